//! Circles: what two discs have in common is closed form in their distance.
//!
//! Error: 0.05 level, from rounding and polynomials.

use core::ops::Range;

use fearless_simd::{Simd, SimdBase, f32x16};
use glam::DVec2;

use super::frame::{Frame, whole_below};
use super::lanes::{LANES, lanes};
use super::rows::{self, Power};
use super::runs::{Run, Runs};
use super::{PixelOptions, Sink, seen_columns};
use crate::grid::Grid;
use crate::scratch::Scratch;

/// Gives `sink` the density of every pixel of the grid that is in the shadow of the circle between two corners, and not hidden. `radius`, the
/// penumbra's, in pixels.
#[inline(always)]
pub(crate) fn fill<S: Simd>(
    simd: S,
    (min, max): (DVec2, DVec2),
    radius: f64,
    grid: &Grid,
    options: &PixelOptions<'_>,
    scratch: &mut Scratch,
    sink: &mut dyn Sink,
) {
    let frame = Frame::new((min, max), radius, grid);
    let [columns, lines] = frame.pixels();
    if columns.is_empty() {
        return;
    }
    let ratio = (max.x - min.x) / 2.0 * frame.scale / radius;
    let (runs, wanted) = (&mut scratch.runs, &mut scratch.wanted);
    runs.begin((columns.end - columns.start) as usize);
    let within =
        |part: &Range<i64>, of: &Range<i64>| part.start.max(of.start)..part.end.min(of.end);
    let on_grid = |part: &Range<i64>| {
        let column = |x: i64| (x - frame.first[0]) as u32;
        column(part.start)..column(part.end)
    };
    // Column and row numbers are the coordinates of their pixels' centres.
    let center = frame.place((min + max) / 2.0) - frame.phase - 0.5;
    let filled = ratio.min(1.0);
    let inside = (filled * filled) as f32;
    let (outer, inner) = ((ratio + 1.0) * radius, (ratio - 1.0).abs() * radius);
    for line in lines {
        let down = line as f64 - center.y;
        let half_width = |reach: f64| (reach * reach - down * down).max(0.0).sqrt();
        let around = |half: f64| {
            let end = whole_below(center.x + half) + 1;
            -whole_below(half - center.x)..end
        };
        let reached = around(half_width(outer));
        let mut even = around(half_width(inner));
        if inner <= down.abs() || even.is_empty() {
            even = reached.end..reached.end;
        }
        let row = (line - frame.first[1]) as u32;
        seen_columns(options.hidden, row, &frame, &columns, wanted);
        let sides = [reached.start..even.start, even.end..reached.end];
        for wanted in wanted.iter() {
            let constant = within(&even, wanted);
            if !constant.is_empty() {
                sink.constant(row..row + 1, on_grid(&constant), inside);
            }
            for side in &sides {
                let part = within(side, wanted);
                if part.is_empty() {
                    continue;
                }
                // From the side's own beginning on, so that what else is drawn changes nothing.
                let seen = DVec2::new(center.x - side.start as f64, -down) / radius;
                let power = Power::of(seen, ratio, 1.0 / radius, f32x16::splat(simd, 0.0));
                let run = Run {
                    row,
                    columns: on_grid(&part),
                };
                place(
                    simd,
                    power,
                    (part.start - side.start) as usize,
                    runs.push(run),
                );
            }
        }
        if runs.are_many() {
            give(simd, ratio as f32, runs, sink);
        }
    }
    give(simd, ratio as f32, runs, sink);
}

/// Places the powers of pixels from the one `skipped` after that which `power` counts from on.
#[inline(always)]
fn place<S: Simd>(simd: S, power: Power<S>, skipped: usize, powers: &mut [f32]) {
    simd.vectorize(
        #[inline(always)]
        || {
            let mut columns = lanes(simd) + skipped as f32;
            for powers in powers.as_chunks_mut::<LANES>().0 {
                power.at(columns).store_slice(powers);
                columns += LANES as f32;
            }
        },
    );
}

/// Gives a sink the densities of runs whose powers are placed: they are computed at once, as a row of a small circle would fill few
/// vectors.
#[inline(always)]
fn give<S: Simd>(simd: S, radius: f32, runs: &mut Runs, sink: &mut dyn Sink) {
    simd.vectorize(
        #[inline(always)]
        || {
            for values in runs.values().as_chunks_mut::<LANES>().0 {
                let power = f32x16::from_slice(simd, values);
                rows::circle(simd, power, radius).store_slice(values);
            }
        },
    );
    runs.give(sink);
}
