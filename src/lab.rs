//! The laboratory: other ways to draw a shadow, kept to be measured against.
//!
//! Every way answers one question behind one trait: the density of one [`Shadow`] on one [`Grid`]. Those that ship are here
//! by an adapter over the public API, so that charts and tests can list all of them alike. Toolkits never compile this: it is
//! behind the feature `lab`.
//!
//! | file | what it holds | source |
//! |---|---|---|
//! | `shipping.rs` | [`Shipping`]: the crate's own methods | |
//! | `gaussian.rs`, `box3.rs` | [`Gaussian`], [`Box3`]: blurs of the outline, as toolkits and browsers have them | CSS, SVG filters, Skia |
//! | `smoothstep.rs` | [`Smoothstep`]: a ramp on the signed distance | shaders of iced, egui and others |
//! | `monte_carlo.rs` | [`MonteCarlo`]: rays to the light's disc, with their statistical bound | Cook et al. 1984 |
//! | `irradiance.rs` | [`Irradiance`]: the light weighted by its cosines, in closed form | Lambert 1760 |
//! | `penumbra_map.rs` | [`PenumbraMap`]: projected alpha, blurred by a radius a pixel | US 7,817,823 |
//! | `depth_map.rs`, `z_buffer.rs` | [`DepthMap`], [`ZBuffer`]: what is nearest to the light, with and without its geometry | US 10,339,703; Williams 1978 |
//! | `scan_line.rs` | [`ScanLine`]: projected edges crossed along scan lines | Appel 1968 |
//! | `shadow_volume.rs` | [`ShadowVolume`]: umbra and penumbra volumes of a polygonal light | Crow 1977; Nishita & Nakamae 1983 |
//! | `tangent.rs` | [`Tangent`]: the classical mesh between two rings of tangents | US 9,639,976 |
//! | `stage.rs`, `card.rs`, `plane.rs`, `view.rs`, `rays.rs` | what they share: casters in space, images, blurred pixels, outlines in pixels, samples | |

mod box3;
mod card;
mod depth_map;
mod gaussian;
mod irradiance;
mod monte_carlo;
mod penumbra_map;
mod plane;
mod rays;
mod scan_line;
mod shadow_volume;
mod shipping;
mod smoothstep;
mod stage;
mod tangent;
mod view;
mod z_buffer;

use core::fmt;

pub use box3::Box3;
pub use card::Card;
pub use depth_map::{DepthMap, DepthView};
pub use gaussian::Gaussian;
pub use irradiance::Irradiance;
pub use monte_carlo::{Estimate, MonteCarlo};
pub use penumbra_map::{DiscLight, Kernel, PenumbraMap, Region};
pub use scan_line::ScanLine;
pub use shadow_volume::ShadowVolume;
pub use shipping::Shipping;
pub use smoothstep::Smoothstep;
pub use stage::Stage;
pub use tangent::{Tangent, Umbra};
pub use z_buffer::{ZBuffer, ZView};

use crate::error::Result;
use crate::grid::Grid;
use crate::mesh::Profile;
use crate::plan::Method;
use crate::scene::{Scene, Surface};
use crate::scratch::Scratch;
use crate::shadow::Shadow;
use crate::tolerance::Tolerance;

/// A way to compute the density of one shadow on one grid, at one setting.
pub trait Technique: fmt::Debug + Send + Sync {
    /// What it is called; the same at every setting.
    fn name(&self) -> &'static str;

    /// What it is like.
    fn family(&self) -> Family;

    /// What can be set, and to what it is.
    fn parameters(&self) -> Vec<Parameter>;

    /// Why it cannot draw a shadow as it is meant to be, or nothing where it can. [`Technique::draw`] draws what it can all
    /// the same.
    fn refusal(&self, shadow: &Shadow, grid: &Grid) -> Option<&'static str> {
        let _ = (shadow, grid);
        None
    }

    /// How wrong it says it may be.
    fn claim(&self) -> Claim;

    /// Writes the density of every pixel of the grid.
    ///
    /// # Errors
    /// A buffer shorter than the grid needs, and pictures beyond [`MAX_PIXELS`](crate::MAX_PIXELS) where a method needs more
    /// pixels than the grid has.
    fn draw(
        &self,
        shadow: &Shadow,
        grid: &Grid,
        densities: &mut [f32],
        scratch: &mut Scratch,
    ) -> Result<()>;
}

/// What a technique is like.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Family {
    /// The crate's own methods.
    Ours,
    /// Blurs of the outline and ramps on the distance: what toolkits have.
    Blurs,
    /// Rays, and hard shadows of many points of the light.
    Samples,
    /// Maps seen from the light.
    Maps,
    /// Triangles and volumes.
    Geometry,
}

impl Family {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Ours,
        Self::Blurs,
        Self::Samples,
        Self::Maps,
        Self::Geometry,
    ];
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ours => "ours",
            Self::Blurs => "blurs",
            Self::Samples => "samples",
            Self::Maps => "maps",
            Self::Geometry => "geometry",
        })
    }
}

/// What a technique can be set to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// What it is called.
    pub name: &'static str,
    /// What it is, and what it could be.
    pub value: Value,
}

/// What a parameter is, and what it could be.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Value {
    /// A number.
    Number {
        /// The number.
        value: f64,
        /// Its unit, or nothing for a count.
        unit: &'static str,
        /// The least it can be.
        min: f64,
        /// The most.
        max: f64,
    },
    /// One of several words.
    Choice {
        /// The word.
        value: &'static str,
        /// All of them.
        of: &'static [&'static str],
    },
}

impl Parameter {
    /// A number in a range; its unit is nothing for a count.
    #[must_use]
    pub fn number(name: &'static str, value: f64, unit: &'static str, range: [f64; 2]) -> Self {
        let [min, max] = range;
        Self {
            name,
            value: Value::Number {
                value,
                unit,
                min,
                max,
            },
        }
    }

    /// One of several words.
    #[must_use]
    pub fn choice(name: &'static str, value: &'static str, of: &'static [&'static str]) -> Self {
        Self {
            name,
            value: Value::Choice { value, of },
        }
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.value {
            Value::Number { value, unit, .. } => {
                let value = (value * 1000.0).round() / 1000.0;
                let space = if unit.is_empty() { "" } else { " " };
                write!(f, "{} {value}{space}{unit}", self.name)
            }
            Value::Choice { value, .. } => write!(f, "{} {value}", self.name),
        }
    }
}

/// What a technique says of its own error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Claim {
    /// The largest error on any shadow, in levels, or none where it states none.
    pub levels: Option<f64>,
    /// Where the number comes from, or why there is none.
    pub why: &'static str,
}

/// How far densities are from the exact ones.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    /// The largest difference, in levels.
    pub max_levels: f64,
    /// The root of the mean square over all pixels, in levels.
    pub rms_levels: f64,
}

impl Errors {
    /// The differences between two maps of the same pixels.
    #[must_use]
    pub fn between(got: &[f32], exact: &[f32]) -> Self {
        let (mut max, mut sum) = (0.0_f64, 0.0);
        for (got, exact) in got.iter().zip(exact) {
            let levels = (f64::from(*got) - f64::from(*exact)) * 255.0;
            // No number is as wrong as can be.
            let levels = if levels.is_nan() { 255.0 } else { levels };
            max = max.max(levels.abs());
            sum += levels * levels;
        }
        Self {
            max_levels: max,
            rms_levels: (sum / exact.len().max(1) as f64).sqrt(),
        }
    }
}

/// A technique's setting in words: all its parameters.
#[must_use]
pub fn setting(technique: &dyn Technique) -> String {
    let words: Vec<String> = technique
        .parameters()
        .iter()
        .map(ToString::to_string)
        .collect();
    words.join(", ")
}

/// Every technique, at the setting that suits it best.
///
/// # Errors
/// None: every setting is within its range.
pub fn techniques() -> Result<Vec<Box<dyn Technique>>> {
    let one = Tolerance::ONE_LEVEL;
    Ok(vec![
        Box::new(Shipping::new(None, one)),
        Box::new(Shipping::new(Some(Method::Exact), one)),
        Box::new(Shipping::new(Some(Method::Direct), one)),
        Box::new(Shipping::new(Some(Method::Grid), one)),
        Box::new(Shipping::new(Some(Method::NinePatch), one)),
        Box::new(Shipping::new(Some(Method::Mesh), one)),
        Box::new(Gaussian::best()),
        Box::new(Box3::new(0.5)?),
        Box::new(Smoothstep::new()),
        Box::new(MonteCarlo::new(128)?),
        Box::new(ScanLine::new(64)?),
        Box::new(PenumbraMap::new(Kernel::Box, Region::Circle, 1.0)?),
        Box::new(DepthMap::new(1.0, 16)?),
        Box::new(ZBuffer::new(1.0, 16, 0.0)?),
        Box::new(ShadowVolume::new(16)?),
        Box::new(Tangent::new(Profile::Cosine, Umbra::Tangents)),
    ])
}

/// Every technique at several settings, from coarse to fine.
///
/// # Errors
/// None: every setting is within its range.
pub fn settings() -> Result<Vec<Box<dyn Technique>>> {
    let mut all: Vec<Box<dyn Technique>> = Vec::new();
    for levels in [0.5, 1.0, 2.0, 4.0] {
        let tolerance = Tolerance::levels(levels)?;
        for method in [
            None,
            Some(Method::Direct),
            Some(Method::Grid),
            Some(Method::NinePatch),
        ] {
            all.push(Box::new(Shipping::new(method, tolerance)));
        }
    }
    for levels in [1.0, 4.0] {
        let mesh = Shipping::new(Some(Method::Mesh), Tolerance::levels(levels)?);
        all.push(Box::new(mesh));
    }
    all.push(Box::new(Shipping::new(
        Some(Method::Exact),
        Tolerance::ONE_LEVEL,
    )));
    for gaussian in [Gaussian::best(), Gaussian::css(), Gaussian::skia()] {
        all.push(Box::new(gaussian));
    }
    for sigma in [0.5, 0.525] {
        all.push(Box::new(Box3::new(sigma)?));
    }
    all.push(Box::new(Smoothstep::new()));
    for rays in [32, 128, 512, 2048] {
        all.push(Box::new(MonteCarlo::new(rays)?));
    }
    for samples in [16, 64, 256] {
        all.push(Box::new(ScanLine::new(samples)?));
    }
    for texels in [0.5, 1.0] {
        all.push(Box::new(PenumbraMap::new(
            Kernel::Box,
            Region::Circle,
            texels,
        )?));
    }
    for side in [1.0, 3.0_f64.sqrt()] {
        all.push(Box::new(PenumbraMap::new(
            Kernel::Box,
            Region::Square(side),
            1.0,
        )?));
    }
    all.push(Box::new(PenumbraMap::new(
        Kernel::Gaussian,
        Region::Circle,
        1.0,
    )?));
    for samples in [16, 64] {
        for texels in [0.25, 1.0] {
            all.push(Box::new(DepthMap::new(texels, samples)?));
            all.push(Box::new(ZBuffer::new(texels, samples, 0.0)?));
        }
    }
    for corners in [4, 8, 16, 32] {
        all.push(Box::new(ShadowVolume::new(corners)?));
    }
    for profile in [Profile::Linear, Profile::Cosine, Profile::Skia] {
        for umbra in [Umbra::Tangents, Umbra::Centroid] {
            all.push(Box::new(Tangent::new(profile, umbra)));
        }
    }
    Ok(all)
}

/// The shadows of a scene's surfaces on its ground, each with the part of the light that it holds back where it hides it:
/// opaque surfaces of one elevation are one shadow. Transmissions multiply.
///
/// # Errors
/// None that the scene's constructors let pass.
pub fn ground_casts(scene: &Scene) -> Result<Vec<(Shadow, f32)>> {
    let mut casts = Vec::new();
    let mut above: Vec<_> = scene
        .surfaces()
        .iter()
        .filter(|surface| surface.elevation() > 0.0 && surface.weight() > 0.0)
        .collect();
    above.sort_by(|a, b| a.elevation().total_cmp(&b.elevation()));
    for level in above.chunk_by(|a, b| a.elevation() == b.elevation()) {
        let elevation = level[0].elevation();
        let (opaque, translucent): (Vec<&Surface>, Vec<&Surface>) =
            level.iter().partition(|surface| surface.is_opaque());
        if !opaque.is_empty() {
            let shapes: Vec<_> = opaque.iter().map(|surface| surface.shape()).collect();
            casts.push((scene.light().cast_all(&shapes, elevation, 0.0)?, 1.0));
        }
        for surface in translucent {
            let shadow = scene.light().cast(surface.shape(), elevation, 0.0)?;
            casts.push((shadow, surface.weight()));
        }
    }
    Ok(casts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use crate::shape::Shape;

    /// A card of 60 x 40 with corners of 8, seen through `radius` pixels, on 100 x 80 pixels.
    pub(super) fn card(radius: f32) -> (Shadow, Grid) {
        let shape = Shape::rounded_rect(20.3, 20.6, 60.0, 40.0, 8.0).unwrap();
        on_grid(&shape, radius, [100, 80])
    }

    pub(super) fn on_grid(shape: &Shape, radius: f32, size: [u32; 2]) -> (Shadow, Grid) {
        let light = Light::directional([0.0, 0.0], radius).unwrap();
        (
            light.cast(shape, 1.0, 0.0).unwrap(),
            Grid::new([0.0, 0.0], size, 1.0).unwrap(),
        )
    }

    pub(super) fn drawn(technique: &dyn Technique, shadow: &Shadow, grid: &Grid) -> Vec<f32> {
        let mut densities = vec![9.0; grid.width() as usize * grid.height() as usize];
        technique
            .draw(shadow, grid, &mut densities, &mut Scratch::new())
            .unwrap();
        densities
    }

    /// How far a technique is from `exact`.
    pub(super) fn errors(technique: &dyn Technique, shadow: &Shadow, grid: &Grid) -> Errors {
        let exact = Shipping::new(Some(Method::Exact), Tolerance::ONE_LEVEL);
        Errors::between(
            &drawn(technique, shadow, grid),
            &drawn(&exact, shadow, grid),
        )
    }

    #[test]
    fn every_technique_draws_and_keeps_what_it_claims() {
        let mut claims = 0;
        for radius in [0.0, 2.0, 9.0] {
            let (shadow, grid) = card(radius);
            for technique in techniques().unwrap() {
                let densities = drawn(technique.as_ref(), &shadow, &grid);
                let (name, setting) = (technique.name(), setting(technique.as_ref()));
                assert!(
                    densities.iter().all(|d| (0.0..=1.0001).contains(d)),
                    "{name}, {setting}"
                );
                let errors = errors(technique.as_ref(), &shadow, &grid);
                println!(
                    "{name}, {setting}, r {radius}: {:.2} levels, rms {:.2}",
                    errors.max_levels, errors.rms_levels
                );
                if let Some(levels) = technique.claim().levels {
                    claims += 1;
                    assert!(
                        errors.max_levels <= levels,
                        "{name}, {setting}, r {radius}: {errors:?}"
                    );
                }
                // None is altogether wrong on a plain card.
                assert!(errors.rms_levels < 30.0, "{name}, {setting}, r {radius}");
                for parameter in technique.parameters() {
                    let possible = match parameter.value {
                        Value::Number {
                            value, min, max, ..
                        } => (min..=max).contains(&value),
                        Value::Choice { value, of } => of.contains(&value),
                    };
                    assert!(possible, "{name}: {parameter:?}");
                }
            }
        }
        assert!(claims > 0);
    }

    #[test]
    fn settings_are_told_apart() {
        let mut names: Vec<String> = settings()
            .unwrap()
            .iter()
            .map(|technique| format!("{}: {}", technique.name(), setting(technique.as_ref())))
            .collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count, "{names:#?}");
    }

    #[test]
    fn what_is_no_number_is_as_wrong_as_can_be() {
        let errors = Errors::between(&[f32::NAN, 0.5], &[0.0, 0.5]);
        assert_eq!(errors.max_levels, 255.0);
    }
}
