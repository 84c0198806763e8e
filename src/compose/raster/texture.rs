//! An image as the fill of a surface, pixel by pixel.

use core::ops::Range;

use glam::DVec2;
use tiny_skia::{
    BlendMode, ColorU8, FilterQuality, Paint, Pattern, Pixmap, PremultipliedColorU8, Rect,
    SpreadMode, Transform,
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

/// The side of the tiles in which an image is drawn, in pixels. Where they begin is the picture's to say and not the window's: places of
/// texels are rounded from there, so that a window shows the bits that all of the picture has.
const TILE: u32 = 256;

impl Texture {
    /// An image spread over a place, on a grid's pixels.
    pub(super) fn new(image: &Pixmap, place: &Place, grid: &Grid) -> Result<Self> {
        let mut pixmap = empty(grid.width(), grid.height())?;
        let mut tile = empty(TILE, TILE)?;
        let side = i64::from(TILE);
        let first = [grid.corner().x, grid.corner().y].map(|at| at.floor() as i64);
        let end = [
            first[0] + i64::from(grid.width()),
            first[1] + i64::from(grid.height()),
        ];
        let tiles =
            |axis: usize| first[axis].div_euclid(side)..(end[axis] - 1).div_euclid(side) + 1;
        for y in tiles(1) {
            for x in tiles(0) {
                let origin = [x * side, y * side];
                // What the tile and the grid share, in the tile's pixels.
                let shared = [0, 1].map(|axis: usize| {
                    let from = first[axis].max(origin[axis]) - origin[axis];
                    from as usize..(end[axis].min(origin[axis] + side) - origin[axis]) as usize
                });
                draw(
                    image,
                    place,
                    grid.pixels_per_unit(),
                    origin,
                    &shared,
                    &mut tile,
                );
                let [columns, rows] = shared;
                for row in rows {
                    let to = (origin[1] - first[1] + row as i64) as usize * grid.width() as usize
                        + (origin[0] - first[0] + columns.start as i64) as usize;
                    let from = row * TILE as usize;
                    pixmap.pixels_mut()[to..to + columns.len()]
                        .copy_from_slice(&tile.pixels()[from + columns.start..from + columns.end]);
                }
            }
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

/// Draws an image on some columns and rows of a tile that begins at a pixel, all of them: where the image ends is the surface's own
/// coverage to say.
fn draw(
    image: &Pixmap,
    place: &Place,
    scale: f64,
    origin: [i64; 2],
    [columns, rows]: &[Range<usize>; 2],
    tile: &mut Pixmap,
) {
    let texel =
        place.size * scale / DVec2::new(f64::from(image.width()), f64::from(image.height()));
    let corner = place.min * scale - DVec2::from(origin.map(|at| at as f64));
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
        blend_mode: BlendMode::Source,
        ..Paint::default()
    };
    let [left, right] = [columns.start, columns.end].map(|at| at as f32);
    let [top, bottom] = [rows.start, rows.end].map(|at| at as f32);
    if let Some(shown) = Rect::from_ltrb(left, top, right, bottom) {
        tile.fill_rect(shown, &paint, Transform::identity(), None);
    }
}
