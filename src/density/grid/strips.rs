//! What an outline covers of strips across the pixels, as sums along each strip.
//!
//! A strip's cells are as wide as a pixel and as high as the strip. A line adds whole steps to the cells that it crosses
//! and to all on their right: the y of its ends is rounded to such steps, so those of a closed loop cancel exactly, whatever
//! part of the plane is looked at.

use fearless_simd::{Simd, SimdBase};
use glam::DVec2;

use crate::density::lanes::{LANES, lanes};
use crate::density::sweep::Sweep;

/// Cells that are taken at once.
pub(super) const BLOCK: usize = LANES;

/// Cells that are marked together.
pub(super) const QUAD: usize = 4;

/// The marks of a block.
pub(super) const QUADS: u64 = (1 << (BLOCK / QUAD)) - 1;

/// Goes down the strips of one outline.
#[derive(Debug, Default)]
pub(crate) struct Strips {
    lines: Vec<StripLine>,
    sweep: Sweep,
    /// The steps that a strip's height is cut into, and their number as a cell's whole area.
    full: f64,
    left: f64,
    /// By how much each cell covers more steps than the one before.
    deltas: Vec<i32>,
    /// The steps that each block of the last strip had all over.
    before: Vec<i32>,
    /// Whether edges cross a block of the present one.
    crossed: Vec<bool>,
}

/// A line from top to bottom, y in strips.
#[derive(Debug, Clone, Copy)]
struct StripLine {
    top: f64,
    bottom: f64,
    /// The x at both ends, in pixels, and what it gains from strip to strip.
    from: f64,
    to: f64,
    slope: f64,
    /// 1 where what is right of it is covered, else -1.
    side: f64,
}

impl Strips {
    /// Begins an outline seen from column `left` on, `blocks` blocks wide. `full` is the number of steps.
    pub(super) fn begin(&mut self, left: i64, blocks: usize, full: f64) {
        self.lines.clear();
        self.sweep.rewind();
        self.left = left as f64;
        self.full = full;
        self.deltas.clear();
        self.deltas.resize(blocks * BLOCK + 1, 0);
        self.before.clear();
        self.before.resize(blocks, 0);
        self.crossed.clear();
        self.crossed.resize(blocks, false);
    }

    /// Takes a line: x in pixels, y in strips.
    pub(super) fn push(&mut self, from: DVec2, to: DVec2) {
        let round = |y: f64| (y * self.full).round() / self.full;
        let (start, end) = (round(from.y), round(to.y));
        let (top, bottom, upper, lower, side) = if start < end {
            (start, end, from.x, to.x, -1.0)
        } else if start > end {
            (end, start, to.x, from.x, 1.0)
        } else {
            return;
        };
        self.lines.push(StripLine {
            top,
            bottom,
            from: upper,
            to: lower,
            slope: (lower - upper) / (bottom - top),
            side,
        });
    }

    /// Ends the outline.
    pub(super) fn end(&mut self) {
        self.lines.sort_unstable_by(|a, b| a.top.total_cmp(&b.top));
    }

    /// Puts the sums of the steps that a strip covers left of each cell into `sums`, and sets those of `marks`, a bit
    /// a quad, that are not covered alike or not as in the strip before. Strips are asked for from top to bottom.
    #[inline(always)]
    pub(super) fn sum<S: Simd>(
        &mut self,
        simd: S,
        strip: i64,
        sums: &mut [f32],
        marks: &mut [u64],
    ) {
        let strip = strip as f64;
        let height = [strip, strip + 1.0];
        self.sweep
            .go_to(&self.lines, height, |line| [line.top, line.bottom]);
        let mut cells = Cells {
            start: self.left,
            deltas: &mut self.deltas,
            crossed: &mut self.crossed,
            marks,
            cover: 0,
        };
        for &index in self.sweep.active() {
            let line = &self.lines[index as usize];
            let (top, bottom) = (line.top.max(strip), line.bottom.min(strip + 1.0));
            let (least, most) = (line.from.min(line.to), line.from.max(line.to));
            let at = |y: f64| (line.from + (y - line.top) * line.slope).clamp(least, most);
            cells.add(at(top), at(bottom), (bottom - top) * self.full * line.side);
        }
        let mut cover = cells.cover;
        let lanes = lanes(simd);
        let mut sum = 0;
        for (block, (((sums, deltas), crossed), before)) in sums
            .as_chunks_mut::<BLOCK>()
            .0
            .iter_mut()
            .zip(self.deltas.as_chunks_mut::<BLOCK>().0)
            .zip(&mut self.crossed)
            .zip(&mut self.before)
            .enumerate()
        {
            if core::mem::take(crossed) {
                for (to, delta) in sums.iter_mut().zip(deltas) {
                    *to = sum as f32;
                    cover += core::mem::take(delta);
                    sum += cover;
                }
            } else {
                let ramp = lanes * cover as f32 + sum as f32;
                ramp.store_slice(sums);
                sum += cover * BLOCK as i32;
                if *before != cover {
                    let quad = block * (BLOCK / QUAD);
                    marks[quad / 64] |= QUADS << (quad % 64);
                }
            }
            *before = cover;
        }
        if let Some(last) = sums.last_mut() {
            *last = sum as f32;
        }
        if let Some(last) = self.deltas.last_mut() {
            *last = 0;
        }
    }
}

/// The cells of one strip.
struct Cells<'a> {
    /// The column of the first. All x count from column 0, as what is rounded may not depend on the columns that are seen.
    start: f64,
    deltas: &'a mut [i32],
    crossed: &'a mut [bool],
    marks: &'a mut [u64],
    /// What covers the first cell from its left.
    cover: i32,
}

impl Cells<'_> {
    /// Adds a line's part from x to x within the strip, which has so many steps right of it.
    #[inline(always)]
    fn add(&mut self, from: f64, to: f64, steps: f64) {
        let (left, right) = (from.min(to), from.max(to));
        let count = self.deltas.len() - 1;
        let end = self.start + count as f64;
        if right <= self.start {
            self.cover += steps as i32;
            return;
        }
        if left >= end {
            return;
        }
        let cell_at = |x: f64| (x - self.start) as usize;
        let (first, last) = (cell_at(left.max(self.start)), cell_at(right.min(end - 1.0)));
        for quad in first / QUAD..=(last + 1).min(count - 1) / QUAD {
            self.marks[quad / 64] |= 1 << (quad % 64);
        }
        for crossed in &mut self.crossed[first / BLOCK..=(last + 1).min(count - 1) / BLOCK] {
            *crossed = true;
        }
        if first == last && left >= self.start && right < end {
            let column = self.start + first as f64;
            self.put(first, steps as i32, (left + right) / 2.0 - column);
            return;
        }
        let per_cell = steps / (right - left);
        let passed = |x: f64| ((x - left) * per_cell).round() as i32;
        let mut before = if left < self.start {
            passed(self.start)
        } else {
            0
        };
        self.cover += before;
        let mut x = left.max(self.start);
        for cell in first..=last {
            let column = self.start + cell as f64;
            let next = right.min(column + 1.0);
            let after = if next == right {
                steps as i32
            } else {
                passed(next)
            };
            self.put(cell, after - before, (x + next) / 2.0 - column);
            (before, x) = (after, next);
        }
    }

    /// Adds steps right of a place in a cell, 0 to 1.
    #[inline(always)]
    fn put(&mut self, cell: usize, steps: i32, place: f64) {
        let within = (f64::from(steps) * (1.0 - place)).round() as i32;
        self.deltas[cell] += within;
        self.deltas[cell + 1] += steps - within;
    }
}
