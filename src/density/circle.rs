//! Circles: what two discs have in common is closed form in their distance.
//!
//! Error: 0.05 level, from rounding and polynomials.

use core::ops::Range;

use fearless_simd::{Simd, SimdBase, f32x16};
use glam::DVec2;

use super::frame::Frame;
use super::lanes::{LANES, lanes};
use super::rows::{self, Power, RowCircle};
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
    let (values, wanted) = (&mut scratch.values, &mut scratch.wanted);
    // Column and row numbers are the coordinates of their pixels' centres.
    let center = frame.place((min + max) / 2.0) - frame.phase - 0.5;
    let inside = ratio.min(1.0).powi(2) as f32;
    let (outer, inner) = ((ratio + 1.0) * radius, (ratio - 1.0).abs() * radius);
    for line in lines {
        let down = line as f64 - center.y;
        let half_width = |reach: f64| (reach * reach - down * down).max(0.0).sqrt();
        let around =
            |half: f64| (center.x - half).ceil() as i64..(center.x + half).floor() as i64 + 1;
        let reached = around(half_width(outer));
        let mut even = around(half_width(inner));
        if inner <= down.abs() || even.is_empty() {
            even = reached.end..reached.end;
        }
        let row = (line - frame.first[1]) as u32;
        seen_columns(options.hidden, row, &frame, &columns, wanted);
        for wanted in wanted.iter() {
            let within = |part: &Range<i64>| part.start.max(wanted.start)..part.end.min(wanted.end);
            let column = |x: i64| (x - frame.first[0]) as u32;
            let constant = within(&even);
            if !constant.is_empty() {
                sink.constant(
                    row..row + 1,
                    column(constant.start)..column(constant.end),
                    inside,
                );
            }
            for side in [reached.start..even.start, even.end..reached.end] {
                let part = within(&side);
                if !part.is_empty() {
                    // From the side's own beginning on, so that what else is drawn changes nothing.
                    let seen = DVec2::new(center.x - side.start as f64, -down) / radius;
                    let circle = RowCircle {
                        power: Power::of(seen, ratio, 1.0 / radius, f32x16::splat(simd, 0.0)),
                        radius: ratio as f32,
                    };
                    let skipped = (part.start - side.start) as usize;
                    let count = (part.end - part.start) as usize;
                    values.resize(count.next_multiple_of(LANES), 0.0);
                    fill_row(simd, &circle, skipped, values);
                    sink.values(row..row + 1, column(part.start)..column(part.end), values);
                }
            }
        }
    }
}

/// Computes the densities of pixels from the one `skipped` after the first on.
#[inline(always)]
fn fill_row<S: Simd>(simd: S, circle: &RowCircle<S>, skipped: usize, values: &mut [f32]) {
    simd.vectorize(
        #[inline(always)]
        || {
            let mut columns = lanes(simd) + skipped as f32;
            for values in values.as_chunks_mut::<LANES>().0 {
                rows::circle(simd, columns, circle).store_slice(values);
                columns += LANES as f32;
            }
        },
    );
}
