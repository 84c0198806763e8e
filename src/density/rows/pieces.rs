//! The outline cut into pieces along which y only rises or only falls.

use core::f64::consts::{FRAC_PI_2, PI, SQRT_2};

use glam::DVec2;

use super::kernels::{self, LEAST_SPAN, Ramp, RowArc, RowCut, RowLine, Wide, WideArc, WideLine};
use super::{Lattice, RowForm, Window};
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
}

/// How a piece stands to all that the pixels of a row average over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Passing {
    /// It passes it, or stands for its chain, which does.
    All,
    /// Its chain passes it, and another piece stands for that.
    Elsewhere,
    /// It may end within it.
    Not,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Form {
    /// Its unit vector, its length, the x it gains with y, and half the chord that it cuts from the unit disc's row.
    Line {
        along: DVec2,
        length: f64,
        slope: f64,
        width: f64,
    },
    Arc {
        center: DVec2,
        radius: f64,
        turn: f64,
        side: f64,
        /// The area between it and its chord, over π.
        segment: f32,
    },
}

/// The area between an arc from one point to another and its chord, over π.
fn segment(from: DVec2, to: DVec2, radius: f64) -> f32 {
    kernels::segment_of((to - from).length_squared() as f32, radius as f32)
}

impl Form {
    /// An arc's centre and radius, its turn and its side.
    fn circle(&self) -> Option<(DVec2, f64, [f64; 2])> {
        match *self {
            Self::Line { .. } => None,
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
    let key = |p: &Piece| [p.low, p.high, p.from.x, p.to.x];
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
        link(&mut pieces[first..], wide);
    }
}

/// Finds the chains of a loop's pieces.
fn link(pieces: &mut [Piece], wide: &Wide) {
    let count = pieces.len();
    // Along the loop and back, and on beyond where it begins.
    let along = (0..2 * count).map(|at| (at % count, (at + 1) % count));
    let back = along.clone().rev().map(|(from, to)| (to, from));
    for (from, to) in along.chain(back) {
        let (a, b) = (pieces[from], pieces[to]);
        if a.goes_on(&b, wide) || b.goes_on(&a, wide) {
            let [low, high] = &mut pieces[to].chain;
            (*low, *high) = (low.min(a.chain[0]), high.max(a.chain[1]));
        }
    }
}

fn push_line(from: DVec2, to: DVec2, pieces: &mut Vec<Piece>) {
    // A level line adds nothing: its ends' neighbours tell of it.
    if from.y == to.y {
        return;
    }
    let length = (to - from).length();
    let along = (to - from) / length;
    pieces.push(Piece {
        low: from.y.min(to.y),
        high: from.y.max(to.y),
        from,
        to,
        form: Form::Line {
            along,
            length,
            slope: along.x / along.y,
            width: 1.0 / along.y.abs(),
        },
        chain: [from.y.min(to.y), from.y.max(to.y)],
    });
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
        matches!(self.form, Form::Line { .. }) && self.from.x == self.to.x
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

    /// Whether another piece goes on from this one so nearly as it would itself that what pixels average over hardly shows it.
    fn goes_on(&self, next: &Self, wide: &Wide) -> bool {
        // By so many levels each a bend of the direction and of the curvature may show.
        const SHOWN: f64 = 0.15;
        let Some(((center, radius, [turn, side]), (c, r, [t, s]))) =
            self.form.circle().zip(next.form.circle())
        else {
            return false;
        };
        let reach = wide.half + wide.radius;
        // What is as high is met with one bend at most above its middle and one below it.
        let fits = |piece: &Self| piece.is_straight(wide) && piece.high - piece.low >= reach;
        if self.to != next.from || turn * side != t * s || !fits(self) || !fits(next) {
            return false;
        }
        // A row sees one of both as far beyond the bend as the windows are high: along a flat border that is far.
        let height = if self.from.y < self.to.y {
            reach
        } else {
            -reach
        };
        let along = |center: DVec2, radius: f64, height: f64| {
            let turn = |y: f64| libm::asin(((y - center.y) / radius).clamp(-1.0, 1.0));
            radius * (turn(self.to.y + height) - turn(self.to.y)).abs()
        };
        let far = along(center, radius, -height).max(along(c, r, height));
        // A bend of the direction by b leaves b s² / 2 of the area up to the distance s from it, one of the curvature b s³ / 6; of
        // that a window sees its own width.
        let seen = (PI * wide.radius * wide.radius).max(4.0 * wide.half * wide.half);
        let near = (far - 2.0 * reach).max(0.0);
        let shown = |bend: f64, power: i32| {
            let area = bend.abs() * (far.powi(power) - near.powi(power)) / f64::from(power);
            area / seen * 255.0 <= SHOWN
        };
        let spokes = [
            (self.to - center) * (turn / radius),
            (next.from - c) * (t / r),
        ];
        spokes[0].dot(spokes[1]) > 0.0
            && shown(spokes[0].perp_dot(spokes[1]), 2)
            && shown((turn / radius - t / r) / 2.0, 3)
    }

    #[inline(always)]
    fn x_at(&self, y: f64) -> f64 {
        match self.form {
            Form::Line { slope, .. } => self.from.x + (y - self.from.y) * slope,
            Form::Arc {
                center,
                radius,
                side,
                ..
            } => {
                let rise = y - center.y;
                center.x + side * (radius * radius - rise * rise).max(0.0).sqrt()
            }
        }
    }

    /// Where the part of the piece that windows in the row at `y` meet begins and ends, from the row.
    #[inline(always)]
    fn met(&self, y: f64, window: Window) -> [f64; 2] {
        let reach = window.reach();
        [(self.low - y).max(-reach), (self.high - y).min(reach)]
    }

    /// The least and the largest x from which a window in the row at `y` meets the piece.
    #[inline(always)]
    pub(super) fn extent(&self, y: f64, window: Window) -> [f64; 2] {
        let [low, high] = self.met(y, window);
        let (a, b) = (self.x_at(y + low), self.x_at(y + high));
        let reach = match self.form {
            // Half of the disc's widest chord between the two heights: lines are too cheap for it to pay.
            Form::Arc { .. } => {
                let nearest = low.max(-high).max(0.0);
                (1.0 - nearest * nearest).sqrt()
            }
            Form::Line { .. } => window.reach(),
        };
        let (mut left, mut right) = (a.min(b) - reach, a.max(b) + reach);
        if window == Window::Square {
            return [left, right];
        }
        match self.form {
            Form::Line { slope, width, .. } => {
                // A disc farther than 1 from the line does not meet it.
                let middle = self.from.x + (y - self.from.y) * slope;
                left = left.max(middle - width);
                right = right.min(middle + width);
            }
            Form::Arc {
                center,
                radius,
                side,
                ..
            } => {
                let rise = center.y - y;
                if low <= rise && rise <= high {
                    let farthest = center.x + side * radius;
                    left = left.min(farthest - reach);
                    right = right.max(farthest + reach);
                }
                // A disc farther than 1 from the circle does not meet it. Above and below the circle's middle part a disc beside the centre
                // may meet either half.
                let beside = |r: f64| center.x + side * (r * r - rise * rise).max(0.0).sqrt();
                let ends = [radius - 1.0, radius + 1.0];
                let inner = (rise.abs() < ends[0]).then(|| beside(ends[0]));
                let outer = beside(ends[1]);
                let (least, most) = if side > 0.0 {
                    (inner.unwrap_or(left), outer)
                } else {
                    (outer, inner.unwrap_or(right))
                };
                (left, right) = (left.max(least), right.min(most));
            }
        }
        [left, right.max(left)]
    }

    /// Whether it is as good as straight to what a pixel averages over.
    #[inline(always)]
    fn is_straight(&self, wide: &Wide) -> bool {
        // Twice 2 levels at most lie between an arc and the line that touches it: so many half heights of the profile.
        const BENT: f64 = 10.4;
        match self.form {
            Form::Line { .. } => true,
            Form::Arc { radius, .. } => {
                let squares = wide.half * wide.half + wide.radius * wide.radius;
                radius * wide.half.max(wide.radius) >= BENT * squares
            }
        }
    }

    /// Whether it passes the whole height of what a pixel of the row at `y` averages over, and is straight enough there.
    #[inline(always)]
    pub(super) fn passes(&self, y: f64, wide: &Wide) -> Passing {
        let reach = wide.half + wide.radius;
        let [low, high] = self.chain;
        if y - reach < low || high < y + reach || !self.is_straight(wide) {
            Passing::Not
        } else if self.low <= y && y < self.high {
            Passing::All
        } else {
            Passing::Elsewhere
        }
    }

    /// The least and the largest x from which a pixel of the row at `y` averages over points that see the piece.
    #[inline(always)]
    pub(super) fn wide_extent(&self, y: f64, wide: &Wide) -> [f64; 2] {
        let reach = wide.half + wide.radius;
        match self.form {
            Form::Line {
                along,
                slope,
                width,
                ..
            } => {
                let middle = self.from.x + (y - self.from.y) * slope;
                let across = along.x.abs() + along.y.abs();
                let reach = (wide.radius + wide.half * across) * width;
                [middle - reach, middle + reach]
            }
            Form::Arc {
                center,
                radius,
                side,
                ..
            } => {
                let (a, b) = (self.x_at(y - reach), self.x_at(y + reach));
                let (mut left, mut right) = (a.min(b) - reach, a.max(b) + reach);
                if (center.y - y).abs() <= reach {
                    let farthest = center.x + side * radius;
                    left = left.min(farthest - reach);
                    right = right.max(farthest + reach);
                }
                [left, right]
            }
        }
    }

    /// The piece that passes all that pixels average over, as a row sees it from its column at `origin`.
    #[inline(always)]
    pub(super) fn seen_widely(&self, origin: DVec2, lattice: &Lattice, wide: &Wide) -> RowForm {
        let ramp = |start: f64, slope: f64| Ramp {
            start: start as f32,
            step: (-slope * lattice.pitch) as f32,
        };
        let (half, radius) = (wide.half as f32, wide.radius as f32);
        match self.form {
            Form::Line { along, .. } => {
                let [a, b] = [along.x, along.y].map(|part| part.abs() as f32 * half);
                RowForm::WideLine(WideLine {
                    distance: ramp((self.from - origin).perp_dot(along), along.y),
                    spans: [a.max(b), a.min(b).max(LEAST_SPAN * half)],
                    radius,
                })
            }
            Form::Arc {
                center,
                radius: arc_radius,
                turn,
                side,
                ..
            } => {
                let seen = center - origin;
                RowForm::WideArc(WideArc {
                    center: ramp(seen.x, 1.0),
                    center_y: seen.y as f32,
                    arc_radius: arc_radius as f32,
                    turn: turn as f32,
                    side: side as f32,
                    half,
                    radius,
                })
            }
        }
    }

    /// The piece as a row sees it from its column at `origin`.
    #[inline(always)]
    pub(super) fn seen_from(&self, origin: DVec2, lattice: &Lattice, halves: [f32; 2]) -> RowForm {
        let [low, high] = self.met(origin.y, lattice.window);
        let (from, to) = (self.from - origin, self.to - origin);
        let passes = self.low <= origin.y - 1.0 && self.high >= origin.y + 1.0;
        let ramp = |start: f64, slope: f64| Ramp {
            start: start as f32,
            step: (-slope * lattice.pitch) as f32,
        };
        match self.form {
            Form::Line { along, .. } if lattice.window == Window::Square => {
                let ends = [low, high].map(|rise| ramp(self.x_at(origin.y + rise) - origin.x, 1.0));
                let upwards = along.y > 0.0;
                RowForm::Cut(RowCut {
                    ends,
                    height: if upwards { high - low } else { low - high } as f32,
                })
            }
            Form::Line { along, length, .. } => {
                let distance = ramp(from.perp_dot(along), along.y);
                if passes {
                    return RowForm::ThroughLine(distance);
                }
                RowForm::Line(RowLine {
                    distance,
                    start: ramp(from.dot(along), along.x),
                    length: length as f32,
                    along: along.as_vec2().to_array(),
                    halves,
                })
            }
            Form::Arc {
                center,
                radius,
                turn,
                side,
                segment,
            } => {
                let seen = center - origin;
                let end = |end: DVec2| {
                    // Negative where the end is above or below the disc.
                    let width = 1.0 - end.y * end.y;
                    let width = if width > 0.0 { width.sqrt() } else { -1.0 };
                    [end.x - seen.x, end.y, width].map(|v| v as f32)
                };
                // The end that is less high or low, if any is within the disc's height.
                let nearer = if from.y.abs() < to.y.abs() { from } else { to };
                let middle = if nearer.y.abs() < 1.0 {
                    nearer.x
                } else {
                    self.x_at(origin.y + (low + high) / 2.0) - origin.x
                };
                let arc = RowArc {
                    center: ramp(seen.x, 1.0),
                    center_y: seen.y as f32,
                    radius: radius as f32,
                    power: [
                        (seen.x * seen.x + (seen.y - radius) * (seen.y + radius)) as f32,
                        (-2.0 * seen.x * lattice.pitch) as f32,
                        (lattice.pitch * lattice.pitch) as f32,
                    ],
                    turn: turn as f32,
                    side: side as f32,
                    from: end(from),
                    to: end(to),
                    middle: (middle - seen.x) as f32,
                    halves,
                    segment,
                };
                if radius < SQRT_2 {
                    RowForm::Arc(arc)
                } else if passes {
                    RowForm::ThroughArc(arc)
                } else {
                    RowForm::LongArc(arc)
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the x axis on, an arc about the origin and another that goes on from it: by so much larger and with its direction
    /// bent by an angle.
    fn arcs(larger: f64, bend: f64, turns: [f64; 2]) -> Vec<Piece> {
        arcs_from(0.1, larger, bend, turns)
    }

    /// The same from another angle on.
    fn arcs_from(begin: f64, larger: f64, bend: f64, turns: [f64; 2]) -> Vec<Piece> {
        let arc = |center: DVec2, radius: f64, start: f64, sweep: f64| Arc {
            center,
            radius,
            start,
            sweep,
            from: center + radius * DVec2::from_angle(start),
            to: center + radius * DVec2::from_angle(start + sweep),
        };
        let first = arc(DVec2::ZERO, 30.0, begin, turns[0]);
        let (radius, start) = (30.0 + larger, begin + turns[0] + bend);
        let center = first.to - radius * DVec2::from_angle(start);
        let mut next = arc(center, radius, start, turns[1]);
        next.from = first.to;
        let mut pieces = Vec::new();
        let wide = Wide {
            half: 0.5,
            radius: 1.0,
        };
        let edges = [first, next].map(Edge::Arc);
        cut(edges.into_iter(), Window::Disc, Some(&wide), &mut pieces);
        pieces
    }

    #[test]
    fn arcs_that_go_on_as_they_were_are_one_chain() {
        let turns = [0.3, 0.4];
        for (larger, bend, is_one) in [
            (0.5, 0.0, true),
            (0.5, 1e-4, true),
            (0.5, 0.05, false),
            (60.0, 0.0, false),
        ] {
            let pieces = arcs(larger, bend, turns);
            let whole = [pieces[0].low, pieces[1].high];
            let chains = [pieces[0].chain, pieces[1].chain];
            assert_eq!(chains == [whole; 2], is_one, "{larger}, {bend}");
        }
        // Too low to be met with one bend only.
        let pieces = arcs(0.5, 0.0, [0.3, 0.04]);
        assert_eq!(pieces[0].chain, [pieces[0].low, pieces[0].high]);
    }

    #[test]
    fn a_bend_counts_as_far_along_a_flat_border_as_a_row_sees_it() {
        for (start, is_one) in [(0.1, true), (0.9, false)] {
            let pieces = arcs_from(start, 0.5, 0.0, [0.2, 0.2]);
            let whole = [pieces[0].low, pieces[1].high];
            assert_eq!(pieces[0].chain == whole, is_one, "{start}");
        }
    }

    #[test]
    fn one_piece_of_a_chain_stands_for_it() {
        let pieces = arcs(0.5, 0.0, [0.3, 0.4]);
        let wide = Wide {
            half: 0.5,
            radius: 1.0,
        };
        let joint = pieces[0].high;
        assert_eq!(joint, pieces[1].low);
        let passing = |y: f64| [0, 1].map(|piece| pieces[piece].passes(y, &wide));
        assert_eq!(passing(joint - 0.7), [Passing::All, Passing::Elsewhere]);
        assert_eq!(passing(joint), [Passing::Elsewhere, Passing::All]);
        assert_eq!(passing(pieces[0].low + 1.0), [Passing::Not; 2]);
    }
}
