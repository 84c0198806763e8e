//! A finished surface pixel by pixel.

use core::ops::Range;

use glam::DVec2;

use super::{Canvas, Finish, Intensity, Lighting, RimMesh};
use crate::error::Result;
use crate::grid::Grid;
use crate::light::Light;
use crate::shape::Shape;

/// A finish on one surface, ready to be drawn on any part of the picture.
#[derive(Debug)]
pub(crate) struct Finished<'a> {
    finish: &'a Finish,
    mesh: Option<RimMesh>,
    lighting: Lighting,
    fill: [u8; 3],
}

impl<'a> Finished<'a> {
    pub(crate) fn new(
        finish: &'a Finish,
        shape: &Shape,
        elevation: f32,
        fill: [u8; 3],
        lights: impl Iterator<Item = (Light, f32)>,
    ) -> Result<Self> {
        let rim = finish.rim.as_ref();
        Ok(Self {
            finish,
            mesh: rim.map(|rim| RimMesh::new(shape, rim)).transpose()?,
            lighting: Lighting::new(lights, elevation, &finish.material)?,
            fill,
        })
    }

    /// The colours of a grid's pixels, as far as the surface covers them.
    pub(crate) fn colors(&self, grid: &Grid, cover: &[f32]) -> Vec<[u8; 3]> {
        let rows = (BAND / grid.width()).max(1);
        let mut colors = Vec::with_capacity(cover.len());
        for first in (0..grid.height()).step_by(rows as usize) {
            let end = grid.height().min(first + rows);
            let band = grid.window([0, first], [grid.width(), end]);
            let rim = self.mesh.as_ref().map(|mesh| self.shaded(mesh, &band));
            for row in 0..band.height() {
                for column in 0..band.width() {
                    let cover = cover[colors.len()];
                    let flat = || self.flat(&band, column, row);
                    let rim = rim.as_ref().and_then(|rim| rim.at(column, row, cover));
                    colors.push(match rim {
                        _ if cover == 0.0 => self.fill,
                        None => flat(),
                        Some((intensity, 1.0)) => intensity.of(self.fill.map(f32::from)),
                        Some((intensity, share)) => {
                            let rim = intensity.of(self.fill.map(f32::from));
                            mixed(rim, flat(), share)
                        }
                    });
                }
            }
        }
        colors
    }

    fn flat(&self, grid: &Grid, column: u32, row: u32) -> [u8; 3] {
        let side = 1.0 / grid.pixels_per_unit();
        let middle = grid.corner() + DVec2::new(f64::from(column), f64::from(row)) + 0.5;
        let middle = (middle * side).to_array();
        self.finish
            .flat_color(self.fill, middle, side, &self.lighting)
    }

    fn shaded(&self, mesh: &RimMesh, grid: &Grid) -> Shaded {
        let mut canvas = Canvas::within(grid, SAMPLES, 1);
        canvas.draw(mesh, &self.lighting, self.finish.shading);
        Shaded {
            canvas,
            stride: (SAMPLES * (grid.width() + 2)) as usize,
        }
    }
}

/// A rim is drawn by bands of about so many pixels.
const BAND: u32 = 1 << 18;

/// Samples along a pixel's side, so that the edges of a rim, and creases, are smooth.
const SAMPLES: u32 = 2;

/// Coverage may miss 1 by the error of its method, half a level and less: what is covered by so much is wholly inside.
const WHOLE: f32 = 0.998;

/// A rim's samples, those of one pixel more on every side among them.
struct Shaded {
    canvas: Canvas,
    stride: usize,
}

impl Shaded {
    /// The intensity of a pixel's rim, and which part of the pixel is rim. At the outline the rest of it is none of the surface's,
    /// and one whose samples all miss the rim has the intensity of those beside it.
    fn at(&self, column: u32, row: u32, cover: f32) -> Option<(Intensity, f32)> {
        let samples = SAMPLES as usize;
        let [column, row] = [column, row].map(|index| samples * (index as usize + 1));
        let (mean, count) = self.mean(column..column + samples, row..row + samples);
        let is_edge = cover < WHOLE;
        if count == 0 && is_edge {
            let beside = |index: usize| index - samples..index + 2 * samples;
            let (mean, count) = self.mean(beside(column), beside(row));
            return (count > 0).then_some((mean, 1.0));
        }
        let share = if is_edge {
            1.0
        } else {
            count as f32 / (samples * samples) as f32
        };
        (count > 0).then_some((mean, share))
    }

    /// The mean of the samples that are of the rim, and their number.
    fn mean(&self, columns: Range<usize>, rows: Range<usize>) -> (Intensity, usize) {
        let (mut sum, mut count) = (Intensity::default(), 0);
        for row in rows {
            let start = row * self.stride;
            let samples = &self.canvas.pixels()[start + columns.start..start + columns.end];
            for sample in samples.iter().flatten() {
                sum.body += sample.body;
                sum.gloss += sample.gloss;
                count += 1;
            }
        }
        let each = 1.0 / count.max(1) as f32;
        let mean = Intensity {
            body: sum.body * each,
            gloss: sum.gloss * each,
        };
        (mean, count)
    }
}

fn mixed(a: [u8; 3], b: [u8; 3], share: f32) -> [u8; 3] {
    [0, 1, 2].map(|channel| {
        let [a, b] = [a, b].map(|color| f32::from(color[channel]));
        (b + (a - b) * share + 0.5) as u8
    })
}
