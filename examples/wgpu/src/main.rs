//! Draws penumbral's meshes through a GPU pipeline into an 8-bit texture, reads it back and compares every pixel with the exact
//! density. Vulkan in software is enough: Debian's `mesa-vulkan-drivers` has one. `cargo run`.

mod gpu;

use anyhow::{Result, ensure};
use penumbral::{FillRule, Light, MeshBuffers, Scratch, Shadow, Shape, Tolerance};

/// The texture's size: one pixel a scene unit.
const SIZE: [u32; 2] = [448, 384];

/// Rounding to 8 bits.
const ROUNDING: f64 = 0.5;

/// GPUs put vertices on a grid of 1/256 pixel, which may move them by half of it along each axis; density changes by at most
/// 2 / π over the penumbra radius.
const SNAP: f64 = core::f64::consts::FRAC_1_SQRT_2 / 256.0 * core::f64::consts::FRAC_2_PI * 255.0;

fn main() -> Result<()> {
    let gpu = gpu::Gpu::new(SIZE)?;
    println!("{}", gpu.name());
    let mut scratch = Scratch::new();
    for (name, shadow) in shadows()? {
        for levels in [1.0_f32, 4.0] {
            let mut buffers = MeshBuffers::<u32>::new();
            let quality =
                shadow.mesh_into(&mut buffers, Tolerance::levels(levels)?, &mut scratch)?;
            let pixels = gpu.draw(&buffers)?;
            let worst = worst(&shadow, &pixels);
            println!(
                "{name:8} {} triangles, {:.2} of {levels} levels stated, {worst:.2} on the GPU",
                buffers.indices.len() / 3,
                quality.error_levels,
            );
            let most = quality.error_levels + ROUNDING + SNAP / shadow.radius();
            ensure!(
                quality.is_complete() && worst <= most,
                "{worst} levels, above {most}"
            );
        }
    }
    Ok(())
}

/// The largest difference from the exact density at the pixels' centres, in levels.
fn worst(shadow: &Shadow, pixels: &[u8]) -> f64 {
    let error = |(index, &value): (usize, &u8)| {
        let width = SIZE[0] as usize;
        let center = [index % width, index / width].map(|i| i as f32 + 0.5);
        (f64::from(value) - 255.0 * shadow.density_at(center)).abs()
    };
    pixels.iter().enumerate().map(error).fold(0.0, f64::max)
}

fn shadows() -> Result<Vec<(&'static str, Shadow)>> {
    let light = Light::new([200.0, 180.0, 600.0], 800.0)?;
    let card = Shape::rounded_rect(60.0, 80.0, 300.0, 200.0, 12.0)?;
    let disc = Shape::circle([210.0, 180.0], 40.0)?;
    let bar = Shape::rect(80.0, 170.0, 260.0, 6.0)?;
    let star: Vec<[f32; 2]> = (0_u8..10)
        .map(|i| {
            let (sin, cos) = (f32::from(i) * core::f32::consts::PI / 5.0).sin_cos();
            let radius = if i % 2 == 0 { 130.0 } else { 55.0 };
            [210.0 + radius * sin, 180.0 - radius * cos]
        })
        .collect();
    let hole = star
        .iter()
        .map(|&[x, y]| [210.0 + (x - 210.0) * 0.4, 180.0 + (y - 180.0) * 0.4])
        .collect();
    let star = Shape::polygon(&[star, hole], FillRule::EvenOdd)?;
    let mut shadows = Vec::new();
    for (name, shape) in [("card", card), ("disc", disc), ("bar", bar), ("star", star)] {
        shadows.push((name, light.cast(&shape, 8.0, 0.0)?));
    }
    Ok(shadows)
}
