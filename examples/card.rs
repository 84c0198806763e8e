//! A card over its shadow on a tiny-skia pixmap: the path that tiny-skia fills is the caster, too.
//!
//! ```sh
//! cargo run --release --example card -- card.png
//! ```

use std::{env, error::Error, path::PathBuf};

use penumbral::{FillRule, Grid, Light, Path, PixelOptions, Scratch, Shape, Tone};
use tiny_skia::{Color, Mask, Paint, PathBuilder, Pixmap, Rect, Transform};

fn main() -> Result<(), Box<dyn Error>> {
    let output = env::args_os().nth(1).map(PathBuf::from);
    let output = output.unwrap_or_else(|| env::temp_dir().join("card.png"));
    let mut pixmap = Pixmap::new(520, 380).ok_or("a picture needs pixels")?;
    let mut mask = Mask::new(520, 380).ok_or("a mask needs pixels")?;
    let canvas = Rect::from_xywh(0.0, 0.0, 520.0, 380.0).ok_or("a canvas needs an area")?;
    let card = rounded_rect(120.0, 92.0, 400.0, 268.0, 24.0).ok_or("a card needs an area")?;

    // The density, one byte a pixel: a mask.
    let shape = Shape::path(&Path::from(&card), FillRule::NonZero)?;
    let shadow = Light::android(canvas.width())?.cast(&shape, 24.0, 0.0)?;
    let grid = Grid::new([0.0, 0.0], [mask.width(), mask.height()], 1.0)?;
    shadow.fill_a8(
        &grid,
        mask.data_mut(),
        &PixelOptions::default(),
        &mut Scratch::new(),
    )?;

    // From the ground up: its colour, the shadow on it in black, the card over both in white.
    let (winding, identity) = (tiny_skia::FillRule::Winding, Transform::identity());
    let mut paint = Paint::default();
    pixmap.fill(Color::from_rgba8(0xe9, 0xed, 0xf4, 0xff));
    paint.shader.apply_opacity(Tone::ANDROID.key());
    pixmap.fill_rect(canvas, &paint, identity, Some(&mask));
    paint.set_color(Color::WHITE);
    pixmap.fill_path(&card, &paint, winding, identity, None);

    pixmap.save_png(&output)?;
    println!("{}", output.display());
    Ok(())
}

/// A rectangle whose corners are cut short by curves, from `r` before each to `r` after it.
fn rounded_rect(left: f32, top: f32, right: f32, bottom: f32, r: f32) -> Option<tiny_skia::Path> {
    let mut path = PathBuilder::new();
    path.move_to(left, top + r);
    path.quad_to(left, top, left + r, top);
    path.line_to(right - r, top);
    path.quad_to(right, top, right, top + r);
    path.line_to(right, bottom - r);
    path.quad_to(right, bottom, right - r, bottom);
    path.line_to(left + r, bottom);
    path.quad_to(left, bottom, left, bottom - r);
    path.close();
    path.finish()
}
