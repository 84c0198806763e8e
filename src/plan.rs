//! The cheapest method within a tolerance, and why it was chosen.

use core::fmt;
use core::str::FromStr;

use crate::density::{direct, grid, nine_patch};
use crate::shadow::Shadow;
use crate::tolerance::Tolerance;

/// The ways to draw a shadow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Method {
    /// The closed form, pixel by pixel, in double precision.
    Exact,
    /// The closed form, row by row, in single precision.
    Direct,
    /// The closed form on a lattice coarser than the pixels, interpolated.
    Grid,
    /// A rounded rectangle by columns and corners, these interpolated from a table.
    NinePatch,
    /// Triangles, interpolated; on pixels one sample at each centre.
    Mesh,
}

/// What a shadow is drawn for.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Target {
    /// A grid of pixels.
    Pixels {
        /// Pixels a scene unit.
        per_unit: f64,
    },
    /// Triangles.
    Triangles,
}

/// A method and the reason for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choice {
    /// The method.
    pub method: Method,
    /// Why, in a sentence.
    pub why: &'static str,
}

/// The method for a shadow within a tolerance.
#[must_use]
pub fn choose(shadow: &Shadow, tolerance: Tolerance, target: Target) -> Choice {
    let (method, why) = match target {
        Target::Triangles => (Method::Mesh, "triangles are asked for"),
        Target::Pixels { per_unit } => on_pixels(shadow, tolerance.as_levels(), per_unit),
    };
    Choice { method, why }
}

fn on_pixels(shadow: &Shadow, levels: f64, per_unit: f64) -> (Method, &'static str) {
    let radius = shadow.radius() * per_unit;
    if radius > 0.0 && radius < 3.0 {
        return if levels < direct::AVERAGED {
            (
                Method::Exact,
                "so fine a tolerance takes the finest averages over pixels",
            )
        } else {
            (Method::Direct, "the penumbra is about as narrow as a pixel")
        };
    }
    if radius == 0.0 {
        return (Method::Direct, "a hard edge is coverage in closed form");
    }
    if levels < FINEST {
        return (
            Method::Direct,
            "so fine a tolerance leaves nothing to interpolation",
        );
    }
    let few_steps = radius >= grid::narrowest(levels);
    let Some(rounded) = nine_patch::suited(shadow, per_unit) else {
        return if few_steps && grid_is_cheaper(shadow, per_unit) {
            (
                Method::Grid,
                "many edges within reach: sums along strips cost less than each one",
            )
        } else {
            (
                Method::Direct,
                "few edges within reach: their closed form costs least",
            )
        };
    };
    if rounded.circle().is_some() {
        (Method::NinePatch, "a circle: one profile along its radius")
    } else {
        (
            Method::NinePatch,
            "a rounded rectangle: its chords are closed form in its sides",
        )
    }
}

/// Whether rows of sums cost less than the closed form of every edge. Fitted to a few shapes on one core with AVX-512, in ns: an edge costs
/// the closed form 0.9 for each pixel whose disc may meet it, an arc 3.2, and a pixel 0.3; sums cost 0.7 a pixel and their
/// rows 50 over the penumbra radius.
fn grid_is_cheaper(shadow: &Shadow, per_unit: f64) -> bool {
    let (census, radius) = (shadow.census(), shadow.radius() * per_unit);
    let met = |count: f64, length: f64| {
        2.0 * radius * length * per_unit + count * core::f64::consts::PI * radius * radius
    };
    let lines = met(census.lines, census.line_length);
    let arcs = met(census.arcs, census.arc_length);
    let size = census.size * per_unit + 2.0 * radius;
    let pixels = size.x * size.y;
    0.9 * lines + 3.2 * arcs + 0.3 * pixels > (0.7 + 50.0 / radius) * pixels
}

/// Tolerances below this, in levels, are kept by the closed form alone.
const FINEST: f64 = 0.5;

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Exact => "exact",
            Self::Direct => "direct",
            Self::Grid => "grid",
            Self::NinePatch => "nine-patch",
            Self::Mesh => "mesh",
        })
    }
}

/// Why a text names no method.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is no method: exact, direct, grid, nine-patch or mesh")]
pub struct ParseMethodError(String);

impl FromStr for Method {
    type Err = ParseMethodError;

    fn from_str(text: &str) -> Result<Self, ParseMethodError> {
        match text {
            "exact" => Ok(Self::Exact),
            "direct" => Ok(Self::Direct),
            "grid" => Ok(Self::Grid),
            "nine-patch" => Ok(Self::NinePatch),
            "mesh" => Ok(Self::Mesh),
            _ => Err(ParseMethodError(text.to_owned())),
        }
    }
}
