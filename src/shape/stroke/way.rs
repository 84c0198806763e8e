//! The way of a pen: a contour as straight pieces, each with its direction.

use glam::DVec2;
use libm::{cos, sin};

use super::pen::Pen;
use crate::path::{Contour, Segment};

/// By how much a curve may lean at its end from its last line and be taken for going along it: more than rounding makes.
const STRAIGHT: f64 = 1e-9;

/// A straight piece of a way. One without length turns the pen to where a curve heads at its end: its last line only nearly does.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub(super) from: DVec2,
    pub(super) to: DVec2,
    /// Its direction, of length 1.
    pub(super) along: DVec2,
    /// Whether the way bends into it as a curve does, without a corner.
    pub(super) bends: bool,
}

impl Line {
    fn turn(at: DVec2, along: DVec2, bends: bool) -> Self {
        Self {
            from: at,
            to: at,
            along,
            bends,
        }
    }

    pub(super) fn is_turn(&self) -> bool {
        self.from == self.to
    }

    pub(super) fn length(&self) -> f64 {
        self.from.distance(self.to)
    }

    /// How much of it the turn at either end may take.
    pub(super) fn room(&self) -> f64 {
        if self.is_turn() {
            f64::INFINITY
        } else {
            self.length() / 2.0
        }
    }

    /// The direction, unless the line has it.
    fn other(&self, along: DVec2) -> Option<DVec2> {
        let leans = self.along.perp_dot(along).abs() > STRAIGHT || self.along.dot(along) < 0.0;
        leans.then_some(along)
    }
}

/// The way along a contour, and whether it ends where it begins. A contour without length is a dot, and heads along x, as in SVG.
pub(super) fn way(contour: &Contour, pen: &Pen) -> (Vec<Line>, bool) {
    let mut way = Vec::new();
    for (from, segment) in contour.walk() {
        append(&mut way, from, segment, pen.flatness);
    }
    if contour.closed {
        let closing = Segment::Line(contour.start);
        append(&mut way, contour.end(), &closing, pen.flatness);
    }
    if way.is_empty() {
        return (vec![Line::turn(contour.start, DVec2::X, false)], false);
    }
    (smooth(way, contour.closed, pen), contour.closed)
}

fn append(way: &mut Vec<Line>, from: DVec2, segment: &Segment, flatness: f64) {
    let mut points = Vec::new();
    segment.flatten(from, flatness, &mut points);
    let mut lines: Vec<Line> = Vec::with_capacity(points.len());
    for to in points {
        let from = lines.last().map_or(from, |line| line.to);
        // A point that is repeated leads nowhere.
        if let Some(along) = (to - from).try_normalize() {
            lines.push(Line {
                from,
                to,
                along,
                bends: !lines.is_empty(),
            });
        }
    }
    let heading = directions(from, segment);
    if let Some(first) = lines.first_mut()
        && let Some(along) = heading.and_then(|[leaving, _]| first.other(leaving))
    {
        first.bends = true;
        way.push(Line::turn(first.from, along, false));
    }
    way.append(&mut lines);
    if let Some(last) = way.last()
        && let Some(along) = heading.and_then(|[_, arriving]| last.other(arriving))
    {
        way.push(Line::turn(last.to, along, true));
    }
}

/// Where a curve heads at its ends.
fn directions(from: DVec2, segment: &Segment) -> Option<[DVec2; 2]> {
    // A control point at the end says nothing of it: the next one does.
    let towards = |at: DVec2, points: &[DVec2]| {
        let mut ways = points.iter().map(|&point| point - at);
        ways.find_map(DVec2::try_normalize)
    };
    match *segment {
        Segment::Line(_) => None,
        Segment::Quad(a, to) => Some([towards(from, &[a, to])?, -towards(to, &[a, from])?]),
        Segment::Cubic(a, b, to) => {
            Some([towards(from, &[a, b, to])?, -towards(to, &[b, a, from])?])
        }
        Segment::Arc(arc) => {
            let at = |angle| {
                let derivative = arc.v * cos(angle) - arc.u * sin(angle);
                (derivative * arc.sweep).try_normalize()
            };
            Some([at(arc.start)?, at(arc.start + arc.sweep)?])
        }
    }
}

/// A way that bends, too, where a segment goes on as the one before it: to where they head there it need not turn.
fn smooth(mut way: Vec<Line>, closed: bool, pen: &Pen) -> Vec<Line> {
    let count = way.len();
    for index in usize::from(!closed)..count {
        let before = way[(index + count - 1) % count];
        let line = &mut way[index];
        line.bends |= pen.is_smooth(&before, line);
    }
    let is_needed = |index: usize| {
        let (line, next) = (&way[index], &way[(index + 1) % count]);
        !(line.is_turn() && line.bends && next.bends)
    };
    (0..count)
        .filter(|&index| is_needed(index))
        .map(|index| way[index])
        .collect()
}
