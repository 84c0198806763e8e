//! What the discs of one row cover of a rounded rectangle, column by column.

use core::ops::Range;

use fearless_simd::{Simd, SimdBase, f32x16};

use super::nodes::{Band, Row};
use crate::density::lanes::{LANES, lanes};

/// Columns that are taken at once.
pub(super) const BLOCK: usize = LANES;

/// What the discs of one row reach.
pub(super) struct Reach<'a> {
    pub(super) row: &'a Row,
    /// The side of the square that pixels are averages over, or 0.
    pub(super) square: f32,
    /// Whether they may meet the left side, and the right one.
    pub(super) met: [bool; 2],
    /// Where the sides are, and pixels from one column to the next; all from the first column.
    pub(super) sides: [f32; 2],
    pub(super) pitch: f32,
}

impl Reach<'_> {
    /// Computes blocks of columns.
    // One copy a SIMD level: where it was inlined, compilers took minutes.
    #[inline(never)]
    pub(super) fn compute_all<S: Simd>(
        &self,
        simd: S,
        blocks: Range<usize>,
        densities: &mut [f32],
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.compute_blocks(simd, blocks, densities),
        );
    }

    #[inline(always)]
    fn compute_blocks<S: Simd>(&self, simd: S, blocks: Range<usize>, densities: &mut [f32]) {
        let mut block = blocks.start;
        while block < blocks.end {
            let at = block * BLOCK;
            let densities = &mut densities[at..];
            block += match blocks.end - block {
                1 => self.compute::<S, 1>(simd, at, densities),
                2 | 4 => self.compute::<S, 2>(simd, at, densities),
                _ => self.compute::<S, 3>(simd, at, densities),
            };
        }
    }

    /// Computes some blocks of densities from column `at` on; their number.
    #[inline(always)]
    fn compute<S: Simd, const BLOCKS: usize>(
        &self,
        simd: S,
        at: usize,
        densities: &mut [f32],
    ) -> usize {
        let zero = f32x16::splat(simd, 0.0);
        let lanes = lanes(simd);
        let mut sums = [zero; BLOCKS];
        for side in 0..2 {
            if !self.met[side] {
                continue;
            }
            // How far inside the side each column is.
            let mut depths = [zero; BLOCKS];
            for (block, depth) in depths.iter_mut().enumerate() {
                let column = (lanes + (at + block * BLOCK) as f32) * self.pitch;
                *depth = if side == 0 {
                    column - self.sides[0]
                } else {
                    f32x16::splat(simd, self.sides[1]) - column
                };
            }
            let splat = |v: f32| f32x16::splat(simd, v);
            let (square, share) = (splat(self.square), splat(0.5 / self.square));
            for (band, Band { scale, .. }) in self.row.bands().iter().enumerate() {
                let mut band_sums = [zero; BLOCKS];
                for (width, offset, weight) in self.row.chords(band, side) {
                    let (offset, width, weight) = (splat(offset), splat(width), splat(weight));
                    for block in 0..BLOCKS {
                        let entered = depths[block] + offset;
                        let inside = if self.square > 0.0 {
                            // A chord's end enters the square from one side on, and its other end after it.
                            let (first, last) = (entered.max(zero), (entered - width).max(zero));
                            let (near, far) = (first.min(square), last.min(square));
                            (near * near - far * far) * share + ((first - near) - (last - far))
                        } else {
                            entered.max(zero).min(width)
                        };
                        band_sums[block] += inside * weight;
                    }
                }
                for (sum, band_sum) in sums.iter_mut().zip(band_sums) {
                    *sum += band_sum * *scale;
                }
            }
        }
        // Both sides leave of a chord what the two leave together less all of it.
        let full = if self.met[0] && self.met[1] {
            self.row.between
        } else {
            0.0
        };
        let one = f32x16::splat(simd, 1.0);
        let blocks = densities.as_chunks_mut::<BLOCK>().0.iter_mut();
        for (sum, densities) in sums.into_iter().zip(blocks) {
            let density = sum - full;
            density.max(zero).min(one).store_slice(densities);
        }
        BLOCKS
    }
}
