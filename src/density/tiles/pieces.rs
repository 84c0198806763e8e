//! An outline as lines, and where each of them is among the tiles of a row.

use core::iter::once;

use glam::DVec2;

use super::places::Places;
use super::{Lattice, SIDE};
use crate::density::rows::{Slant, arc_chord, each_line, sort};
use crate::outline::Edge;

/// How far lines in place of an arc may move a density: 0.02 level.
const ARCS: f64 = 8e-5;

/// How near to the disc's an arc's radius is, over it, where the disc's edge runs along many of those lines at once.
const ALONG: f64 = 0.2;

/// A line, which is not level.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) from: DVec2,
    pub(super) to: DVec2,
    pub(super) slant: Slant,
}

/// The tiles of a row from which a piece is seen as one thing and another: right of all discs before the first, cut from the first to
/// the second and from the third to the fourth, inside between, and left of all from the fourth on.
pub(super) type Parts = [usize; 4];

/// Cuts edges into `pieces`, from the top down, in units of the disc's radius from a lattice's corner on.
pub(super) fn cut(edges: &[Edge], radius: f64, lattice: &Lattice, pieces: &mut Vec<Piece>) {
    let scale = 1.0 / radius;
    let place = |point: DVec2| (point - lattice.corner) * scale;
    pieces.clear();
    let mut push = |from: DVec2, to: DVec2| {
        pieces.extend(Slant::between(from, to).map(|slant| Piece {
            low: from.y.min(to.y),
            high: from.y.max(to.y),
            from,
            to,
            slant,
        }));
    };
    for edge in edges {
        let edge = edge.mapped(scale, place);
        each_line(once(edge), share(&edge), &mut push);
    }
    sort(pieces, |p| [p.low, p.high, p.from.x, p.to.x]);
}

/// How far lines in place of an edge may move a density where one of them lies across the disc's edge.
fn share(edge: &Edge) -> f64 {
    match edge {
        Edge::Arc(arc) if (arc.radius - 1.0).abs() < ALONG => {
            // So many may lie there at once, as many again of another arc about the same centre. Each leaves what goes with the third
            // power of its length, and there are more the shorter they are.
            let count = 2.0 * arc.sweep.abs() * arc.radius / arc_chord(arc.radius, ARCS);
            let count = count.max(1.0);
            ARCS / (count * count.sqrt())
        }
        _ => ARCS,
    }
}

impl Piece {
    /// What it is to the tiles of a row whose first samples have the y given.
    #[inline(always)]
    pub(super) fn parts<const N: usize>(
        &self,
        top: f64,
        places: &Places<N>,
        tiles: usize,
    ) -> Parts {
        let (step, spread) = (places.step, places.reach());
        let slant = &self.slant;
        let middle = top + spread;
        let (low, high) = (self.low - middle, self.high - middle);
        // Where the part that discs reach is, and half of the chord at the y nearest to theirs.
        let reach = 1.0 + spread;
        let (left_end, right_end) = (self.from.x.min(self.to.x), self.from.x.max(self.to.x));
        let at = |y: f64| {
            let x = self.from.x + (middle + y - self.from.y) * slant.slope;
            x.max(left_end).min(right_end)
        };
        let (a, b) = (at(low.max(-reach)), at(high.min(reach)));
        let beyond = (low.max(-high) - spread).max(0.0);
        let half = ((1.0 - beyond) * (1.0 + beyond)).max(0.0).sqrt();
        // A disc farther than 1 from the line does not meet it.
        let crossing = self.from.x + (middle - self.from.y) * slant.slope;
        let width = (1.0 + spread * slant.along.x.abs()) * slant.width;
        let left = (a.min(b) - half).max(crossing - width);
        let right = (a.max(b) + half).min(crossing + width);
        // Where both ends are in all discs.
        let chord = |end: DVec2| {
            let y = (end.y - middle).abs() + spread;
            ((1.0 - y) * (1.0 + y)).max(0.0).sqrt()
        };
        let chords = [chord(self.from), chord(self.to)];
        let enters = (self.from.x - chords[0]).max(self.to.x - chords[1]);
        let leaves = (self.from.x + chords[0]).min(self.to.x + chords[1]);

        let per_tile = 1.0 / (SIDE as f64 * step);
        let wide = 2.0 * spread;
        // The first tile that begins after an x, and the first that does not end before it.
        let begins = |x: f64| ((x * per_tile).ceil().max(0.0) as usize).min(tiles);
        let ends = |x: f64| (((x - wide) * per_tile).floor() + 1.0).max(0.0) as usize;
        let first = ends(left).min(tiles);
        let last = begins(right).max(first);
        let inside = if chords[0] > 0.0 && chords[1] > 0.0 {
            [begins(enters), ends(leaves)].map(|tile| tile.clamp(first, last))
        } else {
            [last; 2]
        };
        if inside[0] < inside[1] {
            [first, inside[0], inside[1], last]
        } else {
            [first, last, last, last]
        }
    }
}
