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
    /// Rows of the mask begin `mask_stride` bytes apart, the grid's width at least: the grid's own stride is that of `pixels`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) for a stride below the width or so large that no buffer is;
    /// [`Error::BufferSize`](crate::Error::BufferSize) when `mask` or `pixels` is shorter than the grid needs.
    pub fn blend_mask(
        &self,
        grid: &Grid,
        mask: &[u8],
        mask_stride: usize,
        pixels: &mut [u8],
        scratch: &mut Scratch,
    ) -> Result<()> {
        grid.strided("mask_stride", mask_stride)?
            .check_buffer(mask.len())?;
        let mut canvas = PixelOptions::default().onto_rgba8(grid, pixels, self, scratch)?;
        let width = grid.width() as usize;
        for (row, mask) in (0..grid.height()).zip(mask.chunks(mask_stride)) {
            canvas.coverage(row, 0, &mask[..width]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use crate::shape::Shape;

    #[test]
    fn a_masks_stride_is_its_own() {
        let light = Light::android(40.0).unwrap();
        let card = Shape::rounded_rect(8.0, 8.0, 20.0, 14.0, 3.0).unwrap();
        let shadow = light.cast(&card, 4.0, 0.0).unwrap();
        let grid = Grid::new([0.0, 0.0], [36, 40], 1.0).unwrap();
        let wide = grid.with_stride(50).unwrap();
        let (paint, options) = (
            Paint::new(Color::BLACK, 0.4).unwrap(),
            PixelOptions::default(),
        );
        let mut scratch = Scratch::new();
        let drawn = [grid, wide].map(|of_mask| {
            let mut mask = vec![0; of_mask.stride() * 40];
            shadow
                .fill_a8(&of_mask, &mut mask, &options, &mut scratch)
                .unwrap();
            let mut pixels = vec![200; 4 * 50 * 40];
            paint
                .blend_mask(&wide, &mask, of_mask.stride(), &mut pixels, &mut scratch)
                .unwrap();
            pixels
        });
        assert!(drawn[0] == drawn[1]);
        assert!(drawn[0].iter().any(|&channel| channel < 150));
    }
}
