//! The disc of the light cut into strips: which part of each strip a pixel's disc covers.

use fearless_simd::{Simd, SimdBase, f32x16};

use super::strips::BLOCK;

/// Up to so many penumbra radii from the disc's middle its chords are two of the lattice's rows high, and one row from there
/// on. Near its ends, where strips are of very different widths, they are single ones.
const PAIRS: f64 = 0.5;
const GROUPS: f64 = 0.857;

/// How high a chord is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Height {
    Strip,
    /// All strips from a row of the lattice to the next.
    Group,
    /// Two groups.
    Pair,
}

/// A strip of the disc.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chord {
    /// Its first strip, counted from the middle of the disc.
    pub(super) strip: i64,
    pub(super) height: Height,
    /// Half of its width and half a pixel: whole pixels, and the rest.
    pub(super) whole: usize,
    rest: f32,
}

/// A chord where its row of sums is: the cells at its ends, counted from a pixel's.
#[derive(Debug, Clone, Copy)]
struct Part {
    left: usize,
    right: usize,
    rest: f32,
}

/// A disc by its strips, for rows of a lattice that are some strips apart.
#[derive(Debug, Default)]
pub(crate) struct Disc {
    pub(super) chords: Vec<Chord>,
    parts: Vec<Part>,
    /// Strips from the middle to an end.
    pub(super) half: i64,
    /// The steps that the disc has in the umbra.
    total: f32,
}

/// The integral of sqrt(1 - u²) from 0 to t.
fn half_area(t: f64) -> f64 {
    let t = t.min(1.0);
    (t * (1.0 - t * t).max(0.0).sqrt() + libm::asin(t)) / 2.0
}

impl Disc {
    /// A disc of `radius` pixels by strips of `height` pixels, each cell of which has `full` steps; `group` strips are one
    /// of the lattice's rows.
    pub(super) fn set(&mut self, radius: f64, height: f64, group: i64, full: f64) {
        let half = (radius / height - 1e-9).ceil() as i64;
        self.half = half;
        self.chords.clear();
        let (mut whole, mut rest) = (0.0, 0.0);
        let mut push = |strip: i64, count: i64, kind: Height| {
            let (near, far) = (strip as f64, (strip + count) as f64);
            let area = |strips: f64| half_area(strips * height / radius) * radius * radius;
            let width = (area(far) - area(near)) / (height * count as f64) + 0.5;
            let cell = (full * count as f64) as f32;
            for strip in [-strip - count, strip] {
                let chord = Chord {
                    strip,
                    height: kind,
                    whole: width as usize,
                    rest: width.fract() as f32,
                };
                whole += cell * (2.0 * chord.whole as f32 - 1.0);
                rest += (cell + cell) * chord.rest;
                self.chords.push(chord);
            }
        };
        let mut strip = 0;
        for (until, count, kind) in [
            (PAIRS, 2 * group, Height::Pair),
            (GROUPS, group, Height::Group),
            (1.0, 1, Height::Strip),
        ] {
            while (strip + count) as f64 * height <= until * radius
                || kind == Height::Strip && strip < half
            {
                push(strip, count, kind);
                strip += count;
            }
        }
        self.total = whole + rest;
    }

    /// The farthest cell from a pixel's own that its disc reaches.
    pub(super) fn reach(&self) -> usize {
        self.chords
            .iter()
            .map(|chord| chord.whole + 1)
            .max()
            .unwrap_or(0)
    }

    /// Finds where the rows of sums are that a row of discs meets, by the place of a chord's row.
    pub(super) fn lay(&mut self, place: impl Fn(&Chord) -> usize) {
        self.parts.clear();
        self.parts.extend(self.chords.iter().map(|chord| {
            let row = place(chord);
            Part {
                left: row - chord.whole,
                right: row + chord.whole,
                rest: chord.rest,
            }
        }));
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
        let (mut whole, mut rest) = ([zero; BLOCKS], [zero; BLOCKS]);
        for part in &self.parts {
            let right = &sums[at + part.right..][..BLOCKS * BLOCK + 1];
            let left = &sums[at + part.left..][..BLOCKS * BLOCK + 1];
            for block in 0..BLOCKS {
                let start = block * BLOCK;
                let near = f32x16::from_slice(simd, &right[start..start + BLOCK]);
                let far = f32x16::from_slice(simd, &right[start + 1..start + 1 + BLOCK]);
                let last = f32x16::from_slice(simd, &left[start..start + BLOCK]);
                let first = f32x16::from_slice(simd, &left[start + 1..start + 1 + BLOCK]);
                // Whole numbers: all but the last product is exact.
                whole[block] += near - first;
                rest[block] += ((far - near) + (first - last)) * part.rest;
            }
        }
        let one = f32x16::splat(simd, 1.0);
        let blocks = densities.as_chunks_mut::<BLOCK>().0.iter_mut();
        for (block, densities) in blocks.enumerate().take(BLOCKS) {
            let density = (whole[block] + rest[block]) / self.total;
            density.max(zero).min(one).store_slice(densities);
        }
    }
}
