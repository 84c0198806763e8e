//! Composition onto a tiny-skia pixmap.

mod mix;
mod painter;
mod texture;

use core::ops::Range;

use tiny_skia::Pixmap;

use self::mix::Mixer;
use self::painter::{Painter, Window};
use super::caster::Cast;
use super::{Receiver, Stage};
use crate::error::{Error, Result};
#[cfg(feature = "finish")]
use crate::finish::Finished;
use crate::grid::Grid;
use crate::limits::Limits;
use crate::scene::{Form, Scene, Surface};
use crate::shadow::Bounds;
#[cfg(feature = "finish")]
use crate::tone::Color;

/// Draws scenes. It keeps nothing of a scene but the memory that it drew it with.
#[derive(Debug, Default)]
pub struct Renderer {
    limits: Limits,
    painter: Painter,
}

/// A band of rows has about so many pixels: few enough to be drawn in some milliseconds a layer, so many that their beginnings
/// do not count.
const BAND: u32 = 1 << 20;

/// The bands of some rows of a `width` above 0.
fn bands(width: u32, rows: Range<u32>) -> impl ExactSizeIterator<Item = Range<u32>> {
    let step = (BAND / width).max(1);
    let end = rows.end;
    rows.step_by(step as usize)
        .map(move |first| first..end.min(first + step))
}

/// A scene that is drawn, and what of it all its layers need.
struct Job<'a> {
    scene: &'a Scene,
    stage: Stage<'a>,
    grid: Grid,
    mixer: Mixer,
    /// What falls on the ground, which all bands of rows show: strengths and casts.
    on_ground: Vec<(f32, Vec<Cast>)>,
    /// The surfaces' images in the order that they are drawn, as far as these are seen.
    images: Vec<Option<Pixmap>>,
    /// The surfaces' finishes in the order that they are drawn.
    #[cfg(feature = "finish")]
    finishes: Vec<Option<Finished<'a>>>,
}

impl Renderer {
    /// A renderer without memory yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// One with other limits: it refuses scenes over them.
    #[must_use]
    pub fn with_limits(limits: Limits) -> Self {
        Self {
            limits,
            ..Self::default()
        }
    }

    /// Draws the scene onto a pixmap of its picture's size, over whatever was there.
    ///
    /// # Errors
    /// [`Error::BufferSize`] when the pixmap has another size than [`Scene::grid`], [`Error::TooMany`] when the scene is over
    /// the renderer's [`Limits`].
    ///
    /// ```
    /// use penumbral::{Light, Renderer, Scene, Shape, Surface};
    /// use tiny_skia::Pixmap;
    ///
    /// let mut scene = Scene::new([120.0, 80.0], Light::android(120.0)?)?;
    /// scene.push(Surface::new(Shape::rounded_rect(20.0, 20.0, 80.0, 40.0, 8.0)?, 4.0))?;
    /// let mut pixmap = Pixmap::new(120, 80).unwrap();
    /// Renderer::new().render(&scene, &mut pixmap)?;
    /// # Ok::<(), penumbral::Error>(())
    /// ```
    pub fn render(&mut self, scene: &Scene, pixmap: &mut Pixmap) -> Result<()> {
        self.render_while(scene, pixmap, |_, _| true)
    }

    /// As [`Renderer::render`], as long as `goes_on` says so: it is asked after each layer, of which each band of some rows has its
    /// own, with the number of layers drawn and of all. A picture that it stops is not whole.
    ///
    /// # Errors
    /// As [`Renderer::render`], and [`Error::Stopped`].
    pub fn render_while(
        &mut self,
        scene: &Scene,
        pixmap: &mut Pixmap,
        mut goes_on: impl FnMut(usize, usize) -> bool,
    ) -> Result<()> {
        let job = self.begin(scene, pixmap)?;
        let grid = &job.grid;
        let bands = bands(grid.width(), 0..grid.height());
        let count = bands.len();
        for (band, rows) in bands.enumerate() {
            let window = Window::new(grid, 0..grid.width(), rows);
            self.painter.draw(&job, &window, pixmap, |done, layers| {
                if goes_on(band * layers + done, count * layers) {
                    Ok(())
                } else {
                    Err(Error::Stopped)
                }
            })?;
        }
        Ok(())
    }

    /// Draws the pixels that meet boxes (scene units), as [`Renderer::render`] draws them bit for bit, and leaves all others as they
    /// are: with [`Scene::damage_since`], what has changed since the pixmap was drawn.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    ///
    /// ```
    /// use penumbral::{Light, Renderer, Scene, Shape, Surface};
    /// use tiny_skia::Pixmap;
    ///
    /// let scene = |x: f32| -> penumbral::Result<Scene> {
    ///     let mut scene = Scene::new([120.0, 80.0], Light::android(120.0)?)?;
    ///     scene.push(Surface::new(Shape::rounded_rect(x, 20.0, 40.0, 40.0, 8.0)?, 4.0))?;
    ///     Ok(scene)
    /// };
    /// let (before, after) = (scene(10.0)?, scene(14.0)?);
    /// let mut renderer = Renderer::new();
    /// let mut pixmap = Pixmap::new(120, 80).unwrap();
    /// renderer.render(&before, &mut pixmap)?;
    /// renderer.render_within(&after, &after.damage_since(&before)?, &mut pixmap)?;
    /// # Ok::<(), penumbral::Error>(())
    /// ```
    pub fn render_within(
        &mut self,
        scene: &Scene,
        boxes: &[Bounds],
        pixmap: &mut Pixmap,
    ) -> Result<()> {
        let job = self.begin(scene, pixmap)?;
        let grid = &job.grid;
        let scale = grid.pixels_per_unit();
        for bounds in boxes {
            let [columns, rows] = [0, 1].map(|axis| {
                let end = f64::from([grid.width(), grid.height()][axis]);
                let pixel = |v: f32, round: fn(f64) -> f64| {
                    round(f64::from(v) * scale).clamp(0.0, end) as u32
                };
                pixel(bounds.min[axis], f64::floor)..pixel(bounds.max[axis], f64::ceil)
            });
            if columns.is_empty() {
                continue;
            }
            for rows in bands(columns.end - columns.start, rows) {
                let window = Window::new(grid, columns.clone(), rows);
                self.painter.draw(&job, &window, pixmap, |_, _| Ok(()))?;
            }
        }
        Ok(())
    }

    /// Refuses what is over the limits or has no place on the pixmap.
    fn begin<'a>(&self, scene: &'a Scene, pixmap: &Pixmap) -> Result<Job<'a>> {
        self.limits.check(scene)?;
        let grid = scene.grid()?;
        if (pixmap.width(), pixmap.height()) != (grid.width(), grid.height()) {
            return Err(Error::BufferSize {
                length: pixmap.pixels().len(),
                needed: grid.width() as usize * grid.height() as usize,
            });
        }
        let stage = Stage::new(scene)?;
        Ok(Job {
            scene,
            #[cfg(feature = "finish")]
            finishes: finishes(scene, &stage)?,
            on_ground: stage.casts(&Receiver::ground(scene))?,
            images: images(scene, &stage)?,
            stage,
            grid,
            mixer: Mixer::new(&scene.tone()),
        })
    }
}

/// The images of surfaces that are seen, premultiplied.
fn images(scene: &Scene, stage: &Stage<'_>) -> Result<Vec<Option<Pixmap>>> {
    let image = |surface: &&Surface| match surface.form() {
        Form::Image(image, _) if surface.weight() > 0.0 => {
            let is_seen = Receiver::surface(scene, surface).is_some();
            is_seen.then(|| texture::premultiplied(image)).transpose()
        }
        _ => Ok(None),
    };
    stage.order.iter().map(image).collect()
}

#[cfg(feature = "finish")]
fn finishes<'a>(scene: &'a Scene, stage: &Stage<'a>) -> Result<Vec<Option<Finished<'a>>>> {
    let finished = stage.order.iter().map(|&surface| {
        let finish = surface.finish().filter(|_| surface.weight() > 0.0);
        let Color { r, g, b, .. } = surface.fill();
        let on = |finish| {
            let (shape, elevation) = (surface.rimmed(), surface.elevation());
            Finished::new(finish, shape, elevation, [r, g, b], scene.lights())
        };
        finish.map(on).transpose()
    });
    finished.collect()
}
