//! What each method takes to draw a shadow on pixels, and how wrong it would be.

use super::{COSTS, Candidate, Method};
use crate::density::{EXACT_SHARE, averaged_side, direct, exact, grid, nine_patch, reach};
use crate::shadow::Shadow;

/// The methods that can draw a shadow on so many pixels a scene unit.
pub(super) fn candidates(shadow: &Shadow, per_unit: f64, levels: f64) -> [Option<Candidate>; 4] {
    let work = Work::of(shadow, per_unit);
    [
        Some(work.exact()),
        Some(work.direct(levels)),
        work.grid(levels),
        nine_patch::suited(shadow, per_unit)
            .map(|rounded| work.nine_patch(levels, rounded.circle().is_some())),
    ]
}

/// Tolerances below this, in levels, are kept by the closed form alone.
const FINEST: f64 = 0.5;

/// Arcs in place of a curve, over the third root of its length in penumbra radii.
const ARCS: f64 = 2.5;

/// What there is to draw, in pixels.
struct Work {
    radius: f64,
    /// Of the bounds.
    pixels: f64,
    /// The larger side of the outline's box.
    extent: f64,
    /// Whether no curve is drawn as something else.
    is_fixed: bool,
    /// Pixels whose discs may meet lines, added up over the lines, and the same for arcs.
    lines: f64,
    arcs: f64,
}

impl Work {
    fn of(shadow: &Shadow, per_unit: f64) -> Self {
        let mut census = shadow.census();
        // How far an arc is from its curve grows with the third power of its length.
        let radius = shadow.radius().max(census.curve_length * 1e-4);
        let arcs = ARCS * libm::cbrt(census.curve_length / census.curves.max(1.0) / radius);
        census.arcs += census.curves * arcs.max(1.0);
        census.arc_length += census.curve_length;
        let radius = shadow.radius() * per_unit;
        // A pixel sees a little beyond its disc.
        let reach = reach(radius);
        let met = |count: f64, length: f64| {
            2.0 * reach * length * per_unit + count * core::f64::consts::PI * reach * reach
        };
        let size = census.size * per_unit + 2.0 * reach;
        Self {
            radius,
            pixels: size.x * size.y,
            extent: shadow.extent() * per_unit,
            is_fixed: shadow.is_fixed(),
            lines: met(census.lines, census.line_length),
            arcs: met(census.arcs, census.arc_length),
        }
    }

    /// Whether its pixels are averages over a square.
    fn is_averaged(&self) -> bool {
        self.radius > 0.0 && averaged_side(self.radius) > 0.0
    }

    fn exact(&self) -> Candidate {
        Candidate {
            method: Method::Exact,
            error_levels: if self.is_averaged() {
                exact::AVERAGED
            } else {
                EXACT_SHARE
            },
            cost_ns: COSTS.exact * (self.lines + self.arcs) * self.averages(COSTS.exact_average)
                + self.pixels,
            why: "the finest averages over pixels",
        }
    }

    fn direct(&self, levels: f64) -> Candidate {
        let why = if self.radius == 0.0 {
            "a hard edge is coverage in closed form"
        } else if self.radius < 0.25 {
            "the penumbra is narrower than a quarter of a pixel: coverage, at few points of the disc"
        } else if self.is_averaged() {
            "the penumbra is about as narrow as a pixel"
        } else {
            "few edges within reach: their closed form costs least"
        };
        Candidate {
            method: Method::Direct,
            error_levels: direct::rounding(self.extent, self.radius)
                + if self.is_averaged() {
                    direct::AVERAGED
                } else if self.is_fixed {
                    direct::FIXED
                } else {
                    direct::curves(self.radius, levels) * levels + direct::ROUNDING
                },
            cost_ns: COSTS.pixel * self.pixels
                + (COSTS.line * self.lines + COSTS.arc * self.arcs) * self.averages(COSTS.average),
            why,
        }
    }

    /// Sums along strips, where these can be told apart.
    fn grid(&self, levels: f64) -> Option<Candidate> {
        (levels >= FINEST && grid::suits(self.radius, levels, self.extent)).then(|| Candidate {
            method: Method::Grid,
            error_levels: levels,
            cost_ns: (COSTS.sum + COSTS.sum_row / self.radius) * self.pixels,
            why: "many edges within reach: sums along strips cost less than each one",
        })
    }

    fn nine_patch(&self, levels: f64, is_circle: bool) -> Candidate {
        Candidate {
            method: Method::NinePatch,
            error_levels: levels.max(FINEST),
            cost_ns: COSTS.rounded * self.pixels,
            why: if is_circle {
                "a circle: the closed form in its distance"
            } else {
                "a rounded rectangle: its chords are closed form in its sides"
            },
        }
    }

    /// How much more a pixel costs for being an average, if it is one.
    fn averages(&self, more: f64) -> f64 {
        if self.is_averaged() { more } else { 1.0 }
    }
}
