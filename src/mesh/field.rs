//! Densities that a mesh is measured against.

use glam::DVec2;

use super::cells::Cells;
use super::tilted::TiltedCells;

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
