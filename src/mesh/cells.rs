//! Densities at many points of one shadow, sixteen at once.
//!
//! The plane is cut into cells, halved from the whole shadow down to less than the penumbra radius. The first point in a
//! cell leaves it with the lines that a disc about any of its points can meet, clipped from those of the cell that holds it:
//! what is far away costs nothing.

use core::f32::consts::FRAC_1_PI;
use std::collections::HashMap;

use fearless_simd::{Level, Simd, dispatch};
use glam::DVec2;

use crate::apart::around_points;
use crate::density::lanes::LANES;
use crate::density::rows::half_disc;
use crate::outline::{Edge, clip_to_box, closed_lines};

/// How far densities may be off by single precision: 0.002 level.
pub(super) const NOISE: f64 = 8e-6;

/// The largest side of the smallest cells, in penumbra radii: much smaller ones would hold nearly the same lines.
pub(super) const SIDE: f64 = 0.75;

/// The most halvings: more than `f32` has digits for places.
const MOST_DEPTH: u32 = 30;

pub(super) struct Cells {
    level: Level,
    radius: f64,
    /// The corner of the largest cell, which holds the shadow, and its side.
    min: DVec2,
    side: f64,
    /// How often it is halved.
    depth: u32,
    /// The largest first.
    cells: Vec<Cell>,
    /// Where the others are, by depth and place.
    places: HashMap<(u32, [i64; 2]), usize>,
    spare: Vec<Edge>,
    /// The points that are asked for, each with its cell and its number.
    asked: Vec<(usize, usize)>,
}

#[derive(Debug, Default)]
struct Cell {
    edges: Vec<Edge>,
    /// The same about the cell's middle, for the smallest cells.
    middle: DVec2,
    sides: Vec<Side>,
}

/// A line about a cell's middle, in penumbra radii.
#[derive(Debug, Clone, Copy)]
struct Side {
    from: [f32; 2],
    to: [f32; 2],
    /// Its unit vector.
    along: [f32; 2],
    length: f32,
}

impl Cells {
    /// Of closed loops of lines, seen through a `radius` above 0.
    pub(super) fn new(loops: &[Vec<DVec2>], radius: f64) -> Self {
        let (min, max) = around_points(loops.iter().flatten().copied()).unwrap_or_default();
        let (min, max) = (min - radius, max + radius);
        let side = (max - min).max_element();
        let depth = libm::ceil(libm::log2(side / (radius * SIDE))).clamp(0.0, MOST_DEPTH.into());
        let mut field = Self {
            level: Level::new(),
            radius,
            min,
            side,
            depth: depth as u32,
            cells: vec![Cell {
                edges: loops
                    .iter()
                    .flat_map(|points| closed_lines(points))
                    .collect(),
                ..Cell::default()
            }],
            places: HashMap::new(),
            spare: Vec::new(),
            asked: Vec::new(),
        };
        if field.depth == 0 {
            field.set_sides(0, min + side / 2.0);
        }
        field
    }

    /// The penumbra radius, in the outline's unit.
    pub(super) fn radius(&self) -> f64 {
        self.radius
    }

    /// The density at a point, within [`NOISE`].
    pub(super) fn at(&mut self, point: DVec2) -> f64 {
        let mut density = [0.0];
        self.at_all(&[point], &mut density);
        density[0]
    }

    /// The densities at points, best near to one another.
    pub(super) fn at_all(&mut self, points: &[DVec2], densities: &mut [f64]) {
        let mut asked = core::mem::take(&mut self.asked);
        asked.clear();
        let mut last = None;
        for (number, &point) in points.iter().enumerate() {
            let place = self.place(point);
            let cell = match last {
                Some((same, cell)) if same == place => cell,
                _ => self.cell(self.depth, place),
            };
            last = Some((place, cell));
            asked.push((cell, number));
        }
        asked.sort_unstable();
        let factor = 1.0 / self.radius;
        for asked in asked.chunk_by(|a, b| a.0 == b.0) {
            let cell = &self.cells[asked[0].0];
            for batch in asked.chunks(LANES) {
                let mut at = [[0.0; LANES]; 2];
                for lane in 0..LANES {
                    let (_, number) = batch[lane.min(batch.len() - 1)];
                    let offset = (points[number] - cell.middle) * factor;
                    [at[0][lane], at[1][lane]] = offset.as_vec2().to_array();
                }
                let found = cell.densities(self.level, &at);
                for (&(_, number), density) in batch.iter().zip(found) {
                    densities[number] = f64::from(density);
                }
            }
        }
        self.asked = asked;
    }

    /// The smallest cell at a point.
    fn place(&self, point: DVec2) -> [i64; 2] {
        let count = (1_u64 << self.depth) as f64;
        let place = ((point - self.min) * (count / self.side)).floor();
        [place.x as i64, place.y as i64]
    }

    /// The number of a cell.
    fn cell(&mut self, depth: u32, place: [i64; 2]) -> usize {
        // Points outside of the largest cell have cells of their own, made from it.
        if depth == 0 {
            return 0;
        }
        if let Some(&cell) = self.places.get(&(depth, place)) {
            return cell;
        }
        let parent = self.cell(depth - 1, place.map(|at| at >> 1));
        let side = self.side / (1_u64 << depth) as f64;
        let min = self.min + DVec2::new(place[0] as f64, place[1] as f64) * side;
        let mut clipped = Vec::new();
        clip_to_box(
            &self.cells[parent].edges,
            min - self.radius,
            min + side + self.radius,
            &mut self.spare,
            &mut clipped,
        );
        let number = self.cells.len();
        self.cells.push(Cell {
            edges: clipped,
            ..Cell::default()
        });
        self.places.insert((depth, place), number);
        if depth == self.depth {
            self.set_sides(number, min + side / 2.0);
        }
        number
    }

    /// Makes a cell ready for questions.
    fn set_sides(&mut self, cell: usize, middle: DVec2) {
        let factor = 1.0 / self.radius;
        let cell = &mut self.cells[cell];
        cell.middle = middle;
        let sides = cell.edges.iter().filter_map(|edge| {
            let [from, to] = [edge.from(), edge.to()].map(|end| (end - middle) * factor);
            let length = (to - from).length();
            // Level lines add nothing: their ends' neighbours tell of them.
            (from.y != to.y).then(|| Side {
                from: from.as_vec2().to_array(),
                to: to.as_vec2().to_array(),
                along: ((to - from) / length).as_vec2().to_array(),
                length: length as f32,
            })
        });
        cell.sides = sides.collect();
        if self.depth > 0 {
            cell.edges = Vec::new();
        }
    }
}

impl Cell {
    fn densities(&self, level: Level, at: &[[f32; LANES]; 2]) -> [f32; LANES] {
        let mut sums = [0.0; LANES];
        dispatch!(level, simd => simd.vectorize(#[inline(always)] || self.add(at, &mut sums)));
        sums.map(|sum| sum.clamp(0.0, 1.0))
    }

    /// By Green's theorem: the integral over y of the lines' x, clamped to the discs about the points, over π.
    #[inline(always)]
    fn add(&self, at: &[[f32; LANES]; 2], sums: &mut [f32; LANES]) {
        let least = |values: &[f32; LANES]| values.iter().copied().fold(f32::INFINITY, f32::min);
        let most = |values: &[f32; LANES]| values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let min = at.each_ref().map(least);
        let max = at.each_ref().map(most);
        // Where the last line ended, and `half_disc` there.
        let (mut end, mut halves) = ([f32::NAN; 2], [0.0; LANES]);
        for side in &self.sides {
            let Side { from, to, .. } = *side;
            if from[1].min(to[1]) >= max[1] + 1.0 || from[1].max(to[1]) <= min[1] - 1.0 {
                continue;
            }
            if end != from {
                for lane in 0..LANES {
                    halves[lane] = half_disc(from[1] - at[1][lane]);
                }
            }
            let before = halves;
            for lane in 0..LANES {
                halves[lane] = half_disc(to[1] - at[1][lane]);
            }
            end = to;
            let right = from[0].min(to[0]) >= max[0] + 1.0;
            if right || from[0].max(to[0]) <= min[0] - 1.0 {
                let sign = if right { 1.0 } else { -1.0 };
                for lane in 0..LANES {
                    sums[lane] += sign * (halves[lane] - before[lane]);
                }
                continue;
            }
            for lane in 0..LANES {
                let start = [from[0] - at[0][lane], from[1] - at[1][lane]];
                let halves = [before[lane], halves[lane]];
                sums[lane] += line_area(start, side.along, side.length, halves);
            }
        }
    }
}

/// The same of one line that begins at `start`, seen from a disc's centre, and leads in the direction of the unit vector `along`, with
/// [`half_disc`] at its two ends.
#[inline(always)]
pub(super) fn line_area(start: [f32; 2], along: [f32; 2], length: f32, halves: [f32; 2]) -> f32 {
    let [along_x, along_y] = along;
    // From the line's start: the foot of the centre, and where the line enters the disc and leaves it. A line that
    // misses the disc turns from before to after at its foot.
    let distance = start[0] * along_y - start[1] * along_x;
    let foot = -(start[0] * along_x + start[1] * along_y);
    let half_chord = (1.0 - distance * distance).max(0.0).sqrt();
    let enter = (foot - half_chord).max(0.0).min(length) - foot;
    let leave = (foot + half_chord).max(0.0).min(length) - foot;
    let (foot_x, foot_y) = (distance * along_y, -distance * along_x);
    let inside = (foot_x + 0.5 * along_x * (enter + leave)) * along_y * (leave - enter);
    // Outside it lies on one side of the disc as a whole.
    let before = half_disc(foot_y + along_y * enter) - halves[0];
    let after = halves[1] - half_disc(foot_y + along_y * leave);
    let chord_x = along_x * half_chord;
    let sides = [foot_x - chord_x, foot_x + chord_x].map(|x| 1.0_f32.copysign(x));
    inside * FRAC_1_PI + before * sides[0] + after * sides[1]
}

#[cfg(test)]
mod tests {
    use super::super::lighten::lighten;
    use super::*;
    use crate::density::at_point;
    use crate::outline::Outline;
    use crate::path::FillRule;
    use crate::shape::Shape;

    fn outline(shape: &Shape) -> Outline {
        Outline::of_simple(shape).unwrap()
    }

    fn star() -> Shape {
        let ring: Vec<[f32; 2]> = (0_u8..60)
            .map(|i| {
                let angle = f32::from(i) * core::f32::consts::TAU / 60.0;
                let radius = if i % 2 == 0 { 50.0 } else { 30.0 };
                [radius * angle.cos(), radius * angle.sin()]
            })
            .collect();
        Shape::polygon(&[ring], FillRule::NonZero).unwrap()
    }

    /// The largest error over and beside the shape, in density.
    fn error(outline: &Outline, loops: &[Vec<DVec2>], radius: f64) -> f64 {
        let mut field = Cells::new(loops, radius);
        let (min, max) = outline.bounds().unwrap();
        let (min, size) = (min - 1.3 * radius, max - min + 2.6 * radius);
        let point = |i: u32| DVec2::new(f64::from(i % 61), f64::from(i / 61)) / 60.0;
        let points: Vec<DVec2> = (0..61 * 61).map(|i| min + size * point(i)).collect();
        let mut densities = vec![0.0; points.len()];
        field.at_all(&points, &mut densities);
        let error = |(&point, density): (&DVec2, f64)| {
            (density - at_point(outline.edges(), point, radius)).abs()
        };
        points.iter().zip(densities).map(error).fold(0.0, f64::max)
    }

    #[test]
    fn lines_have_the_closed_forms_densities() {
        for radius in [0.4, 3.0, 17.0, 200.0] {
            let outline = outline(&star());
            let error = error(&outline, &outline.polygons(1.0), radius);
            assert!(error <= NOISE, "r {radius}: {error:e}");
        }
    }

    #[test]
    fn curves_of_fewer_lines_have_the_same_densities() {
        for radius in [0.2, 1.0, 4.0, 10.0, 12.0, 40.0] {
            for shape in [
                Shape::circle([3.0, 4.0], 10.0).unwrap(),
                Shape::rounded_rect(0.0, 0.0, 50.0, 30.0, 12.0).unwrap(),
            ] {
                let outline = outline(&shape);
                let change = 0.02 / 255.0;
                let loops = outline.polygons(0.5 * core::f64::consts::PI * radius * change);
                let light: Vec<_> = loops.iter().map(|p| lighten(p, radius, change)).collect();
                let error = error(&outline, &light, radius);
                let counts = [&loops, &light].map(|loops| loops[0].len());
                println!(
                    "r {radius}: {counts:?} vertices, {:.4} level",
                    error * 255.0
                );
                assert!(error <= 4.2 * change + NOISE, "r {radius}: {error:e}");
                // Where the disc's edge runs along the circle there is nothing to gain.
                let gain = (1.0..=4.0).contains(&radius);
                assert!(counts[1] * if gain { 2 } else { 1 } <= counts[0] + 16);
            }
        }
    }
}
