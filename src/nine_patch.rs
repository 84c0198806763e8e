//! Nine-patch: a rounded rectangle's shadow as a small mask that stretches, and the key to keep it by.
//!
//! Such a shadow depends on radii, on where in their pixels its four sides lie, and on its size only where corners meet.
//! The key holds these in steps so small that all shadows of one key are alike within the tolerance, and the mask is drawn
//! from the key alone: whichever of them comes first, the bits are the same.

use core::f64::consts::PI;

use glam::DVec2;
use libm::{exp, log, log1p};

use crate::density::blend::{self, Rgba8};
use crate::density::rounded::Rounded;
use crate::density::{PixelOptions, Sink};
use crate::error::{Error, Result};
use crate::grid::{Grid, LEAST_SCALE, MOST_SCALE};
use crate::light::Projection;
use crate::paint::Paint;
use crate::plan::Method;
use crate::scratch::Scratch;
use crate::shadow::Shadow;
use crate::shape::Shape;
use crate::tolerance::Tolerance;

/// What masks of rounded rectangles' shadows are kept by: it tells neither where the shadow is, in whole pixels, nor its
/// colour, and its size only where it matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ShadowKey {
    /// The tolerance in 65536ths of a level.
    levels: u32,
    /// The penumbra radius in steps of a share of itself.
    radius: i32,
    /// The corners' radii, and by how much each side is past a whole pixel, in steps.
    radii: [u32; 4],
    sides: [u32; 4],
    /// The distance between opposite sides' whole pixels, where the mask does not stretch.
    size: [Option<u32>; 2],
}

/// Where a mask belongs: the shadow's pixels from `[left, top]` to before `[right, bottom]`, counted from the scene's
/// origin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PatchPlace {
    /// The first column and row.
    pub min: [i64; 2],
    /// Those after the last.
    pub max: [i64; 2],
}

/// A mask of 8-bit coverage that draws the shadow of every rounded rectangle with its key: corners as they are, the one
/// column and row between them stretched.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NinePatch {
    mask: Vec<u8>,
    size: [u32; 2],
    insets: [u32; 4],
    stretches: [bool; 2],
}

/// Shares of the tolerance for rounding to steps: of a side's place, of the penumbra radius, of corners' radii.
const SIDE: f64 = 0.2;
const RADIUS: f64 = 0.1;
const CORNER: f64 = 0.1;

/// How far from a whole pixel a grid may begin besides what `f32` rounds, in pixels: next to nothing.
const WHOLE: f64 = 1.0 / 1024.0;

/// The sizes of the steps.
struct Steps {
    radius: f64,
    side: f64,
    corner: f64,
}

impl ShadowKey {
    fn tolerance(&self) -> f64 {
        f64::from(self.levels) / 65_536.0 / 255.0
    }

    /// The penumbra radius in pixels, and the steps of the rest. A step is twice what rounding may do: a side moved by d
    /// moves the density by 2 d / (π r), by d where that is more than the pixel's own width allows; a radius larger by its
    /// share s moves it by s / π; a corner's radius larger by d moves the outline by (sqrt 2 - 1) d.
    fn steps(tolerance: f64, radius: i32) -> Steps {
        let radius = exp(f64::from(radius) * log1p(2.0 * RADIUS * PI * tolerance));
        let side = 2.0 * SIDE * tolerance * (PI * radius / 2.0).max(1.0);
        Steps {
            radius,
            // A pixel has a whole number of steps.
            side: 1.0 / (1.0 / side).ceil(),
            corner: side * (CORNER / SIDE) / (core::f64::consts::SQRT_2 - 1.0),
        }
    }

    /// The rectangle that the mask is drawn of, in pixels of the mask, and the mask's size and insets.
    fn layout(&self) -> (Rounded, f64, [u32; 2], [u32; 4]) {
        let steps = Self::steps(self.tolerance(), self.radius);
        let radii = self.radii.map(|radius| f64::from(radius) * steps.corner);
        let reach = reach(steps.radius);
        let past = self.sides.map(|side| f64::from(side) * steps.side);
        let [tl, tr, br, bl] = radii;
        let rounds = [[tl.max(bl), tr.max(br)], [tl.max(tr), bl.max(br)]];
        let (mut min, mut max) = (DVec2::ZERO, DVec2::ZERO);
        let (mut size, mut insets) = ([0; 2], [0; 4]);
        for axis in 0..2 {
            min[axis] = reach + past[axis];
            let near = (min[axis] + rounds[axis][0] + steps.radius).ceil() + 1.0;
            let far = (rounds[axis][1] + steps.radius - past[axis + 2]).ceil() + 1.0;
            let whole = match self.size[axis] {
                Some(size) => f64::from(size) + reach,
                None => near + 1.0 + far,
            };
            max[axis] = whole + past[axis + 2];
            size[axis] = (whole + 1.0 + reach) as u32;
            if self.size[axis].is_none() {
                insets[axis] = near as u32;
                insets[axis + 2] = (far + 1.0 + reach) as u32;
            } else {
                insets[axis] = size[axis];
            }
        }
        (Rounded { min, max, radii }, steps.radius, size, insets)
    }
}

/// Whole pixels that hold a penumbra and what averaging adds.
fn reach(radius: f64) -> f64 {
    (radius + 0.5).ceil() + 1.0
}

impl Shadow {
    /// The key of the shadow's mask and the place for it, on so many pixels a scene unit; none where the shadow is not one
    /// of a rounded rectangle with circular corners, this is thinner than the steps that keys round to, no [`Grid`] has so many pixels a
    /// unit, or one mask would be larger than a picture may be.
    ///
    /// ```
    /// use penumbral::{Color, Grid, Light, NinePatch, Paint, Scratch, Shape, Tolerance};
    ///
    /// let card = Shape::rounded_rect(24.0, 40.0, 312.0, 160.0, 12.0)?;
    /// let shadow = Light::android(360.0)?.cast(&card, 8.0, 0.0)?;
    /// let mut scratch = Scratch::new();
    /// let (key, place) = shadow.key(1.0, Tolerance::ONE_LEVEL).unwrap();
    /// // Kept by `key`, for this card wherever it scrolls.
    /// let patch = NinePatch::draw(&key, &mut scratch)?;
    ///
    /// let grid = Grid::new([0.0, 0.0], [360, 240], 1.0)?;
    /// let mut canvas = vec![255; 360 * 240 * 4];
    /// patch.blend_rgba8(place, &grid, &mut canvas, &Paint::new(Color::BLACK, 0.19)?, &mut scratch)?;
    /// # Ok::<(), penumbral::Error>(())
    /// ```
    #[must_use]
    pub fn key(
        &self,
        pixels_per_unit: f32,
        tolerance: Tolerance,
    ) -> Option<(ShadowKey, PatchPlace)> {
        let scale = f64::from(pixels_per_unit);
        let is_scale = (LEAST_SCALE..=MOST_SCALE).contains(&scale);
        let rounded = self.rounded().filter(|_| is_scale && self.radius() > 0.0)?;
        let levels = (tolerance.as_levels() * 65_536.0) as u32;
        let share = f64::from(levels) / 65_536.0 / 255.0;
        let radius_step = log1p(2.0 * RADIUS * PI * share);
        let radius = (log(self.radius() * scale) / radius_step).round() as i32;
        let steps = ShadowKey::steps(share, radius);
        let mut key = ShadowKey {
            levels,
            radius,
            radii: rounded
                .radii
                .map(|r| (r * scale / steps.corner).round() as u32),
            sides: [0; 4],
            size: [None; 2],
        };
        let reach = reach(steps.radius) as i64;
        let corners = [rounded.min, rounded.max].map(|corner| corner * scale);
        let mut place = PatchPlace {
            min: [0; 2],
            max: [0; 2],
        };
        for axis in 0..2 {
            let [near, far] = corners.map(|corner| {
                let whole = corner[axis].floor();
                let past = ((corner[axis] - whole) / steps.side).round();
                // A side just below a whole pixel rounds up to it.
                if past < (1.0 / steps.side).round() {
                    (whole, past as u32)
                } else {
                    (whole + 1.0, 0)
                }
            });
            if near == far {
                return None;
            }
            key.sides[axis] = near.1;
            key.sides[axis + 2] = far.1;
            place.min[axis] = near.0 as i64 - reach;
            place.max[axis] = far.0 as i64 + 1 + reach;
        }
        for axis in 0..2 {
            let (_, _, size, _) = key.layout();
            let extent = place.max[axis] - place.min[axis];
            if extent < i64::from(size[axis]) {
                key.size[axis] = u32::try_from(extent - 1 - 2 * reach).ok();
                key.size[axis]?;
            }
        }
        let (_, _, [width, height], _) = key.layout();
        Grid::new([0.0, 0.0], [width, height], 1.0).ok()?;
        Some((key, place))
    }
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
        let options = PixelOptions::default().with_method(Method::Direct);
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
        let corner = grid.corner().round();
        let off = (grid.corner() - corner).abs();
        if off
            .cmpgt(corner.abs() * f64::from(f32::EPSILON) + WHOLE)
            .any()
        {
            return Err(Error::OtherGrid { field: "place" });
        }
        let first = [corner.x as i64, corner.y as i64];
        let [left, top, right, bottom] = self.insets.map(i64::from);
        let height = i64::from(grid.height());
        let on_grid = |place: [i64; 2], axis: usize| place[axis].saturating_sub(first[axis]);
        for row in on_grid(place.min, 1).max(0)..on_grid(place.max, 1).min(height) {
            let down = row + first[1] - place.min[1];
            let up = place.max[1] - place.min[1] - down;
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
        part(start, start + left, &mask[..left as usize]);
        if self.stretches[0] {
            part(end - right, end, &mask[left as usize + 1..]);
            let (first, last) = (on_grid(start + left), on_grid(end - right));
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
    }

    #[test]
    fn masks_draw_what_their_shadows_are() {
        let grid = Grid::new([0.0, 0.0], [180, 160], 1.0).unwrap();
        let mut scratch = Scratch::new();
        let paint = Paint::new(Color::BLACK, 1.0).unwrap();
        for shadow in cards() {
            let (key, place) = shadow.key(1.0, Tolerance::ONE_LEVEL).unwrap();
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
            let worst = errors
                .map(|(pixel, exact)| (f32::from(pixel[3]) - exact * 255.0).abs())
                .fold(0.0, f32::max);
            // The tolerance, the mask's rounding and the canvas's.
            assert!(worst <= 2.0, "{key:?}: {worst} levels");
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
                .blend_mask(&grid, &mask, &mut expected, &mut scratch)
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
