//! The cheapest method within a tolerance, and why it was chosen.

mod mesh;

use core::fmt;
use core::ops::Range;
use core::str::FromStr;

use crate::density::frame::Frame;
use crate::density::{
    EXACT_SHARE, PixelOptions, averaged_side, direct, exact, grid, nine_patch, reach,
};
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
    /// The closed form on a lattice coarser than the pixels, interpolated.
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
    /// A grid of pixels.
    Pixels {
        /// Pixels a scene unit.
        per_unit: f64,
    },
    /// Triangles.
    Triangles,
}

/// A method and the reason for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choice {
    /// The method.
    pub method: Method,
    /// Why, in a sentence.
    pub why: &'static str,
}

/// A method that could draw a shadow, as far as can be told without drawing it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// The method.
    pub method: Method,
    /// How wrong a pixel would be at most, in levels.
    pub error_levels: f64,
    /// What all of the shadow would take, in nanoseconds on the core that [`COSTS`] were measured on: only their ratios mean
    /// something elsewhere.
    pub cost_ns: f64,
    /// What speaks for it, in a sentence.
    pub why: &'static str,
}

/// The method for a shadow within a tolerance: of the candidates that keep it, the cheapest.
#[must_use]
pub fn choose(shadow: &Shadow, tolerance: Tolerance, target: Target) -> Choice {
    let levels = tolerance.as_levels();
    let all = candidates(shadow, tolerance, target).into_iter().flatten();
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
#[must_use]
pub fn candidates(shadow: &Shadow, tolerance: Tolerance, target: Target) -> [Option<Candidate>; 4] {
    match target {
        Target::Triangles => [
            Some(mesh::candidate(shadow, tolerance.as_levels())),
            None,
            None,
            None,
        ],
        Target::Pixels { per_unit } => {
            let work = Work::of(shadow, per_unit);
            let levels = tolerance.as_levels();
            [
                Some(work.exact()),
                Some(work.direct(levels)),
                work.grid(levels),
                nine_patch::suited(shadow, per_unit)
                    .map(|rounded| work.nine_patch(levels, rounded.circle().is_some())),
            ]
        }
    }
}

/// Costs in nanoseconds, fitted to what `penumbral chart` measures (`plan.csv`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Costs {
    /// A pixel of the bounds, by closed form.
    pub pixel: f64,
    /// A pixel whose disc may meet a line, for each line.
    pub line: f64,
    /// The same for an arc.
    pub arc: f64,
    /// A pixel that is an average, over one that is not.
    pub average: f64,
    /// A pixel of the bounds, by sums along strips.
    pub sum: f64,
    /// A row of such pixels, over the penumbra radius: rows are so many a radius.
    pub sum_row: f64,
    /// A pixel of a rounded rectangle or a circle: as much as by closed form with no edge in reach, as none of 100 cards under penumbrae of 3
    /// to 11 px took longer.
    pub rounded: f64,
    /// A pixel within reach of an edge in double precision, for each edge.
    pub exact: f64,
    /// The same where it is an average, over where it is not.
    pub exact_average: f64,
    /// A rounded rectangle's triangles at one level, when its corners are new.
    pub strips: f64,
    /// A sample of a mesh of halved squares.
    pub sample: f64,
    /// A triangle of any other mesh at one level.
    pub triangle: f64,
    /// A triangle of a shadow without penumbra.
    pub hard_triangle: f64,
}

/// One core with AVX-512.
pub const COSTS: Costs = Costs {
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
    sample: 26.0,
    triangle: 4e4,
    hard_triangle: 400.0,
};

/// Arcs in place of a curve, over the third root of its length in penumbra radii.
const ARCS: f64 = 2.5;

/// What there is to draw, in pixels.
struct Work {
    radius: f64,
    /// Of the bounds.
    pixels: f64,
    /// The larger side of the outline's box.
    extent: f64,
    /// Pixels whose discs may meet lines, added up over the lines, and the same for arcs.
    lines: f64,
    arcs: f64,
}

impl Work {
    fn of(shadow: &Shadow, per_unit: f64) -> Self {
        let mut census = shadow.census();
        // How far an arc is from its curve grows with the third power of its length.
        let radius = shadow.radius().max(census.curve_length * 1e-4);
        let arcs = ARCS * libm::cbrt(census.curve_length / census.curves.max(1.0) / radius);
        census.arcs += census.curves * arcs.max(1.0);
        census.arc_length += census.curve_length;
        let radius = shadow.radius() * per_unit;
        // A pixel sees a little beyond its disc.
        let reach = reach(radius);
        let met = |count: f64, length: f64| {
            2.0 * reach * length * per_unit + count * core::f64::consts::PI * reach * reach
        };
        let size = census.size * per_unit + 2.0 * reach;
        Self {
            radius,
            pixels: size.x * size.y,
            extent: shadow.extent() * per_unit,
            lines: met(census.lines, census.line_length),
            arcs: met(census.arcs, census.arc_length),
        }
    }

    /// Whether its pixels are averages over a square.
    fn is_averaged(&self) -> bool {
        self.radius > 0.0 && averaged_side(self.radius) > 0.0
    }

    fn exact(&self) -> Candidate {
        Candidate {
            method: Method::Exact,
            error_levels: if self.is_averaged() {
                exact::AVERAGED
            } else {
                EXACT_SHARE
            },
            cost_ns: COSTS.exact * (self.lines + self.arcs) * self.averages(COSTS.exact_average)
                + self.pixels,
            why: "the finest averages over pixels",
        }
    }

    fn direct(&self, levels: f64) -> Candidate {
        let why = if self.radius == 0.0 {
            "a hard edge is coverage in closed form"
        } else if self.radius < 0.25 {
            "the penumbra is narrower than a quarter of a pixel: coverage, at few points of the disc"
        } else if self.is_averaged() {
            "the penumbra is about as narrow as a pixel"
        } else {
            "few edges within reach: their closed form costs least"
        };
        Candidate {
            method: Method::Direct,
            error_levels: if self.is_averaged() {
                direct::AVERAGED
            } else {
                direct::curves(self.radius, levels) * levels + direct::ROUNDING
            },
            cost_ns: COSTS.pixel * self.pixels
                + (COSTS.line * self.lines + COSTS.arc * self.arcs) * self.averages(COSTS.average),
            why,
        }
    }

    /// Sums along strips, where these can be told apart.
    fn grid(&self, levels: f64) -> Option<Candidate> {
        (levels >= FINEST && grid::suits(self.radius, levels, self.extent)).then(|| Candidate {
            method: Method::Grid,
            error_levels: levels,
            cost_ns: (COSTS.sum + COSTS.sum_row / self.radius) * self.pixels,
            why: "many edges within reach: sums along strips cost less than each one",
        })
    }

    fn nine_patch(&self, levels: f64, is_circle: bool) -> Candidate {
        Candidate {
            method: Method::NinePatch,
            error_levels: levels.max(FINEST),
            cost_ns: COSTS.rounded * self.pixels,
            why: if is_circle {
                "a circle: the closed form in its distance"
            } else {
                "a rounded rectangle: its chords are closed form in its sides"
            },
        }
    }

    /// How much more a pixel costs for being an average, if it is one.
    fn averages(&self, more: f64) -> f64 {
        if self.is_averaged() { more } else { 1.0 }
    }
}

/// Tolerances below this, in levels, are kept by the closed form alone.
const FINEST: f64 = 0.5;

/// Why nothing of a shadow is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Skip {
    /// It covers nothing.
    Empty,
    /// It lies beside the grid.
    OffGrid,
    /// No pixel that it reaches is seen.
    Hidden,
    /// The paint is so weak, or the caster so small for its penumbra, that no byte changes.
    Faint,
}

/// Whether anything of a shadow is to be drawn on a grid, with paint of an `opacity` from 0 to 1 on 8-bit pixels; none where
/// weak paint counts as well, as it does where bytes are dithered.
///
/// Nothing is built for it: a box that holds the shadow decides.
#[must_use]
pub fn skip(
    shadow: &Shadow,
    grid: &Grid,
    options: &PixelOptions<'_>,
    opacity: Option<f32>,
) -> Option<Skip> {
    let Some(hull) = shadow.hull() else {
        return Some(Skip::Empty);
    };
    let radius = shadow.radius() * grid.pixels_per_unit();
    let frame = Frame::new(hull, reach(radius), grid);
    let [columns, rows] = frame.pixels();
    if columns.is_empty() || rows.is_empty() {
        return Some(Skip::OffGrid);
    }
    if let Some(opacity) = opacity.filter(|_| !options.dither) {
        let size = hull.1 - hull.0;
        let disc = core::f64::consts::PI * shadow.radius() * shadow.radius();
        let most = f64::from(opacity) * (size.x * size.y / disc).min(1.0);
        if most * 255.0 < FAINTEST {
            return Some(Skip::Faint);
        }
    }
    let hidden = options.hidden?;
    let on_grid = |from: &Range<i64>, axis: usize| {
        let first = frame.first[axis];
        (from.start - first) as u32..(from.end - first) as u32
    };
    let (columns, rows) = (on_grid(&columns, 0), on_grid(&rows, 1));
    let is_seen = |row: u32| {
        let mut any = false;
        hidden.seen(row, columns.clone(), |_| any = true);
        any
    };
    (!rows.into_iter().any(is_seen)).then_some(Skip::Hidden)
}

/// What changes no byte, in its steps: a half would round to one, and blending rounds a little of its own.
const FAINTEST: f64 = 0.45;

impl fmt::Display for Skip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Empty => "it covers nothing",
            Self::OffGrid => "it lies beside the picture",
            Self::Hidden => "no pixel that it reaches is seen",
            Self::Faint => "it is so faint that no byte changes",
        })
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Exact => "exact",
            Self::Direct => "direct",
            Self::Grid => "grid",
            Self::NinePatch => "nine-patch",
            Self::Mesh => "mesh",
        })
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
    use crate::hidden::Hidden;
    use crate::light::Light;
    use crate::paint::Paint;
    use crate::path::FillRule;
    use crate::scratch::Scratch;
    use crate::shape::Shape;
    use crate::tone::Color;

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
        let pixels = Target::Pixels { per_unit: 1.0 };
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
            let all = candidates(&shadow, tolerance, pixels);
            let of = |method| all.into_iter().flatten().find(|c| c.method == method);
            let chosen = of(choice.method).unwrap();
            assert!(chosen.error_levels <= f64::from(levels));
            assert!(all.into_iter().flatten().all(|other| {
                other.error_levels > f64::from(levels) || other.cost_ns >= chosen.cost_ns
            }));
        }
        let shadow = cast(&card, 8.0);
        let choice = choose(&shadow, Tolerance::ONE_LEVEL, Target::Triangles);
        assert_eq!(choice.method, Method::Mesh);
        let cost = |shape: &Shape, radius: f32, levels: f32| {
            let tolerance = Tolerance::levels(levels).unwrap();
            let [mesh, ..] = candidates(&cast(shape, radius), tolerance, Target::Triangles);
            mesh.unwrap().cost_ns
        };
        assert!(cost(&star(5), 8.0, 4.0) < cost(&star(5), 8.0, 1.0));
        assert!(cost(&card, 8.0, 1.0) < cost(&star(5), 8.0, 1.0));
        assert!(cost(&star(5), 8.0, 1.0) < cost(&star(20), 8.0, 1.0));
        assert!((1.0..1e6).contains(&cost(&card, 0.0, 1.0)));
    }

    #[test]
    fn what_is_skipped_changes_no_byte() {
        let card = Shape::rounded_rect(10.0, 10.0, 20.0, 20.0, 4.0).unwrap();
        let grid = Grid::new([0.0, 0.0], [80, 60], 1.0).unwrap();
        let plain = PixelOptions::default();
        let mut scratch = Scratch::new();
        assert_eq!(
            skip(&cast(&card, 8.0), &grid, &plain, Some(0.002)),
            None,
            "half a byte may round to one"
        );
        for (radius, strength) in [(8.0, 0.0017), (90.0, 0.1), (0.0, 0.001)] {
            let shadow = cast(&card, radius);
            assert_eq!(
                skip(&shadow, &grid, &plain, Some(strength)),
                Some(Skip::Faint)
            );
            // Drawn without the plan, it would have left every byte as it was.
            for color in [Color::BLACK, Color::WHITE] {
                let paint = Paint::new(color, strength).unwrap();
                let before: Vec<u8> = (0..80 * 60 * 4_u32).map(|i| (i / 4 % 256) as u8).collect();
                let mut after = before.clone();
                let mut sink = plain
                    .onto_rgba8(&grid, &mut after, &paint, &scratch)
                    .unwrap();
                crate::density::draw(&shadow, &grid, &plain, &mut scratch, &mut sink);
                let opaque = |bytes: &[u8]| bytes.iter().step_by(4).copied().collect::<Vec<_>>();
                assert_eq!(opaque(&before), opaque(&after), "r {radius}, {color:?}");
            }
        }
        let shadow = cast(&card, 2.0);
        let beside = Grid::new([100.0, 0.0], [80, 60], 1.0).unwrap();
        assert_eq!(skip(&shadow, &beside, &plain, None), Some(Skip::OffGrid));
        let mut hidden = Hidden::new(&grid);
        hidden.add(&Shape::rect(5.0, 5.0, 30.0, 30.0).unwrap(), &mut scratch);
        let covered = PixelOptions {
            hidden: Some(&hidden),
            ..plain
        };
        assert_eq!(skip(&shadow, &grid, &covered, None), Some(Skip::Hidden));
        assert_eq!(skip(&cast(&card, 9.0), &grid, &covered, None), None);
    }
}
