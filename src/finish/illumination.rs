//! Illumination: how bright a point of a normal is under the scene's lights (Phong 1975).

use core::f64::consts::{LN_2, PI};

use glam::{DVec2, DVec3};
use libm::{cos, sin};

use super::number::Number;
use crate::error::{self, Result};
use crate::light::Light;

/// How a surface throws light back. Strengths are parts of the surface's own colour, the highlight's of white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    ambient: f64,
    diffuse: f64,
    specular: f64,
    shininess: f64,
    attenuation: [f64; 3],
}

impl Default for Material {
    /// Ambient 0.4, diffuse 0.6, specular 0.3, shininess 24; no attenuation.
    fn default() -> Self {
        Self {
            ambient: 0.4,
            diffuse: 0.6,
            specular: 0.3,
            shininess: 24.0,
            attenuation: [1.0, 0.0, 0.0],
        }
    }
}

impl Material {
    /// The same with other strengths, 0 to 4 each.
    ///
    /// # Errors
    /// A strength out of range.
    pub fn with_strengths(mut self, ambient: f32, diffuse: f32, specular: f32) -> Result<Self> {
        let strength = |field, value: f32| error::within(field, f64::from(value), 0.0, 4.0);
        self.ambient = strength("finish.ambient", ambient)?;
        self.diffuse = strength("finish.diffuse", diffuse)?;
        self.specular = strength("finish.specular", specular)?;
        Ok(self)
    }

    /// The same with another exponent of the highlight, 1 to 1000: the larger, the smaller the highlight.
    ///
    /// # Errors
    /// A shininess out of range.
    pub fn with_shininess(mut self, shininess: f32) -> Result<Self> {
        self.shininess = error::within("finish.shininess", f64::from(shininess), 1.0, 1000.0)?;
        Ok(self)
    }

    /// The same under light that weakens with the distance d: by 1 / (a0 + a1 d + a2 d²), at most 1. Directional lights come from
    /// everywhere at the same strength.
    ///
    /// # Errors
    /// A coefficient that is not from 0 to 1e6, or none above 0.
    pub fn with_attenuation(mut self, attenuation: [f32; 3]) -> Result<Self> {
        for (field, value) in ["a0", "a1", "a2"].into_iter().zip(attenuation) {
            error::within(field, f64::from(value), 0.0, 1e6)?;
        }
        let sum: f32 = attenuation.iter().sum();
        error::positive("finish.attenuation", f64::from(sum))?;
        self.attenuation = attenuation.map(f64::from);
        Ok(self)
    }
}

/// How bright a point is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Intensity {
    /// The part of the surface's own colour.
    pub body: f32,
    /// The part of white that the highlight adds.
    pub gloss: f32,
}

impl Intensity {
    pub(super) fn new((body, gloss): (f64, f64)) -> Self {
        Self {
            body: body as f32,
            gloss: gloss as f32,
        }
    }

    /// The colour of a fill under this light; what is brighter than white is white.
    #[must_use]
    pub fn of(self, fill: [f32; 3]) -> [u8; 3] {
        fill.map(|channel| (channel * self.body + 255.0 * self.gloss + 0.5).clamp(0.0, 255.0) as u8)
    }
}

/// The lights as they shine on one surface, and its material. The viewer is far above.
#[derive(Debug, Clone)]
pub struct Lighting {
    lamps: Vec<Lamp>,
    material: Material,
}

#[derive(Debug, Clone)]
struct Lamp {
    /// Its part of all light.
    share: f64,
    center: Place,
    /// The disc's points that highlights are an average over; its centre alone where that does as well.
    samples: Vec<Place>,
}

#[derive(Debug, Clone, Copy)]
enum Place {
    /// A point, z over the surface.
    At(DVec3),
    /// A direction.
    Towards(DVec3),
}

/// A highlight is so narrow that it shows single samples unless as many as this are in each area of its size.
const SAMPLES: f64 = 4.0;

/// More samples than this a lamp has not: highlights narrower than that are spread over the disc less evenly.
const MOST_SAMPLES: f64 = 64.0;

/// How many times as wide a highlight is across fibres.
const WIDER: f64 = 5.0;

impl Lighting {
    /// Lights, each with its strength among them, on a surface at an elevation (scene units) below them all.
    ///
    /// # Errors
    /// [`Error::CasterNotBelowLight`](crate::Error::CasterNotBelowLight), and an elevation that is not finite.
    pub fn new(
        lights: impl IntoIterator<Item = (Light, f32)>,
        elevation: f32,
        material: &Material,
    ) -> Result<Self> {
        let lights: Vec<_> = lights.into_iter().collect();
        for (light, _) in &lights {
            light.projection(elevation, elevation)?;
        }
        let all: f64 = lights
            .iter()
            .map(|(_, strength)| f64::from(*strength))
            .sum();
        let lamps = lights.iter().map(|(light, strength)| {
            let share = if all > 0.0 {
                f64::from(*strength) / all
            } else {
                1.0 / lights.len() as f64
            };
            Lamp::new(light, share, f64::from(elevation), material)
        });
        Ok(Self {
            lamps: lamps.collect(),
            material: *material,
        })
    }

    /// The intensity at a point (scene units, z over the flat part) of a unit normal.
    #[must_use]
    pub fn at(&self, point: [f64; 3], normal: [f64; 3]) -> Intensity {
        Intensity::new(self.intensity(point, normal))
    }

    /// The same where fine fibres run along the unit tangent: across them the highlight is so many times as wide as along them
    /// (Ashikhmin & Shirley 2000).
    pub(super) fn at_fibres(&self, point: [f64; 3], normal: DVec3, tangent: DVec3) -> Intensity {
        let body = self.intensity(point, normal.to_array()).0;
        let across = normal.cross(tangent);
        // The half vector turns by half of the reflected ray's angle: four times the exponent.
        let along = 4.0 * self.material.shininess;
        let of = |place: Place| {
            let way = DVec3::from(self.ray(place, point).0);
            if way.dot(normal) <= 0.0 {
                return 0.0;
            }
            let half = (way + DVec3::Z).normalize_or_zero();
            let (t, b) = (half.dot(tangent), half.dot(across));
            let square = t * t + b * b;
            if square == 0.0 {
                return 1.0;
            }
            let exponent = along * (t * t + b * b / (WIDER * WIDER)) / square;
            half.dot(normal).max(0.0).power(exponent)
        };
        let mut gloss = 0.0;
        for lamp in &self.lamps {
            let strength = self.ray(lamp.center, point).1;
            let places = match lamp.samples.as_slice() {
                [] => core::slice::from_ref(&lamp.center),
                samples => samples,
            };
            let mean = places.iter().map(|&place| of(place)).sum::<f64>() / places.len() as f64;
            gloss += self.material.specular * lamp.share * strength * mean;
        }
        Intensity::new((body, gloss))
    }

    /// Body and gloss at a point of a normal of unit length, by any arithmetic.
    pub(super) fn intensity<N: Number>(&self, point: [N; 3], normal: [N; 3]) -> (N, N) {
        let material = &self.material;
        let (mut body, mut gloss) = (N::constant(material.ambient), N::constant(0.0));
        for lamp in &self.lamps {
            let (way, strength) = self.ray(lamp.center, point);
            let strength = strength * N::constant(lamp.share);
            let facing = dot(way, normal);
            if facing.value() <= 0.0 {
                continue;
            }
            body = body + N::constant(material.diffuse) * strength * facing;
            if material.specular > 0.0 {
                let highlight = self.highlight(lamp, (way, facing), point, normal);
                gloss = gloss + N::constant(material.specular) * strength * highlight;
            }
        }
        (body, gloss)
    }

    fn highlight<N: Number>(
        &self,
        lamp: &Lamp,
        center: ([N; 3], N),
        point: [N; 3],
        normal: [N; 3],
    ) -> N {
        let of = |way: [N; 3], facing: N| {
            // R·V with the viewer along z: R = 2 N (N·L) - L.
            let towards = N::constant(2.0) * normal[2] * facing - way[2];
            towards.at_least_zero().power(self.material.shininess)
        };
        if lamp.samples.is_empty() {
            return of(center.0, center.1);
        }
        let mut sum = N::constant(0.0);
        for &sample in &lamp.samples {
            let way = self.ray(sample, point).0;
            let facing = dot(way, normal);
            if facing.value() > 0.0 {
                sum = sum + of(way, facing);
            }
        }
        sum * N::constant(1.0 / lamp.samples.len() as f64)
    }

    /// The unit way from a point to a light, and how strong it is there.
    fn ray<N: Number>(&self, place: Place, point: [N; 3]) -> ([N; 3], N) {
        match place {
            Place::Towards(way) => (way.to_array().map(N::constant), N::constant(1.0)),
            Place::At(at) => {
                let mut index = 0;
                let way = at.to_array().map(|coordinate| {
                    index += 1;
                    N::constant(coordinate) - point[index - 1]
                });
                let square = dot(way, way);
                let inverse = square.inverse_root();
                let unit = way.map(|coordinate| coordinate * inverse);
                let [a0, a1, a2] = self.material.attenuation;
                if a1 == 0.0 && a2 == 0.0 {
                    return (unit, N::constant((1.0 / a0).min(1.0)));
                }
                let weakened =
                    N::constant(a0) + N::constant(a1) * square * inverse + N::constant(a2) * square;
                let strength = if weakened.value() > 1.0 {
                    weakened.inverse()
                } else {
                    N::constant(1.0)
                };
                (unit, strength)
            }
        }
    }
}

fn dot<N: Number>(a: [N; 3], b: [N; 3]) -> N {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Lamp {
    fn new(light: &Light, share: f64, elevation: f64, material: &Material) -> Self {
        let place = |at: DVec2| {
            let point = light.point(at, elevation);
            if point.w == 0.0 {
                Place::Towards(point.truncate().normalize())
            } else {
                Place::At(point.truncate())
            }
        };
        let [center, edge] = [DVec2::ZERO, DVec2::X].map(|at| light.point(at, elevation));
        // The tangents of the disc's half angle as seen from below its centre, and of the highlight's at half its strength.
        let disc = (edge - center).length() / center.z;
        let highlight = (2.0 * LN_2 / material.shininess).sqrt();
        let count = if material.specular > 0.0 && disc > highlight {
            (SAMPLES * (disc / highlight) * (disc / highlight)).min(MOST_SAMPLES) as u32
        } else {
            0
        };
        // Along a spiral by the golden angle (Vogel 1979) each point has the same area.
        let golden = PI * (3.0 - 5.0_f64.sqrt());
        let samples = (0..count).map(|index| {
            let index = f64::from(index);
            let radius = ((index + 0.5) / f64::from(count)).sqrt();
            place(DVec2::new(cos(golden * index), sin(golden * index)) * radius)
        });
        Self {
            share,
            center: place(DVec2::ZERO),
            samples: samples.collect(),
        }
    }
}
