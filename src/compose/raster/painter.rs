//! The layers of a scene, one over the other, on some pixels of its picture.
//!
//! A surface and the shadows on it make one layer, which is then laid over what is below by the surface's coverage: at
//! its antialiased edge neither light nor dark shines through between the two.

use core::ops::Range;

use glam::DVec2;
use tiny_skia::{ColorU8, Pixmap};

use super::Job;
use super::texture::Texture;
use crate::compose::fusion::{self, groups};
use crate::compose::{Receiver, Stage};
use crate::density::{self, Each, PixelOptions, Sink};
use crate::error::Result;
use crate::grid::Grid;
use crate::hidden::Hidden;
use crate::scene::{Form, Surface};
use crate::scratch::Scratch;
use crate::tone::Color;

/// Paints layers. It keeps nothing of a scene but the memory that it painted it with.
#[derive(Debug, Default)]
pub(super) struct Painter {
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
pub(super) struct Window {
    columns: Range<u32>,
    rows: Range<u32>,
    grid: Grid,
}

impl Window {
    pub(super) fn new(grid: &Grid, columns: Range<u32>, rows: Range<u32>) -> Self {
        Self {
            grid: grid.window([columns.start, rows.start], [columns.end, rows.end]),
            columns,
            rows,
        }
    }
}

impl Painter {
    /// Draws a scene's layers on the pixels of a window, from the ground up, and tells how many of how many are drawn.
    pub(super) fn draw(
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
                draw_cover(surface, grid, &mut self.scratch, &mut sink);
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
        draw_cover(surface, &layer.grid, &mut self.scratch, &mut sink);
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
        let options = PixelOptions::default().with_hidden(&hidden);
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

/// Gives a sink what a surface covers of each pixel.
fn draw_cover(surface: &Surface, grid: &Grid, scratch: &mut Scratch, sink: &mut dyn Sink) {
    let options = PixelOptions::default();
    density::draw(&surface.cover(), grid, &options, scratch, sink);
}
