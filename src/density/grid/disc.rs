//! The light's disc on rows of sums: what its chords cover is the difference of the sums at their ends.

use core::f64::consts::PI;

use fearless_simd::{Simd, SimdBase, f32x16};

use super::chords::{Chord, Chords};
use super::strips::BLOCK;

/// How many cells from a pixel's own a chord's ends are, and how many whole ones those of it and of all farther from the disc's middle
/// are at most.
#[derive(Debug, Clone, Copy)]
struct Reach {
    whole: usize,
    rest: f32,
    farthest: usize,
}

/// A chord that ends between cells, where its row of sums begins, and the weights of the nearer cells and of the farther ones.
#[derive(Debug, Clone, Copy)]
struct Part {
    row: usize,
    whole: usize,
    share: f32,
    rest: f32,
}

/// How far the ends of chords may be moved to whole cells, in levels: by so much the profile of an upright edge is another at most.
const MOVED: f64 = 0.1;

/// A disc on rows of sums.
#[derive(Debug, Default)]
pub(super) struct Disc {
    pub(super) chords: Chords,
    /// What each chord reaches.
    reaches: Vec<Reach>,
    /// Chords that end with a cell: where their rows of sums begin, and how far they reach. They take half of the sums.
    wholes: Vec<(usize, usize)>,
    parts: Vec<Part>,
    /// The steps that the disc has in the umbra.
    total: f32,
}

impl Disc {
    /// A disc of `radius` pixels on strips of `height` pixels, each cell of which has `full` steps.
    pub(super) fn set(&mut self, radius: f64, height: f64, full: f64) {
        self.chords.set(radius, height);
        self.reaches.clear();
        let most = MOVED / 255.0 * PI * radius * radius;
        // What chords from the disc's middle on leave for those that follow, above and below together.
        let mut left = 0.0;
        for likes in self.chords.all.chunks(2) {
            let both = height * likes.iter().map(|c| c.height.strips() as f64).sum::<f64>();
            // Half of a chord, half a pixel and what was left.
            let reach = likes[0].half_width + 0.5 + left / both;
            let whole = reach.round();
            let moved = (reach - whole) * both;
            let reach = if moved.abs() <= most {
                left = moved;
                (whole as usize, 0.0)
            } else {
                left = 0.0;
                (reach as usize, reach.fract() as f32)
            };
            self.reaches.extend(likes.iter().map(|_| Reach {
                whole: reach.0,
                rest: reach.1,
                farthest: 0,
            }));
        }
        let mut farthest = 0;
        for reach in self.reaches.iter_mut().rev() {
            farthest = farthest.max(reach.whole);
            reach.farthest = farthest;
        }
        // In the order of the pixels' own sums, so that the umbra's density is 1.
        self.total = 0.0;
        for ends_with_cell in [true, false] {
            for (chord, reach) in self.chords.all.iter().zip(&self.reaches) {
                if (reach.rest == 0.0) == ends_with_cell {
                    let cell = (full * chord.height.strips() as f64) as f32;
                    let [near, far] =
                        [-1.0, 1.0].map(|more| cell * (2.0 * reach.whole as f32 + more));
                    self.total += near * (1.0 - reach.rest) + far * reach.rest;
                }
            }
        }
    }

    /// The farthest cell from a pixel's own that its disc reaches.
    pub(super) fn reach(&self) -> usize {
        self.reaches.first().map_or(0, |reach| reach.farthest + 1)
    }

    /// Chords and the farthest cells from a pixel's own that they and those behind them reach.
    pub(super) fn chords(&self) -> impl Iterator<Item = (&Chord, usize)> {
        let reaches = self.reaches.iter().map(|reach| reach.farthest);
        self.chords.all.iter().zip(reaches)
    }

    /// Finds where the rows of sums are that a row of discs meets, by the place of a chord's row.
    pub(super) fn lay(&mut self, place: impl Fn(&Chord) -> usize) {
        self.wholes.clear();
        self.parts.clear();
        for (chord, &Reach { whole, rest, .. }) in self.chords.all.iter().zip(&self.reaches) {
            let row = place(chord);
            if rest == 0.0 {
                self.wholes.push((row, whole));
            } else {
                self.parts.push(Part {
                    row,
                    whole,
                    share: 1.0 - rest,
                    rest,
                });
            }
        }
    }

    /// Computes the densities of some blocks of pixels from cell `at` on.
    #[inline(always)]
    pub(super) fn densities<S: Simd, const BLOCKS: usize>(
        &self,
        simd: S,
        at: usize,
        sums: &[f32],
        densities: &mut [f32],
    ) {
        let zero = f32x16::splat(simd, 0.0);
        let mut totals = [zero; BLOCKS];
        // Differences of whole numbers, wherever the sums begin: these are exact.
        for &(row, whole) in &self.wholes {
            let right = &sums[at + row + whole..][..BLOCKS * BLOCK];
            let left = &sums[at + row + 1 - whole..][..BLOCKS * BLOCK];
            for (block, total) in totals.iter_mut().enumerate() {
                let start = block * BLOCK;
                let last = f32x16::from_slice(simd, &right[start..start + BLOCK]);
                let first = f32x16::from_slice(simd, &left[start..start + BLOCK]);
                *total += last - first;
            }
        }
        for part in &self.parts {
            let right = &sums[at + part.row + part.whole..][..BLOCKS * BLOCK + 1];
            let left = &sums[at + part.row - part.whole..][..BLOCKS * BLOCK + 1];
            for (block, total) in totals.iter_mut().enumerate() {
                let start = block * BLOCK;
                let near = f32x16::from_slice(simd, &right[start..start + BLOCK]);
                let far = f32x16::from_slice(simd, &right[start + 1..start + 1 + BLOCK]);
                let last = f32x16::from_slice(simd, &left[start..start + BLOCK]);
                let first = f32x16::from_slice(simd, &left[start + 1..start + 1 + BLOCK]);
                *total += (near - first) * part.share + (far - last) * part.rest;
            }
        }
        let one = f32x16::splat(simd, 1.0);
        let blocks = densities.as_chunks_mut::<BLOCK>().0.iter_mut();
        for (block, densities) in blocks.enumerate().take(BLOCKS) {
            let density = totals[block] / self.total;
            density.max(zero).min(one).store_slice(densities);
        }
    }
}
