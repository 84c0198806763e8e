//! Rounded rectangles and circles without a triangulator: rings from the penumbra's outer edge to the umbra, or to the
//! caster's middle where there is none, and strips of triangles between them.
//!
//! Each corner has a pole, so far inside that no more than this corner is felt beyond it, or else on the middle line of the
//! rectangle. Rays from the poles cross the penumbra, and each ring joins the knots of one number on all of them. So every
//! ray has its own best knots: a sharp corner, a round one and a straight edge differ, but need about as many.
//!
//! What comes out is measured against the closed form and made finer until it is within the tolerance. Meshes depend on the
//! corners over the penumbra radius only, and are kept for the next shadow that has the same.

mod build;
mod corner;
mod fan;
mod ray;

use glam::DVec2;

use self::build::{Builder, Template};
use self::corner::Corner;
use super::{MeshSink, MeshVertex};
use crate::density::rounded::Rounded;
use crate::error::Result;

/// Meshes that are kept.
const KEPT: usize = 16;

/// What strips leave from mesh to mesh.
#[derive(Debug, Default)]
pub(crate) struct StripScratch {
    builder: Builder,
    templates: Vec<Template>,
    /// The templates' indices, the last one used first.
    recent: Vec<usize>,
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
        let radii = [2, 3, 0, 1].map(|corner: usize| coarsely(rounded.radii[corner]));
        Some(Self {
            center: rounded.min.midpoint(rounded.max),
            half,
            radius,
            corners: corners(DVec2::new(coarsely(half.x), coarsely(half.y)), radii)?,
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
        let Some(template) = scratch.template(&self.corners, levels) else {
            return Ok(None);
        };
        let fits = template.vertices.len() <= max_vertices;
        if !fits || template.thinnest * self.radius < step * THINNEST {
            return Ok(None);
        }
        sink.begin(template.vertices.len(), template.triangles.len())?;
        let corners = SIGNS.map(|sign| self.center + sign * self.half);
        for vertex in &template.vertices {
            let position = corners[vertex.quarter] + vertex.offset * self.radius;
            sink.vertex(MeshVertex {
                position: position.as_vec2().to_array(),
                density: vertex.density,
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
    /// The template for corners, made unless it is kept.
    fn template(&mut self, corners: &[Corner; 4], levels: f64) -> Option<&Template> {
        let Self {
            builder,
            templates,
            recent,
        } = self;
        let found = recent
            .iter()
            .position(|&i| templates[i].is_for(corners, levels));
        let place = found.unwrap_or_else(|| {
            if templates.len() < KEPT {
                recent.push(templates.len());
                templates.push(Template::default());
            }
            let last = recent.len() - 1;
            builder.build(corners, levels, &mut templates[recent[last]]);
            last
        });
        recent[..=place].rotate_right(1);
        let template = &templates[recent[0]];
        (template.error_levels <= levels).then_some(template)
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
    let apart =
        |a: usize, b: usize, half: f64| radii[a] + radii[b] + 2.0 * REACH + APART <= 2.0 * half;
    let separate =
        apart(0, 1, half.x) && apart(2, 3, half.x) && apart(0, 3, half.y) && apart(1, 2, half.y);
    Some([0, 1, 2, 3].map(|i: usize| {
        if separate {
            return Corner {
                tip: DVec2::splat(radii[i] + REACH),
                far: DVec2::NEG_INFINITY,
                radii: [radii[i], 0.0, 0.0, 0.0],
            };
        }
        let tip = half.min(DVec2::splat(largest + REACH));
        // Mirrored corners see the others the other way round.
        let seen = if i.is_multiple_of(2) {
            [i, i + 1, i + 2, i + 3]
        } else {
            [i, i + 3, i + 2, i + 1]
        };
        Corner {
            tip,
            far: tip - 2.0 * half,
            radii: seen.map(|j| radii[j % 4]),
        }
    }))
}

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
