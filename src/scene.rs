//! Scene: surfaces over a ground, under one or more lights.

mod group;
#[cfg(feature = "scene")]
mod json;
mod surface;

pub use self::group::Group;
pub(crate) use self::surface::Form;
pub use self::surface::Surface;

use crate::compose::Overlap;
use crate::error::{self, Error, MAX_PIXELS, Result};
use crate::grid::{Grid, LEAST_SCALE, MOST_SCALE};
use crate::light::Light;
use crate::tone::{Color, Tone};

/// A canvas at elevation 0, the ground, with surfaces above it and one or more lights over all.
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
    /// The lights besides, and the strengths of their shadows.
    more_lights: Vec<(Light, f32)>,
    tone: Tone,
    overlap: Overlap,
    surfaces: Vec<Surface>,
    /// Of those that were read from a file.
    #[cfg(feature = "scene")]
    surface_fields: Vec<String>,
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
            more_lights: Vec::new(),
            tone: Tone::default(),
            overlap: Overlap::default(),
            surfaces: Vec::new(),
            #[cfg(feature = "scene")]
            surface_fields: Vec::new(),
        };
        scene.picture_size()?;
        Ok(scene)
    }

    /// The same at `scale` pixels a scene unit.
    ///
    /// # Errors
    /// A scale not from 1/1024 to 1024, a picture of more than [`MAX_PIXELS`](crate::MAX_PIXELS).
    pub fn with_scale(mut self, scale: f32) -> Result<Self> {
        error::within("scale", f64::from(scale), LEAST_SCALE, MOST_SCALE)?;
        self.scale = scale;
        self.picture_size()?;
        Ok(self)
    }

    /// The same on another ground.
    ///
    /// # Errors
    /// [`Error::NotOpaque`] for a colour whose alpha is not 255.
    pub fn with_background(mut self, background: Color) -> Result<Self> {
        error::opaque("background", background.a)?;
        self.background = background;
        Ok(self)
    }

    /// The same with another tone.
    #[must_use]
    pub fn with_tone(mut self, tone: Tone) -> Self {
        self.tone = tone;
        self
    }

    /// The same with another way to put shadows of several elevations together.
    #[must_use]
    pub fn with_overlap(mut self, overlap: Overlap) -> Self {
        self.overlap = overlap;
        self
    }

    /// Adds a light whose shadows are of strength `key` (0 to 1) where it is wholly hidden; the first light's strength is the
    /// tone's. Each light's shadows darken what the others leave.
    ///
    /// # Errors
    /// A strength that is not from 0 to 1, and a surface of the scene that the light cannot cast.
    pub fn push_light(&mut self, light: Light, key: f32) -> Result<()> {
        error::within("key", f64::from(key), 0.0, 1.0)?;
        for surface in &self.surfaces {
            check(&light, surface)?;
        }
        self.more_lights.push((light, key));
        Ok(())
    }

    /// Adds a surface. Surfaces paint by elevation, those of one elevation in the order they were added.
    ///
    /// # Errors
    /// An elevation below 0 or not below a light, an opacity not from 0 to 1, a caster so near a light that its shadow
    /// passes [`MAX_COORDINATE`](crate::MAX_COORDINATE), a finish on a tilted surface or an image.
    pub fn push(&mut self, surface: Surface) -> Result<()> {
        error::within("opacity", f64::from(surface.opacity()), 0.0, 1.0)?;
        #[cfg(feature = "finish")]
        if surface.finish().is_some() && !matches!(surface.form(), Form::Level) {
            return Err(Error::NotFinished);
        }
        for (light, _) in self.lights() {
            check(&light, &surface)?;
        }
        self.surfaces.push(surface);
        Ok(())
    }

    /// Adds what is left of a group's surfaces, or none of them where one is refused.
    ///
    /// # Errors
    /// As [`Scene::push`] and [`Surface::clipped`], and groups nested too deep.
    pub fn push_group(&mut self, group: &Group) -> Result<()> {
        let before = self.surfaces.len();
        let pushed = group.flatten(None, &mut |surface| self.push(surface));
        if pushed.is_err() {
            self.surfaces.truncate(before);
        }
        pushed
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

    /// The first light.
    #[must_use]
    pub fn light(&self) -> &Light {
        &self.light
    }

    /// All lights, and the strength (0 to 1) of each one's shadows.
    pub fn lights(&self) -> impl Iterator<Item = (Light, f32)> {
        let more = self.more_lights.iter().copied();
        core::iter::once((self.light, self.tone.key())).chain(more)
    }

    /// How shadows of several elevations are put together.
    #[must_use]
    pub fn overlap(&self) -> Overlap {
        self.overlap
    }

    /// Whether all but the surfaces is the same.
    pub(crate) fn is_lit_as(&self, other: &Self) -> bool {
        let all = |scene: &Self| {
            (
                scene.canvas,
                scene.background,
                scene.scale,
                scene.light,
                scene.tone,
                scene.overlap,
            )
        };
        all(self) == all(other) && self.more_lights == other.more_lights
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

    /// The fields of the scene file that the surfaces were read from, as errors name them: `surfaces[2].group[0]`. They come in
    /// the surfaces' own order; surfaces that were pushed later have none.
    #[cfg(feature = "scene")]
    #[must_use]
    pub fn surface_fields(&self) -> &[String] {
        &self.surface_fields
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
                .elevation()
                .total_cmp(&self.surfaces[b].elevation())
        });
        order
    }
}

/// Refuses a surface that a light cannot cast on the ground.
fn check(light: &Light, surface: &Surface) -> Result<()> {
    match surface.form() {
        // What is below the ground or above the light hides nothing.
        Form::Posed(_) => {
            for corner in surface.corners().into_iter().flatten() {
                error::coordinate("elevation", corner.z)?;
            }
            Ok(())
        }
        Form::Level | Form::Image(..) => {
            let projection = light.projection(surface.elevation(), 0.0)?;
            projection.check_reach(surface.shape(), surface.elevation())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Shape;

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
