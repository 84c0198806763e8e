//! The crate's own methods, over its public interface.

use super::{Claim, Family, Parameter, Technique};
use crate::density::PixelOptions;
use crate::error::Result;
use crate::grid::Grid;
use crate::plan::Method;
use crate::scratch::Scratch;
use crate::shadow::Shadow;
use crate::tolerance::Tolerance;

/// A method that ships, or the plan's choice of one, at a tolerance.
#[derive(Debug, Clone, Copy)]
pub struct Shipping {
    method: Option<Method>,
    tolerance: Tolerance,
}

impl Shipping {
    /// That method, or what the plan chooses.
    #[must_use]
    pub fn new(method: Option<Method>, tolerance: Tolerance) -> Self {
        Self { method, tolerance }
    }
}

impl Technique for Shipping {
    fn name(&self) -> &'static str {
        match self.method {
            None => "auto",
            Some(Method::Exact) => "exact",
            Some(Method::Direct) => "direct",
            Some(Method::Grid) => "grid",
            Some(Method::NinePatch) => "nine-patch",
            Some(Method::Mesh) => "mesh",
        }
    }

    fn family(&self) -> Family {
        Family::Ours
    }

    fn parameters(&self) -> Vec<Parameter> {
        if self.method == Some(Method::Exact) {
            return Vec::new();
        }
        let levels = self.tolerance.as_levels();
        vec![Parameter::number(
            "tolerance",
            levels,
            "levels",
            [1.0 / 16.0, 64.0],
        )]
    }

    fn refusal(&self, shadow: &Shadow, grid: &Grid) -> Option<&'static str> {
        let radius = shadow.radius() * grid.pixels_per_unit();
        match self.method {
            Some(Method::NinePatch) if shadow.rounded().is_none() => {
                Some("it is no rounded rectangle: its closed form is drawn edge by edge")
            }
            Some(Method::Mesh) if radius < 3.0 => {
                Some("triangles have the densities of points, pixels here are averages")
            }
            _ => None,
        }
    }

    fn claim(&self) -> Claim {
        match self.method {
            Some(Method::Exact) => Claim {
                levels: Some(0.12),
                why: "rounding, flattening of curves, and quadrature over pixels under 3 px of radius",
            },
            Some(Method::Mesh) => Claim {
                levels: None,
                why: "the tolerance, between its triangles and the densities of points",
            },
            _ => Claim {
                levels: Some(self.tolerance.as_levels()),
                why: "the tolerance",
            },
        }
    }

    fn draw(
        &self,
        shadow: &Shadow,
        grid: &Grid,
        densities: &mut [f32],
        scratch: &mut Scratch,
    ) -> Result<()> {
        let options = PixelOptions::new(self.tolerance).with_method(self.method);
        shadow.fill_f32(grid, densities, &options, scratch)
    }
}
