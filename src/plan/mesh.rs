//! What triangles cost: those of a rounded rectangle and along a gentle curve are strips, those of small detail halved squares, and all
//! others are refined until they are right.

use super::{COSTS, Candidate, Method};
use crate::mesh::halving;
use crate::shadow::Shadow;

pub(super) fn candidate(shadow: &Shadow, levels: f64) -> Candidate {
    let radius = shadow.radius();
    // Four times the tolerance takes a quarter of the triangles, but half of the time: rings and the first triangles stay.
    let coarser = libm::sqrt(levels);
    let (cost_ns, why) = if radius == 0.0 {
        (
            COSTS.hard_triangle * facets(shadow),
            "triangles are asked for, and there is no penumbra",
        )
    } else if shadow.rounded().is_some() {
        (
            COSTS.strips / coarser,
            "triangles are asked for: strips about a rounded rectangle",
        )
    } else if let Some(samples) = halving::forecast(shadow, levels) {
        (
            COSTS.sample * samples as f64,
            "triangles are asked for: squares are halved, as the outline's detail is small",
        )
    } else if shadow.is_gentle() {
        (
            COSTS.gentle / coarser,
            "triangles are asked for: strips along a gentle curve",
        )
    } else {
        (
            COSTS.triangle * triangles(shadow, radius) / coarser,
            "triangles are asked for: refined until they are right",
        )
    };
    Candidate {
        method: Method::Mesh,
        error_levels: levels,
        cost_ns,
        why,
    }
}

/// About how many triangles fill an outline.
fn facets(shadow: &Shadow) -> f64 {
    let census = shadow.census();
    census.lines + CURVE_FACETS * census.curves + ARC_FACETS * census.arcs
}

/// About how many triangles a penumbra takes at one level: so many a corner, or where corners are the joints of a curve and
/// closer than that, so many a penumbra radius along it; and so many a radius along arcs.
fn triangles(shadow: &Shadow, radius: f64) -> f64 {
    let census = shadow.census();
    let (lines, length) = (
        census.lines + CURVE_FACETS * census.curves,
        census.line_length + census.curve_length,
    );
    let corners = (CORNER * lines).min(CURVE * length / radius);
    (corners + ARC * census.arc_length / radius).min(MOST)
}

/// Estimates from the fixtures' meshes: a forecast may be several times off.
const CORNER: f64 = 200.0;
const CURVE: f64 = 150.0;
const ARC: f64 = 70.0;

/// About how many chords a curve has.
const CURVE_FACETS: f64 = 40.0;

/// Chords of an arc of a hard shadow.
const ARC_FACETS: f64 = 300.0;

/// Meshes have no more vertices than 65,536, unless an outline has.
const MOST: f64 = 131_072.0;
