//! Densities: at a point, and on a grid of pixels by one method a file.

mod area;
pub(crate) mod exact;
mod field;
mod quadrature;

use core::f64::consts::FRAC_PI_2;

pub(crate) use area::at_point;
pub(crate) use field::Field;

/// How far flattening may move the density of `exact`, in levels.
pub(crate) const EXACT_SHARE: f64 = 0.02;

/// Takes the densities that a method computes, pixel by pixel; those it is not given are 0.
pub(crate) trait DensitySink {
    /// Whether the density of pixel (x, y) will be looked at.
    fn wants(&self, _x: u32, _y: u32) -> bool {
        true
    }

    /// The density of pixel (x, y), given at most once.
    fn put(&mut self, x: u32, y: u32, density: f32);
}

/// How far from a curve its chords may be to move no density by more than `levels`: a strip of that width along a disc's
/// diameter, 2 r wide, over the disc's area π r²; a strip along a pixel's side where that is less. `radius` and `pixel`,
/// the pixel's side, in the unit of the result.
pub(crate) fn flatness(levels: f64, radius: f64, pixel: f64) -> f64 {
    levels / 255.0 * pixel.max(FRAC_PI_2 * radius)
}

/// The side of the square about its centre over which a pixel's density is averaged, in pixels, for a penumbra radius
/// in pixels: the whole pixel up to 1, nothing from 3 on. So a hard edge is antialiased, a soft one costs one sample,
/// and nothing jumps between.
pub(crate) fn averaged_side(radius: f64) -> f64 {
    ((3.0 - radius) / 2.0).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_averaged_square_has_no_jump() {
        assert_eq!(averaged_side(0.0), 1.0);
        assert_eq!(averaged_side(1.0), 1.0);
        assert_eq!(averaged_side(2.0), 0.5);
        assert_eq!(averaged_side(3.0), 0.0);
        assert_eq!(averaged_side(100.0), 0.0);
    }
}
