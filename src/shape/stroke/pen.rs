//! A pen: what it covers on its way.
//!
//! Each line of the way is a quadrilateral, each of its turns a join on the outer side, each end a cap. Where they all are gone round
//! counter-clockwise, what one has in common with the next is gone both ways and cancels: left are the two sides of the way, which wind
//! round each point as often as it is covered.

use core::f64::consts::PI;

use glam::DVec2;
use libm::{atan2, cos, sin};

use super::way::Line;
use super::{LineCap, LineJoin, MAX_LINES, Stroke};
use crate::error::Result;
use crate::limits::at_most;
use crate::outline::{Winding, resolve_loops};
use crate::path::arc_steps;

/// The largest `1 / cos²` of half a turn at which the two sides of the way are said to meet.
const SHARPEST: f64 = 1e6;

/// Lines that are united at once where the way bends more tightly than the pen is wide, if it does so more often than this.
const PIECE: usize = 4;

/// One of so many bends that is tight makes all of the way be united in pieces.
const OFTEN: usize = 16;

pub(super) struct Pen {
    /// Half its width.
    half: f64,
    cap: LineCap,
    join: LineJoin,
    /// The least `cos²` of half a turn at which a corner is mitred.
    least: f64,
    pub(super) flatness: f64,
}

/// From one line to the next.
struct Turn {
    /// In the middle between the left normals of both, as long as the cosine of half the turn.
    middle: DVec2,
    cos_squared: f64,
    /// The sine and the cosine of all of it: to the left above 0.
    across: f64,
    along: f64,
}

impl Turn {
    fn new(before: &Line, after: &Line) -> Self {
        let middle = (before.along + after.along).perp() / 2.0;
        Self {
            middle,
            cos_squared: middle.length_squared(),
            across: before.along.perp_dot(after.along),
            along: before.along.dot(after.along),
        }
    }

    fn angle(&self) -> f64 {
        atan2(self.across, self.along)
    }
}

/// A turn as wide as the pen, counted from where it is.
struct Corner<'a> {
    before: &'a Line,
    after: &'a Line,
    at: DVec2,
    turn: Turn,
    /// How far to the left the outer side is.
    side: f64,
    /// Where that ends along the line before and begins along the one after.
    ends: [DVec2; 2],
    /// Where both would meet.
    tip: DVec2,
}

impl<'a> Corner<'a> {
    fn new(before: &'a Line, after: &'a Line, half: f64) -> Self {
        let turn = Turn::new(before, after);
        // Of a turn right back it is the sign of 0 that says on which side it is.
        let side = if turn.across.is_sign_negative() {
            half
        } else {
            -half
        };
        Self {
            before,
            after,
            at: after.from,
            side,
            ends: [before, after].map(|line| side * line.along.perp()),
            tip: turn.middle * (side / turn.cos_squared),
            turn,
        }
    }
}

/// The vertices of the two sides of a way, both in its direction, and what else the pen covers in its bends.
#[derive(Default)]
struct Sides {
    left: Vec<DVec2>,
    right: Vec<DVec2>,
    wedges: Vec<Vec<DVec2>>,
}

/// The loops of pieces of a way, each with the next: what lies within both is gone before others cross it.
fn united(mut pieces: Vec<Vec<Vec<DVec2>>>) -> Vec<Vec<DVec2>> {
    while pieces.len() > 1 {
        let pairs = pieces.chunks(2).map(|pair| match pair {
            [a, b] => resolve_loops(&[a.as_slice(), b].concat(), Winding::Positive, false),
            rest => rest.concat(),
        });
        pieces = pairs.collect();
    }
    pieces.concat()
}

impl Pen {
    pub(super) fn new(stroke: &Stroke, flatness: f64) -> Self {
        let limit = f64::from(stroke.miter_limit);
        Self {
            half: f64::from(stroke.width) / 2.0,
            cap: stroke.cap,
            join: stroke.join,
            least: 1.0 / (limit * limit),
            flatness,
        }
    }

    /// Whether a corner is so slight that it may as well be round or mitred.
    pub(super) fn is_smooth(&self, before: &Line, after: &Line) -> bool {
        self.is_slight(&Turn::new(before, after))
    }

    /// Whether the tip of a mitre is within the flatness of a circle.
    fn is_slight(&self, turn: &Turn) -> bool {
        self.half <= (self.half + self.flatness) * turn.cos_squared.sqrt()
    }

    /// Whether the way bends from one line to the next more tightly than the pen is wide.
    fn is_tight(&self, before: &Line, after: &Line) -> bool {
        let turn = Turn::new(before, after);
        after.bends && self.back(&turn) >= before.room().min(after.room())
    }

    /// Loops that wind round what is covered along a way. `count` is how many lines strokes have so far.
    pub(super) fn cover(
        &self,
        way: &[Line],
        closed: bool,
        count: &mut usize,
    ) -> Result<Vec<Vec<DVec2>>> {
        let is_tight = |pair: &&[Line]| self.is_tight(&pair[0], &pair[1]);
        let bends = way.windows(2).filter(is_tight).count();
        if bends > PIECE {
            // Where many are tight, gentle ones cross them as well.
            let are_many = OFTEN * bends > way.len();
            return self.in_pieces(way, closed, are_many, count);
        }
        let ([first, ..], [.., last]) = (way, way) else {
            return Ok(Vec::new());
        };
        if !closed {
            return self.along(way, [self.cap; 2], count);
        }
        let mut sides = self.sides(way, count)?;
        self.turn(last, first, &mut sides, count)?;
        sides.left.reverse();
        sides.wedges.extend([sides.left, sides.right]);
        Ok(sides.wedges)
    }

    /// The same of a way with bends tighter than the pen is wide: there each line's end crosses all others', so that few at a time are
    /// united first. Each piece begins with the last line of the one before: no gap of rounding is between them.
    fn in_pieces(
        &self,
        way: &[Line],
        closed: bool,
        are_many: bool,
        count: &mut usize,
    ) -> Result<Vec<Vec<DVec2>>> {
        let mut way = way.to_vec();
        if closed && let Some(first) = way.iter().position(|line| !line.is_turn()) {
            way.extend_from_within(..=first);
        }
        let is_tight = |index: usize| self.is_tight(&way[index], &way[index + 1]);
        let (mut all, mut tight) = (Vec::new(), Vec::new());
        let (mut start, last) = (0, way.len() - 1);
        while start < last {
            let bends = is_tight(start);
            let is_end = |index: usize| is_tight(index) != bends || bends && index >= start + PIECE;
            let next = (start + 1..last).find(|&index| is_end(index) && !way[index].is_turn());
            let end = next.unwrap_or(last);
            let cap = |is_end: bool| {
                if is_end && !closed {
                    self.cap
                } else {
                    LineCap::Butt
                }
            };
            let caps = [cap(start == 0), cap(end == last)];
            let mut piece = self.along(&way[start..=end], caps, count)?;
            if bends || are_many {
                tight.push(resolve_loops(&piece, Winding::Positive, false));
            } else {
                all.append(&mut united(core::mem::take(&mut tight)));
                all.append(&mut piece);
            }
            start = end;
        }
        all.append(&mut united(tight));
        Ok(all)
    }

    /// Along an open way, with its first and its last cap.
    fn along(
        &self,
        way: &[Line],
        caps: [LineCap; 2],
        count: &mut usize,
    ) -> Result<Vec<Vec<DVec2>>> {
        let ([first, ..], [.., last]) = (way, way) else {
            return Ok(Vec::new());
        };
        let mut sides = self.sides(way, count)?;
        let mut all = sides.right;
        self.end(caps[1], last.to, last.along, &mut all, count)?;
        all.extend(sides.left.iter().rev());
        self.end(caps[0], first.from, -first.along, &mut all, count)?;
        sides.wedges.push(all);
        Ok(sides.wedges)
    }

    fn sides(&self, way: &[Line], count: &mut usize) -> Result<Sides> {
        let mut sides = Sides::default();
        for pair in way.windows(2) {
            self.turn(&pair[0], &pair[1], &mut sides, count)?;
        }
        Ok(sides)
    }

    /// A cap, from right to left.
    fn end(
        &self,
        cap: LineCap,
        at: DVec2,
        along: DVec2,
        out: &mut Vec<DVec2>,
        count: &mut usize,
    ) -> Result<()> {
        let left = self.half * along.perp();
        match cap {
            LineCap::Butt => out.extend([at - left, at + left]),
            LineCap::Square => {
                let at = at + self.half * along;
                out.extend([at - left, at + left]);
            }
            LineCap::Round => self.round(at, -left, PI, out, count)?,
        }
        Ok(())
    }

    /// How far from a corner the inner sides meet, along either line.
    fn back(&self, turn: &Turn) -> f64 {
        self.half * turn.across.abs() / (2.0 * turn.cos_squared)
    }

    /// From one line to the next: on the outer side the join, on the inner one where the sides meet.
    fn turn(
        &self,
        before: &Line,
        after: &Line,
        sides: &mut Sides,
        count: &mut usize,
    ) -> Result<()> {
        let corner = Corner::new(before, after, self.half);
        let (outer, inner) = if corner.side > 0.0 {
            (&mut sides.left, &mut sides.right)
        } else {
            (&mut sides.right, &mut sides.left)
        };
        self.outside(&corner, outer, count)?;
        let wedge = self.inside(&corner, inner, count)?;
        sides.wedges.extend(wedge);
        Ok(())
    }

    /// The join of a corner, on its outer side.
    fn outside(&self, corner: &Corner, out: &mut Vec<DVec2>, count: &mut usize) -> Result<()> {
        let &Corner { at, ends, .. } = corner;
        let join = if corner.after.bends {
            LineJoin::Round
        } else {
            self.join
        };
        let is_pointed = match join {
            LineJoin::Miter => corner.turn.cos_squared >= self.least,
            LineJoin::Round => self.is_slight(&corner.turn),
            LineJoin::Bevel => false,
        };
        if is_pointed {
            out.push(at + corner.tip);
        } else if join == LineJoin::Round {
            self.round(at, ends[0], corner.turn.angle(), out, count)?;
        } else {
            out.extend(ends.map(|end| at + end));
        }
        Ok(())
    }

    /// Where the sides meet on a corner's inner side, or the way by it where they do not. Gives what is covered besides.
    fn inside(
        &self,
        corner: &Corner,
        out: &mut Vec<DVec2>,
        count: &mut usize,
    ) -> Result<Option<Vec<DVec2>>> {
        let &Corner { at, ends, .. } = corner;
        let (before, after, turn) = (corner.before, corner.after, &corner.turn);
        // The sides meet where neither line needs more than half of its length for it. Elsewhere they go by the way itself, as their
        // quadrilaterals do. Where a curve ends its last line is cut to where the curve heads.
        let back = self.back(turn);
        let (meeting, back) = match (before.is_turn(), after.is_turn()) {
            (false, false) => (corner.tip, back),
            (true, false) if after.bends => (ends[0], 2.0 * back),
            (false, true) if after.bends => (ends[1], 2.0 * back),
            _ => (corner.tip, f64::INFINITY),
        };
        if back < before.room().min(after.room()) && SHARPEST * turn.cos_squared >= 1.0 {
            out.push(at - meeting);
            return Ok(None);
        }
        out.extend([at - ends[0], at, at - ends[1]]);
        // In a bend much tighter than the pen is wide its inner end sweeps back over what neither line's quadrilateral covers.
        let swept = ends[0].distance(ends[1]);
        let is_tight = after.bends && swept > before.length() + after.length();
        if !is_tight {
            return Ok(None);
        }
        let mut wedge = vec![at];
        if self.is_slight(turn) {
            wedge.extend(ends.map(|end| at - end));
        } else {
            self.round(at, -ends[0], turn.angle(), &mut wedge, count)?;
        }
        if corner.side > 0.0 {
            wedge.reverse();
        }
        Ok(Some(wedge))
    }

    /// An arc about a point from `start` (counted from it), as the tips of lines that touch it.
    fn round(
        &self,
        at: DVec2,
        start: DVec2,
        angle: f64,
        out: &mut Vec<DVec2>,
        count: &mut usize,
    ) -> Result<()> {
        let steps = arc_steps(self.half + self.flatness, angle, self.flatness);
        *count = count.saturating_add(steps as usize);
        at_most("lines of a stroke", *count, MAX_LINES)?;
        let step = angle / f64::from(steps);
        let start = start / cos(step / 2.0);
        out.extend((0..steps).map(|index| {
            let turned = step * (f64::from(index) + 0.5);
            at + start * cos(turned) + start.perp() * sin(turned)
        }));
        Ok(())
    }
}
