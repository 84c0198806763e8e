//! Rounded rectangles and circles without a triangulator: rings from the penumbra's outer edge to the umbra, or to the
//! caster's middle where there is none, and strips of triangles between them.
//!
//! Each corner has a pole, so far inside that no more than this corner is felt beyond it, or else on the middle line of the
//! rectangle. Rays from the poles cross the penumbra, and each ring joins the knots of one number on all of them. So every
//! ray has its own best knots: a sharp corner, a round one and a straight edge differ, but need about as many.
//!
//! What comes out is measured against the closed form and made finer until it is within the tolerance. Meshes depend on the
//! corners over the penumbra radius only, and are kept for the next shadow that has the same. Where the ends along an axis do
//! not feel each other, the length along it is none of what they depend on. Where no corner feels another and all are equal,
//! radii go in [steps](steps_beside): from one to the next the vertices of the same triangles move straight on.

mod build;
mod corner;
mod fan;
pub(super) mod join;
mod ray;

use glam::DVec2;

use self::build::{Builder, Span, Template};
use self::corner::Corner;
use super::profile::Profile;
use super::rounding::{power_of_two_below, rounding_levels, step};
use super::{MeshOptions, MeshQuality, MeshSink, MeshVertex};
use crate::density::rounded::Rounded;
use crate::error::Result;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// Templates that are kept: enough for corners that rise from next to the ground to high above it, in some megabytes.
const KEPT: usize = 64;

/// What strips leave from mesh to mesh.
#[derive(Debug, Clone, Default)]
pub(crate) struct StripScratch {
    builder: Builder,
    templates: Vec<Template>,
    /// The templates' indices, the last one used first.
    recent: Vec<usize>,
    /// How often a template was there, and how often one had to be made.
    pub(super) hits: u64,
    pub(super) misses: u64,
}

/// The part of the tolerance that strips leave to the rounding of their vertices, and the most that they do where that takes more: a
/// triangulation would take a hundred times as long.
const ROUNDING_SHARE: f64 = 1.0 / 256.0;
const MOST_ROUNDING: f64 = 0.25;

impl Shadow {
    /// The mesh in strips, if the shadow is one of those that have them.
    pub(super) fn strips(
        &self,
        options: &MeshOptions,
        scratch: &mut Scratch,
        sink: &mut impl MeshSink,
    ) -> Result<Option<MeshQuality>> {
        let radius = self.radius();
        let disc = options.profile == Profile::Disc && radius > 0.0;
        let Some(rounded) = self.rounded().filter(|_| disc) else {
            return Ok(None);
        };
        let step = step(rounded.min, rounded.max);
        let Some(strips) = Strips::of(&rounded, radius) else {
            return Ok(None);
        };
        let levels = options.tolerance.as_levels();
        let rounding = rounding_levels(step, radius);
        // In powers of two, so that shadows at other places go by the same template.
        let share = if rounding > levels * ROUNDING_SHARE {
            2.0 * power_of_two_below(rounding)
        } else {
            levels * ROUNDING_SHARE
        };
        if share > levels * MOST_ROUNDING {
            return Ok(None);
        }
        let error = strips.mesh(
            levels - share,
            step,
            options.max_vertices,
            &mut scratch.meshes.strips,
            sink,
        )?;
        Ok(error.map(|error| MeshQuality::new(error + rounding, None)))
    }
}

/// A rounded rectangle of which strips can be made.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strips {
    center: DVec2,
    /// Half of its sides, in scene units.
    half: DVec2,
    radius: f64,
    /// Its corners by growing angles, that of most x and y first.
    corners: [Corner; 4],
}

impl Strips {
    pub(super) fn of(rounded: &Rounded, radius: f64) -> Option<Self> {
        let half = (rounded.max - rounded.min) / 2.0;
        // Moved about, a shape keeps its size to some last digits: without them it keeps its template.
        let coarsely = |length: f64| (length / radius * FINENESS).round() / FINENESS;
        let sides = DVec2::new(coarsely(half.x), coarsely(half.y));
        if sides.min_element() == 0.0 {
            return None;
        }
        let radii = [2, 3, 0, 1].map(|corner: usize| coarsely(rounded.radii[corner]));
        Some(Self {
            center: rounded.min.midpoint(rounded.max),
            half,
            radius,
            corners: corners(sides, radii)?,
        })
    }

    /// Gives a sink the triangles within `levels`, and says how wrong they are at most, in levels; gives it none where
    /// none were found, where there are more than `max_vertices`, and where steps of `step` (scene units) are too coarse.
    pub(super) fn mesh(
        &self,
        levels: f64,
        step: f64,
        max_vertices: usize,
        scratch: &mut StripScratch,
        sink: &mut impl MeshSink,
    ) -> Result<Option<f64>> {
        let Some((template, place)) = scratch.template(&self.corners, levels) else {
            return Ok(None);
        };
        let fits = template.vertices.len() <= max_vertices;
        if !fits || template.thinnest * self.radius < step * THINNEST {
            return Ok(None);
        }
        sink.begin(template.vertices.len(), template.triangles.len())?;
        let corners = SIGNS.map(|sign| self.center + sign * self.half);
        for vertex in &template.vertices {
            let offset = vertex.offset + vertex.shift * place;
            let position = corners[vertex.quarter] + offset * self.radius;
            let density = vertex.density + vertex.rise * place as f32;
            sink.vertex(MeshVertex {
                position: position.as_vec2().to_array(),
                density: density.clamp(0.0, 1.0),
            });
        }
        for &corners in &template.triangles {
            sink.triangle(corners);
        }
        Ok(Some(template.error_levels))
    }
}

/// Steps of lengths in a penumbra radius: less than 0.001 level each.
const FINENESS: f64 = 1_048_576.0;

/// The least height of a triangle, in steps of `f32`: rounding its vertices leaves it its orientation.
const THINNEST: f64 = 4.0;

impl StripScratch {
    /// A template for corners, made unless it is kept, and where they are from its span's beginning to its end.
    fn template(&mut self, corners: &[Corner; 4], levels: f64) -> Option<(&Template, f64)> {
        let (mut place, mut found, mut made) = (0.0, None, false);
        if let Some((span, at)) = span_of(corners).filter(|_| levels >= FINEST_SPANNED) {
            found = self.within(&span, levels, &mut made);
            place = at;
        }
        if found.is_none() {
            found = self.within(&[*corners; 2], levels, &mut made);
            place = 0.0;
        }
        *if made {
            &mut self.misses
        } else {
            &mut self.hits
        } += 1;
        found.map(|index| (&self.templates[index], place))
    }

    /// Which template is a span's, made unless it is kept; none where there is no mesh within so many levels.
    fn within(&mut self, span: &Span, levels: f64, made: &mut bool) -> Option<usize> {
        let Self {
            builder,
            templates,
            recent,
            ..
        } = self;
        let found = recent
            .iter()
            .position(|&i| templates[i].is_for(span, levels));
        *made |= found.is_none();
        let place = found.unwrap_or_else(|| {
            if templates.len() < KEPT {
                recent.push(templates.len());
                templates.push(Template::default());
            }
            let last = recent.len() - 1;
            builder.build(span, levels, &mut templates[recent[last]]);
            last
        });
        recent[..=place].rotate_right(1);
        (templates[recent[0]].error_levels <= levels).then_some(recent[0])
    }
}

/// The least tolerance at which corners share spans, in levels: of less, how density bends within one takes so much that there
/// would be more triangles.
const FINEST_SPANNED: f64 = 0.75;

/// The span that equal corners which are apart are in, and where they are from its beginning to its end.
fn span_of(corners: &[Corner; 4]) -> Option<(Span, f64)> {
    let [corner, others @ ..] = corners;
    if corner.far != DVec2::NEG_INFINITY || others.iter().any(|other| other != corner) {
        return None;
    }
    let radius = corner.radii[0];
    let [from, to] = steps_beside(radius)?;
    Some((
        [from, to].map(|radius| [apart(radius); 4]),
        (radius - from) / (to - from),
    ))
}

/// The steps that a corner's radius, in penumbra radii, is between: eighths up to 1, and eighths of each power of two from
/// there on. Sharp corners are the same whatever the penumbra radius and need none. Just above 1 the umbra's corner begins to be
/// round: there steps are as long as it is, and none where it is next to nothing.
fn steps_beside(radius: f64) -> Option<[f64; 2]> {
    if radius == 0.0 {
        return None;
    }
    if radius > 1.0 && radius < 1.0 + STEP {
        let step = power_of_two_below(radius - 1.0);
        return (step >= LEAST_STEP).then_some([1.0 + step, 1.0 + 2.0 * step]);
    }
    let step = STEP * power_of_two_below(radius.max(1.0));
    // 1 itself has the sharp umbra of what is below.
    let from = if radius == 1.0 {
        1.0 - STEP
    } else {
        (radius / step).floor() * step
    };
    Some([from, from + step])
}

/// The longest step up to 1, and the shortest one above.
const STEP: f64 = 1.0 / 8.0;
const LEAST_STEP: f64 = 1.0 / 64.0;

/// A corner that is not felt by any other.
fn apart(radius: f64) -> Corner {
    Corner {
        tip: DVec2::splat(radius + REACH),
        far: DVec2::NEG_INFINITY,
        radii: [radius, 0.0, 0.0, 0.0],
    }
}

/// The corners of a rounded rectangle, `half` of its sides and their radii in penumbra radii, if rings of it never cross.
fn corners(half: DVec2, radii: [f64; 4]) -> Option<[Corner; 4]> {
    let largest = radii.into_iter().fold(0.0, f64::max);
    let room = half.min_element();
    // An ulp more is rounding.
    if largest > room * (1.0 + 1e-9) {
        return None;
    }
    let radii = radii.map(|radius| radius.min(room));
    let room =
        |a: usize, b: usize, half: f64| radii[a] + radii[b] + 2.0 * REACH + APART <= 2.0 * half;
    let separate =
        room(0, 1, half.x) && room(2, 3, half.x) && room(0, 3, half.y) && room(1, 2, half.y);
    if separate {
        return Some(radii.map(apart));
    }
    // The corners at an end have their poles beside one another, so that their rings meet.
    let reach = |end: [usize; 2]| radii[end[0]].max(radii[end[1]]) + REACH;
    let ends_apart = |axis: usize| {
        let [more, less] = ENDS[axis].map(reach);
        more + less + APART <= 2.0 * half[axis]
    };
    let ends_apart = [0, 1].map(ends_apart);
    Some([0, 1, 2, 3].map(|i: usize| {
        let mut tip = half.min(DVec2::splat(largest + REACH));
        let mut far = tip - 2.0 * half;
        // Mirrored corners see the others the other way round.
        let seen = if i.is_multiple_of(2) {
            [i, i + 1, i + 2, i + 3]
        } else {
            [i, i + 3, i + 2, i + 1]
        };
        let mut radii = seen.map(|j| radii[j % 4]);
        for axis in (0..2).filter(|&axis| ends_apart[axis]) {
            let [more, less] = ENDS[axis];
            tip[axis] = reach(if more.contains(&i) { more } else { less });
            far[axis] = f64::NEG_INFINITY;
            (radii[2], radii[1 + 2 * axis]) = (0.0, 0.0);
        }
        Corner { tip, far, radii }
    }))
}

/// The corners at the end of more x and of less, and of more y and of less.
const ENDS: [[[usize; 2]; 2]; 2] = [[[0, 3], [1, 2]], [[0, 1], [2, 3]]];

/// How far from where a corner begins it is no longer felt, in penumbra radii: a disc there that touched it would be met
/// by both or by neither of its edges, as rounding goes.
const REACH: f64 = 1.0 + 1.0 / 1024.0;

/// How far apart corners are at least that are not felt by each other: their vertices stay apart as well.
const APART: f64 = 1.0 / 64.0;

/// Where the corners are from the middle.
const SIGNS: [DVec2; 4] = [
    DVec2::ONE,
    DVec2::new(-1.0, 1.0),
    DVec2::NEG_ONE,
    DVec2::new(1.0, -1.0),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_hold_what_is_in_them_and_meet() {
        for i in 1..40_000 {
            let radius = f64::from(i) / 4_096.0;
            let Some([from, to]) = steps_beside(radius) else {
                assert!(radius > 1.0 && radius < 1.0 + LEAST_STEP, "{radius}");
                continue;
            };
            assert!(from <= radius && radius <= to, "{radius}: {from} to {to}");
            assert!(to - from <= STEP * radius.max(1.0), "{radius}");
            // The umbra's corner is sharp all the way, or round all the way.
            assert!(to <= 1.0 || from > 1.0, "{radius}: {from} to {to}");
            let middle = f64::midpoint(from, to);
            assert_eq!(steps_beside(middle), Some([from, to]));
        }
        assert_eq!(steps_beside(0.0), None);
        assert_eq!(steps_beside(1.0), Some([1.0 - STEP, 1.0]));
    }
}
