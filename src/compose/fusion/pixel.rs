//! What is known of pixels after some of the casts.

use core::ops::Range;
use std::collections::BTreeMap;

use fearless_simd::{Level, Simd, dispatch};

use super::Cast;
use crate::density::lanes::LANES;

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
    sets: Sets,
}

/// The casts that a pixel sees: which of the sets it is, above two bits for how many of them hide a part of the disc.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Seen(u32);

/// The count that stands for all larger ones.
const MANY: u32 = 3;

impl Seen {
    #[inline(always)]
    fn partial(self) -> u32 {
        self.0 & MANY
    }

    fn set(self) -> usize {
        (self.0 >> 2) as usize
    }
}

/// Some casts of a group by their numbers, from the least on.
#[derive(Debug, Clone, Default)]
pub(super) struct Casts {
    /// Those that hide a part of the disc.
    pub(super) partial: Vec<usize>,
    /// Those that hide all of it.
    pub(super) full: Vec<usize>,
}

/// The sets of casts that pixels have seen so far. Casts come one after the other: each set is made in one way.
#[derive(Debug, Default)]
struct Sets {
    all: Vec<Casts>,
    /// The set that one becomes with a cast that hides a part of the disc, or all of it.
    joined: BTreeMap<(Seen, usize, bool), Seen>,
}

impl Sets {
    /// Back to none but the empty one.
    fn reset(&mut self) {
        self.joined.clear();
        self.all.clear();
        self.all.push(Casts::default());
    }

    fn join(&mut self, seen: Seen, cast: usize, is_full: bool) -> Seen {
        let all = &mut self.all;
        let join = || {
            let mut casts = all[seen.set()].clone();
            let list = if is_full {
                &mut casts.full
            } else {
                &mut casts.partial
            };
            list.push(cast);
            let partial = (casts.partial.len() as u32).min(MANY);
            all.push(casts);
            Seen((all.len() as u32 - 1) << 2 | partial)
        };
        *self
            .joined
            .entry((seen, cast, is_full))
            .or_insert_with(join)
    }
}

/// Densities within this of 0 and 1 are these.
const ROUNDING: f32 = 1e-6;

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
        for list in [&mut self.held, &mut self.met] {
            list.clear();
            list.resize(count, 0.0);
        }
        // What is left in these is read of no pixel before it is written.
        for list in [&mut self.first, &mut self.second] {
            list.resize(count, 0.0);
        }
        self.seen.clear();
        self.seen.resize(count, Seen::default());
        self.sets.reset();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.held.is_empty()
    }

    /// Whether several casts hide a part of the disc from any pixel.
    pub(super) fn are_shared(&self) -> bool {
        self.seen.iter().any(|seen| seen.partial() > 1)
    }

    /// Adds a cast that has one density at some pixels.
    pub(super) fn add_constant(&mut self, level: Level, at: Range<usize>, density: f32, by: By) {
        let density = rounded(density);
        if density == 0.0 {
            return;
        }
        dispatch!(level, simd => simd.vectorize(#[inline(always)] || {
            self.hide(at.clone(), core::iter::repeat(density), by);
        }));
        for seen in self.seen[at].chunk_by_mut(|a, b| a == b) {
            seen.fill(self.sets.join(seen[0], by.cast, density == 1.0));
        }
    }

    /// Adds a cast that has these densities at some pixels.
    pub(super) fn add_values(&mut self, level: Level, at: Range<usize>, densities: &[f32], by: By) {
        dispatch!(level, simd => simd.vectorize(#[inline(always)] || {
            self.hide(at.clone(), densities.iter().map(|&density| rounded(density)), by);
            self.join(at, densities, by.cast);
        }));
    }

    #[inline(always)]
    fn hide(&mut self, at: Range<usize>, densities: impl Iterator<Item = f32>, by: By) {
        let held = self.held[at.clone()].iter_mut();
        let met = self.met[at.clone()].iter_mut();
        let first = self.first[at.clone()].iter_mut();
        let second = self.second[at.clone()].iter_mut();
        let seen = self.seen[at].iter();
        let pixels = held.zip(met).zip(first).zip(second).zip(seen);
        for (((((held, met), first), second), seen), density) in pixels.zip(densities) {
            let hides = by.opacity * density * (1.0 - *met);
            *held += by.strength * hides;
            *met += hides;
            let is_partial = density > 0.0 && density < 1.0;
            let before = seen.partial();
            *first = if is_partial && before == 0 {
                density
            } else {
                *first
            };
            *second = if is_partial && before == 1 {
                density
            } else {
                *second
            };
        }
    }

    /// Notes which pixels see a cast.
    #[inline(always)]
    fn join(&mut self, at: Range<usize>, densities: &[f32], cast: usize) {
        let mut last = None;
        let seen = self.seen[at].chunks_mut(LANES);
        for (seen, densities) in seen.zip(densities.chunks(LANES)) {
            // Most of them are alike.
            let first = seen[0];
            let alike = seen.iter().fold(true, |all, seen| all & (*seen == first));
            let are_partial = densities.iter().fold(alike, |all, density| {
                all & (*density >= ROUNDING) & (*density <= 1.0 - ROUNDING)
            });
            let count = if are_partial { 1 } else { seen.len() };
            for index in 0..count {
                let density = rounded(densities[index]);
                if density == 0.0 {
                    continue;
                }
                let key = (seen[index], density == 1.0);
                let joined = match last {
                    Some((known, joined)) if known == key => joined,
                    _ => self.sets.join(key.0, cast, key.1),
                };
                last = Some((key, joined));
                seen[index] = joined;
            }
            if are_partial {
                seen.fill(seen[0]);
            }
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

    /// The casts of a set.
    pub(super) fn casts(&self, seen: Seen) -> &Casts {
        &self.sets.all[seen.set()]
    }

    /// The next pixels that see the same casts, several of which hide a part of the disc.
    pub(super) fn next_shared(&self, at: Range<usize>) -> Option<(Seen, Range<usize>)> {
        let is_shared = |seen: &Seen| seen.partial() > 1;
        // A block at once: most pixels are not.
        let any_shared =
            |block: &[Seen]| block.iter().fold(false, |any, seen| any | is_shared(seen));
        let first = self.seen[at.clone()].chunks(LANES).position(any_shared)?;
        let start = at.start + first * LANES;
        let start = start + self.seen[start..at.end].iter().position(is_shared)?;
        let seen = self.seen[start];
        let same = self.seen[start..at.end].iter();
        Some((
            seen,
            start..start + same.take_while(|other| **other == seen).count(),
        ))
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
    cast: usize,
}

impl By {
    /// The cast at an index of its group.
    pub(super) fn new(cast: &Cast, index: usize) -> Self {
        Self {
            strength: cast.strength as f32,
            opacity: cast.opacity as f32,
            cast: index,
        }
    }

    /// What it holds back by itself.
    #[inline(always)]
    pub(super) fn alone(self, density: f32) -> f32 {
        self.strength * (self.opacity * rounded(density))
    }
}
