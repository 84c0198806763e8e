//! Nine-patch: a rounded rectangle's shadow as a small mask that stretches, kept by a [key](ShadowKey).
//!
//! The mask is drawn from the key alone: whichever of the shadows of one key comes first, the bits are the same.

mod key;

use crate::density::blend::{self, Rgba8};
use crate::density::{PixelOptions, Sink};
use crate::error::{Error, Result};
use crate::grid::Grid;
use crate::light::Projection;
use crate::paint::Paint;
use crate::plan::Method;
use crate::scratch::Scratch;
use crate::shadow::Shadow;
use crate::shape::Shape;

pub use key::{PatchPlace, ShadowKey};

/// A mask of 8-bit coverage that draws the shadow of every rounded rectangle with its key: corners as they are, the one
/// column and row between them stretched.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NinePatch {
    mask: Vec<u8>,
    size: [u32; 2],
    insets: [u32; 4],
    stretches: [bool; 2],
}

impl NinePatch {
    /// Draws the mask of a key.
    ///
    /// # Errors
    /// None for keys from [`Shadow::key`].
    pub fn draw(key: &ShadowKey, scratch: &mut Scratch) -> Result<Self> {
        let (rounded, radius, size, insets) = key.layout();
        let shape = Shape::of_box(rounded.min, rounded.max - rounded.min, rounded.radii);
        let shadow = Shadow::project(&[shape], &Projection::in_place(radius));
        let grid = Grid::new([0.0, 0.0], size, 1.0)?;
        let mut mask = vec![0; size[0] as usize * size[1] as usize];
        // It is drawn once and used often.
        let options = PixelOptions::new(key.drawn_within()).with_method(Method::Direct);
        shadow.fill_a8(&grid, &mut mask, &options, scratch)?;
        Ok(Self {
            mask,
            size,
            insets,
            stretches: key.size.map(|size| size.is_none()),
        })
    }

    /// The coverage, row by row, 0 to 255.
    #[must_use]
    pub fn mask(&self) -> &[u8] {
        &self.mask
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The pixels left, top, right and bottom that are not stretched: between them lies one column, and one row. Where the
    /// mask does not stretch along an axis, the first is all of it.
    #[must_use]
    pub fn insets(&self) -> [u32; 4] {
        self.insets
    }

    /// Blends the mask, stretched to its place, onto premultiplied RGBA8 pixels, source over. The grid has as many pixels a scene unit as
    /// the key was asked for with, and begins at a whole pixel from the scene's origin on, as places do.
    ///
    /// # Errors
    /// [`Error::BufferSize`] when `pixels` is shorter than the grid needs; [`Error::OtherGrid`] for one that begins between pixels;
    /// [`Error::OutOfRange`] for a place of another key, smaller than the mask or of another size where it does not stretch.
    pub fn blend_rgba8(
        &self,
        place: PatchPlace,
        grid: &Grid,
        pixels: &mut [u8],
        paint: &Paint,
        scratch: &mut Scratch,
    ) -> Result<()> {
        let mut canvas = PixelOptions::default().onto_rgba8(grid, pixels, paint, scratch)?;
        for axis in 0..2 {
            let (start, end) = (place.min[axis], place.max[axis]);
            let least = i64::from(self.size[axis]);
            let fits = |extent| extent == least || extent > least && self.stretches[axis];
            if !end.checked_sub(start).is_some_and(fits) {
                return Err(Error::OutOfRange {
                    field: "place",
                    value: end as f64 - start as f64,
                    min: least as f64,
                    max: if self.stretches[axis] {
                        f64::INFINITY
                    } else {
                        least as f64
                    },
                });
            }
        }
        let (Some(x), Some(y)) = (grid.whole_corner(0), grid.whole_corner(1)) else {
            return Err(Error::OtherGrid { field: "place" });
        };
        let first = [x as i64, y as i64];
        let [left, top, right, bottom] = self.insets.map(i64::from);
        let height = i64::from(grid.height());
        let on_grid = |place: [i64; 2], axis: usize| place[axis].saturating_sub(first[axis]);
        for row in on_grid(place.min, 1).max(0)..on_grid(place.max, 1).min(height) {
            let at = row + first[1];
            let down = at.saturating_sub(place.min[1]);
            let up = place.max[1].saturating_sub(at);
            // Of the stretched rows all are the one between the insets.
            let from = if down < top {
                down
            } else if up <= bottom {
                i64::from(self.size[1]) - up
            } else {
                top
            };
            let start = (from * i64::from(self.size[0])) as usize;
            let mask = &self.mask[start..start + self.size[0] as usize];
            let columns = [on_grid(place.min, 0), on_grid(place.max, 0)];
            self.blend_row(
                &mut canvas,
                row as u32,
                columns,
                [left, right],
                mask,
                grid.width(),
            );
        }
        Ok(())
    }

    fn blend_row(
        &self,
        canvas: &mut Rgba8<'_>,
        row: u32,
        [start, end]: [i64; 2],
        [left, right]: [i64; 2],
        mask: &[u8],
        width: u32,
    ) {
        let on_grid = |column: i64| column.clamp(0, i64::from(width));
        let mut part = |from: i64, to: i64, mask: &[u8]| {
            let (first, last) = (on_grid(from), on_grid(to));
            if first < last {
                let mask = &mask[(first - from) as usize..(last - from) as usize];
                canvas.coverage(row, first as u32, mask);
            }
        };
        // A place may be as far away as numbers go.
        let stretched = start.saturating_add(left)..end.saturating_sub(right);
        part(start, stretched.start, &mask[..left as usize]);
        if self.stretches[0] {
            part(stretched.end, end, &mask[left as usize + 1..]);
            let (first, last) = (on_grid(stretched.start), on_grid(stretched.end));
            if first < last {
                let density = blend::density(mask[left as usize]);
                canvas.constant(row..row + 1, first as u32..last as u32, density);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use crate::path::FillRule;
    use crate::tolerance::Tolerance;
    use crate::tone::Color;

    fn cards() -> impl Iterator<Item = Shadow> {
        let cards = [
            (40.0, 30.0, 90.0, 60.0, 12.0),
            (40.3, 30.7, 90.25, 60.5, 8.0),
            (50.0, 40.0, 20.0, 70.0, 0.0),
            (45.5, 40.1, 56.0, 56.0, 28.0),
            (30.0, 60.0, 120.0, 3.0, 1.5),
        ];
        cards.into_iter().flat_map(|(x, y, width, height, corner)| {
            [0.3_f32, 2.0, 5.4, 10.8, 25.0].map(|radius| {
                let card = Shape::rounded_rect(x, y, width, height, corner).unwrap();
                let light = Light::directional([0.0, 0.0], radius).unwrap();
                light.cast(&card, 1.0, 0.0).unwrap()
            })
        })
    }

    #[test]
    fn slivers_have_a_mask_or_no_key() {
        let light = Light::directional([0.0, 0.0], 6.0).unwrap();
        let mut keys = 0;
        for index in 0_u8..100 {
            let width = f32::from(index + 1) * 0.000_3;
            let card = Shape::rect(3.0 + f32::from(index) * 0.173, 5.0, width, 40.0).unwrap();
            let shadow = light.cast(&card, 1.0, 0.0).unwrap();
            if let Some((key, _)) = shadow.key(1.0, Tolerance::ONE_LEVEL) {
                NinePatch::draw(&key, &mut Scratch::new()).unwrap();
                keys += 1;
            }
        }
        assert!((50..100).contains(&keys), "{keys}");
    }

    #[test]
    fn scales_places_and_grids_that_do_not_fit_are_refused() {
        let card = Shape::rounded_rect(-40.0, -30.0, 90.0, 60.0, 12.0).unwrap();
        for (spread, elevation) in [(0.3, 1.0), (8.0, 1.0), (1000.0, 5000.0)] {
            let light = Light::directional([0.0, 0.0], spread).unwrap();
            let shadow = light.cast(&card, elevation, 0.0).unwrap();
            for scale in [
                f32::NAN,
                -1.0,
                0.0,
                1e-9,
                1025.0,
                1e9,
                f32::MAX,
                f32::INFINITY,
            ] {
                assert_eq!(shadow.key(scale, Tolerance::ONE_LEVEL), None, "{scale}");
            }
            // Corners of 12,288 pixels.
            assert_eq!(shadow.key(1024.0, Tolerance::ONE_LEVEL), None);
        }
        // Its side leans by 16 pixels of 16 million: to tell it from a rectangle takes more digits.
        let corners = [[0.0, 0.0], [1.6e7, 0.0], [1.6e7, 1.6e7], [0.0156, 1.6e7]];
        let leaning = Shape::polygon(&[corners], FillRule::NonZero).unwrap();
        let light = Light::directional([0.0, 0.0], 0.01).unwrap();
        let shadow = light.cast(&leaning, 1.0, 0.0).unwrap();
        assert_eq!(shadow.key(1024.0, Tolerance::ONE_LEVEL), None);
        let shadow = cards().next().unwrap();
        let (key, _) = shadow.key(1.0, Tolerance::ONE_LEVEL).unwrap();
        let patch = NinePatch::draw(&key, &mut Scratch::new()).unwrap();
        let grid = Grid::new([-50.0, -50.0], [20, 20], 1.0).unwrap();
        let paint = Paint::new(Color::BLACK, 1.0).unwrap();
        let blended = |min, max| {
            let (place, mut pixels) = (PatchPlace { min, max }, vec![0; 4 * 20 * 20]);
            patch
                .blend_rgba8(place, &grid, &mut pixels, &paint, &mut Scratch::new())
                .map(|()| pixels.iter().any(|&byte| byte > 0))
        };
        let between = Grid::new([0.25, 0.0], [20, 20], 1.0).unwrap();
        let place = PatchPlace {
            min: [0; 2],
            max: [1000; 2],
        };
        let refused = patch.blend_rgba8(
            place,
            &between,
            &mut [0; 4 * 20 * 20],
            &paint,
            &mut Scratch::new(),
        );
        assert_eq!(refused, Err(Error::OtherGrid { field: "place" }));
        assert!(blended([i64::MIN; 2], [i64::MAX; 2]).is_err());
        assert!(blended([i64::MAX; 2], [i64::MIN; 2]).is_err());
        assert_eq!(blended([i64::MIN; 2], [-1; 2]), Ok(true));
        assert_eq!(blended([i64::MIN; 2], [i64::MIN + 1000; 2]), Ok(false));
        assert_eq!(blended([i64::MAX - 1000; 2], [i64::MAX; 2]), Ok(false));
        // The same beside the grid.
        let right = blended([i64::MAX - 1000, -60], [i64::MAX, 940]);
        let left = blended([i64::MIN, -60], [i64::MIN + 1000, 940]);
        assert_eq!((left, right), (Ok(false), Ok(false)));
    }

    /// How far a mask is from the exact densities besides its rounding, in levels.
    fn error(shadow: &Shadow, tolerance: Tolerance) -> f32 {
        let grid = Grid::new([0.0, 0.0], [180, 160], 1.0).unwrap();
        let mut scratch = Scratch::new();
        let paint = Paint::new(Color::BLACK, 1.0).unwrap();
        let (key, place) = shadow.key(1.0, tolerance).unwrap();
        let patch = NinePatch::draw(&key, &mut scratch).unwrap();
        let mut pixels = vec![0; 4 * 180 * 160];
        patch
            .blend_rgba8(place, &grid, &mut pixels, &paint, &mut scratch)
            .unwrap();
        let mut exact = vec![0.0; 180 * 160];
        let options = PixelOptions::default().with_method(Method::Exact);
        shadow
            .fill_f32(&grid, &mut exact, &options, &mut scratch)
            .unwrap();
        let errors = pixels.chunks_exact(4).zip(&exact);
        errors
            .map(|(pixel, exact)| (f32::from(pixel[3]) - exact * 255.0).abs() - 0.5)
            .fold(0.0, f32::max)
    }

    #[test]
    fn masks_draw_what_their_shadows_are() {
        for shadow in cards() {
            let worst = error(&shadow, Tolerance::ONE_LEVEL);
            assert!(worst <= 1.0, "{shadow:?}: {worst} levels");
        }
    }

    /// Shapes about as large as the disc, which feel all of their sides, found by going uphill.
    #[test]
    fn masks_of_discs_keep_their_tolerance() {
        for (x, y, width, height, radius) in [
            (20.84988, 19.877647, 20.81361, 21.217005, 11.112188),
            (20.911095, 20.045227, 21.044691, 20.027647, 10.779568),
            (20.403008, 21.228539, 14.815598, 15.412852, 8.386156),
            (20.223171, 19.59957, 20.742243, 20.568819, 10.820612),
            (19.685501, 19.881844, 15.433369, 15.5196495, 8.049017),
        ] {
            let card = Shape::rounded_rect(x, y, width, height, 1e4).unwrap();
            let light = Light::directional([0.0, 0.0], radius).unwrap();
            let shadow = light.cast(&card, 1.0, 0.0).unwrap();
            for levels in [0.0625, 0.5, 1.0, 2.0, 4.0, 16.0] {
                let worst = error(&shadow, Tolerance::levels(levels).unwrap());
                assert!(worst <= levels, "{width} x {height}: {worst} of {levels}");
            }
        }
    }

    /// The mask of all the shadow's pixels.
    fn stretched(patch: &NinePatch, place: PatchPlace) -> Vec<u8> {
        let axis = |axis: usize| {
            let [near, far] = [axis, axis + 2].map(|side| i64::from(patch.insets[side]));
            let extent = place.max[axis] - place.min[axis];
            let size = i64::from(patch.size[axis]);
            (0..extent).map(move |at| {
                let from = if at >= extent - far {
                    at - extent + size
                } else {
                    at.min(near)
                };
                from as usize
            })
        };
        let width = patch.size[0] as usize;
        axis(1)
            .flat_map(|y| axis(0).map(move |x| patch.mask[y * width + x]))
            .collect()
    }

    #[test]
    fn a_mask_is_blended_as_if_it_were_stretched_before() {
        let mut scratch = Scratch::new();
        let paint = Paint::new(Color::rgb(30, 60, 90), 0.6).unwrap();
        for shadow in cards() {
            let (key, place) = shadow.key(1.0, Tolerance::ONE_LEVEL).unwrap();
            let patch = NinePatch::draw(&key, &mut scratch).unwrap();
            let size = [0, 1].map(|axis| (place.max[axis] - place.min[axis]) as u32);
            let grid = Grid::new(place.min.map(|v| v as f32), size, 1.0).unwrap();
            let mask = stretched(&patch, place);
            let mut pixels = vec![180; 4 * mask.len()];
            let mut expected = pixels.clone();
            patch
                .blend_rgba8(place, &grid, &mut pixels, &paint, &mut scratch)
                .unwrap();
            paint
                .blend_mask(&grid, &mask, grid.stride(), &mut expected, &mut scratch)
                .unwrap();
            assert!(pixels == expected, "{key:?}");
        }
    }

    #[test]
    fn keys_tell_neither_place_nor_size() {
        let light = Light::directional([0.0, 0.0], 8.0).unwrap();
        let key = |x: f32, y: f32, width: f32| {
            let card = Shape::rounded_rect(x, y, width, 80.0, 12.0).unwrap();
            let shadow = light.cast(&card, 1.0, 0.0).unwrap();
            shadow.key(1.0, Tolerance::ONE_LEVEL).unwrap()
        };
        let (here, place) = key(10.25, 20.0, 100.0);
        let (there, moved) = key(310.25, 1020.0, 164.0);
        assert_eq!(here, there);
        assert_eq!(moved.min, [place.min[0] + 300, place.min[1] + 1000]);
        assert_eq!(
            moved.max[0] - moved.min[0],
            place.max[0] - place.min[0] + 64
        );
        assert_ne!(here, key(10.5, 20.0, 100.0).0);
        // A hundredth of a pixel is below the tolerance, a hair before a whole one is that one.
        assert_eq!(key(10.0, 20.0, 100.0).0, key(10.001, 20.0, 100.0).0);
        assert_eq!(key(10.0, 20.0, 100.0), key(9.9999, 20.0, 100.0));
    }
}
