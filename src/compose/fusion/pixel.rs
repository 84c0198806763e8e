//! What is known of pixels after some of the casts.

use core::ops::Range;

use fearless_simd::{Level, Simd, dispatch};

use super::Cast;

/// What is known of pixels after some of the casts: at first nothing. All lists are of one length.
#[derive(Debug, Default)]
pub(super) struct Pixels {
    /// What the casts hold back of the light, and what of it has met any of them.
    held: Vec<f32>,
    met: Vec<f32>,
    /// What the first two that hide a part of the disc hide.
    first: Vec<f32>,
    second: Vec<f32>,
    seen: Vec<Seen>,
}

/// The casts that hide a part of the disc as lower bits, those that hide all of it as upper ones. The last bit of both stands
/// for all casts from there on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Seen(u32);

/// Densities within this of 0 and 1 are these.
const ROUNDING: f32 = 1e-6;

/// The first cast that has no bit for itself.
pub(super) const REST: usize = 15;

/// How far the bits of those that hide all are above the others.
const FULL: u32 = 16;

/// The bit of a cast among those of its group.
pub(super) fn bit(index: usize) -> u32 {
    1 << index.min(REST)
}

impl Seen {
    /// The casts that hide a part of the disc, a bit each.
    pub(super) fn partial(self) -> u32 {
        self.0 & (bit(REST) * 2 - 1)
    }

    /// The casts that hide all of the disc, a bit each.
    pub(super) fn full(self) -> u32 {
        self.0 >> FULL
    }

    /// Whether several casts hide a part of the disc.
    fn is_shared(self) -> bool {
        let partial = self.partial();
        partial & (partial.wrapping_sub(1) | bit(REST)) != 0
    }
}

/// What rounding leaves beyond a shadow's ends would make a partial cast of none.
#[inline(always)]
fn rounded(density: f32) -> f32 {
    if density > 1.0 - ROUNDING {
        1.0
    } else if density < ROUNDING {
        0.0
    } else {
        density
    }
}

impl Pixels {
    /// As many pixels of which nothing is known.
    pub(super) fn reset(&mut self, count: usize) {
        for list in [
            &mut self.held,
            &mut self.met,
            &mut self.first,
            &mut self.second,
        ] {
            list.clear();
            list.resize(count, 0.0);
        }
        self.seen.clear();
        self.seen.resize(count, Seen::default());
    }

    pub(super) fn is_empty(&self) -> bool {
        self.held.is_empty()
    }

    /// Whether several casts hide a part of the disc from any pixel.
    pub(super) fn are_shared(&self) -> bool {
        self.seen.iter().any(|seen| seen.is_shared())
    }

    /// Adds a cast that has one density at some pixels.
    pub(super) fn add_constant(&mut self, level: Level, at: Range<usize>, density: f32, by: By) {
        dispatch!(level, simd => simd.vectorize(#[inline(always)] || {
            self.add(at, core::iter::repeat(density), by);
        }));
    }

    /// Adds a cast that has these densities at some pixels.
    pub(super) fn add_values(&mut self, level: Level, at: Range<usize>, densities: &[f32], by: By) {
        dispatch!(level, simd => simd.vectorize(#[inline(always)] || {
            self.add(at, densities.iter().copied(), by);
        }));
    }

    #[inline(always)]
    fn add(&mut self, at: Range<usize>, densities: impl Iterator<Item = f32>, by: By) {
        let held = self.held[at.clone()].iter_mut();
        let met = self.met[at.clone()].iter_mut();
        let first = self.first[at.clone()].iter_mut();
        let second = self.second[at.clone()].iter_mut();
        let seen = self.seen[at].iter_mut();
        let pixels = held.zip(met).zip(first).zip(second).zip(seen);
        for (((((held, met), first), second), seen), density) in pixels.zip(densities) {
            let density = rounded(density);
            let hides = by.opacity * density * (1.0 - *met);
            *held += by.strength * hides;
            *met += hides;
            let is_partial = density > 0.0 && density < 1.0;
            let partial = seen.partial();
            let is_first = is_partial && partial == 0;
            let is_second = is_partial && partial != 0 && partial & partial.wrapping_sub(1) == 0;
            *first = if is_first { density } else { *first };
            *second = if is_second { density } else { *second };
            let full = if density >= 1.0 { by.bit << FULL } else { 0 };
            seen.0 |= if is_partial { by.bit } else { full };
        }
    }

    /// What the casts hold back at some pixels.
    pub(super) fn held(&self, at: Range<usize>) -> &[f32] {
        &self.held[at]
    }

    /// What the first two of its casts hide that hide a part of the disc.
    pub(super) fn densities(&self, pixel: usize) -> [f32; 2] {
        [self.first[pixel], self.second[pixel]]
    }

    /// The next pixels that see the same casts, several of which hide a part of the disc.
    pub(super) fn next_shared(&self, at: Range<usize>) -> Option<(Seen, Range<usize>)> {
        let all = &self.seen[at.clone()];
        let start = all.iter().position(|seen| seen.is_shared())?;
        let seen = all[start];
        let same = all[start..].iter().take_while(|other| **other == seen);
        let end = start + same.count();
        Some((seen, at.start + start..at.start + end))
    }

    pub(super) fn mend(&mut self, pixel: usize, by: f32) {
        let held = &mut self.held[pixel];
        *held = (*held + by).clamp(0.0, 1.0);
    }
}

/// What a cast does where it hides the disc.
#[derive(Debug, Clone, Copy)]
pub(super) struct By {
    strength: f32,
    opacity: f32,
    bit: u32,
}

impl By {
    /// The cast at an index of its group.
    pub(super) fn new(cast: &Cast, index: usize) -> Self {
        Self {
            strength: cast.strength as f32,
            opacity: cast.opacity as f32,
            bit: bit(index),
        }
    }

    /// What it holds back by itself.
    #[inline(always)]
    pub(super) fn alone(self, density: f32) -> f32 {
        self.strength * (self.opacity * rounded(density))
    }
}
