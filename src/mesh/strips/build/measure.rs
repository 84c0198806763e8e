//! How wrong the triangles are for one set of corners.

use std::collections::HashSet;

use glam::DVec2;

use super::state::{Place, State, smallest};
use crate::mesh::samples::{Samples, Weights, mix, mix_densities};
use crate::mesh::strips::SIGNS;
use crate::mesh::strips::corner::Corner;

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

/// How closely errors are looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Look {
    /// At few samples.
    Few,
    /// At many.
    Many,
    /// And at the tops beside them, until one is above the limit.
    Tops { limit: f64 },
}

/// What measuring errors takes.
#[derive(Debug, Clone, Default)]
pub(super) struct Measure {
    /// The triangles of one corner that speak for those of equal corners, by their fan and points.
    measured: HashSet<[usize; 4]>,
    samples: Samples,
}

impl Measure {
    /// The largest error of triangles, in density; each vertex keeps the extremes of the samples beside it.
    pub(super) fn error(
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
        let rectangles = Rectangles::of(corners);
        // A few large triangles take more samples each.
        let more = (FEW / triangles.len() as f64).sqrt() as u32;
        let parts = parts * more.clamp(1, MOST);
        // Tops come after all samples, whose extremes stay.
        let extremes = limit.is_infinite();
        if extremes {
            for errors in &mut *beside {
                errors.fill([0.0; 2]);
            }
        }
        self.measured.clear();
        let mut known = 0;
        let mut most: f64 = 0.0;
        for triangle in triangles {
            let places = triangle.map(|i| all[i as usize]);
            let at = places.map(|place| place.at);
            let densities = places.map(|place| f64::from(place.density));
            let quarters = places.map(|place| place.quarter);
            let spans = quarters != [quarters[0]; 3];
            if self.is_known(&places, fan_of, spans) {
                continue;
            }
            for stretch in rectangles.stretches(spans) {
                let whole = rectangles.whole(stretch);
                let at = [0, 1, 2].map(|i: usize| at[i] + SIGNS[quarters[i]] * stretch);
                let first = known;
                let errors = |samples: &[Weights], errors: &mut [f64]| {
                    let on_the_way_up = known > first;
                    let density = |weights: Weights| whole.density(mix(at, weights));
                    for (&weights, error) in samples.iter().zip(errors) {
                        let exact = if on_the_way_up {
                            density(weights)
                        } else {
                            exact.next(&mut known, || density(weights))
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
                self.samples.each_beside(|corner, error| {
                    let place = places[corner];
                    let [least, most] = &mut beside[place.fan][place.point];
                    (*least, *most) = (least.min(error), most.max(error));
                });
            }
        }
        exact.complete = true;
        most
    }

    /// Whether a triangle tells nothing: another one speaks for it, or it is all umbra.
    fn is_known(&mut self, places: &[Place; 3], fan_of: &[usize; 4], spans: bool) -> bool {
        let spoken_for = key(places, fan_of, spans).is_some_and(|key| !self.measured.insert(key));
        spoken_for
            || places
                .iter()
                .all(|place| place.fixed && place.density == 1.0)
    }
}

/// The rectangles with the same corners that errors are measured on, each by how much it is longer than the smallest one.
struct Rectangles {
    /// Half of the smallest one's sides.
    half: DVec2,
    radii: [f64; 4],
    longest: DVec2,
}

impl Rectangles {
    fn of(corners: &[Corner; 4]) -> Self {
        let longer = |axis: usize| {
            if corners[0].far[axis].is_infinite() {
                STRETCH
            } else {
                0.0
            }
        };
        Self {
            half: smallest(corners),
            radii: corners.map(|corner| corner.radii[0]),
            longest: DVec2::new(longer(0), longer(1)),
        }
    }

    /// Those on which triangles differ that span two corners, or lie at one.
    fn stretches(&self, spans: bool) -> impl Iterator<Item = DVec2> {
        let lengths = if spans && self.longest != DVec2::ZERO {
            2
        } else {
            1
        };
        [DVec2::ZERO, self.longest].into_iter().take(lengths)
    }

    fn whole(&self, stretch: DVec2) -> Corner {
        Corner {
            tip: self.half + stretch,
            far: -self.half - stretch,
            radii: self.radii,
        }
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
