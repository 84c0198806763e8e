//! `nine_patch`: rounded rectangles by their sides.
//!
//! What a chord of the disc covers of a rounded rectangle is closed form in the x of the two sides at its height. Those are
//! found once for every strip of the rectangle, whatever the corners' radii; a pixel takes a few operations a chord. Columns
//! between the corners have one density a row, rows between them are all alike. Where the penumbra is wide, rows are computed
//! some pixels apart, with cubics between.
//!
//! Error: that of the chords and of the cubics, kept within the tolerance by their number.

mod columns;
mod sides;

use core::ops::Range;

use fearless_simd::{Simd, SimdBase, f32x16};

use self::columns::Columns;
use self::sides::{Corners, Node, Strips};
use super::chords::{Chords, GROUP, Height};
use super::frame::Frame;
use super::rounded::Rounded;
use super::rows::Window;
use super::{PixelOptions, Sink, cubic, seen_columns};
use crate::grid::Grid;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// Circles larger than this, over the penumbra radius, are told from each other by double precision only.
const LARGEST_CIRCLE: f64 = 1024.0;

/// Single precision tells a pixel's columns and rows apart from its neighbours' in rectangles up to this size, in pixels.
const LARGEST: f64 = 32_768.0;

/// The rounded rectangle or circle that a shadow is, if this method can draw it on so many pixels a scene unit.
pub(crate) fn suited(shadow: &Shadow, per_unit: f64) -> Option<Rounded> {
    let rounded = shadow.rounded()?;
    let size = (rounded.max - rounded.min).max_element() + 2.0 * shadow.radius();
    let drawn = match rounded.circle() {
        Some(radius) => radius <= LARGEST_CIRCLE * shadow.radius(),
        None => size * per_unit <= LARGEST,
    };
    (drawn && shadow.radius() * per_unit >= 3.0).then_some(rounded)
}

/// What this method leaves from drawing to drawing: memory.
#[derive(Debug, Default)]
pub(crate) struct NinePatchScratch {
    chords: Chords,
    disc: Disc,
    /// Single strips, and groups that begin with the first strip, the second and the third.
    strips: [Strips; 1 + GROUP as usize],
    zones: [Zone; 2],
    /// Columns of a row where they are some pixels apart.
    columns: [Vec<f32>; 2],
}

/// The disc's chords from above to below: single strips, groups of strips, and single ones again.
#[derive(Debug, Default)]
struct Disc {
    /// Strips from its middle to its end, and groups from its middle to where single ones follow.
    half: i64,
    groups: i64,
    /// Half of each chord's width, in pixels.
    upper: Vec<f32>,
    middle: Vec<f32>,
    lower: Vec<f32>,
    /// Its area, in strips and pixels.
    total: f32,
}

/// Columns on which a row's density changes.
#[derive(Debug, Default)]
struct Zone {
    start: i64,
    end: i64,
    /// Whether its discs may meet the left side, and the right one.
    met: [bool; 2],
    /// Where the sides are without corners, counted from the first column.
    sides: [f32; 2],
    /// The last rows that were computed, and which they are: [`NONE`] of the lattice's at first.
    rows: [Vec<f32>; RING],
    which: [i64; RING],
    /// The blocks of them that were computed.
    done: [Vec<bool>; RING],
    /// The pixels' densities where rows are apart.
    values: Vec<f32>,
}

/// Rows that are kept: the four that a pixel is interpolated from.
const RING: usize = 4;

/// The number of no row.
const NONE: i64 = i64::MIN;

/// Columns that are taken at once.
const BLOCK: usize = 16;

/// Where rows of densities are computed.
#[derive(Debug, Clone, Copy)]
struct Lattice {
    /// The y of row 0, and pixels from one to the next.
    start: f64,
    pitch: f64,
    /// Whether pixels are interpolated between them: otherwise there is one for each row of pixels.
    is_apart: bool,
    /// The columns that are computed of a row.
    columns: Columns,
    /// Strips from one to the next.
    strips: i64,
    /// Rows after `straight` up to so many more are like it: they are left out of the strips.
    straight: i64,
    alike: i64,
    /// The row of which row 0 is the likeness, if the rectangle's lower half is its upper one's.
    mirror: Option<i64>,
    /// The first strip.
    first: i64,
}

impl Lattice {
    /// For a penumbra radius in pixels and a tolerance in levels; `phase` is where in a pixel of the frame a pixel begins.
    fn new(shape: &Rounded, radius: f64, levels: f64, phase: f64) -> Self {
        let [tl, tr, br, bl] = shape.radii;
        let steps = steps(shape, radius, levels);
        let between = radius / steps;
        let is_mirrored = tl == bl && tr == br;
        let is_apart = between
            > if is_mirrored {
                NEAREST_MIRRORED
            } else {
                NEAREST
            };
        let (pitch, strips) = if is_apart {
            let strips = GROUP as f64 * cubic::steps(levels) / steps;
            (between, (strips - 0.2).ceil() as i64)
        } else {
            // A row for each row of pixels.
            let strips = (ALIGNED * cubic::steps(levels) / radius - 0.1).ceil();
            (1.0, strips.max(1.0) as i64)
        };
        let middle = shape.min.y.midpoint(shape.max.y);
        let half = ((middle - shape.min.y + radius) / pitch).ceil() + 1.0;
        let (start, mirror) = match (is_apart, is_mirrored) {
            (true, true) => (middle - half * pitch, Some(2 * half as i64)),
            (true, false) => (-phase - 0.5, None),
            (false, _) => (0.0, None),
        };
        let mut lattice = Self {
            start,
            pitch,
            is_apart,
            columns: Columns::apart(between / CLOSER),
            strips,
            mirror,
            straight: 0,
            alike: 0,
            first: 0,
        };
        let reach = radius + 2.0 * lattice.height();
        let first = lattice.row_at(shape.min.y + tl.max(tr) + reach).ceil() as i64;
        let last = lattice.row_at(shape.max.y - bl.max(br) - reach).floor() as i64;
        (lattice.straight, lattice.alike) = (first, (last - first).max(0));
        let top = (shape.min.y - lattice.start) / lattice.height();
        // Chords that begin above the rectangle may end within it.
        lattice.first = ((top / GROUP as f64).floor() as i64 - 1) * GROUP;
        lattice
    }

    /// The height of a strip, in pixels.
    fn height(&self) -> f64 {
        self.pitch / self.strips as f64
    }

    /// Where among the rows a y is.
    fn row_at(&self, y: f64) -> f64 {
        (y - self.start) / self.pitch
    }

    /// Takes the next row of pixels: those that need the same rows one after another.
    fn next(&self, lines: &mut Range<i64>) -> Option<i64> {
        let place = |line: i64| {
            let place = self.row_at(line as f64);
            self.mirror
                .map_or(place, |mirror| place.min(mirror as f64 - place))
        };
        if !lines.is_empty() && place(lines.end - 1) < place(lines.start) {
            lines.next_back()
        } else {
            lines.next()
        }
    }

    /// A row of which another is a copy, or itself, among those left.
    fn folded(&self, row: i64) -> i64 {
        let row = self.mirror.map_or(row, |mirror| row.min(mirror - row));
        if row <= self.straight {
            row
        } else {
            (row - self.alike).max(self.straight)
        }
    }
}

/// Strips where each row of pixels is computed, over the rows that cubics between them would need: without cubics fewer
/// are enough.
const ALIGNED: f64 = 2.0;

/// Columns are so many times as close to each other as rows.
const CLOSER: f64 = 1.15;

/// Rows nearer to each other than this, in pixels, are not worth interpolating between.
const NEAREST: f64 = 1.25;

/// The same where the rows of one half serve both.
const NEAREST_MIRRORED: f64 = 0.8;

/// The rows a penumbra radius for a tolerance. Two of the penumbra's ends may meet on the middle line; and where a disc
/// nearly fills its corner's circle, the density has a tip at that circle's centre that cubics between few rows do not
/// hold, the less the more such centres are in one place.
fn steps(shape: &Rounded, radius: f64, levels: f64) -> f64 {
    let steps = cubic::steps(levels);
    let near = |distance: f64| distance.abs() < 4.0 * radius / steps;
    let size = shape.max - shape.min;
    let ends = if near(size.y - 2.0 * radius) {
        2.0
    } else {
        1.0
    };
    let [tl, tr, br, bl] = shape.radii;
    let mut tip = 0.0;
    if shape
        .radii
        .iter()
        .any(|corner| (0.8..1.35).contains(&(corner / radius)))
    {
        let across = near(size.x - tl - tr) || near(size.x - bl - br);
        let down = near(size.y - tl - bl) || near(size.y - tr - br);
        tip = TIP / levels * [1.0, 2.0, 4.0][usize::from(across) + usize::from(down)];
    }
    cubic::steps(levels / ends).max(tip)
}

/// Where a side gains more x in a group of strips, in penumbra radii, it is looked up twice in each.
const STEEP: f64 = 0.17;

/// The error at a tip, in levels, times the rows a penumbra radius.
const TIP: f64 = 20.0;

/// Gives `sink` the density of every pixel of the grid that is in the shadow of a rounded rectangle and not hidden.
#[inline(always)]
pub(crate) fn fill<S: Simd>(
    simd: S,
    rounded: &Rounded,
    radius: f64,
    grid: &Grid,
    options: &PixelOptions<'_>,
    scratch: &mut Scratch,
    sink: &mut dyn Sink,
) {
    let frame = Frame::new((rounded.min, rounded.max), radius, grid);
    // Column and row numbers are the coordinates of their pixels' centres.
    let shape = Rounded {
        min: frame.place(rounded.min) - frame.phase - 0.5,
        max: frame.place(rounded.max) - frame.phase - 0.5,
        radii: rounded.radii.map(|r| r * frame.scale),
    };
    let [columns, mut lines] = frame.pixels();
    if columns.is_empty() {
        return;
    }
    let (kept, wanted) = (&mut scratch.nine_patch, &mut scratch.wanted);
    let lattice = Lattice::new(&shape, radius, options.tolerance.as_levels(), frame.phase.y);
    kept.begin(simd, &shape, radius, &lattice);
    let zones = kept.lay_out(&shape, radius, &lattice);
    let middle = if zones == 2 {
        kept.zones[0].end..kept.zones[1].start
    } else {
        0..0
    };
    let (origin, per_radius) = (frame.first[0], 1.0 / radius);
    while let Some(line) = lattice.next(&mut lines) {
        let y = line as f64;
        let [above, below] =
            [shape.min.y - y, shape.max.y - y].map(|end| Window::Disc.half(end * per_radius));
        let between = 2.0 * (below - above);
        if between <= 0.0 {
            continue;
        }
        let number = (line - frame.first[1]) as u32;
        seen_columns(options.hidden, number, &frame, &columns, wanted);
        let place = lattice.row_at(y);
        for wanted in wanted.iter() {
            let column = |x: i64| (x - origin) as u32;
            let (start, end) = (wanted.start.max(middle.start), wanted.end.min(middle.end));
            if start < end {
                sink.constant(number, column(start)..column(end), between);
            }
            for zone in 0..zones {
                let (first, last) = (kept.zones[zone].start, kept.zones[zone].end);
                let (start, end) = (wanted.start.max(first), wanted.end.min(last));
                if start < end {
                    let part = (start - first) as usize..(end - first) as usize;
                    let densities = kept.row(simd, zone, place, &lattice, part);
                    sink.values(number, column(start)..column(end), densities);
                }
            }
        }
    }
}

impl NinePatchScratch {
    /// Prepares chords and strips.
    #[inline(always)]
    fn begin<S: Simd>(&mut self, simd: S, shape: &Rounded, radius: f64, lattice: &Lattice) {
        let height = lattice.height();
        // In a strip a side is taken to be upright: a round one is not, in higher ones.
        self.chords.set(radius, height, Height::Group);
        self.disc.set(&self.chords);
        let [tl, tr, br, bl] = shape.radii;
        let from_first = |y: f64| (y - lattice.start - lattice.first as f64 * height) as f32;
        let bottom = shape.max.y - lattice.alike as f64 * lattice.pitch;
        let sides = [[tl, bl], [tr, br]].map(|radii| Corners {
            top: from_first(shape.min.y),
            bottom: from_first(bottom),
            radii: radii.map(|radius| radius as f32),
        });
        // Where a circle's side gains so many pixels a strip.
        let slope = STEEP * radius / (height * GROUP as f64);
        let steep = |corner: f64| {
            let depth = corner * (1.0 - slope / (1.0 + slope * slope).sqrt());
            (depth / height) as i64 + GROUP + 2
        };
        let end = ((bottom - shape.min.y) / height) as i64;
        let steep = [steep(tl.max(tr)), end - steep(bl.max(br))];
        let count = end as usize + 2 * GROUP as usize + 2;
        let [singles, groups @ ..] = &mut self.strips;
        singles.set(simd, count, [0, 1], height as f32, &sides);
        singles.set_steep(steep);
        // Where rows are groups apart, all of their groups begin alike.
        let starts = if lattice.strips % GROUP == 0 {
            1
        } else {
            GROUP as usize
        };
        for (first, groups) in groups.iter_mut().enumerate().take(starts) {
            let count = count / GROUP as usize + 1;
            groups.set(simd, count, [first, GROUP as usize], height as f32, &sides);
            groups.set_steep(steep.map(|strip| strip / GROUP));
        }
    }

    /// Prepares the zones, two or one where discs meet both sides; their number.
    fn lay_out(&mut self, shape: &Rounded, radius: f64, lattice: &Lattice) -> usize {
        let [tl, tr, br, bl] = shape.radii;
        let left_end = shape.min.x + radius + tl.max(bl);
        let right_start = shape.max.x - radius - tr.max(br);
        let (first, last) = (shape.min.x - radius, shape.max.x + radius);
        let apart = left_end + 2.0 < right_start;
        let ranges = if apart {
            [(first, left_end), (right_start, last)]
        } else {
            [(first, last); 2]
        };
        for (index, (zone, range)) in self.zones.iter_mut().zip(ranges).enumerate() {
            zone.start = range.0.ceil() as i64;
            zone.end = range.1.floor() as i64 + 1;
            zone.met = [!apart || index == 0, !apart || index == 1];
            zone.sides = [shape.min.x, shape.max.x].map(|x| (x - zone.start as f64) as f32);
            zone.which = [NONE; RING];
            let width = ((zone.end - zone.start) as usize).next_multiple_of(2 * BLOCK);
            for (row, done) in zone.rows.iter_mut().zip(&mut zone.done) {
                row.resize(width, 0.0);
                done.resize(width / BLOCK, false);
            }
            zone.values.resize(width, 0.0);
            lattice.columns.resize(&mut self.columns, width);
        }
        if apart { 2 } else { 1 }
    }

    /// The densities of some columns of a zone, counted from its first, and of what columns follow, at a place among the lattice's rows.
    #[inline(always)]
    fn row<S: Simd>(
        &mut self,
        simd: S,
        zone: usize,
        place: f64,
        lattice: &Lattice,
        part: Range<usize>,
    ) -> &[f32] {
        let knot = place.floor();
        let blocks = part.start / BLOCK..part.end.div_ceil(BLOCK);
        if !lattice.is_apart {
            let row = lattice.folded(knot as i64);
            let slot = self.compute(simd, zone, row, lattice, blocks);
            return &self.zones[zone].rows[slot][part.start..];
        }
        let first = knot as i64 - 1;
        let row = lattice.folded(first);
        if row == lattice.folded(first + 3) {
            let slot = self.compute(simd, zone, row, lattice, blocks);
            return &self.zones[zone].rows[slot][part.start..];
        }
        let mut slots = [0; 4];
        for (slot, row) in slots.iter_mut().zip(first..) {
            let row = lattice.folded(row);
            *slot = self.compute(simd, zone, row, lattice, blocks.clone());
        }
        let weights = cubic::weights(place - knot);
        let zone = &mut self.zones[zone];
        let [a, b, c, d] = slots.map(|slot| &zone.rows[slot]);
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        for block in blocks {
            let columns = block * BLOCK..(block + 1) * BLOCK;
            let a = f32x16::from_slice(simd, &a[columns.clone()]);
            let b = f32x16::from_slice(simd, &b[columns.clone()]);
            let c = f32x16::from_slice(simd, &c[columns.clone()]);
            let d = f32x16::from_slice(simd, &d[columns.clone()]);
            let sum = a * weights[0] + b * weights[1] + (c * weights[2] + d * weights[3]);
            sum.max(zero)
                .min(one)
                .store_slice(&mut zone.values[columns]);
        }
        &zone.values[part.start..]
    }

    /// Computes some blocks of a row of the lattice, as far as they are not there; where it is.
    #[inline(always)]
    fn compute<S: Simd>(
        &mut self,
        simd: S,
        zone: usize,
        row: i64,
        lattice: &Lattice,
        blocks: Range<usize>,
    ) -> usize {
        let zone = &mut self.zones[zone];
        let slot = row.rem_euclid(RING as i64) as usize;
        let done = &mut zone.done[slot];
        if zone.which[slot] != row {
            zone.which[slot] = row;
            done.fill(false);
        } else if done[blocks.clone()].iter().all(|done| *done) {
            return slot;
        }
        let reach = Reach {
            disc: &self.disc,
            strips: &self.strips,
            first: row * lattice.strips - lattice.first,
            met: zone.met,
            sides: zone.sides.map(|side| side - lattice.columns.start()),
            pitch: lattice.columns.pitch(),
        };
        let columns = lattice.columns;
        if !columns.are_pixels() {
            let width = (zone.end - zone.start) as usize;
            let count = columns.count(width).div_ceil(BLOCK);
            reach.compute_all(simd, 0..count, &mut self.columns[0]);
            columns.spread(simd, &mut self.columns, &mut zone.rows[slot]);
            done.fill(true);
            return slot;
        }
        let mut block = blocks.start;
        while block < blocks.end {
            let ahead = &done[block..blocks.end];
            if ahead[0] {
                block += 1;
                continue;
            }
            let missing = ahead.iter().take_while(|done| !**done).count();
            reach.compute_all(simd, block..block + missing, &mut zone.rows[slot]);
            done[block..block + missing].fill(true);
            block += missing;
        }
        slot
    }
}

impl Disc {
    fn set(&mut self, chords: &Chords) {
        self.half = chords.half;
        for list in [&mut self.upper, &mut self.middle, &mut self.lower] {
            list.clear();
        }
        let mut total = 0.0;
        // Of each chord's two likenesses the one below.
        for chord in chords.all.iter().skip(1).step_by(2) {
            total += 4.0 * chord.height.strips() as f64 * chord.half_width;
            let half_width = chord.half_width as f32;
            match chord.height {
                Height::Strip => self.lower.push(half_width),
                Height::Group | Height::Pair => self.middle.push(half_width),
            }
        }
        self.total = total as f32;
        self.groups = self.middle.len() as i64;
        self.upper.extend(self.lower.iter().rev());
        self.middle.extend_from_within(..);
        self.middle[..self.groups as usize].reverse();
    }
}

/// What the discs of one row reach.
struct Reach<'a> {
    disc: &'a Disc,
    strips: &'a [Strips; 1 + GROUP as usize],
    /// The strip below the row.
    first: i64,
    met: [bool; 2],
    /// Where the sides are, and pixels from one column to the next; all from the first column.
    sides: [f32; 2],
    pitch: f32,
}

impl Reach<'_> {
    /// Computes blocks of columns.
    #[inline(always)]
    fn compute_all<S: Simd>(&self, simd: S, blocks: Range<usize>, densities: &mut [f32]) {
        let mut block = blocks.start;
        while block < blocks.end {
            let at = block * BLOCK;
            let densities = &mut densities[at..];
            block += match blocks.end - block {
                1 => self.compute::<S, 1>(simd, at, densities),
                2 | 4 => self.compute::<S, 2>(simd, at, densities),
                _ => self.compute::<S, 3>(simd, at, densities),
            };
        }
    }

    /// Computes some blocks of densities from column `at` on; their number.
    #[inline(always)]
    fn compute<S: Simd, const BLOCKS: usize>(
        &self,
        simd: S,
        at: usize,
        densities: &mut [f32],
    ) -> usize {
        let zero = f32x16::splat(simd, 0.0);
        let lanes = f32x16::from_fn(
            simd,
            #[inline(always)]
            |lane| lane as f32,
        );
        let mut sums = [zero; BLOCKS];
        for side in 0..2 {
            if !self.met[side] {
                continue;
            }
            // How far inside the side each column is.
            let mut depths = [zero; BLOCKS];
            for (block, depth) in depths.iter_mut().enumerate() {
                let column = (lanes + (at + block * BLOCK) as f32) * self.pitch;
                *depth = if side == 0 {
                    column - self.sides[0]
                } else {
                    f32x16::splat(simd, self.sides[1]) - column
                };
            }
            self.add(simd, side, &depths, &mut sums);
        }
        // Both sides leave of a chord what the two leave together less all of it.
        let full = if self.met[0] && self.met[1] {
            self.full()
        } else {
            0.0
        };
        let scale = 1.0 / self.disc.total;
        let one = f32x16::splat(simd, 1.0);
        let blocks = densities.as_chunks_mut::<BLOCK>().0.iter_mut();
        for (sum, densities) in sums.into_iter().zip(blocks) {
            let density = (sum - full) * scale;
            density.max(zero).min(one).store_slice(densities);
        }
        BLOCKS
    }

    /// The disc's chords: half widths, strips, and which of these they are of.
    #[inline(always)]
    fn runs(&self) -> [(&[f32], &Strips, Range<i64>); 3] {
        let disc = self.disc;
        let [singles, grouped @ ..] = self.strips;
        let (first, inner) = (self.first, disc.groups * GROUP);
        let start = first - inner;
        let group = start.div_euclid(GROUP);
        let grouped = &grouped[start.rem_euclid(GROUP) as usize];
        [
            (&disc.upper, singles, first - disc.half..start),
            (&disc.middle, grouped, group..group + 2 * disc.groups),
            (&disc.lower, singles, first + inner..first + disc.half),
        ]
    }

    /// Adds what of the chords lies on the inner side of a side.
    #[inline(always)]
    fn add<S: Simd, const BLOCKS: usize>(
        &self,
        simd: S,
        side: usize,
        depths: &[f32x16<S>; BLOCKS],
        sums: &mut [f32x16<S>; BLOCKS],
    ) {
        let mut inside = [f32x16::splat(simd, 0.0); BLOCKS];
        // What all columns have too much, added up in the same order: beyond the side nothing is left, exactly.
        let mut outside = 0.0;
        for (widths, strips, of) in self.runs() {
            let mut start = of.start.max(0);
            for (end, nodes) in strips.parts() {
                let end = end.min(of.end);
                if start >= end {
                    continue;
                }
                let widths = &widths[(start - of.start) as usize..];
                let share = 1.0 / nodes.len() as f32;
                for node in nodes {
                    let (insets, covers) = strips.of(side, *node, start..end);
                    for ((half_width, inset), cover) in widths.iter().zip(insets).zip(covers) {
                        let cover = cover * share;
                        let (first, last) = (inset - half_width, inset + half_width);
                        outside += first * cover;
                        let first = f32x16::splat(simd, first);
                        let last = f32x16::splat(simd, last);
                        for block in 0..BLOCKS {
                            inside[block] += depths[block].max(first).min(last) * cover;
                        }
                    }
                }
                start = end;
            }
        }
        for block in 0..BLOCKS {
            sums[block] += inside[block] - outside;
        }
    }

    /// What the rectangle's height leaves of all chords.
    fn full(&self) -> f32 {
        let mut sum = 0.0;
        for (widths, strips, of) in self.runs() {
            let (start, end) = (of.start.max(0), of.end.min(strips.count()));
            if start >= end {
                continue;
            }
            let (_, covers) = strips.of(0, Node::Average, start..end);
            let widths = &widths[(start - of.start) as usize..];
            for (half_width, cover) in widths.iter().zip(covers) {
                sum += (half_width + half_width) * cover;
            }
        }
        sum
    }
}
