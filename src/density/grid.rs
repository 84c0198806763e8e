//! `grid`: rows of densities some pixels apart, from sums along strips, and cubics between (Catmull & Rom 1974).
//!
//! The outline is cut into strips and summed along each of them, so what the strip of a disc covers is a difference of two
//! sums: a pixel costs the same whatever the outline, and the strips of one row of discs serve the next. Along the rows
//! every pixel is computed. From row to row the density is smooth at the scale of the penumbra radius r, so the rows have a fixed
//! number a radius, and none of them less than a pixel.
//!
//! What limits the interpolation are the penumbra's two ends, where the density leaves 0 and 1 like the power 1.5 of the
//! distance, and points that see many edges at the distance r at once, like the centre of an arc of radius r. The rows show
//! where they are too far apart: there, each is foretold from its neighbours at twice the distance, and blocks of pixels
//! that are foretold badly are drawn by the closed form.
//!
//! Error: the tolerance.

mod chords;
mod disc;
mod strips;

use core::ops::Range;

use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16};

use glam::DVec2;

use self::chords::{GROUP, Height};
use self::disc::{Disc, reach};
use self::strips::{BLOCK, QUAD, QUADS, Strips};
use super::cubic;
use super::frame::Frame;
use super::rows::{self, Lattice, Points, Window};
use super::{PixelOptions, Sink, seen_columns};
use crate::grid::Grid;
use crate::outline::{self, Edge};
use crate::scratch::Scratch;

/// Rows of the lattice that are kept: the four that a pixel is interpolated from, and three more on both sides to foretell
/// them from.
const RING: i64 = 10;

/// How far any of the four rows that a pixel is interpolated from may be from what its neighbours at twice the distance
/// foretell, over the tolerance. The two nearest do not tell all: at a tip halfway between them the error is 1.5 times what
/// either is surprised by, and more where two tips meet. Of 30,000 cells about the tips of pills, 11 passed the tolerance by
/// up to 0.8 of it where only the two were asked; of all four none passed 0.9. In the notch of a heart 0.7 of the tolerance
/// was a surprise too few: one of 20,000 random shapes passed it by a twentieth.
const LIMIT: f64 = 0.65;

/// The same where the density is about 0 or 1. At the penumbra's ends it is 2.8 times the error between rows.
const END_LIMIT: f64 = 1.0;

/// Arcs whose radius is within this share of the disc's have a tip at their centre that is sharper than rows are apart: rows on both of
/// its sides say nothing of it. One of 20,000 random shapes passed its tolerance there, by a fiftieth.
const TIP: f64 = 0.07;

/// Up to where a density is about 0.
const END: f32 = 0.03;

/// So many blocks of pixels are computed at once at most.
const MOST: usize = 3;

/// The sums along a strip are exact up to here.
const EXACT: f64 = 16_777_216.0;

/// The steps that a strip's height is cut into, at most and at least.
const FULL: [f64; 2] = [256.0, 64.0];

/// What this method leaves from drawing to drawing: memory.
#[derive(Debug, Default)]
pub(crate) struct GridScratch {
    strips: Strips,
    disc: Disc,
    sums: Sums,
    /// The last rows of the lattice.
    ring: [Row; RING as usize],
    /// Columns of pixels that are drawn one by one between two rows.
    coarse: Vec<Range<i64>>,
    /// The row and the column of each point that sees an arc of the disc's own radius all at once.
    tips: Vec<[i64; 2]>,
    values: Vec<f32>,
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

/// A row of the lattice.
#[derive(Debug, Default)]
struct Row {
    densities: Vec<f32>,
    /// Runs of pixels from left to right without a gap, with their density where it is one.
    runs: Vec<(i64, Option<f32>)>,
    /// The pixels of each block that are not as their neighbours foretell, a bit each.
    surprises: Vec<u64>,
}

/// Pixels from one of the lattice's strips to the next.
fn strip_height(radius: f64, levels: f64) -> f64 {
    radius / cubic::steps(levels) / GROUP as f64
}

/// The steps that a strip's height is cut into so that sums along so many cells are exact, and those of a disc.
fn full(radius: f64, height: f64, cells: f64) -> f64 {
    let most = (2.0 * GROUP as f64 * cells).max(4.0 * radius * radius / height);
    libm::exp2(libm::log2(EXACT / most).floor()).min(FULL[0])
}

/// The cells of a shadow of so many columns of pixels, with what its discs reach beyond.
fn cells(columns: f64, radius: f64) -> f64 {
    columns + 4.0 * radius + 8.0 * BLOCK as f64
}

/// Whether the shadow of an outline `columns` pixels wide can be drawn by this method: its penumbra is wide enough, and all
/// sums stay exact.
pub(crate) fn suits(radius: f64, levels: f64, columns: f64) -> bool {
    radius >= narrowest(levels)
        && full(radius, strip_height(radius, levels), cells(columns, radius)) >= FULL[1]
}

/// The least penumbra radius, in pixels, for which cells of a pixel's width keep a tolerance. Where an upright edge halves a
/// cell at the disc's end, linear sums are wrong by a quarter of it along sqrt(8 r) pixels: 57 r^-1.5 levels.
pub(crate) fn narrowest(levels: f64) -> f64 {
    let share = 0.56 * levels;
    libm::cbrt((57.0 / share) * (57.0 / share))
}

/// Gives `sink` the density of every pixel of the grid that is in the shadow of an outline and not hidden; `radius` in pixels.
#[inline(always)]
pub(crate) fn fill<S: Simd>(
    simd: S,
    edges: &[Edge],
    radius: f64,
    grid: &Grid,
    options: &PixelOptions<'_>,
    scratch: &mut Scratch,
    sink: &mut dyn Sink,
) {
    let bounds = outline::bounds(edges.iter());
    let Some(frame) = bounds.map(|bounds| Frame::new(bounds, radius, grid)) else {
        return;
    };
    let [columns, lines] = frame.pixels();
    if columns.is_empty() || lines.is_empty() {
        return;
    }
    let placed = |unit: f64| {
        edges
            .iter()
            .map(move |edge| edge.mapped(frame.scale / unit, |p| frame.place(p) / unit))
    };
    let levels = options.tolerance.as_levels();
    let (pitch, height) = (radius / cubic::steps(levels), strip_height(radius, levels));
    let Scratch {
        rows: pixel_rows,
        grid: kept,
        wanted,
        ..
    } = scratch;
    let full = full(radius, height, cells(frame.extent.x - 2.0 * radius, radius));
    kept.disc.set(radius, height, full);
    let margin = (kept.disc.reach() + 2).div_ceil(BLOCK);
    // Whole blocks of the shadow, whatever part of it the grid shows.
    let first = columns.start - columns.start % BLOCK as i64;
    let blocks = ((columns.end - first) as usize).div_ceil(BLOCK) + 2 * margin;
    kept.strips
        .begin(first - (margin * BLOCK) as i64, blocks, full);
    let strip = |p: DVec2| DVec2::new(p.x - frame.phase.x, p.y / height);
    rows::each_line(placed(radius), |from, to| {
        kept.strips.push(strip(from * radius), strip(to * radius));
    });
    kept.strips.end();
    kept.sums.begin(blocks, &kept.disc);
    kept.tips.clear();
    kept.tips.extend(placed(1.0).filter_map(|edge| match edge {
        Edge::Arc(arc) if (arc.radius / radius - 1.0).abs() < TIP => {
            let place = [arc.center.y / pitch, arc.center.x - frame.phase.x];
            Some(place.map(|v| v.floor() as i64))
        }
        _ => None,
    }));
    let mut weaver = Weaver {
        columns: columns.clone(),
        first,
        margin,
        next: i64::MIN,
        next_group: i64::MIN,
        limits: [LIMIT, END_LIMIT].map(|limit| (limit * levels / 255.0) as f32),
        near: pitch.ceil() as i64,
        full: full as f32,
        kept,
    };
    let origin = frame.first[0];
    let pixels = Lattice {
        window: Window::Disc,
        start: (frame.phase.x + 0.5) / radius,
        pitch: 1.0 / radius,
        density: radius,
    };
    let mut loaded = false;
    let mut cell = None;
    for line in lines {
        let number = (line - frame.first[1]) as u32;
        seen_columns(options.hidden, number, &frame, &columns, wanted);
        if wanted.is_empty() {
            continue;
        }
        let place = (line as f64 + frame.phase.y + 0.5) / pitch;
        let knot = place.floor() as i64;
        weaver.weave_to(simd, knot - 4, knot + 5);
        if cell != Some(knot) {
            weaver.find_coarse(simd, knot, cell == Some(knot - 1));
            cell = Some(knot);
        }
        let woven = Woven {
            knot,
            weights: cubic::weights(place - knot as f64),
            number,
            origin,
        };
        for wanted in wanted.iter() {
            let mut at = wanted.start;
            for coarse in 0..weaver.kept.coarse.len() {
                let coarse = weaver.kept.coarse[coarse].clone();
                let coarse = coarse.start.max(at)..coarse.end.min(wanted.end);
                if !coarse.is_empty() {
                    weaver.give(simd, &woven, at..coarse.start, sink);
                    at = coarse.end;
                }
            }
            weaver.give(simd, &woven, at..wanted.end, sink);
        }
        if !weaver.kept.coarse.is_empty() {
            if !loaded {
                pixel_rows.load(placed(radius), Window::Disc);
                loaded = true;
            }
            let y = (line as f64 + frame.phase.y + 0.5) / radius;
            pixel_rows.go_to(y, columns.clone(), &pixels, &Points::CENTER);
            pixel_rows.clear();
            for coarse in &weaver.kept.coarse {
                for wanted in wanted.iter() {
                    let part = coarse.start.max(wanted.start)..coarse.end.min(wanted.end);
                    if !part.is_empty() {
                        pixel_rows.compute(simd, part, &pixels, &Points::CENTER);
                    }
                }
            }
            pixel_rows.give(number, columns.clone(), origin, sink);
        }
    }
}

/// A line of pixels: the row of the lattice above it, the weights of the four rows about it, its number on the grid and the
/// column at which the grid begins.
struct Woven {
    knot: i64,
    weights: [f32; 4],
    number: u32,
    origin: i64,
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
        for chord in disc.chords.all.iter().skip(1).step_by(2) {
            let farthest = reach(chord).0 / QUAD + 1;
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

/// Sorts ranges and joins those that touch.
fn join(ranges: &mut Vec<Range<i64>>) {
    ranges.sort_unstable_by_key(|range| range.start);
    ranges.dedup_by(|next, range| {
        let touches = next.start <= range.end;
        if touches {
            range.end = range.end.max(next.end);
        }
        touches
    });
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

/// Goes down the lattice row by row.
struct Weaver<'a> {
    kept: &'a mut GridScratch,
    columns: Range<i64>,
    /// The column of the first block of pixels.
    first: i64,
    /// Blocks of sums left and right of the pixels.
    margin: usize,
    /// The next row of the lattice, and the next group of strips.
    next: i64,
    next_group: i64,
    /// How far a density may be from what is foretold, and one of about 0 or 1.
    limits: [f32; 2],
    /// So many pixels beside those that are foretold badly are no better.
    near: i64,
    full: f32,
}

impl Weaver<'_> {
    /// Groups of strips from the middle of a disc to its end.
    fn groups(&self) -> i64 {
        (self.kept.disc.chords.half + GROUP - 1) / GROUP
    }

    /// Computes the lattice's rows from `first` to `last`.
    #[inline(always)]
    fn weave_to<S: Simd>(&mut self, simd: S, first: i64, last: i64) {
        // Rows that no pixel needs are passed over.
        self.next = self.next.max(first);
        while self.next <= last {
            self.weave(simd, self.next);
            self.next += 1;
        }
    }

    #[inline(always)]
    fn weave<S: Simd>(&mut self, simd: S, row: i64) {
        let reach = self.groups();
        let GridScratch {
            strips,
            disc,
            sums,
            ring,
            ..
        } = &mut *self.kept;
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
        let woven = &mut ring[row.rem_euclid(RING) as usize];
        woven.runs.clear();
        let blocks = sums.blocks - 2 * self.margin;
        woven.densities.resize(blocks * BLOCK, 0.0);
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
            let end = self.first + (block * BLOCK) as i64;
            let end = end.min(self.columns.end);
            match woven.runs.last_mut() {
                Some((last, density)) if *density == constant => *last = end,
                _ => woven.runs.push((end, constant)),
            }
        }
    }

    /// Finds the columns of the pixels below a row of the lattice for which its rows are too far apart. `went_on`: the last
    /// time it was the row above.
    #[inline(always)]
    fn find_coarse<S: Simd>(&mut self, simd: S, row: i64, went_on: bool) {
        let new = if went_on { row + 2 } else { row - 1 };
        for row in new..=row + 2 {
            self.surprise(simd, row);
        }
        let GridScratch {
            ring, coarse, tips, ..
        } = &mut *self.kept;
        let at = |offset: i64| &ring[(row + offset).rem_euclid(RING) as usize].surprises;
        coarse.clear();
        let near = self.near;
        let outer = at(-1).iter().zip(at(2));
        for (block, ((a, b), (c, d))) in at(0).iter().zip(at(1)).zip(outer).enumerate() {
            let bits = a | b | c | d;
            if bits == 0 {
                continue;
            }
            // Each block by itself: which others are drawn changes nothing.
            let first = self.first + (block * BLOCK) as i64;
            let start = first + (i64::from(bits.trailing_zeros()) - near).max(0);
            let end = i64::from(u64::BITS - bits.leading_zeros()) + near;
            let end = (first + end.min(BLOCK as i64)).min(self.columns.end);
            let start = start.max(self.columns.start);
            match coarse.last_mut() {
                Some(last) if last.end >= start => last.end = last.end.max(end),
                _ if start < end => coarse.push(start..end),
                _ => {}
            }
        }
        for &[tip, column] in &*tips {
            if (tip - row).abs() <= 1 {
                let start = (column - near).max(self.columns.start);
                let end = (column + near + 1).min(self.columns.end);
                if start < end {
                    coarse.push(start..end);
                }
            }
        }
        if !tips.is_empty() {
            join(coarse);
        }
    }

    /// Finds the pixels of a row that its neighbours at one and three rows foretell badly.
    #[inline(always)]
    fn surprise<S: Simd>(&mut self, simd: S, row: i64) {
        let ring = &mut self.kept.ring;
        let mut surprises = core::mem::take(&mut ring[row.rem_euclid(RING) as usize].surprises);
        surprises.clear();
        let near = |offset: i64| {
            let row = &ring[(row + offset).rem_euclid(RING) as usize];
            row.densities.as_chunks::<BLOCK>().0.iter()
        };
        let [limit, end_limit] = self.limits.map(|limit| f32x16::splat(simd, limit));
        let (half, middle) = (f32x16::splat(simd, 0.5), f32x16::splat(simd, 0.5 - END));
        let outer = near(-3).zip(near(3));
        for ((here, (a, b)), (c, d)) in near(0).zip(near(-1).zip(near(1))).zip(outer) {
            let here = f32x16::from_slice(simd, here);
            let (a, b) = (f32x16::from_slice(simd, a), f32x16::from_slice(simd, b));
            let (c, d) = (f32x16::from_slice(simd, c), f32x16::from_slice(simd, d));
            let surprise = here - ((a + b) * (9.0 / 16.0) - (c + d) * (1.0 / 16.0));
            let at_end = (here - half).abs().simd_gt(middle);
            let limit = at_end.select(end_limit, limit);
            surprises.push(surprise.abs().simd_gt(limit).to_bitmask());
        }
        ring[row.rem_euclid(RING) as usize].surprises = surprises;
    }

    /// Gives `sink` the pixels of a line below a row of the lattice, interpolated.
    #[inline(always)]
    fn give<S: Simd>(&mut self, simd: S, line: &Woven, columns: Range<i64>, sink: &mut dyn Sink) {
        let Woven {
            knot: row,
            weights,
            number,
            origin,
        } = *line;
        let GridScratch { ring, values, .. } = &mut *self.kept;
        let rows = [-1, 0, 1, 2].map(|offset| &ring[(row + offset).rem_euclid(RING) as usize]);
        let mut runs = [0; 4];
        let mut at = columns.start;
        while at < columns.end {
            let mut end = columns.end;
            let (mut constant, mut alike) = (Some(0.0), true);
            for index in 0..4 {
                while rows[index].runs[runs[index]].0 <= at {
                    runs[index] += 1;
                }
                let (run_end, density) = rows[index].runs[runs[index]];
                end = end.min(run_end);
                alike &= density == rows[0].runs[runs[0]].1;
                constant = constant
                    .zip(density)
                    .map(|(sum, density)| sum + density * weights[index]);
            }
            if alike {
                // Whatever the weights add up to.
                constant = rows[0].runs[runs[0]].1;
            }
            let first = (at - origin) as u32;
            match constant {
                Some(density) if density > 0.0 => {
                    sink.constant(number, first..(end - origin) as u32, density.min(1.0));
                }
                Some(_) => {}
                None => {
                    let count = (end - at) as usize;
                    // From the beginning of a block on, so that all stay within their rows.
                    let start = (at - self.first) as usize;
                    let before = start % BLOCK;
                    values.resize((before + count).next_multiple_of(BLOCK), 0.0);
                    let part = start - before..start - before + values.len();
                    let [a, b, c, d] = [
                        &rows[0].densities[part.clone()],
                        &rows[1].densities[part.clone()],
                        &rows[2].densities[part.clone()],
                        &rows[3].densities[part],
                    ];
                    cubic::between(simd, [a, b, c, d], weights, values);
                    let columns = first..first + count as u32;
                    sink.values(number, columns, &values[before..]);
                }
            }
            at = end;
        }
    }
}
