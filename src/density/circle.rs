//! Circles: what two discs have in common is closed form in their distance.
//!
//! Error: 0.05 level, from rounding and polynomials.

use core::ops::Range;

use fearless_simd::{Simd, SimdBase, f32x16};
use glam::DVec2;

use super::frame::Frame;
use super::lanes::{LANES, lanes};
use super::rows::{self, Power};
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
    // Whole vectors are written from any place on.
    let most = (columns.end - columns.start) as usize;
    values.resize(most.next_multiple_of(LANES) + LANES, 0.0);
    let within =
        |part: &Range<i64>, of: &Range<i64>| part.start.max(of.start)..part.end.min(of.end);
    let on_grid = |part: &Range<i64>| {
        let column = |x: i64| (x - frame.first[0]) as u32;
        column(part.start)..column(part.end)
    };
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
            let constant = within(&even, wanted);
            if !constant.is_empty() {
                sink.constant(row..row + 1, on_grid(&constant), inside);
            }
        }
        let sides = [reached.start..even.start, even.end..reached.end];
        // Left and right of what is constant, one after the other, so that they fill whole vectors.
        let parts = || {
            let parts = wanted.iter().flat_map(|wanted| {
                let of_side = |side: &Range<i64>| (side.start, within(side, wanted));
                sides.iter().map(of_side)
            });
            parts.filter(|(_, part)| !part.is_empty())
        };
        let mut count = 0;
        for (start, part) in parts() {
            // From the side's own beginning on, so that what else is drawn changes nothing.
            let seen = DVec2::new(center.x - start as f64, -down) / radius;
            let power = Power::of(seen, ratio, 1.0 / radius, f32x16::splat(simd, 0.0));
            let length = (part.end - part.start) as usize;
            let powers = &mut values[count..][..length.next_multiple_of(LANES)];
            place(simd, power, (part.start - start) as usize, powers);
            count += length;
        }
        fill_all(
            simd,
            ratio as f32,
            &mut values[..count.next_multiple_of(LANES)],
        );
        let mut values = &values[..];
        for (_, part) in parts() {
            sink.values(row..row + 1, on_grid(&part), values);
            values = &values[(part.end - part.start) as usize..];
        }
    }
}

/// Places the powers of pixels from the one `skipped` after the first on.
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

/// Computes densities in the place of powers.
#[inline(always)]
fn fill_all<S: Simd>(simd: S, radius: f32, values: &mut [f32]) {
    simd.vectorize(
        #[inline(always)]
        || {
            for values in values.as_chunks_mut::<LANES>().0 {
                let power = f32x16::from_slice(simd, values);
                rows::circle(simd, power, radius).store_slice(values);
            }
        },
    );
}
