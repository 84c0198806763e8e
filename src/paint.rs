//! Paint: what a shadow is drawn with on pixels.

use crate::error::{self, Result};
use crate::tone::Color;

/// A colour, and how much of it a pixel takes where the light is wholly hidden.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paint {
    color: Color,
    strength: f32,
}

impl Paint {
    /// Paint of a colour and a strength from 0 to 1; the colour's own alpha weakens it further.
    ///
    /// # Errors
    /// A strength that is not from 0 to 1.
    pub fn new(color: Color, strength: f32) -> Result<Self> {
        error::within("strength", f64::from(strength), 0.0, 1.0)?;
        Ok(Self { color, strength })
    }

    /// The colour.
    #[must_use]
    pub fn color(&self) -> Color {
        self.color
    }

    /// The paint's opacity where the density is 1, 0 to 1.
    #[must_use]
    pub fn opacity(&self) -> f32 {
        self.strength * f32::from(self.color.a) / 255.0
    }
}
