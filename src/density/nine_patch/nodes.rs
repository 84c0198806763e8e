//! What the discs of one row cover of a rounded rectangle, as a sum over heights of the disc.
//!
//! At the height sin t the disc is cos t wide. So what a rectangle covers of it is an integral over t from where the rectangle
//! begins within the disc to where it ends, of a function that is smooth at the disc's ends, and it is summed by midpoints.
//! A corner begins like a square root: towards such ends the midpoints are moved closer, so that the sum is
//! wrong by the square of their distance there as well. What a level edge covers of the whole disc is closed form, and the
//! sum is scaled to it.

use core::f32::consts::TAU;

use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16};

use super::kernel::Kernel;
use crate::density::lanes::LANES;
use crate::density::rounded::Rounded;
use crate::density::rows::half_discs;

/// Heights of a disc for a tolerance of one level: with 16 the sum is wrong by at most 0.4 of it for corners up to
/// twice the disc's size. Measured on corners of 0 to 200 radii, no bound.
const COUNT: f64 = 16.0;

/// The least number of heights.
const FEWEST: f64 = 6.0;

/// Corners larger than this, over the disc, need more: a larger one is more nearly level where the disc ends.
const LARGE: f64 = 1.7;

/// The power of a corner's size that the number grows with.
const GROWTH: f64 = 0.27;

/// How much closer midpoints are where the rectangle ends within the disc, at its middle.
const CLOSER: f32 = 0.6;

/// The heights at which a row's discs are looked at.
#[derive(Debug, Default)]
pub(super) struct Nodes {
    pub(super) kernel: Kernel,
    /// Midpoints from 0 to 1, and the distance between them, or 0 for those that fill the last lanes.
    midpoints: Vec<f32>,
    shares: Vec<f32>,
    pub(super) row: Row,
}

/// Heights of one row's discs.
#[derive(Debug, Default)]
pub(super) struct Row {
    /// How far below a band's middle the chords are and their widths, in pixels, and what each pixel of them weighs, up to the band's scale.
    heights: Vec<f32>,
    widths: Vec<f32>,
    weights: Vec<f32>,
    bands: Vec<Band>,
    /// How far inside the left side, and the right one, a disc's centre is when its chord begins to be inside: negative, in pixels.
    offsets: [Vec<f32>; 2],
    /// Where each side's offsets are: where both sides are alike, the first one's serve both.
    places: [usize; 2],
    /// What the rectangle's height leaves of the discs, 0 to 1.
    pub(super) between: f32,
    /// How many chords a band has, and how many places.
    count: usize,
    places_of_band: usize,
    y: Option<f64>,
}

/// What the chords of a band weigh.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Band {
    /// The factor on their weights.
    pub(super) scale: f32,
    /// What the rectangle's height leaves of its discs, 0 to 1, if the chords are those of whole ones.
    whole: Option<f32>,
}

impl Row {
    pub(super) fn bands(&self) -> &[Band] {
        &self.bands
    }

    /// What a band's discs see of a side: the width of each chord, its offset and the weight of what is inside, up to the band's scale.
    #[inline(always)]
    pub(super) fn chords(&self, band: usize, side: usize) -> impl Iterator<Item = (f32, f32, f32)> {
        let start = band * self.places_of_band;
        let places = start..start + self.count;
        let offsets = &self.offsets[self.places[side]][places.clone()];
        let lists = self.widths[places.clone()].iter().zip(offsets);
        let lists = lists.zip(&self.weights[places]);
        lists.map(|((width, offset), weight)| (*width, *offset, *weight))
    }
}

impl Nodes {
    /// For a penumbra of `radius` pixels.
    pub(super) fn begin(&mut self, shape: &Rounded, radius: f64, levels: f64) {
        self.kernel.set(radius, levels);
        let largest = shape.radii.into_iter().fold(0.0, f64::max) / self.kernel.reach();
        let more = libm::pow((largest / LARGE).max(1.0), GROWTH);
        let count = (COUNT * more / levels.sqrt()).ceil().max(FEWEST);
        let share = 1.0 / count;
        let count = count as usize;
        let filled = count.next_multiple_of(LANES);
        self.midpoints.clear();
        self.midpoints
            .extend((0..filled).map(|node| ((node as f64 + 0.5) * share).min(1.0) as f32));
        self.shares.clear();
        self.shares.resize(count, share as f32);
        self.shares.resize(filled, 0.0);
        let (row, bands) = (&mut self.row, self.kernel.count());
        let [left, right] = &mut row.offsets;
        let Row {
            heights,
            widths,
            weights,
            ..
        } = row;
        for list in [heights, widths, weights, left, right] {
            list.resize(bands * filled, 0.0);
        }
        row.bands.clear();
        row.bands.resize(bands, Band::default());
        let [tl, tr, br, bl] = shape.radii;
        (row.count, row.places_of_band, row.y) = (count, filled, None);
        row.places = if tl == tr && bl == br { [0, 0] } else { [0, 1] };
    }

    /// Prepares the row of discs at a y.
    // One copy a SIMD level: where it was inlined, compilers took minutes.
    #[inline(never)]
    pub(super) fn place<S: Simd>(&mut self, simd: S, shape: &Rounded, y: f64) {
        if self.row.y == Some(y) {
            return;
        }
        (self.row.y, self.row.between) = (Some(y), 0.0);
        simd.vectorize(
            #[inline(always)]
            || {
                for band in 0..self.kernel.count() {
                    let y = y + self.kernel.middle(band);
                    self.row.between += self.place_chords(simd, shape, y, band);
                    self.place_offsets(simd, shape, y, band);
                }
            },
        );
    }

    /// Places the chords of a band of the row's discs; what the rectangle's height leaves of these.
    #[inline(always)]
    fn place_chords<S: Simd>(&mut self, simd: S, shape: &Rounded, y: f64, band: usize) -> f32 {
        let Self {
            kernel,
            midpoints,
            shares,
            row,
        } = self;
        let reach = kernel.reach();
        let ends = [shape.min.y - y, shape.max.y - y];
        let is_whole = ends[0] <= -reach && ends[1] >= reach;
        if let Some(between) = row.bands[band].whole.filter(|_| is_whole) {
            return between;
        }
        let Ends {
            angles: [start, end],
            cosines,
            between,
        } = Ends::new(simd, kernel, ends);
        let between = between / kernel.count() as f32;
        let splat = |v: f32| f32x16::splat(simd, v);
        let (zero, one) = (splat(0.0), splat(1.0));
        let length = end - start;
        let closer = [cosines[0] * CLOSER, cosines[1] * CLOSER];
        let reach = reach as f32;
        let is_averaged = kernel.is_averaged();
        let mut total = zero;
        let first = band * midpoints.len();
        let lists = midpoints.as_chunks::<LANES>().0.iter();
        let lists = lists.zip(shares.as_chunks::<LANES>().0);
        for (block, (midpoints, shares)) in lists.enumerate() {
            let place = first + block * LANES..first + (block + 1) * LANES;
            let u = f32x16::from_slice(simd, midpoints);
            let v = one - u;
            let near = [v * closer[0], u * closer[1]];
            let angle = (u - near[0] * (u * v) + near[1] * (u * v)) * length + start;
            let gain = one - near[0] * (v - u * 2.0) + near[1] * (v * 2.0 - u);
            let sine = sine(angle);
            let cosine = (one - sine * sine).max(zero).sqrt();
            let share = gain * cosine * f32x16::from_slice(simd, shares);
            let (mut width, mut weight) = (cosine * (2.0 * reach), share);
            if is_averaged {
                let [chords, met] = kernel.chords(simd, sine);
                (width, weight) = (chords, share * met);
            }
            total += weight * width;
            (sine * reach).store_slice(&mut row.heights[place.clone()]);
            weight.store_slice(&mut row.weights[place.clone()]);
            width.store_slice(&mut row.widths[place]);
        }
        row.bands[band] = Band {
            scale: if between > 0.0 {
                between / sum(total)
            } else {
                0.0
            },
            whole: is_whole.then_some(between),
        };
        between
    }

    /// Places the sides at the heights of a band's chords.
    #[inline(always)]
    fn place_offsets<S: Simd>(&mut self, simd: S, shape: &Rounded, y: f64, band: usize) {
        let (kernel, row) = (&self.kernel, &mut self.row);
        let splat = |v: f32| f32x16::splat(simd, v);
        let [tl, tr, br, bl] = shape.radii;
        // A corner's radius, and how far beyond the middle of its arc the discs' are.
        let upper = |corner: f64| (corner as f32, (shape.min.y + corner - y) as f32);
        let lower = |corner: f64| (corner as f32, (y + corner - shape.max.y) as f32);
        let corners = [[upper(tl), lower(bl)], [upper(tr), lower(br)]];
        let (reach, half_side) = (kernel.reach() as f32, 0.5 * kernel.side as f32);
        let count = self.midpoints.len();
        let places = band * count..(band + 1) * count;
        let sides = row.offsets.iter_mut().zip(corners);
        for (offsets, corners) in sides.take(1 + row.places[1]) {
            let lists = row.heights[places.clone()].as_chunks::<LANES>().0.iter();
            let lists = lists.zip(row.widths[places.clone()].as_chunks::<LANES>().0);
            let offsets = offsets[places.clone()].as_chunks_mut::<LANES>().0;
            for (offsets, (heights, widths)) in offsets.iter_mut().zip(lists) {
                let below = f32x16::from_slice(simd, heights);
                let mut offset = f32x16::from_slice(simd, widths) * 0.5 + half_side;
                for ((corner, rise), sign) in corners.into_iter().zip([-1.0, 1.0]) {
                    if rise + reach <= 0.0 || corner == 0.0 {
                        continue;
                    }
                    let rise = (below * sign + rise).max(splat(0.0)).min(splat(corner));
                    let level = ((splat(corner) - rise) * (rise + corner)).sqrt();
                    offset += level - corner;
                }
                offset.store_slice(offsets);
            }
        }
    }
}

/// Where a band's discs begin and end within a rectangle.
struct Ends {
    angles: [f32; 2],
    cosines: [f32; 2],
    /// How much of the band lies between them.
    between: f32,
}

impl Ends {
    /// For what begins and ends that far below the band's middle, in pixels.
    #[inline(always)]
    fn new<S: Simd>(simd: S, kernel: &Kernel, ends: [f64; 2]) -> Self {
        let sines = ends.map(|end| (end / kernel.reach()).clamp(-1.0, 1.0) as f32);
        let lanes = f32x16::splat(simd, sines[0]).zip_low(f32x16::splat(simd, sines[1]));
        let cosines = (f32x16::splat(simd, 1.0) - lanes * lanes).sqrt();
        // The disc's half is (sin t cos t + t) / 2π.
        let halves = half_discs(simd, lanes);
        let angles = halves * TAU - lanes * cosines;
        let [start, end] = pair(halves);
        Self {
            angles: pair(angles),
            cosines: pair(cosines),
            between: kernel.above(sines[1], end) - kernel.above(sines[0], start),
        }
    }
}

/// The first two lanes.
#[inline(always)]
fn pair<S: Simd>(lanes: f32x16<S>) -> [f32; 2] {
    let lanes = lanes.as_slice();
    [lanes[0], lanes[1]]
}

/// The sum of all lanes, in pairs.
#[inline(always)]
fn sum<S: Simd>(lanes: f32x16<S>) -> f32 {
    let mut sums = [0.0; LANES];
    lanes.store_slice(&mut sums);
    let mut half = LANES / 2;
    while half > 0 {
        let (sums, others) = sums.split_at_mut(half);
        for (sum, other) in sums.iter_mut().zip(others) {
            *sum += *other;
        }
        half /= 2;
    }
    sums[0]
}

/// The sine of an angle t up to a quarter turn is t p(t²): a minimax fit of p, within 4e-9.
const SINE: [f32; 5] = [
    1.0,
    -0.166_666_48,
    0.008_332_9,
    -0.000_198_008_97,
    0.000_002_590_488,
];

/// The sine of an angle up to a quarter turn.
#[inline(always)]
fn sine<S: Simd>(angle: f32x16<S>) -> f32x16<S> {
    let [a, b, c, d, e] = SINE;
    // In pairs, which wait less for each other: a row has a vector or two of angles.
    let square = angle * angle;
    let fourth = square * square;
    let inner = square * d + c + fourth * e;
    (square * b + a + fourth * inner) * angle
}

#[cfg(test)]
mod tests {
    use core::f64::consts::FRAC_PI_2;

    use fearless_simd::{Level, dispatch};
    use glam::DVec2;

    use super::*;

    #[test]
    fn sines_are_those_of_a_quarter_turn() {
        for step in -50..=50 {
            let angle = f64::from(step) / 50.0 * FRAC_PI_2;
            let found = dispatch!(Level::new(), simd => {
                sine(f32x16::splat(simd, angle as f32)).as_slice()[0]
            });
            assert!((f64::from(found) - angle.sin()).abs() < 3e-7, "{angle}");
        }
    }

    #[test]
    fn the_chords_of_a_row_weigh_what_lies_between_the_level_sides() {
        let shape = Rounded {
            min: DVec2::new(0.0, 0.0),
            max: DVec2::new(60.0, 40.0),
            radii: [8.0, 0.0, 20.0, 3.0],
        };
        let mut nodes = Nodes::default();
        for radius in [0.02, 0.3, 0.8, 3.0, 11.0, 45.0] {
            for levels in [0.5, 1.0, 4.0] {
                nodes.begin(&shape, radius, levels);
                for step in -30..=60 {
                    let y = f64::from(step) * 0.71;
                    dispatch!(Level::new(), simd => nodes.place(simd, &shape, y));
                    let mut all = 0.0;
                    for (band, Band { scale, .. }) in nodes.row.bands().iter().enumerate() {
                        let chords = nodes.row.chords(band, 1);
                        all += scale * chords.map(|(w, _, weight)| w * weight).sum::<f32>();
                    }
                    let between = nodes.kernel.between([shape.min.y - y, shape.max.y - y]);
                    let label = format!("r {radius}, {levels} levels, y {y}");
                    assert!((all - nodes.row.between).abs() < 2e-6, "{label}: {all}");
                    assert!((all - between).abs() < 2e-4, "{label}: {all}, {between}");
                }
            }
        }
    }
}
