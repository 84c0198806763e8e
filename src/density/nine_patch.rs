//! `nine_patch`: rounded rectangles by columns and corners.
//!
//! Areas add up, so a rounded rectangle's density is that of the sharp one less those of its four spandrels, what is
//! left between a sharp corner and its arc. The sharp one is closed form with one table along the columns: no root a pixel.
//! A spandrel's density is one function of the corner's radius over the penumbra's, tabled over the few points that it
//! needs and interpolated by cubics (Catmull & Rom 1974) at all four corners. Columns between the corners have one
//! density a row, rows between them are all alike.
//!
//! Error: the spandrels' interpolation, kept within the tolerance by the table's spacing; below 0.01 level elsewhere.

use core::f64::consts::{FRAC_1_PI, FRAC_PI_2};
use core::ops::Range;

use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8};
use glam::DVec2;

use super::frame::Frame;
use super::rounded::Rounded;
use super::rows::{LANES, Lattice, Points, Rows, Window, half_disc, half_disc_x8};
use super::{Each, PixelOptions, Sink, seen_columns};
use crate::grid::Grid;
use crate::outline::{Arc, Edge, Line};
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// Corners rounder than this, over the penumbra radius, need more table than they spare.
pub(crate) const ROUNDEST: f64 = 2.0;

/// Corners rounder than this are no longer drawn by this method.
const ROUNDEST_EVER: f64 = 16.0;

/// Circles larger than this, over the penumbra radius, are told from each other by double precision only.
const LARGEST_CIRCLE: f64 = 1024.0;

/// Rectangles with more columns, in pixels, are no longer drawn by this method.
const WIDEST: f64 = 32_768.0;

/// The rounded rectangle or circle that a shadow is, if this method can draw it on so many pixels a scene unit.
pub(crate) fn suited(shadow: &Shadow, per_unit: f64) -> Option<Rounded> {
    let rounded = shadow.rounded()?;
    let roundest = rounded.radii.into_iter().fold(0.0, f64::max) / shadow.radius();
    let width = (rounded.max.x - rounded.min.x + 2.0 * shadow.radius()) * per_unit;
    let drawn = match rounded.circle() {
        Some(_) => roundest <= LARGEST_CIRCLE,
        None => roundest <= ROUNDEST_EVER && width <= WIDEST,
    };
    (drawn && shadow.radius() * per_unit >= 3.0).then_some(rounded)
}

/// Spandrel densities over square steps of 1/`steps`, from one step before where they begin.
#[derive(Debug, Default)]
struct Corner {
    ratio: f32,
    steps: u32,
    side: usize,
    densities: Vec<f32>,
}

/// What this method leaves from drawing to drawing: the last corners' tables, and memory.
#[derive(Debug, Default)]
pub(crate) struct NinePatchScratch {
    corners: Vec<Corner>,
    /// The table to be given up next.
    oldest: usize,
    rows: Rows,
    zones: [Zone; 2],
}

/// How many corners' tables are kept.
const KEPT: usize = 8;

/// Columns on which a row's density changes.
#[derive(Debug, Default)]
struct Zone {
    start: i64,
    end: i64,
    /// The upright sides that the zone's discs can meet, and the corners.
    sides: List<Side>,
    spandrels: List<Spandrel>,
    values: Vec<f32>,
    /// Whether `values` hold the row that all rows between the corners are alike to.
    still: bool,
}

/// Items whose memory is used again.
#[derive(Debug, Default)]
struct List<T> {
    items: Vec<T>,
    count: usize,
}

impl<T: Default> List<T> {
    fn push(&mut self) -> &mut T {
        if self.count == self.items.len() {
            self.items.push(T::default());
        }
        self.count += 1;
        &mut self.items[self.count - 1]
    }

    fn all(&self) -> &[T] {
        &self.items[..self.count]
    }
}

/// An upright side as each column sees it: how far away, half of the chord that it cuts from the disc, and `half_disc` of
/// that.
#[derive(Debug, Default)]
struct Side {
    /// 1 for the side of largest x, -1 for the other.
    sign: f32,
    distances: Vec<f32>,
    chords: Vec<f32>,
    halves: Vec<f32>,
}

/// A corner's spandrel, interpolated along its table's rows to the zone's columns.
#[derive(Debug, Default)]
struct Spandrel {
    /// Where the corner is, and 1 where the rectangle goes on to larger y, else -1.
    y: f64,
    inwards: f64,
    steps: f64,
    rows: usize,
    /// Where each column's four neighbours begin in a row of the table, and their weights.
    places: Vec<(u32, [f32; 4])>,
    densities: Vec<f32>,
}

/// A row as the sharp rectangle's upper and lower sides cut its discs.
struct Row {
    y: f64,
    radius: f64,
    ends: [f32; 2],
    halves: [f32; 2],
    still: bool,
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
    let frame = Frame::new((rounded.min, rounded.max), radius, grid);
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
    let (kept, wanted) = (&mut scratch.nine_patch, &mut scratch.wanted);
    let zones = lay_out(simd, &shape, radius, options.tolerance.as_levels(), kept);
    let zones = &mut kept.zones[..zones];
    let middle = match zones {
        [left, right] => left.end..right.start,
        _ => 0..0,
    };
    let origin = frame.first[0];
    let deepest = shape.radii.into_iter().fold(0.0, f64::max) + radius;
    for line in lines {
        let y = line as f64;
        let ends = [shape.min.y - y, shape.max.y - y].map(|v| (v / radius).clamp(-1.0, 1.0) as f32);
        let row = Row {
            y,
            radius,
            ends,
            halves: ends.map(half_disc),
            still: y > shape.min.y + deepest && y < shape.max.y - deepest,
        };
        let between = 2.0 * (row.halves[1] - row.halves[0]);
        if between <= 0.0 {
            continue;
        }
        let number = (line - frame.first[1]) as u32;
        seen_columns(options.hidden, number, &frame, &columns, wanted);
        for wanted in wanted.iter() {
            let column = |x: i64| (x - origin) as u32;
            let (start, end) = (wanted.start.max(middle.start), wanted.end.min(middle.end));
            if start < end {
                sink.constant(number, column(start)..column(end), between);
            }
            for zone in &mut *zones {
                let (start, end) = (wanted.start.max(zone.start), wanted.end.min(zone.end));
                if start < end {
                    let part = (start - zone.start) as usize..(end - zone.start) as usize;
                    zone.compute(simd, &part, &row);
                    sink.values(number, column(start), &zone.values[part]);
                }
            }
        }
    }
}

/// Prepares the zones, two or one where their discs meet sides or corners of both; their number.
#[inline(always)]
fn lay_out<S: Simd>(
    simd: S,
    shape: &Rounded,
    radius: f64,
    tolerance: f64,
    kept: &mut NinePatchScratch,
) -> usize {
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
    let across = if apart { 1.0 } else { 2.0 };
    let above = shape.min.y + tl.max(tr);
    let below = shape.max.y - bl.max(br);
    let down = if above + 2.0 * radius < below {
        1.0
    } else {
        2.0
    };
    // The errors of corners that one pixel sees add up.
    let share = SHARE * tolerance / (across * down);

    let zones = if apart { 2 } else { 1 };
    for (index, range) in ranges.iter().enumerate().take(zones) {
        let zone = &mut kept.zones[index];
        zone.start = range.0.ceil() as i64;
        zone.end = range.1.floor() as i64 + 1;
        zone.still = false;
        zone.sides.count = 0;
        zone.spandrels.count = 0;
        let width = ((zone.end - zone.start) as usize).next_multiple_of(LANES);
        zone.values.clear();
        zone.values.resize(width, 0.0);
        if !apart || index == 0 {
            zone.push_side(simd, -1.0, shape.min.x, radius);
        }
        if !apart || index == 1 {
            zone.push_side(simd, 1.0, shape.max.x, radius);
        }
    }
    for (index, corner_radius) in shape.radii.into_iter().enumerate() {
        if corner_radius == 0.0 {
            continue;
        }
        let (right, bottom) = (index == 1 || index == 2, index >= 2);
        let ratio = (corner_radius / radius) as f32;
        let steps = steps(f64::from(ratio), share, tolerance);
        let table = corner(
            simd,
            ratio,
            steps,
            &mut kept.corners,
            &mut kept.oldest,
            &mut kept.rows,
        );
        let x = if right { shape.max.x } else { shape.min.x };
        let spandrel = Placed {
            x,
            y: if bottom { shape.max.y } else { shape.min.y },
            inwards: [
                if right { -1.0 } else { 1.0 },
                if bottom { -1.0 } else { 1.0 },
            ],
            radius,
        };
        let zone = usize::from(right && apart);
        kept.zones[zone].push_spandrel(&kept.corners[table], &spandrel);
    }
    zones
}

/// A corner and the directions in which its rectangle goes on.
struct Placed {
    x: f64,
    y: f64,
    inwards: [f64; 2],
    radius: f64,
}

/// The share of the tolerance that interpolation may take.
const SHARE: f64 = 0.75;

/// The steps a penumbra radius that keep a spandrel's interpolation within `levels`: measured over many ratios, the largest
/// error is below min(ratio, 1.3) levels at 10 steps, and falls with their number to the power of 1.6. Where a disc nearly
/// fills its corner's circle, the density has a tip at that circle's centre: there the error is up to 13.5 levels over the
/// steps, at this corner alone.
fn steps(ratio: f64, levels: f64, tolerance: f64) -> u32 {
    let smooth = 10.0 * libm::pow(ratio.min(1.3) / levels, 1.0 / 1.6);
    let tip = if (0.8..1.35).contains(&ratio) {
        15.0 / tolerance
    } else {
        0.0
    };
    (smooth.max(tip).ceil() as u32).max(3)
}

/// The index of a corner's table, made if it is not among those kept.
#[inline(always)]
fn corner<S: Simd>(
    simd: S,
    ratio: f32,
    steps: u32,
    corners: &mut Vec<Corner>,
    oldest: &mut usize,
    rows: &mut Rows,
) -> usize {
    let found = corners
        .iter()
        .position(|corner| corner.ratio == ratio && corner.steps == steps);
    if let Some(index) = found {
        return index;
    }
    let index = if corners.len() < KEPT {
        corners.push(Corner::default());
        corners.len() - 1
    } else {
        *oldest = (*oldest + 1) % KEPT;
        *oldest
    };
    tabulate(simd, ratio, steps, &mut corners[index], rows);
    index
}

#[inline(always)]
fn tabulate<S: Simd>(simd: S, ratio: f32, steps: u32, corner: &mut Corner, rows: &mut Rows) {
    let (reach, density) = (f64::from(ratio), f64::from(steps));
    let side = ((reach + 2.0) * density).ceil() as usize + 4;
    corner.ratio = ratio;
    corner.steps = steps;
    corner.side = side;
    corner.densities.clear();
    corner.densities.resize(side * side, 0.0);
    rows.load(spandrel(reach).into_iter(), Window::Disc);
    let lattice = Lattice {
        window: Window::Disc,
        start: -1.0 - 1.0 / density,
        pitch: 1.0 / density,
        density,
    };
    let columns = 0..side as i64;
    let mut sink = Each {
        pixels: &mut corner.densities,
        stride: side,
        put: |to: &mut f32, density| *to = density,
    };
    for row in 0..side {
        let y = lattice.start + row as f64 * lattice.pitch;
        rows.go_to(y, columns.clone(), &lattice, &Points::CENTER);
        rows.clear();
        rows.compute(simd, columns.clone(), &lattice, &Points::CENTER);
        rows.give(row as u32, columns.clone(), 0, &mut sink);
    }
}

/// What lies between a corner at the origin and the arc in its first quadrant.
fn spandrel(radius: f64) -> [Edge; 3] {
    let (across, down) = (DVec2::new(radius, 0.0), DVec2::new(0.0, radius));
    let line = |from, to| Edge::Line(Line { from, to });
    [
        line(DVec2::ZERO, across),
        Edge::Arc(Arc {
            center: DVec2::splat(radius),
            radius,
            start: -FRAC_PI_2,
            sweep: -FRAC_PI_2,
            from: across,
            to: down,
        }),
        line(down, DVec2::ZERO),
    ]
}

/// The weights of four neighbours, for a point `share` of the way from the second to the third (Catmull & Rom 1974).
pub(super) fn cubic_weights(share: f64) -> [f32; 4] {
    let (t, u) = (share, 1.0 - share);
    [
        -0.5 * t * u * u,
        1.0 - 2.5 * t * t + 1.5 * t * t * t,
        1.0 - 2.5 * u * u + 1.5 * u * u * u,
        -0.5 * u * t * t,
    ]
    .map(|weight| weight as f32)
}

/// The sum of the first four densities by their weights.
#[inline(always)]
fn interpolate(near: &[f32], weights: &[f32; 4]) -> f32 {
    let Some(near) = near.first_chunk::<4>() else {
        return 0.0;
    };
    let mut parts = [0.0; 4];
    for index in 0..4 {
        parts[index] = near[index] * weights[index];
    }
    (parts[0] + parts[1]) + (parts[2] + parts[3])
}

impl Zone {
    #[inline(always)]
    fn push_side<S: Simd>(&mut self, simd: S, sign: f32, x: f64, radius: f64) {
        let (start, width) = (self.start, self.values.len());
        let side = self.sides.push();
        side.sign = sign;
        for list in [&mut side.distances, &mut side.chords, &mut side.halves] {
            list.clear();
            list.resize(width, 0.0);
        }
        let one = f32x8::splat(simd, 1.0);
        for index in 0..width {
            side.distances[index] = ((x - (start + index as i64) as f64) / radius) as f32;
        }
        for at in (0..width).step_by(LANES) {
            let part = at..at + LANES;
            let distance = f32x8::from_slice(simd, &side.distances[part.clone()]);
            let chord = (one - distance * distance)
                .max(f32x8::splat(simd, 0.0))
                .sqrt();
            chord.store_slice(&mut side.chords[part.clone()]);
            half_disc_x8(simd, chord).store_slice(&mut side.halves[part]);
        }
    }

    fn push_spandrel(&mut self, corner: &Corner, placed: &Placed) {
        let (start, width) = (self.start, self.values.len());
        let steps = f64::from(corner.steps);
        let spandrel = self.spandrels.push();
        spandrel.y = placed.y;
        spandrel.inwards = placed.inwards[1];
        spandrel.steps = steps;
        spandrel.rows = corner.side;
        spandrel.densities.clear();
        spandrel.densities.resize(corner.side * width, 0.0);
        spandrel.places.clear();
        for index in 0..width {
            let x = (start + index as i64) as f64;
            let depth = (x - placed.x) * placed.inwards[0] / placed.radius;
            let place = (depth + 1.0) * steps + 1.0;
            let reached = place >= 1.0 && place < (corner.side - 2) as f64;
            spandrel.places.push(if reached {
                (place as u32 - 1, cubic_weights(place.fract()))
            } else {
                (0, [0.0; 4])
            });
        }
        let rows = spandrel.densities.chunks_exact_mut(width);
        for (to, from) in rows.zip(corner.densities.chunks_exact(corner.side)) {
            for (density, (first, weights)) in to.iter_mut().zip(&spandrel.places) {
                *density = interpolate(&from[*first as usize..], weights);
            }
        }
    }

    /// Computes the zone's densities over columns counted from its first.
    #[inline(always)]
    fn compute<S: Simd>(&mut self, simd: S, columns: &Range<usize>, row: &Row) {
        if row.still && self.still {
            return;
        }
        self.still = row.still;
        let width = self.values.len();
        let (first, last) = if row.still {
            (0, width)
        } else {
            let last = columns.end.next_multiple_of(LANES);
            (columns.start / LANES * LANES, last)
        };
        let [above, below] = row.halves;
        // A side that no disc of the zone meets is far right or far left of all.
        let base = (2 - self.sides.count) as f32 * (below - above);
        let mut near = [([0; 4], [0.0; 4], &[][..]); 4];
        let mut count = 0;
        for spandrel in self.spandrels.all() {
            let place =
                ((row.y - spandrel.y) * spandrel.inwards / row.radius + 1.0) * spandrel.steps + 1.0;
            // The table ends in next to nothing: rows that are alike have none of it.
            if !row.still && place >= 1.0 && place < (spandrel.rows - 2) as f64 {
                let at = (place as usize - 1) * width;
                let rows = [at, at + width, at + 2 * width, at + 3 * width];
                near[count] = (rows, cubic_weights(place.fract()), &spandrel.densities[..]);
                count += 1;
            }
        }
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        for at in (first..last).step_by(LANES) {
            let part = at..at + LANES;
            let mut sum = f32x8::splat(simd, base);
            for side in self.sides.all() {
                let distance = f32x8::from_slice(simd, &side.distances[part.clone()]);
                let chord = f32x8::from_slice(simd, &side.chords[part.clone()]);
                let half = f32x8::from_slice(simd, &side.halves[part.clone()]);
                sum += upright(simd, distance, chord, half, row) * side.sign;
            }
            for (rows, weights, densities) in &near[..count] {
                for (start, weight) in rows.iter().zip(weights) {
                    let row = &densities[start + at..start + at + LANES];
                    sum -= f32x8::from_slice(simd, row) * *weight;
                }
            }
            sum.max(zero).min(one).store_slice(&mut self.values[part]);
        }
    }
}

/// What an upright side between the row's ends adds: as a line does, with the part inside the disc between its chord's
/// ends and the sides beyond.
#[inline(always)]
fn upright<S: Simd>(
    simd: S,
    distance: f32x8<S>,
    chord: f32x8<S>,
    half: f32x8<S>,
    row: &Row,
) -> f32x8<S> {
    let (top, bottom) = (
        f32x8::splat(simd, row.ends[0]),
        f32x8::splat(simd, row.ends[1]),
    );
    let (above, below) = (
        f32x8::splat(simd, row.halves[0]),
        f32x8::splat(simd, row.halves[1]),
    );
    let height = bottom.min(chord).max(-chord) - top.min(chord).max(-chord);
    let inside = below.min(half).max(-half) - above.min(half).max(-half);
    let side = f32x8::splat(simd, 1.0).copysign(distance);
    distance * height * FRAC_1_PI as f32 + side * ((below - above) - inside)
}
