//! Circles: one profile along a radius, looked up by each pixel's distance.
//!
//! Error: 0.1 level, from linear interpolation along the profile.

use core::ops::Range;

use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8, i32x8};
use glam::DVec2;

use super::frame::Frame;
use super::lanes::NUMBERS;
use super::rows::{Lattice, Points, Rows, Window};
use super::{Each, PixelOptions, Sink, seen_columns};
use crate::grid::Grid;
use crate::outline::{Edge, Outline};
use crate::scratch::Scratch;

/// Pixels that are looked up at once.
const LANES: usize = 8;

/// Intervals along the penumbra.
const INTERVALS: usize = 192;

/// The densities along a radius, from where they begin to change: in units of the penumbra radius.
#[derive(Debug, Default)]
pub(crate) struct Profile {
    rows: Rows,
    start: f32,
    per_unit: f32,
    densities: Vec<f32>,
    values: Vec<f32>,
}

/// Gives `sink` the density of every pixel of the grid that is in the shadow of a circle and not hidden. `center` and
/// `circle`, the circle's radius, in scene units; `radius`, the penumbra's, in pixels.
#[inline(always)]
pub(crate) fn fill<S: Simd>(
    simd: S,
    outline: &Outline,
    radius: f64,
    grid: &Grid,
    options: &PixelOptions<'_>,
    scratch: &mut Scratch,
    sink: &mut dyn Sink,
) {
    let Some((min, max)) = outline.bounds() else {
        return;
    };
    let frame = Frame::new((min, max), radius, grid);
    let [columns, lines] = frame.pixels();
    if columns.is_empty() {
        return;
    }
    let ratio = (max.x - min.x) / 2.0 * frame.scale / radius;
    let (profile, wanted) = (&mut scratch.circle, &mut scratch.wanted);
    let edges = outline.edges();
    profile.trace(simd, edges, (min + max) / 2.0, frame.scale / radius, ratio);
    // Column and row numbers are the coordinates of their pixels' centres.
    let center = frame.place((min + max) / 2.0) - frame.phase - 0.5;
    let inside = profile.densities[0];
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
                sink.constant(row, column(constant.start)..column(constant.end), inside);
            }
            for side in [reached.start..even.start, even.end..reached.end] {
                let part = within(&side);
                if !part.is_empty() {
                    // From the side's own beginning on, so that what else is drawn changes nothing.
                    let across = ((side.start as f64 - center.x) / radius) as f32;
                    let skipped = (part.start - side.start) as usize;
                    let to_center = [across, (down / radius) as f32, (1.0 / radius) as f32];
                    let count = (part.end - part.start) as usize;
                    let densities = profile.look_up(simd, to_center, skipped, count);
                    sink.values(row, column(part.start)..column(part.end), densities);
                }
            }
        }
    }
}

impl Profile {
    /// Computes the profile: the densities along a row of points through the centre.
    #[inline(always)]
    fn trace<'a, S: Simd>(
        &mut self,
        simd: S,
        edges: impl Iterator<Item = &'a Edge>,
        center: DVec2,
        factor: f64,
        ratio: f64,
    ) {
        let start = (ratio - 1.0).abs();
        let length = 2.0 * ratio.min(1.0);
        let density = INTERVALS as f64 / length;
        let lattice = Lattice {
            window: Window::Disc,
            start,
            pitch: 1.0 / density,
            density,
        };
        let edges = edges.map(|edge| edge.mapped(factor, |p| (p - center) * factor));
        self.rows.load(edges, Window::Disc, &Points::CENTER);
        self.densities.clear();
        self.densities.resize(INTERVALS + 2, 0.0);
        let columns = 0..INTERVALS as i64 + 1;
        self.rows
            .go_to(0.0, columns.clone(), &lattice, &Points::CENTER);
        self.rows.clear();
        self.rows
            .compute(simd, columns.clone(), &lattice, &Points::CENTER);
        let mut sink = Each {
            pixels: &mut self.densities,
            stride: INTERVALS,
            put: |to: &mut f32, density| *to = density,
        };
        self.rows.give(0, columns, 0, &mut sink);
        self.start = start as f32;
        self.per_unit = density as f32;
    }

    /// The densities of a row of pixels from the one `skipped` after the first on: `across` and `down` from the centre to the
    /// first, and from one to the next, in units of the penumbra radius.
    #[inline(always)]
    fn look_up<S: Simd>(
        &mut self,
        simd: S,
        [across, down, step]: [f32; 3],
        skipped: usize,
        count: usize,
    ) -> &[f32] {
        self.values.clear();
        self.values.resize(count.next_multiple_of(LANES), 0.0);
        let zero = f32x8::splat(simd, 0.0);
        let last = f32x8::splat(simd, INTERVALS as f32);
        let lanes = f32x8::from_slice(simd, &NUMBERS[..LANES]);
        for (index, values) in self
            .values
            .as_chunks_mut::<LANES>()
            .0
            .iter_mut()
            .enumerate()
        {
            let column = lanes + (skipped + index * LANES) as f32;
            let x = column * step + across;
            let distance = (x * x + down * down).sqrt();
            let place = ((distance - self.start) * self.per_unit)
                .max(zero)
                .min(last);
            let whole: i32x8<S> = place.to_int();
            let knots: [i32; LANES] = whole.into();
            let (mut near, mut far) = ([0.0; LANES], [0.0; LANES]);
            for lane in 0..LANES {
                let knot = knots[lane] as usize;
                near[lane] = self.densities[knot];
                far[lane] = self.densities[knot + 1];
            }
            let near = f32x8::from_slice(simd, &near);
            let far = f32x8::from_slice(simd, &far);
            (near + (far - near) * place.fract()).store_slice(values);
        }
        &self.values
    }
}
