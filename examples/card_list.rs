//! A list that scrolls, drawn frame by frame as a toolkit on tiny-skia would: all cards cast one shadow, its density
//! goes into a mask of the viewport's size that every frame uses again, and its colour is the toolkit's own.
//!
//! ```sh
//! cargo run --release --example card_list -- card_list.png
//! ```

use std::{env, error::Error, path::PathBuf};

use penumbral::{Grid, Light, PixelOptions, Scratch, Shape};
use tiny_skia::{
    Color, FillRule, LineCap, Mask, Paint, Path, PathBuilder, Pixmap, PixmapPaint, Rect, Stroke,
    Transform,
};

/// Pixels a scene unit.
const SCALE: f32 = 2.0;
/// The height of the bar at the top of the window, scene units. The list scrolls below it.
const BAR: f32 = 48.0;
/// The height of a card, and of the gap above it.
const CARD: f32 = 68.0;
const GAP: f32 = 16.0;
const ELEVATION: f32 = 8.0;
const PORTRAITS: [u32; 7] = [
    0xf28f79, 0xf4c06a, 0x6cc0a8, 0x7a9be0, 0xb493d6, 0xe88aa8, 0x8fb96a,
];

fn main() -> Result<(), Box<dyn Error>> {
    let output = env::args_os().nth(1).map(PathBuf::from);
    let output = output.unwrap_or_else(|| env::temp_dir().join("card_list.png"));

    let mut list = List::new()?;
    let bar = Rect::from_xywh(0.0, 0.0, 200.0, BAR).ok_or("a bar needs an area")?;
    let title = lines(&[[20.0, BAR / 2.0, 84.0]]).ok_or("a title needs a line")?;
    let mut sheet = Pixmap::new(1392, 768).ok_or("a picture needs pixels")?;
    sheet.fill(color(0xc9d1e3));
    for (left, scroll) in [(48.0, 0.0), (496.0, 60.0), (944.0, 322.0)] {
        let window = Transform::from_row(SCALE, 0.0, 0.0, SCALE, left, 48.0);
        sheet.fill_rect(bar, &paint(color(0x24305e)), window, None);
        write(&mut sheet, &title, color(0x8796cc), window);
        list.draw(scroll)?;
        let viewport = Transform::from_translate(left, 48.0 + BAR * SCALE);
        let paint = PixmapPaint::default();
        sheet.draw_pixmap(0, 0, list.pixmap.as_ref(), &paint, viewport, None);
    }
    sheet.save_png(&output)?;
    println!("{}", output.display());
    Ok(())
}

/// What one frame leaves to the next.
struct List {
    light: Light,
    /// Where in the window the list is seen, in scene units and in pixels.
    viewport: Rect,
    grid: Grid,
    mask: Mask,
    scratch: Scratch,
    pixmap: Pixmap,
    /// A card at the origin, as it casts and as it is drawn.
    caster: Shape,
    card: Path,
    portrait: Path,
    text: Path,
}

impl List {
    fn new() -> Result<Self, Box<dyn Error>> {
        let viewport = Rect::from_xywh(0.0, BAR, 200.0, 288.0).ok_or("a viewport needs an area")?;
        let card = Rect::from_xywh(0.0, 0.0, 168.0, CARD).ok_or("a card needs an area")?;
        let [width, height] = [viewport.width(), viewport.height()].map(|v| (v * SCALE) as u32);
        Ok(Self {
            light: Light::android(viewport.width())?,
            viewport,
            grid: Grid::new([viewport.x(), viewport.y()], [width, height], SCALE)?,
            mask: Mask::new(width, height).ok_or("a mask needs pixels")?,
            scratch: Scratch::new(),
            pixmap: Pixmap::new(width, height).ok_or("a picture needs pixels")?,
            caster: Shape::rounded_rect(0.0, 0.0, card.width(), card.height(), 10.0)?,
            card: rounded_rect(card, 10.0).ok_or("a card needs an area")?,
            portrait: PathBuilder::from_circle(34.0, 34.0, 18.0).ok_or("a circle needs an area")?,
            text: lines(&[[70.0, 27.0, 146.0], [70.0, 42.0, 118.0]]).ok_or("text needs lines")?,
        })
    }

    /// Draws the viewport with the list moved up by `scroll`. The light stays where it is over the window.
    fn draw(&mut self, scroll: f32) -> penumbral::Result<()> {
        let places = PORTRAITS.iter().zip(0_u8..).map(|(&portrait, index)| {
            let top = BAR + GAP + f32::from(index) * (CARD + GAP) - scroll;
            (portrait, GAP, top)
        });

        let casters = places
            .clone()
            .map(|(_, x, y)| self.caster.transformed([1.0, 0.0, 0.0, 1.0, x, y]))
            .collect::<penumbral::Result<Vec<_>>>()?;
        let casters: Vec<&Shape> = casters.iter().collect();
        let shadow = self.light.cast_all(&casters, ELEVATION, 0.0)?;
        shadow.fill_a8(
            &self.grid,
            self.mask.data_mut(),
            &PixelOptions::default(),
            &mut self.scratch,
        )?;

        let pixels = Transform::from_scale(SCALE, SCALE)
            .pre_translate(-self.viewport.x(), -self.viewport.y());
        let mut ink = color(0x122066);
        ink.set_alpha(0.3);
        let pixmap = &mut self.pixmap;
        pixmap.fill(color(0xeef1f8));
        pixmap.fill_rect(self.viewport, &paint(ink), pixels, Some(&self.mask));
        for (portrait, x, y) in places {
            let at = pixels.pre_translate(x, y);
            fill(pixmap, &self.card, Color::WHITE, at);
            fill(pixmap, &self.portrait, color(portrait), at);
            write(pixmap, &self.text, color(0xdfe4ef), at);
        }
        Ok(())
    }
}

fn fill(pixmap: &mut Pixmap, path: &Path, color: Color, at: Transform) {
    pixmap.fill_path(path, &paint(color), FillRule::Winding, at, None);
}

/// Draws lines of text, each as a bar.
fn write(pixmap: &mut Pixmap, lines: &Path, color: Color, at: Transform) {
    let stroke = Stroke {
        width: 8.0,
        line_cap: LineCap::Round,
        ..Stroke::default()
    };
    pixmap.stroke_path(lines, &paint(color), &stroke, at, None);
}

/// Lines of text, each from one x at a y to another x.
fn lines(lines: &[[f32; 3]]) -> Option<Path> {
    let mut path = PathBuilder::new();
    for &[from, y, to] in lines {
        path.move_to(from, y);
        path.line_to(to, y);
    }
    path.finish()
}

fn color(rgb: u32) -> Color {
    let [_, r, g, b] = rgb.to_be_bytes();
    Color::from_rgba8(r, g, b, 0xff)
}

fn paint(color: Color) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color(color);
    paint
}

/// A rectangle with corners of radius `r`: tiny-skia has none of its own.
fn rounded_rect(rect: Rect, r: f32) -> Option<Path> {
    // How far before the corner the handles of a cubic end that follows a quarter of a circle.
    let k = r * 0.4477;
    let (left, top, right, bottom) = (rect.left(), rect.top(), rect.right(), rect.bottom());
    let mut path = PathBuilder::new();
    path.move_to(left, top + r);
    path.cubic_to(left, top + k, left + k, top, left + r, top);
    path.line_to(right - r, top);
    path.cubic_to(right - k, top, right, top + k, right, top + r);
    path.line_to(right, bottom - r);
    path.cubic_to(right, bottom - k, right - k, bottom, right - r, bottom);
    path.line_to(left + r, bottom);
    path.cubic_to(left + k, bottom, left, bottom - k, left, bottom - r);
    path.close();
    path.finish()
}
