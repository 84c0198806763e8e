//! Polygons that cross, overlap and nest, resolved into loops that do not.
//!
//! `i_overlay` does it on a grid of integers. With 64 bits that grid has 2^61 steps over the polygons' extent, finer
//! than `f64` itself, so its rounding adds nothing to the tolerance.

use glam::DVec2;
use i_overlay::core::fill_rule::FillRule as OverlayRuleOfFill;
use i_overlay::core::overlay::ShapeType;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::overlay::{FloatOverlay, OverlayOptions};
use i_overlay::i_float::adapter::FloatPointAdapter;

use super::{Outline, closed_lines};
use crate::path::FillRule;

/// Which winding numbers are inside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Winding {
    /// Those of a path's fill rule.
    Rule(FillRule),
    /// Those above 0, of polygons already oriented.
    Positive,
}

/// The outline of what finite polygons cover.
pub(crate) fn resolve(polygons: &[Vec<DVec2>], winding: Winding) -> Outline {
    let mut outline = Outline {
        loops: resolve_loops(polygons, winding, false)
            .iter()
            .map(|polygon| closed_lines(polygon))
            .collect(),
    };
    outline.loops.retain(|edges| edges.len() > 2);
    outline.canonical()
}

/// The loops of what finite polygons cover: counter-clockwise round the inside where y points up. Vertices on straight
/// lines are dropped unless they are to be kept.
pub(crate) fn resolve_loops(
    polygons: &[Vec<DVec2>],
    winding: Winding,
    keep_collinear: bool,
) -> Vec<Vec<DVec2>> {
    let contours = contours(polygons);
    let mut options = OverlayOptions::default();
    options.preserve_input_collinear = keep_collinear;
    options.preserve_output_collinear = keep_collinear;
    let count = contours.iter().map(Vec::len).sum();
    let adapter =
        FloatPointAdapter::<[f64; 2], i64>::with_iter_conservative(contours.iter().flatten());
    let rule = match winding {
        Winding::Rule(FillRule::NonZero) => OverlayRuleOfFill::NonZero,
        Winding::Rule(FillRule::EvenOdd) => OverlayRuleOfFill::EvenOdd,
        Winding::Positive => OverlayRuleOfFill::Positive,
    };
    FloatOverlay::new_custom(adapter, options, Default::default(), count)
        .unsafe_add_source(&contours, ShapeType::Subject)
        .overlay(OverlayRule::Subject, rule)
        .into_iter()
        .flatten()
        .map(|contour| contour.into_iter().map(DVec2::from_array).collect())
        .collect()
}

/// The loops of what two sets of loops both cover, each of them as [`resolve_loops`] gives them.
pub(crate) fn intersect_loops(a: &[Vec<DVec2>], b: &[Vec<DVec2>]) -> Vec<Vec<DVec2>> {
    let (a, b) = (contours(a), contours(b));
    let count = a.iter().chain(&b).map(Vec::len).sum();
    let points = a.iter().chain(&b).flatten();
    let adapter = FloatPointAdapter::<[f64; 2], i64>::with_iter_conservative(points);
    FloatOverlay::new_custom(
        adapter,
        OverlayOptions::default(),
        Default::default(),
        count,
    )
    .unsafe_add_source(&a, ShapeType::Subject)
    .unsafe_add_source(&b, ShapeType::Clip)
    .overlay(OverlayRule::Intersect, OverlayRuleOfFill::NonZero)
    .into_iter()
    .flatten()
    .map(|contour| contour.into_iter().map(DVec2::from_array).collect())
    .collect()
}

fn contours(polygons: &[Vec<DVec2>]) -> Vec<Vec<[f64; 2]>> {
    polygons
        .iter()
        .map(|polygon| polygon.iter().map(|p| p.to_array()).collect())
        .collect()
}
