//! Image: a picture with alpha as a surface.

mod sums;

use std::sync::OnceLock;

use glam::DVec2;

pub(crate) use sums::Sums;

use crate::error::{self, Error, MAX_PIXELS, Result};

/// A picture whose transparent parts cast no shadow: RGBA with straight (not premultiplied) alpha, 8 bits each.
#[derive(Debug, Clone)]
pub struct Image {
    size: [u32; 2],
    pixels: Vec<u8>,
    /// Of its alpha, once it casts a shadow that takes them: whatever that falls on, they are the same.
    rows: OnceLock<Sums>,
    areas: OnceLock<Sums>,
}

impl PartialEq for Image {
    fn eq(&self, other: &Self) -> bool {
        self.size == other.size && self.pixels == other.pixels
    }
}

impl Eq for Image {}

impl Image {
    /// An image of `size` (columns, rows) from its pixels, row by row, four bytes each.
    ///
    /// # Errors
    /// No pixels or more than [`MAX_PIXELS`], bytes that are not four a pixel.
    pub fn from_rgba8(size: [u32; 2], pixels: Vec<u8>) -> Result<Self> {
        let [width, height] = size.map(u64::from);
        if width * height == 0 || width * height > MAX_PIXELS {
            return Err(Error::PictureSize { width, height });
        }
        let needed = 4 * (width * height) as usize;
        if pixels.len() != needed {
            return Err(Error::BufferSize {
                length: pixels.len(),
                needed,
            });
        }
        Ok(Self {
            size,
            pixels,
            rows: OnceLock::new(),
            areas: OnceLock::new(),
        })
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The bytes, row by row: red, green, blue, alpha.
    #[must_use]
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// The sums of alpha along each row of texels.
    pub(crate) fn row_sums(&self) -> &Sums {
        let columns = self.size[0] as usize;
        self.rows
            .get_or_init(|| Sums::of_rows(columns, self.alphas()))
    }

    /// The sums of alpha over rectangles of texels.
    pub(crate) fn area_sums(&self) -> &Sums {
        let columns = self.size[0] as usize;
        self.areas
            .get_or_init(|| Sums::of_areas(columns, self.alphas()))
    }

    /// Each row's alphas, 0 to 1.
    fn alphas(&self) -> impl ExactSizeIterator<Item = impl Iterator<Item = f64>> {
        let columns = self.size[0] as usize;
        let alpha = |pixel: &[u8; 4]| f64::from(pixel[3]) / 255.0;
        let rows = self.pixels.as_chunks().0.chunks_exact(columns);
        rows.map(move |row| row.iter().map(alpha))
    }
}

/// A rectangle along the axes over which an image is spread, scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    pub(crate) min: DVec2,
    pub(crate) size: DVec2,
}

impl Place {
    pub(crate) fn new([x, y, width, height]: [f32; 4]) -> Result<Self> {
        Ok(Self {
            min: DVec2::new(
                error::coordinate("x", f64::from(x))?,
                error::coordinate("y", f64::from(y))?,
            ),
            size: DVec2::new(
                error::positive("width", f64::from(width))?,
                error::positive("height", f64::from(height))?,
            ),
        })
    }
}
