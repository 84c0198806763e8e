//! Composing layered surfaces: who casts on whom, and how much.
//!
//! From the ground up each surface is a receiver: onto it fall the shadows of every surface above it, each projected on
//! the receiver's own elevation. Opaque casters of one elevation are united before they are cast; what casters of different
//! elevations hide together is the union of what each hides of the light's disc ([`fusion`]).

mod fusion;
mod ground;
#[cfg(feature = "raster")]
mod raster;
mod svg;

pub use ground::{DensityMap, GroundShadows};
#[cfg(feature = "raster")]
pub use raster::Renderer;

use glam::DVec2;

use self::fusion::Cast;
pub(crate) use self::fusion::Fusion;

use crate::error::Result;
use crate::light::Projection;
use crate::scene::{Scene, Surface};
use crate::shadow::Shadow;
use crate::shape::Shape;

/// What a receiver is: its elevation and the box it lies in (scene units).
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

    /// A surface, as far as the canvas shows it, or none where that is nothing.
    pub(crate) fn surface(scene: &Scene, surface: &Surface) -> Option<Self> {
        let (min, max) = surface.shape().hull()?;
        let ground = Self::ground(scene);
        let (min, max) = (min.max(ground.min), max.min(ground.max));
        (min.cmplt(max).all()).then_some(Self {
            elevation: surface.elevation(),
            min,
            max,
        })
    }

    fn meets(&self, shape: &Shape, projection: &Projection) -> bool {
        let Some((min, max)) = shape.hull() else {
            return false;
        };
        let min = min * projection.scale + projection.offset - projection.radius;
        let max = max * projection.scale + projection.offset + projection.radius;
        min.cmple(self.max).all() && max.cmpge(self.min).all()
    }
}

/// Surfaces that cast one shadow on a receiver.
struct Casters<'a> {
    shapes: Vec<&'a Shape>,
    projection: Projection,
    strength: f64,
    opacity: f64,
}

impl Casters<'_> {
    fn cast(&self) -> Cast {
        Cast {
            shadow: Shadow::project(&self.shapes, &self.projection),
            strength: self.strength,
            opacity: self.opacity,
        }
    }
}

/// The shadows of the light on a receiver. What they hold back is not yet weakened by the tone.
pub(crate) fn key_casts(scene: &Scene, receiver: &Receiver) -> Result<Vec<Cast>> {
    Ok(key_casters(scene, receiver)?
        .iter()
        .map(Casters::cast)
        .collect())
}

/// The ambient shadows on a receiver: the caster's own outline, blurred by half its height over the receiver, and the
/// weaker the higher it is, as Android has them. Their weight holds the tone's strength.
pub(crate) fn ambient_casts(scene: &Scene, receiver: &Receiver) -> Result<Vec<Cast>> {
    Ok(ambient_casters(scene, receiver)?
        .iter()
        .map(Casters::cast)
        .collect())
}

/// Whether any shadow may reach a receiver. No shadow is built for it.
pub(crate) fn is_shaded(scene: &Scene, receiver: &Receiver) -> Result<bool> {
    Ok(!key_casters(scene, receiver)?.is_empty() || !ambient_casters(scene, receiver)?.is_empty())
}

fn key_casters<'a>(scene: &'a Scene, receiver: &Receiver) -> Result<Vec<Casters<'a>>> {
    casters(scene, receiver, |elevation| {
        Ok((
            scene.light().projection(elevation, receiver.elevation)?,
            1.0,
        ))
    })
}

fn ambient_casters<'a>(scene: &'a Scene, receiver: &Receiver) -> Result<Vec<Casters<'a>>> {
    let tone = scene.tone();
    if tone.ambient() == 0.0 {
        return Ok(Vec::new());
    }
    casters(scene, receiver, |elevation| {
        let height = f64::from(elevation) - f64::from(receiver.elevation);
        Ok((Projection::in_place(height / 2.0), tone.ambient_at(height)))
    })
}

fn casters<'a>(
    scene: &'a Scene,
    receiver: &Receiver,
    project: impl Fn(f32) -> Result<(Projection, f64)>,
) -> Result<Vec<Casters<'a>>> {
    let mut casters = Vec::new();
    let above: Vec<&Surface> = scene
        .paint_order()
        .into_iter()
        .map(|index| &scene.surfaces()[index])
        .filter(|surface| surface.elevation() > receiver.elevation && surface.weight() > 0.0)
        .collect();
    for level in above.chunk_by(|a, b| a.elevation() == b.elevation()) {
        let (projection, strength) = project(level[0].elevation())?;
        let (opaque, translucent): (Vec<&Surface>, Vec<&Surface>) = level
            .iter()
            .filter(|surface| receiver.meets(surface.shape(), &projection))
            .partition(|surface| surface.is_opaque());
        let shapes: Vec<&Shape> = opaque.iter().map(|surface| surface.shape()).collect();
        if !shapes.is_empty() {
            casters.push(Casters {
                shapes,
                projection,
                strength,
                opacity: 1.0,
            });
        }
        casters.extend(translucent.into_iter().map(|surface| Casters {
            shapes: vec![surface.shape()],
            projection,
            strength,
            opacity: f64::from(surface.weight()),
        }));
    }
    Ok(casters)
}
