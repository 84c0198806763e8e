//! `direct`: the closed form in single precision: by bands of four rows where pixels see few discs, row by row where they average over
//! many or over squares.
//!
//! Error: 0.05 level from rounding and from its polynomials; below r = 3 px, where a pixel is an average over a square,
//! 0.8 level from its quadrature.

use core::f64::consts::{FRAC_PI_2, TAU};
use core::ops::Range;

use fearless_simd::Simd;
use glam::DVec2;

use super::frame::Frame;
use super::rows::{BAND, Bands, Lattice, Points, Rows, Window, to_tiles};
use super::sampling::Sampling;
use super::{CURVES, PixelOptions, Sink, averaged_side, join, reach, seen_columns};
use crate::grid::Grid;
use crate::hidden::Hidden;
use crate::outline::{self, Edge};
use crate::scratch::Scratch;

/// Gives `sink` the density of every pixel of the grid that is in the shadow of an outline; `radius` in scene units.
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
    let Some(bounds) = outline::bounds(edges.iter()) else {
        return;
    };
    let scale = grid.pixels_per_unit();
    let side = averaged_side(radius * scale) / scale;
    let has_tips = || has_tips(edges, radius, side);
    let is_crowded = || {
        // Two squares are as wide as what a pixel averages over. They begin at the outline's corner: where it is changes nothing.
        let width = 2.0 * radius + side;
        scratch.squares.clear();
        for edge in edges {
            let end = (edge.from() - bounds.0) * (2.0 / width);
            scratch.squares.add(end, 1.0);
        }
        scratch.squares.most() >= CROWD
    };
    let sampling = Sampling::new(radius * scale, has_tips, is_crowded);
    let radius = radius * scale;
    let (unit, points) = (sampling.unit, sampling.points());
    let frame = Frame::new(bounds, reach(radius), grid);
    let placed = edges
        .iter()
        .map(|edge| edge.mapped(scale / unit, |p| frame.place(p) / unit));
    let [columns, lines] = frame.pixels();
    if columns.is_empty() || lines.is_empty() {
        return;
    }
    let drawing = Drawing {
        frame,
        lattice: Lattice {
            window: sampling.window,
            start: (frame.phase.x + 0.5) / unit,
            pitch: 1.0 / unit,
            density: unit,
        },
        columns,
        lines,
        hidden: options.hidden,
    };
    let Scratch {
        rows,
        bands,
        wanted,
        wanted_of_rows,
        ..
    } = scratch;
    // Where pieces pass all that a pixel averages over, each row has its own that stands for their chain.
    if sampling.window == Window::Disc && points.wide.is_none() {
        bands.load(placed);
        fill_bands(
            simd,
            &drawing,
            &points,
            bands,
            (wanted, wanted_of_rows),
            sink,
        );
    } else {
        rows.load(placed, sampling.window, &points);
        fill_rows(simd, &drawing, &points, rows, wanted, sink);
    }
}

/// From so many ends of edges on that a pixel averages over, few points leave too much: of 2,700 gratings none with fewer passed 0.8 level.
const CROWD: f64 = 8.0;

/// Whether more than a third of a circle about as large as the disc is among the edges, to `side` of the square that pixels average
/// over: about its centre the density has a tip.
fn has_tips(edges: &[Edge], radius: f64, side: f64) -> bool {
    // The turn so far about one centre. Loops may begin in such a circle.
    let (mut center, mut turn) = (DVec2::ZERO, 0.0);
    edges.iter().chain(edges).any(|edge| {
        let Edge::Arc(arc) = edge else {
            turn = 0.0;
            return false;
        };
        if (arc.center - center).length() > side / 2.0 {
            (center, turn) = (arc.center, 0.0);
        }
        if (arc.radius - radius).abs() < side {
            turn += arc.sweep.abs();
        }
        turn > TAU / 3.0
    })
}

/// What is drawn, where.
struct Drawing<'a> {
    frame: Frame,
    lattice: Lattice,
    columns: Range<i64>,
    lines: Range<i64>,
    hidden: Option<&'a Hidden>,
}

impl Drawing<'_> {
    /// Where a line's centres are, in the windows' unit.
    fn y(&self, line: i64) -> f64 {
        (line as f64 + self.frame.phase.y + 0.5) * self.lattice.pitch
    }

    /// Its number on the grid.
    fn number(&self, line: i64) -> u32 {
        (line - self.frame.first[1]) as u32
    }

    /// Puts what is seen of a line into `seen`.
    fn seen(&self, line: i64, seen: &mut Vec<Range<i64>>) {
        let row = self.number(line);
        seen_columns(self.hidden, row, &self.frame, &self.columns, seen);
    }
}

/// Gives `sink` the lines of a drawing, row by row.
#[inline(always)]
fn fill_rows<S: Simd>(
    simd: S,
    drawing: &Drawing<'_>,
    points: &Points<'_>,
    rows: &mut Rows,
    wanted: &mut Vec<Range<i64>>,
    sink: &mut dyn Sink,
) {
    let Drawing {
        columns, lattice, ..
    } = drawing;
    let mut computed = Computed::Nothing;
    for line in drawing.lines.clone() {
        let y = drawing.y(line);
        drawing.seen(line, wanted);
        if wanted.is_empty() {
            continue;
        }
        if !rows.is_still(y) {
            rows.go_to(y, columns.clone(), lattice, points);
            computed = Computed::Nothing;
        }
        // A row like those below may be seen elsewhere there.
        let now = if rows.is_still(y) {
            Computed::All
        } else {
            Computed::Seen
        };
        if computed != Computed::All {
            rows.clear();
            let all = core::slice::from_ref(columns);
            for columns in if now == Computed::All {
                all
            } else {
                &wanted[..]
            } {
                rows.compute(simd, columns.clone(), lattice, points);
            }
            computed = now;
        }
        for columns in wanted.iter() {
            let (number, origin) = (drawing.number(line), drawing.frame.first[0]);
            rows.give(number, columns, origin, sink);
        }
    }
}

/// Gives `sink` the lines of a drawing of discs, by bands of them.
#[inline(always)]
fn fill_bands<S: Simd>(
    simd: S,
    drawing: &Drawing<'_>,
    points: &Points<'_>,
    bands: &mut Bands,
    (all, wanted): (&mut Vec<Range<i64>>, &mut [Vec<Range<i64>>; BAND as usize]),
    sink: &mut dyn Sink,
) {
    let Drawing { columns, lines, .. } = drawing;
    let lattice = &drawing.lattice;
    let mut computed = Computed::Nothing;
    for band in lines.start.div_euclid(BAND)..=(lines.end - 1).div_euclid(BAND) {
        let first = band * BAND;
        let within = first.max(lines.start)..(first + BAND).min(lines.end);
        all.clear();
        for line in within.clone() {
            let wanted = &mut wanted[(line - first) as usize];
            drawing.seen(line, wanted);
            all.extend(wanted.iter().map(to_tiles));
        }
        if all.is_empty() {
            continue;
        }
        join(all);
        let bottom = drawing.y(first + BAND - 1);
        if !bands.is_still(bottom) {
            bands.go_to(simd, drawing.y(first), columns, lattice, points);
            computed = Computed::Nothing;
        }
        if computed != Computed::All {
            // A band like those below may be seen elsewhere there.
            computed = if bands.is_still(bottom) {
                all.clear();
                all.push(to_tiles(columns));
                Computed::All
            } else {
                Computed::Seen
            };
            bands.clear();
            for columns in all.iter() {
                bands.compute(simd, columns.clone(), lattice, points);
            }
        }
        for line in within {
            let row = (line - first) as usize;
            let (number, origin) = (drawing.number(line), drawing.frame.first[0]);
            for columns in &wanted[row] {
                bands.give(row, number, columns, origin, sink);
            }
        }
    }
}

/// What was computed of the last row or band: all of it, or what was seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Computed {
    Nothing,
    Seen,
    All,
}

/// The share of the tolerance that arcs in place of curves may take, for a penumbra radius in pixels: most of it where nothing else
/// is wrong but rounding, for which twice as much is left as it takes.
pub(crate) fn curves(radius: f64, levels: f64) -> f64 {
    if averaged_side(radius) > 0.0 {
        CURVES
    } else {
        (1.0 - 2.0 * ROUNDING / levels).max(0.5)
    }
}

/// The largest error of averages over pixels, in levels.
pub(crate) const AVERAGED: f64 = 0.8;

/// The largest error from rounding and from polynomials, in levels.
pub(crate) const ROUNDING: f64 = 0.05;

/// The same where lines and arcs are drawn as they are: without a penumbra small corners in one pixel came to 0.095.
pub(crate) const FIXED: f64 = 2.0 * ROUNDING;

/// What single precision adds to it for an outline of an `extent`, in pixels as the penumbra radius: a coordinate is off by half a step, and
/// density changes by 2 / π over the radius, by 1 a pixel at most.
pub(crate) fn rounding(extent: f64, radius: f64) -> f64 {
    const STEP: f64 = f32::EPSILON as f64 / 2.0;
    255.0 * extent * STEP / (FRAC_PI_2 * radius).max(1.0)
}
