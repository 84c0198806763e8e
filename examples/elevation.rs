//! A card that rises from the ground, as a sheet of twelve frames: each is a scene, and one renderer draws them all.
//!
//! ```sh
//! cargo run --release --example elevation -- elevation.png
//! ```

use std::{env, error::Error, path::PathBuf};

use penumbral::{Color, Light, Renderer, Scene, Shape, Surface, Tone};
use tiny_skia::{Pixmap, PixmapPaint, Transform};

const COLUMNS: u16 = 4;
const FRAMES: u16 = 12;
/// How high the card rises, scene units.
const HIGHEST: f32 = 32.0;
const GROUND: Color = Color::rgb(0xee, 0xea, 0xe4);

fn main() -> Result<(), Box<dyn Error>> {
    let output = env::args_os().nth(1).map(PathBuf::from);
    let output = output.unwrap_or_else(|| env::temp_dir().join("elevation.png"));

    let mut renderer = Renderer::new();
    let mut frame = Pixmap::new(244, 204).ok_or("a frame needs pixels")?;
    let mut sheet = Pixmap::new(1000, 636).ok_or("a sheet needs pixels")?;
    sheet.fill(tiny_skia::Color::from_rgba8(
        GROUND.r, GROUND.g, GROUND.b, GROUND.a,
    ));
    for index in 0..FRAMES {
        let time = f32::from(index) / f32::from(FRAMES - 1);
        // Slow at first: shadows change most near the ground.
        renderer.render(&scene(HIGHEST * time.powf(1.5))?, &mut frame)?;
        let [x, y] = [index % COLUMNS * 244 + 12, index / COLUMNS * 204 + 12].map(i32::from);
        sheet.draw_pixmap(
            x,
            y,
            frame.as_ref(),
            &PixmapPaint::default(),
            Transform::identity(),
            None,
        );
    }
    sheet.save_png(&output)?;
    println!("{}", output.display());
    Ok(())
}

/// The card at an elevation, over a surface on the ground.
fn scene(elevation: f32) -> penumbral::Result<Scene> {
    let mut scene = Scene::new([244.0, 204.0], Light::flutter())?
        .with_tone(Tone::FLUTTER)
        .with_background(GROUND)?;
    let below = Shape::rounded_rect(12.0, 12.0, 220.0, 180.0, 16.0)?;
    let card = Shape::rounded_rect(62.0, 44.0, 120.0, 84.0, 12.0)?;
    scene.push(Surface::new(below, 0.0).with_fill(Color::rgb(0xfb, 0xfa, 0xf7)))?;
    scene.push(Surface::new(card, elevation).with_fill(Color::rgb(0xe3, 0x6f, 0x56)))?;
    Ok(scene)
}
