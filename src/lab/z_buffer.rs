//! The shadow z-buffer (Williams 1978; "Realistic Rendering", slides 65 and 66): the depths that the light sees, and whatever is
//! deeper than its texel's is in shadow.
//!
//! A texel's depth is that at its centre: elsewhere on a slanted surface it is too small or too large, so that the surface
//! shadows itself (acne) unless a bias forgives it, and then what is close behind a caster is lit (leaks).

use glam::DVec3;

use super::stage::{Stage, Texels, hard_shadows};
use super::{Claim, Family, Parameter, Technique};
use crate::error::{self, Result};
use crate::grid::Grid;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// Hard shadows of so many points of the light, each through a z-buffer of its own.
#[derive(Debug, Clone, Copy)]
pub struct ZBuffer {
    texels: f64,
    samples: u32,
    bias: f64,
}

impl ZBuffer {
    /// Buffers of so many texels a pixel each way, from at most so many points of the light, and how much deeper than its
    /// texel a pixel may be and still be lit: depth is -1 on the receiver and -2 halfway to the light.
    ///
    /// # Errors
    /// Texels not from 1/64 to 8, samples not from 1 to 4096, a bias not from 0 to 16.
    pub fn new(texels: f64, samples: u32, bias: f64) -> Result<Self> {
        error::within("samples", f64::from(samples), 1.0, 4096.0)?;
        Ok(Self {
            texels: error::within("texels", texels, 1.0 / 64.0, 8.0)?,
            samples,
            bias: error::within("bias", bias, 0.0, 16.0)?,
        })
    }
}

/// The z-buffer of one point of light.
#[derive(Debug)]
pub struct ZView {
    texels: Texels,
    /// Infinite where nothing is seen.
    depths: Vec<f64>,
    bias: f64,
}

impl ZView {
    /// What the light's centre sees of a stage through the receiver's square from `origin` on, by `size` (columns, rows) of
    /// texels, `scale` a unit.
    #[must_use]
    pub fn new(stage: &Stage, origin: [f64; 2], size: [usize; 2], scale: f64, bias: f64) -> Self {
        let texels = Texels::of(stage, origin, size, scale);
        Self::seen(texels, &stage.triangles, bias)
    }

    fn seen(texels: Texels, triangles: &[[DVec3; 3]], bias: f64) -> Self {
        let mut depths = vec![f64::INFINITY; texels.width * texels.height];
        for seen in triangles.iter().filter_map(|t| texels.triangle(t)) {
            texels.scan(&seen, |texel, depth| {
                depths[texel] = depths[texel].min(depth);
            });
        }
        Self {
            texels,
            depths,
            bias,
        }
    }

    /// Whether a point is in the shadow.
    #[must_use]
    pub fn hides(&self, point: [f64; 3]) -> bool {
        self.shadowed(DVec3::from_array(point))
    }

    fn shadowed(&self, point: DVec3) -> bool {
        let (place, depth) = self.texels.see(point);
        self.texels
            .texel(place)
            .is_some_and(|texel| depth > self.depths[texel] + self.bias)
    }
}

impl Technique for ZBuffer {
    fn name(&self) -> &'static str {
        "z-buffer"
    }

    fn family(&self) -> Family {
        Family::Maps
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![
            Parameter::number("texels", self.texels, "a pixel", [1.0 / 64.0, 8.0]),
            Parameter::number("samples", f64::from(self.samples), "", [1.0, 4096.0]),
            Parameter::number("bias", self.bias, "", [0.0, 16.0]),
        ]
    }

    fn claim(&self) -> Claim {
        Claim {
            levels: None,
            why: "each point of the light is a step, and each edge a staircase of texels",
        }
    }

    fn draw(
        &self,
        shadow: &Shadow,
        grid: &Grid,
        densities: &mut [f32],
        _: &mut Scratch,
    ) -> Result<()> {
        let stage = Stage::of_shadow(shadow, grid);
        hard_shadows(&stage, grid, self.samples, densities, |light| {
            let texels = Texels::over(grid, light, self.texels);
            let view = ZView::seen(texels, &stage.triangles, self.bias);
            move |point| view.shadowed(point)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{card, errors};
    use super::*;

    #[test]
    fn more_samples_and_texels_come_nearer() {
        let (shadow, grid) = card(9.0);
        let coarse = errors(&ZBuffer::new(0.25, 16, 0.0).unwrap(), &shadow, &grid);
        let fine = errors(&ZBuffer::new(2.0, 256, 0.0).unwrap(), &shadow, &grid);
        println!("{coarse:?} {fine:?}");
        assert!(coarse.max_levels > 20.0);
        assert!(fine.max_levels < 16.0 && fine.rms_levels < 3.0, "{fine:?}");
        // A bias beyond the caster's own depth lets all light through.
        let biased = errors(&ZBuffer::new(2.0, 16, 1.5).unwrap(), &shadow, &grid);
        assert!(biased.max_levels > 254.0);
    }
}
