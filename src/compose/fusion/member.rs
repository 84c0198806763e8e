//! A cast as chords need it.

use glam::DVec2;

use super::occluder::Occluder;
use crate::compose::caster::{AnyShadow, Cast};
use crate::density::{averaged_side, flatness};
use crate::tilted::Circle;

/// A cast, and what of it its chords need.
pub(super) struct Member {
    pub(super) strength: f32,
    pub(super) opacity: f32,
    pub(super) kind: Kind,
}

pub(super) enum Kind {
    /// Of one radius.
    Level(Occluder),
    /// Of many radii.
    Tilted(Vec<Vec<Circle>>),
}

impl Member {
    pub(super) fn new(cast: &Cast, scale: f64) -> Option<Self> {
        let kind = match &cast.shadow {
            AnyShadow::Level(shadow) => {
                let radius = shadow.radius();
                let flat = flatness(FLATNESS, radius, 1.0 / scale);
                let polygons = shadow.outline(flat).polygons(flat);
                let radius = (radius * scale).max(LEAST_RADIUS);
                Kind::Level(Occluder::new(&polygons, scale, radius))
            }
            AnyShadow::Tilted(shadow) => {
                let place = |circle: &Circle| circle.placed(scale, DVec2::ZERO);
                let loops = shadow.loops.iter();
                Kind::Tilted(
                    loops
                        .map(|circles| circles.iter().map(place).collect())
                        .collect(),
                )
            }
            AnyShadow::Alpha(_) => return None,
        };
        Some(Self {
            strength: cast.strength as f32,
            opacity: cast.opacity as f32,
            kind,
        })
    }

    /// The side of the square about its centre that a pixel sees it through, in pixels.
    pub(super) fn averaged_side(&self) -> f64 {
        match &self.kind {
            Kind::Level(occluder) => averaged_side(occluder.radius),
            Kind::Tilted(_) => 0.0,
        }
    }
}

/// How far lines in place of curves may move what casters hide together, in levels.
const FLATNESS: f64 = 0.2;

/// The disc of a hard shadow, in pixels: next to the pixel's square it is a point.
const LEAST_RADIUS: f64 = 1e-3;
