//! Composition onto a tiny-skia pixmap.

mod mix;
mod texture;

use core::ops::Range;

use glam::DVec2;
use tiny_skia::{ColorU8, Pixmap};

use self::mix::Mixer;
use self::texture::Texture;
use super::caster::Cast;
use super::fusion::{self, groups};
use super::{Receiver, Stage};
use crate::density::{self, Each, PixelOptions};
use crate::error::{Error, Result};
#[cfg(feature = "finish")]
use crate::finish::Finished;
use crate::grid::Grid;
use crate::hidden::Hidden;
use crate::limits::Limits;
use crate::scene::{Form, Scene, Surface};
use crate::scratch::Scratch;
use crate::shadow::Bounds;
use crate::tone::Color;

/// Draws scenes. It keeps nothing of a scene but the memory that it drew it with.
///
/// A surface and the shadows on it make one layer, which is then laid over what is below by the surface's coverage: at
/// its antialiased edge neither light nor dark shines through between the two.
#[derive(Debug, Default)]
pub struct Renderer {
    limits: Limits,
    scratch: Scratch,
    /// For each pixel that is drawn the rank of the highest surface that hides all below: 0 is the ground, 1 the lowest surface.
    topmost: Vec<u32>,
    /// Of the receiver that is being drawn: how much of each pixel it covers, and what passes of the lights and the ambience.
    cover: Vec<f32>,
    passed: Vec<f32>,
}

/// A receiver while it is drawn.
struct Layer {
    receiver: Receiver,
    rank: u32,
    fill: Fill,
    weight: f32,
    is_shaded: bool,
    /// The pixels that show it, and where among those that are drawn they begin.
    grid: Grid,
    first: [u32; 2],
}

enum Fill {
    Color(Color),
    Texture(Texture),
    #[cfg(feature = "finish")]
    Finish(Vec<[u8; 3]>),
}

/// The pixels that are drawn: some columns and rows of the picture's.
struct Window {
    columns: Range<u32>,
    rows: Range<u32>,
    grid: Grid,
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

impl Window {
    fn new(grid: &Grid, columns: Range<u32>, rows: Range<u32>) -> Self {
        Self {
            grid: grid.window([columns.start, rows.start], [columns.end, rows.end]),
            columns,
            rows,
        }
    }
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

    /// One that refuses scenes over other limits.
    #[must_use]
    pub fn within(limits: Limits) -> Self {
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
        self.render_with_progress(scene, pixmap, |_, _| {})
    }

    /// As [`Renderer::render`], calling `progress` with the number of layers drawn and of all layers after each.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn render_with_progress(
        &mut self,
        scene: &Scene,
        pixmap: &mut Pixmap,
        mut progress: impl FnMut(usize, usize),
    ) -> Result<()> {
        self.render_while(scene, pixmap, |done, layers| {
            progress(done, layers);
            true
        })
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
            self.draw(&job, &window, pixmap, |done, layers| {
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
                self.draw(&job, &window, pixmap, |_, _| Ok(()))?;
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

    fn draw(
        &mut self,
        job: &Job<'_>,
        window: &Window,
        pixmap: &mut Pixmap,
        mut progress: impl FnMut(usize, usize) -> Result<()>,
    ) -> Result<()> {
        let Job { scene, stage, .. } = job;
        let layers = stage.order.len() + 1;
        self.find_topmost(stage, window);
        let ground = Layer {
            receiver: Receiver::ground(scene),
            rank: 0,
            fill: Fill::Color(scene.background()),
            weight: 1.0,
            is_shaded: true,
            grid: window.grid,
            first: [0, 0],
        };
        self.cover.clear();
        self.cover.resize(self.topmost.len(), 1.0);
        if self.topmost.contains(&0) {
            self.draw_layer(job, &ground, window, pixmap)?;
        }
        progress(1, layers)?;
        for (index, &surface) in stage.order.iter().enumerate() {
            #[cfg_attr(
                not(feature = "finish"),
                expect(unused_mut, reason = "a finish is found late")
            )]
            if let Some(mut layer) = self.layer(job, index, window)? {
                self.find_cover(surface, &layer);
                #[cfg(feature = "finish")]
                if let Some(finished) = &job.finishes[index] {
                    layer.fill = Fill::Finish(finished.colors(&layer.grid, &self.cover));
                }
                self.draw_layer(job, &layer, window, pixmap)?;
            }
            progress(index + 2, layers)?;
        }
        Ok(())
    }

    fn find_topmost(&mut self, stage: &Stage<'_>, window: &Window) {
        let grid = &window.grid;
        self.topmost.clear();
        self.topmost
            .resize(grid.width() as usize * grid.height() as usize, 0);
        let scale = grid.pixels_per_unit();
        let is_on_grid = |surface: &Surface| {
            let hull = surface.hull();
            hull.is_some_and(|(min, max)| grid.meets((min * scale, max * scale)))
        };
        for (index, &surface) in stage.order.iter().enumerate() {
            if surface.is_opaque() && is_on_grid(surface) {
                let rank = index as u32 + 1;
                let mut sink = Each {
                    pixels: &mut self.topmost,
                    stride: grid.width() as usize,
                    put: |topmost: &mut u32, density: f32| {
                        if density >= 1.0 {
                            *topmost = rank;
                        }
                    },
                };
                let options = PixelOptions::default();
                density::draw(
                    &surface.cover(),
                    grid,
                    &options,
                    &mut self.scratch,
                    &mut sink,
                );
            }
        }
    }

    fn find_cover(&mut self, surface: &Surface, layer: &Layer) {
        let width = layer.grid.width();
        self.cover.clear();
        self.cover
            .resize(width as usize * layer.grid.height() as usize, 0.0);
        let mut sink = Each {
            pixels: &mut self.cover,
            stride: width as usize,
            put: |cover: &mut f32, density| *cover = density,
        };
        let options = PixelOptions::default();
        density::draw(
            &surface.cover(),
            &layer.grid,
            &options,
            &mut self.scratch,
            &mut sink,
        );
    }

    /// A surface, the one at that index of their order, as far as it is seen in the window, or none.
    fn layer(&self, job: &Job<'_>, index: usize, window: &Window) -> Result<Option<Layer>> {
        let (surface, rank) = (job.stage.order[index], index as u32 + 1);
        let Some(receiver) =
            Receiver::surface(job.scene, surface).filter(|_| surface.weight() > 0.0)
        else {
            return Ok(None);
        };
        let scale = window.grid.pixels_per_unit();
        let touched =
            [(0, &window.columns), (1, &window.rows)].map(|(axis, seen): (usize, &Range<u32>)| {
                let [first, end] = [
                    (receiver.min * scale).floor(),
                    (receiver.max * scale).ceil(),
                ]
                .map(|v: DVec2| (v[axis] as u32).clamp(seen.start, seen.end) - seen.start);
                first..end
            });
        let [columns, rows] = self.seen(touched, rank, window);
        if columns.is_empty() || rows.is_empty() {
            return Ok(None);
        }
        let first = [columns.start, rows.start];
        let grid = window.grid.window(first, [columns.end, rows.end]);
        let fill = match (surface.form(), &job.images[index]) {
            (Form::Image(_, place), Some(image)) => {
                Fill::Texture(Texture::new(image, place, &grid)?)
            }
            _ => Fill::Color(surface.fill()),
        };
        Ok(Some(Layer {
            receiver,
            rank,
            fill,
            weight: surface.weight(),
            is_shaded: surface.receives(),
            grid,
            first,
        }))
    }

    /// The columns and rows of the window around those pixels of some columns and rows in which a layer is seen.
    fn seen(
        &self,
        [columns, rows]: [Range<u32>; 2],
        rank: u32,
        window: &Window,
    ) -> [Range<u32>; 2] {
        let is_seen = |topmost: &u32| *topmost <= rank;
        let (mut left, mut right) = (columns.end, columns.start);
        let (mut top, mut bottom) = (rows.end, rows.start);
        for row in rows {
            let start = row as usize * window.grid.width() as usize;
            let pixels =
                &self.topmost[start + columns.start as usize..start + columns.end as usize];
            let ends = (
                pixels.iter().position(is_seen),
                pixels.iter().rposition(is_seen),
            );
            if let (Some(first), Some(last)) = ends {
                (left, right) = (
                    left.min(columns.start + first as u32),
                    right.max(columns.start + last as u32 + 1),
                );
                (top, bottom) = (top.min(row), row + 1);
            }
        }
        [left..right, top..bottom]
    }

    fn draw_layer(
        &mut self,
        job: &Job<'_>,
        layer: &Layer,
        window: &Window,
        pixmap: &mut Pixmap,
    ) -> Result<()> {
        self.find_passed(job, layer, window)?;
        let stride = pixmap.width() as usize;
        let pixels = pixmap.pixels_mut();
        let [left, top] = layer.first.map(|first| first as usize);
        let columns = layer.grid.width() as usize;
        for row in 0..layer.grid.height() as usize {
            let drawn = (row + top) * window.grid.width() as usize + left;
            let start = (row + top + window.rows.start as usize) * stride
                + left
                + window.columns.start as usize;
            for column in 0..columns {
                let index = row * columns + column;
                let mut alpha = self.cover[index] * layer.weight;
                if alpha == 0.0 || self.topmost[drawn + column] > layer.rank {
                    continue;
                }
                let fill = match &layer.fill {
                    Fill::Color(color) => [color.r, color.g, color.b],
                    Fill::Texture(texture) => {
                        let (color, opacity) = texture.at(index);
                        alpha *= opacity;
                        color
                    }
                    #[cfg(feature = "finish")]
                    Fill::Finish(colors) => colors[index],
                };
                let pixel = &mut pixels[start + column];
                let below = [pixel.red(), pixel.green(), pixel.blue()];
                let [r, g, b] = job.mixer.mixed(fill, below, self.passed[index], alpha);
                *pixel = ColorU8::from_rgba(r, g, b, 255).premultiply();
            }
        }
        Ok(())
    }

    /// Finds what the casters above let pass to each pixel of the layer.
    fn find_passed(&mut self, job: &Job<'_>, layer: &Layer, window: &Window) -> Result<()> {
        self.passed.clear();
        self.passed.resize(
            layer.grid.width() as usize * layer.grid.height() as usize,
            1.0,
        );
        if !layer.is_shaded {
            return Ok(());
        }
        let hidden = self.hidden_pixels(layer, window);
        let options = PixelOptions {
            hidden: Some(&hidden),
            ..PixelOptions::default()
        };
        let of_surface;
        let casts = if layer.rank == 0 {
            &job.on_ground
        } else {
            of_surface = job.stage.casts(&layer.receiver)?;
            &of_surface
        };
        for (strength, casts) in casts {
            let mut sink = Each {
                pixels: &mut self.passed,
                stride: layer.grid.width() as usize,
                put: |passed: &mut f32, held: f32| *passed *= 1.0 - strength * held,
            };
            for group in groups(casts, job.scene.overlap(), layer.grid.pixels_per_unit()) {
                fusion::draw(&group, &layer.grid, &options, &mut self.scratch, &mut sink);
            }
        }
        Ok(())
    }

    /// The layer's pixels that are not its own, or that a surface above hides.
    fn hidden_pixels(&self, layer: &Layer, window: &Window) -> Hidden {
        let [left, top] = layer.first;
        let mut hidden = Hidden::new(&layer.grid);
        hidden.add_where(|column, row| {
            let pixel = ((row + top) * window.grid.width() + column + left) as usize;
            self.topmost[pixel] > layer.rank
                || self.cover[(row * layer.grid.width() + column) as usize] == 0.0
        });
        hidden
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
