//! Composition onto a tiny-skia pixmap.

use tiny_skia::{ColorU8, Pixmap};

use super::fusion::{self, Cast, groups};
use super::{Receiver, ambient_casts, key_casts};
use crate::density::{self, Each, PixelOptions};
use crate::error::{Error, Result};
use crate::grid::Grid;
use crate::hidden::Hidden;
use crate::scene::{Scene, Surface};
use crate::scratch::Scratch;
use crate::tone::Color;

/// Draws scenes. It keeps nothing of a scene but the memory that it drew it with.
///
/// A surface and the shadows on it make one layer, which is then laid over what is below by the surface's coverage: at
/// its antialiased edge neither light nor dark shines through between the two.
#[derive(Debug, Default)]
pub struct Renderer {
    scratch: Scratch,
    /// For each pixel the rank of the highest surface that hides all below: 0 is the ground, 1 the lowest surface.
    topmost: Vec<u32>,
    /// Of the receiver that is being drawn: how much of each pixel it covers, and what passes of light and ambience.
    cover: Vec<f32>,
    key: Vec<f32>,
    ambient: Vec<f32>,
}

/// A receiver while it is drawn.
struct Layer {
    receiver: Receiver,
    rank: u32,
    fill: Color,
    weight: f32,
    /// The pixels that it may touch, and where among the picture's they begin.
    grid: Grid,
    first: [u32; 2],
}

impl Renderer {
    /// A renderer without memory yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Draws the scene onto a pixmap of its picture's size, over whatever was there.
    ///
    /// # Errors
    /// [`Error::BufferSize`] when the pixmap has another size than [`Scene::grid`].
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
        let grid = scene.grid()?;
        if (pixmap.width(), pixmap.height()) != (grid.width(), grid.height()) {
            return Err(Error::BufferSize {
                length: pixmap.pixels().len(),
                needed: grid.width() as usize * grid.height() as usize,
            });
        }
        let order = scene.paint_order();
        let layers = order.len() + 1;
        self.find_topmost(scene, &order, &grid);
        let ground = Layer {
            receiver: Receiver::ground(scene),
            rank: 0,
            fill: scene.background(),
            weight: 1.0,
            grid,
            first: [0, 0],
        };
        self.cover.clear();
        self.cover.resize(self.topmost.len(), 1.0);
        if self.is_visible(&ground, grid.width()) {
            self.draw_layer(scene, &ground, pixmap)?;
        }
        progress(1, layers);
        for (index, &surface) in order.iter().enumerate() {
            let surface = &scene.surfaces()[surface];
            let layer = layer(scene, surface, index as u32 + 1, &grid);
            if let Some(layer) = layer.filter(|layer| self.is_visible(layer, grid.width())) {
                self.find_cover(surface, &layer);
                self.draw_layer(scene, &layer, pixmap)?;
            }
            progress(index + 2, layers);
        }
        Ok(())
    }

    fn find_topmost(&mut self, scene: &Scene, order: &[usize], grid: &Grid) {
        self.topmost.clear();
        self.topmost
            .resize(grid.width() as usize * grid.height() as usize, 0);
        for (index, &surface) in order.iter().enumerate() {
            let surface = &scene.surfaces()[surface];
            if surface.is_opaque() {
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

    /// Whether anything of the layer is seen.
    fn is_visible(&self, layer: &Layer, stride: u32) -> bool {
        let [left, top] = layer.first;
        (top..top + layer.grid.height()).any(|row| {
            let start = (row * stride + left) as usize;
            let pixels = &self.topmost[start..start + layer.grid.width() as usize];
            pixels.iter().any(|&rank| rank <= layer.rank)
        })
    }

    fn draw_layer(&mut self, scene: &Scene, layer: &Layer, pixmap: &mut Pixmap) -> Result<()> {
        let mut key = core::mem::take(&mut self.key);
        let mut ambient = core::mem::take(&mut self.ambient);
        let hidden = self.hidden_pixels(layer, pixmap.width());
        let key_casts = key_casts(scene, &layer.receiver)?;
        self.transmit(&key_casts, layer, &hidden, &mut key);
        let ambient_casts = ambient_casts(scene, &layer.receiver)?;
        self.transmit(&ambient_casts, layer, &hidden, &mut ambient);
        let strength = scene.tone().key();
        let fill = [layer.fill.r, layer.fill.g, layer.fill.b].map(f32::from);
        let stride = pixmap.width() as usize;
        let pixels = pixmap.pixels_mut();
        let columns = layer.grid.width() as usize;
        for row in 0..layer.grid.height() as usize {
            let start = (row + layer.first[1] as usize) * stride + layer.first[0] as usize;
            for column in 0..columns {
                let index = row * columns + column;
                let alpha = self.cover[index] * layer.weight;
                if alpha == 0.0 || self.topmost[start + column] > layer.rank {
                    continue;
                }
                let light = (1.0 - strength * (1.0 - key[index])) * ambient[index];
                let below = pixels[start + column];
                let below = [below.red(), below.green(), below.blue()].map(f32::from);
                let [r, g, b] = [0, 1, 2]
                    .map(|c: usize| (below[c] + (fill[c] * light - below[c]) * alpha + 0.5) as u8);
                pixels[start + column] = ColorU8::from_rgba(r, g, b, 255).premultiply();
            }
        }
        (self.key, self.ambient) = (key, ambient);
        Ok(())
    }

    /// The layer's pixels that are not its own, or that a surface above hides.
    fn hidden_pixels(&self, layer: &Layer, stride: u32) -> Hidden {
        let [left, top] = layer.first;
        let mut hidden = Hidden::new(&layer.grid);
        hidden.add_where(|column, row| {
            let pixel = ((row + top) * stride + column + left) as usize;
            self.topmost[pixel] > layer.rank
                || self.cover[(row * layer.grid.width() + column) as usize] == 0.0
        });
        hidden
    }

    /// What the casters let pass to each pixel of the layer.
    fn transmit(&mut self, casts: &[Cast], layer: &Layer, hidden: &Hidden, passed: &mut Vec<f32>) {
        passed.clear();
        passed.resize(
            layer.grid.width() as usize * layer.grid.height() as usize,
            1.0,
        );
        let options = PixelOptions {
            hidden: Some(hidden),
            ..PixelOptions::default()
        };
        let mut sink = Each {
            pixels: passed,
            stride: layer.grid.width() as usize,
            put: |passed: &mut f32, held: f32| *passed *= 1.0 - held,
        };
        for group in groups(casts) {
            fusion::draw(&group, &layer.grid, &options, &mut self.scratch, &mut sink);
        }
    }
}

fn layer(scene: &Scene, surface: &Surface, rank: u32, grid: &Grid) -> Option<Layer> {
    let receiver = Receiver::surface(scene, surface).filter(|_| surface.weight() > 0.0)?;
    let scale = grid.pixels_per_unit();
    let first = [receiver.min.x, receiver.min.y].map(|v| (v * scale).floor() as u32);
    let end = [
        (receiver.max.x, grid.width()),
        (receiver.max.y, grid.height()),
    ]
    .map(|(v, count)| ((v * scale).ceil() as u32).min(count));
    Some(Layer {
        receiver,
        rank,
        fill: surface.fill(),
        weight: surface.weight(),
        grid: grid.window(first, end),
        first,
    })
}
