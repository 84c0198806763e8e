//! Composing layered surfaces: who casts on whom, and how much.
//!
//! From the ground up each surface is a receiver: onto it fall the shadows of every surface above it, each projected on
//! the receiver's own elevation. Opaque casters of one elevation are united before they are cast; what casters of different
//! elevations hide together is the union of what each hides of the light's disc ([`fusion`]).

mod caster;
mod damage;
mod fusion;
mod ground;
mod nearby;
#[cfg(feature = "raster")]
mod raster;
mod svg;

use glam::DVec2;

pub(crate) use self::fusion::Fusion;
pub use self::fusion::Overlap;
pub use self::ground::{DensityMap, GroundShadows};
#[cfg(feature = "raster")]
pub use self::raster::Renderer;

use self::caster::{AnyShadow, Cast};
use self::nearby::Nearby;
use crate::density::alpha::AlphaShadow;
use crate::error::Result;
use crate::light::{Light, Projection};
use crate::pose::Pose;
use crate::scene::{Form, Scene, Surface};
use crate::shadow::Shadow;
use crate::shape::Shape;
use crate::tilted::TiltedShadow;

/// What a receiver is: its elevation and the box it lies in (scene units).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Receiver {
    pub(crate) elevation: f32,
    pub(crate) min: DVec2,
    pub(crate) max: DVec2,
}

impl Receiver {
    /// The ground, as far as the canvas shows it.
    pub(crate) fn ground(scene: &Scene) -> Self {
        Self {
            elevation: 0.0,
            min: DVec2::ZERO,
            max: DVec2::from(scene.canvas().map(f64::from)),
        }
    }

    /// A surface, as far as the canvas shows it, or none where that is nothing. Seen from above a tilted surface is a receiver
    /// of no one elevation: no shadow falls on it.
    pub(crate) fn surface(scene: &Scene, surface: &Surface) -> Option<Self> {
        let (min, max) = surface.hull()?;
        let ground = Self::ground(scene);
        let (min, max) = (min.max(ground.min), max.min(ground.max));
        (min.cmplt(max).all()).then_some(Self {
            elevation: surface.elevation(),
            min,
            max,
        })
    }

    fn meets(&self, surface: &Surface, projection: &Projection) -> bool {
        surface.hull().is_some_and(|hull| {
            let (min, max) = projection.shaded(hull);
            min.cmple(self.max).all() && max.cmpge(self.min).all()
        })
    }
}

/// What casts shadows: one of the lights, or the ambience. An ambient shadow is the caster's own outline, blurred by half its
/// height over the receiver, and the weaker the higher it is, as Android has it.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Source {
    Light(Light),
    Ambience,
}

impl Source {
    /// The scene's sources, each with the strength of what it casts.
    pub(crate) fn of(scene: &Scene) -> Vec<(Self, f32)> {
        let lights = scene.lights().map(|(light, key)| (Self::Light(light), key));
        let ambience = (Self::Ambience, scene.tone().ambient());
        lights
            .chain([ambience])
            .filter(|(_, strength)| *strength > 0.0)
            .collect()
    }

    fn projection(&self, elevation: f32, receiver: f32) -> Result<Projection> {
        match self {
            Self::Light(light) => light.projection(elevation, receiver),
            Self::Ambience => {
                let height = f64::from(elevation) - f64::from(receiver);
                Ok(Projection::in_place(height / 2.0))
            }
        }
    }

    /// What of the source's strength is left to a caster's shadow: ambience fades over 128 units, as Android's does.
    fn strength(&self, elevation: f32, receiver: f32) -> f64 {
        match self {
            Self::Light(_) => 1.0,
            Self::Ambience => {
                let height = f64::from(elevation) - f64::from(receiver);
                1.0 / (1.0 + height.max(0.0) / 128.0)
            }
        }
    }

    fn cast_posed(&self, surface: &Surface, pose: &Pose, receiver: f32) -> Result<TiltedShadow> {
        match self {
            Self::Light(light) => light.cast_posed(surface.shape(), pose, receiver),
            // A circle as wide as half its point's height.
            Self::Ambience => {
                Light::directional([0.0, 0.0], 0.5)?.cast_posed(surface.shape(), pose, receiver)
            }
        }
    }

    /// A box that holds the surface and its shadows on every receiver below it. Both ends of a shadow's way from the caster to the
    /// ground are in it, and between them it moves and grows evenly.
    pub(crate) fn reach(&self, surface: &Surface) -> Result<Option<(DVec2, DVec2)>> {
        let Some((min, max)) = surface.hull() else {
            return Ok(None);
        };
        let on_ground = match surface.form() {
            Form::Posed(pose) => self.cast_posed(surface, pose, 0.0)?.hull(),
            Form::Level | Form::Image(..) => {
                let projection = self.projection(surface.elevation(), 0.0)?;
                Some(projection.shaded((min, max)))
            }
        };
        Ok(Some(on_ground.map_or((min, max), |ground| {
            (min.min(ground.0), max.max(ground.1))
        })))
    }
}

/// A scene's surfaces in their order, ready to be asked who casts on whom.
#[derive(Debug)]
pub(crate) struct Stage<'a> {
    /// From the lowest to the highest, those of one elevation in the order they were added.
    pub(crate) order: Vec<&'a Surface>,
    /// For each source what casts where.
    sources: Vec<(Source, f32, Nearby)>,
}

impl<'a> Stage<'a> {
    pub(crate) fn new(scene: &'a Scene) -> Result<Self> {
        Self::lit_by(scene, Source::of(scene))
    }

    /// Under the first light alone, of strength 1.
    pub(crate) fn of_first_light(scene: &'a Scene) -> Result<Self> {
        Self::lit_by(scene, vec![(Source::Light(*scene.light()), 1.0)])
    }

    fn lit_by(scene: &'a Scene, sources: Vec<(Source, f32)>) -> Result<Self> {
        let order: Vec<&Surface> = scene
            .paint_order()
            .into_iter()
            .map(|index| &scene.surfaces()[index])
            .collect();
        let sources = sources.into_iter().map(|(source, strength)| {
            let reaches = order.iter().map(|surface| {
                if surface.casts() {
                    source.reach(surface)
                } else {
                    Ok(None)
                }
            });
            let reaches: Result<Vec<_>> = reaches.collect();
            Ok((
                source,
                strength,
                Nearby::new(&Receiver::ground(scene), &reaches?),
            ))
        });
        Ok(Self {
            sources: sources.collect::<Result<_>>()?,
            order,
        })
    }

    /// The shadows on a receiver, for each source that casts any, and the source's strength.
    pub(crate) fn casts(&self, receiver: &Receiver) -> Result<Vec<(f32, Vec<Cast>)>> {
        let of_sources = self.sources.iter().map(|(source, strength, nearby)| {
            let casters = self.casters(source, nearby, receiver)?;
            let casts: Result<Vec<Cast>> = casters
                .iter()
                .filter_map(|surfaces| cast(surfaces, source, receiver.elevation).transpose())
                .collect();
            Ok((*strength, casts?))
        });
        let of_sources: Result<Vec<_>> = of_sources.collect();
        Ok(of_sources?
            .into_iter()
            .filter(|(_, casts)| !casts.is_empty())
            .collect())
    }

    /// Whether any shadow may reach a receiver. No shadow is built for it.
    pub(crate) fn is_shaded(&self, receiver: &Receiver) -> Result<bool> {
        for (source, _, nearby) in &self.sources {
            if !self.casters(source, nearby, receiver)?.is_empty() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The surfaces that cast on a receiver, those of one shadow together.
    fn casters(
        &self,
        source: &Source,
        nearby: &Nearby,
        receiver: &Receiver,
    ) -> Result<Vec<Vec<&'a Surface>>> {
        let mut casters = Vec::new();
        let (posed, level): (Vec<&Surface>, Vec<&Surface>) = nearby
            .of(receiver)
            .into_iter()
            .map(|index| self.order[index])
            .partition(|surface| matches!(surface.form(), Form::Posed(_)));
        let above: Vec<&Surface> = level
            .into_iter()
            .filter(|surface| surface.elevation() > receiver.elevation)
            .collect();
        for level in above.chunk_by(|a, b| a.elevation() == b.elevation()) {
            let projection = source.projection(level[0].elevation(), receiver.elevation)?;
            let meeting = level
                .iter()
                .copied()
                .filter(|surface| receiver.meets(surface, &projection));
            let (united, single): (Vec<&Surface>, Vec<&Surface>) =
                meeting.partition(|surface| surface.is_united());
            if !united.is_empty() {
                casters.push(united);
            }
            casters.extend(single.into_iter().map(|surface| vec![surface]));
        }
        let is_above = |surface: &&Surface| surface.highest() > f64::from(receiver.elevation);
        let posed = posed.into_iter().filter(is_above);
        casters.extend(posed.map(|surface| vec![surface]));
        Ok(casters)
    }
}

/// The one shadow on a receiver of surfaces that are alike: several of them are level and opaque, of one elevation.
fn cast(surfaces: &[&Surface], source: &Source, receiver: f32) -> Result<Option<Cast>> {
    let Some(first) = surfaces.first() else {
        return Ok(None);
    };
    let elevation = first.elevation();
    let projection = || source.projection(elevation, receiver);
    let shadow = match first.form() {
        Form::Posed(pose) => AnyShadow::Tilted(source.cast_posed(first, pose, receiver)?),
        Form::Image(image, place) => {
            AnyShadow::Alpha(AlphaShadow::project(image, place, &projection()?))
        }
        Form::Level => {
            let shapes: Vec<&Shape> = surfaces.iter().map(|surface| surface.shape()).collect();
            AnyShadow::Level(Shadow::project(&shapes, &projection()?))
        }
    };
    Ok(Some(Cast {
        shadow,
        strength: source.strength(elevation, receiver),
        opacity: f64::from(first.weight()),
    }))
}
