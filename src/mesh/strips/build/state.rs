//! The vertices for one set of corners.

use glam::DVec2;

use crate::mesh::samples::imbalance;
use crate::mesh::strips::corner::Corner;
use crate::mesh::strips::fan::{Fan, Rings};
use crate::mesh::strips::join::RingVertex;
use crate::mesh::strips::{APART, SIGNS};

/// A long side, in penumbra radii: a triangle that is turned round on one longer yet is next to level on all.
const LONG: f64 = 65_536.0;

/// Vertices nearer than this, in penumbra radii, are one.
const SAME: f64 = 1e-3;

/// A vertex for one set of corners.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// From the middle of the smallest rectangle that has the corners.
    pub(super) at: DVec2,
    pub(super) quarter: usize,
    pub(super) offset: DVec2,
    pub(super) density: f32,
    /// The point that it comes from.
    pub(super) fan: usize,
    pub(super) point: usize,
    /// Whether its density is 0 or 1 by definition.
    pub(super) fixed: bool,
}

/// One set of corners, and the vertices for it.
#[derive(Debug, Clone, Default)]
pub(super) struct State {
    pub(super) corners: [Corner; 4],
    pub(super) fans: [Fan; 4],
    pub(super) places: Vec<Place>,
    /// For each fan's points, the least and the largest error found beside them.
    pub(super) errors: [Vec<[f64; 2]>; 4],
    /// The exact densities at few samples and at many.
    pub(super) few: Exact,
    pub(super) many: Exact,
}

/// Exact densities at the samples of triangles that stay where they are while their own densities are balanced.
#[derive(Debug, Clone, Default)]
pub(super) struct Exact {
    densities: Vec<f64>,
    /// Whether there are all of them.
    pub(super) complete: bool,
}

impl Exact {
    /// The density at the sample after so many that are known, computed unless there are all of them.
    pub(super) fn next(&mut self, known: &mut usize, density: impl FnOnce() -> f64) -> f64 {
        if !self.complete {
            self.densities.push(density());
        }
        *known += 1;
        self.densities[*known - 1]
    }
}

impl State {
    /// Forgets the vertices.
    pub(super) fn clear(&mut self) {
        self.places.clear();
        for exact in [&mut self.few, &mut self.many] {
            exact.densities.clear();
            exact.complete = false;
        }
    }

    /// Lays a ring through the points of all corners.
    pub(super) fn lay(
        &mut self,
        ring: usize,
        rings: &Rings,
        fan_of: &[usize; 4],
        laid: &mut Vec<RingVertex>,
    ) {
        laid.clear();
        let half = smallest(&self.corners);
        let innermost = ring == rings.count() + 1;
        let fixed = ring == 0 || (innermost && self.corners[0].has_umbra());
        for (quarter, (corner, sign)) in self.corners.iter().zip(SIGNS).enumerate() {
            let fan = &self.fans[fan_of[quarter]];
            let first = fan.ring(ring).start;
            let points = &fan.points[fan.ring(ring)];
            // Mirrored once, a corner runs the other way round.
            let mirrored = quarter % 2 == 1;
            for i in 0..points.len() {
                let i = if mirrored { points.len() - 1 - i } else { i };
                let point = points[i];
                let turn = point.turn();
                let mut vertex = RingVertex {
                    quarter,
                    turn: quarter as f64 + if mirrored { 1.0 - turn } else { turn },
                    index: self.places.len() as u32,
                    at: sign * (half - corner.tip + point.at),
                };
                // Of a narrow umbra, or none, corners coincide.
                let twins = [laid.last(), laid.first()].into_iter().flatten();
                let near = |twin: &&RingVertex| (twin.at - vertex.at).length() < SAME;
                if let Some(twin) = { twins }.find(near) {
                    vertex.index = twin.index;
                } else {
                    self.places.push(Place {
                        at: vertex.at,
                        quarter,
                        offset: sign * (point.at - corner.tip),
                        density: point.density as f32,
                        fan: fan_of[quarter],
                        point: first + i,
                        fixed,
                    });
                }
                laid.push(vertex);
            }
        }
    }

    /// Becomes what is between two states, so far from one to the other.
    pub(super) fn mix(&mut self, from: &Self, to: &Self, share: f64) {
        for ((corner, from), to) in self.corners.iter_mut().zip(&from.corners).zip(&to.corners) {
            *corner = from.towards(to, share);
        }
        self.errors.clone_from(&from.errors);
        self.clear();
        let places = from.places.iter().zip(&to.places);
        self.places.extend(places.map(|(from, to)| Place {
            at: from.at.lerp(to.at, share),
            offset: from.offset.lerp(to.offset, share),
            density: from.density + (to.density - from.density) * share as f32,
            ..*from
        }));
    }

    /// Whether no triangle is turned round, however long the sides are between corners that do not feel each other.
    pub(super) fn is_ordered(&self, triangles: &[[u32; 3]]) -> bool {
        let long = [0, 1].map(|axis: usize| match self.corners[0].far[axis].is_finite() {
            true => 0.0,
            false => LONG,
        });
        let is_left = |longer: DVec2| {
            triangles.iter().all(|corners| {
                let [a, b, c] = corners.map(|i| {
                    let place = &self.places[i as usize];
                    place.at + SIGNS[place.quarter] * longer
                });
                (b - a).perp_dot(c - a) > 0.0
            })
        };
        // Twice an area is a length of each side times a number, and one of both.
        let [x, y] = long;
        [[0.0, 0.0], [x, 0.0], [0.0, y], [x, y]]
            .map(DVec2::from)
            .into_iter()
            .all(is_left)
    }

    /// The least height of a triangle.
    pub(super) fn thinnest(&self, triangles: &[[u32; 3]]) -> f64 {
        let height = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|i| self.places[i as usize].at);
            let longest = [b - a, c - b, a - c]
                .map(DVec2::length)
                .into_iter()
                .fold(0.0, f64::max);
            (b - a).perp_dot(c - a) / longest
        };
        triangles.iter().map(height).fold(f64::INFINITY, f64::min)
    }

    /// Moves densities to where the errors beside each vertex are as large above as below.
    pub(super) fn balance(&mut self) {
        for place in self.places.iter_mut().filter(|place| !place.fixed) {
            let density = place.density - imbalance(self.errors[place.fan][place.point]) as f32;
            place.density = density.clamp(0.0, 1.0);
        }
    }
}

/// Half of the sides of the smallest rectangle that has the corners.
pub(super) fn smallest(corners: &[Corner; 4]) -> DVec2 {
    let side = |a: usize, b: usize, axis: usize| {
        if corners[a].far[axis].is_finite() {
            (corners[a].tip[axis] - corners[a].far[axis]) / 2.0
        } else {
            f64::midpoint(corners[a].tip[axis], corners[b].tip[axis]) + APART / 2.0
        }
    };
    DVec2::new(
        side(0, 1, 0).max(side(2, 3, 0)),
        side(0, 3, 1).max(side(1, 2, 1)),
    )
}
