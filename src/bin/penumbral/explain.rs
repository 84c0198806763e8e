//! `explain`: how each surface's shadow on the ground is projected and drawn.

use std::path::Path;

use penumbral::plan::{Target, choose};
use penumbral::{Bounds, Tolerance};

use crate::{Failure, read_scene};

pub(crate) fn run(path: &Path) -> Result<(), Failure> {
    let scene = read_scene(path)?;
    for (index, surface) in scene.surfaces().iter().enumerate() {
        let light = scene.light();
        let shadow = light
            .cast(surface.shape(), surface.elevation(), 0.0)
            .map_err(|error| error.to_string())?;
        let name = surface
            .name()
            .map(|name| format!(" {name:?}"))
            .unwrap_or_default();
        println!("surfaces[{index}]{name}, elevation {}", surface.elevation());
        let Some(bounds) = shadow.bounds() else {
            println!("  no shadow on the ground");
            continue;
        };
        let scale = light
            .scale(surface.elevation(), 0.0)
            .map_err(|error| error.to_string())?;
        println!("  scale   {scale:.4}");
        println!(
            "  radius  {:.3} units, {:.3} px",
            shadow.radius(),
            shadow.radius() * f64::from(scene.scale())
        );
        match shadow.umbra_bounds() {
            Some(umbra) => println!("  umbra   {}", describe(&umbra)),
            None => println!("  umbra   none"),
        }
        println!("  bounds  {}", describe(&bounds));
        let choice = choose(&shadow, Tolerance::default(), Target::Pixels);
        println!("  method  {}: {}", choice.method, choice.why);
    }
    Ok(())
}

fn describe(bounds: &Bounds) -> String {
    let ([x0, y0], [x1, y1]) = (bounds.min, bounds.max);
    format!("x {x0:.2} to {x1:.2}, y {y0:.2} to {y1:.2}")
}
