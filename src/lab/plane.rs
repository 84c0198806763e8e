//! Values on a grid's pixels and on some more around it: what blurs work on.

use crate::density::PixelOptions;
use crate::error::Result;
use crate::grid::Grid;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// Rows of values; `margin` of them lie before the grid's first column and row, and behind the last.
#[derive(Debug, Clone)]
pub(super) struct Plane {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) margin: usize,
    pub(super) values: Vec<f32>,
}

impl Plane {
    /// How much of each pixel lies inside the shadow's outline.
    pub(super) fn coverage(
        shadow: &Shadow,
        grid: &Grid,
        margin: u32,
        scratch: &mut Scratch,
    ) -> Result<Self> {
        let grown = grid.grown(margin)?;
        let (width, height) = (grown.width() as usize, grown.height() as usize);
        let mut values = vec![0.0; width * height];
        let hard = shadow.with_radius(0.0);
        hard.fill_f32(&grown, &mut values, &PixelOptions::default(), scratch)?;
        Ok(Self {
            width,
            height,
            margin: margin as usize,
            values,
        })
    }

    pub(super) fn row(&self, y: usize) -> &[f32] {
        &self.values[y * self.width..][..self.width]
    }

    /// Every row through `filter`, which gets it and writes as many values, then every column.
    pub(super) fn filter_rows_and_columns(&mut self, mut filter: impl FnMut(&[f32], &mut [f32])) {
        let mut to = vec![0.0; self.width];
        for y in 0..self.height {
            let row = &mut self.values[y * self.width..][..self.width];
            filter(row, &mut to);
            row.copy_from_slice(&to);
        }
        let (mut from, mut to) = (vec![0.0; self.height], vec![0.0; self.height]);
        for x in 0..self.width {
            for (y, value) in from.iter_mut().enumerate() {
                *value = self.values[y * self.width + x];
            }
            filter(&from, &mut to);
            for (y, value) in to.iter().enumerate() {
                self.values[y * self.width + x] = *value;
            }
        }
    }

    /// Writes the grid's own pixels.
    pub(super) fn write(&self, grid: &Grid, densities: &mut [f32]) -> Result<()> {
        grid.check_buffer(densities.len())?;
        for y in 0..grid.height() as usize {
            let row = &self.row(y + self.margin)[self.margin..][..grid.width() as usize];
            let to = &mut densities[y * grid.stride()..][..grid.width() as usize];
            for (to, value) in to.iter_mut().zip(row) {
                *to = value.clamp(0.0, 1.0);
            }
        }
        Ok(())
    }
}
