//! `grid`: rows of densities some pixels apart, and cubics between (Catmull & Rom 1974).
//!
//! Along the rows every pixel is computed, from sums along strips: it costs the same whatever the outline. From row to row the
//! density is smooth at the scale of the penumbra radius r, so the rows have a fixed number a radius, and none of them less than a pixel.
//!
//! What limits the interpolation are the penumbra's two ends, where the density leaves 0 and 1 like the power 1.5 of the
//! distance, and points that see many edges at the distance r at once, like the centre of an arc of radius r. The rows show
//! where they are too far apart: there, each is foretold from its neighbours at twice the distance, and blocks of pixels
//! that are foretold badly are drawn by the closed form.
//!
//! Error: the tolerance.

mod chords;
mod disc;
mod strips;
mod sums;
mod weaver;

use core::ops::Range;

use fearless_simd::Simd;
use glam::DVec2;

use self::strips::BLOCK;
use self::sums::{SumScratch, SumSource};
use self::weaver::{Weaver, Woven};
use super::cubic;
use super::frame::Frame;
use super::rows::{Lattice, Points, Window};
use super::{PixelOptions, Sink, seen_columns};
use crate::grid::Grid;
use crate::outline::{self, Edge};
use crate::scratch::Scratch;

/// How far any of the four rows that a pixel is interpolated from may be from what its neighbours at twice the distance
/// foretell, over the tolerance. The two nearest do not tell all: at a tip halfway between them the error is 1.5 times what
/// either is surprised by, and more where two tips meet. Of 30,000 cells about the tips of pills, 11 passed the tolerance by
/// up to 0.8 of it where only the two were asked; of all four none passed 0.9. In the notch of a heart 0.7 of the tolerance
/// was a surprise too few: one of 20,000 random shapes passed it by a twentieth.
const LIMIT: f64 = 0.65;

/// The same where the density is about 0 or 1. At the penumbra's ends it is 2.8 times the error between rows.
const END_LIMIT: f64 = 1.0;

/// Arcs whose radius is within this share of the disc's have a tip at their centre that is sharper than rows are apart: rows on both of
/// its sides say nothing of it. One of 20,000 random shapes passed its tolerance there, by a fiftieth.
const TIP: f64 = 0.07;

/// What this method leaves from drawing to drawing: memory.
#[derive(Debug, Default)]
pub(crate) struct GridScratch {
    sums: SumScratch,
    woven: Woven,
}

/// Where the lattice is, in pixels.
struct Place {
    radius: f64,
    /// From row to row.
    pitch: f64,
    /// Where in the frame a pixel begins.
    phase: DVec2,
    /// The first column of a row, and its blocks.
    first: i64,
    blocks: usize,
}

impl Place {
    /// Of the columns that a frame shows: whole blocks of the shadow, whatever part of it those are.
    fn new(frame: &Frame, radius: f64, levels: f64, columns: &Range<i64>) -> Self {
        let first = columns.start - columns.start % BLOCK as i64;
        Self {
            radius,
            pitch: radius / cubic::steps(levels),
            phase: frame.phase,
            first,
            blocks: ((columns.end - first) as usize).div_ceil(BLOCK),
        }
    }

    /// The row and the column of the point that sees an arc of the disc's own radius all at once, if an edge is one.
    fn tip(&self, edge: &Edge) -> Option<[i64; 2]> {
        match edge {
            Edge::Arc(arc) if (arc.radius / self.radius - 1.0).abs() < TIP => {
                let place = [arc.center.y / self.pitch, arc.center.x - self.phase.x];
                Some(place.map(|v| v.floor() as i64))
            }
            _ => None,
        }
    }

    /// Its columns in penumbra radii.
    fn lattice(&self) -> Lattice {
        Lattice {
            window: Window::Disc,
            start: (self.phase.x + 0.5) / self.radius,
            pitch: 1.0 / self.radius,
            density: self.radius,
        }
    }
}

/// Whether the shadow of an outline `columns` pixels wide can be drawn by this method: its penumbra is wide enough, and all
/// sums stay exact.
pub(crate) fn suits(radius: f64, levels: f64, columns: f64) -> bool {
    let pitch = radius / cubic::steps(levels);
    radius >= narrowest(levels) && sums::are_exact(radius, pitch, columns)
}

/// The least penumbra radius, in pixels, for which cells of a pixel's width keep a tolerance. Where an upright edge halves a
/// cell at the disc's end, linear sums are wrong by a quarter of it along sqrt(8 r) pixels: 57 r^-1.5 levels.
pub(crate) fn narrowest(levels: f64) -> f64 {
    let share = 0.56 * levels;
    libm::cbrt((57.0 / share) * (57.0 / share))
}

/// Gives `sink` the density of every pixel of the grid that is in the shadow of an outline and not hidden; `radius` in pixels.
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
    let frame = Frame::new(bounds, radius, grid);
    let [columns, lines] = frame.pixels();
    if columns.is_empty() || lines.is_empty() {
        return;
    }
    let placed = |unit: f64| {
        edges
            .iter()
            .map(move |edge| edge.mapped(frame.scale / unit, |p| frame.place(p) / unit))
    };
    let levels = options.tolerance.as_levels();
    let place = Place::new(&frame, radius, levels, &columns);
    let Scratch {
        rows: pixel_rows,
        grid: kept,
        wanted,
        ..
    } = scratch;
    kept.woven.tips.clear();
    let tips = placed(1.0).filter_map(|edge| place.tip(&edge));
    kept.woven.tips.extend(tips);
    let width = frame.extent.x - 2.0 * radius;
    let source = SumSource::new(placed(radius), &place, width, &mut kept.sums);
    let mut weaver = Weaver {
        source,
        kept: &mut kept.woven,
        columns: columns.clone(),
        first: place.first,
        blocks: place.blocks,
        next: i64::MIN,
        cell: None,
        limits: [LIMIT, END_LIMIT].map(|limit| (limit * levels / 255.0) as f32),
        near: place.pitch.ceil() as i64,
    };
    let origin = frame.first[0];
    let pixels = place.lattice();
    let mut loaded = false;
    for line in lines {
        let number = (line - frame.first[1]) as u32;
        seen_columns(options.hidden, number, &frame, &columns, wanted);
        if wanted.is_empty() {
            continue;
        }
        let y = line as f64 + frame.phase.y + 0.5;
        let woven = weaver.go_to(simd, y / place.pitch, number, origin);
        for wanted in wanted.iter() {
            weaver.give_between(simd, &woven, wanted, sink);
        }
        if weaver.kept.coarse.is_empty() {
            continue;
        }
        if !loaded {
            pixel_rows.load(placed(radius), Window::Disc, &Points::CENTER);
            loaded = true;
        }
        pixel_rows.go_to(y / radius, columns.clone(), &pixels, &Points::CENTER);
        pixel_rows.clear();
        for coarse in &weaver.kept.coarse {
            for wanted in wanted.iter() {
                let part = coarse.start.max(wanted.start)..coarse.end.min(wanted.end);
                if !part.is_empty() {
                    pixel_rows.compute(simd, part, &pixels, &Points::CENTER);
                }
            }
        }
        pixel_rows.give(number, &columns, origin, sink);
    }
}
