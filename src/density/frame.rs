//! Where a shadow lies among the pixels of a grid.

use core::ops::Range;

use glam::DVec2;

use crate::grid::Grid;

/// Coordinates in pixels from a whole pixel beside the shadow, so that a shadow moved by whole pixels goes through the
/// same arithmetic whatever part of it a grid shows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    /// Pixels a scene unit.
    pub(crate) scale: f64,
    /// The frame's origin, in pixels from the scene's.
    pub(crate) base: DVec2,
    /// The end of what the shadow reaches.
    pub(crate) extent: DVec2,
    /// Where in a pixel of the frame a pixel of the grid begins.
    pub(crate) phase: DVec2,
    /// The grid's first pixel and its size, in the frame's pixels.
    pub(crate) first: [i64; 2],
    pub(crate) size: [i64; 2],
}

impl Frame {
    /// For an outline within a box (scene units) from which pixels are met up to `reach` pixels away.
    pub(crate) fn new((min, max): (DVec2, DVec2), reach: f64, grid: &Grid) -> Self {
        let scale = grid.pixels_per_unit();
        let base = (min * scale - reach).floor() - 1.0;
        let corner = grid.corner() - base;
        let whole = corner.floor();
        Self {
            scale,
            base,
            extent: max * scale + reach - base,
            phase: corner - whole,
            first: [whole.x, whole.y].map(|v| v as i64),
            size: [grid.width(), grid.height()].map(i64::from),
        }
    }

    /// The columns and rows that the shadow may reach and the grid shows. None is so far beyond that a grid that begins with it would
    /// not [meet](Grid::meets) the shadow: a picture is the same in parts.
    pub(crate) fn pixels(&self) -> [Range<i64>; 2] {
        [0, 1].map(|axis| {
            let end = self.extent[axis].ceil() as i64;
            self.first[axis].max(0)..end.min(self.first[axis] + self.size[axis])
        })
    }

    pub(crate) fn place(&self, point: DVec2) -> DVec2 {
        point * self.scale - self.base
    }
}

/// The largest whole number not above `x`. The function for it is a call where a level has no instruction.
#[inline(always)]
pub(crate) fn whole_below(x: f64) -> i64 {
    let whole = x as i64;
    whole - i64::from(whole as f64 > x)
}
