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
use crate::path::arc_steps;

/// The largest `1 / cos²` of half a turn at which the two sides of the way are said to meet.
const SHARPEST: f64 = 1e6;

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

/// The vertices of the two sides of a way, both in its direction, and what else the pen covers in its bends.
#[derive(Default)]
struct Sides {
    left: Vec<DVec2>,
    right: Vec<DVec2>,
    wedges: Vec<Vec<DVec2>>,
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

    /// Loops that wind round what is covered along a way. `count` is how many lines strokes have so far.
    pub(super) fn along(
        &self,
        way: &[Line],
        closed: bool,
        count: &mut usize,
    ) -> Result<Vec<Vec<DVec2>>> {
        let mut sides = Sides::default();
        for pair in way.windows(2) {
            self.turn(&pair[0], &pair[1], &mut sides, count)?;
        }
        let ([first, ..], [.., last]) = (way, way) else {
            return Ok(Vec::new());
        };
        if closed {
            self.turn(last, first, &mut sides, count)?;
            sides.left.reverse();
            sides.wedges.extend([sides.left, sides.right]);
            return Ok(sides.wedges);
        }
        let mut all = sides.right;
        self.end(last.to, last.along, &mut all, count)?;
        all.extend(sides.left.iter().rev());
        self.end(first.from, -first.along, &mut all, count)?;
        sides.wedges.push(all);
        Ok(sides.wedges)
    }

    /// A cap, from right to left.
    fn end(&self, at: DVec2, along: DVec2, out: &mut Vec<DVec2>, count: &mut usize) -> Result<()> {
        let left = self.half * along.perp();
        match self.cap {
            LineCap::Butt => out.extend([at - left, at + left]),
            LineCap::Square => {
                let at = at + self.half * along;
                out.extend([at - left, at + left]);
            }
            LineCap::Round => self.round(at, -left, PI, out, count)?,
        }
        Ok(())
    }

    /// From one line to the next: on the outer side the join, on the inner one where the sides meet.
    fn turn(
        &self,
        before: &Line,
        after: &Line,
        sides: &mut Sides,
        count: &mut usize,
    ) -> Result<()> {
        let at = after.from;
        let turn = Turn::new(before, after);
        // Of a turn right back it is the sign of 0 that says on which side it is.
        let (outer, inner, side) = if turn.across.is_sign_negative() {
            (&mut sides.left, &mut sides.right, self.half)
        } else {
            (&mut sides.right, &mut sides.left, -self.half)
        };
        let corners = [side * before.along.perp(), side * after.along.perp()];
        let tip = turn.middle * (side / turn.cos_squared);
        let join = if after.bends {
            LineJoin::Round
        } else {
            self.join
        };
        let is_pointed = match join {
            LineJoin::Miter => turn.cos_squared >= self.least,
            LineJoin::Round => self.is_slight(&turn),
            LineJoin::Bevel => false,
        };
        if is_pointed {
            outer.push(at + tip);
        } else if join == LineJoin::Round {
            self.round(at, corners[0], turn.angle(), outer, count)?;
        } else {
            outer.extend(corners.map(|corner| at + corner));
        }
        // The sides meet where neither line needs more than half of its length for it. Elsewhere they go by the way itself, as their
        // quadrilaterals do. Where a curve ends its last line is cut to where the curve heads.
        let back = self.half * turn.across.abs() / (2.0 * turn.cos_squared);
        let (meeting, back) = match (before.is_turn(), after.is_turn()) {
            (false, false) => (tip, back),
            (true, false) if after.bends => (corners[0], 2.0 * back),
            (false, true) if after.bends => (corners[1], 2.0 * back),
            _ => (tip, f64::INFINITY),
        };
        if back < before.room().min(after.room()) && SHARPEST * turn.cos_squared >= 1.0 {
            inner.push(at - meeting);
        } else {
            inner.extend([at - corners[0], at, at - corners[1]]);
            // In a bend tighter than the pen is wide its inner end sweeps back over what no line's quadrilateral covers.
            if after.bends {
                let mut wedge = vec![at];
                if self.is_slight(&turn) {
                    wedge.extend(corners.map(|corner| at - corner));
                } else {
                    self.round(at, -corners[0], turn.angle(), &mut wedge, count)?;
                }
                if side > 0.0 {
                    wedge.reverse();
                }
                sides.wedges.push(wedge);
            }
        }
        Ok(())
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
