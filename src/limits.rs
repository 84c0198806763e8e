//! Limits: how much a scene may ask for.

use crate::error::{Error, MAX_PIXELS, MAX_SCENE_LENGTH, MAX_SEGMENTS, Result};
use crate::scene::Scene;

/// How much a scene may ask for, so that what reads and draws scenes of others has a bound on its memory. None of them is on
/// time: whether a scene is drawn must not depend on the machine. To stop a drawing see
/// [`Renderer::render_while`](crate::Renderer).
///
/// The defaults hold for whatever does not say otherwise. With `n` pixels in rows of `w`, `v` vertices of which `c` begin Bézier curves or
/// arcs of ellipses, the longest of `d` pixels, `x` crossings of outlines with themselves or each other, `t` texels of images, and `l` bytes of text,
/// reading and drawing a scene takes no more than
///
/// ```text
/// 4 n + 20 min(n, max(w, 2^20)) + 2^11 (v + 32 c sqrt(d)) + 2^8 x + 32 t + 20 l + 2^20 bytes
/// ```
///
/// of which the picture itself is 4 n: it is drawn in bands of rows. That is measured, and twice what was found; edges may cross as often as half the square of their number, so whoever draws
/// the scenes of strangers sets `vertices` to some thousands.
///
/// ```
/// use penumbral::{Limits, Scene};
///
/// let mut limits = Limits::default();
/// limits.surfaces = 100;
/// let scene = Scene::from_json_within(
///     r#"{"canvas": [60, 40], "light": {"x": 30, "y": 0, "z": 600, "radius": 800}, "surfaces": []}"#,
///     &limits,
///     &mut |name| Err(format!("no image {name}")),
/// )?;
/// # Ok::<(), penumbral::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Limits {
    /// Pixels of the picture: [`MAX_PIXELS`] unless less is set; more are never drawn.
    pub pixels: u64,
    /// Lines, curves and arcs of all surfaces together: [`MAX_SEGMENTS`], which no single path passes either.
    pub vertices: usize,
    /// Surfaces: 65,536.
    pub surfaces: usize,
    /// Bytes of a scene file: [`MAX_SCENE_LENGTH`].
    pub scene_length: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            pixels: MAX_PIXELS,
            vertices: MAX_SEGMENTS,
            surfaces: 1 << 16,
            scene_length: MAX_SCENE_LENGTH,
        }
    }
}

impl Limits {
    /// Refuses a scene that asks for more.
    ///
    /// # Errors
    /// [`Error::TooMany`] pixels, surfaces or vertices.
    pub fn check(&self, scene: &Scene) -> Result<()> {
        let grid = scene.grid()?;
        let pixels = u64::from(grid.width()) * u64::from(grid.height());
        // Both are within MAX_PIXELS.
        at_most(
            "pixels",
            pixels as usize,
            self.pixels.min(MAX_PIXELS) as usize,
        )?;
        at_most("surfaces", scene.surfaces().len(), self.surfaces)?;
        let shapes = scene.surfaces().iter().map(|surface| surface.shape());
        at_most(
            "vertices",
            shapes.map(|shape| shape.vertices()).sum(),
            self.vertices,
        )
    }
}

/// Refuses a number over its limit.
pub(crate) fn at_most(field: &'static str, count: usize, limit: usize) -> Result<()> {
    if count > limit {
        return Err(Error::TooMany {
            field,
            count,
            limit,
        });
    }
    Ok(())
}
