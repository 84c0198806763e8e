//! `render`: a scene as a picture.

use std::path::Path;

use penumbral::{Renderer, Scene, Tolerance};
use tiny_skia::Pixmap;

use crate::{Failure, extension, output, read_scene};

pub(crate) fn run(
    path: &Path,
    picture: &Path,
    tolerance: Option<Tolerance>,
) -> Result<(), Failure> {
    let kind = extension(picture, &["png", "svg"])?;
    if kind == "png" && tolerance.is_some() {
        return Err("--tolerance is for an SVG, a PNG keeps one level: leave it out".to_owned());
    }
    let scene = read_scene(path)?;
    let contents = match kind {
        "svg" => scene
            .to_svg(tolerance.unwrap_or_default())
            .map_err(|error| error.to_string())?
            .into_bytes(),
        _ => png(&scene)?,
    };
    output::write(picture, &contents)
}

fn png(scene: &Scene) -> Result<Vec<u8>, Failure> {
    let grid = scene.grid().map_err(|error| error.to_string())?;
    let mut pixmap = Pixmap::new(grid.width(), grid.height())
        .ok_or_else(|| format!("no memory for {} x {} pixels", grid.width(), grid.height()))?;
    let bar = output::progress(scene.surfaces().len() + 1, "layers");
    Renderer::new()
        .render_while(scene, &mut pixmap, |done, all| {
            bar.set_length(all as u64);
            bar.set_position(done as u64);
            true
        })
        .map_err(|error| error.to_string())?;
    bar.finish_and_clear();
    pixmap.encode_png().map_err(|error| error.to_string())
}
