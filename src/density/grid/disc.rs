//! The light's disc on rows of sums: what its chords cover is the difference of the sums at their ends.

use fearless_simd::{Simd, SimdBase, f32x16};

use super::chords::{Chord, Chords};
use super::strips::BLOCK;

/// A chord, where its row of sums begins, and how many cells from a pixel's own its ends are.
#[derive(Debug, Clone, Copy)]
struct Part {
    row: usize,
    whole: usize,
    /// The weights of the nearer cells and of the farther ones.
    share: f32,
    rest: f32,
}

/// A disc on rows of sums.
#[derive(Debug, Default)]
pub(crate) struct Disc {
    pub(super) chords: Chords,
    /// What each chord reaches.
    reaches: Vec<(usize, f32)>,
    parts: Vec<Part>,
    /// The steps that the disc has in the umbra.
    total: f32,
}

/// Half of a chord and half a pixel: whole pixels, and the rest.
pub(super) fn reach(chord: &Chord) -> (usize, f32) {
    let width = chord.half_width + 0.5;
    (width as usize, width.fract() as f32)
}

impl Disc {
    /// A disc of `radius` pixels on strips of `height` pixels, each cell of which has `full` steps.
    pub(super) fn set(&mut self, radius: f64, height: f64, full: f64) {
        self.chords.set(radius, height);
        // In the order of the pixels' own sums, so that the umbra's density is 1.
        self.total = 0.0;
        self.reaches.clear();
        for chord in &self.chords.all {
            let (whole, rest) = reach(chord);
            self.reaches.push((whole, rest));
            let cell = (full * chord.height.strips() as f64) as f32;
            let [near, far] = [-1.0, 1.0].map(|more| cell * (2.0 * whole as f32 + more));
            self.total += near * (1.0 - rest) + far * rest;
        }
    }

    /// The farthest cell from a pixel's own that its disc reaches.
    pub(super) fn reach(&self) -> usize {
        let widest = self.chords.all.first();
        widest.map_or(0, |chord| reach(chord).0 + 1)
    }

    /// Finds where the rows of sums are that a row of discs meets, by the place of a chord's row.
    pub(super) fn lay(&mut self, place: impl Fn(&Chord) -> usize) {
        self.parts.clear();
        let chords = self.chords.all.iter().zip(&self.reaches);
        self.parts.extend(chords.map(|(chord, &(whole, rest))| {
            let row = place(chord);
            Part {
                row,
                whole,
                share: 1.0 - rest,
                rest,
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
        let mut totals = [zero; BLOCKS];
        for part in &self.parts {
            let right = &sums[at + part.row + part.whole..][..BLOCKS * BLOCK + 1];
            let left = &sums[at + part.row - part.whole..][..BLOCKS * BLOCK + 1];
            for (block, total) in totals.iter_mut().enumerate() {
                let start = block * BLOCK;
                let near = f32x16::from_slice(simd, &right[start..start + BLOCK]);
                let far = f32x16::from_slice(simd, &right[start + 1..start + 1 + BLOCK]);
                let last = f32x16::from_slice(simd, &left[start..start + BLOCK]);
                let first = f32x16::from_slice(simd, &left[start + 1..start + 1 + BLOCK]);
                // Differences of whole numbers, wherever the sums begin: these are exact.
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
