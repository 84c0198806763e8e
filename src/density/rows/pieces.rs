//! The outline cut into pieces along which y only rises or only falls.

use core::f64::consts::{FRAC_PI_2, PI, SQRT_2};

use glam::DVec2;

use super::kernels::Wide;
use super::{Window, arcs, chains};
use crate::outline::{Arc, Edge};

/// A line or an arc between two heights.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) from: DVec2,
    pub(super) to: DVec2,
    pub(super) form: Form,
    /// The heights between which it and what goes on from it as it does are as good as one piece.
    pub(super) chain: [f64; 2],
    /// Whether the loop's next piece is a part of that chain.
    pub(super) goes_on: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Form {
    Line(Slant),
    Arc {
        center: DVec2,
        radius: f64,
        turn: f64,
        side: f64,
        /// The area between it and its chord, over π.
        segment: f32,
    },
}

/// How a line runs that is not level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Slant {
    /// Its unit vector, and its length.
    pub(crate) along: DVec2,
    pub(crate) length: f64,
    /// The x that it gains with y, and half of the chord that it cuts from the unit disc's row.
    pub(crate) slope: f64,
    pub(crate) width: f64,
}

impl Slant {
    /// A level line has none, and adds nothing: its ends' neighbours tell of it.
    pub(crate) fn between(from: DVec2, to: DVec2) -> Option<Self> {
        if from.y == to.y {
            return None;
        }
        let length = (to - from).length();
        let along = (to - from) / length;
        Some(Self {
            along,
            length,
            slope: along.x / along.y,
            width: 1.0 / along.y.abs(),
        })
    }
}

/// The area between an arc from one point to another and its chord, over π.
fn segment(from: DVec2, to: DVec2, radius: f64) -> f32 {
    arcs::segment_of((to - from).length_squared() as f32, radius as f32)
}

impl Form {
    /// An arc's centre and radius, its turn and its side.
    pub(super) fn circle(&self) -> Option<(DVec2, f64, [f64; 2])> {
        match *self {
            Self::Line(_) => None,
            Self::Arc {
                center,
                radius,
                turn,
                side,
                ..
            } => Some((center, radius, [turn, side])),
        }
    }
}

/// Arcs of larger radius, in the window's unit, are cut into lines: single precision would not tell them from these.
const LARGEST: f64 = 1024.0;

/// How far lines in place of an arc may move the density: 0.1 level.
pub(crate) const ERROR: f64 = 4e-4;

/// Cuts edges into `pieces`, sorted by where they begin. `wide` is what pixels average over where that is more than a window.
pub(super) fn cut(
    edges: impl Iterator<Item = Edge>,
    window: Window,
    wide: Option<&Wide>,
    pieces: &mut Vec<Piece>,
) {
    pieces.clear();
    // The first piece of the loop that is being cut.
    let (mut first, mut end) = (0, None);
    for edge in edges {
        if end != Some(edge.from()) {
            close(pieces, first, wide);
            first = pieces.len();
        }
        end = Some(edge.to());
        match edge {
            Edge::Line(line) | Edge::Border(line) => push_line(line.from, line.to, pieces),
            Edge::Arc(arc) if window == Window::Square || arc.radius > LARGEST => {
                flatten(&arc, window, ERROR, |from, to| push_line(from, to, pieces));
            }
            Edge::Arc(arc) => push_arc(&arc, first, pieces),
        }
    }
    close(pieces, first, wide);
    sort(pieces, |p| [p.low, p.high, p.from.x, p.to.x]);
}

/// Sorts pieces by where they begin, and by all else that tells them apart: the order of sums is the same wherever loops begin.
pub(crate) fn sort<T>(pieces: &mut [T], key: impl Fn(&T) -> [f64; 4]) {
    pieces.sort_unstable_by(|a, b| {
        let pairs = key(a).into_iter().zip(key(b));
        pairs
            .map(|(a, b)| a.total_cmp(&b))
            .find(|order| order.is_ne())
            .unwrap_or(core::cmp::Ordering::Equal)
    });
}

/// Calls `line` with the lines that edges are drawn as, in units of the penumbra radius. Those in place of an arc may move the density by
/// `error`.
pub(crate) fn each_line(
    edges: impl Iterator<Item = Edge>,
    error: f64,
    mut line: impl FnMut(DVec2, DVec2),
) {
    for edge in edges {
        match edge {
            Edge::Line(straight) | Edge::Border(straight) => line(straight.from, straight.to),
            Edge::Arc(arc) => flatten(&arc, Window::Disc, error, &mut line),
        }
    }
}

/// Ends a loop: joins its last piece with its first where these are one arc, and finds the chains.
fn close(pieces: &mut Vec<Piece>, first: usize, wide: Option<&Wide>) {
    if pieces.len() > first + 1
        && let Some(last) = pieces.last().copied()
        && let Some(joined) = last.joined(&pieces[first])
    {
        pieces[first] = joined;
        pieces.pop();
    }
    if let Some(wide) = wide {
        chains::link(&mut pieces[first..], wide);
    }
}

fn push_line(from: DVec2, to: DVec2, pieces: &mut Vec<Piece>) {
    pieces.extend(Slant::between(from, to).map(|slant| Piece {
        low: from.y.min(to.y),
        high: from.y.max(to.y),
        from,
        to,
        form: Form::Line(slant),
        chain: [from.y.min(to.y), from.y.max(to.y)],
        goes_on: false,
    }));
}

/// Cuts an arc where it is level; where its whole half could be inside the disc, where it is upright too.
fn push_arc(arc: &Arc, first: usize, pieces: &mut Vec<Piece>) {
    let turn = arc.sweep.signum();
    // Cuts are at an odd number of quarter turns, or at every one.
    let (step, phase) = if arc.radius < SQRT_2 {
        (FRAC_PI_2, 0.0)
    } else {
        (PI, FRAC_PI_2)
    };
    let end = arc.start + arc.sweep;
    let mut cut = ((arc.start * turn - phase) / step).floor();
    let (mut from, mut start) = (arc.from, arc.start);
    loop {
        cut += 1.0;
        let angle = (cut * step + phase) * turn;
        if (angle - start) * turn <= 0.0 {
            continue;
        }
        let last = (end - angle) * turn <= 0.0;
        let (to, stop) = if last {
            (arc.to, end)
        } else {
            (extreme(arc, angle), angle)
        };
        let middle = libm::cos((start + stop) / 2.0);
        let piece = Piece {
            low: from.y.min(to.y),
            high: from.y.max(to.y),
            from,
            to,
            form: Form::Arc {
                center: arc.center,
                radius: arc.radius,
                turn,
                side: 1.0_f64.copysign(middle),
                segment: segment(from, to, arc.radius),
            },
            chain: [from.y.min(to.y), from.y.max(to.y)],
            goes_on: false,
        };
        match pieces
            .last()
            .filter(|_| pieces.len() > first)
            .and_then(|last| last.joined(&piece))
        {
            Some(joined) => {
                pieces.pop();
                pieces.push(joined);
            }
            None => pieces.push(piece),
        }
        if last {
            return;
        }
        (from, start) = (to, stop);
    }
}

/// The arc's point at a multiple of a quarter turn.
fn extreme(arc: &Arc, angle: f64) -> DVec2 {
    let quarter = (angle / FRAC_PI_2).round() as i64;
    let direction =
        [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y][quarter.rem_euclid(4) as usize];
    arc.center + direction * arc.radius
}

/// The chord of the pieces that an arc is cut into, of which one may move a disc's density by `error`; in units of the disc's radius.
///
/// Each is replaced by the two lines that enclose as much: what a window sees wholly is exact, and only where it cuts a piece is
/// there an error. With a piece's chord c and sagitta s that is 0.0247 s c for each of the two cut, 0.049 c³ / (8 radius) for both,
/// and no more than s / 3 along the window's width.
pub(crate) fn arc_chord(radius: f64, error: f64) -> f64 {
    chord_of_area(radius, error * PI)
}

/// The same for an area.
fn chord_of_area(radius: f64, area: f64) -> f64 {
    let by_area = libm::cbrt(area * 8.0 * radius / 0.049);
    let by_width = (24.0 * area / 2.0 * radius).sqrt();
    by_area.min(2.0).max(by_width)
}

/// Cuts an arc into pieces and each into two lines.
fn flatten(arc: &Arc, window: Window, error: f64, mut line: impl FnMut(DVec2, DVec2)) {
    let area = match window {
        Window::Disc => PI,
        Window::Square => 1.0,
    };
    let chord = chord_of_area(arc.radius, error * area);
    let count = (arc.sweep.abs() * arc.radius / chord).ceil().max(2.0);
    // A chord's own segment as two lines: the triangle of its area.
    let angle = arc.sweep.abs() / count / 2.0;
    let height = (angle - libm::sin(angle) * libm::cos(angle)) / libm::sin(angle);
    let apex = libm::cos(angle) + height;
    let mut from = arc.from;
    for index in 0..count as u64 {
        let to = if index as f64 + 1.0 == count {
            arc.to
        } else {
            arc.at(arc.start + arc.sweep * ((index as f64 + 1.0) / count))
        };
        let middle = arc.at(arc.start + arc.sweep * ((index as f64 + 0.5) / count));
        let top = arc.center + (middle - arc.center) * apex;
        line(from, top);
        line(top, to);
        from = to;
    }
}

impl Piece {
    /// Whether it is a line straight up or down.
    pub(super) fn is_upright(&self) -> bool {
        matches!(self.form, Form::Line(_)) && self.from.x == self.to.x
    }

    /// This piece and the one after it as one, where they are of one circle and go on the same way.
    fn joined(&self, next: &Self) -> Option<Self> {
        const SAME: f64 = 1e-6;
        let ((center, radius, way), (c, r, w)) = self.form.circle().zip(next.form.circle())?;
        let same = self.to == next.from
            && way == w
            && center.distance(c) < SAME
            && (radius - r).abs() < SAME
            && radius >= SQRT_2;
        let (low, high) = (self.low.min(next.low), self.high.max(next.high));
        let mut joined = Self {
            low,
            high,
            to: next.to,
            chain: [low, high],
            ..*self
        };
        if let Form::Arc { segment: whole, .. } = &mut joined.form {
            *whole = segment(joined.from, joined.to, radius);
        }
        same.then_some(joined)
    }
}
