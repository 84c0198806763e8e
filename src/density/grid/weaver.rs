//! The last rows of a lattice, how well they foretell each other, and the pixels between.

use core::ops::Range;

use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16};

use super::strips::BLOCK;
use super::sums::SumSource;
use crate::density::{Sink, cubic, join};

/// Rows of the lattice that are kept: the four that a pixel is interpolated from, and three more on both sides to foretell
/// them from.
const RING: i64 = 10;

/// Up to where a density is about 0.
const END: f32 = 0.03;

/// A row of the lattice.
#[derive(Debug, Default)]
pub(super) struct Row {
    pub(super) densities: Vec<f32>,
    /// Where runs of pixels end, from left to right without a gap, with their density where it is one.
    runs: Vec<(i64, Option<f32>)>,
    /// The pixels of each block that are not as their neighbours foretell, a bit each.
    surprises: Vec<u64>,
}

impl Row {
    pub(super) fn push_run(&mut self, end: i64, constant: Option<f32>) {
        match self.runs.last_mut() {
            Some((last, density)) if *density == constant => *last = end,
            _ => self.runs.push((end, constant)),
        }
    }
}

/// What is kept of a lattice.
#[derive(Debug, Default)]
pub(super) struct Woven {
    /// Its last rows.
    ring: [Row; RING as usize],
    /// Columns of pixels that are drawn one by one between two rows.
    pub(super) coarse: Vec<Range<i64>>,
    /// The row and the column of each point that sees an arc of the disc's own radius all at once.
    pub(super) tips: Vec<[i64; 2]>,
    values: Vec<f32>,
}

/// A line of pixels: the row of the lattice above it, the weights of the four rows about it, its number on the grid and the
/// column at which the grid begins.
pub(super) struct WovenLine {
    knot: i64,
    weights: [f32; 4],
    number: u32,
    origin: i64,
}

/// Goes down the lattice row by row.
pub(super) struct Weaver<'a> {
    pub(super) source: SumSource<'a>,
    pub(super) kept: &'a mut Woven,
    pub(super) columns: Range<i64>,
    /// The column of the first block of pixels, and how many blocks there are.
    pub(super) first: i64,
    pub(super) blocks: usize,
    /// The next row of the lattice.
    pub(super) next: i64,
    /// The row below which coarse columns were found last.
    pub(super) cell: Option<i64>,
    /// How far a density may be from what is foretold, and one of about 0 or 1.
    pub(super) limits: [f32; 2],
    /// So many pixels beside those that are foretold badly are no better.
    pub(super) near: i64,
}

impl Weaver<'_> {
    /// Weaves what a line `down` so many rows of the lattice needs, and finds its coarse columns.
    #[inline(always)]
    pub(super) fn go_to<S: Simd>(
        &mut self,
        simd: S,
        down: f64,
        number: u32,
        origin: i64,
    ) -> WovenLine {
        let knot = down.floor() as i64;
        self.weave_to(simd, knot - 4, knot + 5);
        if self.cell != Some(knot) {
            self.find_coarse(simd, knot, self.cell == Some(knot - 1));
            self.cell = Some(knot);
        }
        WovenLine {
            knot,
            weights: cubic::weights(down - knot as f64),
            number,
            origin,
        }
    }

    /// Computes the lattice's rows from `first` to `last`.
    #[inline(always)]
    fn weave_to<S: Simd>(&mut self, simd: S, first: i64, last: i64) {
        // Rows that no pixel needs are passed over.
        self.next = self.next.max(first);
        while self.next <= last {
            self.weave(simd, self.next);
            self.next += 1;
        }
    }

    #[inline(always)]
    fn weave<S: Simd>(&mut self, simd: S, row: i64) {
        let woven = &mut self.kept.ring[row.rem_euclid(RING) as usize];
        woven.runs.clear();
        woven.densities.resize(self.blocks * BLOCK, 0.0);
        self.source.weave(simd, row, woven);
    }

    /// Finds the columns of the pixels below a row of the lattice for which its rows are too far apart. `went_on`: the last
    /// time it was the row above.
    #[inline(always)]
    fn find_coarse<S: Simd>(&mut self, simd: S, row: i64, went_on: bool) {
        let new = if went_on { row + 2 } else { row - 1 };
        for row in new..=row + 2 {
            self.surprise(simd, row);
        }
        let Woven {
            ring, coarse, tips, ..
        } = &mut *self.kept;
        let at = |offset: i64| &ring[(row + offset).rem_euclid(RING) as usize].surprises;
        coarse.clear();
        let near = self.near;
        let outer = at(-1).iter().zip(at(2));
        for (block, ((a, b), (c, d))) in at(0).iter().zip(at(1)).zip(outer).enumerate() {
            let bits = a | b | c | d;
            if bits == 0 {
                continue;
            }
            // Each block by itself: which others are drawn changes nothing.
            let first = self.first + (block * BLOCK) as i64;
            let start = first + (i64::from(bits.trailing_zeros()) - near).max(0);
            let end = i64::from(u64::BITS - bits.leading_zeros()) + near;
            let end = (first + end.min(BLOCK as i64)).min(self.columns.end);
            let start = start.max(self.columns.start);
            match coarse.last_mut() {
                Some(last) if last.end >= start => last.end = last.end.max(end),
                _ if start < end => coarse.push(start..end),
                _ => {}
            }
        }
        for &[tip, column] in &*tips {
            if (tip - row).abs() <= 1 {
                let start = (column - near).max(self.columns.start);
                let end = (column + near + 1).min(self.columns.end);
                if start < end {
                    coarse.push(start..end);
                }
            }
        }
        if !tips.is_empty() {
            join(coarse);
        }
    }

    /// Finds the pixels of a row that its neighbours at one and three rows foretell badly.
    #[inline(always)]
    fn surprise<S: Simd>(&mut self, simd: S, row: i64) {
        let ring = &mut self.kept.ring;
        let mut surprises = core::mem::take(&mut ring[row.rem_euclid(RING) as usize].surprises);
        surprises.clear();
        let near = |offset: i64| {
            let row = &ring[(row + offset).rem_euclid(RING) as usize];
            row.densities.as_chunks::<BLOCK>().0.iter()
        };
        let [limit, end_limit] = self.limits.map(|limit| f32x16::splat(simd, limit));
        let (half, middle) = (f32x16::splat(simd, 0.5), f32x16::splat(simd, 0.5 - END));
        let outer = near(-3).zip(near(3));
        for ((here, (a, b)), (c, d)) in near(0).zip(near(-1).zip(near(1))).zip(outer) {
            let here = f32x16::from_slice(simd, here);
            let (a, b) = (f32x16::from_slice(simd, a), f32x16::from_slice(simd, b));
            let (c, d) = (f32x16::from_slice(simd, c), f32x16::from_slice(simd, d));
            let surprise = here - ((a + b) * (9.0 / 16.0) - (c + d) * (1.0 / 16.0));
            let at_end = (here - half).abs().simd_gt(middle);
            let limit = at_end.select(end_limit, limit);
            surprises.push(surprise.abs().simd_gt(limit).to_bitmask());
        }
        ring[row.rem_euclid(RING) as usize].surprises = surprises;
    }

    /// Gives `sink` those pixels of a line below a row of the lattice that are not coarse.
    #[inline(always)]
    pub(super) fn give_between<S: Simd>(
        &mut self,
        simd: S,
        line: &WovenLine,
        columns: &Range<i64>,
        sink: &mut dyn Sink,
    ) {
        let mut at = columns.start;
        for coarse in 0..self.kept.coarse.len() {
            let coarse = &self.kept.coarse[coarse];
            let coarse = coarse.start.max(at)..coarse.end.min(columns.end);
            if !coarse.is_empty() {
                self.give(simd, line, at..coarse.start, sink);
                at = coarse.end;
            }
        }
        self.give(simd, line, at..columns.end, sink);
    }

    /// Gives `sink` pixels of a line, interpolated.
    #[inline(always)]
    fn give<S: Simd>(
        &mut self,
        simd: S,
        line: &WovenLine,
        columns: Range<i64>,
        sink: &mut dyn Sink,
    ) {
        let WovenLine {
            knot: row,
            weights,
            number,
            origin,
        } = *line;
        let Woven { ring, values, .. } = &mut *self.kept;
        let rows = [-1, 0, 1, 2].map(|offset| &ring[(row + offset).rem_euclid(RING) as usize]);
        let mut runs = [0; 4];
        let mut at = columns.start;
        while at < columns.end {
            let mut end = columns.end;
            let (mut constant, mut alike) = (Some(0.0), true);
            for index in 0..4 {
                while self.first + rows[index].runs[runs[index]].0 <= at {
                    runs[index] += 1;
                }
                let (run_end, density) = rows[index].runs[runs[index]];
                end = end.min(self.first + run_end);
                alike &= density == rows[0].runs[runs[0]].1;
                constant = constant
                    .zip(density)
                    .map(|(sum, density)| sum + density * weights[index]);
            }
            if alike {
                // Whatever the weights add up to.
                constant = rows[0].runs[runs[0]].1;
            }
            let first = (at - origin) as u32;
            match constant {
                Some(density) if density > 0.0 => {
                    sink.constant(
                        number..number + 1,
                        first..(end - origin) as u32,
                        density.min(1.0),
                    );
                }
                Some(_) => {}
                None => {
                    let count = (end - at) as usize;
                    // From the beginning of a block on, so that all stay within their rows.
                    let start = (at - self.first) as usize;
                    let before = start % BLOCK;
                    values.resize((before + count).next_multiple_of(BLOCK), 0.0);
                    let part = start - before..start - before + values.len();
                    let [a, b, c, d] = [
                        &rows[0].densities[part.clone()],
                        &rows[1].densities[part.clone()],
                        &rows[2].densities[part.clone()],
                        &rows[3].densities[part],
                    ];
                    cubic::between(simd, [a, b, c, d], weights, values);
                    let columns = first..first + count as u32;
                    sink.values(number..number + 1, columns, &values[before..]);
                }
            }
            at = end;
        }
    }
}
