//! Densities that a mesh is measured against.

use glam::DVec2;

use super::cells::{Cells, NOISE};
use super::lighten::lighten;
use super::tilted::TiltedCells;
use crate::outline::{Edge, Outline};
use crate::shadow::Shadow;

/// The part of the tolerance that a strip of chords across a disc, and lines in place of runs of them, may each use up where
/// errors are measured.
pub(super) const FIELD_SHARE: f64 = 0.02;

/// Both of them, and the strips all along the disc's edge where a circle is as large as the disc: π times one across.
pub(super) const CURVED: f64 = 4.2;

/// The density at any point of one shadow.
pub(super) enum Field {
    /// Of one radius.
    Level(Cells),
    /// Of many: samples go by this one.
    Tilted { cells: TiltedCells, radius: f64 },
}

impl Field {
    /// The penumbra radius, in the outline's unit.
    pub(super) fn radius(&self) -> f64 {
        match self {
            Self::Level(cells) => cells.radius(),
            Self::Tilted { radius, .. } => *radius,
        }
    }

    /// The density at a point.
    pub(super) fn at(&mut self, point: DVec2) -> f64 {
        match self {
            Self::Level(cells) => cells.at(point),
            Self::Tilted { cells, .. } => cells.at(point),
        }
    }

    /// The densities at points, best near to one another.
    pub(super) fn at_all(&mut self, points: &[DVec2], densities: &mut [f64]) {
        match self {
            Self::Level(cells) => cells.at_all(points, densities),
            Self::Tilted { cells, .. } => cells.at_all(points, densities),
        }
    }
}

impl Shadow {
    /// What errors are measured against, about a centre, and by how much (density) it may itself be off.
    pub(super) fn field(&self, outline: &Outline, levels: f64, center: DVec2) -> (Field, f64) {
        let radius = self.radius();
        let share = FIELD_SHARE * levels;
        let curved = !self.is_fixed() || outline.edges().any(|e| matches!(e, Edge::Arc(_)));
        let unsure = if curved { CURVED * share / 255.0 } else { 0.0 } + NOISE;
        let mut loops = self.polygons_within(share, 0.0);
        // What is left out of many at once adds up.
        let lighter = share / self.crowding(0.0, true) / 255.0;
        for points in &mut loops {
            for point in &mut *points {
                *point -= center;
            }
            *points = lighten(points, radius, lighter);
        }
        (Field::Level(Cells::new(&loops, radius)), unsure)
    }
}
