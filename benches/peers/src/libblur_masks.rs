//! libblur: blurs of an A8 mask that tiny-skia fills. It finds the processor's instructions at run time.

use anyhow::Result;
use libblur::{
    AnisotropicRadius, BlurImage, BlurImageMut, ConvolutionMode, EdgeMode, EdgeMode2D,
    FastBlurChannels, GaussianBlurParams, ThreadingPolicy, gaussian_blur, stack_blur,
};

use crate::mask;
use crate::peer::{Draw, Peer};
use crate::scene::Scene;

/// Below this the fixed-point kernel of libblur 0.24 overflows, and a pixel's own coverage is as good.
const LEAST_SIGMA: f64 = 0.25;

/// A tent: cheap whatever its radius, which is whole.
pub(crate) struct StackBlur;

impl Peer for StackBlur {
    fn name(&self) -> &'static str {
        "libblur stack blur"
    }

    fn prepare<'a>(&self, scene: &'a Scene) -> Result<Option<Draw<'a>>> {
        Ok(Some(mask::draw_blurred(
            scene,
            |mut coverage, [width, height], sigma| {
                let radius = stack_radius(sigma);
                if radius > 0 {
                    let plane = FastBlurChannels::Plane;
                    let mut image = BlurImageMut::borrow(&mut coverage, width, height, plane);
                    let radius = AnisotropicRadius::new(radius);
                    stack_blur(&mut image, radius, ThreadingPolicy::Single)?;
                }
                Ok(coverage)
            },
        )))
    }
}

/// The tent of radius n, of n + 1 steps to either side, has the variance n (n + 2) / 6.
fn stack_radius(sigma: f64) -> u32 {
    ((1.0 + 6.0 * sigma * sigma).sqrt() - 1.0).round() as u32
}

/// A Gaussian cut off at three standard deviations, in fixed point.
pub(crate) struct GaussianBlur;

impl Peer for GaussianBlur {
    fn name(&self) -> &'static str {
        "libblur Gaussian"
    }

    fn prepare<'a>(&self, scene: &'a Scene) -> Result<Option<Draw<'a>>> {
        // It does not blur in place: the mask that was blurred is the memory for the next.
        let mut spare = Vec::new();
        Ok(Some(mask::draw_blurred(
            scene,
            move |coverage, size, sigma| {
                if sigma < LEAST_SIGMA {
                    return Ok(coverage);
                }
                let mut blurred = core::mem::take(&mut spare);
                blurred.resize(coverage.len(), 0);
                gaussian(&coverage, &mut blurred, size, sigma)?;
                spare = coverage;
                Ok(blurred)
            },
        )))
    }
}

fn gaussian(from: &[u8], to: &mut [u8], [width, height]: [u32; 2], sigma: f64) -> Result<()> {
    let plane = FastBlurChannels::Plane;
    let from = BlurImage::borrow(from, width, height, plane);
    let mut to = BlurImageMut::borrow(to, width, height, plane);
    let kernel = 2 * (3.0 * sigma).ceil() as u32 + 1;
    gaussian_blur(
        &from,
        &mut to,
        GaussianBlurParams::new(kernel, sigma),
        EdgeMode2D::new(EdgeMode::Clamp),
        ThreadingPolicy::Single,
        ConvolutionMode::FixedPoint,
    )?;
    Ok(())
}
