//! A Gaussian blur of the outline: what browsers and most toolkits draw.

use libm::exp;

use super::plane::Plane;
use super::{Claim, Family, Parameter, Technique};
use crate::error::{self, Result};
use crate::grid::Grid;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// The covered part of each pixel, blurred by a Gaussian of `sigma = factor r + floor`.
#[derive(Debug, Clone, Copy)]
pub struct Gaussian {
    name: &'static str,
    factor: f64,
    floor: f64,
}

impl Gaussian {
    /// The Gaussian that is nearest to the disc's own profile on ordinary cards: 0.525 r, as measured.
    #[must_use]
    pub fn best() -> Self {
        Self {
            name: "gaussian",
            factor: 0.525,
            floor: 0.0,
        }
    }

    /// CSS' box shadow, whose blur radius is two sigma (CSS Backgrounds and Borders 3, section 6.1.1): with a blur radius of
    /// r, the disc's own variance.
    #[must_use]
    pub fn css() -> Self {
        Self {
            name: "gaussian-css",
            factor: 0.5,
            floor: 0.0,
        }
    }

    /// Skia's blur of the silhouette where `SkShadowUtils` finds no mesh: 0.57735 r + 0.5 px (`SkBlurMask::ConvertRadiusToSigma`).
    #[must_use]
    pub fn skia() -> Self {
        Self {
            name: "gaussian-skia",
            factor: 0.577_35,
            floor: 0.5,
        }
    }

    /// A sigma of `factor` times the penumbra radius.
    ///
    /// # Errors
    /// A factor not from 0 to 4.
    pub fn new(factor: f64) -> Result<Self> {
        Ok(Self {
            name: "gaussian",
            factor: error::within("sigma", factor, 0.0, 4.0)?,
            floor: 0.0,
        })
    }
}

/// Beyond so many sigma the kernel is left out: 1e-4 of its mass.
const SIGMAS: f64 = 4.0;

impl Technique for Gaussian {
    fn name(&self) -> &'static str {
        self.name
    }

    fn family(&self) -> Family {
        Family::Blurs
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![
            Parameter::number("sigma", self.factor, "r", [0.0, 4.0]),
            Parameter::number("and", self.floor, "px", [0.0, 0.5]),
        ]
    }

    fn claim(&self) -> Claim {
        Claim {
            levels: None,
            why: "a Gaussian has no edge; the disc's profile has, 7.5 levels off a straight edge at best",
        }
    }

    fn draw(
        &self,
        shadow: &Shadow,
        grid: &Grid,
        densities: &mut [f32],
        scratch: &mut Scratch,
    ) -> Result<()> {
        let sigma = self.factor * shadow.radius() * grid.pixels_per_unit() + self.floor;
        let reach = (SIGMAS * sigma).ceil();
        let mut plane = Plane::coverage(shadow, grid, reach as u32, scratch)?;
        // Narrower than that no neighbour has a weight.
        if sigma > 0.05 {
            let kernel = kernel(sigma, reach as usize);
            plane.filter_rows_and_columns(|from, to| convolve(from, &kernel, to));
        }
        plane.write(grid, densities)
    }
}

/// The weights of the pixels from the middle one on.
fn kernel(sigma: f64, reach: usize) -> Vec<f32> {
    let weight = |i: usize| exp(-((i * i) as f64) / (2.0 * sigma * sigma));
    let sum = weight(0) + 2.0 * (1..=reach).map(weight).sum::<f64>();
    (0..=reach).map(|i| (weight(i) / sum) as f32).collect()
}

fn convolve(from: &[f32], kernel: &[f32], to: &mut [f32]) {
    for (value, at) in to.iter_mut().zip(from) {
        *value = kernel[0] * at;
    }
    for (i, weight) in kernel.iter().enumerate().skip(1) {
        if i >= from.len() {
            break;
        }
        for (value, at) in to[i..].iter_mut().zip(from) {
            *value += weight * at;
        }
        for (value, at) in to.iter_mut().zip(&from[i..]) {
            *value += weight * at;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{card, errors};
    use super::*;

    #[test]
    fn the_best_gaussian_is_ten_to_twenty_levels_off_a_card() {
        let (shadow, grid) = card(9.0);
        let best = errors(&Gaussian::best(), &shadow, &grid);
        assert!((7.0..19.0).contains(&best.max_levels), "{best:?}");
        for other in [Gaussian::css(), Gaussian::skia()] {
            let other = errors(&other, &shadow, &grid);
            assert!(other.rms_levels > best.rms_levels, "{other:?} {best:?}");
            assert!(other.max_levels < 35.0);
        }
    }
}
