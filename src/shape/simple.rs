//! Which paths need no fill rule: those whose contours neither cross nor touch, themselves or each other.
//!
//! It is found out once, when a shape is made, and holds under every affine map; so drawing goes straight from curves to
//! edges. In doubt a path is not simple: then a fill rule is applied whenever its outline is made, which is always right.
//!
//! Contours are cut into pieces, each with a bound on how far it may be from its chord and on where it may head. Two
//! pieces are apart when their chords are farther from each other than they may be from these, and pieces of one contour
//! also when no piece from the one to the other heads back: what moves within a half plane of directions never meets
//! itself. That settles neighbours, whose chords touch.

use core::ops::Range;

use glam::DVec2;

use crate::path::{Contour, Curve, FillRule, Part, Segment};

/// More pieces than this are not looked through.
const MOST_PIECES: usize = 20_000;

/// How often pieces are compared at most: for each, and besides.
const MOST_COMPARISONS: (usize, usize) = (256, 10_000);

/// How far pieces may be from their chords, over the extent: coarse ones are enough for most shapes.
const REACHES: [f64; 3] = [1.0 / 128.0, 1.0 / 2048.0, 1.0 / 32_768.0];

/// A curve's fewest pieces.
const FEWEST: u32 = 4;

/// The pieces from one to another that are looked through for whether they head back.
const LONGEST_CHAIN: usize = 8;

/// What rounding may hide, over the largest coordinate.
const ROUNDING: f64 = 1e-12;

/// The contours between what a path covers and what it does not, each with what is covered on its left where y points
/// up; or none when they are not known to be simple.
pub(super) fn borders(
    contours: &[Contour],
    rule: FillRule,
    hull: (DVec2, DVec2),
) -> Option<Vec<Contour>> {
    let contours: Vec<Contour> = contours.iter().filter_map(enclosing).collect();
    let pieces = REACHES
        .into_iter()
        .filter_map(|reach| Pieces::new(&contours, hull, reach))
        .find(Pieces::are_apart)?;
    let borders: Vec<Contour> = contours
        .into_iter()
        .enumerate()
        .filter_map(|(index, contour)| {
            let outside = pieces.winding_round(index);
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
    let mut to = contour.start;
    let turned = |segment: &Segment| {
        let to = core::mem::replace(&mut to, segment.end());
        match *segment {
            Segment::Line(_) => Segment::Line(to),
            Segment::Quad(a, _) => Segment::Quad(a, to),
            Segment::Cubic(a, b, _) => Segment::Cubic(b, a, to),
            Segment::Arc(arc) => Segment::Arc(arc.reversed(to)),
        }
    };
    let mut segments: Vec<Segment> = contour.segments.iter().map(turned).collect();
    segments.reverse();
    Contour {
        start: contour.end(),
        segments,
        closed: true,
    }
}

/// The pieces of all contours, one contour after the other.
struct Pieces {
    pieces: Vec<Piece>,
    /// Which pieces are a contour's, and a box that holds their chords.
    contours: Vec<(Range<usize>, DVec2, DVec2)>,
    /// What rounding may hide.
    tiny: f64,
    /// Along which they are sorted: the longer one.
    axis: usize,
}

/// A piece of a contour.
struct Piece {
    contour: usize,
    from: DVec2,
    to: DVec2,
    /// How far it may be from its chord.
    reach: f64,
    headings: Headings,
    /// A box that holds it.
    min: DVec2,
    max: DVec2,
}

/// The directions from one counter-clockwise to another, less than half a turn further on.
#[derive(Clone, Copy)]
struct Headings {
    first: DVec2,
    last: DVec2,
}

impl Headings {
    /// Of given directions, or none if there are none or they take half a turn or nearly so.
    fn of(directions: impl IntoIterator<Item = DVec2>) -> Option<Self> {
        let mut directions = directions.into_iter();
        let first = directions.next()?;
        let one = Self { first, last: first };
        directions.try_fold(one, Self::with)
    }

    fn with(self, direction: DVec2) -> Option<Self> {
        let Self { first, last } = self;
        let after_first = first.perp_dot(direction);
        let before_last = direction.perp_dot(last);
        let ahead = first.dot(direction) > 0.0 || last.dot(direction) > 0.0;
        if after_first >= 0.0 && before_last >= 0.0 {
            ahead.then_some(self)
        } else if before_last < 0.0 {
            is_left(first, direction).then_some(Self {
                first,
                last: direction,
            })
        } else {
            is_left(direction, last).then_some(Self {
                first: direction,
                last,
            })
        }
    }
}

/// Whether the way from one direction to another counter-clockwise is less than half a turn, and not nearly that.
fn is_left(from: DVec2, to: DVec2) -> bool {
    let (across, along) = (from.perp_dot(to), from.dot(to));
    across > 0.0 && (along > 0.0 || across > -1e-6 * along)
}

impl Piece {
    fn of_line(contour: usize, from: DVec2, to: DVec2, tiny: f64) -> Option<Self> {
        Self::new(contour, [from, to], [to - from], 0.0, tiny)
    }

    fn of_part(contour: usize, part: &Part, tiny: f64) -> Option<Self> {
        // A hundredth more than a cubic needs is enough for the arc that it may stand for.
        const ARC: f64 = 1.01;
        let [first, middle, last] = part.legs();
        let bend = (middle - first).length().max((last - middle).length());
        let ends = [part.from, part.to];
        Self::new(contour, ends, part.legs(), 0.75 * ARC * bend, tiny)
    }

    /// None if it may head back.
    fn new<const N: usize>(
        contour: usize,
        [from, to]: [DVec2; 2],
        legs: [DVec2; N],
        reach: f64,
        tiny: f64,
    ) -> Option<Self> {
        Some(Self {
            contour,
            from,
            to,
            reach,
            min: from.min(to) - reach - tiny,
            max: from.max(to) + reach + tiny,
            headings: Headings::of(legs.into_iter().filter(|leg| leg.length() > tiny))?,
        })
    }
}

impl Pieces {
    /// Pieces within `reach` times the extent of their chords, or none if there are too many or one may head back.
    fn new(contours: &[Contour], (min, max): (DVec2, DVec2), reach: f64) -> Option<Self> {
        let size = max - min;
        let mut pieces = Self {
            pieces: Vec::new(),
            contours: Vec::with_capacity(contours.len()),
            tiny: ROUNDING * min.abs().max(max.abs()).max_element(),
            axis: usize::from(size.y > size.x),
        };
        for contour in contours {
            pieces.push(contour, reach * size.max_element())?;
        }
        Some(pieces)
    }

    fn push(&mut self, contour: &Contour, reach: f64) -> Option<()> {
        let (first, index) = (self.pieces.len(), self.contours.len());
        let closing = Segment::Line(contour.start);
        let mut from = contour.start;
        for segment in contour.segments.iter().chain([&closing]) {
            if let Some(curve) = Curve::new(from, segment) {
                let count = (curve.sagitta() / reach).sqrt().ceil();
                let count = count.max(f64::from(FEWEST.max(curve.fewest_parts())));
                if count + self.pieces.len() as f64 > MOST_PIECES as f64 {
                    return None;
                }
                for part in curve.parts(count as u32) {
                    self.pieces.push(Piece::of_part(index, &part, self.tiny)?);
                }
            } else if (segment.end() - from).length() > self.tiny {
                let line = Piece::of_line(index, from, segment.end(), self.tiny)?;
                self.pieces.push(line);
            } else {
                // The next piece begins where this one does, so that the chords stay closed.
                continue;
            }
            from = segment.end();
        }
        let own = self.pieces.get_mut(first..)?;
        own.last_mut()?.to = contour.start;
        let ends = own.iter().map(|piece| piece.to);
        let (min, max) = ends.fold((contour.start, contour.start), |(min, max), p| {
            (min.min(p), max.max(p))
        });
        self.contours.push((first..self.pieces.len(), min, max));
        (self.pieces.len() <= MOST_PIECES).then_some(())
    }

    /// Whether no two pieces meet but where the contour goes on from one to the other.
    fn are_apart(&self) -> bool {
        let axis = self.axis;
        let mut order: Vec<usize> = (0..self.pieces.len()).collect();
        let low = |index: usize| self.pieces[index].min[axis];
        order.sort_unstable_by(|&a, &b| low(a).total_cmp(&low(b)));
        let mut left = MOST_COMPARISONS.0 * order.len() + MOST_COMPARISONS.1;
        // The pieces that the sweep has come to and not left yet.
        let mut open: Vec<usize> = Vec::new();
        for next in order {
            open.retain(|&other| self.pieces[other].max[axis] >= low(next));
            if open.len() > left || open.iter().any(|&other| self.may_meet(other, next)) {
                return false;
            }
            left -= open.len();
            open.push(next);
        }
        true
    }

    fn may_meet(&self, a: usize, b: usize) -> bool {
        let (one, other) = (&self.pieces[a], &self.pieces[b]);
        let boxes_meet = one.min.cmple(other.max).all() && other.min.cmple(one.max).all();
        boxes_meet
            && !one.is_apart_from(other, self.tiny)
            && !(one.contour == other.contour && self.goes_on(a.min(b), a.max(b)))
    }

    /// Whether no piece on one of the two ways between two pieces of a contour heads back.
    fn goes_on(&self, a: usize, b: usize) -> bool {
        let contour = &self.contours[self.pieces[a].contour].0;
        let ways = [(a..b + 1, 0..0), (b..contour.end, contour.start..a + 1)];
        ways.into_iter().any(|(first, second)| {
            first.len() + second.len() <= LONGEST_CHAIN && {
                let mut chain = first.chain(second).map(|index| self.pieces[index].headings);
                chain.next().is_some_and(|one| {
                    chain
                        .try_fold(one, |all, next| all.with(next.first)?.with(next.last))
                        .is_some()
                })
            }
        })
    }

    fn of(&self, contour: usize) -> &[Piece] {
        &self.pieces[self.contours[contour].0.clone()]
    }

    /// 1 if a contour turns left as a whole, -1 if it turns right.
    fn turn(&self, contour: usize) -> i32 {
        let pieces = self.of(contour);
        let origin = pieces[0].from;
        let double_area: f64 = pieces
            .iter()
            .map(|piece| (piece.from - origin).perp_dot(piece.to - origin))
            .sum();
        if double_area < 0.0 { -1 } else { 1 }
    }

    /// How often all other contours wind round a contour: as often round one of its points as round any other, and as
    /// their chords do, since it is nowhere between these and the contours.
    fn winding_round(&self, contour: usize) -> i32 {
        let point = self.of(contour)[0].from;
        let others = self.contours.iter().enumerate();
        others
            .filter(|&(other, (_, min, max))| {
                other != contour && point.cmpge(*min).all() && point.cmple(*max).all()
            })
            .map(|(other, _)| winding(self.of(other), point))
            .sum()
    }
}

impl Piece {
    fn is_apart_from(&self, other: &Self, tiny: f64) -> bool {
        let most = self.reach + other.reach + tiny;
        !self.crosses(other)
            && self.distance_squared(other.from) > most * most
            && self.distance_squared(other.to) > most * most
            && other.distance_squared(self.from) > most * most
            && other.distance_squared(self.to) > most * most
    }

    fn crosses(&self, other: &Self) -> bool {
        let side = |piece: &Self, p: DVec2| (piece.to - piece.from).perp_dot(p - piece.from) > 0.0;
        side(self, other.from) != side(self, other.to)
            && side(other, self.from) != side(other, self.to)
    }

    /// The square of the distance from its chord.
    fn distance_squared(&self, p: DVec2) -> f64 {
        let (chord, from) = (self.to - self.from, p - self.from);
        let along = (from.dot(chord) / chord.length_squared()).clamp(0.0, 1.0);
        (from - chord * along).length_squared()
    }
}

/// How often closed chords wind round a point beside them.
fn winding(pieces: &[Piece], point: DVec2) -> i32 {
    pieces
        .iter()
        .filter(|piece| (piece.from.y <= point.y) != (piece.to.y <= point.y))
        .map(|piece| {
            let up = piece.from.y <= point.y;
            let left = (piece.to - piece.from).perp_dot(point - piece.from) > 0.0;
            match (up, left) {
                (true, true) => 1,
                (false, false) => -1,
                _ => 0,
            }
        })
        .sum()
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
