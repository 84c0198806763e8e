//! `nine_patch`: rounded rectangles by their sides.
//!
//! What a chord of the disc covers of a rounded rectangle is closed form in the x of the two sides at its height. Those are
//! found once for a row, at a few heights of the disc, whatever the corners' radii; a pixel takes a few operations for each.
//! Columns between the corners have one density a row, rows between them are all alike. Rows and columns are computed some
//! pixels apart where the penumbra is wide, with cubics between, and one half of the rows serves the other, as the left half of the
//! columns does the right one.
//!
//! Error: that of the heights and of the cubics, kept within the tolerance by their number.

mod columns;
mod kernel;
mod lattice;
mod mirror;
mod nodes;
mod reach;

use core::ops::Range;

use fearless_simd::Simd;

use self::kernel::LIKE_SQUARE;
use self::lattice::{Cell, Lattice};
use self::mirror::{BEFORE, BEHIND, Mirror};
use self::nodes::Nodes;
use self::reach::{BLOCK, Reach};
use super::frame::Frame;
use super::rounded::Rounded;
use super::runs::Run;
use super::{PixelOptions, Sink, averaged_side, cubic, reach, seen_columns};
use crate::grid::Grid;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// Circles larger than this, over the penumbra radius, are told from each other by double precision only.
const LARGEST_CIRCLE: f64 = 1024.0;

/// Single precision tells a pixel's columns and rows apart from its neighbours' in rectangles up to this size, in pixels.
const LARGEST: f64 = 32_768.0;

/// The least penumbra radius, in pixels, that is not an edge to this method.
const NARROWEST: f64 = 0.01;

/// Where pixels are averages, chords that stand for others show in rectangles thinner than this, in pixels.
const THINNEST: f64 = 3.0;

/// Where pixels are averages, rectangles as thin as the disc is wide, to so many pixels, may end in tips of the density that few heights
/// do not hold.
const TIP: f64 = 0.8;

/// Whether averages over pixels cost less by this method, for a penumbra radius and the largest corner's, in pixels. By closed form few
/// points of each pixel are enough from r = 0.9 px on, or one where a border is as good as straight: only small corners take them many,
/// and two bands of heights cost as much as the 3 x 3 points from r = 1.4 px on.
fn averages_pay(radius: f64, corner: f64) -> bool {
    if radius < LIKE_SQUARE.start {
        return radius >= NARROWEST;
    }
    (0.5..10.0).contains(&corner) && !(1.4..LIKE_SQUARE.end).contains(&radius)
}

/// The rounded rectangle or circle that a shadow is, if this method can draw it on so many pixels a scene unit.
pub(crate) fn suited(shadow: &Shadow, per_unit: f64) -> Option<Rounded> {
    let rounded = shadow.rounded()?;
    let size = (rounded.max - rounded.min).max_element() + 2.0 * shadow.radius();
    let radius = shadow.radius() * per_unit;
    let is_sampled = averaged_side(radius) == 0.0;
    let drawn = match rounded.circle() {
        Some(circle) if is_sampled => circle <= LARGEST_CIRCLE * shadow.radius(),
        _ => size * per_unit <= LARGEST,
    };
    let thinnest = (rounded.max - rounded.min).min_element() * per_unit;
    let corner = rounded.radii.into_iter().fold(0.0, f64::max) * per_unit;
    let is_tip = radius >= LIKE_SQUARE.start && (thinnest - 2.0 * radius).abs() < TIP;
    let averaged = averages_pay(radius, corner) && thinnest >= THINNEST && !is_tip;
    (drawn && (is_sampled || averaged)).then_some(rounded)
}

/// What this method leaves from drawing to drawing: memory.
#[derive(Debug, Default)]
pub(crate) struct NinePatchScratch {
    nodes: Nodes,
    zones: [Zone; 2],
    /// How the second zone is the first one's likeness, if it is.
    mirror: Option<Mirror>,
    /// Columns of a row where they are some pixels apart.
    columns: [Vec<f32>; 2],
}

/// Columns on which a row's density changes.
#[derive(Debug, Default)]
struct Zone {
    start: i64,
    end: i64,
    /// How many of them are kept: some more, that others are the likeness of.
    width: usize,
    /// Whether its discs may meet the left side, and the right one.
    met: [bool; 2],
    /// Where the sides are without corners, counted from the first column.
    sides: [f32; 2],
    /// The last rows that were computed, and which they are: [`NONE`] of the lattice's at first.
    rows: [Vec<f32>; RING],
    which: [i64; RING],
    /// The blocks of them that were computed; of a likeness, the columns.
    done: [Range<usize>; RING],
    /// The cell that pixels were last asked for in, and the columns for which all of its rows are there.
    cell: [i64; 4],
    ready: Range<usize>,
}

/// Rows that are kept: among them the four that a pixel is interpolated from, of which every second may be left out.
const RING: usize = 8;

/// The number of no row.
const NONE: i64 = i64::MIN;

/// Where a row is kept.
fn slot(row: i64) -> usize {
    row.rem_euclid(RING as i64) as usize
}

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
    let frame = Frame::new((rounded.min, rounded.max), reach(radius), grid);
    // Column and row numbers are the coordinates of their pixels' centres.
    let shape = Rounded {
        min: frame.place(rounded.min) - frame.phase - 0.5,
        max: frame.place(rounded.max) - frame.phase - 0.5,
        radii: rounded.radii.map(|r| r * frame.scale),
    };
    let [columns, lines] = frame.pixels();
    if columns.is_empty() {
        return;
    }
    let (kept, wanted, runs) = (
        &mut scratch.nine_patch,
        &mut scratch.wanted,
        &mut scratch.runs,
    );
    runs.begin((columns.end - columns.start) as usize);
    let levels = options.tolerance.as_levels();
    let lattice = Lattice::new(&shape, radius, levels, frame.phase.y);
    kept.nodes.begin(&shape, radius, levels);
    let zones = kept.lay_out(&lattice);
    let middle = if zones == 2 {
        kept.zones[0].end..kept.zones[1].start
    } else {
        0..0
    };
    let origin = frame.first[0];
    let column = |x: i64| (x - origin) as u32;
    for (lines, place) in lattice.lines(lines) {
        let cell = lattice.cell(place);
        let [mut next, end] = [lines.start, lines.end].map(|line| (line - frame.first[1]) as u32);
        while next < end {
            let alike = options
                .hidden
                .map_or(end - next, |hidden| hidden.alike(next..end));
            let rows = next..next + alike;
            next = rows.end;
            seen_columns(options.hidden, rows.start, &frame, &columns, wanted);
            for wanted in wanted.iter() {
                let (start, end) = (wanted.start.max(middle.start), wanted.end.min(middle.end));
                if start < end {
                    let y = lines.start as f64;
                    let ends = [shape.min.y - y, shape.max.y - y];
                    let between = kept.nodes.kernel.between(ends);
                    if between > 0.0 {
                        sink.constant(rows.clone(), column(start)..column(end), between);
                    }
                }
                for zone in 0..zones {
                    let (first, last) = (kept.zones[zone].start, kept.zones[zone].end);
                    let (start, end) = (wanted.start.max(first), wanted.end.min(last));
                    if start < end {
                        let part = (start - first) as usize..(end - first) as usize;
                        let columns = column(start)..column(end);
                        kept.compute(simd, zone, &cell, &lattice, &part);
                        let row =
                            |row: i64| &kept.zones[zone].rows[slot(row)][BEFORE + part.start..];
                        if let [only] = cell.distinct() {
                            sink.values(rows.clone(), columns, row(*only));
                            continue;
                        }
                        for number in rows.clone() {
                            let run = Run {
                                row: number,
                                columns: columns.clone(),
                            };
                            let to = runs.push(run);
                            cubic::between(simd, cell.rows.map(row), cell.weights, to);
                        }
                    }
                }
            }
        }
        if runs.are_many() {
            runs.give(sink);
        }
    }
    runs.give(sink);
}

impl NinePatchScratch {
    /// Prepares the zones, two or one where discs meet both sides; their number.
    fn lay_out(&mut self, lattice: &Lattice) -> usize {
        let (shape, reach) = (&lattice.shape, lattice.reach);
        let [tl, tr, br, bl] = shape.radii;
        let left_end = shape.min.x + reach + tl.max(bl);
        let right_start = shape.max.x - reach - tr.max(br);
        let (first, last) = (shape.min.x - reach, shape.max.x + reach);
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
            (zone.which, zone.cell) = ([NONE; RING], [NONE; 4]);
            zone.width = (zone.end - zone.start) as usize + BEHIND;
            // From any column on whole vectors are read.
            let length = zone.width.next_multiple_of(2 * BLOCK) + BLOCK;
            for row in &mut zone.rows {
                row.resize(BEFORE + length, 0.0);
            }
        }
        let first = [0, 1].map(|zone: usize| self.zones[zone].start);
        self.mirror = Mirror::new(lattice, first).filter(|_| apart);
        let widest = self.zones.iter().map(|zone| zone.rows[0].len()).max();
        lattice
            .columns
            .resize(&mut self.columns, widest.unwrap_or(0));
        if apart { 2 } else { 1 }
    }

    /// Computes some columns of a zone, counted from its first, of all rows that a cell takes, as far as they are not there.
    #[inline(always)]
    fn compute<S: Simd>(
        &mut self,
        simd: S,
        zone: usize,
        cell: &Cell,
        lattice: &Lattice,
        part: &Range<usize>,
    ) {
        let kept = &self.zones[zone];
        let is_ready =
            kept.cell == cell.rows && kept.ready.start <= part.start && part.end <= kept.ready.end;
        if is_ready {
            return;
        }
        for &row in cell.distinct() {
            match self.mirror.filter(|_| zone == 1) {
                Some(mirror) => self.reflect_row(simd, &mirror, row, lattice, part),
                None => self.compute_row(simd, zone, row, lattice, part),
            }
        }
        let kept = &mut self.zones[zone];
        (kept.cell, kept.ready) = (cell.rows, part.clone());
    }

    /// Computes some columns of a row of the second zone from the first one's, if they are not there.
    #[inline(always)]
    fn reflect_row<S: Simd>(
        &mut self,
        simd: S,
        mirror: &Mirror,
        row: i64,
        lattice: &Lattice,
        part: &Range<usize>,
    ) {
        let (slot, right) = (slot(row), &mut self.zones[1]);
        if right.missing(row, part).iter().all(Range::is_empty) {
            return;
        }
        // With what was there before: whole vectors reach into it, and its left columns may be gone.
        let part = right.done[slot].clone();
        self.compute_row(simd, 0, row, lattice, &mirror.needs(&part));
        let [left, right] = self
            .zones
            .each_mut()
            .map(|zone| zone.rows[slot].as_mut_slice());
        let right = &mut right[BEFORE..];
        simd.vectorize(
            #[inline(always)]
            || mirror.fill(simd, left, &part, right),
        );
    }

    /// Computes some columns of a row of the lattice, as far as they are not there.
    #[inline(always)]
    fn compute_row<S: Simd>(
        &mut self,
        simd: S,
        zone: usize,
        row: i64,
        lattice: &Lattice,
        part: &Range<usize>,
    ) {
        let zone = &mut self.zones[zone];
        let missing = zone.missing(row, &(part.start / BLOCK..part.end.div_ceil(BLOCK)));
        if missing.iter().all(Range::is_empty) {
            return;
        }
        self.nodes.place(simd, &lattice.shape, lattice.y(row));
        let reach = Reach {
            row: &self.nodes.row,
            square: self.nodes.kernel.side as f32,
            met: zone.met,
            sides: zone.sides.map(|side| side - lattice.columns.start()),
            pitch: lattice.columns.pitch(),
        };
        let (columns, slot) = (lattice.columns, slot(row));
        let pixels = &mut zone.rows[slot][BEFORE..];
        if !columns.are_pixels() {
            let count = columns.count(zone.width).div_ceil(BLOCK);
            reach.compute_all(simd, 0..count, &mut self.columns[0]);
            columns.spread(simd, &mut self.columns, pixels);
            zone.done[slot] = 0..usize::MAX;
            return;
        }
        for missing in missing {
            if !missing.is_empty() {
                reach.compute_all(simd, missing, pixels);
            }
        }
    }
}

impl Zone {
    /// The blocks, or of a likeness the columns, that are missing of some wanted ones of a row, before and behind those that are there: they
    /// are there from now on.
    #[inline(always)]
    fn missing(&mut self, row: i64, wanted: &Range<usize>) -> [Range<usize>; 2] {
        let slot = slot(row);
        let done = &mut self.done[slot];
        if self.which[slot] != row {
            self.which[slot] = row;
            *done = wanted.start..wanted.start;
        }
        let missing = [wanted.start..done.start, done.end..wanted.end];
        *done = done.start.min(wanted.start)..done.end.max(wanted.end);
        missing
    }
}
