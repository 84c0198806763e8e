//! `explain`: how each surface's shadow on the ground is projected and drawn.

use std::fmt::Write;
use std::path::Path;

use penumbral::plan::{self, Target, candidates, choose};
use penumbral::{Bounds, PixelOptions, Tolerance};

use crate::{Failure, output, read_scene};

pub(crate) fn run(path: &Path) -> Result<(), Failure> {
    let scene = read_scene(path)?;
    let grid = scene.grid().map_err(|error| error.to_string())?;
    let mut text = String::new();
    // Writing to a string cannot fail.
    for (index, surface) in scene.surfaces().iter().enumerate() {
        let light = scene.light();
        let shadow = light
            .cast(surface.shape(), surface.elevation(), 0.0)
            .map_err(|error| error.to_string())?;
        let name = surface
            .name()
            .map(|name| format!(" {name:?}"))
            .unwrap_or_default();
        let _ = writeln!(
            text,
            "surfaces[{index}]{name}, elevation {}",
            surface.elevation()
        );
        let Some(bounds) = shadow.bounds() else {
            let _ = writeln!(text, "  no shadow on the ground");
            continue;
        };
        let scale = light
            .scale(surface.elevation(), 0.0)
            .map_err(|error| error.to_string())?;
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
        let pixels = Target::Pixels {
            per_unit: f64::from(scene.scale()),
        };
        let opacity = Some(scene.tone().key() * surface.weight());
        let skip = plan::skip(&shadow, &grid, &PixelOptions::default(), opacity);
        if let Some(skip) = skip.map_err(|error| error.to_string())? {
            let _ = writeln!(text, "  skipped {skip}");
            continue;
        }
        let tolerance = Tolerance::default();
        let choice = choose(&shadow, tolerance, pixels);
        let _ = writeln!(text, "  method  {}: {}", choice.method, choice.why);
        for candidate in candidates(&shadow, tolerance, pixels) {
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
        for mesh in candidates(&shadow, tolerance, Target::Triangles) {
            let _ = writeln!(
                text,
                "  mesh      about {:.1} ms to build, within {:.2} levels",
                mesh.cost_ns / 1e6,
                mesh.error_levels
            );
        }
    }
    output::print(&text)
}

fn describe(bounds: &Bounds) -> String {
    let ([x0, y0], [x1, y1]) = (bounds.min, bounds.max);
    format!("x {x0:.2} to {x1:.2}, y {y0:.2} to {y1:.2}")
}
