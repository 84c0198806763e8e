//! What a pixel's density is the average over: the light's disc, or below r = 3 px the disc moved all over the pixel's square.
//!
//! The square is taken in bands, one below the other. At a height above such a band's middle the average is over chords of many
//! lengths at once, each moved along the square's side: for these one stands whose variance is the same. Its error falls with the
//! square of the number of bands.

use core::f64::consts::PI;
use core::ops::Range;

use fearless_simd::{Simd, SimdFrom, f32x16};

use crate::density::lanes::LANES;
use crate::density::rows::Window;
use crate::density::{averaged_side, reach};

/// The disc, or the disc all over the bands of a pixel's square; all in pixels.
#[derive(Debug, Default)]
pub(super) struct Kernel {
    radius: f64,
    /// The square's side, and how many bands it is taken in.
    pub(super) side: f64,
    bands: usize,
    slices: Slices,
}

/// A band's average at heights from its middle to its end, and nothing behind that.
#[derive(Debug)]
struct Slices {
    /// The chords, and how much of the average lies on a pixel of each.
    widths: [f32; SLICES],
    weights: [f32; SLICES],
    /// How much lies above.
    above: [f32; SLICES],
}

impl Default for Slices {
    fn default() -> Self {
        let none = [0.0; SLICES];
        Self {
            widths: none,
            weights: none,
            above: none,
        }
    }
}

/// The penumbra radii, in pixels, at which the disc is neither much smaller than the square nor much larger: there one band is worst.
pub(super) const LIKE_SQUARE: Range<f64> = 0.9..1.85;

/// The largest error with one band, in levels. Measured on 6,000 rectangles.
fn one_band(radius: f64) -> f64 {
    if radius < LIKE_SQUARE.start {
        0.7
    } else if radius < LIKE_SQUARE.end {
        1.25
    } else {
        0.8
    }
}

/// The share of the tolerance that this may take.
const SHARE: f64 = 0.8;

/// Intervals from a band's middle to its end.
const INTERVALS: usize = 32;

/// Room for their ends and for what is behind the last one: a power of two, so that a number is in it whose upper bits are cut off.
const SLICES: usize = 64;

impl Kernel {
    /// For a penumbra radius in pixels.
    pub(super) fn set(&mut self, radius: f64, levels: f64) {
        self.radius = radius;
        self.side = averaged_side(radius);
        if !self.is_averaged() {
            self.bands = 1;
            return;
        }
        self.bands = (one_band(radius) / (SHARE * levels)).sqrt().ceil() as usize;
        let (half, reach) = (self.half_band(), self.reach());
        let all = PI * radius * radius * half;
        for interval in 0..=INTERVALS {
            let height = reach * interval as f64 / INTERVALS as f64;
            let [lower, upper] = [height - half, height + half].map(|rise| self.moments(rise));
            let [area, cube, above] = [0, 1, 2].map(|moment| upper[moment] - lower[moment]);
            let half_width = (cube / area.max(1e-9)).max(0.0).sqrt().max(SHORTEST);
            self.slices.widths[interval] = 2.0 * half_width as f32;
            self.slices.weights[interval] = (area / half_width) as f32;
            self.slices.above[interval] = (above / all) as f32;
        }
    }

    pub(super) fn is_averaged(&self) -> bool {
        self.side > 0.0
    }

    /// Where a band's middle is, from the pixel's centre.
    pub(super) fn middle(&self, band: usize) -> f64 {
        self.side * ((band as f64 + 0.5) / self.bands as f64 - 0.5)
    }

    /// How many bands there are.
    pub(super) fn count(&self) -> usize {
        self.bands
    }

    fn half_band(&self) -> f64 {
        self.side / (2 * self.bands) as f64
    }

    /// How far from its middle a band's average reaches.
    pub(super) fn reach(&self) -> f64 {
        self.radius + self.half_band()
    }

    /// How much of what a band averages over lies above a height, over the reach, at which that is the disc's `half`.
    pub(super) fn above(&self, sine: f32, half: f32) -> f32 {
        if !self.is_averaged() {
            return 0.5 + 2.0 * half;
        }
        let (slice, share) = slice(sine);
        let [above, next] = [0, 1].map(|more| self.slices.above[(slice + more) % SLICES]);
        0.5 + (above + (next - above) * share).copysign(sine)
    }

    /// How much of what a pixel averages over lies between two heights, in pixels.
    #[inline(always)]
    pub(super) fn between(&self, ends: [f64; 2]) -> f32 {
        let reach = reach(self.radius);
        if ends[0] <= -reach && ends[1] >= reach {
            return 1.0;
        }
        self.partly_between(ends)
    }

    fn partly_between(&self, ends: [f64; 2]) -> f32 {
        if !self.is_averaged() {
            let [above, below] = ends.map(|end| Window::Disc.half(end / self.radius));
            return 2.0 * (below - above);
        }
        let half = self.side / 2.0;
        let [above, below] =
            ends.map(|end| self.moments(end + half)[2] - self.moments(end - half)[2]);
        ((below - above) / (PI * self.radius * self.radius * half)) as f32
    }

    /// The chords at heights over the reach, and how much of the average lies on a pixel of each.
    #[inline(always)]
    pub(super) fn chords<S: Simd>(&self, simd: S, heights: f32x16<S>) -> [f32x16<S>; 2] {
        let mut found = [[0.0; LANES]; 2];
        for lane in 0..LANES {
            let (slice, share) = slice(heights[lane]);
            for (found, list) in found
                .iter_mut()
                .zip([&self.slices.widths, &self.slices.weights])
            {
                let (here, next) = (list[slice % SLICES], list[(slice + 1) % SLICES]);
                found[lane] = here + (next - here) * share;
            }
        }
        [
            f32x16::simd_from(simd, found[0]),
            f32x16::simd_from(simd, found[1]),
        ]
    }

    /// The integrals up to a height from the disc's middle of half a chord, of its cube, and of the first of these integrals.
    fn moments(&self, rise: f64) -> [f64; 3] {
        let (radius, square) = (self.radius, self.radius * self.radius);
        let beyond = rise - rise.clamp(-radius, radius);
        let rise = rise.clamp(-radius, radius);
        let half = (square - rise * rise).max(0.0).sqrt();
        let angle = libm::asin(rise / radius);
        let area = (rise * half + square * angle) / 2.0;
        let cube = (rise * half * half * half + 3.0 * square * area) / 4.0;
        let above = (square * (rise * angle + half) - half * half * half / 3.0) / 2.0;
        [area, cube, above + beyond * area]
    }
}

/// The slice before a height over the reach, and how far from there to the next one it is.
#[inline(always)]
fn slice(height: f32) -> (usize, f32) {
    let place = height.abs().min(1.0) * INTERVALS as f32;
    let slice = place as u32;
    // The fraction itself is a call where a level has no instruction for it.
    (slice as usize, place - slice as f32)
}

/// The least half width of a chord, in pixels.
const SHORTEST: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn averages_between_two_heights_are_means_over_the_square() {
        let mut kernel = Kernel::default();
        for radius in [0.01, 0.2, 0.5, 0.89] {
            kernel.set(radius, 1.0);
            for ends in [
                [-0.3, 0.4],
                [-2.0, 0.1],
                [0.2, 5.0],
                [-0.05, 0.0],
                [0.7, 0.9],
            ] {
                let samples = 2000;
                let means = (0..samples).map(|sample| {
                    let offset = (f64::from(sample) + 0.5) / f64::from(samples) - 0.5;
                    let [above, below] = ends.map(|end| Window::Disc.half((end - offset) / radius));
                    f64::from(2.0 * (below - above))
                });
                let mean = means.sum::<f64>() / f64::from(samples);
                let found = f64::from(kernel.between(ends));
                assert!(
                    (found - mean).abs() < 1e-4,
                    "r {radius}, {ends:?}: {found}, {mean}"
                );
            }
        }
    }
}
