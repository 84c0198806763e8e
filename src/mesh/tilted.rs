//! Meshes of casters that are not parallel to the light: the tangent construction with circles of many radii.

mod cells;
mod fewer;

use core::f64::consts::{FRAC_2_PI, TAU};

use glam::DVec2;
use libm::{cos, sin};

pub(super) use cells::TiltedCells;
use fewer::{fewer, fewer_within};

use super::cells::NOISE;
use super::field::{CURVED, FIELD_SHARE, Field};
use super::profile::Knot;
use super::refine::Refinement;
use super::rounding::{NARROWEST, rounding_levels, step};
use super::skeleton::{pieces, ring_flatness};
use super::tangents::{ProjectionCircle, tangent_loops, tangent_normal};
use super::{Incomplete, MeshOptions, ShadowMesh, umbra};
use crate::error::MAX_COORDINATE;
use crate::outline::{Winding, resolve_loops, sides};
use crate::path::{FillRule, arc_steps};
use crate::tilted::{Circle, TiltedShadow};

/// The smallest radius for which there are rings, over the largest one.
const SMALLEST: f64 = 1.0 / 64.0;

/// The smallest radius that samples go by: triangles where it is smaller are small themselves.
const SAMPLED: f64 = 1.0 / 8.0;

/// The part of that where the caster is seen edge-on from within the shadow: what is seen of it there is as narrow as the caster is flat,
/// and crests of the error between samples were an eighth higher than any of them.
const EDGE_ON: f64 = 0.5;

impl TiltedShadow {
    /// Triangles with a density at each vertex, within the tolerance of [`TiltedShadow::density_at`] wherever they are
    /// interpolated and outside of them, unless the mesh says what it is [short of](ShadowMesh::incomplete).
    ///
    /// It is not complete where the caster touches the receiver, since the penumbra narrows there to nothing: what is wrong
    /// is as small as `f32` allows; and not where the light is a point, or next to one: then it fills the hard shadow, and its error
    /// is 255 levels. The shadow of a caster that reaches the light's plane has no end, and no mesh: it comes empty and with that
    /// error too.
    ///
    /// ```
    /// use penumbral::{Light, Pose, Shape, Tolerance};
    ///
    /// let card = Shape::rect(50.0, 60.0, 60.0, 40.0)?;
    /// let flipping = Pose::turned(40.0, [80.0, 80.0], [0.0, 1.0], 0.6)?;
    /// let light = Light::new([80.0, 30.0, 300.0], 120.0)?;
    /// let mesh = light.cast_posed(&card, &flipping, 0.0)?.mesh(Tolerance::levels(2.0)?);
    /// assert!(mesh.is_complete() && mesh.error_levels() <= 2.0);
    /// # Ok::<(), penumbral::Error>(())
    /// ```
    #[must_use]
    pub fn mesh(&self, options: impl Into<MeshOptions>) -> ShadowMesh {
        let options = options.into();
        let Some((min, max)) = self.hull() else {
            return ShadowMesh::empty();
        };
        if min.abs().max(max.abs()).max_element() >= MAX_COORDINATE {
            return ShadowMesh::empty().short_of(Incomplete::Endless);
        }
        // As for level casters: about a centre that `f32` holds.
        let center = min.midpoint(max).as_vec2().as_dvec2();
        let place = |circle: &Circle| circle.placed(1.0, center);
        let seen = Self {
            loops: self
                .loops
                .iter()
                .map(|circles| circles.iter().map(place).collect())
                .collect(),
            plane: self.plane.each_ref().map(place),
        };
        let levels = options.tolerance.as_levels();
        let share = ring_flatness(1.0, levels);
        // As for level casters: rings' vertices are refinement's to add.
        let ring = |circles: &Vec<Circle>| {
            let (circles, _) = fewer(circles, share);
            circles.iter().map(projected).collect()
        };
        let circles: Vec<Vec<ProjectionCircle>> = seen.loops.iter().map(ring).collect();
        let radii = circles.iter().flatten().map(|circle| circle.radius);
        let (least, most) = radii.fold((f64::MAX, 0.0), |(least, most), radius| {
            (radius.min(least), radius.max(most))
        });
        let step = step(min, max);
        if most < step * NARROWEST {
            let centers = |circles: &Vec<ProjectionCircle>| {
                circles.iter().map(|circle| circle.center).collect()
            };
            let loops: Vec<Vec<DVec2>> = circles.iter().map(centers).collect();
            let loops = resolve_loops(&loops, Winding::Rule(FillRule::NonZero), false);
            return umbra::mesh(&loops, center).short_of(Incomplete::Narrow);
        }
        let radius = least.max(most * SMALLEST);
        let facing = seen.facing([min - center, max - center]);
        let pieces = pieces(levels, rounding_levels(step, radius));
        let count = circles.iter().map(Vec::len).sum::<usize>() * pieces.knots.len();
        let has_rings = least == radius && 2 * count <= options.max_vertices;
        // Parts of the shadow may see the caster from above, and others from below; or all rings meet where the caster touches its
        // receiver, or are too many, or cross where it is sharp: the outermost is all that is taken of them.
        let outermost = || {
            let knot = |t: f64| Knot {
                t,
                value: f64::from(u8::from(t > 0.0)),
            };
            vec![
                (knot(-1.0), reached(&circles, share)),
                (knot(1.0), Vec::new()),
            ]
        };
        let all_rings = |faces_up: bool| {
            let mut circles = circles.clone();
            if !faces_up {
                circles.iter_mut().for_each(|circles| circles.reverse());
            }
            let ring = |knot: &Knot| (*knot, tangent_loops(&circles, knot.t, radius * share));
            pieces.knots.iter().map(ring).collect()
        };
        let rings = facing.filter(|_| has_rings).map(all_rings);
        // Where the caster touches its receiver there is no end to samples.
        let part = if facing.is_some() || least < radius {
            1.0
        } else {
            EDGE_ON
        };
        let sampled = least.max(most * SAMPLED) * part;
        // Where the penumbra is narrower than samples go by, rounding counts for more.
        let rounding = step * FRAC_2_PI * (1.0 / radius - 1.0 / sampled);
        let (loops, lost) = fewer_within(&seen.loops, CURVED * FIELD_SHARE * levels / 255.0);
        let unsure = rounding + lost + NOISE;
        let field = Field::Tilted {
            cells: TiltedCells::new(&loops, [min - center, max - center], sampled),
            radius: sampled,
        };
        let mut refinement = Refinement::new(field, options, rings.unwrap_or_else(outermost));
        if refinement.is_broken() {
            refinement = refinement.with_rings(outermost());
        }
        refinement.run(center, step, unsure)
    }

    /// Whether all points of a box see the caster's loops turn left where y points up, or all of them right, or some so and others
    /// so.
    fn facing(&self, [min, max]: [DVec2; 2]) -> Option<bool> {
        // Seen from a point, the caster's plane is mapped onto the light's by these three: the sign of their determinant tells. It is
        // linear in the point.
        let turns_left = |point: DVec2| {
            let [origin, x, y] = self.plane.map(|circle| {
                let offset = circle.center - circle.scale * point;
                offset.extend(circle.radius)
            });
            origin.dot(x.cross(y)) > 0.0
        };
        let first = turns_left(min);
        let others = [max, DVec2::new(min.x, max.y), DVec2::new(max.x, min.y)];
        others
            .into_iter()
            .all(|point| turns_left(point) == first)
            .then_some(first)
    }
}

/// The loops round all that a light seen through a caster's edges reaches: the circles round its vertices, what lies between two
/// neighbours and the caster as its vertices' centres have it. Chords are within `share` of their circle's radius.
fn reached(circles: &[Vec<ProjectionCircle>], share: f64) -> Vec<Vec<DVec2>> {
    let mut parts = Vec::new();
    let mut push = |mut points: Vec<DVec2>| {
        let area: f64 = sides(&points).map(|(a, b)| a.perp_dot(b)).sum();
        if area < 0.0 {
            points.reverse();
        }
        parts.push(points);
    };
    for of_loop in circles {
        push(of_loop.iter().map(|circle| circle.center).collect());
        for (from, to) in sides(of_loop) {
            let steps = arc_steps(from.radius, TAU, share * from.radius);
            let at = |step: u32| {
                let angle = TAU * f64::from(step) / f64::from(steps);
                from.center + DVec2::new(cos(angle), sin(angle)) * from.radius
            };
            push((0..steps).map(at).collect());
            if from.center.distance(to.center) > (from.radius - to.radius).abs() {
                let [left, right] = [1.0, -1.0].map(|side| tangent_normal(from, to, 1.0, side));
                push(vec![
                    from.center + left * from.radius,
                    from.center + right * from.radius,
                    to.center + right * to.radius,
                    to.center + left * to.radius,
                ]);
            }
        }
    }
    resolve_loops(&parts, Winding::Positive, true)
}

fn projected(circle: &Circle) -> ProjectionCircle {
    ProjectionCircle {
        center: circle.center / circle.scale,
        radius: circle.radius / circle.scale,
    }
}
