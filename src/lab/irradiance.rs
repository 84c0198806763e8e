//! Irradiance: the part of the light's energy that a caster holds back, where uniform visibility counts its area.
//!
//! A Lambertian disc is weighted by the cosines at both ends of a ray and by its length: cos² / d². Its irradiance is an
//! integral over the boundary of what is seen of it (Lambert 1760, Photometria): with x and y from the receiving point in
//! units of R, and k = (H - g) / R,
//!
//! ```text
//! E = 1/2 ∮ (x dy - y dx) / (x² + y² + k²)
//! ```
//!
//! which is closed form along lines and along the disc's own circle. The density is E round the hidden part of the disc over E
//! round the whole of it.

use core::f64::consts::PI;

use glam::DVec2;
use libm::{atan, atan2};

use super::view::View;
use super::{Claim, Family, Parameter, Technique};
use crate::density::{reach, square_average};
use crate::error::{self, Result};
use crate::grid::Grid;
use crate::outline::{sides, turn};
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// The densities of a Lambertian disc's irradiance: `exact` with the physics of an emitting surface.
#[derive(Debug, Clone, Copy)]
pub struct Irradiance {
    /// The light's centre over the receiver, and its height over it, scene units.
    center: DVec2,
    height: f64,
    radius: f64,
}

impl Irradiance {
    /// For the shadows of a light of `radius` about `center` (x, y, z) on the plane at elevation `receiver`, all in scene
    /// units.
    ///
    /// # Errors
    /// A number that is not finite or passes [`MAX_COORDINATE`](crate::MAX_COORDINATE), a light not above the receiver, a
    /// radius not above 0.
    pub fn new(center: [f32; 3], radius: f32, receiver: f32) -> Result<Self> {
        let [x, y, z] = center.map(f64::from);
        let receiver = error::coordinate("receiver", f64::from(receiver))?;
        Ok(Self {
            center: DVec2::new(
                error::coordinate("light.x", x)?,
                error::coordinate("light.y", y)?,
            ),
            height: error::positive("light.z - receiver", z - receiver)?,
            radius: error::positive("light.radius", f64::from(radius))?,
        })
    }

    /// The part of the light's irradiance that the shadow's caster holds back from a point (x, y) of the receiver, 0 to 1.
    ///
    /// Exact to rounding for lines; curves are cut into lines that move no density by more than 0.02 level where the light's
    /// weights are even, and by more the more uneven they are.
    #[must_use]
    pub fn density_at(&self, shadow: &Shadow, point: [f64; 2]) -> f64 {
        let polygons = shadow.polygons_within(0.02, 0.0);
        let lines = polygons.iter().flat_map(|points| sides(points));
        let point = DVec2::from_array(point);
        self.hidden(lines, point, shadow.radius(), point)
    }

    /// How a ray to a point of the light's disc (-1 to 1 each way) counts at a point of the receiver: cos² / d², in units of R.
    #[must_use]
    pub fn weight(&self, point: [f64; 2], on_light: [f64; 2]) -> f64 {
        let across = self.from(DVec2::from_array(point)) + DVec2::from_array(on_light);
        let k = self.height / self.radius;
        let square = across.length_squared() + k * k;
        k * k / (square * square)
    }

    /// The disc's centre from a point of the receiver, in units of R.
    fn from(&self, point: DVec2) -> DVec2 {
        (self.center - point) / self.radius
    }

    /// `lines`, `point` and `radius` in one unit; `at` is the point in scene units.
    fn hidden(
        &self,
        lines: impl Iterator<Item = (DVec2, DVec2)>,
        point: DVec2,
        radius: f64,
        at: DVec2,
    ) -> f64 {
        let k = self.height / self.radius;
        let disc = Disc::new(self.from(at), k);
        if radius <= 0.0 {
            return 0.0;
        }
        let place = |p: DVec2| (p - point) / radius;
        let sum: f64 = lines.map(|(a, b)| disc.along(place(a), place(b))).sum();
        (sum / disc.whole()).clamp(0.0, 1.0)
    }
}

/// The unit disc about `center` from the receiving point, at height `k`.
struct Disc {
    center: DVec2,
    /// |center|² + 1 + k².
    a: f64,
    /// 2 |center|.
    b: f64,
    /// sqrt(a² - b²).
    root: f64,
    k: f64,
}

impl Disc {
    fn new(center: DVec2, k: f64) -> Self {
        let (a, b) = (center.length_squared() + 1.0 + k * k, 2.0 * center.length());
        Self {
            center,
            a,
            b,
            root: ((a - b) * (a + b)).sqrt(),
            k,
        }
    }

    /// Twice the irradiance of the whole disc.
    fn whole(&self) -> f64 {
        PI + (1.0 - self.a / 2.0) * 2.0 * PI / self.root
    }

    /// The integral along the part of a line inside the disc, and along its circle in place of the parts outside: points are
    /// from the disc's centre.
    fn along(&self, from: DVec2, to: DVec2) -> f64 {
        let length = (to - from).length();
        if length == 0.0 {
            return 0.0;
        }
        let direction = (to - from) / length;
        let distance = from.perp_dot(direction);
        if distance.abs() >= 1.0 {
            return self.circle(from, to);
        }
        let half = ((1.0 - distance) * (1.0 + distance)).sqrt();
        let start = from.dot(direction);
        let (first, last) = (start.max(-half), (start + length).min(half));
        if first >= last {
            return self.circle(from, to);
        }
        let foot = from - start * direction;
        let (enter, leave) = (foot + first * direction, foot + last * direction);
        let mut sum = self.line(enter, leave, direction);
        if first > start {
            sum += self.circle(from, enter);
        }
        if last < start + length {
            sum += self.circle(leave, to);
        }
        sum
    }

    /// Along a line: the integral of D dt / (D² + k² + t²), D its distance from the receiving point.
    fn line(&self, from: DVec2, to: DVec2, direction: DVec2) -> f64 {
        let (from, to) = (from + self.center, to + self.center);
        let distance = from.perp_dot(direction);
        let depth = (distance * distance + self.k * self.k).sqrt();
        let angle = |p: DVec2| atan(p.dot(direction) / depth);
        distance / depth * (angle(to) - angle(from))
    }

    /// Along the circle, from the direction of one point to that of another, the shorter way: the integral of
    /// (1 + b/2 cos φ) / (a + b cos φ) dφ = φ/2 + (1 - a/2) ∫ dφ / (a + b cos φ), φ from the centre's own direction.
    fn circle(&self, from: DVec2, to: DVec2) -> f64 {
        let turned = turn(from, to);
        let axis = if self.b > 0.0 {
            self.center / (self.b / 2.0)
        } else {
            DVec2::X
        };
        let first = turn(axis, from);
        let rest = self.antiderivative(first + turned) - self.antiderivative(first);
        turned / 2.0 + (1.0 - self.a / 2.0) * rest
    }

    /// ∫ dφ / (a + b cos φ) from 0 on: 2 / root atan(sqrt((a - b) / (a + b)) tan(φ/2)), whole turns apart.
    fn antiderivative(&self, angle: f64) -> f64 {
        let turns = (angle / (2.0 * PI)).round();
        let half = (angle - turns * 2.0 * PI) / 2.0;
        let slope = ((self.a - self.b) / (self.a + self.b)).sqrt();
        let within = atan2(slope * libm::sin(half), libm::cos(half));
        2.0 / self.root * (within + turns * PI)
    }
}

impl Technique for Irradiance {
    fn name(&self) -> &'static str {
        "irradiance"
    }

    fn family(&self) -> Family {
        Family::Ours
    }

    fn parameters(&self) -> Vec<Parameter> {
        let share = self.radius / self.height;
        vec![Parameter::number("R/H", share, "", [0.0, f64::INFINITY])]
    }

    fn refusal(&self, shadow: &Shadow, _: &Grid) -> Option<&'static str> {
        (shadow.radius() == 0.0).then_some("a point has no irradiance to be held back in part")
    }

    fn claim(&self) -> Claim {
        Claim {
            levels: None,
            why: "another quantity than uniform visibility: up to 6 levels apart at R/H = 0.05, 16 at 0.2, 57 at 1",
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
        let scale = grid.pixels_per_unit();
        view.draw(grid, reach(view.radius), densities, |center, _, lines| {
            let at = |point: DVec2| {
                let scene = (point + grid.corner()) / scale;
                self.hidden(lines.iter().copied(), point, view.radius, scene)
            };
            square_average(view.radius, |offset| at(center + offset))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::MonteCarlo;
    use super::*;
    use crate::light::Light;
    use crate::path::FillRule;
    use crate::shape::Shape;

    #[test]
    fn rays_weighted_by_their_cosines_agree() {
        let star = [
            [0.0, -30.0],
            [8.0, -8.0],
            [30.0, 0.0],
            [8.0, 8.0],
            [0.0, 30.0],
            [-8.0, 8.0],
            [-30.0, 0.0],
            [-8.0, -8.0],
        ];
        let shapes = [
            Shape::rounded_rect(-40.0, -25.0, 80.0, 50.0, 12.0).unwrap(),
            Shape::polygon(&[star], FillRule::NonZero).unwrap(),
        ];
        let rays = MonteCarlo::new(20_000).unwrap();
        let (height, elevation) = (300.0_f32, 30.0_f32);
        let mut apart: f64 = 0.0;
        for share in [0.05_f32, 0.2, 0.5, 1.0, 2.0] {
            let radius = share * height;
            for center in [[0.0, 0.0], [260.0, -150.0]] {
                let light = Light::new([center[0], center[1], height], radius).unwrap();
                let closed = Irradiance::new([center[0], center[1], height], radius, 0.0).unwrap();
                let mut worst: f64 = 0.0;
                for shape in &shapes {
                    let shadow = light.cast(shape, elevation, 0.0).unwrap();
                    let bounds = shadow.bounds().unwrap();
                    for index in 0..36_u8 {
                        let at = |axis: usize, step: u8| {
                            let (min, max) = (bounds.min[axis], bounds.max[axis]);
                            f64::from(min + (max - min) * (f32::from(step) + 0.5) / 6.0)
                        };
                        let point = [at(0, index % 6), at(1, index / 6)];
                        let got = closed.density_at(&shadow, point);
                        let traced = rays
                            .weighted(&shadow, point, |on_light| closed.weight(point, on_light));
                        let error = (got - traced.density).abs() * 255.0;
                        worst = worst.max(error);
                        apart = apart
                            .max((got - shadow.density_at(point.map(|v| v as f32))).abs() * 255.0);
                        assert!(
                            error < traced.bound_levels() + 0.05,
                            "R/H {share}, {point:?}: {got} {traced:?}"
                        );
                    }
                }
                println!("R/H {share}, light at {center:?}: {worst:.3} levels from the rays");
                assert!(worst < 1.0, "R/H {share}: {worst} levels");
            }
        }
        // It is not uniform visibility.
        assert!(apart > 30.0, "{apart}");
    }

    #[test]
    fn a_small_light_is_seen_evenly() {
        let shape = Shape::rect(-20.0, -20.0, 40.0, 40.0).unwrap();
        let light = Light::new([0.0, 0.0, 1000.0], 1.0).unwrap();
        let shadow = light.cast(&shape, 500.0, 0.0).unwrap();
        let closed = Irradiance::new([0.0, 0.0, 1000.0], 1.0, 0.0).unwrap();
        for x in [39.2_f32, 39.7, 40.0, 40.6] {
            let error =
                closed.density_at(&shadow, [f64::from(x), 3.0]) - shadow.density_at([x, 3.0]);
            assert!(error.abs() < 1e-4, "{x}: {error}");
        }
    }
}
