//! Pieces that go on from one to the next so nearly as one would itself that pixels which are averages hardly show it: one of them
//! stands for all.

use core::f64::consts::PI;

use glam::DVec2;

use super::kernels::Wide;
use super::pieces::{Form, Piece};

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

/// Finds the chains of a loop's pieces.
pub(super) fn link(pieces: &mut [Piece], wide: &Wide) {
    let count = pieces.len();
    let after = |at: usize| (at + 1) % count;
    for at in 0..count {
        pieces[at].goes_on = pieces[at].goes_on_as(&pieces[after(at)], wide);
    }
    // Along the loop and back, and on beyond where it begins.
    let along = (0..2 * count).map(|at| at % count);
    let ways = along.clone().map(|at| (at, at, after(at)));
    for (joint, from, to) in ways.chain(along.rev().map(|at| (at, after(at), at))) {
        if pieces[joint].goes_on {
            let [first, last] = pieces[from].chain;
            let [low, high] = &mut pieces[to].chain;
            (*low, *high) = (low.min(first), high.max(last));
        }
    }
}

impl Piece {
    /// Whether another piece goes on from this one so nearly as it would itself that what pixels average over hardly shows it.
    fn goes_on_as(&self, next: &Self, wide: &Wide) -> bool {
        // By so many levels each a bend of the direction and of the curvature may show.
        const SHOWN: f64 = 0.25;
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
        let shown = |bend: f64, power: f64, of: fn(f64) -> f64| {
            let area = bend.abs() * (of(far) - of(near)) / power;
            area / seen * 255.0 <= SHOWN
        };
        let spokes = [
            (self.to - center) * (turn / radius),
            (next.from - c) * (t / r),
        ];
        spokes[0].dot(spokes[1]) > 0.0
            && shown(spokes[0].perp_dot(spokes[1]), 2.0, |x| x * x)
            && shown((turn / radius - t / r) / 2.0, 3.0, |x| x * x * x)
    }

    /// Whether it is as good as straight to what a pixel averages over.
    #[inline(always)]
    fn is_straight(&self, wide: &Wide) -> bool {
        // Twice 2 levels at most lie between an arc and the line that touches it: so many half heights of the profile.
        const BENT: f64 = 10.4;
        match self.form {
            Form::Line(_) => true,
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
}

#[cfg(test)]
mod tests {
    use super::super::Window;
    use super::super::pieces::cut;
    use super::*;
    use crate::outline::{Arc, Edge};

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
