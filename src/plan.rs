//! The cheapest method within a tolerance, and why it was chosen.

mod mesh;
mod pixels;
mod skip;

use core::fmt;
use core::str::FromStr;

pub use self::skip::{Skip, skip};
use crate::grid::Grid;
use crate::shadow::Shadow;
use crate::tolerance::Tolerance;

/// The ways to draw a shadow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Method {
    /// The closed form, pixel by pixel, in double precision.
    Exact,
    /// The closed form, row by row, in single precision.
    Direct,
    /// Sums of lengths along strips, in rows some pixels apart, with cubics between.
    Grid,
    /// A rounded rectangle or a circle, by the closed form in its sides.
    NinePatch,
    /// Triangles, interpolated; on pixels one sample at each centre.
    Mesh,
}

/// What a shadow is drawn for.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Target {
    /// The pixels of a grid: their size counts, not where they are.
    Pixels(Grid),
    /// Triangles.
    Triangles,
}

/// A method and the reason for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Choice {
    /// The method.
    pub method: Method,
    /// Why, in a sentence.
    pub why: &'static str,
}

/// A method that could draw a shadow, as far as can be told without drawing it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Candidate {
    /// The method.
    pub method: Method,
    /// How wrong a pixel would be at most, in levels.
    pub error_levels: f64,
    /// What all of the shadow would take, in nanoseconds on one core with AVX-512: only their ratios mean something elsewhere.
    pub cost_ns: f64,
    /// What speaks for it, in a sentence.
    pub why: &'static str,
}

/// The method for a shadow within a tolerance: of the candidates that keep it, the cheapest.
#[must_use]
pub fn choose(shadow: &Shadow, tolerance: Tolerance, target: Target) -> Choice {
    let levels = tolerance.as_levels();
    let all = candidates(shadow, tolerance, target);
    let kept = all.filter(|candidate| candidate.error_levels <= levels);
    let cheapest = kept.min_by(|a, b| a.cost_ns.total_cmp(&b.cost_ns));
    cheapest.map_or(
        Choice {
            method: Method::Exact,
            why: "so fine a tolerance takes the finest averages over pixels",
        },
        |candidate| Choice {
            method: candidate.method,
            why: candidate.why,
        },
    )
}

/// What a shadow could be drawn by at a tolerance, in no order: methods that cannot draw it are not among them, methods that
/// cannot keep the tolerance are.
pub fn candidates(
    shadow: &Shadow,
    tolerance: Tolerance,
    target: Target,
) -> impl Iterator<Item = Candidate> + use<> {
    let levels = tolerance.as_levels();
    let all = match target {
        Target::Triangles => [Some(mesh::candidate(shadow, levels)), None, None, None],
        Target::Pixels(grid) => pixels::candidates(shadow, grid.pixels_per_unit(), levels),
    };
    all.into_iter().flatten()
}

/// Costs in nanoseconds, fitted to what `penumbral chart` measures (`plan.csv`).
struct Costs {
    /// A pixel of the bounds, by closed form.
    pixel: f64,
    /// A pixel whose disc may meet a line, for each line.
    line: f64,
    /// The same for an arc.
    arc: f64,
    /// A pixel that is an average, over one that is not.
    average: f64,
    /// A pixel of the bounds, by sums along strips.
    sum: f64,
    /// A row of such pixels, over the penumbra radius: rows are so many a radius.
    sum_row: f64,
    /// A pixel of a rounded rectangle or a circle: as much as by closed form with no edge in reach, as none of 100 cards under penumbrae of 3
    /// to 11 px took longer.
    rounded: f64,
    /// A pixel within reach of an edge in double precision, for each edge.
    exact: f64,
    /// The same where it is an average, over where it is not.
    exact_average: f64,
    /// A rounded rectangle's triangles at one level, when its corners are new.
    strips: f64,
    /// Triangles along a gentle curve at one level.
    gentle: f64,
    /// A sample of a mesh of halved squares.
    sample: f64,
    /// A triangle of any other mesh at one level.
    triangle: f64,
    /// A triangle of a shadow without penumbra.
    hard_triangle: f64,
}

/// One core with AVX-512.
const COSTS: Costs = Costs {
    pixel: 0.3,
    line: 0.7,
    arc: 1.8,
    average: 10.2,
    sum: 0.7,
    sum_row: 42.0,
    rounded: 0.3,
    exact: 130.0,
    exact_average: 25.0,
    strips: 1e7,
    gentle: 3e7,
    sample: 26.0,
    triangle: 4e4,
    hard_triangle: 400.0,
};

impl Method {
    /// Its name, as texts have it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Direct => "direct",
            Self::Grid => "grid",
            Self::NinePatch => "nine-patch",
            Self::Mesh => "mesh",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Why a text names no method.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is no method: exact, direct, grid, nine-patch or mesh")]
pub struct ParseMethodError(String);

impl FromStr for Method {
    type Err = ParseMethodError;

    fn from_str(text: &str) -> Result<Self, ParseMethodError> {
        match text {
            "exact" => Ok(Self::Exact),
            "direct" => Ok(Self::Direct),
            "grid" => Ok(Self::Grid),
            "nine-patch" => Ok(Self::NinePatch),
            "mesh" => Ok(Self::Mesh),
            _ => Err(ParseMethodError(text.to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use crate::path::FillRule;
    use crate::shape::Shape;

    fn cast(shape: &Shape, radius: f32) -> Shadow {
        let light = Light::directional([0.0, 0.0], radius).unwrap();
        light.cast(shape, 1.0, 0.0).unwrap()
    }

    fn star(points: u16) -> Shape {
        let vertex = |i: u16| {
            let angle = f32::from(i) * core::f32::consts::PI / f32::from(points);
            let radius = [70.0, 50.0][usize::from(i % 2)];
            [80.0 + radius * angle.cos(), 80.0 + radius * angle.sin()]
        };
        let ring: Vec<[f32; 2]> = (0..2 * points).map(vertex).collect();
        Shape::polygon(&[ring], FillRule::NonZero).unwrap()
    }

    #[test]
    fn the_cheapest_that_keeps_the_tolerance_is_chosen() {
        let card = Shape::rounded_rect(10.0, 10.0, 100.0, 60.0, 8.0).unwrap();
        let grid = Grid::new([0.0, 0.0], [240, 160], 1.0).unwrap();
        let pixels = Target::Pixels(grid);
        for (shape, radius, levels, expected) in [
            (&card, 8.0, 1.0, Method::NinePatch),
            (&card, 8.0, 0.25, Method::Direct),
            (&card, 0.0, 0.25, Method::Direct),
            (&card, 1.0, 1.0, Method::NinePatch),
            (&card, 1.6, 1.0, Method::Direct),
            (&card, 1.6, 0.5, Method::Exact),
            (&star(5), 8.0, 1.0, Method::Direct),
            (&star(200), 40.0, 1.0, Method::Grid),
        ] {
            let tolerance = Tolerance::levels(levels).unwrap();
            let shadow = cast(shape, radius);
            let choice = choose(&shadow, tolerance, pixels);
            assert_eq!(choice.method, expected, "r {radius}, {levels} levels");
            let mut all = candidates(&shadow, tolerance, pixels);
            let chosen = all.find(|one| one.method == choice.method).unwrap();
            assert!(chosen.error_levels <= f64::from(levels));
            let mut all = candidates(&shadow, tolerance, pixels);
            assert!(all.all(|other| {
                other.error_levels > f64::from(levels) || other.cost_ns >= chosen.cost_ns
            }));
        }
        let shadow = cast(&card, 8.0);
        let choice = choose(&shadow, Tolerance::ONE_LEVEL, Target::Triangles);
        assert_eq!(choice.method, Method::Mesh);
        let cost = |shape: &Shape, radius: f32, levels: f32| {
            let tolerance = Tolerance::levels(levels).unwrap();
            let mut meshes = candidates(&cast(shape, radius), tolerance, Target::Triangles);
            meshes.next().unwrap().cost_ns
        };
        assert!(cost(&star(5), 8.0, 4.0) < cost(&star(5), 8.0, 1.0));
        assert!(cost(&card, 8.0, 1.0) < cost(&star(5), 8.0, 1.0));
        assert!(cost(&star(5), 8.0, 1.0) < cost(&star(20), 8.0, 1.0));
        assert!((1.0..1e6).contains(&cost(&card, 0.0, 1.0)));
        let ellipse = Shape::ellipse([80.0, 60.0], [75.0, 50.0]).unwrap();
        let ellipse = choose(
            &cast(&ellipse, 10.0),
            Tolerance::ONE_LEVEL,
            Target::Triangles,
        );
        assert!(ellipse.why.ends_with("strips along a gentle curve"));
    }
}
