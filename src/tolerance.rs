//! Tolerance: how wrong a shadow may be.

use crate::error::{self, Result};

/// The largest error that is allowed, in levels (1/255 of density). Half of it takes about 1.4 times the triangles along
/// straight edges and twice as many at corners.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Tolerance(f64);

impl Tolerance {
    /// One level: what 8-bit rounding does twice over.
    pub const ONE_LEVEL: Self = Self(1.0);

    /// A tolerance of 1/16 to 64 levels.
    ///
    /// # Errors
    /// A number outside that range.
    pub fn levels(levels: f32) -> Result<Self> {
        Ok(Self(error::within(
            "tolerance",
            f64::from(levels),
            LEAST_LEVELS,
            MOST_LEVELS,
        )?))
    }

    /// So many levels, or the fewest that there are.
    pub(crate) fn at_least(levels: f64) -> Self {
        Self(levels.max(LEAST_LEVELS))
    }

    /// The tolerance over a strength from 0 to 1, as far as tolerances go.
    pub(crate) fn divided(self, strength: f64) -> Self {
        Self((self.0 / strength).min(MOST_LEVELS))
    }

    /// The tolerance in levels.
    #[must_use]
    pub fn as_levels(self) -> f64 {
        self.0
    }
}

/// The smallest tolerance, in levels.
const LEAST_LEVELS: f64 = 1.0 / 16.0;

/// The largest tolerance, in levels: a quarter of the whole.
const MOST_LEVELS: f64 = 64.0;

impl Default for Tolerance {
    fn default() -> Self {
        Self::ONE_LEVEL
    }
}
