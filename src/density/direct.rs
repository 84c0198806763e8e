//! `direct`: the closed form in single precision, row by row.
//!
//! Error: 0.05 level from rounding and from its polynomials; below r = 3 px, where a pixel is an average over a square,
//! 0.8 level from its quadrature.

use fearless_simd::Simd;

use super::frame::Frame;
use super::rows::Lattice;
use super::sampling::Sampling;
use super::{CURVES, PixelOptions, Sink, averaged_side, reach, seen_columns};
use crate::grid::Grid;
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
    let scale = grid.pixels_per_unit();
    let radius = radius * scale;
    let sampling = Sampling::new(radius);
    let (unit, points) = (sampling.unit, sampling.points());
    let bounds = outline::bounds(edges.iter());
    let reach = reach(radius);
    let Some(frame) = bounds.map(|bounds| Frame::new(bounds, reach, grid)) else {
        return;
    };
    let placed = edges
        .iter()
        .map(|edge| edge.mapped(scale / unit, |p| frame.place(p) / unit));
    scratch.rows.load(placed, sampling.window, &points);
    let (rows, wanted) = (&mut scratch.rows, &mut scratch.wanted);
    let lattice = Lattice {
        window: sampling.window,
        start: (frame.phase.x + 0.5) / unit,
        pitch: 1.0 / unit,
        density: unit,
    };
    let [columns, lines] = frame.pixels();
    if columns.is_empty() {
        return;
    }
    let origin = frame.first[0];
    // What was computed of the last row: all of it, or what was seen.
    let mut computed = Computed::Nothing;
    for line in lines {
        let y = (line as f64 + frame.phase.y + 0.5) / unit;
        let row = (line - frame.first[1]) as u32;
        seen_columns(options.hidden, row, &frame, &columns, wanted);
        if wanted.is_empty() {
            continue;
        }
        if !rows.is_still(y) {
            rows.go_to(y, columns.clone(), &lattice, &points);
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
            let all = core::slice::from_ref(&columns);
            for columns in if now == Computed::All {
                all
            } else {
                &wanted[..]
            } {
                rows.compute(simd, columns.clone(), &lattice, &points);
            }
            computed = now;
        }
        for columns in wanted.iter() {
            rows.give(row, columns.clone(), origin, sink);
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Computed {
    Nothing,
    Seen,
    All,
}

/// The share of the tolerance that arcs in place of curves may take, for a penumbra radius in pixels: most of it where nothing else
/// is wrong but rounding.
pub(crate) fn curves(radius: f64) -> f64 {
    if averaged_side(radius) > 0.0 {
        CURVES
    } else {
        0.5
    }
}

/// The largest error of averages over pixels, in levels.
pub(crate) const AVERAGED: f64 = 0.8;

/// The largest error from rounding and from polynomials, in levels.
pub(crate) const ROUNDING: f64 = 0.05;
