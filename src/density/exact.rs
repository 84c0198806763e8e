//! `exact`: the closed form, pixel by pixel, in double precision. All that follows is held against it.
//!
//! A quadtree of tiles cuts the outline down to what the discs of a tile can meet, so umbra and surroundings are filled
//! whole and a pixel of the penumbra costs only the edges near it.
//!
//! Error: rounding (1e-9) for lines and circular arcs, 0.02 level from flattening other curves, and below r = 3 px, where
//! a pixel is an average over a square, 0.12 level from its quadrature.

use glam::DVec2;

use super::area::settled;
use super::frame::Frame;
use super::{EXACT_SHARE, Sink, at_point, averaged_side, quadrature, reach};
use crate::grid::Grid;
use crate::hidden::Hidden;
use crate::outline::{self, Edge, clip_to_box};
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// The largest error of averages over pixels, in levels.
pub(crate) const AVERAGED: f64 = 0.12;

/// The side of the smallest tiles, in pixels: smaller ones cut more than they save.
const LEAF: i64 = 8;

/// Gives `sink` the density of every pixel of the grid that is in the shadow and not hidden.
pub(crate) fn fill(
    shadow: &Shadow,
    grid: &Grid,
    hidden: Option<&Hidden>,
    scratch: &mut Scratch,
    sink: &mut dyn Sink,
) {
    let scale = grid.pixels_per_unit();
    let outline = shadow.outline_within(EXACT_SHARE, 1.0 / scale);
    let Some(bounds) = outline.bounds() else {
        return;
    };
    let radius = shadow.radius() * scale;
    let reach = reach(radius);
    let frame = Frame::new(bounds, reach, grid);
    let mut painter = Painter {
        radius,
        side: averaged_side(radius),
        reach,
        phase: frame.phase,
        first: frame.first,
        size: frame.size,
        hidden,
        scratch,
        sink,
    };
    let mut edges = painter.scratch.take();
    edges.extend(
        outline
            .edges()
            .map(|edge| edge.mapped(scale, |p| frame.place(p))),
    );
    let mut tile = LEAF;
    while (tile as f64) < frame.extent.max_element() {
        tile *= 2;
    }
    painter.tile([0, 0], tile, &edges);
    painter.scratch.give(edges);
}

struct Painter<'a> {
    /// The penumbra radius, the side of a pixel's averaged square, and how far from its centre a pixel sees, in pixels.
    radius: f64,
    side: f64,
    reach: f64,
    /// Where in a pixel of the shadow's own coordinates a pixel of the grid begins.
    phase: DVec2,
    /// The grid's first pixel and its size, in the shadow's own pixels.
    first: [i64; 2],
    size: [i64; 2],
    hidden: Option<&'a Hidden>,
    scratch: &'a mut Scratch,
    sink: &'a mut dyn Sink,
}

impl Painter<'_> {
    fn tile(&mut self, at: [i64; 2], side: i64, edges: &[Edge]) {
        let range = |axis: usize| {
            let end = self.first[axis] + self.size[axis];
            at[axis].max(self.first[axis])..(at[axis] + side).min(end)
        };
        let (columns, rows) = (range(0), range(1));
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        let min = DVec2::new(at[0] as f64, at[1] as f64) + self.phase - self.reach;
        let max = min + side as f64 + 2.0 * self.reach;
        let (mut clipped, mut spare) = (self.scratch.take(), self.scratch.take());
        let met = clip_to_box(edges, min, max, &mut spare, &mut clipped);
        self.scratch.give(spare);
        if met && side > LEAF {
            let half = side / 2;
            for [x, y] in [[0, 0], [half, 0], [0, half], [half, half]] {
                self.tile([at[0] + x, at[1] + y], half, &clipped);
            }
        } else if met || winds_round(&clipped) {
            for y in rows {
                for x in columns.clone() {
                    let (column, row) = ((x - self.first[0]) as u32, (y - self.first[1]) as u32);
                    if self.hidden.is_none_or(|hidden| !hidden.hides(column, row)) {
                        let density = if met {
                            self.pixel([x, y], &clipped)
                        } else {
                            1.0
                        };
                        self.sink
                            .values(row..row + 1, column..column + 1, &[density as f32]);
                    }
                }
            }
        }
        self.scratch.give(clipped);
    }

    fn pixel(&mut self, at: [i64; 2], edges: &[Edge]) -> f64 {
        let center = DVec2::new(at[0] as f64, at[1] as f64) + self.phase + 0.5;
        if self.side == 0.0 {
            return at_point(edges.iter(), center, self.radius);
        }
        // An average costs many densities: most pixels of a tile are spared it.
        let (mut near, mut spare) = (self.scratch.take(), self.scratch.take());
        let half = DVec2::splat(self.reach);
        let met = clip_to_box(edges, center - half, center + half, &mut spare, &mut near);
        self.scratch.give(spare);
        let parts = quadrature::parts(self.radius, periods(&near, self.reach));
        let density = if !met {
            f64::from(u8::from(winds_round(&near)))
        } else if self.radius == 0.0 {
            covered(&near)
        } else if self.radius < quadrature::COVERAGE_RADIUS {
            self.averaged_coverage(center, &near, parts)
        } else {
            quadrature::exact_square(self.radius, parts)
                .map(|(offset, weight)| {
                    weight * at_point(near.iter(), center + offset * self.side, self.radius)
                })
                .sum()
        };
        self.scratch.give(near);
        density
    }

    /// The part of the pixel's square inside the outline, averaged over the disc.
    fn averaged_coverage(&mut self, center: DVec2, edges: &[Edge], parts: u32) -> f64 {
        let (mut inside, mut spare) = (self.scratch.take(), self.scratch.take());
        let average = quadrature::exact_disc(parts)
            .map(|(offset, weight)| {
                let center = center + offset * self.radius;
                clip_to_box(edges, center - 0.5, center + 0.5, &mut spare, &mut inside);
                weight * covered(&inside)
            })
            .sum();
        self.scratch.give(inside);
        self.scratch.give(spare);
        average
    }
}

/// The area inside edges cut to a pixel.
fn covered(edges: &[Edge]) -> f64 {
    settled(outline::area(edges.iter()))
}

/// How many periods of a grating there are across a pixel, were what it sees within its reach one.
fn periods(near: &[Edge], reach: f64) -> f64 {
    let side = 2.0 * reach;
    let edges = near.iter().filter(|edge| !matches!(edge, Edge::Border(_)));
    let across: f64 = edges.map(|edge| edge.length() / side).sum();
    // Two edges to a period.
    across / 2.0 / side
}

/// Whether edges that all run along the box they were cut to wind round it, or are nothing.
fn winds_round(edges: &[Edge]) -> bool {
    covered(edges) > 0.5
}

#[cfg(test)]
mod tests {
    use core::ops::Range;

    use glam::DAffine2;

    use super::*;
    use crate::outline::Outline;
    use crate::path::FillRule;
    use crate::shape::Shape;

    /// A square, a sliver and a dot at odd angles: what a pixel sees at its worst.
    fn outlines() -> impl Iterator<Item = Outline> {
        let shapes = [
            Shape::rect(0.0, 0.0, 40.0, 40.0).unwrap(),
            Shape::rect(0.0, 0.0, 40.0, 0.3).unwrap(),
            Shape::circle([0.0, 0.0], 1.0).unwrap(),
        ];
        shapes.into_iter().flat_map(|shape| {
            [0.0, 0.13, 0.6].map(|angle| {
                Outline::of_simple(&shape.mapped(&DAffine2::from_angle(angle))).unwrap()
            })
        })
    }

    /// Bars and gaps of equal widths.
    fn gratings() -> impl Iterator<Item = Outline> {
        let grating = |pitch: f32| {
            let bar = |i: i8| {
                let (top, bottom) = (f32::from(i) * pitch, (f32::from(i) + 0.5) * pitch);
                [[-9.0, top], [9.0, top], [9.0, bottom], [-9.0, bottom]]
            };
            let bars: Vec<_> = (-40..=40).map(bar).collect();
            let bars = Shape::polygon(&bars, FillRule::EvenOdd).unwrap();
            Outline::of_simple(&bars.mapped(&DAffine2::from_angle(f64::from(pitch)))).unwrap()
        };
        [0.09, 0.12, 0.15, 0.2, 0.28, 0.42, 0.73]
            .into_iter()
            .map(grating)
    }

    fn centers() -> impl Iterator<Item = DVec2> + Clone {
        (0..20).flat_map(|i| {
            (0..4).map(move |j| DVec2::new(f64::from(i) * 0.33 - 3.3, f64::from(j) * 0.7 - 1.0))
        })
    }

    /// How far pixels about centres are off the same average from at least 16 times as many densities, in levels.
    fn worst_average(
        radius: f64,
        outlines: impl Iterator<Item = Outline>,
        centers: impl Iterator<Item = DVec2> + Clone,
    ) -> f64 {
        let (mut scratch, mut sink) = (Scratch::new(), Nowhere);
        let (side, reach) = (averaged_side(radius), reach(radius));
        let mut painter = Painter {
            radius,
            side,
            reach,
            phase: DVec2::ZERO,
            first: [0, 0],
            size: [1, 1],
            hidden: None,
            scratch: &mut scratch,
            sink: &mut sink,
        };
        let mut worst: f64 = 0.0;
        let (mut spare, mut near) = (Vec::new(), Vec::new());
        for outline in outlines {
            let edges: Vec<Edge> = outline.edges().copied().collect();
            for center in centers.clone() {
                painter.phase = center - 0.5;
                let got = painter.pixel([0, 0], &edges);
                let half = DVec2::splat(reach);
                clip_to_box(&edges, center - half, center + half, &mut spare, &mut near);
                let fine: f64 = quadrature::exact_square(0.5, 4)
                    .map(|(offset, weight)| {
                        weight * at_point(near.iter(), center + offset * side, radius)
                    })
                    .sum();
                worst = worst.max((got - fine).abs());
            }
        }
        worst * 255.0
    }

    #[test]
    fn averages_are_within_the_stated_error() {
        for radius in [
            0.1, 0.3, 0.499, 0.5, 0.6, 0.9, 1.0, 1.5, 1.99, 2.0, 2.5, 2.9,
        ] {
            let worst = worst_average(radius, outlines(), centers());
            let on_gratings = worst_average(radius, gratings(), centers().step_by(11));
            println!("r {radius} px: {worst:.3} levels, on gratings {on_gratings:.3}");
            assert!(worst.max(on_gratings) < AVERAGED, "r {radius}");
        }
    }

    struct Nowhere;

    impl Sink for Nowhere {
        fn constant(&mut self, _: Range<u32>, _: Range<u32>, _: f32) {}
        fn values(&mut self, _: Range<u32>, _: Range<u32>, _: &[f32]) {}
    }

    #[test]
    fn hard_edges_are_exact_coverage() {
        // A slanted edge y = x / 4 over pixels: trapezia and triangles of known area.
        let mut painter = Painter {
            radius: 0.0,
            side: 1.0,
            reach: 0.5,
            phase: DVec2::ZERO,
            first: [0, 0],
            size: [8, 8],
            hidden: None,
            scratch: &mut Scratch::new(),
            sink: &mut Nowhere,
        };
        let below = Shape::polygon(
            &[[[-40.0, -10.0], [40.0, 10.0], [-40.0, 10.0]]],
            FillRule::NonZero,
        )
        .unwrap();
        let edges: Vec<Edge> = Outline::of_simple(&below)
            .unwrap()
            .edges()
            .copied()
            .collect();
        for (at, covered) in [
            ([0, 0], 0.875),
            ([1, 0], 0.625),
            ([3, 0], 0.125),
            ([0, 1], 1.0),
            ([5, 0], 0.0),
        ] {
            assert!(
                (painter.pixel(at, &edges) - covered).abs() < 1e-12,
                "{at:?}"
            );
        }
    }
}
