//! The outline: oriented loops of lines and circular arcs that never cross.
//!
//! Every number of the crate comes from an outline by sums over its edges, so all that it must promise is
//! orientation: the area lies to the left of each edge where y points up, so that areas come out positive.

mod arcs;
mod chords;
mod clip;
mod fit;
mod near;
mod resolve;

use core::f64::consts::{PI, TAU};

use glam::DVec2;
use libm::{atan2, cos, sin};

pub(crate) use clip::clip_to_box;
pub(crate) use fit::Fineness;
pub(crate) use resolve::{Winding, intersect_loops, resolve, resolve_loops};

use crate::path::{EllipseArc, Segment, arc_steps};
use crate::shape::{Cover, Shape};

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
    /// The outline of a shape of lines and circular arcs that needs no fill rule, or none.
    pub(crate) fn of_simple(shape: &Shape) -> Option<Self> {
        let straight = shape.contours.iter().all(crate::path::Contour::is_straight);
        match shape.cover {
            Cover::Simple => {}
            Cover::Rule(rule) if straight => {
                // A single convex contour is what it covers, whatever the rule.
                let polygons = flatten(shape, 1.0);
                return Some(match polygons.as_slice() {
                    [only] if is_convex_polygon(only) => Self::of_polygons(&polygons),
                    _ => resolve(&polygons, Winding::Rule(rule)),
                });
            }
            Cover::Rule(_) => return None,
        }
        let mut loops = Vec::with_capacity(shape.contours.len());
        for contour in &shape.contours {
            let mut edges = Vec::with_capacity(contour.segments.len() + 1);
            let mut from = contour.start;
            for segment in &contour.segments {
                match *segment {
                    Segment::Line(to) => edges.push(Edge::Line(Line { from, to })),
                    Segment::Arc(arc) => edges.extend(circular(from, &arc)?.map(Edge::Arc)),
                    Segment::Quad(..) | Segment::Cubic(..) => return None,
                }
                from = segment.end();
            }
            if from != contour.start {
                edges.push(Edge::Line(Line {
                    from,
                    to: contour.start,
                }));
            }
            loops.push(edges);
        }
        Some(Self { loops }.canonical())
    }

    /// The outline of a shape: with circular arcs as they are where that can be, or else its curves cut into lines within
    /// `flatness` of them.
    pub(crate) fn of_shape(shape: &Shape, flatness: f64) -> Self {
        Self::of_simple(shape).unwrap_or_else(|| Self::of_flattened(shape, flatness))
    }

    /// The outline of a shape, its curves cut into lines within `flatness` of them.
    pub(crate) fn of_flattened(shape: &Shape, flatness: f64) -> Self {
        let polygons = flatten(shape, flatness);
        match shape.cover {
            Cover::Simple => Self::of_polygons(&polygons),
            Cover::Rule(rule) => resolve(&polygons, Winding::Rule(rule)),
        }
    }

    /// The outline of polygons known neither to cross nor to touch.
    fn of_polygons(polygons: &[Vec<DVec2>]) -> Self {
        let loops = polygons
            .iter()
            .map(|polygon| closed_lines(polygon))
            .collect();
        Self { loops }.canonical()
    }

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
            for (edge, next) in edges.iter().zip(edges.iter().cycle().skip(1)) {
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

fn flatten(shape: &Shape, flatness: f64) -> Vec<Vec<DVec2>> {
    shape
        .contours
        .iter()
        .map(|contour| contour.flatten(flatness))
        .filter(|polygon| polygon.len() > 2)
        .collect()
}

fn closed_lines(polygon: &[DVec2]) -> Vec<Edge> {
    let nexts = polygon.iter().cycle().skip(1);
    polygon
        .iter()
        .zip(nexts)
        .map(|(&from, &to)| Edge::Line(Line { from, to }))
        .collect()
}

/// Whether a polygon turns one way only, and once.
fn is_convex_polygon(polygon: &[DVec2]) -> bool {
    let count = polygon.len();
    let edge = |i: usize| polygon[(i + 1) % count] - polygon[i % count];
    let turns_left = (0..count).all(|i| edge(i).perp_dot(edge(i + 1)) > 0.0);
    let turns_right = (0..count).all(|i| edge(i).perp_dot(edge(i + 1)) < 0.0);
    // A star turns one way only as well, but its edges head left and right more than once.
    let changes = (0..count)
        .filter(|&i| (edge(i).x < 0.0) != (edge(i + 1).x < 0.0))
        .count();
    (turns_left || turns_right) && changes <= 2
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

/// The arc as parts of a circle of at most a half turn, when its half diameters are equal and perpendicular.
fn circular(from: DVec2, arc: &EllipseArc) -> Option<impl Iterator<Item = Arc>> {
    // Rounding may make a half circle a little longer, and two arcs of it would be no better.
    const HALF_TURN: f64 = PI + 1e-9;
    if !arc.is_circular() {
        return None;
    }
    let radius = arc.u.length();
    let turn = arc.turn();
    let whole = Arc {
        center: arc.center,
        radius,
        start: atan2(arc.u.y, arc.u.x) + turn * arc.start,
        sweep: turn * arc.sweep,
        from,
        to: arc.to,
    };
    let parts = if whole.sweep.abs() <= HALF_TURN {
        [Some(whole), None]
    } else {
        let sweep = whole.sweep / 2.0;
        let middle = whole.at(whole.start + sweep);
        let first = Arc {
            sweep,
            to: middle,
            ..whole
        };
        let second = Arc {
            start: whole.start + sweep,
            sweep,
            from: middle,
            ..whole
        };
        [Some(first), Some(second)]
    };
    Some(parts.into_iter().flatten())
}

#[cfg(test)]
mod tests {
    use glam::{DAffine2, DMat2};

    use super::*;
    use crate::path::FillRule;

    fn outline(shape: &Shape) -> Outline {
        let outline = Outline::of_simple(shape).unwrap();
        outline.sanity_check();
        outline
    }

    #[test]
    fn rounded_rectangles_keep_four_lines_and_four_arcs() {
        let shape = Shape::rounded_rect(10.0, 20.0, 100.0, 60.0, [4.0, 8.0, 0.0, 12.0]).unwrap();
        let outline = outline(&shape);
        let arcs = outline
            .edges()
            .filter(|edge| matches!(edge, Edge::Arc(_)))
            .count();
        assert_eq!((arcs, outline.edges().count()), (3, 7));
        let area = 6000.0 - (1.0 - PI / 4.0) * (16.0 + 64.0 + 144.0);
        assert!((outline.area() - area).abs() < 1e-9);
        assert_eq!(
            outline.bounds(),
            Some((DVec2::new(10.0, 20.0), DVec2::new(110.0, 80.0)))
        );
    }

    #[test]
    fn circles_are_one_pair_of_arcs_under_every_similarity() {
        let shape = Shape::circle([3.0, 4.0], 5.0).unwrap();
        for (angle, mirror) in [(0.0, 1.0), (1.0, 1.0), (2.5, -1.0)] {
            let turned = DMat2::from_cols(
                DVec2::new(cos(angle), sin(angle)) * 2.0,
                DVec2::new(-sin(angle), cos(angle)) * 2.0 * mirror,
            );
            let mapped = outline(&shape.mapped(&DAffine2::from_mat2(turned)));
            assert_eq!(mapped.edges().count(), 2);
            assert!((mapped.area() - PI * 100.0).abs() < 1e-9);
            let (min, max) = mapped.bounds().unwrap();
            assert!(((max - min) - DVec2::splat(20.0)).length() < 1e-9);
        }
        // A stretched circle is no circle.
        assert!(
            Outline::of_simple(&shape.mapped(&DAffine2::from_scale(DVec2::new(2.0, 1.0))))
                .is_none()
        );
    }

    #[test]
    fn one_outline_has_one_description() {
        let ring = [
            [0.0, 0.0],
            [10.0, 1.0],
            [12.0, 9.0],
            [5.0, 12.0],
            [-1.0, 6.0],
        ];
        let mut reversed = ring;
        reversed.reverse();
        let mut rotated = ring;
        rotated.rotate_left(2);
        let of =
            |ring: [[f32; 2]; 5]| outline(&Shape::polygon(&[ring], FillRule::NonZero).unwrap());
        assert_eq!(of(ring), of(reversed));
        assert_eq!(of(ring), of(rotated));
    }

    #[test]
    fn fill_rules_and_crossings_are_resolved() {
        let area = |rings: &[&[[f32; 2]]], rule| {
            let outline = outline(&Shape::polygon(rings, rule).unwrap());
            outline.area()
        };
        // A bow-tie: two triangles of area 25, one of them wound backwards.
        let bow_tie: &[[f32; 2]] = &[[0.0, 0.0], [10.0, 10.0], [10.0, 0.0], [0.0, 10.0]];
        assert!((area(&[bow_tie], FillRule::NonZero) - 50.0).abs() < 1e-9);
        assert!((area(&[bow_tie], FillRule::EvenOdd) - 50.0).abs() < 1e-9);
        // A square in a square, wound the same way and the other way.
        let square = |at: f32, side: f32| {
            [
                [at, at],
                [at + side, at],
                [at + side, at + side],
                [at, at + side],
            ]
        };
        let (outer, inner) = (square(0.0, 9.0), square(3.0, 3.0));
        let mut turned = inner;
        turned.reverse();
        assert!((area(&[&outer, &inner], FillRule::NonZero) - 81.0).abs() < 1e-9);
        assert!((area(&[&outer, &inner], FillRule::EvenOdd) - 72.0).abs() < 1e-9);
        assert!((area(&[&outer, &turned], FillRule::NonZero) - 72.0).abs() < 1e-9);
        // Two squares that share a part: it counts once.
        let (a, b) = (square(0.0, 10.0), square(5.0, 10.0));
        assert!((area(&[&a, &b], FillRule::NonZero) - 175.0).abs() < 1e-9);
        assert!((area(&[&a, &b], FillRule::EvenOdd) - 150.0).abs() < 1e-9);
        // A pentagram: its core is wound twice.
        let tip = |i: u32| {
            let angle = f64::from(i) * 0.4 * TAU;
            [(10.0 * cos(angle)) as f32, (10.0 * sin(angle)) as f32]
        };
        let pentagram = [0, 1, 2, 3, 4].map(tip);
        let core = area(&[&pentagram], FillRule::NonZero) - area(&[&pentagram], FillRule::EvenOdd);
        // A regular pentagon of circumradius 10 / φ², φ the golden ratio.
        let radius: f64 = 10.0 / 2.618_033_988_749_895;
        assert!(
            (core - 2.5 * radius * radius * sin(TAU / 5.0)).abs() < 1e-4,
            "{core}"
        );
    }
}
