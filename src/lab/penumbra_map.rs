//! The penumbra map (US 7,817,823): alpha projected on the receiver, and blurred there by a radius of each pixel's own.
//!
//! For every texel of the receiver the ray from the light's centre is followed through the casters: the map keeps the alpha
//! that it meets, and how far along it does. A disc seen from the texel through the caster's plane, taken as parallel to the
//! receiver where the ray meets it, has the radius u = R d2 / (d1 + d2) there, with d1 from the light to the caster and d2 from
//! the caster to the receiver; on the map that is u (d1 + d2) / d1 = R d2 / d1, the penumbra radius. The density is the average
//! of the map's alpha over a circle or square of that radius, evenly or by a Gaussian.
//!
//! With a circle, even weights and a parallel caster it is the exact convolution, but for its texels. Each light has a map of
//! its own; a light that is no disc is several discs.

use glam::{DVec2, DVec3};
use libm::exp;

use super::card::Card;
use super::plane::Plane;
use super::{Claim, Family, Parameter, Technique};
use crate::error::{self, Result};
use crate::grid::Grid;
use crate::image::Sums;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// How the texels within the radius are weighted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kernel {
    /// Evenly.
    Box,
    /// By a Gaussian whose sigma is half of the radius, the disc's own.
    Gaussian,
}

/// Which texels are within the radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Region {
    /// A circle of the radius.
    Circle,
    /// A square whose side is so many radii: 1 is the document's, sqrt(3) has the disc's variance. Even weights come from a
    /// summed-area table (Crow 1984), at one cost whatever the radius.
    Square(f64),
}

/// A light's disc, parallel to the receiver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiscLight {
    /// Its centre (x, y, z), z above the receiver, scene units.
    pub center: [f64; 3],
    /// Its radius, scene units.
    pub radius: f64,
    /// Its part of all light; parts are taken relative to their sum.
    pub power: f64,
}

impl DiscLight {
    /// A long light as `count` equal discs that touch, from one end to the other, and as wide as it is.
    #[must_use]
    pub fn long(from: [f64; 3], to: [f64; 3], width: f64, count: u32) -> Vec<Self> {
        let (from, to) = (DVec3::from_array(from), DVec3::from_array(to));
        let share = |i: u32| (f64::from(i) + 0.5) / f64::from(count);
        let disc = |i: u32| Self {
            center: from.lerp(to, share(i)).to_array(),
            radius: width / 2.0,
            power: 1.0,
        };
        (0..count).map(disc).collect()
    }

    /// A square light, parallel to the receiver, as `count` by `count` discs with the square's area.
    #[must_use]
    pub fn square(center: [f64; 3], side: f64, count: u32) -> Vec<Self> {
        let cell = side / f64::from(count);
        let at = |i: u32| (f64::from(i) + 0.5) * cell - side / 2.0;
        let disc = |i: u32| Self {
            center: [
                center[0] + at(i % count),
                center[1] + at(i / count),
                center[2],
            ],
            radius: cell / core::f64::consts::PI.sqrt(),
            power: 1.0,
        };
        (0..count * count).map(disc).collect()
    }
}

/// Projected alpha, blurred by a radius a pixel.
#[derive(Debug, Clone, Copy)]
pub struct PenumbraMap {
    kernel: Kernel,
    region: Region,
    texels: f64,
}

/// What the map holds: alpha, how far along the ray from the light it was met, and the light's radius in texels.
struct Map {
    alpha: Plane,
    /// d1 / (d1 + d2) of each texel; 1 where the caster's plane is not between light and receiver.
    depth: Vec<f32>,
    light_radius: f64,
}

/// Radii of more texels are cut to that.
const WIDEST: f64 = 2048.0;

/// A Gaussian is sampled at no more places than this along the radius.
const GAUSSIAN_STEPS: f64 = 16.0;

impl PenumbraMap {
    /// A map of so many texels a pixel each way.
    ///
    /// # Errors
    /// Texels not from 1/16 to 8, a square of a side not from 0.1 to 4 radii.
    pub fn new(kernel: Kernel, region: Region, texels: f64) -> Result<Self> {
        if let Region::Square(side) = region {
            error::within("side", side, 0.1, 4.0)?;
        }
        Ok(Self {
            kernel,
            region,
            texels: error::within("texels", texels, 1.0 / 16.0, 8.0)?,
        })
    }

    /// The densities of the shadows of `cards` on the receiver at elevation 0, by a map for each light and card: transmissions
    /// of cards multiply, the lights' parts add up.
    ///
    /// # Errors
    /// No light, a light not above the receiver, and maps beyond [`MAX_PIXELS`](crate::MAX_PIXELS).
    pub fn shade(
        &self,
        lights: &[DiscLight],
        cards: &[Card],
        grid: &Grid,
        densities: &mut [f32],
    ) -> Result<()> {
        grid.check_buffer(densities.len())?;
        let power = lights.iter().map(|light| light.power).sum();
        error::positive("the lights' power", power)?;
        densities.fill(0.0);
        for light in lights {
            error::positive("light.z", light.center[2])?;
            let mut passed = vec![1.0_f32; densities.len()];
            for card in cards {
                let map = self.project(light, card, grid)?;
                self.average(&map, grid, |place, density| {
                    passed[place] *= 1.0 - density as f32;
                });
            }
            let part = (light.power / power) as f32;
            for (density, passed) in densities.iter_mut().zip(&passed) {
                *density += part * (1.0 - passed);
            }
        }
        Ok(())
    }

    /// The map of a card seen from the light's centre.
    fn project(&self, light: &DiscLight, card: &Card, grid: &Grid) -> Result<Map> {
        let finer = grid.finer(self.texels)?;
        let scale = finer.pixels_per_unit();
        let from = DVec3::from_array(light.center);
        let meet = |grid: &Grid, x: u32, y: u32| {
            let center = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let point = (grid.corner() + center) / scale;
            match card.met(from, point.extend(0.0)) {
                Some((share, alpha)) if 0.0 < share && share < 1.0 => (share, alpha),
                _ => (1.0, 0.0),
            }
        };
        // The widest circle that a pixel of the grid may ask for is at one of its corners: planes are flat.
        let (right, bottom) = (finer.width() - 1, finer.height() - 1);
        let widest = [(0, 0), (right, 0), (0, bottom), (right, bottom)]
            .map(|(x, y)| radius(meet(&finer, x, y).0, light.radius * scale))
            .into_iter()
            .fold(0.0, f64::max);
        let margin = widest.min(WIDEST).ceil() as u32 + 1;
        let grown = finer.grown(margin)?;
        let (width, height) = (grown.width(), grown.height());
        let mut map = Map {
            alpha: Plane {
                width: width as usize,
                height: height as usize,
                margin: margin as usize,
                values: Vec::with_capacity(width as usize * height as usize),
            },
            depth: Vec::with_capacity(width as usize * height as usize),
            light_radius: light.radius * scale,
        };
        for y in 0..height {
            for x in 0..width {
                let (share, alpha) = meet(&grown, x, y);
                map.alpha.values.push(alpha as f32);
                map.depth.push(share as f32);
            }
        }
        Ok(map)
    }

    /// The average about each of the grid's pixels.
    fn average(&self, map: &Map, grid: &Grid, mut put: impl FnMut(usize, f64)) {
        let averages = Averages::new(&map.alpha, self.kernel, self.region);
        let margin = map.alpha.margin as f64;
        for y in 0..grid.height() {
            for x in 0..grid.width() {
                let pixel = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let center = pixel * self.texels + margin;
                let texel = center.y as usize * map.alpha.width + center.x as usize;
                let radius = radius(f64::from(map.depth[texel]), map.light_radius).min(WIDEST);
                let place = y as usize * grid.stride() + x as usize;
                put(place, averages.average(center, radius).clamp(0.0, 1.0));
            }
        }
    }
}

/// R d2 / d1.
fn radius(depth: f64, light_radius: f64) -> f64 {
    light_radius * (1.0 - depth) / depth
}

/// The averages of a plane.
struct Averages<'a> {
    plane: &'a Plane,
    kernel: Kernel,
    region: Region,
    /// Of rows for circles, of areas for squares, of nothing for a Gaussian.
    sums: Sums,
}

impl<'a> Averages<'a> {
    fn new(plane: &'a Plane, kernel: Kernel, region: Region) -> Self {
        let rows = (0..plane.height).map(|y| plane.row(y).iter().copied().map(f64::from));
        let sums = match (kernel, region) {
            (Kernel::Gaussian, _) => Sums::default(),
            (Kernel::Box, Region::Circle) => Sums::of_rows(plane.width, rows),
            (Kernel::Box, Region::Square(_)) => Sums::of_areas(plane.width, rows),
        };
        Self {
            plane,
            kernel,
            region,
            sums,
        }
    }

    fn average(&self, center: DVec2, radius: f64) -> f64 {
        match (self.kernel, self.region) {
            (Kernel::Box, Region::Circle) => self.circle(center, radius),
            (Kernel::Box, Region::Square(side)) => self.square(center, radius * side),
            (Kernel::Gaussian, Region::Circle) => self.gaussian(center, radius, radius, |d| {
                d.length_squared() <= radius * radius
            }),
            (Kernel::Gaussian, Region::Square(side)) => {
                self.gaussian(center, radius, radius * side / 2.0, |_| true)
            }
        }
    }

    /// Along a chord in each row of texels.
    fn circle(&self, center: DVec2, radius: f64) -> f64 {
        let first = (center.y - radius - 0.5).ceil().max(0.0) as usize;
        let (mut sum, mut area) = (0.0, 0.0);
        for row in first..self.plane.height {
            let dy = row as f64 + 0.5 - center.y;
            if dy > radius {
                break;
            }
            let half = (radius * radius - dy * dy).sqrt();
            let row = self.sums.row(row);
            sum += row.up_to(center.x + half) - row.up_to(center.x - half);
            area += 2.0 * half;
        }
        if area > 0.0 {
            sum / area
        } else {
            self.texel(center)
        }
    }

    fn square(&self, center: DVec2, side: f64) -> f64 {
        // A square within a texel is the texel.
        let half = DVec2::splat(side.max(1e-3) / 2.0);
        let (min, max) = (center - half, center + half);
        let at = |x: f64, y: f64| self.sums.up_to(x, y);
        let sum = at(max.x, max.y) - at(min.x, max.y) - at(max.x, min.y) + at(min.x, min.y);
        sum / ((max.x - min.x) * (max.y - min.y))
    }

    fn gaussian(
        &self,
        center: DVec2,
        radius: f64,
        reach: f64,
        within: impl Fn(DVec2) -> bool,
    ) -> f64 {
        let sigma = radius / 2.0;
        if sigma <= 0.0 {
            return self.texel(center);
        }
        let step = (reach / GAUSSIAN_STEPS).max(1.0);
        let count = (reach / step) as i32;
        let (mut sum, mut weights) = (0.0, 0.0);
        for j in -count..=count {
            for i in -count..=count {
                let offset = DVec2::new(f64::from(i), f64::from(j)) * step;
                if within(offset) {
                    let weight = exp(-offset.length_squared() / (2.0 * sigma * sigma));
                    sum += weight * self.texel(center + offset);
                    weights += weight;
                }
            }
        }
        sum / weights
    }

    /// The value of the texel that holds a place, 0 outside.
    fn texel(&self, at: DVec2) -> f64 {
        let inside = at.cmpge(DVec2::ZERO).all()
            && at.x < self.plane.width as f64
            && at.y < self.plane.height as f64;
        if inside {
            f64::from(self.plane.row(at.y as usize)[at.x as usize])
        } else {
            0.0
        }
    }
}

impl Technique for PenumbraMap {
    fn name(&self) -> &'static str {
        "penumbra-map"
    }

    fn family(&self) -> Family {
        Family::Maps
    }

    fn parameters(&self) -> Vec<Parameter> {
        let kernel = match self.kernel {
            Kernel::Box => "box",
            Kernel::Gaussian => "gaussian",
        };
        let mut parameters = vec![Parameter::choice("kernel", kernel, &["box", "gaussian"])];
        parameters.push(match self.region {
            Region::Circle => Parameter::choice("region", "circle", &["circle", "square"]),
            Region::Square(side) => Parameter::number("square", side, "r", [0.1, 4.0]),
        });
        let texels = Parameter::number("texels", self.texels, "a pixel", [1.0 / 16.0, 8.0]);
        parameters.push(texels);
        parameters
    }

    fn claim(&self) -> Claim {
        Claim {
            levels: None,
            why: match (self.kernel, self.region) {
                (Kernel::Box, Region::Circle) => {
                    "the exact convolution of a parallel caster, but for the size of its texels"
                }
                _ => "another kernel than the light's disc",
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
        grid.check_buffer(densities.len())?;
        let finer = grid.finer(self.texels)?;
        // A caster halfway to the light: the radius on the receiver is the light's own.
        let light_radius = shadow.radius() * finer.pixels_per_unit();
        let margin = light_radius.min(WIDEST).ceil() as u32 + 1;
        let alpha = Plane::coverage(shadow, &finer, margin, scratch)?;
        let map = Map {
            depth: vec![0.5; alpha.values.len()],
            alpha,
            light_radius,
        };
        self.average(&map, grid, |place, density| {
            densities[place] = density as f32;
        });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::Errors;
    use super::super::rays::{number, stratified};
    use super::super::tests::{card, errors};
    use super::*;
    use crate::image::Image;

    fn map(kernel: Kernel, region: Region) -> PenumbraMap {
        PenumbraMap::new(kernel, region, 1.0).unwrap()
    }

    #[test]
    fn an_even_circle_is_the_discs_convolution() {
        for (radius, allowed) in [(3.0, 9.0), (9.0, 2.0), (20.0, 1.0)] {
            let (shadow, grid) = card(radius);
            let got = errors(&map(Kernel::Box, Region::Circle), &shadow, &grid);
            println!("r {radius}: {got:?}");
            assert!(got.max_levels < allowed, "r {radius}: {got:?}");
        }
        let (shadow, grid) = card(9.0);
        for (kernel, region, allowed) in [
            (Kernel::Box, Region::Square(3.0_f64.sqrt()), 22.0),
            (Kernel::Box, Region::Square(1.0), 80.0),
            (Kernel::Gaussian, Region::Circle, 50.0),
            (Kernel::Gaussian, Region::Square(2.0), 50.0),
        ] {
            let got = errors(&map(kernel, region), &shadow, &grid);
            println!("{kernel:?} {region:?}: {got:?}");
            assert!(got.max_levels < allowed && got.max_levels > 4.0, "{got:?}");
        }
    }

    /// A dot that fades out on a square of 48 units.
    fn soft_dot() -> Image {
        let alpha = |i: u32| {
            let d = DVec2::new(f64::from(i % 64), f64::from(i / 64)) - 31.5;
            (255.0 * (1.5 - d.length() / 20.0).clamp(0.0, 1.0)) as u8
        };
        let pixels = (0..64 * 64).flat_map(|i| [200, 30, 30, alpha(i)]);
        Image::from_rgba8([64, 64], pixels.collect()).unwrap()
    }

    /// The mean over the lights, each at `places` of its disc, of what `hidden` says of a point and a light's point.
    fn averaged(
        lights: &[DiscLight],
        grid: &Grid,
        places: &[DVec2],
        hidden: impl Fn(DVec3, DVec3) -> f64,
    ) -> Vec<f32> {
        let power: f64 = lights.iter().map(|light| light.power).sum();
        let pixel = |i: u32| {
            let center = DVec2::new(f64::from(i % grid.width()), f64::from(i / grid.width())) + 0.5;
            let point = ((grid.corner() + center) / grid.pixels_per_unit()).extend(0.0);
            let of = |light: &DiscLight| {
                let from = DVec3::from_array(light.center);
                let at = |place: &DVec2| hidden(point, from + (*place * light.radius).extend(0.0));
                light.power / power * places.iter().map(at).sum::<f64>() / places.len() as f64
            };
            lights.iter().map(of).sum::<f64>() as f32
        };
        (0..grid.width() * grid.height()).map(pixel).collect()
    }

    /// What rays to every point of the lights find.
    fn traced(lights: &[DiscLight], cards: &[Card], grid: &Grid) -> Vec<f32> {
        averaged(lights, grid, &stratified(1024), |point, light| {
            1.0 - cards
                .iter()
                .map(|card| card.passed(point.to_array(), light.to_array()))
                .product::<f64>()
        })
    }

    fn shaded(lights: &[DiscLight], cards: &[Card], grid: &Grid) -> Errors {
        let mut got = vec![0.0; grid.width() as usize * grid.height() as usize];
        map(Kernel::Box, Region::Circle)
            .shade(lights, cards, grid, &mut got)
            .unwrap();
        Errors::between(&got, &traced(lights, cards, grid))
    }

    const LIGHT: DiscLight = DiscLight {
        center: [50.0, 20.0, 200.0],
        radius: 60.0,
        power: 1.0,
    };

    #[test]
    fn images_cast_by_their_alpha_and_tilted_cards_by_the_plane_at_each_ray() {
        let grid = Grid::new([0.0, 0.0], [100, 100], 1.0).unwrap();
        let card = |low: f64, high: f64| {
            let corner = [26.0, 26.0, low];
            let across = [48.0, 0.0, high - low];
            Card::new(soft_dot(), corner, across, [0.0, 48.0, 0.0]).unwrap()
        };
        for (low, high, allowed) in [(30.0, 30.0, 2.0), (20.0, 40.0, 8.0), (2.0, 60.0, 30.0)] {
            let got = shaded(&[LIGHT], &[card(low, high)], &grid);
            println!("from z {low} to {high}: {got:?}");
            assert!(got.max_levels < allowed, "{low} to {high}: {got:?}");
        }
        // Two cards and two lights, a map each.
        let other = DiscLight {
            center: [10.0, 90.0, 180.0],
            radius: 30.0,
            power: 0.5,
        };
        let got = shaded(
            &[LIGHT, other],
            &[card(30.0, 30.0), card(12.0, 12.0)],
            &grid,
        );
        // Both cards are partial for the same rays, which a product does not know.
        assert!(got.max_levels < 30.0, "{got:?}");
    }

    #[test]
    fn a_long_and_a_square_light_are_several_discs() {
        let grid = Grid::new([0.0, 0.0], [100, 100], 1.0).unwrap();
        let solid = Image::from_rgba8([1, 1], vec![0, 0, 0, 255]).unwrap();
        let card = Card::new(
            solid,
            [30.0, 30.0, 25.0],
            [40.0, 0.0, 0.0],
            [0.0, 40.0, 0.0],
        )
        .unwrap();
        let truth = |square: DVec2| {
            // A place of its own in each of 32 by 32 cells of a rectangle with these half sides.
            let place = |i: u32| {
                let within = DVec2::new(number(5, u64::from(i)), number(6, u64::from(i)));
                let corner = DVec2::new(f64::from(i % 32), f64::from(i / 32));
                ((corner + within) / 16.0 - 1.0) * square
            };
            let places: Vec<DVec2> = (0..1024).map(place).collect();
            let unit = DiscLight {
                radius: 1.0,
                ..LIGHT
            };
            averaged(&[unit], &grid, &places, |point, light| {
                1.0 - card.passed(point.to_array(), light.to_array())
            })
        };
        let compare = |lights: &[DiscLight], truth: &[f32]| {
            let mut got = vec![0.0; 10_000];
            // The smallest discs are seen through 2 px: texels must be smaller.
            PenumbraMap::new(Kernel::Box, Region::Circle, 4.0)
                .unwrap()
                .shade(lights, std::slice::from_ref(&card), &grid, &mut got)
                .unwrap();
            Errors::between(&got, truth).max_levels
        };
        let square = truth(DVec2::splat(50.0));
        let by_count =
            [1, 2, 4].map(|count| compare(&DiscLight::square(LIGHT.center, 100.0, count), &square));
        println!("a square light as 1, 4 and 16 discs: {by_count:?} levels");
        assert!(
            by_count[2] < by_count[0] && by_count[2] < 10.0,
            "{by_count:?}"
        );
        let long = truth(DVec2::new(80.0, 8.0));
        let ends = [[-30.0, 20.0, 200.0], [130.0, 20.0, 200.0]];
        let by_count =
            [1, 4, 16].map(|count| compare(&DiscLight::long(ends[0], ends[1], 16.0, count), &long));
        println!("a long light as 1, 4 and 16 discs: {by_count:?} levels");
        assert!(
            by_count[2] < by_count[1] && by_count[2] < 30.0,
            "{by_count:?}"
        );
    }
}
