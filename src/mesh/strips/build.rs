//! Templates: strips for one set of corners, or for all between two sets, measured and made finer until they keep their tolerance.
//!
//! Between two sets vertices go straight from where they are for the one to where they are for the other. At a point that moves
//! with its triangle the error is then in between as well, but for what density itself bends on such a short way: that is
//! measured at quarters of the way, and by a sixteenth of what it is half-way it may be more than there.

mod measure;
mod state;

use glam::DVec2;
use libm::ceil;

use self::measure::{Look, Measure};
use self::state::State;
use super::corner::Corner;
use super::fan::{Bends, Counts, Rings};
use super::join::{RingVertex, fill, join};
use super::ray::MIDDLE;
use crate::mesh::search::{Strips, within};

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
    /// The corner that it belongs to, as in [`SIGNS`](super::SIGNS).
    pub(super) quarter: usize,
    /// From where that corner's sides meet, and what is added on the way to the span's end.
    pub(super) offset: DVec2,
    pub(super) shift: DVec2,
    pub(super) density: f32,
    pub(super) rise: f32,
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

/// Strips for one span, while they are looked for.
struct Tried<'a> {
    builder: &'a mut Builder,
    bends: Bends,
    /// How many of the span's ends differ.
    count: usize,
}

impl Strips for Tried<'_> {
    fn make(&mut self, aim: f64) -> bool {
        let rings = Rings {
            anchored: self.builder.fan_of != [0; 4],
            ..rings(&self.bends, aim)
        };
        self.builder.place(self.count, &rings) && self.builder.join(self.count, &rings)
    }

    fn error(&mut self, limit: f64) -> f64 {
        self.builder.error(self.count, limit)
    }

    fn balance(&mut self) {
        for end in &mut self.builder.ends[..self.count] {
            end.balance();
        }
    }
}

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
        let mut tried = Tried {
            builder: self,
            bends,
            count,
        };
        template.error_levels = f64::INFINITY;
        if let Some(error) = within(limit, &mut tried) {
            self.finish(count, template);
            template.error_levels = error / SAMPLED * 255.0 + unseen;
        }
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
            .all(|end| end.is_ordered(&self.triangles))
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
                if !between.is_ordered(triangles) {
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

/// How many rings, and how fine: as few triangles as `error` (density) allows.
fn rings(bends: &Bends, error: f64) -> Rings {
    let mut best = (f64::INFINITY, Rings::default());
    // What pieces across take of the error is left to pieces along rings: more rings, fewer columns.
    for share in 1..SHARES {
        let across = error * f64::from(share) / f64::from(SHARES);
        let count = |bend: f64| ceil(bend / (4.0 * across.sqrt()) - MIDDLE).max(0.0);
        let (outside, inside) = (count(bends.outside), count(bends.inside));
        let piece = (bends.outside / (outside + MIDDLE)).max(bends.inside / (inside + MIDDLE));
        let across = piece * piece / 16.0;
        let along = error - across;
        let columns = bends.along / along.sqrt() + SIDE_COLUMNS;
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
