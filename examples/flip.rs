//! A card that flips over its own middle line, in 24 frames on one sheet.
//!
//! `cargo run --release --example flip -- flip.png`

use std::env;
use std::error::Error;
use std::f32::consts::PI;

use penumbral::{Color, Light, Pose, Renderer, Scene, Shape, Surface, Tone};
use tiny_skia::{Pixmap, PixmapPaint, Transform};

/// Frames in a row, rows, and the side of a frame in scene units and pixels.
const SHEET: [u32; 2] = [6, 4];
const SIDE: u32 = 150;

fn main() -> Result<(), Box<dyn Error>> {
    let path = env::args().nth(1).unwrap_or_else(|| "flip.png".to_owned());
    let mut sheet =
        Pixmap::new(SHEET[0] * SIDE, SHEET[1] * SIDE).ok_or("no memory for the sheet")?;
    let mut frame = Pixmap::new(SIDE, SIDE).ok_or("no memory for a frame")?;
    let mut renderer = Renderer::new();
    let count = SHEET[0] * SHEET[1];
    for index in 0..count {
        let angle = PI * index as f32 / (count - 1) as f32;
        renderer.render(&scene(angle)?, &mut frame)?;
        let [x, y] = [index % SHEET[0], index / SHEET[0]].map(|place| (place * SIDE) as i32);
        let paint = PixmapPaint::default();
        sheet.draw_pixmap(x, y, frame.as_ref(), &paint, Transform::identity(), None);
    }
    sheet.save_png(&path)?;
    println!("{path}: {count} frames");
    Ok(())
}

/// The card in the middle of its flip's `angle`, radians.
fn scene(angle: f32) -> penumbral::Result<Scene> {
    let light = Light::new([SIDE as f32 / 2.0, -30.0, 300.0], 130.0)?;
    let mut scene = Scene::new([SIDE as f32; 2], light)?.with_tone(Tone::new(0.4, 0.05)?);
    let card = Shape::rounded_rect(45.0, 35.0, 60.0, 80.0, 8.0)?;
    let pose = Pose::turned(44.0, [75.0, 75.0], [0.0, 1.0], angle)?;
    // Face up it is white, face down red.
    let fill = if angle < PI / 2.0 {
        Color::WHITE
    } else {
        Color::rgb(0xe5, 0x73, 0x73)
    };
    scene.push(Surface::posed(card, &pose).with_fill(fill))?;
    Ok(scene)
}
