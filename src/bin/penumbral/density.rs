//! `density`: the density of all casters on the ground, and how long it takes to draw their shadows.

use std::io::Cursor;
use std::path::Path;
use std::time::Instant;

use image::{ImageBuffer, ImageFormat, Luma};
use penumbral::plan::Method;
use penumbral::{DensityMap, Hidden, PixelOptions, Scratch, Tolerance};
use serde_json::json;

use crate::{Failure, extension, output, read_scene};

pub(crate) fn run(
    path: &Path,
    picture: &Path,
    method: Option<Method>,
    tolerance: Option<Tolerance>,
    opaque: bool,
    repeat: u32,
) -> Result<(), Failure> {
    extension(picture, &["png"])?;
    if method == Some(Method::Exact) && tolerance.is_some() {
        return Err("--tolerance is for other methods than exact: leave it out".to_owned());
    }
    let tolerance = tolerance.unwrap_or_default();
    let scene = read_scene(path)?;
    let shadows = scene.ground_shadows().map_err(|e| e.to_string())?;
    let grid = *shadows.grid();
    let (mut hidden, mut scratch) = (Hidden::new(&grid), Scratch::new());
    let mut canvas = vec![255; 4 * grid.width() as usize * grid.height() as usize];
    let mut times = Vec::new();
    let bar = output::progress(repeat as usize + 1, "drawing");
    // The first drawing warms up memory and is not counted.
    for count in 0..=repeat {
        let start = Instant::now();
        if opaque {
            shadows.hide_covered(&mut hidden, &mut scratch);
        }
        let options = PixelOptions::new(tolerance)
            .with_method(method)
            .with_hidden(opaque.then_some(&hidden));
        shadows
            .blend_rgba8(&mut canvas, &options, &mut scratch)
            .map_err(|error| error.to_string())?;
        let time = start.elapsed().as_nanos();
        if count > 0 {
            times.push(time as u64);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    let mut map = DensityMap::default();
    let options = PixelOptions::new(tolerance)
        .with_method(method)
        .with_hidden(opaque.then_some(&hidden));
    shadows
        .draw(&mut map, &options, &mut scratch)
        .map_err(|error| error.to_string())?;
    times.sort_unstable();
    let max = map.densities().iter().copied().fold(0.0_f32, f32::max);

    let grey: ImageBuffer<Luma<u16>, Vec<u16>> =
        ImageBuffer::from_raw(map.width(), map.height(), map.to_grey16())
            .ok_or("the map does not fill its picture")?;
    let mut png = Cursor::new(Vec::new());
    grey.write_to(&mut png, ImageFormat::Png)
        .map_err(|error| error.to_string())?;
    output::write(picture, &png.into_inner())?;
    let names: Vec<&str> = shadows.drawn_by(&options).into_iter().collect();
    let line = json!({
        "method": if names.is_empty() { "none".to_owned() } else { names.join("+") },
        "pixels": map.densities().len(),
        "median_ns": times[times.len() / 2],
        "max_density": max,
    });
    output::print(&format!("{line}\n"))
}
