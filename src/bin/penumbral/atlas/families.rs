//! What breaks shadow engines, each with the parameter that does.

use std::f64::consts::TAU;

use penumbral::lab::{
    DepthMap, Errors, Family, Kernel, MonteCarlo, PenumbraMap, Region, ScanLine, ShadowVolume,
    Technique, ZBuffer,
};
use penumbral::{FillRule, Grid, Light, Result, Scratch, Shadow, Shape};

use crate::tilt::{Method, Turned};

type Techniques = Vec<Box<dyn Technique>>;

/// A situation that is made worse by one number.
pub(super) struct Stress {
    pub(super) name: &'static str,
    pub(super) parameter: &'static str,
    pub(super) values: Vec<f64>,
    pub(super) trial: Trial,
}

/// What is drawn for a number.
pub(super) enum Trial {
    /// A shadow, by every technique.
    Shadow(fn(f64) -> Result<Case>),
    /// The card, by techniques of which the number is a setting.
    Setting(fn(f64) -> Result<Techniques>),
    /// What no technique draws.
    Own(fn(f64) -> Result<Vec<Own>>),
}

/// A drawing that measured itself.
pub(super) struct Own {
    pub(super) method: &'static str,
    pub(super) family: Family,
    pub(super) errors: Errors,
    pub(super) promised_levels: Option<f64>,
}

/// A shadow on its pixels.
pub(super) struct Case {
    pub(super) shadow: Shadow,
    pub(super) grid: Grid,
}

pub(super) fn all() -> Vec<Stress> {
    let stress = |name, parameter, values: &[f64], case| Stress {
        name,
        parameter,
        values: values.to_vec(),
        trial: Trial::Shadow(case),
    };
    vec![
        stress(
            "vanishing umbra",
            "r, px, of a 60 x 24 card (inradius 12)",
            &[
                1.0, 2.0, 3.0, 6.0, 9.0, 11.5, 11.9, 12.0, 12.1, 12.5, 16.0, 24.0, 48.0, 100.0,
            ],
            |r| flat(&Shape::rounded_rect(0.3, 0.6, 60.0, 24.0, 6.0)?, r),
        ),
        stress(
            "elevation to 0",
            "elevation under Android's light",
            &[
                4.0, 2.5, 2.0, 1.5, 1.0, 0.75, 0.5, 0.2, 0.1, 0.03, 0.01, 0.001, 0.0001,
            ],
            |h| {
                let light = Light::android(100.0)?;
                let card = Shape::rounded_rect(20.3, 30.6, 60.0, 40.0, 8.0)?;
                fitted(light.cast(&card, h as f32, 0.0)?, 1.0)
            },
        ),
        stress(
            "elevation to the light",
            "light's height 100 less elevation",
            &[50.0, 20.0, 10.0, 5.0, 2.0, 1.0, 0.3, 0.1, 0.03],
            |gap| {
                let light = Light::new([30.0, 20.0, 100.0], 8.0)?;
                let card = Shape::rounded_rect(0.3, 0.6, 60.0, 40.0, 8.0)?;
                fitted(light.cast(&card, (100.0 - gap) as f32, 0.0)?, 120.0)
            },
        ),
        stress(
            "corner angle",
            "degrees, at r = 8 px",
            &[
                1.0, 2.0, 5.0, 10.0, 20.0, 45.0, 90.0, 135.0, 160.0, 175.0, 179.0,
            ],
            |degrees| {
                let half = (degrees / 2.0).to_radians();
                let (x, y) = (80.0 * half.sin(), 80.0 * half.cos());
                flat(&polygon(&[[[0.4, 0.7], [x, y], [-x, y]].to_vec()])?, 8.0)
            },
        ),
        stress(
            "notch",
            "width, px, at r = 8 px",
            &[0.5, 1.0, 2.0, 4.0, 8.0, 12.0, 15.0, 16.0, 17.0, 20.0, 32.0],
            |w| {
                let (a, b) = (40.3 - w / 2.0, 40.3 + w / 2.0);
                let ring = [
                    [0.3, 0.6],
                    [a, 0.6],
                    [a, 40.2],
                    [b, 40.2],
                    [b, 0.6],
                    [80.3, 0.6],
                    [80.3, 60.6],
                    [0.3, 60.6],
                ];
                flat(&polygon(&[ring.to_vec()])?, 8.0)
            },
        ),
        stress(
            "hole",
            "width, px, at r = 8 px",
            &[0.5, 1.0, 2.0, 4.0, 8.0, 12.0, 15.0, 16.0, 17.0, 20.0, 32.0],
            |w| {
                let square = |side: f64| {
                    let (a, b) = (35.3 - side / 2.0, 35.3 + side / 2.0);
                    vec![[a, a], [b, a], [b, b], [a, b]]
                };
                flat(&polygon(&[square(70.0), square(w)])?, 8.0)
            },
        ),
        stress(
            "corner radius",
            "px, at r = 10 px",
            &[0.01, 0.1, 1.0, 3.0, 6.0, 9.0, 10.0, 11.0, 15.0, 25.0, 30.0],
            |radius| {
                flat(
                    &Shape::rounded_rect(0.3, 0.6, 80.0, 60.0, radius as f32)?,
                    10.0,
                )
            },
        ),
        stress(
            "aspect",
            "width over height, at r = 8 px",
            &[1.0, 2.0, 5.0, 10.0, 30.0, 100.0, 300.0, 1000.0],
            |aspect| {
                let (w, h) = (60.0 * aspect.sqrt(), 60.0 / aspect.sqrt());
                flat(&Shape::rect(0.3, 0.6, w as f32, h as f32)?, 8.0)
            },
        ),
        stress(
            "coordinates",
            "distance from the origin, at r = 9 px",
            &[1.0, 1e2, 1e4, 1e5, 1e6, 4e6, 1e7],
            |d| {
                flat(
                    &Shape::rounded_rect(d as f32, -d as f32, 60.0, 40.0, 8.0)?,
                    9.0,
                )
            },
        ),
        stress(
            "vertices",
            "of a ring of teeth, at r = 6 px",
            &[8.0, 32.0, 100.0, 316.0, 1000.0, 1e4, 1e5],
            |count| {
                let vertex = |i: u32| {
                    let angle = TAU * f64::from(i) / count;
                    let radius = [40.0, 37.0][(i % 2) as usize];
                    [45.3 + radius * angle.cos(), 45.6 + radius * angle.sin()]
                };
                flat(&polygon(&[(0..count as u32).map(vertex).collect()])?, 6.0)
            },
        ),
        stress(
            "near-collinear points",
            "px from the side, every point twice, at r = 8 px",
            &[1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0],
            |off| {
                let corners = [[0.3, 0.6], [70.3, 0.6], [70.3, 50.6], [0.3, 50.6]];
                let mut ring = Vec::new();
                for (i, from) in corners.iter().enumerate() {
                    let to = corners[(i + 1) % 4];
                    for step in 0..12_u8 {
                        let share = f64::from(step) / 12.0;
                        let away = if step % 2 == 1 { off } else { 0.0 };
                        let point = [
                            from[0] + (to[0] - from[0]) * share + away * (to[1] - from[1]).signum(),
                            from[1] + (to[1] - from[1]) * share - away * (to[0] - from[0]).signum(),
                        ];
                        ring.extend([point, point]);
                    }
                }
                flat(&polygon(&[ring])?, 8.0)
            },
        ),
        Stress {
            name: "tilt",
            parameter: "degrees, to and past the light's plane (56)",
            values: vec![1.0, 15.0, 30.0, 45.0, 52.0, 56.0, 60.0, 75.0, 85.0, 89.0],
            trial: Trial::Own(turned),
        },
        Stress {
            name: "map resolution",
            parameter: "texels a pixel, at r = 9 px",
            values: vec![0.0625, 0.125, 0.25, 0.5, 1.0, 2.0],
            trial: Trial::Setting(|texels| {
                Ok(vec![
                    Box::new(PenumbraMap::new(Kernel::Box, Region::Circle, texels)?),
                    Box::new(DepthMap::new(texels, 64)?),
                    Box::new(ZBuffer::new(texels, 64, 0.0)?),
                ])
            }),
        },
        Stress {
            name: "samples",
            parameter: "points of the light, rays, or corners, at r = 9 px",
            values: vec![4.0, 16.0, 64.0, 144.0, 256.0, 1024.0],
            trial: Trial::Setting(|count| {
                let count = count as u32;
                let mut all: Techniques = vec![
                    Box::new(MonteCarlo::new(count)?),
                    Box::new(ScanLine::new(count)?),
                    Box::new(DepthMap::new(1.0, count)?),
                ];
                if count <= 256 {
                    all.push(Box::new(ShadowVolume::new(count)?));
                }
                Ok(all)
            }),
        },
    ]
}

pub(super) fn card() -> Result<Case> {
    flat(&Shape::rounded_rect(0.3, 0.6, 60.0, 40.0, 8.0)?, 9.0)
}

fn polygon(rings: &[Vec<[f64; 2]>]) -> Result<Shape> {
    let rings: Vec<Vec<[f32; 2]>> = rings
        .iter()
        .map(|ring| ring.iter().map(|point| point.map(|v| v as f32)).collect())
        .collect();
    Shape::polygon(&rings, FillRule::EvenOdd)
}

/// What is drawn of the card turned by so many degrees.
fn turned(degrees: f64) -> Result<Vec<Own>> {
    let card = Turned::by(degrees)?;
    let (mut densities, mut scratch) = (vec![0.0; card.pixels()], Scratch::new());
    let own = |method: Method| {
        card.draw(method, &mut densities, &mut scratch)?;
        Ok(Own {
            method: method.name(),
            family: method.family(),
            errors: card.errors(&densities),
            promised_levels: method.promised_levels(),
        })
    };
    Method::ALL.into_iter().map(own).collect()
}

/// A shape seen through `radius` pixels.
fn flat(shape: &Shape, radius: f64) -> Result<Case> {
    let light = Light::directional([0.0, 0.0], radius as f32)?;
    fitted(light.cast(shape, 1.0, 0.0)?, f64::INFINITY)
}

/// The pixels of a shadow's bounds: at most `most` along a side, where that is more than 1, else one a unit.
fn fitted(shadow: Shadow, most: f64) -> Result<Case> {
    let (low, high) = shadow
        .bounds()
        .map_or(([0.0; 2], [1.0; 2]), |bounds| (bounds.min, bounds.max));
    let extent = [0, 1].map(|i: usize| f64::from(high[i]) - f64::from(low[i]));
    let scale = if most > 1.0 {
        (most / extent[0].max(extent[1])).clamp(1.0 / 1024.0, 1.0)
    } else {
        1.0
    };
    let origin = low.map(|v| ((f64::from(v) * scale).floor() / scale) as f32);
    let size = [0, 1].map(|i: usize| {
        ((f64::from(high[i]) - f64::from(origin[i])) * scale)
            .ceil()
            .max(1.0) as u32
            + 1
    });
    Ok(Case {
        shadow,
        grid: Grid::new(origin, size, scale as f32)?,
    })
}
