//! The mesh by triangulation: rings at the profile's knots, as the tangent construction has them, are the skeleton that refinement begins
//! with.

use super::profile::{Knot, Pieces};
use super::refine::Refinement;
use super::rounding::{NARROWEST, rounding_levels, step};
use super::tangents::{projection_circles, tangent_loops};
use super::{Incomplete, MeshOptions, ShadowMesh, umbra};
use crate::shadow::Shadow;

impl Shadow {
    /// The mesh by triangulation and refinement.
    pub(super) fn refined(&self, options: &MeshOptions) -> ShadowMesh {
        let mut options = *options;
        let levels = options.tolerance.as_levels();
        let radius = self.radius();
        let facet = self.extent() * FACET;
        let flat = if radius == 0.0 {
            facet
        } else {
            ring_flatness(radius, levels)
        };
        let outline = self.outline(flat);
        let Some((min, max)) = outline.bounds() else {
            return ShadowMesh::empty();
        };
        // Far from the origin the triangulations would lose digits. From a centre that `f32` holds, positions that it
        // holds have exact differences.
        let center = min.midpoint(max).as_vec2().as_dvec2();
        let outline = outline.moved(-center);
        if radius == 0.0 {
            return umbra::mesh(&outline.polygons(facet), center);
        }
        let step = step(min, max);
        if radius < step * NARROWEST {
            // `f32` has no room for the rings of such a penumbra: a hard edge is half of density away from it, and at the
            // tip of a sharp corner all.
            return umbra::mesh(&outline.polygons(facet), center).short_of(Incomplete::Narrow);
        }

        // What rounding leaves nothing of is refined as far as it leaves some.
        let rounding = rounding_levels(step, radius);
        let is_coarser = rounding > levels * REFINED_ROUNDING;
        if is_coarser {
            options.tolerance = options
                .tolerance
                .divided(levels * REFINED_ROUNDING / rounding);
        }
        let levels = options.tolerance.as_levels();
        let pieces = pieces(levels, rounding);
        let mut flat = ring_flatness(radius, levels);
        loop {
            let circles = projection_circles(&outline, radius, flat);
            let count = circles.iter().map(Vec::len).sum::<usize>() * pieces.knots.len();
            // A penumbra that is very narrow for its outline has too many vertices from the start: coarser rings leave
            // refinement room, and what error remains is reported.
            if 2 * count > options.max_vertices && flat < facet {
                flat *= 4.0;
                continue;
            }
            let loops = |knot: &Knot| (*knot, tangent_loops(&circles, knot.t, flat));
            let rings = pieces.knots.iter().map(loops).collect();
            let (field, unsure) = self.field(&outline, levels, center);
            let mut mesh = Refinement::new(field, options, rings).run(center, step, unsure);
            if flat > ring_flatness(radius, levels) {
                mesh.incomplete = mesh.incomplete.and(Some(Incomplete::Vertices));
            }
            if is_coarser {
                mesh.incomplete = mesh.incomplete.or(Some(Incomplete::Narrow));
            }
            return mesh;
        }
    }
}

/// The part of the tolerance that straight pieces of the profile may use. Were it all, as with five pieces for one level,
/// corners would need three times the triangles for the thousandths that are left.
const SLACK: f64 = 0.85;

/// How far chords of rings may be from their arcs, over the penumbra radius and a tolerance of one level. Refinement mends
/// what is too coarse: half of it took a tenth more triangles, twice as much no fewer.
const RING_FLATNESS: f64 = 0.01;

/// The straight pieces of the profile of rings whose vertices are rounded by so many levels.
pub(super) fn pieces(levels: f64, rounding: f64) -> &'static Pieces {
    let taken = if rounding > levels * SPARE {
        TAKEN * rounding
    } else {
        0.0
    };
    Pieces::within((levels - taken) / 255.0 * SLACK)
}

pub(super) fn ring_flatness(radius: f64, levels: f64) -> f64 {
    radius * (RING_FLATNESS * levels).min(COARSEST_RING)
}

/// The same at large tolerances: beyond, rings could cross.
const COARSEST_RING: f64 = 0.02;

/// The most of the tolerance that the rounding of vertices may be where triangles are refined.
const REFINED_ROUNDING: f64 = 0.5;

/// What it may take that straight pieces of the profile need not make up for.
const SPARE: f64 = 1.0 / 32.0;

/// What they make up for, over it: with all else that is taken of the tolerance as much as before is left beside them.
const TAKEN: f64 = 1.2;

/// How far the chords of a hard shadow's arcs may be from them, over its extent.
pub(super) const FACET: f64 = 1e-5;
