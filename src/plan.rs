//! The cheapest method within a tolerance, and why it was chosen.

use core::fmt;
use core::str::FromStr;

use crate::shadow::Shadow;
use crate::tolerance::Tolerance;

/// The ways to draw a shadow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Method {
    /// The closed form, pixel by pixel.
    Exact,
    /// Triangles, interpolated; on pixels one sample at each centre.
    Mesh,
}

/// What a shadow is drawn for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Target {
    /// A grid of pixels with so many a scene unit.
    Pixels,
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

/// The method for a shadow within a tolerance. For pixels there is one so far, which keeps every tolerance.
#[must_use]
pub fn choose(shadow: &Shadow, _tolerance: Tolerance, target: Target) -> Choice {
    let (method, why) = match target {
        Target::Triangles => (Method::Mesh, "triangles are asked for"),
        Target::Pixels if shadow.radius() == 0.0 => {
            (Method::Exact, "a hard edge is coverage in closed form")
        }
        Target::Pixels => (
            Method::Exact,
            "the closed form keeps every tolerance; only penumbra pixels cost anything",
        ),
    };
    Choice { method, why }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Exact => "exact",
            Self::Mesh => "mesh",
        })
    }
}

/// Why a text names no method.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is no method: exact or mesh")]
pub struct ParseMethodError(String);

impl FromStr for Method {
    type Err = ParseMethodError;

    fn from_str(text: &str) -> Result<Self, ParseMethodError> {
        match text {
            "exact" => Ok(Self::Exact),
            "mesh" => Ok(Self::Mesh),
            _ => Err(ParseMethodError(text.to_owned())),
        }
    }
}
