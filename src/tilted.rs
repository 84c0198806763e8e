//! `TiltedShadow`: the shadow of a caster that is not parallel to the light.
//!
//! Each of the caster's vertices is a projection circle of its own radius. Seen from a point of the receiver, the caster covers
//! of the light's disc the polygon of the circles' centres in the unit of their radii, about the point.

use core::f64::consts::FRAC_PI_2;
use core::ops::Range;

use glam::{DVec2, DVec3};

use crate::apart::{around, around_points};
use crate::density::{PixelOptions, tilted};
use crate::error::{MAX_COORDINATE, Result};
use crate::grid::Grid;
use crate::outline::Outline;
use crate::paint::Paint;
use crate::pose::Pose;
use crate::scratch::Scratch;
use crate::shadow::Bounds;
use crate::shape::Shape;

/// How much of the light's disc there may be between a curve of a tilted caster and its lines: 1/50 of a level.
const CURVED: f64 = 0.02 / 255.0;

/// The finest that lines are, over the larger side of the caster's box: where it touches its receiver, and where the light is a point,
/// no lines are fine enough for every disc.
const FINEST: f64 = 1.0 / 1_048_576.0;

/// How high a caster must be over its receiver to shade it, over its extent: by more than what `f32` makes of half a turn.
const FLAT: f64 = 4.0 * f32::EPSILON as f64;

/// The radius that a point light is taken to have, against its height: its shadows are hard.
pub(crate) const LEAST_LIGHT: f64 = 1e-7;

/// A projection circle in homogeneous form, finite where the caster meets its receiver and where it meets the light's plane:
/// its centre is `center / scale`, its radius `radius / scale`. All three are linear along a straight edge of the caster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Circle {
    pub(crate) center: DVec2,
    pub(crate) scale: f64,
    pub(crate) radius: f64,
}

impl Circle {
    /// The caster's point on the light's unit disc as seen from a point of the receiver.
    pub(crate) fn seen_from(&self, point: DVec2) -> DVec2 {
        // So far away that only its direction counts.
        const FAR: f64 = 1e-11;
        let offset = self.center - self.scale * point;
        let unit = self.radius.max(FAR * offset.abs().max_element());
        if unit > 0.0 {
            offset / unit
        } else {
            DVec2::ZERO
        }
    }

    /// The same where rounding put a place at which the caster is cut below its receiver.
    fn real(self) -> Self {
        Self {
            radius: if self.radius > 0.0 { self.radius } else { 0.0 },
            ..self
        }
    }

    fn minus(&self, other: &Self) -> Self {
        Self {
            center: self.center - other.center,
            scale: self.scale - other.scale,
            radius: self.radius - other.radius,
        }
    }

    /// The circle a share of the way along a straight edge to another.
    pub(crate) fn lerp(&self, other: &Self, share: f64) -> Self {
        Self {
            center: self.center.lerp(other.center, share),
            scale: self.scale + (other.scale - self.scale) * share,
            radius: self.radius + (other.radius - self.radius) * share,
        }
    }

    /// The circle where a unit is `factor` and the origin at `base`, in new units.
    pub(crate) fn placed(&self, factor: f64, base: DVec2) -> Self {
        Self {
            center: self.center * factor - self.scale * base,
            scale: self.scale,
            radius: self.radius * factor,
        }
    }
}

/// The shadow of a flat caster in any pose on one receiver, in closed form: the area of the light's disc that the caster hides.
/// What lies below the receiver or above the light hides nothing.
#[derive(Debug, Clone)]
pub struct TiltedShadow {
    /// The caster's vertices, loop after loop.
    pub(crate) loops: Vec<Vec<Circle>>,
    /// The circle of the caster's own origin, and how circles change along its x and y.
    pub(crate) plane: [Circle; 3],
}

impl TiltedShadow {
    /// The part of the caster with z in `heights`, each of its points through `circle`.
    pub(crate) fn project(
        shape: &Shape,
        pose: &Pose,
        heights: Range<f64>,
        circle: impl Fn(DVec3) -> Circle,
    ) -> Self {
        let at = |point: DVec2| circle(pose.place(point));
        let origin = at(DVec2::ZERO);
        let plane = [
            origin,
            at(DVec2::X).minus(&origin),
            at(DVec2::Y).minus(&origin),
        ];
        let place = |polygon: Vec<DVec2>| {
            let points: Vec<DVec3> = polygon.into_iter().map(|p| pose.place(p)).collect();
            cut(&cut(&points, |p| p.z - heights.start), |p| {
                heights.end - p.z
            })
        };
        let corners = shape.hull().map_or_else(Vec::new, |(min, max)| {
            place(vec![
                min,
                DVec2::new(max.x, min.y),
                max,
                DVec2::new(min.x, max.y),
            ])
        });
        if corners.is_empty() {
            // Nothing of its box is between receiver and light.
            return Self {
                loops: Vec::new(),
                plane,
            };
        }
        let flatness = corners
            .into_iter()
            .map(|corner| flatness(&circle(corner).real(), &plane))
            .fold(f64::INFINITY, f64::min)
            .max(FINEST * shape.extent());
        let outline = Outline::of_shape(shape, flatness);
        let polygons = outline.polygons(flatness).into_iter().map(place);
        // What lies on its receiver hides none of it, as no level caster does, but for what rounding lifts.
        let is_raised = |points: &Vec<DVec3>| {
            let high = points
                .iter()
                .map(|p| p.z - heights.start)
                .fold(0.0, f64::max);
            around_points(points.iter().map(|p| p.truncate()))
                .is_some_and(|(min, max)| high > FLAT * (max - min).max_element())
        };
        Self {
            loops: polygons
                .filter(|points| points.len() > 2 && is_raised(points))
                .map(|points| points.into_iter().map(&circle).map(Circle::real).collect())
                .collect(),
            plane,
        }
    }

    /// Whether there is no shadow at all: nothing of the caster is between its receiver and the light.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.loops.is_empty()
    }

    /// The smallest box that holds all projection circles, or none for an empty shadow: outside of it the density is 0. A
    /// caster that reaches the light's plane shades without end: such a box ends at [`MAX_COORDINATE`].
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        let (min, max) = self.hull()?;
        Some(Bounds::outwards(min, max))
    }

    pub(crate) fn hull(&self) -> Option<(DVec2, DVec2)> {
        let far = DVec2::splat(MAX_COORDINATE);
        let boxes = self.loops.iter().flatten().map(|circle| {
            let scale = circle.scale.max(f64::MIN_POSITIVE);
            let (center, radius) = (circle.center / scale, circle.radius / scale);
            (
                (center - radius).clamp(-far, far),
                (center + radius).clamp(-far, far),
            )
        });
        around(boxes)
    }

    /// The density at a point (x, y) of the receiver, 0 to 1, in closed form. Lines in place of the caster's curves take
    /// 1/50 of a level of it, or what a millionth of the caster's extent makes where that is more. A point that is not finite has
    /// density 0.
    #[must_use]
    pub fn density_at(&self, point: [f32; 2]) -> f64 {
        let point = DVec2::new(f64::from(point[0]), f64::from(point[1]));
        if !point.is_finite() {
            return 0.0;
        }
        tilted::at_point(&self.loops, point)
    }

    /// As [`Shadow::fill_a8`](crate::Shadow::fill_a8), by the closed form whatever the options' tolerance and method.
    ///
    /// # Errors
    /// A buffer shorter than the grid needs, and options for another grid.
    pub fn fill_a8(
        &self,
        grid: &Grid,
        mask: &mut [u8],
        options: &PixelOptions<'_>,
        scratch: &mut Scratch,
    ) -> Result<()> {
        let mut sink = options.onto_mask(grid, mask, scratch.level())?;
        tilted::fill(self, grid, options.hidden, scratch, &mut sink);
        Ok(())
    }

    /// As [`Shadow::fill_f32`](crate::Shadow::fill_f32), by the closed form whatever the options' tolerance and method.
    ///
    /// # Errors
    /// A buffer shorter than the grid needs, and options for another grid.
    pub fn fill_f32(
        &self,
        grid: &Grid,
        densities: &mut [f32],
        options: &PixelOptions<'_>,
        scratch: &mut Scratch,
    ) -> Result<()> {
        let mut sink = options.onto_densities(grid, densities)?;
        tilted::fill(self, grid, options.hidden, scratch, &mut sink);
        Ok(())
    }

    /// As [`Shadow::blend_rgba8`](crate::Shadow::blend_rgba8), by the closed form whatever the options' tolerance and method.
    ///
    /// # Errors
    /// A buffer shorter than the grid needs, and options for another grid.
    pub fn blend_rgba8(
        &self,
        grid: &Grid,
        pixels: &mut [u8],
        paint: &Paint,
        options: &PixelOptions<'_>,
        scratch: &mut Scratch,
    ) -> Result<()> {
        let mut sink = options.onto_rgba8(grid, pixels, paint, scratch)?;
        tilted::fill(self, grid, options.hidden, scratch, &mut sink);
        Ok(())
    }
}

/// How far from a curve its lines may be about one of its points, in the caster's own plane: seen from where the disc meets them, a strip
/// of that width along a diameter is as much of the disc as they may miss.
fn flatness(at: &Circle, [_, x, y]: &[Circle; 3]) -> f64 {
    let seen = at.center / at.scale.max(f64::MIN_POSITIVE);
    let motion = [x, y].map(|way| (way.center - way.scale * seen).length() + way.radius.abs());
    CURVED * FRAC_PI_2 * at.radius / DVec2::from_array(motion).length()
}

/// The part of a loop where `depth`, linear along its edges, is not negative.
fn cut(points: &[DVec3], depth: impl Fn(&DVec3) -> f64) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(points.len());
    for (index, to) in points.iter().enumerate() {
        let from = &points[(index + points.len() - 1) % points.len()];
        let (a, b) = (depth(from), depth(to));
        if (a < 0.0) != (b < 0.0) {
            kept.push(from.lerp(*to, a / (a - b)));
        }
        if b >= 0.0 {
            kept.push(*to);
        }
    }
    kept
}
