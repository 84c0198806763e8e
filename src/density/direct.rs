//! `direct`: the closed form in single precision, row by row.
//!
//! Error: 0.05 level from rounding and from its polynomials; below r = 3 px, where a pixel is an average over a square,
//! 0.5 level from its quadrature.

use fearless_simd::Simd;

use super::frame::Frame;
use super::rows::Lattice;
use super::sampling::Sampling;
use super::{PixelOptions, Sink, averaged_side, seen_columns};
use crate::grid::Grid;
use crate::outline;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// Gives `sink` the density of every pixel of the grid that is in the shadow.
#[inline(always)]
pub(crate) fn fill<S: Simd>(
    simd: S,
    shadow: &Shadow,
    grid: &Grid,
    options: &PixelOptions<'_>,
    scratch: &mut Scratch,
    coarse: bool,
    sink: &mut dyn Sink,
) {
    let scale = grid.pixels_per_unit();
    let radius = shadow.radius() * scale;
    let sampling = Sampling::new(radius);
    let (unit, points) = (sampling.unit, sampling.points());
    let mut edges = scratch.take();
    let levels = CURVES * options.tolerance.as_levels();
    shadow.edges_into(levels, 1.0 / scale, &mut edges);
    let bounds = outline::bounds(edges.iter());
    let reach = radius + averaged_side(radius) / 2.0;
    let frame = bounds.map(|bounds| Frame::new(bounds, reach, grid));
    if let Some(frame) = &frame {
        let placed = edges
            .iter()
            .map(|edge| edge.mapped(scale / unit, |p| frame.place(p) / unit));
        scratch.rows.load(placed, sampling.window);
    }
    scratch.give(edges);
    let Some(frame) = frame else { return };
    if coarse && radius >= 3.0 {
        super::grid::fill(simd, &frame, radius, options, scratch, sink);
        return;
    }
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

/// The largest error of averages over pixels, in levels.
pub(crate) const AVERAGED: f64 = 0.8;

/// The share of the tolerance that lines in place of curves may take.
const CURVES: f64 = 0.25;

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;
    use crate::light::Light;
    use crate::shape::Shape;

    struct Map(Vec<f32>, u32);
    impl Sink for Map {
        fn constant(&mut self, y: u32, columns: core::ops::Range<u32>, density: f32) {
            let row = (y * self.1) as usize;
            self.0[row + columns.start as usize..row + columns.end as usize].fill(density);
        }
        fn values(&mut self, y: u32, first: u32, densities: &[f32]) {
            let start = (y * self.1 + first) as usize;
            self.0[start..start + densities.len()].copy_from_slice(densities);
        }
    }

    #[test]
    fn small() {
        let shapes = [
            ("rect", Shape::rect(10.3, 10.6, 30.0, 30.0).unwrap()),
            (
                "tilted",
                Shape::rect(10.3, 10.6, 30.0, 30.0)
                    .unwrap()
                    .transformed([0.9, 0.25, -0.25, 0.9, 13.0, 0.0])
                    .unwrap(),
            ),
            ("circle", Shape::circle([30.2, 30.3], 15.0).unwrap()),
            ("dot", Shape::circle([30.2, 30.3], 0.8).unwrap()),
            ("sliver", Shape::rect(10.0, 30.2, 40.0, 0.3).unwrap()),
            (
                "rrect",
                Shape::rounded_rect(10.3, 10.6, 30.0, 30.0, 4.0).unwrap(),
            ),
        ];
        let grid = Grid::new([0.0, 0.0], [60, 60], 1.0).unwrap();
        for radius in [
            0.0_f32, 0.05, 0.1, 0.2, 0.3, 0.4, 0.49, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.3, 1.5,
            1.8, 2.0, 2.5, 2.9,
        ] {
            let mut line = String::new();
            for (name, shape) in &shapes {
                let shadow = Light::directional([0.0, 0.0], radius.max(1e-6))
                    .unwrap()
                    .cast(shape, 1.0, 0.0)
                    .unwrap();
                let shadow = if radius == 0.0 {
                    shadow.with_radius(0.0)
                } else {
                    shadow
                };
                let mut scratch = Scratch::new();
                let mut a = vec![0.0; 3600];
                let mut b = vec![0.0; 3600];
                let mut o = PixelOptions {
                    method: Some(crate::plan::Method::Exact),
                    ..PixelOptions::default()
                };
                shadow.fill_f32(&grid, &mut a, &o, &mut scratch).unwrap();
                o.method = Some(crate::plan::Method::Direct);
                shadow.fill_f32(&grid, &mut b, &o, &mut scratch).unwrap();
                let worst = a
                    .iter()
                    .zip(&b)
                    .map(|(a, b)| (a - b).abs() * 255.0)
                    .fold(0.0, f32::max);
                line += &format!(" {name} {worst:.3}");
            }
            println!("r {radius}:{line}");
        }
    }

    #[test]
    fn agrees_with_the_closed_form() {
        let shapes = [
            ("rect", Shape::rect(60.0, 80.0, 180.0, 100.0).unwrap()),
            (
                "rrect",
                Shape::rounded_rect(60.3, 80.0, 180.0, 100.0, 20.0).unwrap(),
            ),
            (
                "pill",
                Shape::rounded_rect(60.0, 80.2, 180.0, 60.0, 30.0).unwrap(),
            ),
            ("circle", Shape::circle([150.0, 150.0], 40.0).unwrap()),
            ("dot", Shape::circle([150.0, 150.0], 4.0).unwrap()),
            ("bar", Shape::rect(60.0, 80.0, 180.0, 3.0).unwrap()),
            (
                "star",
                Shape::polygon(
                    &[(0_u8..10)
                        .map(|i| {
                            let (sin, cos) = (f32::from(i) * core::f32::consts::PI / 5.0).sin_cos();
                            let radius = if i % 2 == 0 { 100.0 } else { 40.0 };
                            [150.0 + radius * sin, 150.0 - radius * cos]
                        })
                        .collect::<Vec<_>>()],
                    crate::path::FillRule::NonZero,
                )
                .unwrap(),
            ),
        ];
        let grid = Grid::new([0.0, 0.0], [300, 300], 1.0).unwrap();
        for (name, shape) in shapes {
            for radius in [3.0_f32, 5.0, 10.8, 20.0, 30.0, 40.0, 60.0, 100.0] {
                let shadow = Light::directional([0.0, 0.0], radius)
                    .unwrap()
                    .cast(&shape, 1.0, 0.0)
                    .unwrap();
                let mut scratch = Scratch::new();
                let mut map = Map(vec![0.0; 90000], 300);
                let mut times = Vec::new();
                for _ in 0..5 {
                    let start = std::time::Instant::now();
                    dispatch!(Level::new(), simd => fill(simd, &shadow, &grid, &PixelOptions::default(), &mut scratch, false, &mut map));
                    times.push(start.elapsed().as_nanos());
                }
                let time = times.iter().min().unwrap();
                let (mut worst, mut at) = (0.0, [0, 0]);
                for y in 0..300_u16 {
                    for x in 0..300_u16 {
                        let exact = shadow.density_at([f32::from(x) + 0.5, f32::from(y) + 0.5]);
                        let got = map.0[usize::from(y) * 300 + usize::from(x)];
                        let error = (f64::from(got) - exact).abs() * 255.0;
                        if error > worst {
                            (worst, at) = (error, [x, y]);
                        }
                    }
                }
                println!("{name} r {radius}: {worst:.5} levels at {at:?}, {time} ns");
            }
        }
    }
}
