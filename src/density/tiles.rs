//! Densities on a fine lattice, tile by tile: for samples so near to one another that many fall on each piece of an outline.
//!
//! To the discs about a tile of four by four samples a short piece is nearly always wholly beside them or wholly within. What it adds
//! then is a difference of one function of its ends' y, or linear in x, so it is kept as what changes from tile to tile. The closed form
//! is left to the tiles about whose discs' edges the piece lies, one vector for each.
//!
//! All is in units of the disc's radius.

mod pieces;
mod places;

use core::f32::consts::FRAC_1_PI;

use fearless_simd::{Simd, SimdBase, SimdCombine, SimdFloat, f32x8, f32x16, i32x16};
use glam::DVec2;

use super::lanes::{LANES, spread};
use super::rows::{half_discs, line_at};
use super::sweep::Sweep;
use crate::outline::Edge;
use pieces::Piece;
use places::Places;

/// Samples along a tile's sides.
pub(crate) const SIDE: usize = 4;

/// Places to a sample, at most: memory is taken for so many.
pub(crate) const PLACES: usize = 6;

/// From a tile's middle to its outer samples, in samples.
const REACH: f64 = (SIDE as f64 - 1.0) / 2.0;

/// What lies beside a disc is counted in units of 2^-28 of density. Sums of them may pass what the numbers hold: along closed loops they
/// come back.
const UNIT: f32 = (1_u32 << 28) as f32;

/// The largest error from rounding, from polynomials and from lines in place of arcs, in levels.
pub(crate) const ROUNDING: f64 = 0.05;

/// Where samples are, in scene units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lattice {
    /// The first sample, and from each to the next.
    pub(crate) corner: DVec2,
    pub(crate) pitch: f64,
    /// Columns and rows of samples.
    pub(crate) size: [usize; 2],
}

/// What is left from lattice to lattice: memory.
#[derive(Debug, Default)]
pub(crate) struct Tiles {
    /// From the top down.
    pieces: Vec<Piece>,
    sweep: Sweep,
    /// What pieces cut of the discs of each tile, place by place.
    cut: Vec<[f32; LANES]>,
    /// What changes from tile to tile of what lies beside, row by row of samples.
    beside: Vec<[i32; SIDE]>,
    /// The same of the area inside: about the lattice's first column, and how much less of it there is with x.
    inside: Vec<[f64; 2]>,
}

impl Tiles {
    /// Takes the outline whose densities are drawn from then on.
    pub(crate) fn load(&mut self, edges: &[Edge], radius: f64, lattice: &Lattice) {
        pieces::cut(edges, radius, lattice, &mut self.pieces);
    }

    /// Puts densities at `offsets` from all samples of a lattice, in samples and not less than 0, row by row, or from those in the tiles
    /// alone that are wanted, if that is told: what is put elsewhere is undefined. The lattice's columns and rows are multiples of a
    /// tile's side and one more: the last of each are beyond the shadow.
    // One copy a SIMD level.
    #[inline(never)]
    pub(crate) fn fill<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        radius: f64,
        lattice: &Lattice,
        offsets: [[f64; 2]; N],
        wanted: Option<&[bool]>,
        mut densities: [&mut [f32]; N],
    ) {
        let step = lattice.pitch / radius;
        let places = Places::new(offsets, step);
        let [columns, rows] = lattice.size;
        let tiles = columns / SIDE;
        self.sweep.rewind();
        for row in 0..rows / SIDE {
            let top = (row * SIDE) as f64 * step;
            let middle = top + places.reach();
            let reach = 1.0 + places.reach();
            let reached = [middle - reach, middle + reach];
            self.sweep.go_to(&self.pieces, reached, |p| [p.low, p.high]);
            let wanted = wanted.map(|wanted| &wanted[row * tiles..][..tiles]);
            if wanted.is_some_and(|wanted| !wanted.contains(&true)) {
                continue;
            }
            let rows = row * SIDE * columns..(row + 1) * SIDE * columns;
            if self.sweep.active().is_empty() {
                for densities in &mut densities {
                    densities[rows.clone()].fill(0.0);
                }
                continue;
            }
            simd.vectorize(
                #[inline(always)]
                || {
                    self.add_pieces(simd, top, &places, tiles, wanted);
                    for (place, densities) in densities.iter_mut().enumerate() {
                        self.give(&places, place, &mut densities[rows.clone()]);
                    }
                },
            );
        }
        for densities in densities {
            densities[(rows - 1) * columns..].fill(0.0);
        }
    }

    /// Adds up what the active pieces are to a row of tiles whose first samples have the y given.
    #[inline(always)]
    fn add_pieces<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        top: f64,
        places: &Places<N>,
        tiles: usize,
        wanted: Option<&[bool]>,
    ) {
        let Self {
            pieces,
            sweep,
            cut,
            beside,
            inside,
        } = self;
        let step = places.step;
        let middle = top + REACH * step;
        cut.clear();
        cut.reserve(tiles * PLACES);
        cut.resize(tiles * N, [0.0; LANES]);
        beside.clear();
        beside.reserve((tiles + 1) * PLACES);
        beside.resize((tiles + 1) * N, [0; SIDE]);
        inside.clear();
        inside.resize(tiles + 1, [0.0; 2]);
        let load = |numbers: &[f32; LANES]| f32x16::from_slice(simd, numbers);
        let (xs, ys) = (
            places.xs.each_ref().map(load),
            places.ys.each_ref().map(load),
        );
        let downs = places.downs.each_ref().map(load);
        let zero = f32x16::splat(simd, 0.0);
        let (mut rows, mut units) = ([[0.0; LANES]; N], [[0; LANES]; N]);
        for &index in sweep.active() {
            let piece = &pieces[index as usize];
            let [first, enters, leaves, last] = piece.parts(top, places, tiles);
            let along = piece.slant.along.as_vec2().to_array();
            let length = piece.slant.length as f32;
            let (mut halves, mut distance_at, mut start_at) =
                ([[zero; 2]; N], [zero; N], [zero; N]);
            let ends = [piece.from.y, piece.to.y].map(|y| (y - middle) as f32);
            let ends = f32x8::splat(simd, ends[0]).combine(f32x8::splat(simd, ends[1]));
            for pair in 0..N.div_ceil(2) {
                let halves = half_discs(simd, ends - downs[pair]);
                halves.store_slice(&mut rows[pair]);
                // Each end is rounded alone, so that what follows cancels it.
                let whole: i32x16<S> = (halves * UNIT).to_int();
                whole.store_slice(&mut units[pair]);
            }
            for place in 0..N {
                let first_row = place % 2 * SIDE;
                let last_row = LANES / 2 + first_row;
                let ends = [first_row, last_row].map(|row| {
                    let rows = rows[place / 2][row..].first_chunk::<SIDE>();
                    rows.map_or([0.0; SIDE], |rows| *rows)
                });
                let units = &units[place / 2];
                for tile in [first, last] {
                    for (row, change) in beside[tile * N + place].iter_mut().enumerate() {
                        let risen = units[last_row + row] - units[first_row + row];
                        *change = change.wrapping_sub(risen);
                    }
                }
                halves[place] = [spread(simd, ends[0]), spread(simd, ends[1])];
                distance_at[place] = ys[place] * along[0] - xs[place] * along[1];
                start_at[place] = -(xs[place] * along[0] + ys[place] * along[1]);
            }
            let rise = piece.to.y - piece.from.y;
            let area = (piece.from.x + piece.to.x) * 0.5 * rise;
            inside[enters][0] += area;
            inside[enters][1] += rise;
            inside[leaves][0] -= area;
            inside[leaves][1] -= rise;
            for tiles in [first..enters, leaves..last] {
                for tile in tiles {
                    if wanted.is_some_and(|wanted| !wanted[tile]) {
                        continue;
                    }
                    let x = ((tile * SIDE) as f64 + REACH) * step;
                    let seen = piece.from - DVec2::new(x, middle);
                    let (across, ahead) = (
                        seen.perp_dot(piece.slant.along),
                        seen.dot(piece.slant.along),
                    );
                    for place in 0..N {
                        let distance = distance_at[place] + across as f32;
                        let start = start_at[place] + ahead as f32;
                        let added = line_at(simd, distance, start, length, along, halves[place]);
                        let cut = &mut cut[tile * N + place];
                        let sum = f32x16::from_slice(simd, cut) + added;
                        sum.store_slice(cut);
                    }
                }
            }
        }
    }

    /// Adds up what is seen from one of the places of a row of tiles, from the left to the right.
    #[inline(always)]
    fn give<const N: usize>(&self, places: &Places<N>, place: usize, densities: &mut [f32]) {
        let columns = densities.len() / SIDE;
        let step = places.step;
        let mut beside = [0_i32; SIDE];
        let mut inside = [0.0; 2];
        for (tile, areas) in self.inside[..columns / SIDE].iter().enumerate() {
            let (cut, steps) = (&self.cut[tile * N + place], self.beside[tile * N + place]);
            for row in 0..SIDE {
                beside[row] = beside[row].wrapping_add(steps[row]);
            }
            inside[0] += areas[0];
            inside[1] += areas[1];
            let first = (tile * SIDE) as f64 * step + places.offsets[place].x;
            let start = (inside[0] - inside[1] * first) as f32 * FRAC_1_PI;
            let growth = (-inside[1] * step) as f32 * FRAC_1_PI;
            for row in 0..SIDE {
                let at = row * columns + tile * SIDE;
                let out = &mut densities[at..at + SIDE];
                let constant = beside[row] as f32 * (1.0 / UNIT) + start;
                for column in 0..SIDE {
                    let density = cut[row * SIDE + column] + (constant + growth * column as f32);
                    out[column] = density.clamp(0.0, 1.0);
                }
            }
        }
        for row in densities.chunks_exact_mut(columns) {
            row[columns - 1] = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;
    use crate::density::at_point;
    use crate::outline::Outline;
    use crate::path::FillRule;
    use crate::shape::Shape;

    fn shapes() -> Vec<Shape> {
        let star: Vec<[f32; 2]> = (0_u8..14)
            .map(|i| {
                let (sin, cos) = (f32::from(i) * core::f32::consts::TAU / 14.0).sin_cos();
                let radius = [8.0, 3.0][usize::from(i % 2)];
                [10.0 + radius * cos, 7.0 + radius * sin]
            })
            .collect();
        let needle = vec![[0.0, 0.0], [30.0, -0.2], [30.0, 0.3]];
        vec![
            Shape::polygon(&[star], FillRule::NonZero).unwrap(),
            Shape::polygon(&[needle], FillRule::NonZero).unwrap(),
            Shape::rect(3.0, 2.0, 20.0, 9.0).unwrap(),
            Shape::rounded_rect(0.0, 0.0, 12.0, 17.0, [6.0, 0.0, 3.0, 1.0]).unwrap(),
            Shape::circle([5.0, 5.0], 4.0).unwrap(),
        ]
    }

    /// The largest difference from the closed form in double precision at a lattice's samples and beside them, in levels.
    fn error(shape: &Shape, radius: f64, pitch: f64) -> f64 {
        let outline = Outline::of_simple(shape).unwrap();
        let edges: Vec<Edge> = outline.edges().copied().collect();
        let (min, max) = outline.bounds().unwrap();
        let corner = min - (radius + 2.0 * pitch);
        let size = (max + (radius + 2.0 * pitch) - corner) / (pitch * SIDE as f64);
        let [columns, rows] = [size.x, size.y].map(|count| count.ceil() as usize * SIDE + 1);
        let offsets = [[0.0; 2], [0.5, 0.25], [0.75, 0.0]];
        let mut drawn = offsets.map(|_| vec![f32::NAN; columns * rows]);
        let lattice = Lattice {
            corner,
            pitch,
            size: [columns, rows],
        };
        let mut tiles = Tiles::default();
        tiles.load(&edges, radius, &lattice);
        dispatch!(Level::new(), simd => {
            let densities = drawn.each_mut().map(Vec::as_mut_slice);
            tiles.fill(simd, radius, &lattice, offsets, None, densities);
        });
        let lines = edges.iter().all(|edge| matches!(edge, Edge::Line(_)));
        let mut worst: f64 = 0.0;
        for (offset, densities) in offsets.into_iter().zip(drawn) {
            for (i, density) in densities.into_iter().enumerate() {
                let sample = DVec2::new((i % columns) as f64, (i / columns) as f64);
                let place = corner + (sample + DVec2::from(offset)) * pitch;
                let exact = at_point(edges.iter(), place, radius);
                worst = worst.max((f64::from(density) - exact).abs() * 255.0);
                // Where there is nothing, or all, rounding leaves next to nothing.
                if lines && (exact == 0.0 || exact == 1.0) {
                    assert!(
                        (f64::from(density) - exact).abs() < 2e-6,
                        "{density}, {exact}"
                    );
                }
            }
        }
        worst
    }

    #[test]
    fn densities_are_those_of_the_closed_form() {
        for (index, shape) in shapes().iter().enumerate() {
            for radius in [0.5, 1.7, 4.0, 4.3, 6.0, 13.0, 60.0] {
                for samples in [10.0, 22.0, 41.3] {
                    if radius / samples < 0.05 {
                        continue;
                    }
                    let worst = error(shape, radius, radius / samples);
                    println!("shape {index}, radius {radius}, {samples} samples: {worst:.4}");
                    assert!(worst <= ROUNDING, "{index} at {radius}: {worst}");
                }
            }
        }
    }
}
