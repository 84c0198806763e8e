//! The depth map with geometry (US 10,339,703): each element keeps, beside its depth, the surface element that it saw and how
//! much the depth varies over it, and a pixel in doubt is decided by a ray against that surface.
//!
//! The least depth of the surface over a texel is its depth at the centre less its variation over half a texel. A pixel nearer
//! to the light than that is lit. Any other is in shadow where the ray from it to the light meets the surface element; where
//! it does not, the neighbouring texels' elements are tried, and then the pixel is lit. So neither a bias nor a
//! texel's size decides where an edge is, only which surfaces were seen at all.

use glam::DVec3;

use super::stage::{Stage, Texels, hard_shadows};
use super::{Claim, Family, Parameter, Technique};
use crate::error::{self, Result};
use crate::grid::Grid;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// Hard shadows of so many points of the light, each through a depth map of its own.
#[derive(Debug, Clone, Copy)]
pub struct DepthMap {
    texels: f64,
    samples: u32,
}

impl DepthMap {
    /// Maps of so many texels a pixel each way, from at most so many points of the light.
    ///
    /// # Errors
    /// Texels not from 1/64 to 8, samples not from 1 to 4096.
    pub fn new(texels: f64, samples: u32) -> Result<Self> {
        error::within("samples", f64::from(samples), 1.0, 4096.0)?;
        Ok(Self {
            texels: error::within("texels", texels, 1.0 / 64.0, 8.0)?,
            samples,
        })
    }
}

/// What one texel saw.
#[derive(Debug, Clone, Copy)]
struct Element {
    /// At the texel's centre.
    depth: f64,
    /// How much the depth varies from the centre to the farthest corner of the texel.
    variation: f64,
    /// Whose vertices the ray test takes.
    triangle: u32,
}

/// The depth map of one point of light.
#[derive(Debug)]
pub struct DepthView<'a> {
    texels: Texels,
    elements: Vec<Option<Element>>,
    triangles: &'a [[DVec3; 3]],
}

impl<'a> DepthView<'a> {
    /// What the light's centre sees of a stage through the receiver's square from `origin` on, by `size` (columns, rows) of
    /// texels, `scale` a unit.
    #[must_use]
    pub fn new(stage: &'a Stage, origin: [f64; 2], size: [usize; 2], scale: f64) -> Self {
        Self::seen(Texels::of(stage, origin, size, scale), &stage.triangles)
    }

    fn seen(texels: Texels, triangles: &'a [[DVec3; 3]]) -> Self {
        let mut elements: Vec<Option<Element>> = vec![None; texels.width * texels.height];
        for (index, triangle) in triangles.iter().enumerate() {
            let Some(seen) = texels.triangle(triangle) else {
                continue;
            };
            let variation = seen.gradient.abs().element_sum() / 2.0;
            texels.scan(&seen, |texel, depth| {
                if elements[texel].is_none_or(|element| depth < element.depth) {
                    elements[texel] = Some(Element {
                        depth,
                        variation,
                        triangle: index as u32,
                    });
                }
            });
        }
        Self {
            texels,
            elements,
            triangles,
        }
    }

    /// Whether a point is in the shadow.
    #[must_use]
    pub fn hides(&self, point: [f64; 3]) -> bool {
        self.shadowed(DVec3::from_array(point))
    }

    fn shadowed(&self, point: DVec3) -> bool {
        let (place, depth) = self.texels.see(point);
        let Some(texel) = self.texels.texel(place) else {
            return false;
        };
        let decide = |texel: usize| -> Option<bool> {
            let element = self.elements[texel]?;
            if depth < element.depth - element.variation {
                return Some(false);
            }
            let triangle = &self.triangles[element.triangle as usize];
            meets(point, self.texels.light, triangle).then_some(true)
        };
        if let Some(decided) = decide(texel) {
            return decided;
        }
        let (x, y) = (texel % self.texels.width, texel / self.texels.width);
        let rows = y.saturating_sub(1)..(y + 2).min(self.texels.height);
        let columns = x.saturating_sub(1)..(x + 2).min(self.texels.width);
        rows.into_iter()
            .flat_map(|y| columns.clone().map(move |x| y * self.texels.width + x))
            .any(|texel| decide(texel) == Some(true))
    }
}

/// Whether the way from a point to the light passes a triangle, its own surface left out (Möller & Trumbore 1997).
fn meets(point: DVec3, light: DVec3, triangle: &[DVec3; 3]) -> bool {
    // What lies on a surface meets it at its start, but for rounding.
    const START: f64 = 1e-9;
    const SIDE: f64 = 1e-12;
    let (u, v) = (triangle[1] - triangle[0], triangle[2] - triangle[0]);
    let way = light - point;
    let across = way.cross(v);
    let determinant = u.dot(across);
    if determinant == 0.0 {
        return false;
    }
    let from = point - triangle[0];
    let a = from.dot(across) / determinant;
    let along = from.cross(u);
    let b = way.dot(along) / determinant;
    let share = v.dot(along) / determinant;
    a >= -SIDE && b >= -SIDE && a + b <= 1.0 + SIDE && share > START && share < 1.0
}

impl Technique for DepthMap {
    fn name(&self) -> &'static str {
        "depth-map"
    }

    fn family(&self) -> Family {
        Family::Maps
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![
            Parameter::number("texels", self.texels, "a pixel", [1.0 / 64.0, 8.0]),
            Parameter::number("samples", f64::from(self.samples), "", [1.0, 4096.0]),
        ]
    }

    fn claim(&self) -> Claim {
        Claim {
            levels: None,
            why: "each point of the light is a step; surfaces narrower than a texel may go unseen",
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
            let view = DepthView::seen(texels, &stage.triangles);
            move |point| view.shadowed(point)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{card, errors, on_grid};
    use super::super::{ScanLine, ZBuffer, ZView};
    use super::*;
    use crate::shape::Shape;

    #[test]
    fn coarse_maps_are_better_than_z_buffers_and_lose_what_is_narrower_than_a_texel() {
        let rect = Shape::rect(20.3, 20.6, 60.0, 40.0).unwrap();
        for (name, (shadow, grid), lost) in [
            ("two triangles", on_grid(&rect, 9.0, [100, 80]), 4.0),
            // Those that round the corners are slivers.
            ("many triangles", card(9.0), 40.0),
        ] {
            let samples = errors(&ScanLine::new(64).unwrap(), &shadow, &grid);
            let with = errors(&DepthMap::new(0.25, 64).unwrap(), &shadow, &grid);
            let without = errors(&ZBuffer::new(0.25, 64, 0.0).unwrap(), &shadow, &grid);
            println!("{name}: with geometry {with:?}, without {without:?}, samples {samples:?}");
            assert!(with.max_levels < samples.max_levels + lost, "{with:?}");
            assert!(with.rms_levels < without.rms_levels, "{with:?} {without:?}");
        }
    }

    /// A roof over the receiver, steep to the light, and one flat below it.
    fn roofs() -> Stage {
        let roof = |z: [f64; 2], x: [f64; 2]| {
            let corner = |i: usize, y: f64| [x[i], y, z[i]];
            [
                [corner(0, -20.0), corner(1, -20.0), corner(1, 20.0)],
                [corner(0, -20.0), corner(1, 20.0), corner(0, 20.0)],
            ]
        };
        let triangles = [
            roof([5.0, 45.0], [-20.0, 20.0]),
            roof([2.0, 2.0], [-30.0, 0.0]),
        ]
        .concat();
        Stage::new([-80.0, 0.0, 120.0], 0.0, &triangles).unwrap()
    }

    /// The parts of the points on the steep roof that come out shadowed, and of those just below it that come out lit.
    fn acne_and_leaks(hides: impl Fn([f64; 3]) -> bool) -> [f64; 2] {
        let (mut acne, mut leaks) = (0.0, 0.0);
        for i in 0..40 {
            for j in 0..40 {
                let share = (f64::from(i) + 0.37) / 40.0;
                let y = (f64::from(j) + 0.61) - 20.0;
                let (x, z) = (40.0 * share - 20.0, 5.0 + 40.0 * share);
                acne += f64::from(u8::from(hides([x, y, z])));
                // A unit further along the light's own rays.
                let way = DVec3::new(x + 80.0, y, z - 120.0).normalize();
                let below = DVec3::new(x, y, z) + way;
                leaks += f64::from(u8::from(!hides(below.to_array())));
            }
        }
        [acne / 1600.0, leaks / 1600.0]
    }

    #[test]
    fn neither_acne_nor_leaks_where_a_z_buffer_has_one_or_the_other() {
        let stage = roofs();
        let (origin, size, scale) = ([-60.0, -50.0], [56, 32], 0.32);
        let with = DepthView::new(&stage, origin, size, scale);
        let [acne, leaks] = acne_and_leaks(|point| with.hides(point));
        println!("with geometry: acne {acne:.3}, leaks {leaks:.3}");
        assert_eq!(acne, 0.0);
        // At its silhouette a texel may have seen the roof behind it: nearer than that, a pixel is lit without another look.
        assert!(leaks < 0.04, "{leaks}");
        let plain = |bias: f64| {
            let view = ZView::new(&stage, origin, size, scale, bias);
            acne_and_leaks(|point| view.hides(point))
        };
        for bias in [0.0, 0.01, 0.05, 0.2] {
            let [acne, leaks] = plain(bias);
            println!("bias {bias}: acne {acne:.3}, leaks {leaks:.3}");
            assert!(acne > 0.1 || leaks > 0.1, "{bias}: {acne} {leaks}");
        }
    }
}
