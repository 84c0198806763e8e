//! A ramp on the signed distance to the outline: what shaders draw.

use super::view::{View, holds};
use super::{Claim, Family, Parameter, Technique};
use crate::error::Result;
use crate::grid::Grid;
use crate::outline::nearest_share;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// `smoothstep` of the distance from the outline, from r outside to r inside: 3 u² - 2 u³.
#[derive(Debug, Clone, Copy, Default)]
pub struct Smoothstep;

impl Smoothstep {
    /// It has no parameters.
    #[must_use]
    pub fn new() -> Self {
        Self
    }
}

impl Technique for Smoothstep {
    fn name(&self) -> &'static str {
        "smoothstep"
    }

    fn family(&self) -> Family {
        Family::Blurs
    }

    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }

    fn claim(&self) -> Claim {
        Claim {
            levels: None,
            why: "10 levels off a straight edge; a distance knows of one edge only, so corners and casters without umbra are far off",
        }
    }

    fn draw(
        &self,
        shadow: &Shadow,
        grid: &Grid,
        densities: &mut [f32],
        _: &mut Scratch,
    ) -> Result<()> {
        let view = View::new(shadow, grid, 0.1);
        // A ramp of less than a pixel would be a staircase.
        let half = view.radius.max(0.5);
        view.draw(grid, half, densities, |center, _, lines| {
            let mut nearest = half * half;
            for &(a, b) in lines {
                let foot = a + (b - a) * nearest_share(a, b, center);
                nearest = nearest.min((center - foot).length_squared());
            }
            let inside = if holds(lines, center) { 1.0 } else { -1.0 };
            let u = f64::midpoint(inside * nearest.sqrt() / half, 1.0);
            u * u * (3.0 - 2.0 * u)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{errors, on_grid};
    use super::*;
    use crate::shape::Shape;

    #[test]
    fn ten_levels_off_an_edge_and_seventy_off_a_corner() {
        let shape = Shape::rect(-200.0, -300.0, 240.0, 600.0).unwrap();
        let (shadow, grid) = on_grid(&shape, 12.0, [80, 40]);
        let edge = errors(&Smoothstep, &shadow, &grid);
        assert!((9.0..11.0).contains(&edge.max_levels), "{edge:?}");
        let shape = Shape::rect(-200.0, -300.0, 240.0, 320.0).unwrap();
        let (shadow, grid) = on_grid(&shape, 12.0, [80, 40]);
        let corner = errors(&Smoothstep, &shadow, &grid);
        assert!((55.0..75.0).contains(&corner.max_levels), "{corner:?}");
    }
}
