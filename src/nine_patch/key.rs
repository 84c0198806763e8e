//! What a rounded rectangle's mask is kept by.
//!
//! Such a shadow depends on radii, on where in their pixels its four sides lie, and on its size only where corners meet.
//! The key holds these in steps so small that all shadows of one key are alike within the tolerance.

use core::f64::consts::PI;

use glam::DVec2;
use libm::{exp, log, log1p};

use crate::density::rounded::{LARGEST, Rounded};
use crate::grid::{Grid, LEAST_SCALE, MOST_SCALE};
use crate::shadow::Shadow;
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
    pub(super) size: [Option<u32>; 2],
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

/// Shares of the tolerance that rounding to steps may take where a disc sees one straight side: of a side's place, of the penumbra
/// radius, of corners' radii. It sees at most its own circumference of an outline, which moves density π times as much as such a
/// side does, 2 π times where the radius grows, and at corners twice: all of this adds up to 0.8 of the tolerance. The rest is for
/// drawing the mask.
const SIDE: f64 = 0.11;
const RADIUS: f64 = 0.055;
const CORNER: f64 = 0.055;
const DRAWN: f64 = 0.2;

/// The sizes of the steps.
struct Steps {
    radius: f64,
    side: f64,
    corner: f64,
}

impl ShadowKey {
    /// How wrong the mask may be before it is rounded: what steps leave of the tolerance.
    pub(super) fn drawn_within(&self) -> Tolerance {
        Tolerance::at_least(DRAWN * self.tolerance() * 255.0)
    }

    /// In density.
    fn tolerance(&self) -> f64 {
        f64::from(self.levels) / 65_536.0 / 255.0
    }

    /// The penumbra radius in pixels, and the steps of the rest. A step is twice what rounding may do: a straight side moved by d
    /// moves the density by 2 d / (π r), by d where that is more than the pixel's own width allows; a radius larger by its
    /// share s moves it by s / π there; a corner's radius larger by d moves the outline by (sqrt 2 - 1) d.
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
    pub(super) fn layout(&self) -> (Rounded, f64, [u32; 2], [u32; 4]) {
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
    /// of a rounded rectangle with circular corners, this is thinner than the steps that keys round to or larger than 100,000 pixels, no
    /// [`Grid`] has so many pixels a unit, or one mask would be larger than a picture may be. The mask is within the tolerance before it is
    /// rounded, or within 0.8 level where the penumbra is narrower than 3 px, as [`Method::Direct`](crate::plan::Method::Direct) is.
    ///
    /// Cards that scroll by whole pixels under a directional light have one key each. Under any other light a shadow is larger than its card
    /// and moves by more, so that its sides are elsewhere in their pixels at each step: there it pays to draw it anew, as it does where
    /// cards move by parts of pixels.
    ///
    /// ```
    /// use penumbral::{Color, Grid, Light, NinePatch, Paint, Scratch, Shape, Tolerance};
    ///
    /// let card = Shape::rounded_rect(24.0, 40.0, 312.0, 160.0, 12.0)?;
    /// let shadow = Light::android(360.0)?.cast(&card, 8.0, 0.0)?;
    /// let mut scratch = Scratch::new();
    /// let (key, place) = shadow.key(1.0, Tolerance::ONE_LEVEL).unwrap();
    /// // Kept by `key`, for this card wherever it has the same place in its pixels.
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
        if (rounded.max - rounded.min).max_element() * scale > LARGEST {
            return None;
        }
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
