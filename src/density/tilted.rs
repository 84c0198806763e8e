//! The closed form for casters of many radii: the area of a polygon on the light's unit disc, pixel by pixel.
//!
//! Tiles keep of a loop what their discs can meet: elsewhere a path of edges counts by the angle that it spans alone, so that
//! a few long lines stand for it.

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

/// The side of a tile, in pixels.
const TILE: i64 = 16;

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
    let loops: Vec<Vec<Circle>> = shadow
        .loops
        .iter()
        .map(|circles| circles.iter().map(place).collect())
        .collect();
    let radii = loops
        .iter()
        .flatten()
        .map(|circle| circle.radius / circle.scale);
    let mut painter = Painter {
        radii: radii.fold(f64::MAX..0.0, |all, radius| {
            all.start.min(radius)..all.end.max(radius)
        }),
        loops,
        plane: shadow.plane.map(|circle| place(&circle)),
        phase: frame.phase,
        near: Vec::new(),
        whole: 0.0,
        edges: scratch.take(),
        clipped: scratch.take(),
        spare: scratch.take(),
    };
    for top in
        (rows.start.div_euclid(TILE)..=(rows.end - 1).div_euclid(TILE)).map(|tile| tile * TILE)
    {
        for left in (columns.start.div_euclid(TILE)..=(columns.end - 1).div_euclid(TILE))
            .map(|tile| tile * TILE)
        {
            let middle = DVec2::new(left as f64, top as f64) + painter.phase + TILE as f64 / 2.0;
            painter.keep_near(middle);
            let constant = painter.near.is_empty().then(|| fraction(painter.whole));
            if constant == Some(0.0) {
                continue;
            }
            for row in top.max(rows.start)..(top + TILE).min(rows.end) {
                let y = (row - frame.first[1]) as u32;
                for column in left.max(columns.start)..(left + TILE).min(columns.end) {
                    let x = (column - frame.first[0]) as u32;
                    if hidden.is_some_and(|hidden| hidden.hides(x, y)) {
                        continue;
                    }
                    let density = constant.unwrap_or_else(|| painter.pixel([column, row]));
                    if density > 0.0 {
                        sink.values(y..y + 1, x..x + 1, &[density as f32]);
                    }
                }
            }
        }
    }
    for edges in [painter.edges, painter.clipped, painter.spare] {
        scratch.give(edges);
    }
}

struct Painter {
    loops: Vec<Vec<Circle>>,
    plane: [Circle; 3],
    /// The least and the largest radius of all circles, in pixels.
    radii: Range<f64>,
    phase: DVec2,
    /// Of the tile: the loops that discs may meet, short of what they cannot, and twice the area that all others span.
    near: Vec<Vec<Circle>>,
    whole: f64,
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
    /// Finds what of the loops discs about the points of a tile can meet.
    fn keep_near(&mut self, middle: DVec2) {
        // To the farthest corner of the tile's corner pixels.
        let reach = TILE as f64 / 2.0 * SQRT_2;
        self.near.clear();
        self.whole = 0.0;
        for circles in &self.loops {
            let seen: Vec<Seen> = circles
                .iter()
                .map(|circle| Seen {
                    at: circle.seen_from(middle),
                    // Without end where the caster touches its receiver.
                    motion: reach * circle.scale / circle.radius,
                })
                .collect();
            let count = circles.len();
            let is_far = |from: usize| seen[from].is_far(&seen[(from + 1) % count]);
            let Some(first) = (0..count).find(|&index| !is_far(index)) else {
                self.whole += double_area(circles, middle);
                continue;
            };
            let mut kept = vec![circles[first]];
            // The vertex from which a path out of reach began.
            let mut start = None;
            for index in (first + 1..=first + count).map(|index| index % count) {
                let next = (index + 1) % count;
                if index == first {
                    break;
                }
                if is_far(index) {
                    let from = *start.get_or_insert_with(|| {
                        kept.push(circles[index]);
                        index
                    });
                    if from != index && !passes(&seen[from], &seen[index], &seen[next]) {
                        kept.push(circles[index]);
                        start = Some(index);
                    }
                } else {
                    kept.push(circles[index]);
                    start = None;
                }
            }
            self.near.push(kept);
        }
    }

    fn pixel(&mut self, at: [i64; 2]) -> f64 {
        let middle = DVec2::new(at[0] as f64, at[1] as f64) + self.phase + 0.5;
        let radius = self.radius_at(middle);
        let side = averaged_side(radius);
        if side == 0.0 {
            return self.at_point(middle);
        }
        let is_wide = self.radii.end > WIDE;
        if radius < quadrature::COVERAGE_RADIUS {
            let mut hidden = |(light, weight)| weight * self.coverage(middle, light);
            // Where the caster touches its receiver, what is hard in the pixel is seen with what is wide.
            return if is_wide {
                quadrature::exact_disc(1).map(&mut hidden).sum()
            } else {
                quadrature::disc().map(&mut hidden).sum()
            };
        }
        quadrature::square(radius)
            .map(|(offset, weight)| weight * self.at_point(middle + offset * side))
            .sum()
    }

    fn at_point(&self, point: DVec2) -> f64 {
        let near: f64 = self
            .near
            .iter()
            .map(|circles| double_area(circles, point))
            .sum();
        fraction(self.whole + near)
    }

    /// The part of a pixel that the caster hides from a point of the light's unit disc.
    fn coverage(&mut self, middle: DVec2, light: DVec2) -> f64 {
        let mut double_area = self.whole / TAU * 2.0;
        for circles in &self.near {
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
