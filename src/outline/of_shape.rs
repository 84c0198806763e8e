//! The outline of a shape.

use core::f64::consts::PI;

use glam::DVec2;
use libm::atan2;

use super::fit::push_line;
use super::{Arc, Edge, Line, Outline, Winding, closed_lines, resolve};
use crate::path::{EllipseArc, Segment};
use crate::shape::{Cover, Shape};

impl Outline {
    /// The outline of a shape of lines and circular arcs that needs no fill rule, or none.
    pub(crate) fn of_simple(shape: &Shape) -> Option<Self> {
        match shape.cover {
            Cover::Simple => {}
            Cover::Rule(rule) if shape.is_straight() => {
                // A single convex contour is what it covers, whatever the rule.
                let polygons = flatten(shape, 1.0);
                return Some(match polygons.as_slice() {
                    [only] if is_convex_polygon(only) => Self::of_polygons(&polygons),
                    _ => resolve(&polygons, Winding::Rule(rule)),
                });
            }
            Cover::Rule(_) => return None,
        }
        let mut loops = Vec::with_capacity(shape.contours.len());
        for contour in &shape.contours {
            let mut edges = Vec::with_capacity(contour.segments.len() + 1);
            for (from, segment) in contour.walk() {
                match *segment {
                    Segment::Line(to) => edges.push(Edge::Line(Line { from, to })),
                    Segment::Arc(arc) => edges.extend(circular(from, &arc)?.map(Edge::Arc)),
                    Segment::Quad(..) | Segment::Cubic(..) => return None,
                }
            }
            push_line(contour.end(), contour.start, &mut edges);
            loops.push(edges);
        }
        Some(Self { loops }.canonical())
    }

    /// The outline of a shape: with circular arcs as they are where that can be, or else its curves cut into lines within
    /// `flatness` of them.
    pub(crate) fn of_shape(shape: &Shape, flatness: f64) -> Self {
        Self::of_simple(shape).unwrap_or_else(|| Self::of_flattened(shape, flatness))
    }

    /// The outline of a shape, its curves cut into lines within `flatness` of them.
    pub(crate) fn of_flattened(shape: &Shape, flatness: f64) -> Self {
        let polygons = flatten(shape, flatness);
        match shape.cover {
            Cover::Simple => Self::of_polygons(&polygons),
            Cover::Rule(rule) => resolve(&polygons, Winding::Rule(rule)),
        }
    }

    /// The outline of polygons known neither to cross nor to touch.
    fn of_polygons(polygons: &[Vec<DVec2>]) -> Self {
        let loops = polygons
            .iter()
            .map(|polygon| closed_lines(polygon))
            .collect();
        Self { loops }.canonical()
    }
}

fn flatten(shape: &Shape, flatness: f64) -> Vec<Vec<DVec2>> {
    shape
        .contours
        .iter()
        .map(|contour| contour.flatten(flatness))
        .filter(|polygon| polygon.len() > 2)
        .collect()
}

/// Whether a polygon turns one way only, and once.
fn is_convex_polygon(polygon: &[DVec2]) -> bool {
    let count = polygon.len();
    let edge = |i: usize| polygon[(i + 1) % count] - polygon[i % count];
    let turns_left = (0..count).all(|i| edge(i).perp_dot(edge(i + 1)) > 0.0);
    let turns_right = (0..count).all(|i| edge(i).perp_dot(edge(i + 1)) < 0.0);
    // A star turns one way only as well, but its edges head left and right more than once.
    let changes = (0..count)
        .filter(|&i| (edge(i).x < 0.0) != (edge(i + 1).x < 0.0))
        .count();
    (turns_left || turns_right) && changes <= 2
}

/// The arc as parts of a circle of at most a half turn, when its half diameters are equal and perpendicular.
pub(super) fn circular(from: DVec2, arc: &EllipseArc) -> Option<impl Iterator<Item = Arc>> {
    // Rounding may make a half circle a little longer, and two arcs of it would be no better.
    const HALF_TURN: f64 = PI + 1e-9;
    if !arc.is_circular() {
        return None;
    }
    let radius = arc.u.length();
    let turn = arc.turn();
    let whole = Arc {
        center: arc.center,
        radius,
        start: atan2(arc.u.y, arc.u.x) + turn * arc.start,
        sweep: turn * arc.sweep,
        from,
        to: arc.to,
    };
    let parts = if whole.sweep.abs() <= HALF_TURN {
        [Some(whole), None]
    } else {
        let sweep = whole.sweep / 2.0;
        let middle = whole.at(whole.start + sweep);
        let first = Arc {
            sweep,
            to: middle,
            ..whole
        };
        let second = Arc {
            start: whole.start + sweep,
            sweep,
            from: middle,
            ..whole
        };
        [Some(first), Some(second)]
    };
    Some(parts.into_iter().flatten())
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use glam::{DAffine2, DMat2};
    use libm::{cos, sin};

    use super::*;
    use crate::path::FillRule;

    fn outline(shape: &Shape) -> Outline {
        let outline = Outline::of_simple(shape).unwrap();
        outline.sanity_check();
        outline
    }

    #[test]
    fn rounded_rectangles_keep_four_lines_and_four_arcs() {
        let shape = Shape::rounded_rect(10.0, 20.0, 100.0, 60.0, [4.0, 8.0, 0.0, 12.0]).unwrap();
        let outline = outline(&shape);
        let arcs = outline
            .edges()
            .filter(|edge| matches!(edge, Edge::Arc(_)))
            .count();
        assert_eq!((arcs, outline.edges().count()), (3, 7));
        let area = 6000.0 - (1.0 - PI / 4.0) * (16.0 + 64.0 + 144.0);
        assert!((outline.area() - area).abs() < 1e-9);
        assert_eq!(
            outline.bounds(),
            Some((DVec2::new(10.0, 20.0), DVec2::new(110.0, 80.0)))
        );
    }

    #[test]
    fn circles_are_one_pair_of_arcs_under_every_similarity() {
        let shape = Shape::circle([3.0, 4.0], 5.0).unwrap();
        for (angle, mirror) in [(0.0, 1.0), (1.0, 1.0), (2.5, -1.0)] {
            let turned = DMat2::from_cols(
                DVec2::new(cos(angle), sin(angle)) * 2.0,
                DVec2::new(-sin(angle), cos(angle)) * 2.0 * mirror,
            );
            let mapped = outline(&shape.mapped(&DAffine2::from_mat2(turned)));
            assert_eq!(mapped.edges().count(), 2);
            assert!((mapped.area() - PI * 100.0).abs() < 1e-9);
            let (min, max) = mapped.bounds().unwrap();
            assert!(((max - min) - DVec2::splat(20.0)).length() < 1e-9);
        }
        // A stretched circle is no circle.
        assert!(
            Outline::of_simple(&shape.mapped(&DAffine2::from_scale(DVec2::new(2.0, 1.0))))
                .is_none()
        );
    }

    #[test]
    fn one_outline_has_one_description() {
        let ring = [
            [0.0, 0.0],
            [10.0, 1.0],
            [12.0, 9.0],
            [5.0, 12.0],
            [-1.0, 6.0],
        ];
        let mut reversed = ring;
        reversed.reverse();
        let mut rotated = ring;
        rotated.rotate_left(2);
        let of =
            |ring: [[f32; 2]; 5]| outline(&Shape::polygon(&[ring], FillRule::NonZero).unwrap());
        assert_eq!(of(ring), of(reversed));
        assert_eq!(of(ring), of(rotated));
    }

    #[test]
    fn fill_rules_and_crossings_are_resolved() {
        let area = |rings: &[&[[f32; 2]]], rule| {
            let outline = outline(&Shape::polygon(rings, rule).unwrap());
            outline.area()
        };
        // A bow-tie: two triangles of area 25, one of them wound backwards.
        let bow_tie: &[[f32; 2]] = &[[0.0, 0.0], [10.0, 10.0], [10.0, 0.0], [0.0, 10.0]];
        assert!((area(&[bow_tie], FillRule::NonZero) - 50.0).abs() < 1e-9);
        assert!((area(&[bow_tie], FillRule::EvenOdd) - 50.0).abs() < 1e-9);
        // A square in a square, wound the same way and the other way.
        let square = |at: f32, side: f32| {
            [
                [at, at],
                [at + side, at],
                [at + side, at + side],
                [at, at + side],
            ]
        };
        let (outer, inner) = (square(0.0, 9.0), square(3.0, 3.0));
        let mut turned = inner;
        turned.reverse();
        assert!((area(&[&outer, &inner], FillRule::NonZero) - 81.0).abs() < 1e-9);
        assert!((area(&[&outer, &inner], FillRule::EvenOdd) - 72.0).abs() < 1e-9);
        assert!((area(&[&outer, &turned], FillRule::NonZero) - 72.0).abs() < 1e-9);
        // Two squares that share a part: it counts once.
        let (a, b) = (square(0.0, 10.0), square(5.0, 10.0));
        assert!((area(&[&a, &b], FillRule::NonZero) - 175.0).abs() < 1e-9);
        assert!((area(&[&a, &b], FillRule::EvenOdd) - 150.0).abs() < 1e-9);
        // A pentagram: its core is wound twice.
        let tip = |i: u32| {
            let angle = f64::from(i) * 0.4 * TAU;
            [(10.0 * cos(angle)) as f32, (10.0 * sin(angle)) as f32]
        };
        let pentagram = [0, 1, 2, 3, 4].map(tip);
        let core = area(&[&pentagram], FillRule::NonZero) - area(&[&pentagram], FillRule::EvenOdd);
        // A regular pentagon of circumradius 10 / φ², φ the golden ratio.
        let radius: f64 = 10.0 / 2.618_033_988_749_895;
        assert!(
            (core - 2.5 * radius * radius * sin(TAU / 5.0)).abs() < 1e-4,
            "{core}"
        );
    }
}
