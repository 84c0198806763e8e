//! Templates: strips for one set of corners, or for all between two sets, measured and made finer until they keep their tolerance.
//!
//! Between two sets vertices go straight from where they are for the one to where they are for the other. At a point that moves
//! with its triangle the error is then in between as well, but for what density itself bends on such a short way: that is
//! measured at quarters of the way, and by a
//! sixteenth of what it is half-way it may be more than there.

use std::collections::HashSet;

use glam::DVec2;
use libm::{ceil, sqrt};

use super::corner::Corner;
use super::fan::{Bends, Counts, Fan, Rings};
use super::join::{RingVertex, fill, join};
use super::ray::MIDDLE;
use super::{APART, SIGNS};
use crate::mesh::samples::{Samples, Weights, mix, mix_densities};

/// Strips in penumbra radii, for rectangles of any size that have these corners.
#[derive(Debug, Clone, Default)]
pub(super) struct Template {
    key: Option<(Span, f64)>,
    pub(super) vertices: Vec<Vertex>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The largest error; infinite where no mesh was found.
    pub(super) error_levels: f64,
    /// The least height of a triangle.
    pub(super) thinnest: f64,
}

/// The corners that a template is for: from these to those, or twice the same.
pub(super) type Span = [[Corner; 4]; 2];

#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    /// The corner that it belongs to, as in [`SIGNS`].
    pub(super) quarter: usize,
    /// From where that corner's sides meet, and what is added on the way to the span's end.
    pub(super) offset: DVec2,
    pub(super) shift: DVec2,
    pub(super) density: f32,
    pub(super) rise: f32,
}

/// A vertex for one set of corners.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// From the middle of the smallest rectangle that has the corners.
    at: DVec2,
    quarter: usize,
    offset: DVec2,
    density: f32,
    /// The point that it comes from.
    fan: usize,
    point: usize,
    /// Whether its density is 0 or 1 by definition.
    fixed: bool,
}

/// One set of corners, and the vertices for it.
#[derive(Debug, Clone, Default)]
struct State {
    corners: [Corner; 4],
    fans: [Fan; 4],
    places: Vec<Place>,
    /// For each fan's points, the least and the largest error found beside them.
    errors: [Vec<[f64; 2]>; 4],
    /// The exact densities at few samples and at many.
    few: Exact,
    many: Exact,
}

/// Exact densities at the samples of triangles that stay where they are while their own densities are balanced.
#[derive(Debug, Clone, Default)]
struct Exact {
    densities: Vec<f64>,
    /// Whether there are all of them.
    complete: bool,
}

/// Makes templates. It keeps its memory.
#[derive(Debug, Clone, Default)]
pub(super) struct Builder {
    /// The span's ends.
    ends: [State; 2],
    between: State,
    /// For each corner the first one that equals it: they share its fan.
    fan_of: [usize; 4],
    counts: [Counts; 4],
    outer: Vec<RingVertex>,
    inner: Vec<RingVertex>,
    triangles: Vec<[u32; 3]>,
    measure: Measure,
}

/// How closely errors are looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Look {
    /// At few samples.
    Few,
    /// At many.
    Many,
    /// And at the tops beside them, until one is above the limit.
    Tops { limit: f64 },
}

/// What measuring errors takes.
#[derive(Debug, Clone, Default)]
struct Measure {
    /// The triangles of one corner that speak for those of equal corners, by their fan and points.
    measured: HashSet<[usize; 4]>,
    samples: Samples,
}

impl Template {
    pub(super) fn is_for(&self, span: &Span, levels: f64) -> bool {
        self.key.is_some_and(|key| key == (*span, levels))
    }
}

/// Error is sampled: between samples it may be larger by the rest.
const SAMPLED: f64 = 0.97;

/// Where errors between the ends of a span are looked at, and what they may be more between there, in levels: half-way
/// through the first span, the worst, they are 0.15 level away from the straight way.
const SHARES_BETWEEN: [f64; 3] = [0.5, 0.25, 0.75];
const UNSEEN: f64 = 0.01;

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
    /// Makes the template for a span of corners within a tolerance.
    pub(super) fn build(&mut self, span: &Span, levels: f64, template: &mut Template) {
        template.key = Some((*span, levels));
        let corners = &span[0];
        self.fan_of =
            [0, 1, 2, 3].map(|i: usize| (0..i).find(|&j| corners[j] == corners[i]).unwrap_or(i));
        // Of a span without length one end is all.
        let count = if span[0] == span[1] { 1 } else { 2 };
        let mut bends = Bends::default();
        for (end, corners) in self.ends[..count].iter_mut().zip(span) {
            end.corners = *corners;
            for i in (0..4).filter(|&i| self.fan_of[i] == i) {
                bends = bends.max(end.fans[i].sample(&corners[i]));
            }
        }
        let unseen = if count > 1 { UNSEEN } else { 0.0 };
        let limit = SAMPLED * (levels - unseen) / 255.0;
        let mut aim = FIRST_AIM * limit;
        for _ in 0..TRIES {
            let rings = Rings {
                anchored: self.fan_of != [0; 4],
                ..rings(&bends, aim)
            };
            let mut error = f64::INFINITY;
            if self.place(count, &rings) && self.join(count, &rings) {
                for _ in 0..=BALANCES {
                    error = self.error(count, limit);
                    if error <= limit {
                        self.finish(count, template);
                        template.error_levels = error / SAMPLED * 255.0 + unseen;
                        return;
                    }
                    for end in &mut self.ends[..count] {
                        end.balance();
                    }
                }
            }
            aim *= (limit / error).clamp(FINEST_STEP, COARSEST_STEP);
        }
        template.error_levels = f64::INFINITY;
    }

    /// Places the points of all fans, as many for the one end as for the other; no where a strip has no width.
    fn place(&mut self, count: usize, rings: &Rings) -> bool {
        let Self {
            ends,
            fan_of,
            counts,
            ..
        } = self;
        let ends = &mut ends[..count];
        for i in (0..4).filter(|&i| fan_of[i] == i) {
            counts[i].clear();
            for State { corners, fans, .. } in &mut *ends {
                if !fans[i].count(&corners[i], rings, &mut counts[i]) {
                    return false;
                }
            }
            for end in &mut *ends {
                end.fans[i].place(&end.corners[i], rings, &counts[i]);
                end.errors[i].resize(end.fans[i].points.len(), [0.0; 2]);
            }
        }
        true
    }

    /// Joins the fans' rings to triangles; no where they would cross.
    fn join(&mut self, count: usize, rings: &Rings) -> bool {
        let [first, rest @ ..] = &mut self.ends;
        self.triangles.clear();
        let umbra = first.corners[0].has_umbra();
        first.clear();
        for ring in 0..=rings.count() + 1 {
            first.lay(ring, rings, &self.fan_of, &mut self.inner);
            if ring > 0 {
                join(&self.outer, &self.inner, &mut self.triangles);
            }
            core::mem::swap(&mut self.outer, &mut self.inner);
        }
        if umbra {
            fill(&self.outer, &mut self.triangles);
        }
        for end in &mut rest[..count - 1] {
            end.clear();
            for ring in 0..=rings.count() + 1 {
                end.lay(ring, rings, &self.fan_of, &mut self.inner);
            }
        }
        self.ends[..count]
            .iter()
            .all(|end| end.thinnest(&self.triangles) > 0.0)
    }

    /// The largest error, in density: looked at more closely as long as it is not too large.
    fn error(&mut self, count: usize, limit: f64) -> f64 {
        let Self {
            ends,
            between,
            fan_of,
            triangles,
            measure,
            ..
        } = self;
        let ends = &mut ends[..count];
        let mut worst = f64::INFINITY;
        for look in [Look::Few, Look::Many, Look::Tops { limit }] {
            let errors = ends
                .iter_mut()
                .map(|end| measure.error(end, fan_of, triangles, look));
            worst = errors.fold(0.0, f64::max);
            if worst > limit {
                return worst;
            }
        }
        if let [from, to] = ends {
            for share in SHARES_BETWEEN {
                between.mix(from, to, share);
                if between.thinnest(triangles) <= 0.0 {
                    return f64::INFINITY;
                }
                let error = measure.error(between, fan_of, triangles, Look::Tops { limit });
                worst = worst.max(error);
                if worst > limit {
                    return worst;
                }
            }
        }
        worst
    }

    /// Writes what was found into a template.
    fn finish(&self, count: usize, template: &mut Template) {
        let [from, to] = [&self.ends[0], &self.ends[count - 1]];
        template.vertices.clear();
        let vertices = from.places.iter().zip(&to.places).map(|(from, to)| Vertex {
            quarter: from.quarter,
            offset: from.offset,
            shift: to.offset - from.offset,
            density: from.density,
            rise: to.density - from.density,
        });
        template.vertices.extend(vertices);
        template.triangles.clone_from(&self.triangles);
        let thinnest = |state: &State| state.thinnest(&template.triangles);
        template.thinnest = thinnest(from).min(thinnest(to));
    }
}

impl State {
    /// Forgets the vertices.
    fn clear(&mut self) {
        self.places.clear();
        for exact in [&mut self.few, &mut self.many] {
            exact.densities.clear();
            exact.complete = false;
        }
    }

    /// Lays a ring through the points of all corners.
    fn lay(&mut self, ring: usize, rings: &Rings, fan_of: &[usize; 4], laid: &mut Vec<RingVertex>) {
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
    fn mix(&mut self, from: &Self, to: &Self, share: f64) {
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

    /// The least height of a triangle; not above 0 where one is turned round.
    fn thinnest(&self, triangles: &[[u32; 3]]) -> f64 {
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
    fn balance(&mut self) {
        for place in self.places.iter_mut().filter(|place| !place.fixed) {
            let [least, most] = self.errors[place.fan][place.point];
            let density = place.density - (BALANCE * f64::midpoint(least, most)) as f32;
            place.density = density.clamp(0.0, 1.0);
        }
    }
}

impl Measure {
    /// The largest error of triangles, in density; each vertex keeps the extremes of the samples beside it.
    fn error(
        &mut self,
        state: &mut State,
        fan_of: &[usize; 4],
        triangles: &[[u32; 3]],
        look: Look,
    ) -> f64 {
        let State {
            corners,
            places: all,
            errors: beside,
            few,
            many,
            ..
        } = state;
        let (exact, parts) = match look {
            Look::Few => (few, COARSE),
            Look::Many | Look::Tops { .. } => (many, FINE),
        };
        let limit = match look {
            Look::Few | Look::Many => f64::INFINITY,
            Look::Tops { limit } => limit,
        };
        let mut known = 0;
        let half = smallest(corners);
        let whole = |stretch: DVec2| Corner {
            tip: half + stretch,
            far: -half - stretch,
            radii: corners.map(|corner| corner.radii[0]),
        };
        let longer = |axis: usize| {
            if corners[0].far[axis].is_infinite() {
                STRETCH
            } else {
                0.0
            }
        };
        let longest = DVec2::new(longer(0), longer(1));
        // A few large triangles take more samples each.
        let more = sqrt(FEW / triangles.len() as f64) as u32;
        let parts = parts * more.clamp(1, MOST);
        // Tops come after all samples, whose extremes stay.
        let extremes = limit.is_infinite();
        if extremes {
            for errors in &mut *beside {
                errors.fill([0.0; 2]);
            }
        }
        self.measured.clear();
        let mut most: f64 = 0.0;
        for triangle in triangles {
            let places = triangle.map(|i| all[i as usize]);
            let at = places.map(|place| place.at);
            let densities = places.map(|place| f64::from(place.density));
            let quarters = places.map(|place| place.quarter);
            let spans = quarters != [quarters[0]; 3];
            let spoken_for =
                key(&places, fan_of, spans).is_some_and(|key| !self.measured.insert(key));
            let umbra = densities == [1.0; 3] && places.iter().all(|place| place.fixed);
            if spoken_for || umbra {
                continue;
            }
            let lengths = if spans && longest != DVec2::ZERO {
                2
            } else {
                1
            };
            for stretch in [DVec2::ZERO, longest].into_iter().take(lengths) {
                let whole = whole(stretch);
                let at = [0, 1, 2].map(|i: usize| at[i] + SIGNS[quarters[i]] * stretch);
                let first = known;
                let errors = |samples: &[Weights], errors: &mut [f64]| {
                    let on_the_way_up = known > first;
                    let density = |weights: Weights| whole.density(mix(at, weights));
                    for (&weights, error) in samples.iter().zip(errors) {
                        let exact = if on_the_way_up {
                            density(weights)
                        } else {
                            if !exact.complete {
                                exact.densities.push(density(weights));
                            }
                            known += 1;
                            exact.densities[known - 1]
                        };
                        *error = mix_densities(densities, weights) - exact;
                    }
                };
                let (error, _) = self.samples.worst(at, parts, SPACING, NEAR * limit, errors);
                if error > limit {
                    return error;
                }
                most = most.max(error);
                if !extremes {
                    continue;
                }
                for (weights, error) in self.samples.all() {
                    for (place, weight) in places.into_iter().zip(weights) {
                        if weight >= BESIDE {
                            let [least, most] = &mut beside[place.fan][place.point];
                            (*least, *most) = (least.min(error), most.max(error));
                        }
                    }
                }
            }
        }
        exact.complete = true;
        most
    }
}

/// What triangles have in common that are mirror images of one another: those of equal corners, and those between two of
/// four equal ones, unless rounding cuts the same four vertices the other way.
fn key(places: &[Place; 3], fan_of: &[usize; 4], spans: bool) -> Option<[usize; 4]> {
    let [a, b, c] = places.map(|place| (place.quarter, place.point));
    // The one alone at its corner, if there is one.
    let [alone, first, second] = if a.0 == b.0 {
        [c, a, b]
    } else if b.0 == c.0 {
        [a, b, c]
    } else if c.0 == a.0 {
        [b, c, a]
    } else {
        return None;
    };
    if spans {
        let pair = [first.1.min(second.1), first.1.max(second.1)];
        // Beside one another along x, along y, or opposite.
        let way = match alone.0.abs_diff(first.0) {
            2 => 2,
            _ if alone.0 / 2 == first.0 / 2 => 0,
            _ => 1,
        };
        return (*fan_of == [0; 4]).then_some([fan_of.len() + way, alone.1, pair[0], pair[1]]);
    }
    let mut key = [fan_of[a.0], a.1, b.1, c.1];
    key[1..].sort_unstable();
    Some(key)
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
