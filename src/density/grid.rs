//! `grid`: the closed form on a lattice coarser than the pixels, and cubics between (Catmull & Rom 1974).
//!
//! The density is smooth at the scale of the penumbra radius r, so the lattice has a fixed number of steps a radius and a
//! pixel's cost hardly depends on r. What limits every interpolation are the penumbra's two ends, where the density leaves
//! 0 and 1 like the power 1.5 of the distance, and points that see many edges at the distance r at once, like the centre
//! of an arc of radius r. The lattice shows where it is too coarse: there, each node is foretold from its neighbours at twice
//! the spacing, and cells whose nodes are foretold badly are drawn pixel by pixel.
//!
//! Error: the tolerance.

use core::ops::Range;

use fearless_simd::{Simd, SimdBase, f32x8};

use super::frame::Frame;
use super::nine_patch::cubic_weights;
use super::rows::{LANES, Lattice, Points, Rows, Window};
use super::{Each, PixelOptions, Sink, seen_columns};
use crate::scratch::Scratch;

/// Rows of the lattice that are kept: the four that a pixel is interpolated from, and three more on both sides to foretell
/// nodes from.
const RING: usize = 8;

/// The steps a penumbra radius for a tolerance of one level.
const STEPS: f64 = 14.0;

/// The steps a penumbra radius that keep the penumbra's ends within a tolerance: their error falls with the power of 1.5.
pub(crate) fn steps(levels: f64) -> f64 {
    STEPS * libm::pow(1.0 / levels, if levels < 1.0 { 1.0 / 1.5 } else { 0.5 })
}

/// A row of the lattice has at least so many columns: eight at once are foretold, from three more on both sides.
const LEAST: i64 = LANES as i64 + 6;

/// Columns of the lattice before the shadow begins.
const MARGIN: f64 = 4.0;

/// What this method leaves from drawing to drawing: memory.
#[derive(Debug, Default)]
pub(crate) struct GridScratch {
    rows: Rows,
    /// The last rows of the lattice, each with its densities, the same on the pixels' columns, and its constant runs there.
    ring: [Knots; RING],
    /// Where each pixel's four neighbours begin in a row of the lattice, and their weights.
    places: Vec<u32>,
    weights: Vec<[f32; 4]>,
    /// How far nodes of a row are from what their neighbours foretell.
    surprises: [Vec<f32>; 2],
    /// Columns of pixels that are drawn one by one in the present row of cells.
    coarse: Vec<Range<i64>>,
    values: Vec<f32>,
}

#[derive(Debug, Default)]
struct Knots {
    densities: Vec<f32>,
    pixels: Vec<f32>,
    /// Runs of pixels from left to right without a gap, with their density where it is one.
    runs: Vec<(i64, Option<f32>)>,
}

/// Where the lattice's columns and rows are.
#[derive(Debug, Clone, Copy)]
struct Net {
    /// Pixels from knot to knot.
    spacing: f64,
    /// The fraction of a pixel by which pixels begin after the frame's.
    phase: f64,
}

impl Net {
    /// A pixel's place among the knots.
    fn place(&self, pixel: i64) -> f64 {
        (pixel as f64 + self.phase + 0.5) / self.spacing + MARGIN
    }

    /// The first pixel at a knot or after it.
    fn pixel(&self, knot: i64) -> i64 {
        ((knot as f64 - MARGIN) * self.spacing - self.phase - 0.5).ceil() as i64
    }
}

/// Gives `sink` the density of every pixel of the grid that is in the shadow and not hidden; `scratch.rows` holds the
/// outline in units of the penumbra radius, `radius` pixels.
#[inline(always)]
pub(crate) fn fill<S: Simd>(
    simd: S,
    frame: &Frame,
    radius: f64,
    options: &PixelOptions<'_>,
    scratch: &mut Scratch,
    sink: &mut dyn Sink,
) {
    let Scratch {
        rows: pixel_rows,
        grid: kept,
        wanted,
        ..
    } = scratch;
    let levels = options.tolerance.as_levels();
    let steps = steps(levels);
    let across = Net {
        spacing: radius / steps,
        phase: frame.phase.x,
    };
    let down = Net {
        phase: frame.phase.y,
        ..across
    };
    let [columns, lines] = frame.pixels();
    if columns.is_empty() || lines.is_empty() {
        return;
    }
    let pixels = Lattice {
        window: Window::Disc,
        start: (frame.phase.x + 0.5) / radius,
        pitch: 1.0 / radius,
        density: radius,
    };
    kept.rows.load_from(pixel_rows);
    let knots = across.place(columns.start) as i64 - 4..across.place(columns.end) as i64 + 6;
    let mut weaver = Weaver {
        kept,
        across,
        columns: columns.clone(),
        knots: knots.start..knots.end.max(knots.start + LEAST),
        next: down.place(lines.start) as i64 - 3,
        steps,
        limit: (LIMIT * levels / 255.0) as f32,
    };
    weaver.find_places();
    let origin = frame.first[0];
    let mut cell = None;
    for line in lines {
        let place = down.place(line);
        let knot = place as i64;
        weaver.weave_to(simd, knot + 4);
        if cell != Some(knot) {
            weaver.find_coarse(simd, knot, cell == Some(knot - 1));
            cell = Some(knot);
        }
        let number = (line - frame.first[1]) as u32;
        seen_columns(options.hidden, number, frame, &columns, wanted);
        let woven = Woven {
            knot,
            weights: cubic_weights(place.fract()),
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

/// How far a knot may be from what its neighbours at twice the spacing foretell, over the tolerance. At the penumbra's
/// ends that is 2.8 times the error between knots, at the tip of a cone twice.
const LIMIT: f64 = 0.9;

/// The sum of the first four densities by their weights.
#[inline(always)]
pub(super) fn interpolate(near: &[f32], weights: &[f32; 4]) -> f32 {
    let Some(near) = near.first_chunk::<4>() else {
        return 0.0;
    };
    let mut parts = [0.0; 4];
    for index in 0..4 {
        parts[index] = near[index] * weights[index];
    }
    (parts[0] + parts[1]) + (parts[2] + parts[3])
}

/// Eight knots as their neighbours at one and three steps on both sides foretell them.
#[inline(always)]
fn foretold<S: Simd>(simd: S, [a, b, c, d]: [&[f32]; 4]) -> f32x8<S> {
    let near = f32x8::from_slice(simd, &b[..LANES]) + f32x8::from_slice(simd, &c[..LANES]);
    let far = f32x8::from_slice(simd, &a[..LANES]) + f32x8::from_slice(simd, &d[..LANES]);
    near * (9.0 / 16.0) - far * (1.0 / 16.0)
}

/// A line of pixels: the row of the lattice above it, the weights of the four rows about it, its number on the grid and the
/// column at which the grid begins.
struct Woven {
    knot: i64,
    weights: [f32; 4],
    number: u32,
    origin: i64,
}

/// Goes down the lattice row by row.
struct Weaver<'a> {
    kept: &'a mut GridScratch,
    across: Net,
    columns: Range<i64>,
    knots: Range<i64>,
    /// The next row of the lattice.
    next: i64,
    steps: f64,
    limit: f32,
}

impl Weaver<'_> {
    fn find_places(&mut self) {
        let kept = &mut *self.kept;
        kept.places.clear();
        kept.weights.clear();
        for column in self.columns.clone() {
            let place = self.across.place(column);
            let knot = place as i64;
            kept.places.push((knot - 1 - self.knots.start) as u32);
            kept.weights.push(cubic_weights(place - knot as f64));
        }
    }

    /// Computes the lattice's rows up to and with `last`.
    #[inline(always)]
    fn weave_to<S: Simd>(&mut self, simd: S, last: i64) {
        // Rows that no pixel needs are passed over.
        self.next = self.next.max(last + 1 - RING as i64);
        while self.next <= last {
            self.weave(simd, self.next);
            self.next += 1;
        }
    }

    #[inline(always)]
    fn weave<S: Simd>(&mut self, simd: S, row: i64) {
        let lattice = Lattice {
            window: Window::Disc,
            start: -MARGIN / self.steps,
            pitch: 1.0 / self.steps,
            density: self.steps,
        };
        let kept = &mut *self.kept;
        let rows = &mut kept.rows;
        let y = (row as f64 - MARGIN) / self.steps;
        if !rows.is_still(y) {
            rows.go_to(y, self.knots.clone(), &lattice, &Points::CENTER);
            rows.clear();
            rows.compute(simd, self.knots.clone(), &lattice, &Points::CENTER);
        }
        let knots = &mut kept.ring[row.rem_euclid(RING as i64) as usize];
        let width = (self.knots.end - self.knots.start) as usize;
        knots.densities.clear();
        knots.densities.resize(width, 0.0);
        let mut sink = Each {
            pixels: &mut knots.densities,
            stride: width,
            put: |to: &mut f32, density| *to = density,
        };
        rows.give(0, self.knots.clone(), self.knots.start, &mut sink);

        knots.runs.clear();
        let mut at = self.columns.start;
        let mut constant = |from: i64, to: i64, density: f32| {
            // All four neighbours of these pixels are of the one density.
            let start = self.across.pixel(from + 1).clamp(at, self.columns.end);
            let end = self.across.pixel(to - 2).clamp(start, self.columns.end);
            if start < end {
                if start > at {
                    knots.runs.push((start, None));
                }
                knots.runs.push((end, Some(density)));
                at = end;
            }
        };
        let mut knot = self.knots.start;
        for (columns, density) in rows.spans() {
            constant(knot, columns.start, 0.0);
            if let Some(density) = density {
                constant(columns.start, columns.end, density);
            }
            knot = columns.end;
        }
        constant(knot, self.knots.end + 3, 0.0);
        if at < self.columns.end {
            knots.runs.push((self.columns.end, None));
        }

        let count = (self.columns.end - self.columns.start) as usize;
        knots.pixels.resize(count + LANES, 0.0);
        let mut start = 0;
        for (end, density) in &knots.runs {
            let end = (end - self.columns.start) as usize;
            match density {
                Some(density) => knots.pixels[start..end].fill(*density),
                None => {
                    let places = kept.places[start..end]
                        .iter()
                        .zip(&kept.weights[start..end]);
                    for (pixel, (place, weights)) in knots.pixels[start..end].iter_mut().zip(places)
                    {
                        *pixel = interpolate(&knots.densities[*place as usize..], weights);
                    }
                }
            }
            start = end;
        }
    }

    /// Finds the columns of the cells below a row of the lattice that are too coarse. `went_on`: the last time it was the row
    /// above.
    #[inline(always)]
    fn find_coarse<S: Simd>(&mut self, simd: S, row: i64, went_on: bool) {
        if went_on {
            self.kept.surprises.swap(0, 1);
        } else {
            self.surprise(simd, row, 0);
        }
        self.surprise(simd, row + 1, 1);
        let kept = &mut *self.kept;
        kept.coarse.clear();
        let [above, below] = &kept.surprises;
        // A peak between knots shows at those beyond the cell as well.
        for index in 3..above.len().saturating_sub(4) {
            let near = above[index - 1..index + 3].iter();
            let worst = near
                .chain(&below[index - 1..index + 3])
                .fold(0.0, |a: f32, b| a.max(*b));
            if worst <= self.limit {
                continue;
            }
            let knot = self.knots.start + index as i64;
            let start = self.across.pixel(knot).max(self.columns.start);
            let end = self.across.pixel(knot + 1).min(self.columns.end);
            match kept.coarse.last_mut() {
                Some(last) if last.end == start => last.end = end,
                _ if start < end => kept.coarse.push(start..end),
                _ => {}
            }
        }
    }

    /// How far each knot of a row is from what its neighbours at one and three steps foretell, along the row and across.
    #[inline(always)]
    fn surprise<S: Simd>(&mut self, simd: S, row: i64, which: usize) {
        let kept = &mut *self.kept;
        let near =
            |offset: i64| &kept.ring[(row + offset).rem_euclid(RING as i64) as usize].densities;
        let here = near(0);
        let columns = [near(-3), near(-1), near(1), near(3)];
        let surprises = &mut kept.surprises[which];
        surprises.clear();
        surprises.resize(here.len(), 0.0);
        let last = here.len().saturating_sub(LANES + 3);
        let mut at = 3;
        while at <= last {
            let density = f32x8::from_slice(simd, &here[at..at + LANES]);
            let along = foretold(
                simd,
                [
                    &here[at - 3..],
                    &here[at - 1..],
                    &here[at + 1..],
                    &here[at + 3..],
                ],
            );
            let [a, b, c, d] = columns;
            let across = foretold(simd, [&a[at..], &b[at..], &c[at..], &d[at..]]);
            let surprise = (density - along).abs().max((density - across).abs());
            surprise.store_slice(&mut surprises[at..at + LANES]);
            if at == last {
                break;
            }
            at = (at + LANES).min(last);
        }
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
        let rows =
            [-1, 0, 1, 2].map(|offset| &ring[(row + offset).rem_euclid(RING as i64) as usize]);
        let mut runs = [0; 4];
        let mut at = columns.start;
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        while at < columns.end {
            let mut end = columns.end;
            let mut constant = Some(0.0);
            for index in 0..4 {
                while rows[index].runs[runs[index]].0 <= at {
                    runs[index] += 1;
                }
                let (run_end, density) = rows[index].runs[runs[index]];
                end = end.min(run_end);
                constant = constant
                    .zip(density)
                    .map(|(sum, density)| sum + density * weights[index]);
            }
            let first = (at - origin) as u32;
            match constant {
                Some(density) if density > 0.0 => {
                    sink.constant(number, first..(end - origin) as u32, density.min(1.0));
                }
                Some(_) => {}
                None => {
                    let count = (end - at) as usize;
                    let start = (at - self.columns.start) as usize;
                    values.resize(count.next_multiple_of(LANES), 0.0);
                    for offset in (0..count).step_by(LANES) {
                        let part = start + offset..start + offset + LANES;
                        let load = |row: usize| &rows[row].pixels[part.clone()];
                        let [a, b, c, d] = [load(0), load(1), load(2), load(3)];
                        let sum = f32x8::from_slice(simd, a) * weights[0]
                            + f32x8::from_slice(simd, b) * weights[1]
                            + (f32x8::from_slice(simd, c) * weights[2]
                                + f32x8::from_slice(simd, d) * weights[3]);
                        let sum = sum.max(zero).min(one);
                        sum.store_slice(&mut values[offset..offset + LANES]);
                    }
                    sink.values(number, first, &values[..count]);
                }
            }
            at = end;
        }
    }
}
