//! `explain`: how each surface's shadow on the ground is projected and drawn.

use std::fmt::Write;
use std::path::Path;

use penumbral::plan::{self, Target, candidates, choose};
use penumbral::{Bounds, Grid, Light, PixelOptions, Pose, Scene, Shadow, Surface, Tolerance};

use crate::{Failure, output, read_scene};

pub(crate) fn run(path: &Path) -> Result<(), Failure> {
    let scene = read_scene(path)?;
    let grid = scene.grid().map_err(|error| error.to_string())?;
    let lights: Vec<(Light, f32)> = scene.lights().collect();
    let mut text = String::new();
    // Writing to a string cannot fail.
    for (surface, field) in scene.surfaces().iter().zip(scene.surface_fields()) {
        for (number, (light, key)) in lights.iter().enumerate() {
            let name = surface
                .name()
                .map(|name| format!(" {name:?}"))
                .unwrap_or_default();
            let _ = write!(text, "{field}{name}, elevation {}", surface.elevation());
            if lights.len() > 1 {
                let _ = write!(text, ", light {number}");
            }
            let _ = writeln!(text);
            if !surface.casts() {
                let _ = writeln!(text, "  no shadow");
                Ok(())
            } else if let Some(pose) = surface.pose() {
                tilted(surface, pose, light, &mut text)
            } else if let Some(image) = surface.as_image() {
                let [width, height] = image.size();
                let _ = writeln!(
                    text,
                    "  method  by the alpha of an image of {width} x {height} pixels"
                );
                Ok(())
            } else {
                level(surface, (light, *key), &scene, &grid, &mut text)
            }
            .map_err(|error| error.to_string())?;
        }
    }
    output::print(&text)
}

fn tilted(
    surface: &Surface,
    pose: &Pose,
    light: &Light,
    text: &mut String,
) -> penumbral::Result<()> {
    let shadow = light.cast_posed(surface.shape(), pose, 0.0)?;
    let _ = match shadow.bounds() {
        Some(bounds) => writeln!(
            text,
            "  bounds  {}\n  method  in closed form: each of its points has a penumbra radius of its own",
            describe(&bounds)
        ),
        None => writeln!(text, "  no shadow on the ground"),
    };
    Ok(())
}

fn level(
    surface: &Surface,
    (light, key): (&Light, f32),
    scene: &Scene,
    grid: &Grid,
    text: &mut String,
) -> penumbral::Result<()> {
    let shadow = light.cast(surface.shape(), surface.elevation(), 0.0)?;
    let Some(bounds) = shadow.bounds() else {
        let _ = writeln!(text, "  no shadow on the ground");
        return Ok(());
    };
    let scale = light.scale(surface.elevation(), 0.0)?;
    let _ = writeln!(text, "  scale   {scale:.4}");
    let _ = writeln!(
        text,
        "  radius  {:.3} units, {:.3} px",
        shadow.radius(),
        shadow.radius() * f64::from(scene.scale())
    );
    let umbra = match shadow.umbra_bounds() {
        Some(umbra) => describe(&umbra),
        None => "none".to_owned(),
    };
    let _ = writeln!(text, "  umbra   {umbra}");
    let _ = writeln!(text, "  bounds  {}", describe(&bounds));
    let opacity = Some(key * surface.weight());
    if let Some(skip) = plan::skip(&shadow, grid, &PixelOptions::default(), opacity)? {
        let _ = writeln!(text, "  skipped {skip}");
    } else {
        methods(&shadow, grid, text);
    }
    Ok(())
}

/// The method that the plan chooses, and the others.
fn methods(shadow: &Shadow, grid: &Grid, text: &mut String) {
    let pixels = Target::Pixels(*grid);
    let tolerance = Tolerance::default();
    let choice = choose(shadow, tolerance, pixels);
    let _ = writeln!(text, "  method  {}: {}", choice.method, choice.why);
    for candidate in candidates(shadow, tolerance, pixels) {
        let mark = if candidate.method == choice.method {
            "takes"
        } else if candidate.error_levels > tolerance.as_levels() {
            "too wrong"
        } else {
            "instead"
        };
        let _ = writeln!(
            text,
            "  {mark:9} {}: about {:.3} ms, within {:.2} levels",
            candidate.method,
            candidate.cost_ns / 1e6,
            candidate.error_levels
        );
    }
    for mesh in candidates(shadow, tolerance, Target::Triangles) {
        let _ = writeln!(
            text,
            "  mesh      about {:.1} ms to build, within {:.2} levels",
            mesh.cost_ns / 1e6,
            mesh.error_levels
        );
    }
}

fn describe(bounds: &Bounds) -> String {
    let ([x0, y0], [x1, y1]) = (bounds.min, bounds.max);
    format!("x {x0:.2} to {x1:.2}, y {y0:.2} to {y1:.2}")
}
