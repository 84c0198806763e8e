//! Densities as 8-bit coverage.

use core::ops::Range;

use fearless_simd::{
    Bytes, Level, Select, Simd, SimdBase, SimdFloat, SimdFrom, SimdInt, SimdNarrow, dispatch,
    f32x8, i32x8, u8x32, u16x16,
};

use super::Sink;
use super::dither::{Layout, PATTERN, thresholds};
use super::lanes::{change_block, last_block};

/// Writes densities as 8-bit coverage, which adds up.
pub(crate) struct A8<'a> {
    pub(crate) level: Level,
    pub(crate) mask: &'a mut [u8],
    pub(crate) layout: Layout,
}

/// Pixels that are written at once.
const PIXELS: usize = 32;

/// Each pixel's own number in its block.
const NUMBERS: [u8; PIXELS] = {
    let mut numbers = [0; PIXELS];
    let mut lane = 0;
    while lane < PIXELS {
        numbers[lane] = lane as u8;
        lane += 1;
    }
    numbers
};

impl A8<'_> {
    /// The mask of row `y` from column `first` on, and all behind it; what rounds the densities there.
    #[inline(always)]
    fn from(&mut self, y: u32, first: u32) -> (&mut [u8], [u16; PATTERN]) {
        let start = y as usize * self.layout.stride + first as usize;
        (&mut self.mask[start..], thresholds(&self.layout, y, first))
    }
}

impl Sink for A8<'_> {
    fn constant(&mut self, rows: Range<u32>, columns: Range<u32>, density: f32) {
        dispatch!(self.level, simd => for y in rows {
            let (mask, thresholds) = self.from(y, columns.start);
            add_constant(simd, mask, columns.len(), density, thresholds);
        });
    }

    fn values(&mut self, rows: Range<u32>, columns: Range<u32>, densities: &[f32]) {
        dispatch!(self.level, simd => for y in rows {
            let (mask, thresholds) = self.from(y, columns.start);
            add_values(simd, mask, columns.len(), densities, thresholds);
        });
    }
}

/// Adds one density to the first `count` pixels.
#[inline(always)]
fn add_constant<S: Simd>(
    simd: S,
    mask: &mut [u8],
    count: usize,
    density: f32,
    thresholds: [u16; PATTERN],
) {
    let coverage = Steps::new(simd, thresholds).coverage(&[density; PIXELS]);
    let (blocks, rest) = mask.split_at_mut(count - count % PIXELS);
    for block in blocks.as_chunks_mut().0 {
        add(simd, block, coverage);
    }
    add_rest(simd, rest, count % PIXELS, coverage);
}

/// Adds the first `count` densities to as many pixels.
#[inline(always)]
fn add_values<S: Simd>(
    simd: S,
    mask: &mut [u8],
    count: usize,
    densities: &[f32],
    thresholds: [u16; PATTERN],
) {
    let steps = Steps::new(simd, thresholds);
    let (parts, last) = densities[..count].as_chunks();
    let (blocks, rest) = mask.split_at_mut(PIXELS * parts.len());
    for (block, part) in blocks.as_chunks_mut().0.iter_mut().zip(parts) {
        add(simd, block, steps.coverage(part));
    }
    let part = last_block(densities, count, last.len());
    add_rest(simd, rest, last.len(), steps.coverage(&part));
}

#[inline(always)]
fn add<S: Simd>(simd: S, block: &mut [u8; PIXELS], coverage: u8x32<S>) {
    *block = u8x32::simd_from(simd, *block)
        .saturating_add(coverage)
        .into();
}

/// Adds the first `count` of a block's coverage, and 0 to other pixels, which leaves them as they are.
#[inline(always)]
fn add_rest<S: Simd>(simd: S, rest: &mut [u8], count: usize, coverage: u8x32<S>) {
    let within = u8x32::from_slice(simd, &NUMBERS).simd_lt(u8x32::splat(simd, count as u8));
    let coverage = within.select(coverage, u8x32::splat(simd, 0));
    change_block(
        rest,
        count,
        #[inline(always)]
        |block| add(simd, block, coverage),
    );
}

/// How densities are rounded, along a row.
struct Steps<S: Simd> {
    simd: S,
    thresholds: i32x8<S>,
}

impl<S: Simd> Steps<S> {
    #[inline(always)]
    fn new(simd: S, thresholds: [u16; PATTERN]) -> Self {
        Self {
            simd,
            thresholds: i32x8::simd_from(simd, thresholds.map(i32::from)),
        }
    }

    #[inline(always)]
    fn coverage(&self, densities: &[f32; PIXELS]) -> u8x32<S> {
        let parts = densities.as_chunks().0;
        let first = self.part(&parts[0]).narrow(self.part(&parts[1]));
        let last = self.part(&parts[2]).narrow(self.part(&parts[3]));
        let (first, last): (u16x16<S>, u16x16<S>) = (first.bitcast(), last.bitcast());
        first.narrow(last)
    }

    #[inline(always)]
    fn part(&self, densities: &[f32; PATTERN]) -> i32x8<S> {
        // Density 1 is 255 exactly, whatever the threshold.
        let steps: i32x8<S> = (f32x8::simd_from(self.simd, *densities) * 65_280.0).to_int();
        (steps + self.thresholds) >> 8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coverage_is_cut_off_above_thresholds_and_adds_up() {
        let densities: Vec<f32> = (0_u16..=1000)
            .map(|step| f32::from(step) / 1000.0)
            .collect();
        for dither in [None, Some([3, 5])] {
            for count in [1, 7, 31, 32, 33, 1001] {
                let layout = Layout {
                    stride: 1004,
                    dither,
                };
                let mut mask = vec![40; 4 * layout.stride];
                let mut sink = A8 {
                    level: Level::new(),
                    mask: &mut mask,
                    layout,
                };
                sink.values(1..3, 2..2 + count, &densities);
                sink.constant(3..4, 2..2 + count, 0.3);
                let thresholds = [1, 2, 3].map(|y| thresholds(&layout, y, 2));
                for (index, covered) in mask.iter().enumerate() {
                    let (y, x) = (index / layout.stride, index % layout.stride);
                    let drawn = y > 0 && (2..2 + count as usize).contains(&x);
                    let expected = if drawn {
                        let density = if y < 3 { densities[x - 2] } else { 0.3 };
                        let threshold = u32::from(thresholds[y - 1][(x - 2) % PATTERN]);
                        (40 + (((density * 65_280.0) as u32 + threshold) >> 8)).min(255)
                    } else {
                        40
                    };
                    assert_eq!(
                        u32::from(*covered),
                        expected,
                        "{dither:?}, {count}, {x}, {y}"
                    );
                }
            }
        }
    }
}
