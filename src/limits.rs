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
/// the scenes of strangers sets [`with_vertices`](Self::with_vertices) to some thousands.
///
/// ```
/// use penumbral::{Limits, Scene};
///
/// let limits = Limits::default().with_surfaces(100);
/// let scene = Scene::from_json_with_limits(
///     r#"{"canvas": [60, 40], "light": {"x": 30, "y": 0, "z": 600, "radius": 800}, "surfaces": []}"#,
///     &limits,
///     &mut |name| Err(format!("no image {name}")),
/// )?;
/// # Ok::<(), penumbral::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    pub(crate) pixels: u64,
    pub(crate) vertices: usize,
    pub(crate) surfaces: usize,
    pub(crate) scene_length: usize,
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
    /// With at most so many pixels in a picture: [`MAX_PIXELS`] otherwise, and never more.
    #[must_use]
    pub fn with_pixels(mut self, pixels: u64) -> Self {
        self.pixels = pixels;
        self
    }

    /// With at most so many lines, curves and arcs of all surfaces together: [`MAX_SEGMENTS`] otherwise, which no single path
    /// passes either.
    #[must_use]
    pub fn with_vertices(mut self, vertices: usize) -> Self {
        self.vertices = vertices;
        self
    }

    /// With at most so many surfaces: 65,536 otherwise.
    #[must_use]
    pub fn with_surfaces(mut self, surfaces: usize) -> Self {
        self.surfaces = surfaces;
        self
    }

    /// With at most so many bytes in a scene file: [`MAX_SCENE_LENGTH`] otherwise.
    #[must_use]
    pub fn with_scene_length(mut self, scene_length: usize) -> Self {
        self.scene_length = scene_length;
        self
    }

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
