//! What can cast: one shadow on one receiver, of whatever kind.

use glam::DVec2;

use crate::density::alpha::AlphaShadow;
use crate::density::{self, PixelOptions, Sink, reached, tilted};
use crate::grid::Grid;
use crate::scratch::Scratch;
use crate::shadow::Shadow;
use crate::tilted::TiltedShadow;

/// One shadow on one receiver, and what of the light is held back where its casters hide it: `strength` by those that are
/// opaque, and of the rest a part, their `opacity`.
#[derive(Debug)]
pub(crate) struct Cast {
    pub(crate) shadow: AnyShadow,
    pub(crate) strength: f64,
    pub(crate) opacity: f64,
}

impl Cast {
    /// What is held back where the shadow is densest.
    pub(crate) fn weight(&self) -> f64 {
        self.strength * self.opacity
    }
}

/// A shadow of casters parallel to the light, of one that is not, or of an image.
#[derive(Debug)]
pub(crate) enum AnyShadow {
    Level(Shadow),
    Tilted(TiltedShadow),
    Alpha(AlphaShadow),
}

impl AnyShadow {
    /// Gives `sink` the density of every pixel of the grid that is in the shadow and not hidden.
    pub(crate) fn draw(
        &self,
        grid: &Grid,
        options: &PixelOptions<'_>,
        scratch: &mut Scratch,
        sink: &mut dyn Sink,
    ) {
        match self {
            Self::Level(shadow) => density::draw(shadow, grid, options, scratch, sink),
            Self::Tilted(shadow) => tilted::fill(shadow, grid, options.hidden, scratch, sink),
            Self::Alpha(shadow) => shadow.fill(grid, options.hidden, sink),
        }
    }

    /// The box of the pixels that see the shadow, in pixels of which there are so many a scene unit.
    pub(crate) fn reach(&self, per_unit: f64) -> Option<(DVec2, DVec2)> {
        match self {
            Self::Level(shadow) => shadow.reach(per_unit),
            // Its circles are within the box already.
            Self::Tilted(shadow) => shadow.hull().map(|hull| reached(hull, 0.0, per_unit)),
            Self::Alpha(shadow) => Some(reached(shadow.hull(), shadow.radius(), per_unit)),
        }
    }
}
