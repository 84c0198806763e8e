//! What `f32` keeps of coordinates, and what that takes of densities.

use core::f64::consts::FRAC_2_PI;

use glam::DVec2;

/// How far `f32` may tell places of a box apart.
pub(super) fn step(min: DVec2, max: DVec2) -> f64 {
    min.abs().max(max.abs()).max_element() * f64::from(f32::EPSILON)
}

/// The narrowest penumbra that is drawn, in steps of `f32` at its coordinates.
pub(super) const NARROWEST: f64 = 64.0;

/// How wrong densities may be for coordinates that are rounded to `f32`, which tells places a `step` apart, in levels: density changes by
/// at most 2 / π over the penumbra radius.
pub(super) fn rounding_levels(step: f64, radius: f64) -> f64 {
    255.0 * step * FRAC_2_PI / radius
}

/// The power of two at or below a number above 0: that without its fraction bits.
pub(super) fn power_of_two_below(value: f64) -> f64 {
    f64::from_bits(value.to_bits() >> 52 << 52)
}
