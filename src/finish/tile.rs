//! An image laid over a surface again and again, averaged over any rectangle by sums that are there beforehand (Crow 1984).
//!
//! Each texel counts by the part of it that lies in the rectangle, so that an image shrunk to any size has no moire.

use std::sync::Arc;

use glam::{DVec2, DVec4};
use libm::floor;

use crate::error::{self, Result};
use crate::image::Image;
use crate::limits::at_most;

/// An image for a surface's detail may not have more texels than this: their sums take 32 bytes each.
pub const MAX_TEXELS: usize = 1 << 22;

/// An image whose copies, of a size in scene units, lie side by side from the scene's origin on.
#[derive(Debug, Clone, PartialEq)]
pub struct Tile {
    image: Arc<Image>,
    size: [f32; 2],
    /// For each corner of texels the sums of red, green, blue (each times alpha) and alpha of all texels left of it and above.
    sums: Arc<Vec<[u64; 4]>>,
}

impl Tile {
    /// Copies of an image, `size` (width, height; scene units) each.
    ///
    /// # Errors
    /// [`Error::TooMany`](crate::Error::TooMany) texels over [`MAX_TEXELS`], a size that is not finite or not above 0.
    pub fn new(image: Arc<Image>, size: [f32; 2]) -> Result<Self> {
        error::positive("tile.width", f64::from(size[0]))?;
        error::positive("tile.height", f64::from(size[1]))?;
        let [width, height] = image.size().map(|side| side as usize);
        at_most("texels", width * height, MAX_TEXELS)?;
        let mut sums = vec![[0; 4]; (width + 1) * (height + 1)];
        for row in 0..height {
            let mut of_row = [0; 4];
            for column in 0..width {
                let start = 4 * (row * width + column);
                let texel = &image.pixels()[start..start + 4];
                let alpha = u64::from(texel[3]);
                let above = sums[row * (width + 1) + column + 1];
                let sum = &mut sums[(row + 1) * (width + 1) + column + 1];
                for channel in 0..4 {
                    let weight = if channel < 3 { alpha } else { 1 };
                    of_row[channel] += weight * u64::from(texel[channel]);
                    sum[channel] = above[channel] + of_row[channel];
                }
            }
        }
        Ok(Self {
            image,
            size,
            sums: Arc::new(sums),
        })
    }

    /// A texel's size, scene units.
    pub(super) fn texel(&self) -> DVec2 {
        self.size() / DVec2::from(self.image.size().map(f64::from))
    }

    fn size(&self) -> DVec2 {
        DVec2::from(self.size.map(f64::from))
    }

    /// The average over a rectangle (its middle and size, scene units): red, green and blue times alpha, and alpha, 0 to 1 each.
    pub(super) fn average(&self, middle: DVec2, size: DVec2) -> DVec4 {
        let texel = self.texel();
        // From a corner in the first copy on: sums from far away would cancel.
        let start = middle - size / 2.0;
        let min = (start - (start / self.size()).floor() * self.size()) / texel;
        let max = min + size / texel;
        let area = (max.x - min.x) * (max.y - min.y);
        let sum = self.sum_to(max.x, max.y) - self.sum_to(min.x, max.y) - self.sum_to(max.x, min.y)
            + self.sum_to(min.x, min.y);
        let color = 1.0 / (255.0 * 255.0);
        (sum / area * DVec4::new(color, color, color, 1.0 / 255.0)).clamp(DVec4::ZERO, DVec4::ONE)
    }

    /// The sum over all copies' texels right of and below the origin and left of and above a point, in texels.
    fn sum_to(&self, x: f64, y: f64) -> DVec4 {
        let [width, height] = self.image.size().map(f64::from);
        let (columns, rows) = (floor(x / width), floor(y / height));
        let (x, y) = (x - columns * width, y - rows * height);
        self.within(width, height) * (columns * rows)
            + self.within(x, height) * rows
            + self.within(width, y) * columns
            + self.within(x, y)
    }

    /// The same of one copy.
    fn within(&self, x: f64, y: f64) -> DVec4 {
        let [width, height] = self.image.size().map(f64::from);
        let (left, top) = (
            floor(x).clamp(0.0, width - 1.0),
            floor(y).clamp(0.0, height - 1.0),
        );
        let stride = width as usize + 1;
        let first = top as usize * stride + left as usize;
        let [a, b, c, d] = [first, first + 1, first + stride, first + stride + 1]
            .map(|index| DVec4::from(self.sums[index].map(|sum| sum as f64)));
        // Between the corners of a texel the sum is bilinear.
        let (x, y) = (x - left, y - top);
        a.lerp(b, x).lerp(c.lerp(d, x), y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tile() -> Tile {
        let bytes = (0..5 * 3 * 4).map(|i| (i * 37 % 251) as u8).collect();
        let image = Image::from_rgba8([5, 3], bytes).unwrap();
        Tile::new(Arc::new(image), [10.0, 9.0]).unwrap()
    }

    #[test]
    fn averages_weigh_each_texel_by_its_area() {
        let tile = tile();
        // From within the second texel of the first row to within the third of the second, and over the tile's edge.
        for (middle, size) in [
            (DVec2::new(3.7, 3.1), DVec2::new(2.9, 2.3)),
            (DVec2::new(-0.4, 9.2), DVec2::new(13.0, 31.0)),
        ] {
            let count = 400;
            let mut sum = DVec4::ZERO;
            for row in 0..count {
                for column in 0..count {
                    let at = middle
                        + size * (DVec2::new(f64::from(column), f64::from(row)) + 0.5)
                            / f64::from(count)
                        - size / 2.0;
                    let texel = |v: f64, side: f64, number: f64| {
                        (v / side).rem_euclid(number).floor() as usize
                    };
                    let index = 4 * (texel(at.y, 3.0, 3.0) * 5 + texel(at.x, 2.0, 5.0));
                    let bytes = &tile.image.pixels()[index..index + 4];
                    let [r, g, b, a] = [0, 1, 2, 3].map(|i: usize| f64::from(bytes[i]) / 255.0);
                    sum += DVec4::new(r * a, g * a, b * a, a);
                }
            }
            let expected = sum / f64::from(count * count);
            // Samples at a texel's edge are a 400th of a side off.
            let miss = (tile.average(middle, size) - expected).abs().max_element();
            assert!(miss < 3e-3, "{miss}");
        }
    }
}
