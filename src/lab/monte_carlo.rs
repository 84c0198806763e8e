//! Rays from the receiver to the light's disc: the independent check on every closed form.
//!
//! Distributed rays (Cook, Porter & Carpenter 1984): the disc is cut into cells of equal area, and every cell gets two rays at
//! places of chance. A cell that is wholly hidden or wholly seen adds no error; the two rays of each other one tell its
//! variance, and so the estimate comes with a deviation of its own that no closed form had a part in.

use glam::DVec2;

use super::rays::{number, on_disc};
use super::view::{View, holds};
use super::{Claim, Family, Parameter, Technique};
use crate::density::{averaged_side, reach};
use crate::error::{self, Result};
use crate::grid::Grid;
use crate::outline::sides;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// Two rays to each of the cells of the disc. Where pixels are averages over a square, each ray starts at a place of chance
/// in it.
#[derive(Debug, Clone, Copy)]
pub struct MonteCarlo {
    /// Cells along each side of the square that is mapped on the disc.
    side: u32,
}

/// What rays found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The density, 0 to 1.
    pub density: f64,
    /// Its standard deviation, as the rays' own pairs tell it.
    pub deviation: f64,
    /// How many rays there were.
    pub rays: u32,
}

impl Estimate {
    /// How far the truth may be, in levels, but for one case in some 100,000: four and a half deviations, and four rays for
    /// edges that no pair told.
    #[must_use]
    pub fn bound_levels(&self) -> f64 {
        255.0 * (4.5 * self.deviation + 4.0 / f64::from(self.rays))
    }
}

/// How far the lines in place of curves may move what rays find, in levels.
const CURVES: f64 = 0.002;

impl MonteCarlo {
    /// As near to so many rays as twice a square number is.
    ///
    /// # Errors
    /// Not from 2 to 2^24 rays.
    pub fn new(rays: u32) -> Result<Self> {
        let rays = error::within("rays", f64::from(rays), 2.0, 16_777_216.0)?;
        Ok(Self {
            side: (rays / 2.0).sqrt().round() as u32,
        })
    }

    /// How many rays there are.
    #[must_use]
    pub fn rays(&self) -> u32 {
        2 * self.side * self.side
    }

    /// The density at a point of the receiver.
    #[must_use]
    pub fn at_point(&self, shadow: &Shadow, point: [f64; 2]) -> Estimate {
        self.weighted(shadow, point, |_| 1.0)
    }

    /// The density at a point of the receiver where the light's points have weights: `weight` gets them from -1 to 1 each way.
    /// The deviation is the plain density's, times the largest weight over the mean one.
    #[must_use]
    pub fn weighted(
        &self,
        shadow: &Shadow,
        point: [f64; 2],
        weight: impl Fn([f64; 2]) -> f64,
    ) -> Estimate {
        let polygons = shadow.polygons_within(CURVES, 0.0);
        let point = DVec2::from_array(point);
        let lines: Vec<(DVec2, DVec2)> = polygons.iter().flat_map(|p| sides(p)).collect();
        let near = near(&lines, point, shadow.radius() * (1.0 + 1e-9));
        self.trace(0, point, shadow.radius(), 0.0, &near, weight)
    }

    fn trace(
        &self,
        stream: u64,
        point: DVec2,
        radius: f64,
        square: f64,
        lines: &[(DVec2, DVec2)],
        weight: impl Fn([f64; 2]) -> f64,
    ) -> Estimate {
        let cells = u64::from(self.side) * u64::from(self.side);
        let chance = |index: u64| number(stream.wrapping_mul(8), index);
        let (mut hidden, mut all, mut differing, mut most) = (0.0, 0.0, 0_u64, 0.0_f64);
        for cell in 0..cells {
            let corner = DVec2::new(
                (cell % u64::from(self.side)) as f64,
                (cell / u64::from(self.side)) as f64,
            );
            let mut hits = 0;
            for ray in [2 * cell, 2 * cell + 1] {
                let within = DVec2::new(chance(4 * ray), chance(4 * ray + 1));
                let on_light = on_disc((corner + within) / f64::from(self.side));
                let start = if square > 0.0 {
                    let offset = DVec2::new(chance(4 * ray + 2), chance(4 * ray + 3)) - 0.5;
                    point + offset * square
                } else {
                    point
                };
                let weight = weight(on_light.to_array());
                most = most.max(weight);
                all += weight;
                if holds(lines, start + on_light * radius) {
                    hidden += weight;
                    hits += 1;
                }
            }
            differing += u64::from(hits == 1);
        }
        let rays = 2 * cells;
        Estimate {
            density: hidden / all,
            // The variance of the mean of two rays is half of theirs, which a pair that differs estimates as 1/2.
            deviation: (differing as f64 / 4.0).sqrt() / cells as f64 * (most * rays as f64 / all),
            rays: rays as u32,
        }
    }
}

/// The lines that may decide whether points within `reach` of `center` are inside: a ray to the right crosses no others.
fn near(lines: &[(DVec2, DVec2)], center: DVec2, reach: f64) -> Vec<(DVec2, DVec2)> {
    let decides = |(a, b): &&(DVec2, DVec2)| {
        a.y.max(b.y) >= center.y - reach
            && a.y.min(b.y) <= center.y + reach
            && a.x.max(b.x) >= center.x - reach
    };
    lines.iter().filter(decides).copied().collect()
}

impl Technique for MonteCarlo {
    fn name(&self) -> &'static str {
        "monte-carlo"
    }

    fn family(&self) -> Family {
        Family::Samples
    }

    fn parameters(&self) -> Vec<Parameter> {
        let rays = f64::from(self.rays());
        vec![Parameter::number("rays", rays, "", [2.0, 16_777_216.0])]
    }

    fn claim(&self) -> Claim {
        Claim {
            levels: None,
            why: "a bound of its own at every point, from the pairs of rays that differ",
        }
    }

    fn draw(
        &self,
        shadow: &Shadow,
        grid: &Grid,
        densities: &mut [f32],
        _: &mut Scratch,
    ) -> Result<()> {
        let view = View::new(shadow, grid, 0.02);
        let (radius, side) = (view.radius, averaged_side(view.radius));
        view.draw(grid, reach(radius), densities, |center, place, lines| {
            self.trace(place + 1, center, radius, side, lines, |_| 1.0)
                .density
        })
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::super::tests::{card, drawn};
    use super::super::{Shipping, ground_casts};
    use super::*;
    use crate::plan::Method;
    use crate::scene::Scene;
    use crate::tolerance::Tolerance;

    #[test]
    fn rays_agree_with_exact_on_pixels() {
        for radius in [0.4, 1.5, 2.6, 8.0] {
            let (shadow, grid) = card(radius);
            let exact = Shipping::new(Some(Method::Exact), Tolerance::ONE_LEVEL);
            let exact = drawn(&exact, &shadow, &grid);
            let rays = MonteCarlo::new(512).unwrap();
            let got = drawn(&rays, &shadow, &grid);
            // Of 8000 pixels none is to be beyond the bound of independent rays, sqrt(1/4 / 512) 4.5 times.
            for (got, exact) in got.iter().zip(&exact) {
                assert!((got - exact).abs() < 0.1, "r {radius}: {got} {exact}");
            }
            let mean: f32 =
                got.iter().zip(&exact).map(|(a, b)| a - b).sum::<f32>() / got.len() as f32;
            assert!(mean.abs() * 255.0 < 0.05, "r {radius}: {mean}");
        }
    }

    /// How many deviations of the rays each scene's densities are off, at points of chance in the penumbra.
    fn check_fixtures(rays: u32, points: u32) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/truth");
        let mut paths: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.extension().is_some_and(|e| e == "json"))
            .collect();
        paths.sort();
        assert_eq!(paths.len(), 20);
        let rays = MonteCarlo::new(rays).unwrap();
        for path in paths {
            let scene = read(&path);
            let (mut worst, mut bound, mut tried) = (0.0_f64, 0.0_f64, 0);
            for (shadow, _) in ground_casts(&scene).unwrap() {
                let bounds = shadow.bounds().unwrap();
                let (min, max) = (bounds.min.map(f64::from), bounds.max.map(f64::from));
                for index in 0..u64::MAX {
                    let point = [0, 1].map(|axis: usize| {
                        let share = number(77 + axis as u64, index);
                        // What a caller can ask for is an `f32`.
                        min[axis] + (max[axis] - min[axis]) * share
                    });
                    let point = point.map(|v| f64::from(v as f32));
                    let exact = shadow.density_at(point.map(|v| v as f32));
                    if exact == 0.0 || exact == 1.0 {
                        continue;
                    }
                    let got = rays.at_point(&shadow, point);
                    let error = (got.density - exact).abs() * 255.0;
                    // Curves, in `exact` and here, as both state.
                    let allowed = got.bound_levels() + 0.02 + CURVES;
                    assert!(
                        error <= allowed,
                        "{}, {point:?}: {got:?} {exact}",
                        path.display()
                    );
                    (worst, bound) = (worst.max(error), bound.max(allowed));
                    tried += 1;
                    if tried % points == 0 {
                        break;
                    }
                }
            }
            println!(
                "{:18} {} rays at {tried} points: worst {worst:.4} levels, bound {bound:.4}",
                path.file_stem().unwrap().to_string_lossy(),
                rays.rays(),
            );
        }
    }

    #[cfg(feature = "scene")]
    fn read(path: &Path) -> Scene {
        Scene::from_json(&fs::read_to_string(path).unwrap()).unwrap()
    }

    #[cfg(feature = "scene")]
    #[test]
    fn rays_agree_with_exact_on_every_truth_scene() {
        check_fixtures(8192, 16);
    }

    #[cfg(feature = "scene")]
    #[test]
    #[ignore = "a minute: cargo test --release --features lab,scene --lib million_rays -- --ignored --nocapture"]
    fn a_million_rays_agree_with_exact_on_every_truth_scene() {
        check_fixtures(1_000_000, 24);
    }
}
