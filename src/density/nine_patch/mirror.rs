//! The right half of a row from its left half, where a rectangle's halves are alike: its columns lie between those of the other.

use core::ops::Range;

use fearless_simd::{Simd, SimdBase, f32x16};

use super::lattice::Lattice;
use super::reach::BLOCK;
use crate::density::cubic;
use crate::density::frame::whole_below;

/// Where the columns of the right zone lie among those of the left one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mirror {
    /// The sum of the numbers of a right column and of the left one at or before the place where it lies, each counted from its zone's first.
    sum: i64,
    /// The weights of four left columns, of which that one is the second.
    weights: [f32; 4],
}

/// Columns that are no farther from each other than this, in pixels, are one.
const SAME: f64 = 1e-9;

/// Columns that are read before the left zone's first, where nothing is in the shadow, and behind what is asked for.
pub(super) const BEFORE: usize = 2 * BLOCK;
pub(super) const BEHIND: usize = 3;

impl Mirror {
    /// For two zones by the numbers of their first columns: none where the halves differ, or where cubics between columns would not do.
    pub(super) fn new(lattice: &Lattice, first: [i64; 2]) -> Option<Self> {
        let shape = &lattice.shape;
        let [tl, tr, br, bl] = shape.radii;
        let both = shape.min.x + shape.max.x;
        let whole = whole_below(both + SAME);
        let share = both - whole as f64;
        let is_same = share.abs() <= SAME;
        let is_alike = tl == tr && bl == br;
        (is_alike && (is_same || lattice.are_columns_near)).then(|| Self {
            sum: whole - first[0] - first[1],
            weights: if is_same {
                [0.0, 1.0, 0.0, 0.0]
            } else {
                cubic::touching(share)
            },
        })
    }

    /// The left columns that some right ones take.
    pub(super) fn needs(&self, part: &Range<usize>) -> Range<usize> {
        let [first, last] = [part.end - 1, part.start].map(|column| self.sum - column as i64);
        (first - 1).max(0) as usize..(last + BEHIND as i64) as usize
    }

    /// Puts the densities of some right columns, and of what columns follow, in whole vectors. Of the left ones there are [`BEFORE`] more
    /// in `from` before their first.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(&self, simd: S, from: &[f32], part: &Range<usize>, to: &mut [f32]) {
        let before = self.sum + (BEFORE - BLOCK) as i64;
        for first in part.clone().step_by(BLOCK) {
            // A block's columns are in the other order on the left.
            let from = &from[(before - first as i64) as usize..];
            let at = |place: usize| f32x16::from_slice(simd, &from[place..place + BLOCK]);
            let sum = cubic::sum(simd, [at(0), at(1), at(2), at(3)], self.weights);
            for (lane, to) in to[first..first + BLOCK].iter_mut().enumerate() {
                *to = sum[BLOCK - 1 - lane];
            }
        }
    }
}
