//! The closed form for casters of many radii: the area of a polygon on the light's unit disc, pixel by pixel.
//!
//! Tiles keep of a loop what their discs can meet: elsewhere a path of edges counts by the angle that it spans alone, so that
//! a few long lines stand for it. Small tiles keep so much of what large ones do, and pixels that are averages of theirs.

use core::f64::consts::{SQRT_2, TAU};
use core::ops::Range;

use glam::DVec2;

use super::area::{of_line, settled};
use super::frame::Frame;
use super::{Sink, averaged_side, quadrature};
use crate::grid::Grid;
use crate::hidden::Hidden;
use crate::outline::{Edge, Line, clip_to_box};
use crate::scratch::Scratch;
use crate::tilted::{Circle, TiltedShadow};

/// From this penumbra radius on, in pixels, it takes more points of the light to tell what it hides of a pixel.
const WIDE: f64 = 1.0;

/// The sides of tiles, in pixels: of large ones and of the small ones that they are made of.
const LARGE: i64 = 16;
const SMALL: i64 = 4;

/// The fraction of the light's disc that loops hide from a point.
pub(crate) fn at_point(loops: &[Vec<Circle>], point: DVec2) -> f64 {
    let double_area: f64 = loops
        .iter()
        .map(|circles| double_area(circles, point))
        .sum();
    fraction(double_area)
}

/// A caster is seen from above or from below: the sign tells which.
fn fraction(double_area: f64) -> f64 {
    settled(double_area.abs() / TAU)
}

fn double_area(circles: &[Circle], point: DVec2) -> f64 {
    let Some(last) = circles.last() else {
        return 0.0;
    };
    let mut from = last.seen_from(point);
    let mut area = 0.0;
    for circle in circles {
        let to = circle.seen_from(point);
        area += of_line(from, to);
        from = to;
    }
    area
}

/// Gives `sink` the density of every pixel of the grid that is in the shadow and not hidden.
pub(crate) fn fill(
    shadow: &TiltedShadow,
    grid: &Grid,
    hidden: Option<&Hidden>,
    scratch: &mut Scratch,
    sink: &mut dyn Sink,
) {
    let Some(hull) = shadow.hull() else {
        return;
    };
    // The hull holds the penumbra; what pixels average over beyond it is in the frame's spare ones.
    let frame = Frame::new(hull, 0.0, grid);
    let [columns, rows] = frame.pixels();
    if columns.is_empty() || rows.is_empty() {
        return;
    }
    let place = |circle: &Circle| circle.placed(frame.scale, frame.base);
    let mut all = Near::default();
    for circles in &shadow.loops {
        all.circles.extend(circles.iter().map(place));
        all.end_loop();
    }
    let radii = all
        .circles
        .iter()
        .map(|circle| circle.radius / circle.scale);
    let mut painter = Painter {
        radii: radii.fold(f64::MAX..0.0, |all, radius| {
            all.start.min(radius)..all.end.max(radius)
        }),
        plane: shadow.plane.map(|circle| place(&circle)),
        phase: frame.phase,
        near: Near::default(),
        seen: Vec::new(),
        edges: scratch.take(),
        clipped: scratch.take(),
        spare: scratch.take(),
    };
    let (mut large, mut small) = (Near::default(), Near::default());
    each_tile(LARGE, &columns, &rows, |corner, columns, rows| {
        painter.keep_near(&all, corner, LARGE, &mut large);
        if large.is_light() {
            return;
        }
        each_tile(SMALL, &columns, &rows, |corner, columns, rows| {
            painter.keep_near(&large, corner, SMALL, &mut small);
            if small.is_light() {
                return;
            }
            let constant = small.is_empty().then(|| fraction(small.whole));
            for row in rows {
                let y = (row - frame.first[1]) as u32;
                for column in columns.clone() {
                    let x = (column - frame.first[0]) as u32;
                    if hidden.is_some_and(|hidden| hidden.hides(x, y)) {
                        continue;
                    }
                    let density = constant.unwrap_or_else(|| painter.pixel([column, row], &small));
                    if density > 0.0 {
                        sink.values(y..y + 1, x..x + 1, &[density as f32]);
                    }
                }
            }
        });
    });
    for edges in [painter.edges, painter.clipped, painter.spare] {
        scratch.give(edges);
    }
}

/// Calls `draw` with the first pixel of each tile of a side that has some of the columns and rows, and those that it has.
fn each_tile(
    side: i64,
    columns: &Range<i64>,
    rows: &Range<i64>,
    mut draw: impl FnMut([i64; 2], Range<i64>, Range<i64>),
) {
    let tiles = |of: &Range<i64>| {
        let (start, end) = (of.start, of.end);
        let all = start.div_euclid(side)..=(end - 1).div_euclid(side);
        let first = all.map(move |tile| tile * side);
        first.map(move |first| (first, start.max(first)..end.min(first + side)))
    };
    for (top, rows) in tiles(rows) {
        for (left, columns) in tiles(columns) {
            draw([left, top], columns, rows.clone());
        }
    }
}

/// Loops that discs about the points of a tile may meet, short of what they cannot, and twice the area that all others span.
#[derive(Default)]
struct Near {
    circles: Vec<Circle>,
    /// Where each loop ends among them.
    ends: Vec<usize>,
    whole: f64,
}

impl Near {
    fn clear(&mut self, whole: f64) {
        self.circles.clear();
        self.ends.clear();
        self.whole = whole;
    }

    fn end_loop(&mut self) {
        self.ends.push(self.circles.len());
    }

    fn loops(&self) -> impl Iterator<Item = &[Circle]> {
        let starts = core::iter::once(0).chain(self.ends.iter().copied());
        let ranges = starts.zip(&self.ends);
        ranges.map(|(start, &end)| &self.circles[start..end])
    }

    fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Whether nothing is in the shadow.
    fn is_light(&self) -> bool {
        self.is_empty() && fraction(self.whole) == 0.0
    }

    fn at_point(&self, point: DVec2) -> f64 {
        let near: f64 = self
            .loops()
            .map(|circles| double_area(circles, point))
            .sum();
        fraction(self.whole + near)
    }
}

struct Painter {
    plane: [Circle; 3],
    /// The least and the largest radius of all circles, in pixels.
    radii: Range<f64>,
    phase: DVec2,
    /// What a pixel's own discs may meet.
    near: Near,
    /// A loop as seen from the middle of a tile.
    seen: Vec<Seen>,
    /// A pixel's loops as they are seen from one point of the light.
    edges: Vec<Edge>,
    /// The part of them in the pixel.
    clipped: Vec<Edge>,
    /// Between one side of the pixel and the next.
    spare: Vec<Edge>,
}

/// A vertex as seen from the middle of a tile, and how far it may be from there seen from another point of the tile.
#[derive(Clone, Copy)]
struct Seen {
    at: DVec2,
    motion: f64,
}

impl Seen {
    /// Whether the disc is out of reach of the edge to `other`, wherever in the tile it is seen from.
    fn is_far(&self, other: &Self) -> bool {
        let along = other.at - self.at;
        let share = (-self.at.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        let nearest = if share.is_nan() {
            self.at
        } else {
            self.at + share * along
        };
        nearest.length() > 1.0 + self.motion.max(other.motion)
    }
}

impl Painter {
    /// Finds what of loops discs about the points of a tile can meet, whatever of it is drawn.
    fn keep_near(&mut self, loops: &Near, corner: [i64; 2], side: i64, kept: &mut Near) {
        let corner = DVec2::from(corner.map(|at| at as f64));
        let half = side as f64 / 2.0;
        let middle = corner + self.phase + half;
        let reach = half * SQRT_2;
        kept.clear(loops.whole);
        for circles in loops.loops() {
            self.seen.clear();
            self.seen.extend(circles.iter().map(|circle| Seen {
                at: circle.seen_from(middle),
                // Without end where the caster touches its receiver.
                motion: reach * circle.scale / circle.radius,
            }));
            let (seen, count) = (&self.seen, circles.len());
            let is_far = |from: usize| seen[from].is_far(&seen[(from + 1) % count]);
            let Some(first) = (0..count).find(|&index| !is_far(index)) else {
                kept.whole += double_area(circles, middle);
                continue;
            };
            kept.circles.push(circles[first]);
            // The vertex from which a path out of reach began.
            let mut start = None;
            for index in (first + 1..first + count).map(|index| index % count) {
                let next = (index + 1) % count;
                if is_far(index) {
                    let from = *start.get_or_insert_with(|| {
                        kept.circles.push(circles[index]);
                        index
                    });
                    if from != index && !passes(&seen[from], &seen[index], &seen[next]) {
                        kept.circles.push(circles[index]);
                        start = Some(index);
                    }
                } else {
                    kept.circles.push(circles[index]);
                    start = None;
                }
            }
            kept.end_loop();
        }
    }

    fn pixel(&mut self, [x, y]: [i64; 2], loops: &Near) -> f64 {
        let middle = DVec2::new(x as f64, y as f64) + self.phase + 0.5;
        let radius = self.radius_at(middle);
        let side = averaged_side(radius);
        if side == 0.0 {
            return loops.at_point(middle);
        }
        let mut near = core::mem::take(&mut self.near);
        self.keep_near(loops, [x, y], 1, &mut near);
        let is_wide = self.radii.end > WIDE;
        let density = if near.is_empty() {
            fraction(near.whole)
        } else if radius < quadrature::COVERAGE_RADIUS {
            let mut hidden = |(light, weight)| weight * self.coverage(middle, light, &near);
            // Where the caster touches its receiver, what is hard in the pixel is seen with what is wide.
            if is_wide {
                quadrature::exact_disc(1).map(&mut hidden).sum()
            } else {
                quadrature::disc().map(&mut hidden).sum()
            }
        } else {
            quadrature::square(radius)
                .map(|(offset, weight)| weight * near.at_point(middle + offset * side))
                .sum()
        };
        self.near = near;
        density
    }

    /// The part of a pixel that the caster hides from a point of the light's unit disc.
    fn coverage(&mut self, middle: DVec2, light: DVec2, near: &Near) -> f64 {
        let mut double_area = near.whole / TAU * 2.0;
        for circles in near.loops() {
            let shade = |circle: &Circle| {
                (circle.center - light * circle.radius) / circle.scale.max(f64::MIN_POSITIVE)
            };
            self.edges.clear();
            for (index, circle) in circles.iter().enumerate() {
                let from = shade(&circles[(index + circles.len() - 1) % circles.len()]);
                self.edges.push(Edge::Line(Line {
                    from,
                    to: shade(circle),
                }));
            }
            clip_to_box(
                &self.edges,
                middle - 0.5,
                middle + 0.5,
                &mut self.spare,
                &mut self.clipped,
            );
            double_area += self
                .clipped
                .iter()
                .map(|edge| edge.double_area(middle))
                .sum::<f64>();
        }
        settled(double_area.abs() / 2.0)
    }

    /// The penumbra radius of the caster's point that hides the light's centre, within those of its vertices: what the pixel's
    /// square goes by.
    fn radius_at(&self, point: DVec2) -> f64 {
        let [origin, x, y] = self
            .plane
            .map(|circle| circle.center - circle.scale * point);
        let turn = x.perp_dot(y);
        let (along_x, along_y) = (y.perp_dot(origin) / turn, origin.perp_dot(x) / turn);
        let at = |of: fn(&Circle) -> f64| {
            let [origin, x, y] = self.plane.each_ref().map(of);
            origin + along_x * x + along_y * y
        };
        // Beyond where it touches the receiver the plane goes on below, by as much.
        let radius = (at(|circle| circle.radius) / at(|circle| circle.scale)).abs();
        if radius.is_finite() {
            radius.clamp(self.radii.start, self.radii.end)
        } else {
            self.radii.start
        }
    }
}

/// Whether an edge from `from` to `to` may stand for a path by way of `over`, all of it out of reach: the disc is not between.
fn passes(from: &Seen, over: &Seen, to: &Seen) -> bool {
    if !from.is_far(to) {
        return false;
    }
    let turns = [(from, over), (over, to), (to, from)].map(|(a, b)| a.at.perp_dot(b.at) > 0.0);
    turns.iter().any(|&turn| turn != turns[0])
}
