//! The image crate: its blurs of an A8 mask that tiny-skia fills. Each allocates its result, which counts.

use anyhow::{Context, Result};
use image::{GrayImage, imageops};

use crate::mask;
use crate::peer::{Draw, Peer};
use crate::scene::Scene;

/// `imageops::blur`: a Gaussian.
pub(crate) struct GaussianBlur;

impl Peer for GaussianBlur {
    fn name(&self) -> &'static str {
        "image blur"
    }

    fn prepare<'a>(&self, scene: &'a Scene) -> Result<Option<Draw<'a>>> {
        Ok(Some(draw(scene, imageops::blur)))
    }
}

/// `imageops::fast_blur`: three boxes.
pub(crate) struct FastBlur;

impl Peer for FastBlur {
    fn name(&self) -> &'static str {
        "image fast_blur"
    }

    fn prepare<'a>(&self, scene: &'a Scene) -> Result<Option<Draw<'a>>> {
        Ok(Some(draw(scene, imageops::fast_blur)))
    }
}

fn draw(scene: &Scene, blur: fn(&GrayImage, f32) -> GrayImage) -> Draw<'_> {
    mask::draw_blurred(scene, move |coverage, [width, height], sigma| {
        let mask = GrayImage::from_raw(width, height, coverage).context("a mask too small")?;
        Ok(blur(&mask, sigma as f32).into_raw())
    })
}
