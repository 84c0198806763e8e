//! Densities on a fine lattice, tile by tile: for samples so near to one another that many fall on each piece of an outline.
//!
//! To the discs about a tile of four by four samples a short piece is nearly always wholly beside them or wholly within. What it adds
//! then is a difference of one function of its ends' y, or linear in x, so it is kept as what changes from tile to tile. The closed form
//! is left to the tiles about whose discs' edges the piece lies, one vector for each.
//!
//! All is in units of the disc's radius.

use core::f32::consts::FRAC_1_PI;
use core::iter::once;

use fearless_simd::{Simd, SimdBase, f32x16};
use glam::DVec2;

use super::lanes::LANES;
use super::rows::{self, arc_chord, each_line, half_discs, line_at};
use crate::outline::Edge;

/// Samples along a tile's sides.
const SIDE: usize = 4;

/// From a tile's middle to its outer samples, in samples.
const REACH: f64 = (SIDE as f64 - 1.0) / 2.0;

/// What lies beside a disc is counted in units of 2^-28 of density. Sums of them may pass what the numbers hold: along closed loops they
/// come back.
const UNIT: f32 = (1_u32 << 28) as f32;

/// How far lines in place of an arc may move a density: 0.02 level.
const ARCS: f64 = 8e-5;

/// How near to the disc's an arc's radius is, over it, where the disc's edge runs along many of those lines at once.
const ALONG: f64 = 0.2;

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

/// A line, which is not level.
#[derive(Debug, Clone, Copy)]
struct Piece {
    low: f64,
    high: f64,
    from: DVec2,
    to: DVec2,
    along: DVec2,
    length: f64,
    /// The x that it gains with y, and half of the chord that it cuts from the unit disc's row.
    slope: f64,
    width: f64,
}

/// The tiles of a row from which a piece is seen as one thing and another: right of all discs before the first, cut from the first to
/// the second and from the third to the fourth, inside between, and left of all from the fourth on.
type Parts = [usize; 4];

/// What is left from lattice to lattice: memory.
#[derive(Debug, Default)]
pub(crate) struct Tiles {
    /// From the top down.
    pieces: Vec<Piece>,
    /// Those that a row of tiles may meet.
    active: Vec<u32>,
    /// What pieces cut of the discs of each tile.
    cut: Vec<[f32; LANES]>,
    /// What changes from tile to tile of what lies beside, row by row of samples.
    beside: Vec<[i32; SIDE]>,
    /// The same of the area inside: about the lattice's first column, and how much less of it there is with x.
    inside: Vec<[f64; 2]>,
}

/// How far lines in place of an edge may move a density where one of them lies across the disc's edge.
fn share(edge: &Edge) -> f64 {
    match edge {
        Edge::Arc(arc) if (arc.radius - 1.0).abs() < ALONG => {
            // So many may lie there at once, as many again of another arc about the same centre. Each leaves what goes with the third
            // power of its length, and there are more the shorter they are.
            let count = 2.0 * arc.sweep.abs() * arc.radius / arc_chord(arc.radius, ARCS);
            let count = count.max(1.0);
            ARCS / (count * count.sqrt())
        }
        _ => ARCS,
    }
}

/// The places of a tile's samples about its middle.
struct Places<S: Simd> {
    x: f32x16<S>,
    y: f32x16<S>,
}

impl Tiles {
    /// Takes edges; `place` puts a point in units of the radius about the lattice's first sample.
    fn load(&mut self, edges: &[Edge], scale: f64, place: impl Fn(DVec2) -> DVec2 + Copy) {
        self.pieces.clear();
        let mut push = |from: DVec2, to: DVec2| {
            // A level line adds nothing: its ends' neighbours tell of it.
            if from.y == to.y {
                return;
            }
            let length = (to - from).length();
            let along = (to - from) / length;
            self.pieces.push(Piece {
                low: from.y.min(to.y),
                high: from.y.max(to.y),
                from,
                to,
                along,
                length,
                slope: along.x / along.y,
                width: 1.0 / along.y.abs(),
            });
        };
        for edge in edges {
            let edge = edge.mapped(scale, place);
            each_line(once(edge), share(&edge), &mut push);
        }
        rows::sort(&mut self.pieces, |p| [p.low, p.high, p.from.x, p.to.x]);
    }

    /// Puts the densities of an outline at all samples of a lattice, row by row. Its columns and rows are multiples of a tile's side and one
    /// more: the last of each are beyond the shadow.
    // One copy a SIMD level.
    #[inline(never)]
    pub(crate) fn fill<S: Simd>(
        &mut self,
        simd: S,
        edges: &[Edge],
        radius: f64,
        lattice: &Lattice,
        densities: &mut [f32],
    ) {
        let scale = 1.0 / radius;
        self.load(edges, scale, |point| (point - lattice.corner) * scale);
        self.draw(simd, lattice.pitch * scale, lattice.size, densities);
    }

    /// Puts the densities of the same outline in the middles between the samples, to the right of each and below.
    // One copy a SIMD level.
    #[inline(never)]
    pub(crate) fn fill_middles<S: Simd>(
        &mut self,
        simd: S,
        radius: f64,
        lattice: &Lattice,
        densities: &mut [f32],
    ) {
        let step = lattice.pitch / radius;
        for piece in &mut self.pieces {
            for y in [&mut piece.low, &mut piece.high] {
                *y -= step / 2.0;
            }
            for end in [&mut piece.from, &mut piece.to] {
                *end -= step / 2.0;
            }
        }
        self.draw(simd, step, lattice.size, densities);
    }

    #[inline(always)]
    fn draw<S: Simd>(
        &mut self,
        simd: S,
        step: f64,
        [columns, rows]: [usize; 2],
        densities: &mut [f32],
    ) {
        self.active.clear();
        let mut reached = 0;
        for row in 0..rows / SIDE {
            let middle = (row * SIDE) as f64 * step + REACH * step;
            let reach = 1.0 + REACH * step;
            while let Some(piece) = self.pieces.get(reached).filter(|p| p.low < middle + reach) {
                if piece.high > middle - reach {
                    self.active.push(reached as u32);
                }
                reached += 1;
            }
            let pieces = &self.pieces;
            self.active
                .retain(|&index| pieces[index as usize].high > middle - reach);
            let start = row * SIDE * columns;
            let densities = &mut densities[start..start + SIDE * columns];
            if self.active.is_empty() {
                densities.fill(0.0);
                continue;
            }
            simd.vectorize(
                #[inline(always)]
                || {
                    self.add_pieces(simd, middle, step, columns / SIDE);
                    self.give(step, densities);
                },
            );
        }
        densities[(rows - 1) * columns..].fill(0.0);
    }

    /// Adds up what the active pieces are to a row of tiles about the y given.
    #[inline(always)]
    fn add_pieces<S: Simd>(&mut self, simd: S, middle: f64, step: f64, tiles: usize) {
        let Self {
            pieces,
            active,
            cut,
            beside,
            inside,
        } = self;
        cut.clear();
        cut.resize(tiles, [0.0; LANES]);
        beside.clear();
        beside.resize(tiles + 1, [0; SIDE]);
        inside.clear();
        inside.resize(tiles + 1, [0.0; 2]);
        let (mut xs, mut ys) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            xs[lane] = (((lane % SIDE) as f64 - REACH) * step) as f32;
            ys[lane] = (((lane / SIDE) as f64 - REACH) * step) as f32;
        }
        let places = Places {
            x: f32x16::from_slice(simd, &xs),
            y: f32x16::from_slice(simd, &ys),
        };
        for &index in &*active {
            let piece = &pieces[index as usize];
            let from = f32x16::splat(simd, (piece.from.y - middle) as f32) - places.y;
            let to = f32x16::splat(simd, (piece.to.y - middle) as f32) - places.y;
            let halves = [half_discs(simd, from), half_discs(simd, to)];
            let [first, enters, leaves, last] = piece.parts(middle, step, tiles);
            let (mut from, mut to) = ([0.0; LANES], [0.0; LANES]);
            halves[0].store_slice(&mut from);
            halves[1].store_slice(&mut to);
            for place in [first, last] {
                for (row, change) in beside[place].iter_mut().enumerate() {
                    let lane = row * SIDE;
                    // Each end is rounded alone, so that what follows cancels it.
                    let risen = (to[lane] * UNIT) as i32 - (from[lane] * UNIT) as i32;
                    *change = change.wrapping_sub(risen);
                }
            }
            let rise = piece.to.y - piece.from.y;
            let area = (piece.from.x + piece.to.x) * 0.5 * rise;
            inside[enters][0] += area;
            inside[enters][1] += rise;
            inside[leaves][0] -= area;
            inside[leaves][1] -= rise;
            let along = piece.along.as_vec2().to_array();
            let length = piece.length as f32;
            // Relative to a tile's middle by double precision.
            let distance_at = places.y * along[0] - places.x * along[1];
            let start_at = -(places.x * along[0] + places.y * along[1]);
            for tiles in [first..enters, leaves..last] {
                for tile in tiles {
                    let x = ((tile * SIDE) as f64 + REACH) * step;
                    let seen = piece.from - DVec2::new(x, middle);
                    let distance = distance_at + seen.perp_dot(piece.along) as f32;
                    let start = start_at + seen.dot(piece.along) as f32;
                    let added = line_at(simd, distance, start, length, along, halves);
                    let sum = f32x16::from_slice(simd, &cut[tile]) + added;
                    sum.store_slice(&mut cut[tile]);
                }
            }
        }
    }

    /// Adds up what is seen from the tiles of a row, from the left to the right.
    #[inline(always)]
    fn give(&self, step: f64, densities: &mut [f32]) {
        let columns = densities.len() / SIDE;
        let mut beside = [0_i32; SIDE];
        let mut inside = [0.0; 2];
        let changes = self.beside.iter().zip(&self.inside);
        for (tile, (cut, (steps, areas))) in self.cut.iter().zip(changes).enumerate() {
            for row in 0..SIDE {
                beside[row] = beside[row].wrapping_add(steps[row]);
            }
            inside[0] += areas[0];
            inside[1] += areas[1];
            let first = (tile * SIDE) as f64 * step;
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

impl Piece {
    /// What it is to the tiles of a row about the y given.
    #[inline(always)]
    fn parts(&self, middle: f64, step: f64, tiles: usize) -> Parts {
        let spread = REACH * step;
        let (low, high) = (self.low - middle, self.high - middle);
        // Where the part that discs reach is, and half of the chord at the y nearest to theirs.
        let reach = 1.0 + spread;
        let (left_end, right_end) = (self.from.x.min(self.to.x), self.from.x.max(self.to.x));
        let at = |y: f64| {
            let x = self.from.x + (middle + y - self.from.y) * self.slope;
            x.max(left_end).min(right_end)
        };
        let (a, b) = (at(low.max(-reach)), at(high.min(reach)));
        let beyond = (low.max(-high) - spread).max(0.0);
        let half = ((1.0 - beyond) * (1.0 + beyond)).max(0.0).sqrt();
        // A disc farther than 1 from the line does not meet it.
        let crossing = self.from.x + (middle - self.from.y) * self.slope;
        let width = (1.0 + spread * self.along.x.abs()) * self.width;
        let left = (a.min(b) - half).max(crossing - width);
        let right = (a.max(b) + half).min(crossing + width);
        // Where both ends are in all discs.
        let chord = |end: DVec2| {
            let y = (end.y - middle).abs() + spread;
            ((1.0 - y) * (1.0 + y)).max(0.0).sqrt()
        };
        let chords = [chord(self.from), chord(self.to)];
        let enters = (self.from.x - chords[0]).max(self.to.x - chords[1]);
        let leaves = (self.from.x + chords[0]).min(self.to.x + chords[1]);

        let per_tile = 1.0 / (SIDE as f64 * step);
        let wide = (SIDE as f64 - 1.0) * step;
        // The first tile that begins after an x, and the first that does not end before it.
        let begins = |x: f64| ((x * per_tile).ceil().max(0.0) as usize).min(tiles);
        let ends = |x: f64| (((x - wide) * per_tile).floor() + 1.0).max(0.0) as usize;
        let first = ends(left).min(tiles);
        let last = begins(right).max(first);
        let inside = if chords[0] > 0.0 && chords[1] > 0.0 {
            [begins(enters), ends(leaves)].map(|tile| tile.clamp(first, last))
        } else {
            [last; 2]
        };
        if inside[0] < inside[1] {
            [first, inside[0], inside[1], last]
        } else {
            [first, last, last, last]
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

    /// The largest difference from the closed form in double precision at a lattice's samples, in levels.
    fn error(shape: &Shape, radius: f64, pitch: f64) -> f64 {
        let outline = Outline::of_simple(shape).unwrap();
        let edges: Vec<Edge> = outline.edges().copied().collect();
        let (min, max) = outline.bounds().unwrap();
        let corner = min - (radius + 2.0 * pitch);
        let size = (max + (radius + 2.0 * pitch) - corner) / (pitch * SIDE as f64);
        let [columns, rows] = [size.x, size.y].map(|count| count.ceil() as usize * SIDE + 1);
        let mut densities = vec![f32::NAN; columns * rows];
        let lattice = Lattice {
            corner,
            pitch,
            size: [columns, rows],
        };
        let mut tiles = Tiles::default();
        dispatch!(Level::new(), simd => tiles.fill(simd, &edges, radius, &lattice, &mut densities));
        let lines = edges.iter().all(|edge| matches!(edge, Edge::Line(_)));
        let mut worst: f64 = 0.0;
        for (i, &density) in densities.iter().enumerate() {
            let sample = DVec2::new((i % columns) as f64, (i / columns) as f64);
            let exact = at_point(edges.iter(), corner + sample * pitch, radius);
            worst = worst.max((f64::from(density) - exact).abs() * 255.0);
            // Where there is nothing, or all, rounding leaves next to nothing.
            if lines && (exact == 0.0 || exact == 1.0) {
                assert!(
                    (f64::from(density) - exact).abs() < 2e-6,
                    "{density}, {exact}"
                );
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
