//! The pixels of a picture, in scene units.

use glam::DVec2;

use crate::error::{self, Error, MAX_PIXELS, Result};

/// Pixels a scene unit are no fewer and no more than this.
pub(crate) const LEAST_SCALE: f64 = 1.0 / 1024.0;
pub(crate) const MOST_SCALE: f64 = 1024.0;

/// A grid of square pixels. Pixel (i, j) covers the square from `origin + (i, j) / pixels_per_unit` on; row j begins
/// at `j * stride` in a buffer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// The first corner, in pixels from the scene's origin.
    corner: DVec2,
    width: u32,
    height: u32,
    pixels_per_unit: f64,
    stride: usize,
}

impl Grid {
    /// A grid of `size` (columns, rows) pixels whose first corner is at `origin` (x, y; scene units), with
    /// `pixels_per_unit` pixels a scene unit and rows one after the other.
    ///
    /// # Errors
    /// No pixels or more than [`MAX_PIXELS`], an origin that is not finite or passes
    /// [`MAX_COORDINATE`](crate::MAX_COORDINATE), pixels per unit not from 1/1024 to 1024.
    pub fn new(origin: [f32; 2], size: [u32; 2], pixels_per_unit: f32) -> Result<Self> {
        let [width, height] = size;
        let count = u64::from(width) * u64::from(height);
        if count == 0 || count > MAX_PIXELS {
            return Err(Error::PictureSize {
                width: u64::from(width),
                height: u64::from(height),
            });
        }
        let origin = DVec2::new(
            error::coordinate("grid.origin.x", f64::from(origin[0]))?,
            error::coordinate("grid.origin.y", f64::from(origin[1]))?,
        );
        let pixels_per_unit = error::within(
            "grid.pixels_per_unit",
            f64::from(pixels_per_unit),
            LEAST_SCALE,
            MOST_SCALE,
        )?;
        Ok(Self {
            corner: origin * pixels_per_unit,
            width,
            height,
            pixels_per_unit,
            stride: width as usize,
        })
    }

    /// The same grid in a buffer whose rows begin `stride` pixels apart.
    ///
    /// # Errors
    /// A stride below the width, above 2^31, or so large that the buffer could not be addressed.
    pub fn with_stride(self, stride: usize) -> Result<Self> {
        self.strided("grid.stride", stride)
    }

    /// The same; an error tells of a `field`.
    pub(crate) fn strided(mut self, field: &'static str, stride: usize) -> Result<Self> {
        error::within(field, stride as f64, f64::from(self.width), 2_147_483_648.0)?;
        if stride.checked_mul(self.height as usize).is_none() {
            return Err(Error::OutOfRange {
                field,
                value: stride as f64,
                min: f64::from(self.width),
                max: usize::MAX as f64 / f64::from(self.height),
            });
        }
        self.stride = stride;
        Ok(self)
    }

    /// Columns.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Pixels a scene unit.
    #[must_use]
    pub fn pixels_per_unit(&self) -> f64 {
        self.pixels_per_unit
    }

    /// From one row's first pixel to the next row's, in pixels.
    #[must_use]
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// The first corner, in pixels from the scene's origin.
    pub(crate) fn corner(&self) -> DVec2 {
        self.corner
    }

    /// Whether a box may meet any of its pixels, in pixels from the scene's origin.
    pub(crate) fn meets(&self, (min, max): (DVec2, DVec2)) -> bool {
        let end = self.corner + DVec2::new(f64::from(self.width), f64::from(self.height));
        // A pixel to spare for rounding.
        min.cmple(end + 1.0).all() && max.cmpge(self.corner - 1.0).all()
    }

    /// Whether another grid has the same pixels, in whatever buffer.
    pub(crate) fn has_pixels_of(&self, other: &Self) -> bool {
        let pixels = |grid: &Self| (grid.corner, grid.width, grid.height, grid.pixels_per_unit);
        pixels(self) == pixels(other)
    }

    /// The first pixel's corner on an axis, where that is a whole number of pixels but for the rounding of an origin in `f32`.
    pub(crate) fn whole_corner(&self, axis: usize) -> Option<f64> {
        /// How far from it one may be besides, in pixels: next to nothing.
        const WHOLE: f64 = 1.0 / 1024.0;
        let corner = self.corner[axis];
        let nearest = corner.round();
        let slack = nearest.abs() * f64::from(f32::EPSILON) + WHOLE;
        ((corner - nearest).abs() <= slack).then_some(nearest)
    }

    /// The column and row of the first pixel among those of the plane, as far as a pattern of 8 needs them.
    pub(crate) fn pattern(&self) -> [u32; 2] {
        [0, 1].map(|axis| {
            let first = self.whole_corner(axis);
            let first = first.unwrap_or_else(|| self.corner[axis].floor());
            (first as i64).rem_euclid(8) as u32
        })
    }

    /// The part of the grid from column and row `first` to before `end`, in a buffer of its own.
    #[cfg(feature = "raster")]
    pub(crate) fn window(&self, first: [u32; 2], end: [u32; 2]) -> Self {
        let width = end[0] - first[0];
        Self {
            corner: self.corner + DVec2::new(f64::from(first[0]), f64::from(first[1])),
            width,
            height: end[1] - first[1],
            stride: width as usize,
            ..*self
        }
    }

    /// The same square in pixels a `factor` as large or small, in a buffer of its own.
    #[cfg(feature = "lab")]
    pub(crate) fn finer(&self, factor: f64) -> Result<Self> {
        let side = |pixels: u32| (f64::from(pixels) * factor).ceil() as u64;
        let (width, height) = (side(self.width), side(self.height));
        if width * height > MAX_PIXELS {
            return Err(Error::PictureSize { width, height });
        }
        Ok(Self {
            corner: self.corner * factor,
            width: width as u32,
            height: height as u32,
            pixels_per_unit: self.pixels_per_unit * factor,
            stride: width as usize,
        })
    }

    /// The grid and `margin` more pixels on every side, in a buffer of its own.
    #[cfg(feature = "lab")]
    pub(crate) fn grown(&self, margin: u32) -> Result<Self> {
        let (width, height) = [self.width, self.height]
            .map(|side| u64::from(side) + 2 * u64::from(margin))
            .into();
        if width * height > MAX_PIXELS {
            return Err(Error::PictureSize { width, height });
        }
        Ok(Self {
            corner: self.corner - f64::from(margin),
            width: width as u32,
            height: height as u32,
            stride: width as usize,
            ..*self
        })
    }

    /// The rows from `first` to before `end`, in the same buffer.
    #[cfg(feature = "rayon")]
    pub(crate) fn band(&self, first: u32, end: u32) -> Self {
        Self {
            corner: self.corner + DVec2::new(0.0, f64::from(first)),
            height: end - first,
            ..*self
        }
    }

    /// Refuses a buffer that ends before the grid does.
    pub(crate) fn check_buffer(&self, length: usize) -> Result<()> {
        let needed = self.stride * (self.height as usize - 1) + self.width as usize;
        if length < needed {
            return Err(Error::BufferSize { length, needed });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_bounded_before_memory_is_taken() {
        assert!(matches!(
            Grid::new([0.0, 0.0], [1_000_000, 1_000_000], 1.0),
            Err(Error::PictureSize { .. })
        ));
        assert!(Grid::new([0.0, 0.0], [0, 5], 1.0).is_err());
        let grid = Grid::new([0.0, 0.0], [4, 3], 2.0).unwrap();
        assert!(grid.with_stride(3).is_err());
        let grid = grid.with_stride(10).unwrap();
        assert!(grid.check_buffer(24).is_ok());
        assert!(matches!(
            grid.check_buffer(23),
            Err(Error::BufferSize { needed: 24, .. })
        ));
    }
}
