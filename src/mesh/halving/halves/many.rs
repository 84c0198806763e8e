//! Which sides of small triangles are halved, sixteen of them at once.
//!
//! They are those with sixteen samples in a row as middles, though there is a middle at every fourth or eighth alone: that still takes a
//! fraction of the time of one after the other. A triangle's legs are left out, as they are the longest sides of smaller ones and have
//! been looked at before, and so are its corners.

use fearless_simd::{Simd, SimdBase, f32x16};

use super::{Halves, SLANTED_WAYS, Tube, WAYS, is_rising};
use crate::density::lanes::LANES;

/// Samples at distances from sixteen in a row, by their numbers.
struct Many<'a, S: Simd> {
    simd: S,
    tube: &'a Tube,
    /// From row to row.
    columns: isize,
}

/// A side's density at its middle, and how much it grows from sample to sample.
#[derive(Clone, Copy)]
struct Chord<S: Simd> {
    middle: f32x16<S>,
    growth: f32x16<S>,
}

impl<S: Simd> Many<'_, S> {
    #[inline(always)]
    fn at(&self, sample: usize) -> f32x16<S> {
        self.tube.at_many(self.simd, sample)
    }

    #[inline(always)]
    fn chord(&self, middle: usize, along: isize, half: isize) -> Chord<S> {
        let end = self.at(moved(middle, along * half));
        let start = self.at(moved(middle, -along * half));
        Chord {
            middle: (start + end) * 0.5,
            growth: (end - start) * (0.5 / half as f32),
        }
    }

    /// How far a side is outside of the tube between its ends.
    #[inline(always)]
    fn on_side(&self, chord: Chord<S>, middle: usize, along: isize, half: isize) -> f32x16<S> {
        let mut worst = f32x16::splat(self.simd, f32::NEG_INFINITY);
        for step in 1 - half..half {
            let density = chord.middle + chord.growth * step as f32;
            let sample = moved(middle, along * step);
            worst = worst.max(self.tube.excess_at_many(self.simd, density, sample));
        }
        worst
    }

    /// How far the triangle is outside within its sides whose longest one is a chord; `across` is the way to its right angle.
    #[inline(always)]
    fn beside(
        &self,
        chord: Chord<S>,
        middle: usize,
        [along, across]: [isize; 2],
        half: isize,
    ) -> f32x16<S> {
        let apex = self.at(moved(middle, across * half));
        let rise = (apex - chord.middle) * (1.0 / half as f32);
        let mut worst = f32x16::splat(self.simd, f32::NEG_INFINITY);
        for row in 1..half {
            let base = chord.middle + rise * row as f32;
            let end = half - row - 1;
            for step in -end..end + 1 {
                let density = base + chord.growth * step as f32;
                let sample = moved(middle, across * row + along * step);
                worst = worst.max(self.tube.excess_at_many(self.simd, density, sample));
            }
        }
        worst
    }

    /// How far the two triangles of a square are outside on their common side and within; `way` leads from its middle to one of
    /// their right angles.
    #[inline(always)]
    fn in_square(&self, middle: usize, way: [isize; 2], legs: isize) -> f32x16<S> {
        let half = legs / 2;
        let [x, y] = [way[0], way[1] * self.columns];
        let side = x - y;
        let mut worst = self.on_side(self.chord(middle, side, half), middle, side, half);
        for [x, y] in [[x, y], [-x, -y]] {
            let corner = moved(middle, (x + y) * half);
            let density = self.at(corner);
            let share = 1.0 / legs as f32;
            let along = (self.at(moved(corner, -x * legs)) - density) * share;
            let across = (self.at(moved(corner, -y * legs)) - density) * share;
            for row in 1..legs - 1 {
                let base = density + across * row as f32;
                for step in 1..legs - row {
                    let density = base + along * step as f32;
                    let sample = moved(corner, -(x * step + y * row));
                    worst = worst.max(self.tube.excess_at_many(self.simd, density, sample));
                }
            }
        }
        worst
    }
}

impl Halves {
    /// Chooses for all level and upright sides of twice `HALF` samples.
    #[inline(always)]
    pub(super) fn choose_many_straight<S: Simd, const HALF: usize>(
        &mut self,
        simd: S,
        tube: &Tube,
    ) {
        let [columns, rows] = self.size;
        let columns_apart = columns as isize;
        let many = Many {
            simd,
            tube,
            columns: columns_apart,
        };
        let half = HALF as isize;
        let mut found = [[0.0; LANES]; 2];
        for y in (0..rows).step_by(2 * HALF) {
            for start in (HALF..columns).step_by(LANES) {
                let middle = y * columns + start;
                let chord = many.chord(middle, 1, half);
                let mut worst = many.on_side(chord, middle, 1, half);
                if y > 0 {
                    worst = worst.max(many.beside(chord, middle, [1, -columns_apart], half));
                }
                if y + 1 < rows {
                    worst = worst.max(many.beside(chord, middle, [1, columns_apart], half));
                }
                worst.store_slice(&mut found[0]);
                for lane in (0..LANES).step_by(2 * HALF) {
                    let place = [start + lane, y];
                    self.halved[middle + lane] =
                        found[0][lane] > 0.0 || self.any(place, &SLANTED_WAYS, HALF / 2);
                }
            }
        }
        for y in (HALF..rows).step_by(2 * HALF) {
            for start in (0..columns).step_by(LANES) {
                let middle = y * columns + start;
                let chord = many.chord(middle, columns_apart, half);
                let on_side = many.on_side(chord, middle, columns_apart, half);
                let before = many.beside(chord, middle, [columns_apart, -1], half);
                let behind = many.beside(chord, middle, [columns_apart, 1], half);
                on_side.max(before).store_slice(&mut found[0]);
                on_side.max(behind).store_slice(&mut found[1]);
                for lane in (0..LANES.min(columns - start)).step_by(2 * HALF) {
                    let x = start + lane;
                    // Beside the lattice there are no triangles.
                    self.halved[middle + lane] = x > 0 && found[0][lane] > 0.0
                        || x + 1 < columns && found[1][lane] > 0.0
                        || self.any([x, y], &SLANTED_WAYS, HALF / 2);
                }
            }
        }
    }

    /// Chooses for the diagonals of all squares of `LEGS` samples.
    #[inline(always)]
    pub(super) fn choose_many_slanted<S: Simd, const LEGS: usize>(&mut self, simd: S, tube: &Tube) {
        let [columns, rows] = self.size;
        let many = Many {
            simd,
            tube,
            columns: columns as isize,
        };
        let half = LEGS / 2;
        let mut found = [[0.0; LANES]; 2];
        for y in (half..rows).step_by(LEGS) {
            for start in (half..columns).step_by(LANES) {
                let middle = y * columns + start;
                let legs = LEGS as isize;
                many.in_square(middle, [1, 1], legs)
                    .store_slice(&mut found[0]);
                many.in_square(middle, [1, -1], legs)
                    .store_slice(&mut found[1]);
                for lane in (0..LANES).step_by(LEGS) {
                    let place = [start + lane, y];
                    let rising = usize::from(is_rising(place, LEGS));
                    self.halved[middle + lane] =
                        found[rising][lane] > 0.0 || self.any(place, &WAYS, half);
                }
            }
        }
    }
}

#[inline(always)]
fn moved(from: usize, by: isize) -> usize {
    from.wrapping_add_signed(by)
}
