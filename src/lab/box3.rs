//! Three box blurs one after another in place of a Gaussian: what SVG filters and canvases draw.

use super::plane::Plane;
use super::{Claim, Family, Parameter, Technique};
use crate::error::{self, Result};
use crate::grid::Grid;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// The covered part of each pixel, blurred by three boxes (Filter Effects 1, section 9.7): they are as wide as three of them
/// need to be to have the variance of a Gaussian of `sigma` times the penumbra radius, in whole pixels.
#[derive(Debug, Clone, Copy)]
pub struct Box3 {
    sigma: f64,
}

impl Box3 {
    /// A sigma of so many penumbra radii.
    ///
    /// # Errors
    /// A sigma not from 0 to 4.
    pub fn new(sigma: f64) -> Result<Self> {
        Ok(Self {
            sigma: error::within("sigma", sigma, 0.0, 4.0)?,
        })
    }
}

impl Technique for Box3 {
    fn name(&self) -> &'static str {
        "box3"
    }

    fn family(&self) -> Family {
        Family::Blurs
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter::number("sigma", self.sigma, "r", [0.0, 4.0])]
    }

    fn claim(&self) -> Claim {
        Claim {
            levels: None,
            why: "a Gaussian in place of the disc, three boxes in place of a Gaussian, whole pixels in place of their widths",
        }
    }

    fn draw(
        &self,
        shadow: &Shadow,
        grid: &Grid,
        densities: &mut [f32],
        scratch: &mut Scratch,
    ) -> Result<()> {
        let boxes = boxes(self.sigma * shadow.radius() * grid.pixels_per_unit());
        let margin: usize = boxes.iter().map(|(before, after)| before.max(after)).sum();
        let mut plane = Plane::coverage(shadow, grid, margin as u32, scratch)?;
        let mut between = Vec::new();
        plane.filter_rows_and_columns(|from, to| {
            to.copy_from_slice(from);
            for &(before, after) in &boxes {
                between.clear();
                between.extend_from_slice(to);
                average(&between, before, after, to);
            }
        });
        plane.write(grid, densities)
    }
}

/// How many pixels before and behind a pixel each box averages: with an even width, one to the left, one to the right, and
/// one that is wider by a pixel.
fn boxes(sigma: f64) -> [(usize, usize); 3] {
    let width = (sigma * 3.0 * core::f64::consts::TAU.sqrt() / 4.0 + 0.5).floor() as usize;
    let half = width / 2;
    match width {
        0 => [(0, 0); 3],
        _ if width % 2 == 1 => [(half, half); 3],
        _ => [(half, half - 1), (half - 1, half), (half, half)],
    }
}

/// Sums that run along, in double precision so that what enters leaves again.
fn average(from: &[f32], before: usize, after: usize, to: &mut [f32]) {
    let width = (before + after + 1) as f64;
    let mut sum: f64 = from.iter().take(after).map(|v| f64::from(*v)).sum();
    for (i, value) in to.iter_mut().enumerate() {
        if let Some(next) = from.get(i + after) {
            sum += f64::from(*next);
        }
        *value = (sum / width) as f32;
        if let Some(last) = i.checked_sub(before) {
            sum -= f64::from(from[last]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{card, errors};
    use super::*;

    #[test]
    fn three_boxes_are_as_far_off_as_their_gaussian() {
        let (shadow, grid) = card(9.0);
        let got = errors(&Box3::new(0.525).unwrap(), &shadow, &grid);
        assert!((7.0..20.0).contains(&got.max_levels), "{got:?}");
    }

    #[test]
    fn even_widths_stay_centred() {
        for sigma in [0.0, 0.6, 1.4, 3.0, 5.5] {
            let boxes = boxes(sigma);
            let before: usize = boxes.iter().map(|b| b.0).sum();
            let after: usize = boxes.iter().map(|b| b.1).sum();
            assert_eq!(before, after, "{sigma}");
        }
    }
}
