//! Paint: what a shadow is drawn with on pixels.

use crate::density::PixelOptions;
use crate::error::{self, Result};
use crate::grid::Grid;
use crate::scratch::Scratch;
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

    /// Blends the paint onto premultiplied RGBA8 pixels, source over, by coverage such as
    /// [`Shadow::fill_a8`](crate::Shadow::fill_a8) writes on the same grid: for shadows that are drawn once and used often.
    /// The grid's stride is that of both buffers.
    ///
    /// # Errors
    /// [`Error::BufferSize`](crate::Error::BufferSize) when `mask` or `pixels` is shorter than the grid needs.
    pub fn blend_mask(
        &self,
        grid: &Grid,
        mask: &[u8],
        pixels: &mut [u8],
        scratch: &mut Scratch,
    ) -> Result<()> {
        grid.check_buffer(mask.len())?;
        let mut canvas = PixelOptions::default().onto_rgba8(grid, pixels, self, scratch)?;
        let width = grid.width() as usize;
        for (row, mask) in (0..grid.height()).zip(mask.chunks(grid.stride())) {
            canvas.coverage(row, 0, &mask[..width]);
        }
        Ok(())
    }
}
