//! Strips along a gentle convex curve, such as an ellipse: one whose circles of curvature are all larger than the light's disc, so that
//! the penumbra is a band of one width and the umbra is as smooth as the outline.
//!
//! Rings lie where density is as steep as at the best knots of a straight edge's profile. Their vertices are opposite to the middles of
//! the next ring's chords, as many on each: where one ring had many and the next few, what joins them would go far along, and be off by
//! more than both. What comes out is measured, its densities are balanced, and it is made finer until it is within the
//! tolerance. No triangulator is needed.

mod curve;
mod strips;

use core::f64::consts::FRAC_2_PI;
use std::borrow::Cow;

use glam::DVec2;
use libm::ceil;

use self::curve::Curve;
use self::strips::Strips;
use super::field::Field;
use super::profile::{Knot, Pieces, Profile};
use super::rounding::{NARROWEST, rounding_levels, step};
use super::samples::Samples;
use super::search;
use super::strips::join::RingVertex;
use super::{MeshOptions, MeshVertex, ShadowMesh};
use crate::outline::Outline;
use crate::shadow::Shadow;

/// How far the chords of the outermost and the innermost ring may be from these, over the width of the strip beside them.
const BEYOND: f64 = 0.04;

/// Shares of the error that are tried for pieces across.
const SHARES: u8 = 20;

/// How far the lines that strips go along may be from the curve, over the penumbra radius.
const FLATNESS: f64 = 1e-3;

/// Error is sampled: between samples it may be larger by the rest.
const SAMPLED: f64 = 0.97;

/// A gentle convex outline seen through a penumbra radius.
#[derive(Debug)]
pub(super) struct Gentle {
    curve: Curve,
    radius: f64,
    /// How far the curve's lines may be from it.
    flatness: f64,
}

/// A triangulation.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) places: Vec<DVec2>,
    pub(super) densities: Vec<f64>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The largest error, in density.
    pub(super) error: f64,
}

/// Which rings there are.
#[derive(Debug)]
struct Rings {
    /// Between the outermost and the innermost: the place across a straight edge, outwards in penumbra radii, and how much less than
    /// exact density is.
    inner: Vec<[f64; 2]>,
    /// How many vertices each of these has, and each of the two others.
    count: usize,
    end_count: usize,
}

impl Rings {
    fn vertices(&self) -> usize {
        self.count * self.inner.len() + 2 * self.end_count
    }
}

/// Strips while they are looked for.
struct Tried<'a> {
    gentle: &'a Gentle,
    field: &'a mut Field,
    max_vertices: usize,
    strips: Strips,
    samples: Samples,
}

impl search::Strips for Tried<'_> {
    fn make(&mut self, aim: f64) -> bool {
        let rings = self.gentle.rings(aim);
        let Some(rings) = rings.filter(|rings| rings.vertices() <= self.max_vertices) else {
            return false;
        };
        self.gentle.lay(&rings, self.field, &mut self.strips);
        self.strips.are_ordered()
    }

    fn error(&mut self, limit: f64) -> f64 {
        self.strips.measure(self.field, limit, &mut self.samples)
    }

    fn balance(&mut self) {
        self.strips.balance();
    }
}

impl Shadow {
    /// Whether the outline is one gentle convex curve.
    pub(crate) fn is_gentle(&self) -> bool {
        self.radius() > 0.0 && self.gentle_curve().is_some()
    }

    /// The outline, a place in its middle that `f32` holds, and the curve about that, if it is one.
    fn gentle_curve(&self) -> Option<(Cow<'_, Outline>, DVec2, Gentle)> {
        let radius = self.radius();
        let flat = radius * FLATNESS;
        let outline = self.outline(flat);
        let (min, max) = outline.bounds()?;
        if outline.loops.len() > 1 || radius < step(min, max) * NARROWEST {
            return None;
        }
        let center = min.midpoint(max).as_vec2().as_dvec2();
        let mut polygons = outline.moved(-center).polygons(flat);
        let points = polygons.pop().filter(|_| polygons.is_empty())?;
        let curve = Gentle::new(points, radius, flat)?;
        Some((outline, center, curve))
    }

    /// The mesh in strips along the outline, if that is one gentle convex curve.
    pub(super) fn gentle(&self, options: &MeshOptions) -> Option<ShadowMesh> {
        let (levels, radius) = (options.tolerance.as_levels(), self.radius());
        if options.profile != Profile::Disc || radius == 0.0 {
            return None;
        }
        let (outline, center, curve) = self.gentle_curve()?;
        let (min, max) = outline.bounds()?;
        let rounding = rounding_levels(step(min - radius, max + radius), radius);
        let (mut field, unsure) = self.field(&outline, levels, center);
        let limit = (levels - rounding) / 255.0 - unsure;
        if limit <= 0.0 {
            return None;
        }
        let found = curve.mesh(&mut field, limit, options.max_vertices)?;
        let vertices = found.places.iter().zip(&found.densities);
        let vertex = |(at, density): (&DVec2, &f64)| MeshVertex {
            position: (*at + center).as_vec2().to_array(),
            density: *density as f32,
        };
        Some(ShadowMesh {
            vertices: vertices.map(vertex).collect(),
            indices: found.triangles.into_flattened(),
            error_levels: (found.error + unsure) * 255.0 + rounding,
            incomplete: None,
        })
    }
}

impl Gentle {
    /// A loop of lines within `flatness` of an outline, if that is one.
    fn new(points: Vec<DVec2>, radius: f64, flatness: f64) -> Option<Self> {
        Some(Self {
            curve: Curve::new(points, radius, flatness)?,
            radius,
            flatness,
        })
    }

    /// Triangles within an error (density) of a field, of no more than so many vertices, if any are found.
    pub(super) fn mesh(&self, field: &mut Field, limit: f64, max_vertices: usize) -> Option<Found> {
        let mut tried = Tried {
            gentle: self,
            field,
            max_vertices,
            strips: Strips::default(),
            samples: Samples::default(),
        };
        let error = search::within(SAMPLED * limit, &mut tried)?;
        let strips = tried.strips;
        Some(Found {
            places: strips.places,
            densities: strips.densities,
            triangles: strips.triangles,
            error: error / SAMPLED,
        })
    }

    /// The rings of fewest vertices within an error: what pieces across take of it is left to chords along.
    fn rings(&self, error: f64) -> Option<Rings> {
        let rings = |share: u8| {
            let pieces = Pieces::within(error * f64::from(share) / f64::from(SHARES));
            let along = error - pieces.error;
            let [_, inner @ .., _] = &pieces.knots[..] else {
                return None;
            };
            // Knots begin where density is 0.
            let ring = |knot: &Knot| [-knot.t, Profile::Disc.at(knot.t) - knot.value];
            let inner: Vec<_> = inner.iter().map(ring).collect();
            (along > 0.0).then(|| {
                let count = self.count(&inner, along);
                Rings {
                    count,
                    end_count: self.end_count(&inner, count),
                    inner,
                }
            })
        };
        let all = (1..SHARES).filter_map(rings);
        all.min_by_key(Rings::vertices)
    }

    /// How many vertices rings have so that their chords are off by so much, half of it to either side.
    fn count(&self, inner: &[[f64; 2]], along: f64) -> usize {
        let count = |[t, _]: &[f64; 2]| {
            let bend: f64 = self.curve.bends(t * self.radius).sum();
            // What a straight edge's density grows by.
            let slope = FRAC_2_PI / self.radius * (1.0 - t * t).sqrt();
            bend * (slope / (16.0 * along)).sqrt()
        };
        ceil(inner.iter().map(count).fold(3.0, f64::max)) as usize
    }

    /// How many the outermost and the innermost have: half as many, unless their chords would be far from them.
    fn end_count(&self, inner: &[[f64; 2]], count: usize) -> usize {
        let steepest = inner.iter().map(|[t, _]| t.abs()).fold(0.0, f64::max);
        let width = (1.0 - steepest) * self.radius;
        let bend: f64 = self.curve.bends(self.radius).sum();
        let least = ceil(bend / (8.0 * BEYOND * width).sqrt()) as usize;
        count.div_ceil(2).max(least)
    }

    /// Lays the rings from the outermost on and joins them.
    fn lay(&self, rings: &Rings, field: &mut Field, strips: &mut Strips) {
        strips.clear();
        let (mut outer, mut inner) = (Vec::new(), Vec::new());
        let last = rings.inner.len() + 1;
        for ring in 0..=last {
            inner.clear();
            self.lay_ring(rings, ring, strips, &mut inner);
            if ring > 0 {
                strips.join(&outer, &inner);
            }
            core::mem::swap(&mut outer, &mut inner);
        }
        strips.fill(&outer);
        strips.raise(field);
    }

    fn lay_ring(
        &self,
        rings: &Rings,
        ring: usize,
        strips: &mut Strips,
        laid: &mut Vec<RingVertex>,
    ) {
        let inner = ring.checked_sub(1).and_then(|ring| rings.inner.get(ring));
        let count = match inner {
            Some(_) => rings.count,
            None => rings.end_count,
        };
        let step = self.curve.bends(0.0).sum::<f64>() / count as f64;
        let begins = if ring.is_multiple_of(2) { 0.25 } else { 0.75 };
        self.curve.stations(begins * step, step, count, |station| {
            let distance = match inner {
                Some([t, _]) => self.radius * station.distance_at(*t),
                // Chords touch it from outside.
                None if ring == 0 => {
                    let chord = step * step / 8.0 * self.curve.most_growth(self.radius);
                    self.radius + self.flatness + chord
                }
                None => -self.radius - 2.0 * self.flatness,
            };
            let at = station.at + station.normal * distance;
            let index = match inner {
                Some([_, less]) => strips.push(at, *less),
                None => strips.push_fixed(at, if ring == 0 { 0.0 } else { 1.0 }),
            };
            laid.push(RingVertex {
                quarter: 0,
                turn: 4.0 * station.turn,
                index,
                at,
            });
        });
    }
}
