//! The density of all casters together on the ground.

use super::{Receiver, key_casts};
use crate::density::{DensitySink, exact};
use crate::error::{self, Error, Result};
use crate::grid::Grid;
use crate::plan::Method;
use crate::scene::Scene;
use crate::scratch::Scratch;
use crate::tolerance::Tolerance;

/// Densities on a picture's pixels, row by row, 0 to 1.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DensityMap {
    width: u32,
    height: u32,
    densities: Vec<f32>,
}

impl DensityMap {
    /// Columns.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The densities, row by row.
    #[must_use]
    pub fn densities(&self) -> &[f32] {
        &self.densities
    }

    /// The densities as 16-bit grey, row by row: 65535 is density 1.
    #[must_use]
    pub fn to_grey16(&self) -> Vec<u16> {
        let grey = |density: &f32| (f64::from(*density) * 65535.0 + 0.5) as u16;
        self.densities.iter().map(grey).collect()
    }

    /// Blends black of the strength `key` (0 to 1) times the density onto premultiplied RGBA8 pixels, row by row.
    ///
    /// # Errors
    /// [`Error::BufferSize`] when `pixels` are not as many as the densities, 4 bytes each; a key that is not from 0 to 1.
    pub fn blend_rgba8(&self, key: f32, pixels: &mut [u8]) -> Result<()> {
        error::within("key", f64::from(key), 0.0, 1.0)?;
        let needed = self.densities.len() * 4;
        if pixels.len() != needed {
            return Err(Error::BufferSize {
                length: pixels.len(),
                needed,
            });
        }
        for (pixel, density) in pixels.chunks_exact_mut(4).zip(&self.densities) {
            if *density > 0.0 {
                let keep = 1.0 - key * density;
                for channel in &mut pixel[..3] {
                    *channel = (f32::from(*channel) * keep + 0.5) as u8;
                }
                pixel[3] = (255.0 - (255.0 - f32::from(pixel[3])) * keep + 0.5) as u8;
            }
        }
        Ok(())
    }
}

impl Scene {
    /// Draws the density of all casters on the ground, into `map`, whose memory is used again. Under the casters too,
    /// unless `visible_only` leaves out, as 0, the pixels wholly covered by opaque ones. By one method for all; none
    /// leaves the choice to the plan.
    ///
    /// # Errors
    /// None that the scene's constructors let pass.
    pub fn ground_density(
        &self,
        method: Option<Method>,
        tolerance: Tolerance,
        visible_only: bool,
        map: &mut DensityMap,
        scratch: &mut Scratch,
    ) -> Result<()> {
        let grid = self.grid()?;
        (map.width, map.height) = (grid.width(), grid.height());
        map.densities.clear();
        // While the casters are gone through, what they let pass.
        map.densities
            .resize(grid.width() as usize * grid.height() as usize, 1.0);
        if visible_only {
            self.mark_hidden(&grid, &mut map.densities, scratch);
        }
        for cast in key_casts(self, &Receiver::ground(self))? {
            let mut sink = Transmission {
                width: grid.width(),
                passed: &mut map.densities,
                weight: cast.weight as f32,
            };
            let choice = crate::plan::choose(&cast.shadow, tolerance, crate::plan::Target::Pixels);
            match method.unwrap_or(choice.method) {
                Method::Exact => exact::fill(&cast.shadow, &grid, scratch, &mut sink),
                Method::Mesh => cast.shadow.mesh(tolerance).scan_convert(&grid, &mut sink),
            }
        }
        for passed in &mut map.densities {
            *passed = if *passed == HIDDEN {
                0.0
            } else {
                1.0 - *passed
            };
        }
        Ok(())
    }

    fn mark_hidden(&self, grid: &Grid, passed: &mut [f32], scratch: &mut Scratch) {
        for surface in self.surfaces().iter().filter(|surface| surface.is_opaque()) {
            let mut sink = Hidden {
                width: grid.width(),
                passed: &mut *passed,
            };
            exact::fill(&surface.cover(), grid, scratch, &mut sink);
        }
    }
}

/// Marks a pixel that nobody sees.
const HIDDEN: f32 = -1.0;

struct Hidden<'a> {
    width: u32,
    passed: &'a mut [f32],
}

impl DensitySink for Hidden<'_> {
    fn put(&mut self, x: u32, y: u32, density: f32) {
        if density >= 1.0 {
            self.passed[(y * self.width + x) as usize] = HIDDEN;
        }
    }
}

struct Transmission<'a> {
    width: u32,
    passed: &'a mut [f32],
    weight: f32,
}

impl DensitySink for Transmission<'_> {
    fn wants(&self, x: u32, y: u32) -> bool {
        self.passed[(y * self.width + x) as usize] > 0.0
    }

    fn put(&mut self, x: u32, y: u32, density: f32) {
        self.passed[(y * self.width + x) as usize] *= 1.0 - self.weight * density;
    }
}
