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
use crate::apart::around_points;
use crate::path::FillRule;

/// How far off a straight line, over the extent of all there is, the overlay may leave a point that belongs on it: 2^-43, some
/// hundred times what its rounding makes. A million times less than the flattest curve is cut to.
const ROUNDING: f64 = 1.0 / 8_796_093_022_208.0;

/// Which winding numbers are inside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Winding {
    /// Those of a path's fill rule.
    Rule(FillRule),
    /// Those above 0, of polygons already oriented.
    Positive,
}

/// The outline of what finite polygons cover.
///
/// The overlay drops vertices that are on a straight line to the last bit. Where lines cross on a side it may leave others, and
/// slivers, and which of them depends on where contours begin: they go here.
pub(crate) fn resolve(polygons: &[Vec<DVec2>], winding: Winding) -> Outline {
    let (min, max) = around_points(polygons.iter().flatten().copied()).unwrap_or_default();
    let thinnest = (max - min).max_element() * ROUNDING;
    let loops = resolve_loops(polygons, winding, false)
        .iter()
        .map(|polygon| straightened(polygon, thinnest))
        .filter(|polygon| polygon.len() > 2)
        .map(|polygon| closed_lines(&polygon))
        .collect();
    Outline { loops }.canonical()
}

/// A polygon without the vertices that make triangles no higher than `thinnest` with those beside them: corners that turn by
/// nothing, and spikes.
fn straightened(polygon: &[DVec2], thinnest: f64) -> Vec<DVec2> {
    let is_thin = |a: DVec2, b: DVec2, c: DVec2| {
        let longest = (b - a).length().max((c - b).length()).max((c - a).length());
        (b - a).perp_dot(c - a).abs() <= thinnest * longest
    };
    let mut kept: Vec<DVec2> = Vec::with_capacity(polygon.len());
    for &vertex in polygon {
        while let [.., a, b] = kept[..]
            && is_thin(a, b, vertex)
        {
            kept.pop();
        }
        kept.push(vertex);
    }
    // The same where the last one meets the first.
    let mut rest = &kept[..];
    while let [first, second, .., before, last] = *rest {
        rest = if is_thin(before, last, first) {
            &rest[..rest.len() - 1]
        } else if is_thin(last, first, second) {
            &rest[1..]
        } else {
            break;
        };
    }
    match *rest {
        [a, b, c] if is_thin(a, b, c) => Vec::new(),
        _ => rest.to_vec(),
    }
}

/// The loops of what finite polygons cover: counter-clockwise round the inside where y points up. Vertices on straight
/// lines are dropped unless they are to be kept.
pub(crate) fn resolve_loops(
    polygons: &[Vec<DVec2>],
    winding: Winding,
    keep_collinear: bool,
) -> Vec<Vec<DVec2>> {
    let rule = match winding {
        Winding::Rule(FillRule::NonZero) => OverlayRuleOfFill::NonZero,
        Winding::Rule(FillRule::EvenOdd) => OverlayRuleOfFill::EvenOdd,
        Winding::Positive => OverlayRuleOfFill::Positive,
    };
    overlay(polygons, &[], OverlayRule::Subject, rule, keep_collinear)
}

/// The loops of what two sets of loops both cover, each of them as [`resolve_loops`] gives them.
pub(crate) fn intersect_loops(a: &[Vec<DVec2>], b: &[Vec<DVec2>]) -> Vec<Vec<DVec2>> {
    overlay(
        a,
        b,
        OverlayRule::Intersect,
        OverlayRuleOfFill::NonZero,
        false,
    )
}

/// What a rule leaves of loops and others, on a grid over them all.
fn overlay(
    subject: &[Vec<DVec2>],
    clip: &[Vec<DVec2>],
    rule: OverlayRule,
    winding: OverlayRuleOfFill,
    keep_collinear: bool,
) -> Vec<Vec<DVec2>> {
    let mut options = OverlayOptions::default();
    options.preserve_input_collinear = keep_collinear;
    options.preserve_output_collinear = keep_collinear;
    let (subject, clip) = (contours(subject), contours(clip));
    let all = subject.iter().chain(&clip);
    let count = all.clone().map(Vec::len).sum();
    let adapter = FloatPointAdapter::<[f64; 2], i64>::with_iter_conservative(all.flatten());
    FloatOverlay::new_custom(adapter, options, Default::default(), count)
        .unsafe_add_source(&subject, ShapeType::Subject)
        .unsafe_add_source(&clip, ShapeType::Clip)
        .overlay(rule, winding)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn of(points: &[[f64; 2]]) -> Vec<DVec2> {
        points.iter().map(|&p| DVec2::from_array(p)).collect()
    }

    #[test]
    fn corners_that_turn_by_nothing_and_spikes_go() {
        let square = of(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]);
        assert_eq!(straightened(&square, 1e-12), square);
        let more = of(&[
            [2.0, 1e-14],
            [4.0, 0.0],
            [4.0, 2.0],
            [7.0, 3.0],
            [4.0, 2.0 + 1e-14],
            [4.0, 4.0],
            [0.0, 4.0],
            [0.0, -1.0],
            [1e-14, 0.0],
        ]);
        let mut corners = straightened(&more, 1e-12);
        assert_eq!(corners.len(), 4);
        corners.rotate_right(1);
        let off = corners.iter().zip(&square).map(|(a, b)| a.distance(*b));
        assert!(off.fold(0.0, f64::max) < 1e-12, "{corners:?}");
        // Slivers, and what is no more than a point.
        for thin in [
            &[[0.0, 0.0], [9.0, 3.0], [3.0, 1.0 + 1e-13]][..],
            &[[0.0, 0.0], [9.0, 3.0], [6.0, 2.0], [3.0, 1.0]],
            &[[1.0, 1.0]; 5],
            &[[1.0, 1.0], [2.0, 2.0]],
        ] {
            assert!(straightened(&of(thin), 1e-12).len() < 3, "{thin:?}");
        }
    }

    #[test]
    fn where_contours_begin_leaves_no_vertex() {
        let rings = [
            of(&[
                [9.0, 12.0],
                [22.0, 12.0],
                [1.25, 3.0],
                [22.0, 12.0],
                [14.0, 12.0],
                [17.25, 1.0],
                [5.75, 4.5],
                [3.5, 5.25],
            ]),
            of(&[
                [10.5, 18.25],
                [21.75, 18.5],
                [23.5, 10.25],
                [16.25, 2.75],
                [23.5, 10.25],
            ]),
            of(&[
                [0.0, 9.25],
                [14.0, 9.75],
                [0.0, 9.25],
                [11.5, 17.0],
                [6.75, 5.0],
                [6.75, 0.25],
                [16.0, 14.0],
                [7.25, 14.0],
                [12.5, 6.75],
            ]),
        ];
        let whole = resolve(&rings, Winding::Rule(FillRule::NonZero));
        for start in 1..9 {
            let mut other = rings.clone();
            for ring in &mut other {
                let count = ring.len();
                ring.rotate_left(start % count);
            }
            other.rotate_left(start % 3);
            assert_eq!(whole, resolve(&other, Winding::Rule(FillRule::NonZero)));
        }
    }
}
