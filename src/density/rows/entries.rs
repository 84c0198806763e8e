//! What each piece does to a row, and the steps that its passing adds.

use core::ops::Range;

use super::Lattice;
use super::kernels::Wide;
use super::pieces::Piece;
use super::points::Line;
use crate::density::lanes::LANES;

/// Steps count whole units of 2^-30 of density.
pub(super) const UNIT: f64 = (1_u64 << 30) as f64;

/// What one piece of the outline does to a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) first: i64,
    pub(super) end: i64,
    /// What its passing adds to all columns from `end` on.
    pub(super) step: i64,
    pub(super) piece: u32,
    /// Which of the rows of points it is seen from, or [`ALL`] of them at once.
    pub(super) line: u32,
    /// The window's half at the y of its two ends.
    pub(super) halves: [f32; 2],
}

/// The number of no row of points.
pub(super) const ALL: u32 = u32::MAX;

/// The columns of the entries from one on that follow each other without a gap, and the first of those after them; `reached` tells each
/// one's first column and its end.
#[inline(always)]
pub(super) fn cluster(
    start: usize,
    count: usize,
    reached: impl Fn(usize) -> [i64; 2],
) -> ([i64; 2], usize) {
    let [first, mut end] = reached(start);
    let mut next = start + 1;
    while next < count {
        let [other, other_end] = reached(next);
        if other > end {
            break;
        }
        end = end.max(other_end);
        next += 1;
    }
    ([first, end], next)
}

pub(super) fn density(steps: i64) -> f32 {
    ((steps as f64 / UNIT) as f32).clamp(0.0, 1.0)
}

/// What a piece adds to all on its right, seen from a row of points. Each end is rounded alone, so that what follows cancels
/// it.
#[inline(always)]
pub(super) fn step(line: &Line, halves: [f32; 2]) -> i64 {
    let whole = |half: f32| (2.0 * UNIT * line.weight * f64::from(half)) as i64;
    whole(halves[0]) - whole(halves[1])
}

/// Makes the entries of one row.
pub(super) struct Maker<'a> {
    pub(super) columns: Range<i64>,
    pub(super) lattice: &'a Lattice,
    pub(super) width: f64,
    pub(super) entries: &'a mut Vec<Entry>,
    pub(super) before: &'a mut i64,
}

impl Maker<'_> {
    #[inline(always)]
    pub(super) fn add(&mut self, index: u32, piece: &Piece, y: f64, number: u32, line: &Line) {
        let window = self.lattice.window;
        let reach = window.reach();
        if piece.low >= y + reach || piece.high <= y - reach {
            return;
        }
        let halves = [piece.from.y - y, piece.to.y - y].map(|rise| window.half(rise));
        let spread = line.spread * self.width * self.lattice.pitch;
        let extent = piece.extent([y; 2], window);
        let step = step(line, halves);
        self.push(index, number, halves, step, extent, spread);
    }

    /// Adds a piece that passes all that a pixel averages over.
    #[inline(always)]
    pub(super) fn add_wide(
        &mut self,
        index: u32,
        piece: &Piece,
        y: f64,
        wide: &Wide,
        lines: &[Line],
    ) {
        let falls = 0.25_f32.copysign((piece.from.y - piece.to.y) as f32);
        let halves = [falls, -falls];
        // As the rows of points would have it one by one, so that pieces that end in them cancel it.
        let step = lines.iter().map(|line| step(line, halves)).sum();
        self.push(index, ALL, halves, step, piece.wide_extent(y, wide), 0.0);
    }

    #[inline(always)]
    fn push(
        &mut self,
        index: u32,
        number: u32,
        halves: [f32; 2],
        step: i64,
        [left, right]: [f64; 2],
        spread: f64,
    ) {
        // One column to spare on both sides, whichever way these are rounded.
        let column = |x: f64| ((x - self.lattice.start) * self.lattice.density) as i64;
        let first = column(left - spread) - 1;
        let end = column(right + spread) + 2;
        let stride = LANES as i64;
        let end = first + (end - first + stride - 1) / stride * stride;
        if end <= self.columns.start {
            *self.before += step;
        } else if first < self.columns.end {
            self.entries.push(Entry {
                first,
                end,
                step,
                piece: index,
                line: number,
                halves,
            });
        }
    }
}
