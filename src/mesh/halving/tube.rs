//! What a mesh may be at each sample.

use fearless_simd::{Simd, SimdBase, f32x16};
use glam::DVec2;

use crate::density::lanes::{LANES, NUMBERS};

/// How far density may be off the chord between two samples, over the second differences there: where the penumbra ends between
/// them it goes with the power 1.5 of the distance, and is off by 0.21 of the larger and 0.26 of their mean.
pub(super) const BETWEEN: f32 = 0.26;

/// Densities so near to 0 or 1 are that: a thousandth of a level.
const NOISE: f32 = 4e-6;

/// From how many samples away bends are measured: about as far as triangles reach.
const BEND: usize = 3;

/// The part of the tolerance that vertices are moved by at most.
const BALANCED: f32 = 0.9;

/// Samples that are looked at together.
const RUN: usize = 8;

/// So many samples are read past the end of the last row, at most.
const BEHIND: usize = 2 * LANES;

/// Densities on a lattice, and the least and the largest that a mesh may have there so that it is within a tolerance at the
/// sample and on the way to its neighbours.
#[derive(Debug, Default)]
pub(super) struct Tube {
    /// Columns and rows.
    size: [usize; 2],
    pub(super) limit: f32,
    pub(super) densities: Vec<f32>,
    /// Those in the middle between each sample, the next and the two below.
    pub(super) centers: Vec<f32>,
    /// What vertices have instead, so that triangles are off both ways.
    pub(super) balanced: Vec<f32>,
    pub(super) least: Vec<f32>,
    pub(super) most: Vec<f32>,
}

/// A row of samples: what vertices have there, and between what they may be.
pub(super) struct Row<'a> {
    pub(super) densities: &'a [f32],
    least: &'a [f32],
    most: &'a [f32],
}

impl Row<'_> {
    /// Whether a density is outside of the tube.
    #[inline(always)]
    pub(super) fn is_outside(&self, x: usize, density: f32) -> bool {
        (density > self.most[x]) | (density < self.least[x])
    }
}

/// A plane over the lattice: its density at a right triangle's corner, and how much it grows from column to column and from
/// row to row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    pub(super) corner: f32,
    pub(super) growth: [f32; 2],
}

/// A right triangle with legs along the lattice: the sample at its right angle, the way of its legs (1 or -1) and their length.
#[derive(Debug, Clone, Copy)]
pub(super) struct Right {
    pub(super) corner: [usize; 2],
    pub(super) ways: [isize; 2],
    pub(super) legs: usize,
}

impl Tube {
    /// Takes memory for so many columns and rows of samples and as many between them, all 0, and hands it out to be filled.
    pub(super) fn begin(&mut self, size: [usize; 2]) -> [&mut [f32]; 2] {
        self.size = size;
        for densities in [&mut self.densities, &mut self.centers] {
            densities.clear();
            densities.resize(size[0] * size[1], 0.0);
        }
        [&mut self.densities, &mut self.centers]
    }

    /// Columns and rows.
    pub(super) fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The density that a vertex has at a sample.
    #[inline(always)]
    pub(super) fn at(&self, [x, y]: [usize; 2]) -> f32 {
        self.balanced[y * self.size[0] + x]
    }

    /// Lays the tube about the samples. What limit it [takes](Self::needed) is more where it is closed, or where the part `hidden` of a
    /// bend is larger.
    ///
    /// Between two samples density is off their chord by a [part](BETWEEN) of the second difference, up where it is negative and
    /// down where it is positive. What is known of it along rows and along columns adds up, as where two ends of penumbrae cross,
    /// and what is known of it along both diagonals, if one bends up and the other down: rows and columns show nothing of that.
    /// In the middle of diagonals, where triangles' longest sides pass samples that are farther apart than along rows, it is sampled:
    /// of 2,077 icons 5 passed the tolerance there, by up to an eighth, while samples alone told of it.
    #[inline(always)]
    pub(super) fn surround(&mut self, limit: f32, hidden: f32) {
        let [columns, rows] = self.size;
        let count = columns * rows;
        self.limit = limit;
        // One list after the other: chained they are not taken by vectors.
        for densities in [&mut self.densities, &mut self.centers] {
            for density in densities {
                *density = clean(*density);
            }
        }
        for (bounds, empty) in [(&mut self.least, -limit), (&mut self.most, limit)] {
            bounds.clear();
            bounds.resize(count + BEHIND, empty);
        }
        // What limit it takes at each sample.
        let needed = &mut self.balanced;
        needed.clear();
        needed.resize(count + BEHIND, 0.0);
        for row in 1..rows - 1 {
            let start = row * columns;
            let [above, here, below] = [start - columns, start, start + columns]
                .map(|start| self.densities[start..start + columns].windows(3));
            let inner = start + 1..start + columns - 1;
            let bounds = self.least[inner.clone()]
                .iter_mut()
                .zip(&mut self.most[inner.clone()]);
            let [over, under] = [start - columns, start]
                .map(|start| self.centers[start..start + columns - 1].windows(2));
            let samples = above.zip(here).zip(below).zip(over.zip(under));
            let found = bounds.zip(&mut needed[inner]);
            for ((((above, here), below), (over, under)), ((least, most), needed)) in
                samples.zip(found)
            {
                // How far the chords along diagonals are above density.
                let half = 0.5 * here[1];
                let off = [
                    half + 0.5 * above[0] - over[0],
                    half + 0.5 * above[2] - over[1],
                    half + 0.5 * below[0] - under[0],
                    half + 0.5 * below[2] - under[1],
                ];
                let lowest = smaller(smaller(off[0], off[1]), smaller(off[2], off[3]));
                let highest = larger(larger(off[0], off[1]), larger(off[2], off[3]));
                let twice = 2.0 * here[1];
                let along = here[0] + here[2] - twice;
                let across = above[1] + below[1] - twice;
                let down = above[0] + below[2] - twice;
                let up = above[2] + below[0] - twice;
                let [low, high] = bends(along, across, down, up);
                let seen = hidden * BETWEEN * larger(high, -low);
                let low = smaller(BETWEEN * low, lowest);
                let high = larger(BETWEEN * high, highest);
                *least = here[1] - low - limit;
                *most = here[1] - high + limit;
                // What vertices may have is from 0 to 1.
                let outer = larger(high - here[1], here[1] - 1.0 - low);
                *needed = larger(larger(outer, seen), 0.5 * (high - low));
            }
        }
    }

    /// How much the limit that it takes is over the limit: above 1 samples are too far apart.
    pub(super) fn worst(&self) -> f32 {
        let mut worst = [0.0; RUN];
        for needed in self.needed().as_chunks::<RUN>().0 {
            for (worst, needed) in worst.iter_mut().zip(needed) {
                *worst = larger(*worst, *needed);
            }
        }
        worst.into_iter().fold(0.0, larger) / self.limit
    }

    /// What limit it takes at each sample, as long as vertices are not balanced.
    pub(super) fn needed(&self) -> &[f32] {
        &self.balanced
    }

    /// Narrows the tube about a place (in samples) to what is left if density may be off by so much between them.
    pub(super) fn narrow(&mut self, place: DVec2, reach: f64, by: f32) {
        let [columns, rows] = self.size;
        let range = |at: f64, count: usize| {
            let first = (at - reach).floor().max(0.0) as usize;
            first..((at + reach).ceil().max(-1.0) + 1.0).min(count as f64) as usize
        };
        for y in range(place.y, rows) {
            for x in range(place.x, columns) {
                let at = y * columns + x;
                self.least[at] = self.least[at].max(self.densities[at] + by - self.limit);
                self.most[at] = self.most[at].min(self.densities[at] - by + self.limit);
                let needed = self.limit - 0.5 * (self.most[at] - self.least[at]);
                self.balanced[at] = self.balanced[at].max(needed);
            }
        }
    }

    /// Narrows the tube at two samples by the density in the middle between them, about which it may be so far off down and up.
    #[inline(always)]
    pub(super) fn narrow_chord(&mut self, ends: [usize; 2], middle: f32, [low, high]: [f32; 2]) {
        let chord = 0.5 * (self.densities[ends[0]] + self.densities[ends[1]]);
        for end in ends {
            let density = self.densities[end] - (chord - middle);
            self.least[end] = self.least[end].max(density - low - self.limit);
            self.most[end] = self.most[end].min(density - high + self.limit);
        }
    }

    /// Moves a vertex into the tube once that is narrowed; to the density itself where there is none in it: all triangles about it are
    /// smaller then than the tube is for.
    #[inline(always)]
    pub(super) fn settle(&mut self, sample: usize) {
        let (least, most) = (self.least[sample], self.most[sample]);
        let within = self.balanced[sample].max(least).min(most);
        self.balanced[sample] = if least <= most && (0.0..=1.0).contains(&within) {
            within
        } else {
            self.densities[sample]
        };
    }

    /// Moves vertices to the side to which density bends, by as much as the triangles' middles would be off to the other.
    #[inline(always)]
    pub(super) fn balance(&mut self) {
        let [columns, rows] = self.size;
        self.balanced.clear();
        self.balanced.extend_from_slice(&self.densities);
        self.balanced.resize(columns * rows + BEHIND, 0.0);
        let by = self.limit * BALANCED;
        for row in BEND..rows - BEND {
            let start = row * columns;
            let [above, below] = [start - BEND * columns, start + BEND * columns]
                .map(|start| &self.densities[start + BEND..start + columns - BEND]);
            let here = self.densities[start..start + columns].windows(2 * BEND + 1);
            let inner = start + BEND..start + columns - BEND;
            let bounds = self.least[inner.clone()]
                .iter()
                .zip(&self.most[inner.clone()]);
            let around = above.iter().zip(below).zip(here);
            let balanced = self.balanced[inner].iter_mut();
            for ((balanced, ((above, below), here)), (least, most)) in
                balanced.zip(around).zip(bounds)
            {
                let around = here[0] + here[2 * BEND] + above + below;
                let bend = (around - 4.0 * here[BEND]) / 8.0;
                let density = here[BEND] - smaller(larger(bend, -by), by);
                let density = smaller(larger(density, 0.0), 1.0);
                *balanced = smaller(larger(density, *least), *most);
            }
        }
    }

    /// How far a density is outside of the tube at a sample; less than 0 where it is within.
    #[inline(always)]
    pub(super) fn excess_at(&self, density: f32, [x, y]: [usize; 2]) -> f32 {
        let sample = y * self.size[0] + x;
        (density - self.most[sample]).max(self.least[sample] - density)
    }

    /// The densities of vertices at sixteen samples in a row.
    #[inline(always)]
    pub(super) fn at_many<S: Simd>(&self, simd: S, sample: usize) -> f32x16<S> {
        f32x16::from_slice(simd, &self.balanced[sample..sample + LANES])
    }

    /// How far densities are outside of the tube at sixteen samples in a row.
    #[inline(always)]
    pub(super) fn excess_at_many<S: Simd>(
        &self,
        simd: S,
        density: f32x16<S>,
        sample: usize,
    ) -> f32x16<S> {
        let most = f32x16::from_slice(simd, &self.most[sample..sample + LANES]);
        let least = f32x16::from_slice(simd, &self.least[sample..sample + LANES]);
        (density - most).max(least - density)
    }

    /// Whether the shadow reaches a triangle, as far as samples and the way to their neighbours tell.
    pub(super) fn is_reached(&self, triangle: &Right) -> bool {
        let light = Plane {
            corner: 0.0,
            growth: [0.0; 2],
        };
        self.excess(light, triangle) > -self.limit
    }

    /// A row of samples.
    #[inline(always)]
    pub(super) fn row(&self, y: usize) -> Row<'_> {
        let start = y * self.size[0];
        let row = start..start + self.size[0];
        Row {
            densities: &self.balanced[row.clone()],
            least: &self.least[row.clone()],
            most: &self.most[row],
        }
    }

    /// How far a plane is outside of the tube over a triangle at most; less than 0 where it is within.
    #[inline(always)]
    pub(super) fn excess(&self, plane: Plane, triangle: &Right) -> f32 {
        let Right { corner, ways, legs } = *triangle;
        let growth = plane.growth[0];
        let mut worst = [f32::NEG_INFINITY; RUN];
        for step in 0..=legs {
            let length = legs - step;
            let row = corner[1].wrapping_add_signed(ways[1] * step as isize);
            let back = if ways[0] < 0 { length } else { 0 };
            let start = row * self.size[0] + corner[0] - back;
            let first = plane.corner + plane.growth[1] * (ways[1] * step as isize) as f32
                - growth * back as f32;
            for done in (0..=length).step_by(RUN) {
                let at = start + done;
                let (least, most) = (&self.least[at..at + RUN], &self.most[at..at + RUN]);
                let (done, length) = (done as f32, length as f32);
                for lane in 0..RUN {
                    let along = done + NUMBERS[lane];
                    let density = first + growth * along;
                    let excess = larger(density - most[lane], least[lane] - density);
                    let within = if along <= length {
                        excess
                    } else {
                        f32::NEG_INFINITY
                    };
                    worst[lane] = larger(worst[lane], within);
                }
            }
        }
        worst.into_iter().fold(f32::NEG_INFINITY, larger)
    }
}

/// A density without the rounding that sums over many edges leave where there is nothing, or all.
#[inline(always)]
pub(super) fn clean(density: f32) -> f32 {
    let density = if density < NOISE { 0.0 } else { density };
    if density > 1.0 - NOISE { 1.0 } else { density }
}

/// How much density bends down and up about a sample, by second differences along a row, across rows and along both diagonals.
///
/// What is known of rows and columns adds up, as where two ends of penumbrae cross, and what is known of both diagonals, if one bends up
/// and the other down: rows and columns show nothing of that.
#[inline(always)]
pub(super) fn bends(along: f32, across: f32, down: f32, up: f32) -> [f32; 2] {
    let saddle = larger(smaller(larger(down, up), -smaller(down, up)), 0.0);
    let low = smaller(along, 0.0) + smaller(across, 0.0) - saddle;
    let high = larger(along, 0.0) + larger(across, 0.0) + saddle;
    [low, high]
}

/// The larger of two numbers: without a rule for what is none, which would take as long again.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers.
#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
