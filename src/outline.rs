//! The outline: oriented loops of lines and circular arcs that never cross.
//!
//! Every number of the crate comes from an outline by sums over its edges, so all that it must promise is
//! orientation: the area lies to the left of each edge where y points up, so that areas come out positive.

mod arcs;
mod chords;
mod clip;
mod fit;
mod near;
mod of_shape;
mod resolve;

use core::f64::consts::{PI, TAU};

use glam::DVec2;
use libm::{atan2, cos, sin};

pub(crate) use clip::clip_to_box;
pub(crate) use fit::Fineness;
pub(crate) use resolve::{Winding, intersect_loops, resolve, resolve_loops};

use crate::path::arc_steps;

/// Loops of edges, each ending where the next begins.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Outline {
    pub(crate) loops: Vec<Vec<Edge>>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Edge {
    Line(Line),
    Arc(Arc),
    /// A line that came from clipping: it runs along the box, out of the disc's reach.
    Border(Line),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    pub(crate) from: DVec2,
    pub(crate) to: DVec2,
}

/// The points `center + radius (cos θ, sin θ)`, θ from `start` to `start + sweep`, at most a half turn (radians).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Arc {
    pub(crate) center: DVec2,
    pub(crate) radius: f64,
    pub(crate) start: f64,
    pub(crate) sweep: f64,
    pub(crate) from: DVec2,
    pub(crate) to: DVec2,
}

impl Line {
    fn mapped(&self, place: impl Fn(DVec2) -> DVec2) -> Self {
        Self {
            from: place(self.from),
            to: place(self.to),
        }
    }
}

impl Arc {
    pub(crate) fn mapped(&self, factor: f64, place: impl Fn(DVec2) -> DVec2) -> Self {
        Self {
            center: place(self.center),
            radius: self.radius * factor,
            from: place(self.from),
            to: place(self.to),
            ..*self
        }
    }

    pub(crate) fn at(&self, angle: f64) -> DVec2 {
        self.center + self.radius * DVec2::new(cos(angle), sin(angle))
    }

    /// Whether the direction from the centre is one of the arc's.
    pub(crate) fn has(&self, direction: DVec2) -> bool {
        let turn = if self.sweep < 0.0 { -1.0 } else { 1.0 };
        let offset = wrap(turn * (atan2(direction.y, direction.x) - self.start));
        let length = self.sweep.abs();
        (0.0..=length).contains(&offset) || offset + TAU <= length
    }

    /// Gives `piece` the parts of the arc in order, each with whether its angles are within `half_width` of `middle`.
    pub(crate) fn split(&self, middle: f64, half_width: f64, mut piece: impl FnMut(Self, bool)) {
        if half_width >= PI || half_width <= 0.0 {
            piece(*self, half_width > 0.0);
            return;
        }
        // Along the arc from its start, whatever its direction, the middle lies at `offset` and a turn later: a turn
        // earlier would end before the start.
        let length = self.sweep.abs();
        let turn = if self.sweep < 0.0 { -1.0 } else { 1.0 };
        let offset = wrap(turn * (middle - self.start));
        let mut done = 0.0;
        let mut part = |from: f64, to: f64, within: bool| {
            if to > from {
                let start = self.start + turn * from;
                piece(
                    Self {
                        start,
                        sweep: turn * (to - from),
                        from: if from == 0.0 {
                            self.from
                        } else {
                            self.at(start)
                        },
                        to: if to == length {
                            self.to
                        } else {
                            self.at(self.start + turn * to)
                        },
                        ..*self
                    },
                    within,
                );
            }
        };
        for middle in [offset, offset + TAU] {
            let first = (middle - half_width).clamp(done, length);
            let last = (middle + half_width).clamp(first, length);
            part(done, first, false);
            part(first, last, true);
            done = last;
        }
        part(done, length, false);
    }
}

/// The angle plus or minus turns that is within a half turn of 0.
fn wrap(angle: f64) -> f64 {
    let turns = (angle / TAU).round();
    angle - turns * TAU
}

impl Edge {
    pub(crate) fn from(&self) -> DVec2 {
        match self {
            Self::Line(line) | Self::Border(line) => line.from,
            Self::Arc(arc) => arc.from,
        }
    }

    pub(crate) fn to(&self) -> DVec2 {
        match self {
            Self::Line(line) | Self::Border(line) => line.to,
            Self::Arc(arc) => arc.to,
        }
    }

    pub(crate) fn length(&self) -> f64 {
        match self {
            Self::Line(line) | Self::Border(line) => (line.to - line.from).length(),
            Self::Arc(arc) => arc.sweep.abs() * arc.radius,
        }
    }

    pub(crate) fn reversed(&self) -> Self {
        let turned = |line: &Line| Line {
            from: line.to,
            to: line.from,
        };
        match self {
            Self::Line(line) => Self::Line(turned(line)),
            Self::Border(line) => Self::Border(turned(line)),
            Self::Arc(arc) => Self::Arc(Arc {
                start: arc.start + arc.sweep,
                sweep: -arc.sweep,
                from: arc.to,
                to: arc.from,
                ..*arc
            }),
        }
    }

    /// Twice the area between the edge and `origin`: the triangle of its chord, and the circular segment beyond.
    pub(crate) fn double_area(&self, origin: DVec2) -> f64 {
        let triangle = (self.from() - origin).perp_dot(self.to() - origin);
        match self {
            Self::Line(_) | Self::Border(_) => triangle,
            Self::Arc(arc) => triangle + arc.radius * arc.radius * (arc.sweep - sin(arc.sweep)),
        }
    }

    /// The edge under a map of its points that moves and scales by `factor`.
    pub(crate) fn mapped(&self, factor: f64, place: impl Fn(DVec2) -> DVec2) -> Self {
        match self {
            Self::Line(line) => Self::Line(line.mapped(place)),
            Self::Border(line) => Self::Border(line.mapped(place)),
            Self::Arc(arc) => Self::Arc(arc.mapped(factor, place)),
        }
    }
}

impl Outline {
    /// Oriented so that the area is positive, with loops and their starts in an order of their own: two descriptions
    /// of one outline become the same edges, and every sum over them the same bits.
    fn canonical(mut self) -> Self {
        self.loops.retain(|edges| !edges.is_empty());
        if self.area() < 0.0 {
            for edges in &mut self.loops {
                reverse(edges);
            }
        }
        let key = |edge: &Edge| (edge.from().x, edge.from().y);
        for edges in &mut self.loops {
            let first = (0..edges.len())
                .min_by(|&a, &b| {
                    key(&edges[a])
                        .partial_cmp(&key(&edges[b]))
                        .unwrap_or(core::cmp::Ordering::Equal)
                })
                .unwrap_or(0);
            edges.rotate_left(first);
        }
        self.loops.sort_by(|a, b| {
            key(&a[0])
                .partial_cmp(&key(&b[0]))
                .unwrap_or(core::cmp::Ordering::Equal)
        });
        self
    }

    /// The outline moved by `offset`.
    pub(crate) fn moved(&self, offset: DVec2) -> Self {
        let loops = self.loops.iter();
        Self {
            loops: loops
                .map(|edges| {
                    edges
                        .iter()
                        .map(|edge| edge.mapped(1.0, |p| p + offset))
                        .collect()
                })
                .collect(),
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.loops.is_empty()
    }

    pub(crate) fn edges(&self) -> impl Iterator<Item = &Edge> + Clone {
        self.loops.iter().flatten()
    }

    /// The area inside, in square units.
    pub(crate) fn area(&self) -> f64 {
        area(self.edges())
    }

    /// The smallest box that holds the outline.
    pub(crate) fn bounds(&self) -> Option<(DVec2, DVec2)> {
        bounds(self.edges())
    }

    /// The vertices of each loop with the arcs cut within `flatness`.
    pub(crate) fn polygons(&self, flatness: f64) -> Vec<Vec<DVec2>> {
        self.loops
            .iter()
            .map(|edges| {
                let mut vertices = Vec::with_capacity(edges.len());
                for edge in edges {
                    vertices.push(edge.from());
                    if let Edge::Arc(arc) = edge {
                        let count = arc_steps(arc.radius, arc.sweep, flatness);
                        vertices.extend((1..count).map(|i| {
                            arc.at(arc.start + arc.sweep * f64::from(i) / f64::from(count))
                        }));
                    }
                }
                vertices
            })
            .collect()
    }

    /// Adds the loops of another outline that does not overlap this one.
    pub(crate) fn append(&mut self, other: Self) {
        self.loops.extend(other.loops);
    }

    /// Whether every edge ends where the next begins and every number is finite.
    #[cfg(test)]
    pub(crate) fn sanity_check(&self) {
        for edges in &self.loops {
            assert!(!edges.is_empty());
            for (edge, next) in sides(edges) {
                assert!(edge.from().is_finite());
                assert!(
                    (edge.to() - next.from()).length() < 1e-9,
                    "{edge:?} {next:?}"
                );
            }
        }
        assert!(self.area() >= 0.0);
    }
}

/// What goes round a loop, each with the next: a polygon's sides, if it is points.
pub(crate) fn sides<T: Copy>(of_loop: &[T]) -> impl Iterator<Item = (T, T)> {
    let nexts = of_loop.iter().cycle().skip(1);
    of_loop.iter().copied().zip(nexts.copied())
}

pub(crate) fn closed_lines(polygon: &[DVec2]) -> Vec<Edge> {
    sides(polygon)
        .map(|(from, to)| Edge::Line(Line { from, to }))
        .collect()
}

/// The angle from one direction to another, within a half turn: above 0 to the left where y points up.
pub(crate) fn turn(from: DVec2, to: DVec2) -> f64 {
    atan2(from.perp_dot(to), from.dot(to))
}

/// How far along a line, from 0 to 1, is what of it is nearest to a point: 0 where it has no length.
pub(crate) fn nearest_share(from: DVec2, to: DVec2, point: DVec2) -> f64 {
    let along = to - from;
    let share = (point - from).dot(along) / along.length_squared();
    if share.is_nan() {
        0.0
    } else {
        share.clamp(0.0, 1.0)
    }
}

/// How often closed lines wind round a point.
pub(crate) fn winding(lines: impl Iterator<Item = (DVec2, DVec2)>, point: DVec2) -> i32 {
    lines
        .filter(|(from, to)| (from.y <= point.y) != (to.y <= point.y))
        .map(|(from, to)| {
            let side = (to - from).perp_dot(point - from);
            if from.y <= point.y {
                i32::from(side > 0.0)
            } else {
                -i32::from(side < 0.0)
            }
        })
        .sum()
}

/// The area inside of edges, positive where it is on their left with y pointing up.
pub(crate) fn area<'a>(edges: impl Iterator<Item = &'a Edge> + Clone) -> f64 {
    // Far from the origin the triangles' areas would cancel.
    let origin = edges.clone().next().map_or(DVec2::ZERO, Edge::from);
    edges.map(|edge| edge.double_area(origin)).sum::<f64>() / 2.0
}

/// Edges gone the other way.
pub(crate) fn reverse(edges: &mut [Edge]) {
    edges.reverse();
    for edge in edges {
        *edge = edge.reversed();
    }
}

/// The smallest box that holds edges.
pub(crate) fn bounds<'a>(edges: impl Iterator<Item = &'a Edge>) -> Option<(DVec2, DVec2)> {
    let mut bounds: Option<(DVec2, DVec2)> = None;
    let mut include = |p: DVec2| {
        bounds = Some(bounds.map_or((p, p), |(min, max)| (min.min(p), max.max(p))));
    };
    for edge in edges {
        include(edge.from());
        if let Edge::Arc(arc) = edge {
            for direction in [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y] {
                if arc.has(direction) {
                    include(arc.center + arc.radius * direction);
                }
            }
        }
    }
    bounds
}
