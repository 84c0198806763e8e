//! One rim by three kinds of normals: a card with three round corners and a sharp one, shaded by the normals of its faces, of its
//! vertices, and by both, blended by curvature.
//!
//! ```sh
//! cargo run --release --features finish --example rims -- rims.png
//! ```

use std::{env, error::Error, path::PathBuf};

use penumbral::finish::{Finish, Rim, RimMesh, RimProfile, RimSurface, ShadingModel, normals};
use penumbral::{Color, CornerRadii, Grid, Light, Renderer, Scene, Shape, Surface};
use tiny_skia::Pixmap;

const MODELS: [(ShadingModel, &str); 3] = [
    (ShadingModel::Flat, "normals of faces"),
    (ShadingModel::Phong, "normals of vertices"),
    (ShadingModel::CurvatureDriven, "curvature-driven normals"),
];

fn main() -> Result<(), Box<dyn Error>> {
    let output = env::args_os().nth(1).map(PathBuf::from);
    let output = output.unwrap_or_else(|| env::temp_dir().join("rims.png"));

    let rim = Rim::new(24.0, 24.0, RimProfile::QuarterRound)?.with_steps(12)?;
    let mut scene = Scene::new([840.0, 240.0], Light::new([200.0, -300.0, 700.0], 40.0)?)?;
    for (index, (model, name)) in MODELS.into_iter().enumerate() {
        let card = card(20.0 + 280.0 * index as f32)?;
        println!(
            "{name}: up to {:.1} degrees off",
            largest_miss(&card, &rim, model)?
        );
        let finish = Finish::new().with_rim(rim).with_shading(model);
        let surface = Surface::new(card, 12.0).with_fill(Color::rgb(0xd0, 0x60, 0x3a));
        scene.push(surface.with_finish(finish))?;
    }
    let mut picture = Pixmap::new(840, 240).ok_or("a picture needs pixels")?;
    Renderer::new().render(&scene, &mut picture)?;
    picture.save_png(&output)?;
    println!("{}", output.display());
    Ok(())
}

fn card(x: f32) -> penumbral::Result<Shape> {
    let radii = [[60.0; 2], [60.0; 2], [0.0; 2], [60.0; 2]];
    Shape::rounded_rect(x, 20.0, 240.0, 180.0, CornerRadii(radii))
}

/// The largest angle between the normals that a model shades by and the surface's own, degrees.
fn largest_miss(card: &Shape, rim: &Rim, model: ShadingModel) -> penumbral::Result<f64> {
    let (mesh, surface) = (RimMesh::new(card, rim)?, RimSurface::new(card, rim));
    let grid = Grid::new([0.0, 0.0], [840, 240], 1.0)?;
    let mut least = 1.0_f64;
    for (index, normal) in normals(&grid, &mesh, model).into_iter().enumerate() {
        let Some(normal) = normal else { continue };
        let at = [(index % 840) as f64 + 0.5, (index / 840) as f64 + 0.5];
        let expected = surface.normal_at(at);
        least = least.min(normal.iter().zip(expected).map(|(a, b)| a * b).sum());
    }
    Ok(least.clamp(-1.0, 1.0).acos().to_degrees())
}
