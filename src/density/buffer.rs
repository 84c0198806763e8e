//! Buffers of the caller's, checked and made ready to be drawn into.

use fearless_simd::Level;

use super::blend::{Ink, Rgba8};
use super::coverage::A8;
use super::dither::Layout;
use super::{Each, PixelOptions, Sink};
use crate::error::{Error, Result};
use crate::grid::Grid;
use crate::paint::Paint;
use crate::scratch::Scratch;

impl PixelOptions<'_> {
    /// Refuses options for other pixels than the grid's.
    pub(crate) fn check(&self, grid: &Grid) -> Result<()> {
        match self.hidden {
            Some(hidden) if !hidden.grid().has_pixels_of(grid) => Err(Error::OtherGrid {
                field: "options.hidden",
            }),
            _ => Ok(()),
        }
    }

    fn layout(&self, grid: &Grid) -> Layout {
        Layout {
            stride: grid.stride(),
            dither: self.dither.then(|| grid.pattern()),
        }
    }

    /// 8-bit coverage, at first 0.
    pub(crate) fn onto_mask<'b>(
        &self,
        grid: &Grid,
        mask: &'b mut [u8],
        level: Level,
    ) -> Result<A8<'b>> {
        self.check(grid)?;
        clear(grid, mask, 0)?;
        Ok(A8 {
            level,
            mask,
            layout: self.layout(grid),
        })
    }

    /// Densities, at first 0, that add up.
    pub(crate) fn onto_densities<'b>(
        &self,
        grid: &Grid,
        densities: &'b mut [f32],
    ) -> Result<impl Sink + use<'b>> {
        self.check(grid)?;
        clear(grid, densities, 0.0)?;
        Ok(Each {
            pixels: densities,
            stride: grid.stride(),
            put: |pixel: &mut f32, density: f32| *pixel = (*pixel + density).min(1.0),
        })
    }

    /// Premultiplied RGBA8 pixels, onto which paint is blended.
    pub(crate) fn onto_rgba8<'b>(
        &self,
        grid: &Grid,
        pixels: &'b mut [u8],
        paint: &Paint,
        scratch: &Scratch,
    ) -> Result<Rgba8<'b>> {
        grid.check_buffer(pixels.len() / 4)?;
        self.check(grid)?;
        Ok(Rgba8 {
            level: scratch.level(),
            pixels,
            layout: self.layout(grid),
            ink: Ink::new(paint),
        })
    }
}

/// Sets the grid's pixels in a buffer.
pub(crate) fn clear<T: Copy>(grid: &Grid, buffer: &mut [T], value: T) -> Result<()> {
    grid.check_buffer(buffer.len())?;
    for row in 0..grid.height() as usize {
        buffer[row * grid.stride()..][..grid.width() as usize].fill(value);
    }
    Ok(())
}
