//! A cast as chords need it.

use glam::DVec2;

use super::occluder::Occluder;
use crate::compose::caster::{AnyShadow, Cast};
use crate::density::lanes::LANES;
use crate::density::{CURVES, averaged_side};
use crate::grid::Grid;
use crate::shadow::Shadow;
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
    /// As far as a grid may show it.
    pub(super) fn new(cast: &Cast, grid: &Grid) -> Option<Self> {
        let scale = grid.pixels_per_unit();
        let kind = match &cast.shadow {
            AnyShadow::Level(shadow) => {
                let radius = shadow.radius();
                let of_part = |part: &Shadow| part.polygons_within(CURVES, 1.0 / scale);
                // Pixels are worked on together with others that may be beyond the grid.
                let parts = shadow.parts_on(grid, LANES as f64);
                let polygons: Vec<_> = parts.flat_map(of_part).collect();
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

/// The disc of a hard shadow, in pixels: next to the pixel's square it is a point.
const LEAST_RADIUS: f64 = 1e-3;
