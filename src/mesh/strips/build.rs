//! Templates: strips for one set of corners, measured and made finer until they keep their tolerance.

use std::collections::HashSet;

use glam::DVec2;
use libm::{ceil, sqrt};

use super::corner::Corner;
use super::fan::{Bends, Fan, Rings};
use super::ray::MIDDLE;
use super::{APART, SIGNS};
use crate::mesh::samples::{Samples, Weights, mix, mix_densities};

/// Strips in penumbra radii, for rectangles of any size that have these corners.
#[derive(Debug, Default)]
pub(super) struct Template {
    key: Option<([Corner; 4], f64)>,
    pub(super) vertices: Vec<Vertex>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The largest error; infinite where no mesh was found.
    pub(super) error_levels: f64,
    /// The least height of a triangle.
    pub(super) thinnest: f64,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    /// The corner that it belongs to, as in [`SIGNS`].
    pub(super) quarter: usize,
    /// From where that corner's sides meet.
    pub(super) offset: DVec2,
    pub(super) density: f32,
}

/// A vertex of a ring: where it comes round the middle, in quarters, and its number.
#[derive(Debug, Clone, Copy)]
struct RingVertex {
    turn: f64,
    index: u32,
    at: DVec2,
}

/// Where a vertex of a template is, and comes from.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// From the middle of the smallest rectangle that has the template's corners.
    at: DVec2,
    fan: usize,
    point: usize,
    /// Whether its density is 0 or 1 by definition.
    fixed: bool,
}

/// Makes templates. It keeps its memory.
#[derive(Debug, Default)]
pub(super) struct Builder {
    fans: [Fan; 4],
    outer: Vec<RingVertex>,
    inner: Vec<RingVertex>,
    /// The vertices of the template.
    places: Vec<Place>,
    /// For each fan's points, the least and the largest error found beside them.
    errors: [Vec<[f64; 2]>; 4],
    /// The triangles of one corner that speak for those of equal corners, by their fan and points.
    measured: HashSet<[usize; 4]>,
    samples: Samples,
}

impl Template {
    pub(super) fn is_for(&self, corners: &[Corner; 4], levels: f64) -> bool {
        self.key == Some((*corners, levels))
    }
}

/// Error is sampled: between samples it may be larger by the rest.
const SAMPLED: f64 = 0.97;

/// Into how many parts samples cut a triangle's sides: while a template is looked for, and to be sure of it.
const COARSE: u32 = 4;
const FINE: u32 = 8;

/// How far samples are apart at most, in penumbra radii: long triangles run past corners that are shorter than a part.
const SPACING: f64 = 0.2;

/// By how much rectangles are also longer than the smallest one, in penumbra radii: triangles along their sides slant less.
const STRETCH: f64 = 4.0;

/// From which part of the limit on the way from samples to the tops beside them is gone.
const NEAR: f64 = 0.7;

/// Templates of fewer triangles take more samples each, up to so many times the parts.
const FEW: f64 = 400.0;
const MOST: u32 = 3;

/// The share of the tolerance that is aimed at first: rules that leave out how bends along and across meet.
const FIRST_AIM: f64 = 1.1;

/// By how much the aim shrinks from try to try, and how many there are.
const COARSEST_STEP: f64 = 0.95;
const FINEST_STEP: f64 = 0.8;
const TRIES: usize = 14;

/// How often vertices' densities are balanced before strips are made finer.
const BALANCES: usize = 4;

/// How much of what would balance the samples beside a vertex it is moved by, and from which weight on they count.
const BALANCE: f64 = 0.8;
const BESIDE: f64 = 0.2;

impl Builder {
    /// Makes the template for corners within a tolerance.
    pub(super) fn build(&mut self, corners: &[Corner; 4], levels: f64, template: &mut Template) {
        template.key = Some((*corners, levels));
        // Equal corners share a fan.
        let fan_of =
            [0, 1, 2, 3].map(|i: usize| (0..i).find(|&j| corners[j] == corners[i]).unwrap_or(i));
        let mut bends = Bends::default();
        for i in (0..4).filter(|&i| fan_of[i] == i) {
            bends = bends.max(self.fans[i].sample(&corners[i]));
        }
        let limit = SAMPLED * levels / 255.0;
        let mut aim = FIRST_AIM * limit;
        for _ in 0..TRIES {
            let rings = Rings {
                anchored: fan_of != [0; 4],
                ..rings(&bends, aim)
            };
            let umbra = corners[0].has_umbra();
            let placed = (0..4)
                .filter(|&i| fan_of[i] == i)
                .all(|i| self.fans[i].place(&corners[i], &rings, umbra));
            let mut error = f64::INFINITY;
            if placed && self.join_rings(corners, &fan_of, &rings, template) {
                for _ in 0..=BALANCES {
                    error = self.measure(corners, &fan_of, template, COARSE, f64::INFINITY);
                    if error <= limit {
                        error = self.measure(corners, &fan_of, template, FINE, NEAR * limit);
                    }
                    if error <= limit {
                        template.error_levels = error / SAMPLED * 255.0;
                        return;
                    }
                    self.balance(template);
                }
            }
            aim *= (limit / error).clamp(FINEST_STEP, COARSEST_STEP);
        }
        template.error_levels = f64::INFINITY;
    }

    /// Joins the fans' rings to triangles; no where they would cross.
    fn join_rings(
        &mut self,
        corners: &[Corner; 4],
        fan_of: &[usize; 4],
        rings: &Rings,
        template: &mut Template,
    ) -> bool {
        template.vertices.clear();
        template.triangles.clear();
        template.thinnest = f64::INFINITY;
        self.places.clear();
        let half = smallest(corners);
        let mut sound = true;
        let umbra = corners[0].has_umbra();
        let last = rings.count() + 1;
        for ring in 0..=last {
            self.inner.clear();
            for (quarter, (corner, sign)) in corners.iter().zip(SIGNS).enumerate() {
                let fan = &self.fans[fan_of[quarter]];
                let first = fan.ring(ring).start;
                let points = &fan.points[fan.ring(ring)];
                // Mirrored once, a corner runs the other way round.
                let mirrored = quarter % 2 == 1;
                for i in 0..points.len() {
                    let point = points[if mirrored { points.len() - 1 - i } else { i }];
                    let turn = point.turn();
                    let mut vertex = RingVertex {
                        turn: quarter as f64 + if mirrored { 1.0 - turn } else { turn },
                        index: template.vertices.len() as u32,
                        at: sign * (half - corner.tip + point.at),
                    };
                    // Of a narrow umbra, or none, corners coincide.
                    let twins = [self.inner.last(), self.inner.first()]
                        .into_iter()
                        .flatten();
                    let near = |twin: &&RingVertex| (twin.at - vertex.at).length() < SAME;
                    if let Some(twin) = { twins }.find(near) {
                        vertex.index = twin.index;
                    } else {
                        self.places.push(Place {
                            at: vertex.at,
                            fan: fan_of[quarter],
                            point: first + if mirrored { points.len() - 1 - i } else { i },
                            fixed: ring == 0 || (umbra && ring == last),
                        });
                        template.vertices.push(Vertex {
                            quarter,
                            offset: sign * (point.at - corner.tip),
                            density: point.density as f32,
                        });
                    }
                    self.inner.push(vertex);
                }
            }
            if ring > 0 {
                sound &= join(&self.outer, &self.inner, template);
            }
            core::mem::swap(&mut self.outer, &mut self.inner);
        }
        if umbra {
            sound &= fill(&self.outer, template);
        }
        sound
    }

    /// The largest error of the template's triangles, in density, by samples; each vertex keeps the extremes beside it.
    /// Where a sample's error is above `near` the top beside it counts.
    fn measure(
        &mut self,
        corners: &[Corner; 4],
        fan_of: &[usize; 4],
        template: &Template,
        parts: u32,
        near: f64,
    ) -> f64 {
        let half = smallest(corners);
        let whole = |stretch: f64| Corner {
            tip: half + stretch,
            far: -half - stretch,
            radii: corners.map(|corner| corner.radii[0]),
        };
        let stretches = corners[0].far.x.is_infinite();
        // A few large triangles take more samples each.
        let more = sqrt(FEW / template.triangles.len() as f64) as u32;
        let parts = parts * more.clamp(1, MOST);
        for (errors, fan) in self.errors.iter_mut().zip(&self.fans) {
            errors.clear();
            errors.resize(fan.points.len(), [0.0; 2]);
        }
        self.measured.clear();
        let mut most: f64 = 0.0;
        for triangle in &template.triangles {
            let places = triangle.map(|i| self.places[i as usize]);
            let at = places.map(|place| place.at);
            let densities = triangle.map(|i| f64::from(template.vertices[i as usize].density));
            // One of equal corners speaks for all, but not for what lies between them, nor where rounding cuts the same
            // four vertices the other way.
            let quarters = triangle.map(|i| template.vertices[i as usize].quarter);
            let spans = quarters != [quarters[0]; 3];
            let mut key = [fan_of[quarters[0]]; 4];
            for (part, place) in key[1..].iter_mut().zip(&places) {
                *part = place.point;
            }
            key[1..].sort_unstable();
            let spoken_for = !spans && !self.measured.insert(key);
            let umbra = densities == [1.0; 3] && places.iter().all(|place| place.fixed);
            if spoken_for || umbra {
                continue;
            }
            for stretch in [0.0, STRETCH] {
                if stretch > 0.0 && !(spans && stretches) {
                    continue;
                }
                let whole = whole(stretch);
                let at = [0, 1, 2].map(|i: usize| at[i] + SIGNS[quarters[i]] * stretch);
                let errors = |samples: &[Weights], errors: &mut [f64]| {
                    for (&weights, error) in samples.iter().zip(errors) {
                        let exact = whole.density(mix(at, weights));
                        *error = mix_densities(densities, weights) - exact;
                    }
                };
                let (error, _) = self.samples.worst(at, parts, SPACING, near, errors);
                most = most.max(error);
                for (weights, error) in self.samples.all() {
                    for (place, weight) in places.into_iter().zip(weights) {
                        if weight >= BESIDE {
                            let [least, most] = &mut self.errors[place.fan][place.point];
                            (*least, *most) = (least.min(error), most.max(error));
                        }
                    }
                }
            }
        }
        most
    }

    /// Moves densities to where the errors beside each vertex are as large above as below.
    fn balance(&self, template: &mut Template) {
        for (vertex, place) in template.vertices.iter_mut().zip(&self.places) {
            if !place.fixed {
                let [least, most] = self.errors[place.fan][place.point];
                let density = vertex.density - (BALANCE * f64::midpoint(least, most)) as f32;
                vertex.density = density.clamp(0.0, 1.0);
            }
        }
    }
}

/// Vertices nearer than this, in penumbra radii, are one.
const SAME: f64 = 1e-3;

/// Half of the sides of the smallest rectangle that has the corners.
fn smallest(corners: &[Corner; 4]) -> DVec2 {
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

/// How many rings, and how fine: as few triangles as `error` (density) allows.
fn rings(bends: &Bends, error: f64) -> Rings {
    let mut best = (f64::INFINITY, Rings::default());
    // What pieces across take of the error is left to pieces along rings: more rings, fewer columns.
    for share in 1..SHARES {
        let across = error * f64::from(share) / f64::from(SHARES);
        let count = |bend: f64| ceil(bend / (4.0 * sqrt(across)) - MIDDLE).max(0.0);
        let (outside, inside) = (count(bends.outside), count(bends.inside));
        let piece = (bends.outside / (outside + MIDDLE)).max(bends.inside / (inside + MIDDLE));
        let across = piece * piece / 16.0;
        let along = error - across;
        let columns = bends.along / sqrt(along) + SIDE_COLUMNS;
        let cost = (outside + inside + 1.0) * columns;
        if cost < best.0 {
            let rings = Rings {
                outside: outside as usize,
                inside: inside as usize,
                along,
                anchored: false,
            };
            best = (cost, rings);
        }
    }
    best.1
}

/// Shares of the error that are tried.
const SHARES: u8 = 20;

/// Strips between two rings cost about as much beside their corners.
const SIDE_COLUMNS: f64 = 2.0;

/// Triangles between a ring and the next one inside; no where the rings cross.
fn join(outer: &[RingVertex], inner: &[RingVertex], template: &mut Template) -> bool {
    let at = |ring: &[RingVertex], i: usize| {
        let vertex = ring[i % ring.len()];
        let turns = if i < ring.len() { 0.0 } else { 4.0 };
        (vertex.turn + turns, vertex)
    };
    let (mut i, mut j) = (0, 0);
    let mut sound = true;
    while i < outer.len() || j < inner.len() {
        let (from, a) = at(outer, i);
        let (to, next) = at(outer, i + 1);
        let (inner_from, b) = at(inner, j);
        let (inner_to, inner_next) = at(inner, j + 1);
        // The side whose middle comes first: its triangle's apex is about opposite.
        if j == inner.len() || (i < outer.len() && from + to <= inner_from + inner_to) {
            sound &= triangle([a, next, b], template);
            i += 1;
        } else {
            sound &= triangle([a, inner_next, b], template);
            j += 1;
        }
    }
    sound
}

/// Triangles that fill a convex ring.
fn fill(ring: &[RingVertex], template: &mut Template) -> bool {
    let (mut first, mut last) = (0, ring.len() - 1);
    let mut sound = true;
    while first + 1 < last {
        sound &= triangle([ring[first], ring[first + 1], ring[last]], template);
        first += 1;
        if first + 1 < last {
            sound &= triangle([ring[first], ring[last - 1], ring[last]], template);
            last -= 1;
        }
    }
    sound
}

/// Adds a triangle, unless two of its vertices are one; no if it is turned round.
fn triangle(corners: [RingVertex; 3], template: &mut Template) -> bool {
    let indices = corners.map(|corner| corner.index);
    if indices[0] == indices[1] || indices[1] == indices[2] || indices[2] == indices[0] {
        return true;
    }
    let [a, b, c] = corners.map(|corner| corner.at);
    let longest = [b - a, c - b, a - c]
        .map(DVec2::length)
        .into_iter()
        .fold(0.0, f64::max);
    let height = (b - a).perp_dot(c - a) / longest;
    template.triangles.push(indices);
    template.thinnest = template.thinnest.min(height);
    height > 0.0
}
