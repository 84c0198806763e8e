//! Samples between samples, where density bends too much for a lattice: as many again each way, in a few tiles alone.
//!
//! Elsewhere samples half as near to one another are enough, and a lattice that is fine everywhere would have several times as many.
//! Here the smallest squares, of one sample, may be halved as well, and then the sides between two samples.

use fearless_simd::Simd;

use super::Lattice;
use super::tips::Tip;
use super::tube::{BETWEEN, Tube, bends, clean};
use crate::density::tiles::{PLACES, SIDE, Tiles};

/// In half samples, column and row. The parities are a spot's kind: a sample, or between two along a row or a column, or in
/// the middle of four.
pub(super) type Spot = [usize; 2];

/// Kinds of spots, by their first parity and twice the second.
pub(super) const KINDS: usize = 4;
const LEVEL: usize = 1;
const UPRIGHT: usize = 2;
const CENTER: usize = 3;

/// From a sample to where densities are taken: between two along both axes, and in the middles of a quarter's diagonals.
const OFFSETS: [[f64; 2]; PLACES] = [
    [0.5, 0.0],
    [0.0, 0.5],
    [0.25, 0.25],
    [0.75, 0.25],
    [0.25, 0.75],
    [0.75, 0.75],
];

/// The number among the offsets of the first in a quarter's middle.
const QUARTERS: usize = 2;

/// What is known between samples, and which sides are halved there.
#[derive(Debug, Default)]
pub(super) struct Finer {
    /// Columns and rows of samples.
    size: [usize; 2],
    /// Whether squares of one sample may be halved in a tile.
    fine: Vec<bool>,
    /// Whether densities are known in it: in those about them too.
    known: Vec<bool>,
    densities: [Vec<f32>; PLACES],
    /// The least and the most that a mesh may have, by the kind of spot.
    bounds: [Vec<[f32; 2]>; KINDS],
    /// Whether the side is halved whose middle a spot is, by its kind.
    halved: [Vec<bool>; KINDS],
}

impl Finer {
    /// Forgets all, and takes memory for a lattice of so many columns and rows: warm, none is taken whether it is needed or not.
    pub(super) fn begin(&mut self, size: [usize; 2]) {
        self.size = size;
        let (count, tiles) = (size[0] * size[1], size[0] / SIDE * (size[1] / SIDE));
        for marks in [&mut self.fine, &mut self.known] {
            marks.clear();
            marks.reserve(tiles);
        }
        for marks in &mut self.halved {
            marks.clear();
            marks.reserve(count);
        }
        for densities in &mut self.densities {
            densities.reserve(count.saturating_sub(densities.len()));
        }
        for bounds in &mut self.bounds {
            bounds.reserve(count.saturating_sub(bounds.len()));
        }
    }

    /// Whether there is any such tile.
    pub(super) fn any(&self) -> bool {
        !self.fine.is_empty()
    }

    /// Finds the tiles about samples where density bends too much.
    pub(super) fn find(&mut self, tube: &Tube) {
        let [columns, rows] = self.size;
        let tiles = [columns / SIDE, rows / SIDE];
        for marks in [&mut self.fine, &mut self.known] {
            marks.resize(tiles[0] * tiles[1], false);
        }
        for y in 0..tiles[1] * SIDE {
            let row = &tube.needed()[y * columns..][..columns];
            for (tile, needed) in row.as_chunks::<SIDE>().0.iter().enumerate() {
                if needed.iter().any(|&needed| needed > tube.limit) {
                    mark_about(&mut self.fine, tiles, [tile, y / SIDE]);
                }
            }
        }
        for y in 0..tiles[1] {
            for x in 0..tiles[0] {
                if self.fine[y * tiles[0] + x] {
                    mark_about(&mut self.known, tiles, [x, y]);
                }
            }
        }
    }

    /// Takes the densities.
    #[inline(always)]
    pub(super) fn sample<S: Simd>(
        &mut self,
        simd: S,
        tiles: &mut Tiles,
        radius: f64,
        lattice: &Lattice,
    ) {
        for densities in &mut self.densities {
            densities.resize(self.size[0] * self.size[1], 0.0);
        }
        let densities = self.densities.each_mut().map(Vec::as_mut_slice);
        tiles.fill(simd, radius, lattice, OFFSETS, Some(&self.known), densities);
        for [x, y] in samples_in(&self.known, self.size) {
            for densities in &mut self.densities {
                let density = &mut densities[y * self.size[0] + x];
                *density = clean(*density);
            }
        }
    }

    /// The density that a vertex has at a spot.
    pub(super) fn vertex_at(&self, tube: &Tube, spot: Spot) -> f32 {
        match spot.map(|at| at % 2) {
            [0, 0] => tube.at(spot.map(|at| at / 2)),
            _ => self.at(tube, spot),
        }
    }

    /// The density at a spot, as it is sampled.
    #[inline(always)]
    fn at(&self, tube: &Tube, [x, y]: Spot) -> f32 {
        let sample = y / 2 * self.size[0] + x / 2;
        match x % 2 + 2 * (y % 2) {
            LEVEL => self.densities[0][sample],
            UPRIGHT => self.densities[1][sample],
            CENTER => tube.centers[sample],
            _ => tube.densities[sample],
        }
    }

    /// How far down and up density may be off about a spot, from what is known there.
    fn off(&self, tube: &Tube, spot: Spot) -> [f32; 2] {
        let at = |x: isize, y: isize| self.at(tube, moved(spot, [x, y]));
        let here = at(0, 0);
        let second = |x: isize, y: isize| at(x, y) + at(-x, -y) - 2.0 * here;
        let [low, high] = bends(second(1, 0), second(0, 1), second(1, 1), second(1, -1));
        let (mut low, mut high) = (BETWEEN * low, BETWEEN * high);
        if spot[0] % 2 == spot[1] % 2 {
            for way in [[1, 1], [-1, 1], [-1, -1], [1, -1]] {
                let [x, y] = moved([2 * spot[0], 2 * spot[1]], way);
                let quarter = QUARTERS + x % 4 / 2 + y % 4 / 2 * 2;
                let middle = self.densities[quarter][y / 4 * self.size[0] + x / 4];
                let off = 0.5 * (here + at(way[0], way[1])) - middle;
                (low, high) = (low.min(off), high.max(off));
            }
        }
        [low, high]
    }

    /// Finds what a mesh may be at spots, and narrows the tube by what is known of the way to samples' neighbours. Gives how much density
    /// bends between spots over what they may be apart for, as [`Tube::surround`] does.
    pub(super) fn surround(
        &mut self,
        tube: &mut Tube,
        tips: &[Tip],
        lattice: &Lattice,
        radius: f64,
    ) -> f32 {
        let columns = self.size[0];
        for bounds in &mut self.bounds {
            bounds.resize(columns * self.size[1], [0.0; 2]);
            for [x, y] in samples_in(&self.fine, self.size) {
                bounds[y * columns + x] = [0.0; 2];
            }
        }
        self.add_tips(tips, lattice, radius);
        let mut worst: f32 = 0.0;
        for [x, y] in samples_in(&self.fine, self.size) {
            for kind in 0..KINDS {
                let spot = [2 * x + kind % 2, 2 * y + kind / 2];
                let (here, sample) = (self.at(tube, spot), y * columns + x);
                let [low, high] = self.off(tube, spot);
                let [hidden, _] = self.bounds[kind][sample];
                let (low, high) = (low.min(-hidden), high.max(hidden));
                worst = worst.max(high).max(-low);
                self.bounds[kind][sample] = [here - low - tube.limit, here - high + tube.limit];
                let chords: &[[usize; 2]] = match kind {
                    LEVEL => &[[0, 1]],
                    UPRIGHT => &[[0, columns]],
                    CENTER => &[[0, columns + 1], [1, columns]],
                    _ => &[],
                };
                for ends in chords {
                    tube.narrow_chord(ends.map(|end| sample + end), here, [low, high]);
                }
            }
        }
        for [x, y] in samples_in(&self.known, self.size) {
            tube.settle(y * columns + x);
        }
        for [x, y] in samples_in(&self.fine, self.size) {
            let sample = y * columns + x;
            let ([least, most], balanced) = (self.bounds[0][sample], &mut tube.balanced[sample]);
            *balanced = balanced.max(least).min(most);
        }
        worst / tube.limit
    }

    /// Puts how far density may be off because of tips beside spots in place of their bounds.
    fn add_tips(&mut self, tips: &[Tip], lattice: &Lattice, radius: f64) {
        for tip in tips {
            let height = tip.height(lattice.pitch / 2.0, radius) as f32;
            let (place, reach) = (2.0 * tip.place(lattice), tip.reach(lattice.pitch / 2.0));
            let range = |axis: usize| {
                let end = 2.0 * self.size[axis] as f64 - 1.0;
                let at = |at: f64| at.clamp(0.0, end) as usize;
                at((place[axis] - reach).floor())..at((place[axis] + reach).ceil()) + 1
            };
            for y in range(1) {
                for x in range(0) {
                    let sample = y / 2 * self.size[0] + x / 2;
                    let [hidden, _] = &mut self.bounds[x % 2 + 2 * (y % 2)][sample];
                    *hidden = hidden.max(height);
                }
            }
        }
    }

    /// Chooses the sides to halve between samples: those off which density is too far, and those about samples beside which a mesh can't
    /// be within the tube unless they are.
    pub(super) fn choose(&mut self, tube: &Tube) {
        let [columns, rows] = self.size;
        if self.any() {
            for marks in &mut self.halved {
                marks.resize(columns * rows, false);
            }
        }
        let Self {
            fine,
            known,
            bounds,
            halved,
            ..
        } = self;
        let is_off = |kind: usize, sample: usize, ends: [usize; 2]| {
            let [least, most] = bounds[kind][sample];
            let middle = 0.5 * (tube.balanced[ends[0]] + tube.balanced[ends[1]]);
            middle < least || middle > most
        };
        for [x, y] in samples_in(fine, [columns, rows]) {
            let sample = y * columns + x;
            halved[LEVEL][sample] = is_off(LEVEL, sample, [sample, sample + 1]);
            halved[UPRIGHT][sample] = is_off(UPRIGHT, sample, [sample, sample + columns]);
            let ends = diagonals([x, y], columns)[0];
            halved[CENTER][sample] = is_off(CENTER, sample, ends);
        }
        for [x, y] in samples_in(known, [columns, rows]) {
            let sample = y * columns + x;
            let is_closed = |&sample: &usize| {
                let balanced = tube.balanced[sample];
                balanced < tube.least[sample] || balanced > tube.most[sample]
            };
            halved[CENTER][sample] |= halved[LEVEL][sample]
                || halved[LEVEL][sample + columns]
                || halved[UPRIGHT][sample]
                || halved[UPRIGHT][sample + 1]
                || diagonals([x, y], columns).iter().flatten().any(is_closed);
        }
    }

    /// Marks the sides of two samples that are halved because squares of one sample beside them are.
    pub(super) fn mark_beside(&self, halved: &mut [bool]) {
        let columns = self.size[0];
        for [x, y] in samples_in(&self.known, self.size) {
            if self.halved[CENTER][y * columns + x] {
                // A square's right angles.
                for middle in diagonals([x, y], columns)[1] {
                    halved[middle] = true;
                }
            }
        }
    }

    /// Whether the side is halved whose middle a spot is.
    pub(super) fn is_halved(&self, [x, y]: Spot) -> bool {
        self.any() && self.halved[x % 2 + 2 * (y % 2)][y / 2 * self.size[0] + x / 2]
    }
}

/// A spot as a number, on a lattice of a size: its sample's, and so many more as there are samples for each kind.
pub(super) fn spot_key([x, y]: Spot, [columns, rows]: [usize; 2]) -> u32 {
    let kind = x % 2 + 2 * (y % 2);
    (kind * columns * rows + y / 2 * columns + x / 2) as u32
}

/// The spot of a number.
pub(super) fn spot_of(key: u32, [columns, rows]: [usize; 2]) -> Spot {
    let (kind, sample) = (
        key as usize / (columns * rows),
        key as usize % (columns * rows),
    );
    [
        2 * (sample % columns) + kind % 2,
        2 * (sample / columns) + kind / 2,
    ]
}

/// Marks a tile and those about it.
fn mark_about(marks: &mut [bool], [columns, rows]: [usize; 2], [x, y]: [usize; 2]) {
    for y in y.saturating_sub(1)..(y + 2).min(rows) {
        for x in x.saturating_sub(1)..(x + 2).min(columns) {
            marks[y * columns + x] = true;
        }
    }
}

/// The ends of the diagonal along which a square of one sample is halved, and of its other one. The first sample is the square's.
fn diagonals([x, y]: [usize; 2], columns: usize) -> [[usize; 2]; 2] {
    let sample = y * columns + x;
    let (falling, rising) = (
        [sample, sample + columns + 1],
        [sample + 1, sample + columns],
    );
    if (x + y).is_multiple_of(2) {
        [falling, rising]
    } else {
        [rising, falling]
    }
}

/// The samples of the tiles that are marked, without those at the lattice's own sides, where nothing bends.
fn samples_in(marks: &[bool], [columns, rows]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
    let tiles = (0..marks.len()).filter(|&tile| marks[tile]);
    tiles.flat_map(move |tile| {
        let first = [tile % (columns / SIDE), tile / (columns / SIDE)].map(|at| at * SIDE);
        let range = move |axis: usize, count: usize| {
            first[axis].max(1)..(first[axis] + SIDE).min(count - 1)
        };
        range(1, rows).flat_map(move |y| range(0, columns).map(move |x| [x, y]))
    })
}

fn moved(spot: Spot, way: [isize; 2]) -> Spot {
    [
        spot[0].wrapping_add_signed(way[0]),
        spot[1].wrapping_add_signed(way[1]),
    ]
}
