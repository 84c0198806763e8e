//! The rim's own surface, without a mesh: what all shading is measured against.

use glam::DVec2;

use super::Rim;
use crate::outline::{Edge, Outline, nearest_share};
use crate::shape::Shape;

/// How far lines may be from curves other than circles, scene units.
const FLAT: f64 = 1e-3;

/// How often the way to a ridge is halved: to a thousandth of it.
const HALVINGS: u32 = 10;

/// A rim as the surface over its outline's inside whose height is the profile's at the distance from the outline.
#[derive(Debug, Clone)]
pub struct RimSurface {
    edges: Vec<Edge>,
    rim: Rim,
}

impl RimSurface {
    /// The surface of a rim along a shape's outline.
    #[must_use]
    pub fn new(shape: &Shape, rim: &Rim) -> Self {
        let outline = Outline::of_shape(shape, FLAT);
        Self::of_edges(outline.edges().copied().collect(), rim)
    }

    pub(super) fn of_edges(edges: Vec<Edge>, rim: &Rim) -> Self {
        Self { edges, rim: *rim }
    }

    /// The surface's unit normal at a point inside the outline (scene units; z towards the viewer).
    #[must_use]
    pub fn normal_at(&self, point: [f64; 2]) -> [f64; 3] {
        let point = DVec2::from(point);
        let foot = self.foot(point);
        let outwards = (foot - point).normalize_or_zero();
        let depth = (foot - point).length() / self.rim.width();
        self.rim.normal(depth, outwards).to_array()
    }

    /// How far above the flat part the surface is at a point, at most 0, scene units.
    #[must_use]
    pub fn rise_at(&self, point: [f64; 2]) -> f64 {
        self.rim.rise(self.depth(DVec2::from(point)))
    }

    /// The distance from the outline over the rim's width.
    pub(super) fn depth(&self, point: DVec2) -> f64 {
        (self.foot(point) - point).length() / self.rim.width()
    }

    /// The point of the ridge above a point, at most `reach` away: as long as one goes away from one side the depth grows as fast,
    /// and from the ridge on another side is nearer.
    pub(super) fn ridge_near(&self, point: DVec2, reach: f64) -> DVec2 {
        let foot = self.foot(point);
        let (start, away) = (foot.distance(point), (point - foot).normalize_or_zero());
        let is_below = |way: f64| {
            let at = point + away * way;
            self.foot(at).distance(at) > (start + way) * (1.0 - 1e-9)
        };
        let (mut low, mut high) = (0.0, reach);
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            if is_below(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        point + away * low
    }

    /// The outline's nearest point.
    fn foot(&self, point: DVec2) -> DVec2 {
        let feet = self.edges.iter().map(|edge| foot_on(edge, point));
        let nearer = |a: DVec2, b: DVec2| {
            let is_b = b.distance_squared(point) < a.distance_squared(point);
            if is_b { b } else { a }
        };
        feet.reduce(nearer).unwrap_or(point)
    }
}

fn foot_on(edge: &Edge, point: DVec2) -> DVec2 {
    let (from, to) = (edge.from(), edge.to());
    match edge {
        Edge::Line(_) | Edge::Border(_) => from + (to - from) * nearest_share(from, to, point),
        Edge::Arc(arc) => {
            let spoke = point - arc.center;
            if spoke != DVec2::ZERO && arc.has(spoke) {
                arc.center + spoke.normalize() * arc.radius
            } else if from.distance_squared(point) <= to.distance_squared(point) {
                from
            } else {
                to
            }
        }
    }
}
