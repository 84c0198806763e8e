//! Columns of densities from those some pixels apart: each level halves their distance, by the four-point scheme
//! (Dyn, Levin & Gregory 1987), whose midpoints are those of a Catmull-Rom spline.

use fearless_simd::{Simd, SimdBase, f32x16};

use crate::density::lanes::LANES;

/// How many times the columns that are computed are halved in distance until there is one for each pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Columns {
    halvings: u32,
}

/// What a level needs left and right of the columns that it yields.
const BEFORE: usize = 1;
const BEHIND: usize = 2;

impl Columns {
    /// As far apart as can be, but no farther than `apart` pixels.
    pub(super) fn apart(apart: f64) -> Self {
        Self {
            halvings: (apart.max(1.0) as u64).ilog2(),
        }
    }

    /// Whether there is one for each pixel.
    pub(super) fn are_pixels(self) -> bool {
        self.halvings == 0
    }

    /// Pixels from one column to the next.
    pub(super) fn pitch(self) -> f32 {
        (1_u32 << self.halvings) as f32
    }

    /// Where the first column is, in pixels from the first pixel: each level leaves out the first one of its own.
    pub(super) fn start(self) -> f32 {
        BEFORE as f32 * (2.0 - 2.0 * self.pitch())
    }

    /// Columns that so many pixels need.
    pub(super) fn count(self, pixels: usize) -> usize {
        (0..self.halvings).fold(pixels, |count, _| count.div_ceil(2) + BEFORE + BEHIND)
    }

    /// Gets lists ready for the columns of so many pixels.
    pub(super) fn resize(self, lists: &mut [Vec<f32>; 2], pixels: usize) {
        // Whole vectors are read and written.
        let length = pixels.next_multiple_of(2 * LANES) + 2 * LANES;
        for list in lists {
            list.resize(length, 0.0);
        }
    }

    /// Densities of pixels from those of columns in the first of the lists, of which the other is memory.
    #[inline(always)]
    pub(super) fn spread<S: Simd>(self, simd: S, lists: &mut [Vec<f32>; 2], pixels: &mut [f32]) {
        let [mut from, mut to] = lists.each_mut();
        for level in 1..self.halvings {
            let count = pixels.len() >> (self.halvings - level);
            let count = (count + 2 * (BEFORE + BEHIND)).next_multiple_of(2 * LANES);
            halve(simd, from, &mut to[..count]);
            core::mem::swap(&mut from, &mut to);
        }
        halve(simd, from, pixels);
    }
}

/// Columns half as far apart, from the second one of `from` on.
#[inline(always)]
fn halve<S: Simd>(simd: S, from: &[f32], to: &mut [f32]) {
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    for (index, both) in to.as_chunks_mut::<{ 2 * LANES }>().0.iter_mut().enumerate() {
        let first = index * LANES;
        let a = f32x16::from_slice(simd, &from[first..first + LANES]);
        let b = f32x16::from_slice(simd, &from[first + 1..first + 1 + LANES]);
        let c = f32x16::from_slice(simd, &from[first + 2..first + 2 + LANES]);
        let d = f32x16::from_slice(simd, &from[first + 3..first + 3 + LANES]);
        let middle = ((b + c) * 0.5625 - (a + d) * 0.0625).max(zero).min(one);
        let (even, odd) = both.split_at_mut(LANES);
        b.zip_low(middle).store_slice(even);
        b.zip_high(middle).store_slice(odd);
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    #[test]
    fn straight_densities_stay_straight_at_every_distance() {
        for apart in [1.0, 2.0, 5.9, 8.0, 16.3] {
            let columns = Columns::apart(apart);
            let density = |pixel: f32| 0.3 + pixel * 0.002;
            for pixels in [32, 64, 96] {
                let mut lists = [Vec::new(), Vec::new()];
                columns.resize(&mut lists, pixels);
                let count = columns.count(pixels);
                assert!(count <= lists[0].len());
                for (index, column) in lists[0].iter_mut().take(count).enumerate() {
                    *column = density(columns.start() + columns.pitch() * index as f32);
                }
                if columns.are_pixels() {
                    continue;
                }
                let mut spread = vec![0.0; pixels];
                dispatch!(Level::new(), simd => columns.spread(simd, &mut lists, &mut spread));
                for (pixel, found) in spread.into_iter().enumerate() {
                    assert!(
                        (found - density(pixel as f32)).abs() < 1e-6,
                        "{apart} {pixel}"
                    );
                }
            }
        }
    }
}
