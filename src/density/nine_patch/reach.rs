//! What the disc's chords cover of a rounded rectangle.

use core::ops::Range;

use fearless_simd::{Simd, SimdBase, f32x16};

use super::sides::{Node, Strips};
use crate::density::chords::{Chords, GROUP, Height};
use crate::density::lanes::{LANES, lanes};

/// Columns that are taken at once.
pub(super) const BLOCK: usize = LANES;

/// The disc's chords from above to below: single strips, groups of strips, and single ones again.
#[derive(Debug, Default)]
pub(super) struct Disc {
    /// Strips from its middle to its end, and groups from its middle to where single ones follow.
    pub(super) half: i64,
    groups: i64,
    /// Half of each chord's width, in pixels.
    upper: Vec<f32>,
    middle: Vec<f32>,
    lower: Vec<f32>,
    /// Its area, in strips and pixels.
    total: f32,
}

impl Disc {
    pub(super) fn set(&mut self, chords: &Chords) {
        self.half = chords.half;
        for list in [&mut self.upper, &mut self.middle, &mut self.lower] {
            list.clear();
        }
        let mut total = 0.0;
        // Of each chord's two likenesses the one below.
        for chord in chords.all.iter().skip(1).step_by(2) {
            total += 4.0 * chord.height.strips() as f64 * chord.half_width;
            let half_width = chord.half_width as f32;
            match chord.height {
                Height::Strip => self.lower.push(half_width),
                Height::Group | Height::Pair => self.middle.push(half_width),
            }
        }
        self.total = total as f32;
        self.groups = self.middle.len() as i64;
        self.upper.extend(self.lower.iter().rev());
        self.middle.extend_from_within(..);
        self.middle[..self.groups as usize].reverse();
    }
}

/// What the discs of one row reach.
pub(super) struct Reach<'a> {
    pub(super) disc: &'a Disc,
    pub(super) strips: &'a [Strips; 1 + GROUP as usize],
    /// The strip below the row.
    pub(super) first: i64,
    pub(super) met: [bool; 2],
    /// Where the sides are, and pixels from one column to the next; all from the first column.
    pub(super) sides: [f32; 2],
    pub(super) pitch: f32,
}

impl Reach<'_> {
    /// Computes blocks of columns.
    #[inline(always)]
    pub(super) fn compute_all<S: Simd>(
        &self,
        simd: S,
        blocks: Range<usize>,
        densities: &mut [f32],
    ) {
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
            self.add(simd, side, &depths, &mut sums);
        }
        // Both sides leave of a chord what the two leave together less all of it.
        let full = if self.met[0] && self.met[1] {
            self.full()
        } else {
            0.0
        };
        let scale = 1.0 / self.disc.total;
        let one = f32x16::splat(simd, 1.0);
        let blocks = densities.as_chunks_mut::<BLOCK>().0.iter_mut();
        for (sum, densities) in sums.into_iter().zip(blocks) {
            let density = (sum - full) * scale;
            density.max(zero).min(one).store_slice(densities);
        }
        BLOCKS
    }

    /// The disc's chords: half widths, strips, and which of these they are of.
    #[inline(always)]
    fn runs(&self) -> [(&[f32], &Strips, Range<i64>); 3] {
        let disc = self.disc;
        let [singles, grouped @ ..] = self.strips;
        let (first, inner) = (self.first, disc.groups * GROUP);
        let start = first - inner;
        let group = start.div_euclid(GROUP);
        let grouped = &grouped[start.rem_euclid(GROUP) as usize];
        [
            (&disc.upper, singles, first - disc.half..start),
            (&disc.middle, grouped, group..group + 2 * disc.groups),
            (&disc.lower, singles, first + inner..first + disc.half),
        ]
    }

    /// Adds what of the chords lies on the inner side of a side.
    #[inline(always)]
    fn add<S: Simd, const BLOCKS: usize>(
        &self,
        simd: S,
        side: usize,
        depths: &[f32x16<S>; BLOCKS],
        sums: &mut [f32x16<S>; BLOCKS],
    ) {
        let zero = f32x16::splat(simd, 0.0);
        for (widths, strips, of) in self.runs() {
            let mut start = of.start.max(0);
            for (end, nodes) in strips.parts() {
                let end = end.min(of.end);
                if start >= end {
                    continue;
                }
                let widths = &widths[(start - of.start) as usize..];
                let share = 1.0 / nodes.len() as f32;
                for node in nodes {
                    let (insets, covers) = strips.of(side, *node, start..end);
                    for ((half_width, inset), cover) in widths.iter().zip(insets).zip(covers) {
                        let offset = f32x16::splat(simd, half_width - inset);
                        let width = f32x16::splat(simd, half_width + half_width);
                        let cover = f32x16::splat(simd, cover * share);
                        for block in 0..BLOCKS {
                            let inside = (depths[block] + offset).max(zero).min(width);
                            sums[block] += inside * cover;
                        }
                    }
                }
                start = end;
            }
        }
    }

    /// What the rectangle's height leaves of all chords.
    fn full(&self) -> f32 {
        let mut sum = 0.0;
        for (widths, strips, of) in self.runs() {
            let (start, end) = (of.start.max(0), of.end.min(strips.count()));
            if start >= end {
                continue;
            }
            let (_, covers) = strips.of(0, Node::Average, start..end);
            let widths = &widths[(start - of.start) as usize..];
            for (half_width, cover) in widths.iter().zip(covers) {
                sum += (half_width + half_width) * cover;
            }
        }
        sum
    }
}
