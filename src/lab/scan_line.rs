//! Shadows along scan lines (Appel 1968, Bouknight & Kelley 1970; "Realistic Rendering", slides 63 and 64): the casters' edges,
//! projected from the light on the receiver, are crossed with each scan line, and from one crossing to the next a pixel is in
//! shadow or is not. A disc of light is as many points as asked for.

use super::rays::stratified;
use super::view::View;
use super::{Claim, Family, Parameter, Technique};
use crate::error::{self, Result};
use crate::grid::Grid;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// Hard shadows of so many points of the light, by spans along scan lines.
#[derive(Debug, Clone, Copy)]
pub struct ScanLine {
    samples: u32,
}

impl ScanLine {
    /// From at most so many points of the light.
    ///
    /// # Errors
    /// Samples not from 1 to 65,536.
    pub fn new(samples: u32) -> Result<Self> {
        error::within("samples", f64::from(samples), 1.0, 65_536.0)?;
        Ok(Self { samples })
    }
}

impl Technique for ScanLine {
    fn name(&self) -> &'static str {
        "scan-line"
    }

    fn family(&self) -> Family {
        Family::Samples
    }

    fn parameters(&self) -> Vec<Parameter> {
        let samples = f64::from(self.samples);
        vec![Parameter::number("samples", samples, "", [1.0, 65_536.0])]
    }

    fn claim(&self) -> Claim {
        Claim {
            levels: None,
            why: "each point of the light is a step of the penumbra",
        }
    }

    fn draw(
        &self,
        shadow: &Shadow,
        grid: &Grid,
        densities: &mut [f32],
        _: &mut Scratch,
    ) -> Result<()> {
        grid.check_buffer(densities.len())?;
        let view = View::new(shadow, grid, 0.1);
        let (width, height) = (grid.width() as usize, grid.height() as usize);
        let points = if view.radius == 0.0 { 1 } else { self.samples };
        let lights = stratified(points);
        // By how much the number of points that hide a pixel differs from that of the pixel before.
        let mut changes = vec![0_i32; (width + 1) * height];
        let mut crossings: Vec<Vec<(f64, i32)>> = vec![Vec::new(); height];
        for light in &lights {
            let offset = *light * view.radius;
            for (a, b) in view.lines() {
                let (a, b) = (a - offset, b - offset);
                let (top, bottom, turn) = if a.y < b.y { (a, b, 1) } else { (b, a, -1) };
                let first = (top.y - 0.5).ceil().max(0.0);
                let end = (bottom.y - 0.5).ceil().min(height as f64);
                let slope = (bottom.x - top.x) / (bottom.y - top.y);
                let mut y = first;
                while y < end {
                    let x = top.x + slope * (y + 0.5 - top.y);
                    crossings[y as usize].push((x, turn));
                    y += 1.0;
                }
            }
            for (y, crossings) in crossings.iter_mut().enumerate() {
                crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
                let mut winding = 0;
                for (x, turn) in crossings.drain(..) {
                    let before = winding;
                    winding += turn;
                    let column = (x - 0.5).ceil().clamp(0.0, width as f64) as usize;
                    changes[y * (width + 1) + column] +=
                        i32::from(winding != 0) - i32::from(before != 0);
                }
            }
        }
        for y in 0..height {
            let mut hidden = 0;
            let row = &mut densities[y * grid.stride()..][..width];
            for (density, change) in row.iter_mut().zip(&changes[y * (width + 1)..]) {
                hidden += change;
                *density = hidden as f32 / lights.len() as f32;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{card, errors};
    use super::*;

    #[test]
    fn steps_get_finer_with_more_points() {
        let (shadow, grid) = card(9.0);
        for (samples, allowed) in [(16, 45.0), (64, 20.0), (256, 9.0), (4096, 2.5)] {
            let got = errors(&ScanLine::new(samples).unwrap(), &shadow, &grid);
            println!("{samples}: {got:?}");
            assert!(got.max_levels < allowed, "{samples}: {got:?}");
        }
    }
}
