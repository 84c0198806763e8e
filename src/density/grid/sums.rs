//! Rows of densities from sums along strips.
//!
//! The outline is cut into strips and summed along each of them, so what the strip of a disc covers is a difference of two
//! sums: a pixel costs the same whatever the outline, and the strips of one row of discs serve the next.

use core::ops::Range;

use fearless_simd::Simd;
use glam::DVec2;

use super::Place;
use super::chords::{GROUP, Height};
use super::disc::Disc;
use super::strips::{BLOCK, QUAD, QUADS, Strips};
use super::weaver::Row;
use crate::density::rows;
use crate::outline::Edge;

/// So many blocks of pixels are computed at once at most.
const MOST: usize = 3;

/// The sums along a strip are exact up to here.
const EXACT: f64 = 16_777_216.0;

/// The steps that a strip's height is cut into, at most and at least.
const FULL: [f64; 2] = [256.0, 64.0];

/// The steps that a strip's height is cut into so that sums along so many cells are exact, and those of a disc.
fn full(radius: f64, height: f64, cells: f64) -> f64 {
    let most = (2.0 * GROUP as f64 * cells).max(4.0 * radius * radius / height);
    libm::exp2(libm::log2(EXACT / most).floor()).min(FULL[0])
}

/// The cells of a shadow of so many columns of pixels, with what its discs reach beyond.
fn cells(columns: f64, radius: f64) -> f64 {
    columns + 4.0 * radius + 8.0 * BLOCK as f64
}

/// Whether all sums stay exact for an outline `columns` pixels wide, with rows `pitch` pixels apart.
pub(super) fn are_exact(radius: f64, pitch: f64, columns: f64) -> bool {
    full(radius, pitch / GROUP as f64, cells(columns, radius)) >= FULL[1]
}

/// What sums leave from drawing to drawing: memory.
#[derive(Debug, Default)]
pub(super) struct SumScratch {
    strips: Strips,
    disc: Disc,
    sums: Sums,
}

/// Rows of sums: of single strips, of all those from one of the lattice's rows to the next, and of two such groups.
#[derive(Debug, Default)]
struct Sums {
    /// Blocks and sums of a row.
    blocks: usize,
    length: usize,
    /// How many rows of strips are kept and how many of the others, less one: powers of two.
    strips: i64,
    groups: i64,
    /// The strips' rows, the groups' and the pairs'.
    sums: Vec<f32>,
    /// The quads of each group that edges cross, a bit each.
    crossed: Vec<u64>,
    /// Those from which a row of discs sees an edge.
    mixed: Vec<u64>,
}

/// Rows from the sums of one outline.
pub(super) struct SumSource<'a> {
    kept: &'a mut SumScratch,
    /// Blocks of sums left and right of the pixels.
    margin: usize,
    /// The next group of strips.
    next_group: i64,
    full: f32,
}

impl<'a> SumSource<'a> {
    /// For edges in penumbra radii; `columns` is the width of the outline in pixels.
    pub(super) fn new(
        edges: impl Iterator<Item = Edge>,
        place: &Place,
        columns: f64,
        kept: &'a mut SumScratch,
    ) -> Self {
        let Place { radius, pitch, .. } = *place;
        let height = pitch / GROUP as f64;
        let full = full(radius, height, cells(columns, radius));
        kept.disc.set(radius, height, full);
        let margin = (kept.disc.reach() + 2).div_ceil(BLOCK);
        let blocks = place.blocks + 2 * margin;
        kept.strips
            .begin(place.first - (margin * BLOCK) as i64, blocks, full);
        let strip = |p: DVec2| DVec2::new(p.x - place.phase.x, p.y / height);
        rows::each_line(edges, rows::ERROR, |from, to| {
            kept.strips.push(strip(from * radius), strip(to * radius));
        });
        kept.strips.end();
        kept.sums.begin(blocks, &kept.disc);
        Self {
            kept,
            margin,
            next_group: i64::MIN,
            full: full as f32,
        }
    }

    /// Computes a row of the lattice, below the last.
    #[inline(always)]
    pub(super) fn weave<S: Simd>(&mut self, simd: S, row: i64, woven: &mut Row) {
        // Groups of strips from the middle of a disc to its end.
        let reach = (self.kept.disc.chords.half + GROUP - 1) / GROUP;
        let SumScratch { strips, disc, sums } = &mut *self.kept;
        self.next_group = self.next_group.max(row - reach);
        while self.next_group < row + reach {
            sums.sum(simd, strips, self.next_group);
            self.next_group += 1;
        }
        sums.find_mixed(disc, row);
        disc.lay(|chord| {
            let group = || row + chord.strip.div_euclid(GROUP);
            match chord.height {
                Height::Strip => sums.strip(row * GROUP + chord.strip),
                Height::Group => sums.group(group()),
                Height::Pair => sums.pair(group()),
            }
        });
        let blocks = sums.blocks - 2 * self.margin;
        let middle = sums.group(row);
        let cell = self.full * GROUP as f32;
        let is_mixed = |block: usize| {
            let quad = (block + self.margin) * (BLOCK / QUAD);
            block < blocks && sums.mixed[quad / 64] >> (quad % 64) & QUADS != 0
        };
        let mut block = 0;
        while block < blocks {
            let at = (block + self.margin) * BLOCK;
            let densities = &mut woven.densities[block * BLOCK..];
            let (count, constant) = if is_mixed(block) {
                let count = (1..MOST).take_while(|&more| is_mixed(block + more)).count() + 1;
                match count {
                    1 => disc.densities::<S, 1>(simd, at, &sums.sums, densities),
                    2 => disc.densities::<S, 2>(simd, at, &sums.sums, densities),
                    _ => disc.densities::<S, MOST>(simd, at, &sums.sums, densities),
                }
                (count, None)
            } else {
                let covered = sums.sums[middle + at + 1] - sums.sums[middle + at];
                let density = (covered / cell).clamp(0.0, 1.0);
                densities[..BLOCK].fill(density);
                (1, Some(density))
            };
            block += count;
            woven.push_run((block * BLOCK) as i64, constant);
        }
    }
}

impl Sums {
    fn begin(&mut self, blocks: usize, disc: &Disc) {
        self.blocks = blocks;
        self.length = blocks * BLOCK + 1;
        let kept = |rows: i64| (rows as u64).next_power_of_two() as i64 - 1;
        self.strips = kept(2 * disc.chords.half + 2 * GROUP);
        self.groups = kept(2 * disc.chords.half / GROUP + 4);
        let rows = (self.strips + 1) + 2 * (self.groups + 1);
        self.sums.resize(rows as usize * self.length, 0.0);
        let words = self.words();
        self.crossed.resize((self.groups + 1) as usize * words, 0);
    }

    /// Where the sums of a strip begin, those of a group, and those of it and the one below.
    fn strip(&self, strip: i64) -> usize {
        (strip & self.strips) as usize * self.length
    }

    fn group(&self, group: i64) -> usize {
        (self.strips + 1 + (group & self.groups)) as usize * self.length
    }

    fn pair(&self, group: i64) -> usize {
        (self.strips + 1 + self.groups + 1 + (group & self.groups)) as usize * self.length
    }

    fn words(&self) -> usize {
        (self.blocks * BLOCK / QUAD).div_ceil(64)
    }

    /// The bits of a group.
    fn bits(&self, group: i64) -> Range<usize> {
        let start = (group & self.groups) as usize * self.words();
        start..start + self.words()
    }

    /// Sums the strips of a group.
    #[inline(always)]
    fn sum<S: Simd>(&mut self, simd: S, strips: &mut Strips, group: i64) {
        let bits = self.bits(group);
        let crossed = &mut self.crossed[bits];
        crossed.fill(0);
        let first = group * GROUP;
        for strip in first..first + GROUP {
            let at = (strip & self.strips) as usize * self.length;
            strips.sum(simd, strip, &mut self.sums[at..at + self.length], crossed);
        }
        self.copy(self.strip(first), self.group(group));
        for strip in first + 1..first + GROUP {
            self.add(self.strip(strip), self.group(group));
        }
        self.copy(self.group(group - 1), self.pair(group - 1));
        self.add(self.group(group), self.pair(group - 1));
    }

    fn copy(&mut self, from: usize, to: usize) {
        self.sums.copy_within(from..from + self.length, to);
    }

    /// Adds a row to one behind it.
    #[inline(always)]
    fn add(&mut self, from: usize, to: usize) {
        let (before, behind) = self.sums.split_at_mut(to);
        let from = &before[from..from + self.length];
        for (sum, other) in behind.iter_mut().zip(from) {
            *sum += *other;
        }
    }

    /// Finds the quads from which the discs of a lattice's row see an edge.
    fn find_mixed(&mut self, disc: &Disc, row: i64) {
        self.mixed.clear();
        self.mixed.resize(self.words(), 0);
        // From the widest of the disc's chords to the narrowest, all reach farther by one quad at a time.
        let mut reached = disc.reach() / QUAD + 1;
        for (chord, farthest) in disc.chords().skip(1).step_by(2) {
            let farthest = farthest / QUAD + 1;
            while reached > farthest {
                widen(&mut self.mixed);
                reached -= 1;
            }
            let first = chord.strip / GROUP;
            let groups = first..first + if chord.height == Height::Pair { 2 } else { 1 };
            for group in groups {
                for group in [row + group, row - group - 1] {
                    let bits = self.bits(group);
                    for (mixed, crossed) in self.mixed.iter_mut().zip(&self.crossed[bits]) {
                        *mixed |= *crossed;
                    }
                }
            }
        }
        for _ in 0..reached {
            widen(&mut self.mixed);
        }
    }
}

/// Sets the bits beside those that are set.
fn widen(bits: &mut [u64]) {
    let mut before = 0;
    for word in 0..bits.len() {
        let after = bits.get(word + 1).copied().unwrap_or(0);
        let now = bits[word];
        bits[word] |= (now << 1) | (now >> 1) | (before >> 63) | (after << 63);
        before = now;
    }
}
