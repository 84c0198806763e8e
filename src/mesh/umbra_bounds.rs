//! Where the light is wholly hidden.

use core::f64::consts::PI;

use super::tangents::{projection_circles, tangent_loops};
use crate::apart::around_points;
use crate::shadow::{Bounds, Shadow};

impl Shadow {
    /// The smallest box that holds the umbra, or none where the light is nowhere wholly hidden. Of paths it takes milliseconds, and for
    /// detailed ones under a wide penumbra more.
    #[must_use]
    pub fn umbra_bounds(&self) -> Option<Bounds> {
        let outline = self.exact_outline();
        let (min, max) = outline.bounds()?;
        if self.radius() == 0.0 {
            return Some(Bounds::outwards(min, max));
        }
        // The light is hidden where a disc is within the outline: there is none in a smaller one.
        let disc = PI * self.radius() * self.radius();
        if outline.area() < disc || (max - min).min_element() < 2.0 * self.radius() {
            return None;
        }
        let center = min.midpoint(max);
        let flat = (self.radius() * UMBRA_FLATNESS).max(self.extent() * UMBRA_FACET);
        let circles = projection_circles(&outline.moved(-center), self.radius(), flat);
        let loops = tangent_loops(&circles, 1.0, flat);
        let (min, max) = around_points(loops.into_iter().flatten())?;
        Some(Bounds::outwards(min + center, max + center))
    }
}

/// How far the chords of an umbra's arcs may be from them, over the penumbra radius.
const UMBRA_FLATNESS: f64 = 1e-4;

/// The same over the outline's extent, where the radius is next to nothing.
const UMBRA_FACET: f64 = 1e-7;
