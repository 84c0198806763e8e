//! Paint blended onto premultiplied RGBA8, by densities or by coverage.

use core::hint::black_box;
use core::ops::Range;

use fearless_simd::{
    Bytes, Level, Select, Simd, SimdBase, SimdFrom, SimdInt, SimdSplit, dispatch, f32x16, u16x16,
    u16x32, u32x16,
};

use super::Sink;
use super::dither::{Layout, thresholds};
use super::lanes::{NUMBERS, change_block, last_block};
use super::runs::{Run, each};
use crate::paint::Paint;
use crate::tone::Color;

/// Blends paint of one colour onto premultiplied RGBA8 pixels.
pub(crate) struct Rgba8<'a> {
    pub(crate) level: Level,
    pub(crate) pixels: &'a mut [u8],
    pub(crate) layout: Layout,
    pub(crate) ink: Ink,
}

/// Paint of one colour.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ink {
    /// Red and blue, green and opaque, each pair in the halves of 32 bits and in 256ths.
    red_blue: u32,
    green_alpha: u32,
    /// The paint's opacity where the density is 1, in 65535ths.
    strength: f32,
}

/// Pixels that are blended at once, and their bytes.
const PIXELS: usize = 16;
const BLOCK: usize = 4 * PIXELS;

/// The upper byte of 16 bits.
const UPPER: u16 = 0xff00;

/// Added to a number far below it, this rounds it to a whole one, as single precision has no bits for less: these are the lower ones of
/// the sum then.
const WHOLE: f32 = (1_u32 << 23) as f32;
const LOWER: u32 = 0xffff;

impl Rgba8<'_> {
    /// Blends the paint by 8-bit coverage, from column `first` of row `y` on.
    pub(crate) fn coverage(&mut self, y: u32, first: u32, mask: &[u8]) {
        let (layout, ink) = (&self.layout, &self.ink);
        let pixels = from(self.pixels, layout, y, first);
        dispatch!(self.level, simd => ink.blend_coverage(simd, pixels, mask, (layout, y, first)));
    }
}

impl Sink for Rgba8<'_> {
    fn constant(&mut self, rows: Range<u32>, columns: Range<u32>, density: f32) {
        let (layout, ink, first) = (&self.layout, &self.ink, columns.start);
        let count = columns.len();
        dispatch!(self.level, simd => for rows in layout.alike(rows) {
            let y = rows.start;
            let pixels = from(self.pixels, layout, y, first);
            ink.blend_constant(simd, pixels, (rows.len(), count), density, (layout, y, first));
        });
    }

    fn values(&mut self, rows: Range<u32>, columns: Range<u32>, densities: &[f32]) {
        let (layout, ink, first) = (&self.layout, &self.ink, columns.start);
        let count = columns.len();
        dispatch!(self.level, simd => for rows in layout.alike(rows) {
            let (y, rows) = (rows.start, rows.len());
            let pixels = from(self.pixels, layout, y, first);
            if rows > 1 {
                ink.blend_rows(simd, pixels, (rows, count), densities, (layout, y, first));
            } else {
                ink.blend_values(simd, pixels, count, densities, (layout, y, first));
            }
        });
    }

    fn runs(&mut self, runs: &[Run], densities: &[f32]) {
        let (layout, ink) = (&self.layout, &self.ink);
        dispatch!(self.level, simd => for (Run { row, columns }, densities) in each(runs, densities) {
            let (y, first) = (*row, columns.start);
            let pixels = from(self.pixels, layout, y, first);
            ink.blend_values(simd, pixels, columns.len(), densities, (layout, y, first));
        });
    }
}

/// The bytes of row `y` from column `first` on, and all behind them.
#[inline(always)]
fn from<'a>(pixels: &'a mut [u8], layout: &Layout, y: u32, first: u32) -> &'a mut [u8] {
    &mut pixels[4 * (y as usize * layout.stride + first as usize)..]
}

impl Ink {
    pub(crate) fn new(paint: &Paint) -> Self {
        let Color { r, g, b, .. } = paint.color();
        Self {
            red_blue: (u32::from(b) << 24) | (u32::from(r) << 8),
            green_alpha: (255 << 24) | (u32::from(g) << 8),
            strength: paint.opacity() * 65_535.0,
        }
    }

    /// Blends one density onto the first `count` pixels of each of some rows which round alike and begin at a row and column of the layout.
    #[inline(always)]
    fn blend_constant<S: Simd>(
        &self,
        simd: S,
        pixels: &mut [u8],
        (rows, count): (usize, usize),
        density: f32,
        (layout, y, first): (&Layout, u32, u32),
    ) {
        let brush = Brush::new(simd, self, &thresholds(layout, y, first));
        let coat = brush.coat(f32x16::splat(simd, density));
        let left = count % PIXELS;
        let rest = (left > 0).then(|| brush.last_coat([density; PIXELS], left));
        for row in 0..rows {
            let pixels = &mut pixels[4 * row * layout.stride..];
            let (blocks, end) = pixels.split_at_mut(4 * (count - left));
            for block in blocks.as_chunks_mut::<BLOCK>().0 {
                anew(&coat).blend(simd, block);
            }
            if let Some(rest) = &rest {
                brush.blend_rest(end, left, rest);
            }
        }
    }

    /// Blends the first `count` densities onto pixels, which begin at a row and column of the layout.
    #[inline(always)]
    fn blend_values<S: Simd>(
        &self,
        simd: S,
        pixels: &mut [u8],
        count: usize,
        densities: &[f32],
        (layout, y, first): (&Layout, u32, u32),
    ) {
        let brush = Brush::new(simd, self, &thresholds(layout, y, first));
        let (parts, last) = densities[..count].as_chunks::<PIXELS>();
        let (blocks, rest) = pixels.split_at_mut(BLOCK * parts.len());
        for (block, part) in blocks.as_chunks_mut::<BLOCK>().0.iter_mut().zip(parts) {
            brush
                .coat(f32x16::simd_from(simd, *part))
                .blend(simd, block);
        }
        if !last.is_empty() {
            let part = last_block(densities, count, last.len());
            brush.blend_last(rest, last.len(), part);
        }
    }

    /// Blends the first `count` densities onto pixels of each of some rows which round alike: they are paint once.
    #[inline(always)]
    fn blend_rows<S: Simd>(
        &self,
        simd: S,
        mut pixels: &mut [u8],
        (rows, count): (usize, usize),
        mut densities: &[f32],
        (layout, y, first): (&Layout, u32, u32),
    ) {
        let brush = Brush::new(simd, self, &thresholds(layout, y, first));
        let mut left = count;
        while left > 0 {
            let count = left.min(COATS * PIXELS);
            let (parts, last) = densities[..count].as_chunks::<PIXELS>();
            let rest = brush.last_coat(last_block(densities, count, last.len()), last.len());
            let mut coats = [rest; COATS];
            let coats = &mut coats[..parts.len()];
            for (coat, part) in coats.iter_mut().zip(parts) {
                *coat = brush.coat(f32x16::simd_from(simd, *part));
            }
            for row in 0..rows {
                let pixels = &mut pixels[4 * row * layout.stride..];
                let (blocks, end) = pixels.split_at_mut(BLOCK * coats.len());
                for (block, coat) in blocks.as_chunks_mut::<BLOCK>().0.iter_mut().zip(&*coats) {
                    coat.blend(simd, block);
                }
                if !last.is_empty() {
                    brush.blend_rest(end, last.len(), &rest);
                }
            }
            left -= count;
            (pixels, densities) = (&mut pixels[4 * count..], &densities[count..]);
        }
    }

    /// Blends coverage onto pixels, which begin at a row and column of the layout.
    #[inline(always)]
    fn blend_coverage<S: Simd>(
        &self,
        simd: S,
        pixels: &mut [u8],
        mask: &[u8],
        (layout, y, first): (&Layout, u32, u32),
    ) {
        let brush = Brush::new(simd, self, &thresholds(layout, y, first));
        let (parts, last) = mask.as_chunks::<PIXELS>();
        let (blocks, rest) = pixels.split_at_mut(BLOCK * parts.len());
        for (block, part) in blocks.as_chunks_mut::<BLOCK>().0.iter_mut().zip(parts) {
            brush
                .coat(f32x16::simd_from(simd, densities(part)))
                .blend(simd, block);
        }
        if !last.is_empty() {
            let part = match mask.last_chunk() {
                // Shifted down to the block's beginning.
                Some(end) => {
                    (u128::from_le_bytes(*end) >> (8 * (PIXELS - last.len()))).to_le_bytes()
                }
                None => {
                    let mut part = [0; PIXELS];
                    part[..last.len()].copy_from_slice(last);
                    part
                }
            };
            brush.blend_last(rest, last.len(), densities(&part));
        }
    }
}

/// The density that 8-bit coverage stands for.
#[inline(always)]
pub(crate) fn density(coverage: u8) -> f32 {
    f32::from(coverage) * (1.0 / 255.0)
}

/// The densities of a block's pixels.
#[inline(always)]
fn densities(coverage: &[u8; PIXELS]) -> [f32; PIXELS] {
    let mut densities = [0.0; PIXELS];
    for (to, coverage) in densities.iter_mut().zip(coverage) {
        *to = density(*coverage);
    }
    densities
}

/// Paint at hand: each of its vectors holds two channels of a block's pixels.
struct Brush<S: Simd> {
    simd: S,
    strength: f32,
    red_blue: u16x32<S>,
    green_alpha: u16x32<S>,
    thresholds: u16x32<S>,
}

/// Paint on pixels, two of whose channels each of its vectors holds.
#[derive(Clone, Copy)]
struct Coat<V> {
    /// How much is left of what is below, in 65535ths: cut off to 256ths of a level, all of it is one of them less, which any
    /// threshold makes up for.
    left: V,
    /// What paint and rounding add to both pairs of channels, in 256ths: with what is left of a channel these are 255 upper bytes at
    /// most, a threshold is 254 lower ones.
    red_blue: V,
    green_alpha: V,
}

/// Blocks that are painted at once on rows that are alike.
const COATS: usize = 8;

impl<S: Simd> Brush<S> {
    #[inline(always)]
    fn new(simd: S, ink: &Ink, thresholds: &[u16; 8]) -> Self {
        let mut twice = [0; PIXELS];
        for (both, threshold) in twice.iter_mut().zip(thresholds.iter().cycle()) {
            *both = u32::from(*threshold) * 0x1_0001;
        }
        Self {
            simd,
            strength: ink.strength,
            red_blue: u32x16::splat(simd, ink.red_blue).bitcast(),
            green_alpha: u32x16::splat(simd, ink.green_alpha).bitcast(),
            thresholds: u32x16::simd_from(simd, twice).bitcast(),
        }
    }

    /// A coat of the first `count` of a block's densities, which leaves other pixels as they are.
    #[inline(always)]
    fn last_coat(&self, densities: [f32; PIXELS], count: usize) -> Coat<u16x32<S>> {
        let lanes = f32x16::from_slice(self.simd, &NUMBERS);
        let within = lanes.simd_lt(f32x16::splat(self.simd, count as f32));
        let densities = f32x16::simd_from(self.simd, densities);
        self.coat(within.select(densities, f32x16::splat(self.simd, 0.0)))
    }

    #[inline(always)]
    fn coat(&self, densities: f32x16<S>) -> Coat<u16x32<S>> {
        let brush = anew(self);
        let opacity: u32x16<S> = (densities * self.strength + WHOLE).bitcast();
        let opacity: u16x32<S> = ((opacity & LOWER) | (opacity << 16)).bitcast();
        Coat {
            left: !opacity,
            red_blue: high(brush.red_blue, opacity) + self.thresholds,
            green_alpha: high(brush.green_alpha, opacity) + self.thresholds,
        }
    }

    /// Blends the first `count` of a block's densities, where there may be no other pixels.
    #[inline(always)]
    fn blend_last(&self, rest: &mut [u8], count: usize, densities: [f32; PIXELS]) {
        self.blend_rest(rest, count, &self.last_coat(densities, count));
    }

    /// Blends a coat that leaves all but the first `count` pixels as they are, where there may be no others.
    #[inline(always)]
    fn blend_rest(&self, rest: &mut [u8], count: usize, coat: &Coat<u16x32<S>>) {
        if count > PIXELS / 2 {
            coat.blend_some::<S, BLOCK>(self.simd, rest, count);
        } else {
            let half = coat.half();
            half.blend_some::<S, { BLOCK / 2 }>(self.simd, rest, count);
        }
    }
}

impl<S: Simd> Coat<u16x32<S>> {
    /// The coat of the first half of the pixels.
    #[inline(always)]
    fn half(&self) -> Coat<u16x16<S>> {
        Coat {
            left: self.left.split().0,
            red_blue: self.red_blue.split().0,
            green_alpha: self.green_alpha.split().0,
        }
    }
}

impl<V> Coat<V> {
    /// Blends the coat onto as many pixels as it has.
    #[inline(always)]
    fn blend<S: Simd>(&self, simd: S, block: &mut [u8])
    where
        V: SimdInt<S, Element = u16>,
    {
        let pixels = V::from_bytes(V::ByteVector::from_slice(simd, block));
        let red_blue = (high(pixels << 8, self.left) + self.red_blue) >> 8;
        let green_alpha = (high(pixels & UPPER, self.left) + self.green_alpha) & UPPER;
        (red_blue | green_alpha).to_bytes().store_slice(block);
    }

    /// Blends a coat that leaves all but the first `count` pixels as they are, where there may be no others.
    #[inline(always)]
    fn blend_some<S: Simd, const SIZE: usize>(&self, simd: S, rest: &mut [u8], count: usize)
    where
        V: SimdInt<S, Element = u16>,
    {
        change_block::<SIZE>(
            rest,
            4 * count,
            #[inline(always)]
            |block| self.blend(simd, block),
        );
    }
}

/// The same, taken from memory again. A factor that stays as it is through a loop is widened before it by LLVM, which then does not find
/// the instruction for the upper halves of products: spans of one density took half as long again.
#[inline(always)]
fn anew<T>(value: &T) -> &T {
    black_box(value)
}

/// The upper half of each product.
#[inline(always)]
fn high<S: Simd, V: SimdInt<S, Element = u16>>(a: V, b: V) -> V {
    let mut high = a;
    for lane in 0..V::LEN {
        high[lane] = ((u32::from(a[lane]) * u32::from(b[lane])) >> 16) as u16;
    }
    high
}
