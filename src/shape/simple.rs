//! Which paths need no fill rule: those whose contours neither cross nor touch, themselves or each other.
//!
//! It is found out once, when a shape is made, and holds under every affine map; so drawing goes straight from curves to
//! edges. In doubt a path is not simple: then a fill rule is applied whenever its outline is made, which is always right.

mod pieces;

use glam::DVec2;

use self::pieces::Pieces;
use crate::path::{Contour, FillRule, Segment};

/// How far pieces may be from their chords, over the extent: coarse ones are enough for most shapes.
const REACHES: [f64; 3] = [1.0 / 128.0, 1.0 / 2048.0, 1.0 / 32_768.0];

/// The contours between what a path covers and what it does not, each with what is covered on its left where y points
/// up; or none when they are not known to be simple.
pub(super) fn borders(
    contours: &[Contour],
    rule: FillRule,
    hull: (DVec2, DVec2),
) -> Option<Vec<Contour>> {
    let contours: Vec<Contour> = contours.iter().filter_map(enclosing).collect();
    // Lines are their own chords, however near these are to be.
    let reaches = if contours.iter().all(Contour::is_straight) {
        &REACHES[..1]
    } else {
        &REACHES
    };
    let pieces = reaches
        .iter()
        .filter_map(|&reach| Pieces::new(&contours, hull, reach))
        .find(Pieces::are_apart)?;
    let borders: Vec<Contour> = contours
        .into_iter()
        .zip(pieces.windings()?)
        .enumerate()
        .filter_map(|(index, (contour, outside))| {
            let turn = pieces.turn(index);
            let covers = |winding: i32| match rule {
                FillRule::NonZero => winding != 0,
                FillRule::EvenOdd => winding % 2 != 0,
            };
            // Inside of the contour it winds once more, on its left if it turns left.
            match (covers(outside), covers(outside + turn)) {
                (false, true) if turn < 0 => Some(reversed(&contour)),
                (true, false) if turn > 0 => Some(reversed(&contour)),
                (outside, inside) => (outside != inside).then_some(contour),
            }
        })
        .collect();
    (!borders.is_empty()).then_some(borders)
}

/// The contour without segments that go nowhere, or none where it is a point, or a line and back.
fn enclosing(contour: &Contour) -> Option<Contour> {
    let mut from = contour.start;
    let mut segments = contour.segments.clone();
    segments.retain(|segment| {
        let start = core::mem::replace(&mut from, segment.end());
        match *segment {
            Segment::Line(to) => to != start,
            Segment::Quad(a, to) => [a, to] != [start; 2],
            Segment::Cubic(a, b, to) => [a, b, to] != [start; 3],
            Segment::Arc(_) => true,
        }
    });
    let cleaned = Contour {
        start: contour.start,
        segments,
        closed: true,
    };
    let closing = usize::from(cleaned.end() != cleaned.start);
    let encloses = !cleaned.is_straight() || cleaned.segments.len() + closing > 2;
    encloses.then_some(cleaned)
}

/// The contour from its end to its start.
fn reversed(contour: &Contour) -> Contour {
    let turned = |(to, segment): (DVec2, &Segment)| match *segment {
        Segment::Line(_) => Segment::Line(to),
        Segment::Quad(a, _) => Segment::Quad(a, to),
        Segment::Cubic(a, b, _) => Segment::Cubic(b, a, to),
        Segment::Arc(arc) => Segment::Arc(arc.reversed(to)),
    };
    let mut segments: Vec<Segment> = contour.walk().map(turned).collect();
    segments.reverse();
    Contour {
        start: contour.end(),
        segments,
        closed: true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outline::{Edge, Outline};
    use crate::path::Path;
    use crate::shape::{Cover, Shape};

    /// A closed ring of four curves about `center`, turning left (where y points up) or right.
    fn add_ring(path: &mut Path, [x, y]: [f32; 2], radius: f32, left: bool) {
        let (r, h) = (radius, radius * 0.552_284_8);
        let f = if left { 1.0 } else { -1.0 };
        let at = |dx: f32, dy: f32| [x + dx, y + dy * f];
        path.move_to(at(r, 0.0))
            .cubic_to(at(r, h), at(h, r), at(0.0, r))
            .cubic_to(at(-h, r), at(-r, h), at(-r, 0.0))
            .cubic_to(at(-r, -h), at(-h, -r), at(0.0, -r))
            .cubic_to(at(h, -r), at(r, -h), at(r, 0.0))
            .close();
    }

    fn rings(rings: &[([f32; 2], f32, bool)]) -> Path {
        let mut path = Path::new();
        for &(center, radius, left) in rings {
            add_ring(&mut path, center, radius, left);
        }
        path
    }

    /// How many contours the path has as a simple shape, once its outline was compared with the one that the fill rule
    /// gives; 0 if it is not simple.
    fn contours(path: &Path, rule: FillRule) -> usize {
        let shape = Shape::path(path, rule).unwrap();
        if shape.cover != Cover::Simple {
            return 0;
        }
        let ruled = Shape {
            contours: path.contours.clone(),
            cover: Cover::Rule(rule),
        };
        let (min, max) = ruled.hull().unwrap();
        let flatness = (max - min).max_element() * 1e-6;
        let (simple, ruled) = (
            Outline::of_flattened(&shape, flatness),
            Outline::of_flattened(&ruled, flatness),
        );
        simple.sanity_check();
        assert_eq!(simple.loops.len(), ruled.loops.len());
        let relative = simple.area() / ruled.area() - 1.0;
        assert!(relative.abs() < 1e-6, "{relative:e}");
        // Holes turn the other way.
        for edges in &simple.loops {
            let area = |edges: &[Edge]| -> f64 {
                edges
                    .iter()
                    .map(|edge| edge.double_area(edges[0].from()))
                    .sum()
            };
            let same =
                |other: &&Vec<Edge>| (area(other) - area(edges)).abs() < 1e-6 * area(edges).abs();
            assert!(ruled.loops.iter().any(|other| same(&other)));
        }
        shape.contours.len()
    }

    #[test]
    fn hearts_are_simple() {
        for (left, right) in [(70.0, 290.0), (290.0, 70.0)] {
            let side = |x: f32| 180.0 + (x - 180.0) * (right - left) / 220.0;
            let mut heart = Path::new();
            heart
                .move_to([180.0, 280.0])
                .cubic_to([side(60.0), 200.0], [side(40.0), 130.0], [side(70.0), 95.0])
                .cubic_to([side(105.0), 55.0], [side(160.0), 70.0], [180.0, 115.0])
                .cubic_to(
                    [side(200.0), 70.0],
                    [side(255.0), 55.0],
                    [side(290.0), 95.0],
                )
                .cubic_to([side(320.0), 130.0], [side(300.0), 200.0], [180.0, 280.0])
                .close();
            assert_eq!(contours(&heart, FillRule::NonZero), 1);
            assert_eq!(contours(&heart, FillRule::EvenOdd), 1);
        }
    }

    #[test]
    fn rules_decide_what_is_a_border() {
        let count = |inner: bool, outer: bool, rule| {
            contours(
                &rings(&[([5.0, 5.0], 9.0, outer), ([6.0, 5.0], 4.0, inner)]),
                rule,
            )
        };
        for outer in [true, false] {
            // A hole whichever way it turns, or only the one that turns back.
            assert_eq!(count(outer, outer, FillRule::EvenOdd), 2);
            assert_eq!(count(!outer, outer, FillRule::EvenOdd), 2);
            assert_eq!(count(!outer, outer, FillRule::NonZero), 2);
            assert_eq!(count(outer, outer, FillRule::NonZero), 1);
        }
        // An island in a lake, and another beside.
        let rings = rings(&[
            ([0.0, 0.0], 3.0, true),
            ([0.0, 0.0], 9.0, true),
            ([0.0, 1.0], 6.0, false),
            ([20.0, 1.0], 6.0, false),
        ]);
        assert_eq!(contours(&rings, FillRule::EvenOdd), 4);
        assert_eq!(contours(&rings, FillRule::NonZero), 4);
    }

    #[test]
    fn what_crosses_or_touches_is_not_simple() {
        let is_simple = |path: &Path| {
            [FillRule::NonZero, FillRule::EvenOdd].map(|rule| contours(path, rule) > 0)
        };
        let mut eight = Path::new();
        eight
            .move_to([0.0, 0.0])
            .cubic_to([30.0, 40.0], [-30.0, 40.0], [10.0, 0.0])
            .close();
        assert_eq!(is_simple(&eight), [false; 2]);
        // Two rings that cross, touch in a point, are the same, are too near to tell, and are apart.
        for (x, apart) in [
            (7.0, false),
            (8.0, false),
            (0.0, false),
            (8.000_01, false),
            (8.01, true),
            (9.0, true),
        ] {
            let rings = rings(&[([0.0, 0.0], 4.0, true), ([x, 0.0], 4.0, true)]);
            assert_eq!(is_simple(&rings), [apart; 2], "{x}");
        }
        // A cusp, and a curve that goes back the way it came.
        let mut cusp = Path::new();
        cusp.move_to([0.0, 0.0])
            .quad_to([10.0, 0.0], [10.0, 10.0])
            .quad_to([10.0, 0.0], [20.0, 5.0]);
        assert_eq!(is_simple(&cusp), [false; 2]);
        let mut back = Path::new();
        back.move_to([0.0, 0.0])
            .quad_to([10.0, 10.0], [0.0, 0.0])
            .line_to([5.0, 0.0]);
        assert_eq!(is_simple(&back), [false; 2]);
    }

    #[test]
    fn ends_that_nearly_meet_and_points_that_repeat_do_no_harm() {
        let mut path = Path::new();
        path.move_to([0.1, 0.2])
            .line_to([0.1, 0.2])
            .quad_to([5.0, -3.0], [10.0, 0.2])
            .quad_to([10.0, 0.2], [10.0, 0.2])
            .line_to([10.0, 10.0])
            .line_to([10.000_001, 10.0])
            .quad_to([5.0, 12.0], [0.1, 10.0])
            .line_to([0.100_000_1, 0.200_000_1])
            .close();
        path.move_to([50.0, 50.0]).line_to([60.0, 60.0]).close();
        path.move_to([5.0, 5.0]);
        assert_eq!(contours(&path, FillRule::NonZero), 1);
        // Open contours are closed.
        let mut open = Path::new();
        open.move_to([0.0, 0.0]).quad_to([5.0, 9.0], [10.0, 0.0]);
        assert_eq!(contours(&open, FillRule::EvenOdd), 1);
    }

    #[test]
    fn arcs_of_paths_stay_arcs() {
        let mut ring = Path::new();
        ring.move_to([170.0, 50.0])
            .arc_to([115.0, 115.0], 0.0, true, true, [169.99, 50.0])
            .close();
        ring.move_to([170.0, 120.0])
            .arc_to([45.0, 45.0], 0.0, true, false, [170.01, 120.0])
            .close();
        for rule in [FillRule::NonZero, FillRule::EvenOdd] {
            assert_eq!(contours(&ring, rule), 2);
            let outline = Outline::of_simple(&Shape::path(&ring, rule).unwrap()).unwrap();
            outline.sanity_check();
            assert_eq!(outline.edges().count(), 6);
            let exact = core::f64::consts::PI * (115.0 * 115.0 - 45.0 * 45.0);
            assert!((outline.area() / exact - 1.0).abs() < 1e-6);
        }
        // As a hole that turns the same way the inner one is turned round.
        let mut same = Path::new();
        same.move_to([0.0, 0.0])
            .arc_to([9.0, 9.0], 0.0, true, true, [0.0, 18.0])
            .arc_to([9.0, 9.0], 0.0, true, true, [0.0, 0.0]);
        same.move_to([0.0, 5.0])
            .arc_to([4.0, 4.0], 0.0, true, true, [0.0, 13.0])
            .line_to([0.5, 9.0]);
        assert_eq!(contours(&same, FillRule::EvenOdd), 2);
    }

    #[test]
    fn paths_taken_for_simple_cover_what_their_rule_says() {
        let mut state = 1_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 40) as f32 / (1_u32 << 24) as f32
        };
        let mut simple = 0;
        for index in 0..COUNT {
            let mut path = Path::new();
            for _ in 0..1 + index % 3 {
                let center = [random() * 30.0, random() * 30.0];
                let radius = 1.0 + random() * 12.0;
                let jitter = random() * radius;
                let mut near = |x: f32, y: f32| {
                    [
                        center[0] + radius * x + jitter * (random() - 0.5),
                        center[1] + radius * y + jitter * (random() - 0.5),
                    ]
                };
                path.move_to(near(1.0, 0.0))
                    .cubic_to(near(1.0, 0.6), near(0.6, 1.0), near(0.0, 1.0))
                    .quad_to(near(-1.0, 1.0), near(-1.0, 0.0))
                    .line_to(near(-0.7, -0.7))
                    .arc_to(
                        [radius, radius * 0.6],
                        index as f32,
                        false,
                        index % 2 == 0,
                        near(0.0, -1.0),
                    )
                    .cubic_to(near(0.6, -1.0), near(1.0, -0.6), near(1.0, 0.0));
            }
            for rule in [FillRule::NonZero, FillRule::EvenOdd] {
                simple += usize::from(contours(&path, rule) > 0);
            }
        }
        println!("{simple} of {} simple", 2 * COUNT);
        assert!(simple > COUNT / 5);
    }

    const COUNT: usize = 1000;
}
