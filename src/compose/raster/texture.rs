//! An image as the fill of a surface, pixel by pixel.

use glam::DVec2;
use tiny_skia::{
    ColorU8, FilterQuality, Paint, Pattern, Pixmap, PremultipliedColorU8, Rect, SpreadMode,
    Transform,
};

use crate::error::{Error, Result};
use crate::grid::Grid;
use crate::image::{Image, Place};

/// The colours and opacities of a layer's pixels.
pub(super) struct Texture {
    pixmap: Pixmap,
}

/// An image as tiny-skia has them.
pub(super) fn premultiplied(image: &Image) -> Result<Pixmap> {
    let [width, height] = image.size();
    let mut pixmap = empty(width, height)?;
    let pixels = pixmap.pixels_mut().iter_mut();
    for (to, from) in pixels.zip(image.pixels().chunks_exact(4)) {
        *to = ColorU8::from_rgba(from[0], from[1], from[2], from[3]).premultiply();
    }
    Ok(pixmap)
}

fn empty(width: u32, height: u32) -> Result<Pixmap> {
    Pixmap::new(width, height).ok_or(Error::PictureSize {
        width: u64::from(width),
        height: u64::from(height),
    })
}

impl Texture {
    /// An image spread over a place, on a grid's pixels.
    pub(super) fn new(image: &Pixmap, place: &Place, grid: &Grid) -> Result<Self> {
        let mut pixmap = empty(grid.width(), grid.height())?;
        let scale = grid.pixels_per_unit();
        let texel =
            place.size * scale / DVec2::new(f64::from(image.width()), f64::from(image.height()));
        let corner = place.min * scale - grid.corner();
        let transform = Transform::from_row(
            texel.x as f32,
            0.0,
            0.0,
            texel.y as f32,
            corner.x as f32,
            corner.y as f32,
        );
        let paint = Paint {
            shader: Pattern::new(
                image.as_ref(),
                SpreadMode::Pad,
                FilterQuality::Bilinear,
                1.0,
                transform,
            ),
            ..Paint::default()
        };
        // All of the layer: where the image ends is the surface's own coverage to say.
        let whole = Rect::from_xywh(0.0, 0.0, grid.width() as f32, grid.height() as f32);
        if let Some(whole) = whole {
            pixmap.fill_rect(whole, &paint, Transform::identity(), None);
        }
        Ok(Self { pixmap })
    }

    /// The colour and the opacity, 0 to 1, of a pixel.
    pub(super) fn at(&self, index: usize) -> ([u8; 3], f32) {
        let pixel: PremultipliedColorU8 = self.pixmap.pixels()[index];
        let color = pixel.demultiply();
        (
            [color.red(), color.green(), color.blue()],
            f32::from(color.alpha()) / 255.0,
        )
    }
}
