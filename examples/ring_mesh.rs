//! A ring as triangles: one shadow as a mesh within four tolerances, side by side in an SVG.
//!
//! ```sh
//! cargo run --release --example ring_mesh -- ring_mesh.svg
//! ```

use std::{env, error::Error, fs, path::PathBuf};

use penumbral::{FillRule, Light, Path, Shape, Tolerance, meshes_to_svg};

fn main() -> Result<(), Box<dyn Error>> {
    let output = env::args_os().nth(1).map(PathBuf::from);
    let output = output.unwrap_or_else(|| env::temp_dir().join("ring_mesh.svg"));

    let light = Light::flutter();
    let mut meshes = Vec::new();
    for (levels, left) in [(64.0, 0.0), (16.0, 240.0), (4.0, 480.0), (1.0, 720.0)] {
        let shadow = light.cast(&ring([left + 100.0, 100.0])?, 16.0, 0.0)?;
        let mesh = shadow.mesh(Tolerance::levels(levels)?);
        println!(
            "within {levels:2} levels: {:4} triangles, off by {:.2} at most",
            mesh.triangles().count(),
            mesh.error_levels()
        );
        meshes.push(mesh);
    }
    fs::write(&output, meshes_to_svg(&meshes, 1.0)?)?;
    println!("{}", output.display());
    Ok(())
}

/// A disc with a round hole nearer to its lower edge.
fn ring([x, y]: [f32; 2]) -> penumbral::Result<Shape> {
    let mut path = Path::new();
    for (y, r) in [(y, 80.0), (y + 14.0, 40.0)] {
        path.move_to([x - r, y])
            .arc_to([r, r], 0.0, false, true, [x + r, y])
            .arc_to([r, r], 0.0, false, true, [x - r, y])
            .close();
    }
    Shape::path(&path, FillRule::EvenOdd)
}
