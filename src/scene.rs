//! Scene: surfaces over a ground, under one light.

#[cfg(feature = "scene")]
mod json;

use crate::error::{self, Error, MAX_PIXELS, Result};
use crate::grid::Grid;
use crate::light::{Light, Projection};
use crate::shadow::Shadow;
use crate::shape::Shape;
use crate::tone::{Color, Tone};

/// A canvas at elevation 0, the ground, with surfaces above it and a light over all.
///
/// ```
/// use penumbral::{Color, Light, Scene, Shape, Surface};
///
/// let mut scene = Scene::new([360.0, 200.0], Light::android(360.0)?)?;
/// let card = Shape::rounded_rect(24.0, 24.0, 312.0, 120.0, 12.0)?;
/// scene.push(Surface::new(card, 8.0).with_fill(Color::WHITE))?;
/// # Ok::<(), penumbral::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Scene {
    canvas: [f32; 2],
    background: Color,
    scale: f32,
    light: Light,
    tone: Tone,
    surfaces: Vec<Surface>,
}

/// A flat shape at an elevation: it casts shadows on what is below and receives them from what is above.
#[derive(Debug, Clone)]
pub struct Surface {
    shape: Shape,
    elevation: f32,
    opacity: f32,
    fill: Color,
    name: Option<String>,
}

impl Surface {
    /// An opaque white surface; its elevation above the ground is in scene units.
    #[must_use]
    pub fn new(shape: Shape, elevation: f32) -> Self {
        Self {
            shape,
            elevation,
            opacity: 1.0,
            fill: Color::WHITE,
            name: None,
        }
    }

    /// The same with another fill.
    #[must_use]
    pub fn with_fill(mut self, fill: Color) -> Self {
        self.fill = fill;
        self
    }

    /// The same with another opacity, 0 to 1; it multiplies the fill's own.
    #[must_use]
    pub fn with_opacity(mut self, opacity: f32) -> Self {
        self.opacity = opacity;
        self
    }

    /// The same with a name, for messages.
    #[must_use]
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.name = Some(name.into());
        self
    }

    /// The shape.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The elevation above the ground, scene units.
    #[must_use]
    pub fn elevation(&self) -> f32 {
        self.elevation
    }

    /// The fill; its alpha and the opacity multiply.
    #[must_use]
    pub fn fill(&self) -> Color {
        self.fill
    }

    /// The name, if it has one.
    #[must_use]
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// How much of what is behind it the surface hides, and of the light: opacity times the fill's alpha, 0 to 1.
    #[must_use]
    pub fn weight(&self) -> f32 {
        self.opacity * f32::from(self.fill.a) / 255.0
    }

    /// The surface's own coverage: its hard shadow on itself.
    pub(crate) fn cover(&self) -> Shadow {
        Shadow::project(&[self.shape()], &Projection::in_place(0.0))
    }

    /// Whether nothing is seen through it.
    #[must_use]
    pub fn is_opaque(&self) -> bool {
        self.weight() >= 1.0
    }
}

impl Scene {
    /// A scene without surfaces on a `canvas` (width, height; scene units) of `#fafafa`, at one pixel a unit, with
    /// Android's tone.
    ///
    /// # Errors
    /// A side that is not finite or not above 0, a picture of more than [`MAX_PIXELS`](crate::MAX_PIXELS).
    pub fn new(canvas: [f32; 2], light: Light) -> Result<Self> {
        error::positive("canvas width", f64::from(canvas[0]))?;
        error::positive("canvas height", f64::from(canvas[1]))?;
        let scene = Self {
            canvas,
            background: Color::rgb(0xfa, 0xfa, 0xfa),
            scale: 1.0,
            light,
            tone: Tone::default(),
            surfaces: Vec::new(),
        };
        scene.picture_size()?;
        Ok(scene)
    }

    /// The same at `scale` pixels a scene unit.
    ///
    /// # Errors
    /// A scale not from 1/1024 to 1024, a picture of more than [`MAX_PIXELS`](crate::MAX_PIXELS).
    pub fn with_scale(mut self, scale: f32) -> Result<Self> {
        error::within("scale", f64::from(scale), 1.0 / 1024.0, 1024.0)?;
        self.scale = scale;
        self.picture_size()?;
        Ok(self)
    }

    /// The same on another ground.
    ///
    /// # Errors
    /// [`Error::NotOpaque`] for a colour whose alpha is not 255.
    pub fn with_background(mut self, background: Color) -> Result<Self> {
        if background.a < 255 {
            return Err(Error::NotOpaque {
                field: "background",
                alpha: background.a,
            });
        }
        self.background = background;
        Ok(self)
    }

    /// The same with another tone.
    #[must_use]
    pub fn with_tone(mut self, tone: Tone) -> Self {
        self.tone = tone;
        self
    }

    /// Adds a surface. Surfaces paint by elevation, those of one elevation in the order they were added.
    ///
    /// # Errors
    /// An elevation below 0 or not below the light, an opacity not from 0 to 1, a caster so near the light that its shadow
    /// passes [`MAX_COORDINATE`](crate::MAX_COORDINATE).
    pub fn push(&mut self, surface: Surface) -> Result<()> {
        error::within("opacity", f64::from(surface.opacity), 0.0, 1.0)?;
        let projection = self.light.projection(surface.elevation, 0.0)?;
        projection.check_reach(&surface.shape, surface.elevation)?;
        self.surfaces.push(surface);
        Ok(())
    }

    /// Width and height, scene units.
    #[must_use]
    pub fn canvas(&self) -> [f32; 2] {
        self.canvas
    }

    /// The ground's colour.
    #[must_use]
    pub fn background(&self) -> Color {
        self.background
    }

    /// Pixels a scene unit.
    #[must_use]
    pub fn scale(&self) -> f32 {
        self.scale
    }

    /// The light.
    #[must_use]
    pub fn light(&self) -> &Light {
        &self.light
    }

    /// How density becomes paint.
    #[must_use]
    pub fn tone(&self) -> Tone {
        self.tone
    }

    /// The surfaces in the order they were added.
    #[must_use]
    pub fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }

    /// The picture's pixels: the canvas times the scale, rounded up. A thousandth of a pixel is no pixel: scales like
    /// 2.625 and canvases like 411.428 are not quite what they say in `f32`.
    ///
    /// # Errors
    /// [`Error::PictureSize`] over [`MAX_PIXELS`].
    fn picture_size(&self) -> Result<[u32; 2]> {
        let pixels = |side: f32| {
            (f64::from(side) * f64::from(self.scale) - 1e-3)
                .ceil()
                .max(1.0)
        };
        let [width, height] = self.canvas.map(pixels);
        if width * height > MAX_PIXELS as f64 {
            return Err(Error::PictureSize {
                width: width as u64,
                height: height as u64,
            });
        }
        Ok([width as u32, height as u32])
    }

    /// The grid of the scene's picture.
    ///
    /// # Errors
    /// None that the constructors let pass.
    pub fn grid(&self) -> Result<Grid> {
        Grid::new([0.0, 0.0], self.picture_size()?, self.scale)
    }

    /// The surfaces' indices from the lowest to the highest, those of one elevation in the order they were added.
    pub(crate) fn paint_order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.surfaces.len()).collect();
        order.sort_by(|&a, &b| {
            self.surfaces[a]
                .elevation
                .total_cmp(&self.surfaces[b].elevation)
        });
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_scales_give_whole_pictures() {
        let light = Light::android(100.0).unwrap();
        for (canvas, scale, pixels) in [
            (411.428_6, 2.625, 1080),
            (1.1, 10.0, 11),
            (10.01, 1.0, 11),
            (0.2, 1.0, 1),
        ] {
            let scene = Scene::new([canvas, 1.0], light)
                .unwrap()
                .with_scale(scale)
                .unwrap();
            assert_eq!(scene.grid().unwrap().width(), pixels, "{canvas} x {scale}");
        }
    }

    #[test]
    fn what_is_out_of_range_is_refused() {
        let light = Light::android(100.0).unwrap();
        assert!(matches!(
            Scene::new([1e6, 1e6], light),
            Err(Error::PictureSize { .. })
        ));
        assert!(Scene::new([0.0, 10.0], light).is_err());
        let mut scene = Scene::new([100.0, 100.0], light).unwrap();
        let card = || Shape::rect(0.0, 0.0, 10.0, 10.0).unwrap();
        assert!(scene.push(Surface::new(card(), 600.0)).is_err());
        assert!(scene.push(Surface::new(card(), -1.0)).is_err());
        assert!(
            scene
                .push(Surface::new(card(), 1.0).with_opacity(1.5))
                .is_err()
        );
        assert!(scene.clone().with_scale(0.0).is_err());
        assert!(scene.with_scale(200.0).is_err());
    }
}
