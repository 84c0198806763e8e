//! A card that turns about its middle line until it passes the light's plane, for the atlas and the chart: the closed form on
//! pixels and the penumbra map, against the closed form at points.

use penumbral::lab::{Card, DiscLight, Errors, Family, Kernel, PenumbraMap, Region};
use penumbral::{Grid, Image, Light, PixelOptions, Pose, Result, Scratch, Shape, TiltedShadow};

/// The card's half side, its middle's height, and the light.
const HALF: f64 = 24.0;
const MIDDLE: [f64; 3] = [50.0, 50.0, 60.0];
const LIGHT: [f64; 3] = [50.0, 30.0, 80.0];
const RADIUS: f64 = 30.0;

/// What draws the card.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Method {
    ClosedForm,
    PenumbraMap,
}

impl Method {
    pub(crate) const ALL: [Self; 2] = [Self::ClosedForm, Self::PenumbraMap];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::ClosedForm => "tilted",
            Self::PenumbraMap => "penumbra-map (tilted)",
        }
    }

    pub(crate) fn family(self) -> Family {
        match self {
            Self::ClosedForm => Family::Ours,
            Self::PenumbraMap => Family::Maps,
        }
    }

    pub(crate) fn promised_levels(self) -> Option<f64> {
        (self == Self::ClosedForm).then_some(1.0)
    }
}

/// The card at one angle, and its pixels.
pub(crate) struct Turned {
    shadow: TiltedShadow,
    card: Card,
    map: PenumbraMap,
    grid: Grid,
    exact: Vec<f32>,
    /// The penumbra radius through the card's middle, pixels.
    pub(crate) radius: f64,
}

impl Turned {
    pub(crate) fn by(degrees: f64) -> Result<Self> {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let corner = [
            MIDDLE[0] - HALF * cos,
            MIDDLE[1] - HALF,
            MIDDLE[2] - HALF * sin,
        ];
        let across = [cos, 0.0, sin];
        let pose = Pose::new(
            corner.map(|v| v as f32),
            across.map(|v| v as f32),
            [0.0, 1.0, 0.0],
        )?;
        let side = (2.0 * HALF) as f32;
        let light = Light::new(LIGHT.map(|v| v as f32), RADIUS as f32)?;
        let shadow = light.cast_posed(&Shape::rect(0.0, 0.0, side, side)?, &pose, 0.0)?;
        let exact = (0..200 * 200_u16)
            .map(|i| {
                let (x, y) = (f32::from(i % 200), f32::from(i / 200));
                shadow.density_at([x - 49.5, y - 49.5]) as f32
            })
            .collect();
        let solid = Image::from_rgba8([1, 1], vec![0, 0, 0, 255])?;
        Ok(Self {
            shadow,
            card: Card::new(
                solid,
                corner,
                across.map(|v| v * 2.0 * HALF),
                [0.0, 2.0 * HALF, 0.0],
            )?,
            map: PenumbraMap::new(Kernel::Box, Region::Circle, 1.0)?,
            grid: Grid::new([-50.0, -50.0], [200, 200], 1.0)?,
            exact,
            radius: RADIUS * MIDDLE[2] / (LIGHT[2] - MIDDLE[2]),
        })
    }

    /// The card's densities.
    pub(crate) fn draw(
        &self,
        method: Method,
        densities: &mut [f32],
        scratch: &mut Scratch,
    ) -> Result<()> {
        match method {
            Method::ClosedForm => {
                let options = PixelOptions::default();
                self.shadow
                    .fill_f32(&self.grid, densities, &options, scratch)
            }
            Method::PenumbraMap => {
                let light = DiscLight {
                    center: LIGHT,
                    radius: RADIUS,
                    power: 1.0,
                };
                let cards = std::slice::from_ref(&self.card);
                self.map.shade(&[light], cards, &self.grid, densities)
            }
        }
    }

    /// How many densities it has.
    pub(crate) fn pixels(&self) -> usize {
        self.exact.len()
    }

    pub(crate) fn errors(&self, densities: &[f32]) -> Errors {
        Errors::between(densities, &self.exact)
    }
}
