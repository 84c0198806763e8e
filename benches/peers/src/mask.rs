//! What blur crates need around them to draw shadows: an antialiased A8 mask of the caster, and its blending.
//!
//! Both are here for all of them alike, so their differences are the blurs'.

use anyhow::{Context, Result};
use tiny_skia::{IntSize, Mask, Transform};

use crate::peer::Draw;
use crate::scene::{Caster, PixelRect, Scene};

/// Draws a scene through a blur of A8 masks: `blur` gets a mask, its width and height and the standard deviation, and
/// gives back one of the same size.
pub(crate) fn draw_blurred<'a, B>(scene: &'a Scene, mut blur: B) -> Draw<'a>
where
    B: FnMut(Vec<u8>, [u32; 2], f64) -> Result<Vec<u8>> + 'a,
{
    let layer = |caster| Layer::new(scene, caster);
    let mut layers: Vec<Layer<'a>> = scene.casters.iter().filter_map(layer).collect();
    Box::new(move |canvas| {
        for layer in &mut layers {
            layer.fill()?;
            let size = [layer.rect.width(), layer.rect.height()];
            let coverage = core::mem::take(&mut layer.coverage);
            layer.coverage = blur(coverage, size, layer.caster.sigma())?;
            layer.blend([scene.width, scene.height], canvas);
        }
        Ok(())
    })
}

/// A caster's mask, its memory kept from drawing to drawing.
struct Layer<'a> {
    caster: &'a Caster,
    rect: PixelRect,
    coverage: Vec<u8>,
}

impl<'a> Layer<'a> {
    /// A mask as large as the blur reaches. Beyond the canvas too: what is there is blurred into it.
    fn new(scene: &Scene, caster: &'a Caster) -> Option<Self> {
        let reach = (3.0 * caster.sigma()).ceil() + 1.0;
        let rect = scene.pixels_within(caster, reach, reach as i32)?;
        Some(Self {
            caster,
            rect,
            coverage: vec![0; rect.area()],
        })
    }

    fn fill(&mut self) -> Result<()> {
        let Self {
            caster,
            rect,
            coverage,
        } = self;
        let size = IntSize::from_wh(rect.width(), rect.height()).context("a mask without size")?;
        let coverage_now = core::mem::take(coverage);
        let mut mask = Mask::from_vec(coverage_now, size).context("a blur changed its size")?;
        mask.clear();
        let to_mask = Transform::from_translate(-rect.x0 as f32, -rect.y0 as f32);
        mask.fill_path(&caster.skia, caster.rule, true, to_mask);
        *coverage = mask.take();
        Ok(())
    }

    fn blend(&mut self, [width, height]: [u32; 2], canvas: &mut [u8]) {
        if self.caster.opacity < 1.0 {
            scale(&mut self.coverage, self.caster.opacity);
        }
        let rect = self.rect;
        let (left, right) = (rect.x0.max(0), rect.x1.min(width as i32));
        if left >= right {
            return;
        }
        for y in rect.y0.max(0)..rect.y1.min(height as i32) {
            let row = rect.width() as usize * y.abs_diff(rect.y0) as usize;
            let coverage = &self.coverage[row + left.abs_diff(rect.x0) as usize..];
            let pixels = &mut canvas[(y as usize * width as usize + left as usize) * 4..];
            let count = left.abs_diff(right) as usize;
            blend_row(&mut pixels[..count * 4], &coverage[..count]);
        }
    }
}

/// `v` / 255 to the nearest, for v up to 255².
fn over_255(v: u16) -> u16 {
    let v = v + 128;
    (v + (v >> 8)) >> 8
}

fn scale(coverage: &mut [u8], opacity: f32) {
    let opacity = (opacity * 255.0).round() as u16;
    for value in coverage {
        *value = over_255(u16::from(*value) * opacity) as u8;
    }
}

/// Draws black of some coverage, a byte a pixel, over premultiplied RGBA8 pixels.
pub(crate) fn blend_row(pixels: &mut [u8], coverage: &[u8]) {
    let (blocks, pixels) = pixels.as_chunks_mut::<{ 4 * BLOCK }>();
    let (masks, coverage) = coverage.as_chunks::<BLOCK>();
    for (block, mask) in blocks.iter_mut().zip(masks) {
        blend_block(block, mask);
    }
    for (pixel, coverage) in pixels.as_chunks_mut::<4>().0.iter_mut().zip(coverage) {
        *pixel = blended(*pixel, *coverage);
    }
}

/// Pixels at a time: loops of a fixed length become vector instructions.
const BLOCK: usize = 8;

fn blend_block(pixels: &mut [u8; 4 * BLOCK], coverage: &[u8; BLOCK]) {
    let cover: [u8; 4 * BLOCK] = core::array::from_fn(|i| coverage[i / 4]);
    let alpha: [u8; 4 * BLOCK] = core::array::from_fn(|i| if i % 4 == 3 { 255 } else { 0 });
    for i in 0..4 * BLOCK {
        let kept = over_255(u16::from(pixels[i]) * u16::from(255 - cover[i])) as u8;
        pixels[i] = kept + (cover[i] & alpha[i]);
    }
}

fn blended(pixel: [u8; 4], coverage: u8) -> [u8; 4] {
    let keep = u16::from(255 - coverage);
    let [r, g, b, a] = pixel.map(|channel| over_255(u16::from(channel) * keep) as u8);
    [r, g, b, a + coverage]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_and_the_rest_of_a_row_blend_alike() {
        let coverage: Vec<u8> = (0..=255).chain([3, 77, 201]).collect();
        for start in [[255, 255, 255, 255], [90, 17, 0, 128]] {
            let mut pixels = start.repeat(coverage.len());
            blend_row(&mut pixels, &coverage);
            for (pixel, cover) in pixels.as_chunks::<4>().0.iter().zip(&coverage) {
                assert_eq!(*pixel, blended(start, *cover));
            }
        }
        assert_eq!(blended([255; 4], 255), [0, 0, 0, 255]);
        assert_eq!(blended([9, 8, 7, 6], 0), [9, 8, 7, 6]);
    }
}
