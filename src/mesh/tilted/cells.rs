//! Densities at many points of a tilted caster's shadow, sixteen at once.
//!
//! As for [level casters](crate::mesh::cells) the plane is cut into cells, but where the caster is near its receiver they are
//! smaller: each is quartered until it is less than the penumbra radii in it. Lines of homogeneous circles are cut where all discs
//! of a cell end, which are planes too.

use core::f64::consts::PI;

use fearless_simd::{Level, Simd, dispatch};
use glam::DVec2;
use libm::{ceil, log2};

use crate::density::half_area;
use crate::density::lanes::LANES;
use crate::density::rows::half_disc;
use crate::mesh::cells::{SIDE, line_area};
use crate::tilted::Circle;

/// How often cells of the size for the radius that samples go by are quartered again: where the caster touches its receiver no cell is
/// small enough, and to make cells for a few samples each takes longer than the closed form.
const FINER: f64 = 2.0;

/// The most that cells are quartered: more than `f32` has digits for places.
const MOST_DEPTH: f64 = 30.0;

/// The largest side of the smallest cells, in the radii of what is beside all of their discs: single precision tells there how far up
/// ends are within some 1e-6 radii.
const SIDE_BESIDE: f64 = 8.0;

/// The number of no cell.
const NONE: usize = usize::MAX;

pub(in crate::mesh) struct TiltedCells {
    level: Level,
    /// The corner of the largest cell, which holds the shadow, and its side.
    min: DVec2,
    side: f64,
    /// How often it is quartered at most.
    depth: u32,
    /// The largest first.
    cells: Vec<Cell>,
    /// The points that are asked for, each with its cell and its number.
    asked: Vec<(usize, usize)>,
}

#[derive(Debug)]
struct Cell {
    middle: DVec2,
    /// Half its side.
    half: f64,
    lines: Vec<Line>,
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    /// With its four quarters, or [`NONE`] where no point was asked for yet.
    Quartered([usize; 4]),
    /// Small enough for its lines.
    Smallest(Vec<Seen>),
    /// As small as cells get, and larger than a radius in it.
    Touched,
}

/// A line from circle to circle, and where it is.
#[derive(Debug, Clone, Copy)]
struct Line {
    ends: [Circle; 2],
    place: Place,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// Discs may meet it.
    Near,
    /// Left (-1) or right (1) of all discs about a cell's points.
    Beside(f32),
}

/// The same as it is seen from a cell's middle.
#[derive(Debug, Clone, Copy)]
struct Seen {
    ends: [End; 2],
    place: Place,
}

/// Where a circle is on the light's unit disc, and by how much that moves with a step away from a cell's middle.
#[derive(Debug, Clone, Copy, PartialEq)]
struct End {
    at: [f32; 2],
    motion: f32,
}

impl TiltedCells {
    /// Of closed loops in the box from `min` to `max`, of which samples are asked for as near to one another as suits `radius`.
    pub(in crate::mesh) fn new(loops: &[Vec<Circle>], [min, max]: [DVec2; 2], radius: f64) -> Self {
        let lines = |circles: &Vec<Circle>| {
            let next = circles.iter().cycle().skip(1);
            let line = |(&from, &to)| Line {
                ends: [from, to],
                place: Place::Near,
            };
            circles.iter().zip(next).map(line).collect::<Vec<_>>()
        };
        let side = (max - min).max_element();
        let lines = loops.iter().flat_map(lines).collect();
        let depth = ceil(log2(side / (radius * SIDE))) + FINER;
        let depth = depth.clamp(0.0, MOST_DEPTH) as u32;
        Self {
            level: Level::new(),
            cells: vec![Cell::new(min + side / 2.0, side / 2.0, lines, depth)],
            min,
            side,
            depth,
            asked: Vec::new(),
        }
    }

    /// The density at a point, within [`NOISE`](crate::mesh::cells::NOISE).
    pub(in crate::mesh) fn at(&mut self, point: DVec2) -> f64 {
        let mut density = [0.0];
        self.at_all(&[point], &mut density);
        density[0]
    }

    /// The densities at points, best near to one another.
    pub(in crate::mesh) fn at_all(&mut self, points: &[DVec2], densities: &mut [f64]) {
        let mut asked = core::mem::take(&mut self.asked);
        asked.clear();
        let mut last = NONE;
        for (number, &point) in points.iter().enumerate() {
            let from_corner = point - self.min;
            if from_corner.min_element() < 0.0 || from_corner.max_element() > self.side {
                densities[number] = 0.0;
                continue;
            }
            if self.cells.get(last).is_none_or(|cell| !cell.holds(point)) {
                last = self.cell(point);
            }
            asked.push((last, number));
        }
        asked.sort_unstable();
        for asked in asked.chunk_by(|a, b| a.0 == b.0) {
            let cell = &self.cells[asked[0].0];
            let Kind::Smallest(lines) = &cell.kind else {
                for &(_, number) in asked {
                    densities[number] = cell.density(points[number]);
                }
                continue;
            };
            for batch in asked.chunks(LANES) {
                let mut at = [[0.0; LANES]; 2];
                for lane in 0..LANES {
                    let (_, number) = batch[lane.min(batch.len() - 1)];
                    [at[0][lane], at[1][lane]] =
                        (points[number] - cell.middle).as_vec2().to_array();
                }
                let found = Seen::densities(lines, self.level, &at);
                for (&(_, number), density) in batch.iter().zip(found) {
                    densities[number] = f64::from(density);
                }
            }
        }
        self.asked = asked;
    }

    /// The number of the smallest cell at a point of the largest.
    fn cell(&mut self, point: DVec2) -> usize {
        let (mut number, mut depth) = (0, 0);
        while let Kind::Quartered(quarters) = self.cells[number].kind {
            let cell = &self.cells[number];
            depth += 1;
            let [right, above] = [0, 1].map(|axis| point[axis] >= cell.middle[axis]);
            let quarter = usize::from(right) + 2 * usize::from(above);
            let mut next = quarters[quarter];
            if next == NONE {
                next = self.cells.len();
                let half = cell.half / 2.0;
                let away = |far: bool| if far { half } else { -half };
                let middle = cell.middle + DVec2::new(away(right), away(above));
                let lines = near(&cell.lines, middle, half);
                let cell = Cell::new(middle, half, lines, self.depth - depth);
                self.cells.push(cell);
                if let Kind::Quartered(quarters) = &mut self.cells[number].kind {
                    quarters[quarter] = next;
                }
            }
            number = next;
        }
        number
    }
}

impl Cell {
    /// That may be quartered so many times.
    fn new(middle: DVec2, half: f64, mut lines: Vec<Line>, times: u32) -> Self {
        let is_small = lines.iter().all(|line| {
            let most = match line.place {
                Place::Near => SIDE,
                Place::Beside(_) => SIDE_BESIDE,
            };
            let is_small = |end: &Circle| 2.0 * half * end.scale <= most * end.radius;
            line.ends.iter().all(is_small)
        });
        let kind = if is_small {
            let lines = lines.drain(..);
            Kind::Smallest(lines.map(|line| line.seen_from(middle)).collect())
        } else if times == 0 {
            Kind::Touched
        } else {
            Kind::Quartered([NONE; 4])
        };
        Self {
            middle,
            half,
            lines,
            kind,
        }
    }

    /// The density at one of its points where it is not small enough.
    fn density(&self, point: DVec2) -> f64 {
        let area = |line: &Line| {
            let [from, to] = line.ends.each_ref().map(|end| end.seen_from(point));
            if from.y.min(to.y) >= 1.0 || from.y.max(to.y) <= -1.0 {
                return 0.0;
            }
            match line.place {
                Place::Near => area_left_of(from, to),
                Place::Beside(sign) => f64::from(sign) * (half_area(to.y) - half_area(from.y)),
            }
        };
        (self.lines.iter().map(area).sum::<f64>().abs() / PI).min(1.0)
    }

    fn holds(&self, point: DVec2) -> bool {
        let way = point - self.middle;
        // As quarters are chosen: what lies between two belongs to the one beyond.
        let is_within = |way: f64| -self.half <= way && way < self.half;
        is_within(way.x) && is_within(way.y)
    }
}

/// What of lines the discs about a cell's points may meet, and what is left or right of them.
fn near(lines: &[Line], middle: DVec2, half: f64) -> Vec<Line> {
    let mut kept: Vec<Line> = Vec::new();
    // How far a circle is right or left of all discs, or above or below: linear along lines.
    let beyond = |circle: &Circle, axis: usize, sign: f64| {
        sign * (circle.center[axis] - circle.scale * middle[axis])
            - circle.scale * half
            - circle.radius
    };
    let beside = |sign: f64| Place::Beside(sign as f32);
    for &line in lines {
        let is_out = |sign: f64| line.ends.iter().all(|end| beyond(end, 1, sign) >= 0.0);
        if is_out(1.0) || is_out(-1.0) {
            continue;
        }
        if line.place != Place::Near {
            push(line, &mut kept);
            continue;
        }
        // What is above or below all discs spans nothing of them.
        let mut inside = line;
        for sign in [1.0, -1.0] {
            if let Some((end, cut)) = inside.cut(|circle| beyond(circle, 1, sign)) {
                inside.ends[end] = cut;
            }
        }
        for sign in [1.0, -1.0] {
            if inside.ends.iter().all(|end| beyond(end, 0, sign) >= 0.0) {
                inside.place = beside(sign);
            }
        }
        let mut parts = [None; 3];
        if inside.place == Place::Near {
            for sign in [1.0, -1.0] {
                if let Some((end, cut)) = inside.cut(|circle| beyond(circle, 0, sign)) {
                    let mut part = Line {
                        place: beside(sign),
                        ..inside
                    };
                    part.ends[1 - end] = cut;
                    inside.ends[end] = cut;
                    parts[2 * end] = Some(part);
                }
            }
        }
        parts[1] = Some(inside);
        for part in parts.into_iter().flatten() {
            push(part, &mut kept);
        }
    }
    kept
}

/// Adds a line, joined to the one before it if that ends there and both are on one side of all discs.
fn push(line: Line, kept: &mut Vec<Line>) {
    if let Some(last) = kept.last_mut()
        && line.place != Place::Near
        && last.place == line.place
        && last.ends[1] == line.ends[0]
    {
        last.ends[1] = line.ends[1];
    } else {
        kept.push(line);
    }
}

/// By Green's theorem: the integral over y of a line's x, clamped to the unit disc.
fn area_left_of(from: DVec2, to: DVec2) -> f64 {
    // The far one of two ends may be so far away that it has no digits left for the disc.
    if to.length_squared() < from.length_squared() {
        return -area_left_of(to, from);
    }
    let way = to - from;
    let length = way.length();
    if length == 0.0 {
        return 0.0;
    }
    // As `line_area`.
    let along = way / length;
    let distance = from.perp_dot(along);
    let start = from.dot(along);
    let half_chord = (1.0 - distance * distance).max(0.0).sqrt();
    let enter = (-half_chord).max(start).min(start + length);
    let leave = half_chord.max(start).min(start + length);
    let foot = from - start * along;
    let inside = (foot.x + 0.5 * along.x * (enter + leave)) * along.y * (leave - enter);
    let before = half_area(foot.y + along.y * enter) - half_area(from.y);
    let after = half_area(to.y) - half_area(foot.y + along.y * leave);
    let side = |x: f64| 1.0_f64.copysign(x);
    let chord = along.x * half_chord;
    inside + before * side(foot.x - chord) + after * side(foot.x + chord)
}

impl Line {
    /// Which end is beyond a plane that the line passes, and the circle in the plane, if it passes it.
    fn cut(&self, beyond: impl Fn(&Circle) -> f64) -> Option<(usize, Circle)> {
        let [from, to] = self.ends.each_ref().map(beyond);
        let is_cut = (from > 0.0) != (to > 0.0);
        let [first, last] = &self.ends;
        is_cut.then(|| (usize::from(to > 0.0), first.lerp(last, from / (from - to))))
    }

    fn seen_from(&self, middle: DVec2) -> Seen {
        let end = |end: Circle| End {
            at: end.seen_from(middle).as_vec2().to_array(),
            motion: (end.scale / end.radius) as f32,
        };
        Seen {
            ends: self.ends.map(end),
            place: self.place,
        }
    }
}

impl Seen {
    fn densities(lines: &[Self], level: Level, at: &[[f32; LANES]; 2]) -> [f32; LANES] {
        let mut sums = [0.0; LANES];
        dispatch!(level, simd => simd.vectorize(#[inline(always)] || Self::add(lines, at, &mut sums)));
        // A caster is seen from above or from below.
        sums.map(|sum| sum.abs().min(1.0))
    }

    /// By Green's theorem: the integral over y of the lines' x, clamped to the disc, over π.
    #[inline(always)]
    fn add(lines: &[Self], points: &[[f32; LANES]; 2], sums: &mut [f32; LANES]) {
        let least = |values: &[f32; LANES]| values.iter().copied().fold(f32::INFINITY, f32::min);
        let most = |values: &[f32; LANES]| values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let min = points.each_ref().map(least);
        let max = points.each_ref().map(most);
        // Where the last line ended, and `half_disc` there.
        let (mut end, mut halves) = (None, [0.0; LANES]);
        for line in lines {
            let [from, to] = line.ends;
            // From all points' box: how far right or up both ends are at least, and how far left or down.
            let above =
                |axis: usize| from.seen(axis, max[axis]).min(to.seen(axis, max[axis])) >= 1.0;
            let below =
                |axis: usize| from.seen(axis, min[axis]).max(to.seen(axis, min[axis])) <= -1.0;
            if above(1) || below(1) {
                continue;
            }
            if end != Some(from) {
                for lane in 0..LANES {
                    halves[lane] = half_disc(from.seen(1, points[1][lane]));
                }
            }
            let before = halves;
            for lane in 0..LANES {
                halves[lane] = half_disc(to.seen(1, points[1][lane]));
            }
            end = Some(to);
            let place = match line.place {
                Place::Near if above(0) => Place::Beside(1.0),
                Place::Near if below(0) => Place::Beside(-1.0),
                place => place,
            };
            if let Place::Beside(sign) = place {
                for lane in 0..LANES {
                    sums[lane] += sign * (halves[lane] - before[lane]);
                }
                continue;
            }
            for lane in 0..LANES {
                let (x, y) = (points[0][lane], points[1][lane]);
                let start = [from.seen(0, x), from.seen(1, y)];
                let (way_x, way_y) = (to.seen(0, x) - start[0], to.seen(1, y) - start[1]);
                let length = (way_x * way_x + way_y * way_y).sqrt();
                // Of a line without a length any direction is right.
                let unit = 1.0 / length.max(f32::MIN_POSITIVE);
                let along = [way_x * unit, way_y * unit];
                sums[lane] += line_area(start, along, length, [before[lane], halves[lane]]);
            }
        }
    }
}

impl End {
    /// One coordinate, seen from a point so far off the cell's middle along it.
    #[inline(always)]
    fn seen(&self, axis: usize, offset: f32) -> f32 {
        self.at[axis] - self.motion * offset
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::tilted;
    use crate::light::Light;
    use crate::mesh::cells::NOISE;
    use crate::outline::sides;
    use crate::path::{FillRule, Path};
    use crate::pose::Pose;
    use crate::shape::Shape;
    use crate::tilted::TiltedShadow;

    /// The largest error over and beside a shadow, in density, and in how many of the cells asked the closed form is.
    fn error(shadow: &TiltedShadow) -> (f64, [usize; 2]) {
        const SIDE: u32 = 97;
        let (min, max) = shadow.hull().unwrap();
        let center = min.midpoint(max);
        let place = |circle: &Circle| circle.placed(1.0, center);
        let loops: Vec<Vec<Circle>> = shadow
            .loops
            .iter()
            .map(|circles| circles.iter().map(place).collect())
            .collect();
        let radii = loops
            .iter()
            .flatten()
            .map(|circle| circle.radius / circle.scale);
        let most = radii.fold(0.0, f64::max);
        let mut cells = TiltedCells::new(&loops, [min - center, max - center], most / 8.0);
        let at =
            |i: u32| DVec2::new(f64::from(i % SIDE), f64::from(i / SIDE)) / f64::from(SIDE - 1);
        let points: Vec<DVec2> = (0..SIDE * SIDE)
            .map(|i| (max - min) * 1.1 * (at(i) - 0.5))
            .collect();
        let mut densities = vec![0.0; points.len()];
        cells.at_all(&points, &mut densities);
        let apart =
            |(&point, density): (&DVec2, &f64)| (density - tilted::at_point(&loops, point)).abs();
        let worst = points.iter().zip(&densities).map(apart).fold(0.0, f64::max);
        let count =
            |is: fn(&Kind) -> bool| cells.cells.iter().filter(|cell| is(&cell.kind)).count();
        let touched = count(|kind| matches!(kind, Kind::Touched));
        (
            worst,
            [touched, count(|kind| matches!(kind, Kind::Smallest(_)))],
        )
    }

    #[test]
    fn areas_left_of_lines_add_up_to_those_inside() {
        let mut state = 1_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
        };
        for size in [0.5, 1.5, 4.0, 1e3, 1e9] {
            for _ in 0..1000 {
                let corners = [(); 3].map(|()| DVec2::new(next(), next()) * size);
                let circle = |&center: &DVec2| Circle {
                    center,
                    scale: 1.0,
                    radius: 1.0,
                };
                let expected =
                    tilted::at_point(&[corners.iter().map(circle).collect()], DVec2::ZERO);
                let sum: f64 = sides(&corners)
                    .map(|(from, to)| area_left_of(from, to))
                    .sum();
                let error = sum.abs() / PI - expected;
                assert!(
                    error.abs() < 1e-12 * size.max(1.0),
                    "{corners:?}: {error:e}"
                );
            }
        }
    }

    #[test]
    fn cells_have_the_closed_forms_densities() {
        let mut star = Path::new();
        for i in 0_u8..40 {
            let angle = f32::from(i) * core::f32::consts::TAU / 40.0;
            let radius = if i % 2 == 0 { 40.0 } else { 22.0 };
            let point = [80.0 + radius * angle.cos(), 80.0 + radius * angle.sin()];
            if i == 0 {
                star.move_to(point);
            } else {
                star.line_to(point);
            }
        }
        star.close();
        let shapes = [
            Shape::rect(50.0, 60.0, 60.0, 40.0).unwrap(),
            Shape::rounded_rect(50.0, 60.0, 60.0, 40.0, 6.0).unwrap(),
            Shape::circle([80.0, 80.0], 30.0).unwrap(),
            Shape::path(&star, FillRule::NonZero).unwrap(),
        ];
        for radius in [4.0, 40.0, 400.0] {
            let light = Light::new([80.0, 30.0, 300.0], radius).unwrap();
            for shape in &shapes {
                for (elevation, degrees) in [
                    (60.0, 0.0),
                    (60.0, 25.0),
                    (50.0, 80.0),
                    (60.0, 130.0),
                    (20.0, 60.0),
                    (20.0, 90.0),
                ] {
                    let angle = f32::to_radians(degrees);
                    let pose = Pose::turned(elevation, [80.0, 80.0], [1.0, 0.4], angle).unwrap();
                    let shadow = light.cast_posed(shape, &pose, 0.0).unwrap();
                    let (error, [touched, all]) = error(&shadow);
                    println!(
                        "light {radius}, {elevation} up, {degrees} degrees: {error:.1e}, {touched} and {all} cells"
                    );
                    assert!(error <= NOISE, "{error:e}");
                    // At an elevation of 20 it reaches the ground.
                    assert!(elevation < 30.0 || touched == 0);
                }
            }
        }
    }
}
