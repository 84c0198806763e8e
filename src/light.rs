//! The light, and the projection of one plane on another.

use core::borrow::Borrow;

#[cfg(feature = "finish")]
use glam::DVec4;
use glam::{DAffine2, DMat2, DVec2};

use crate::error::{self, Error, MAX_COORDINATE, Result};
use crate::pose::Pose;
use crate::shadow::Shadow;
use crate::shape::Shape;
use crate::tilted::{Circle, LEAST_LIGHT, TiltedShadow};

/// A uniform disc parallel to the ground, or the same disc moved away to infinity.
///
/// ```
/// use penumbral::{Light, Shape};
///
/// // Android's light over a phone 411 units wide.
/// let light = Light::android(411.0)?;
/// let card = Shape::rounded_rect(16.0, 100.0, 379.0, 120.0, 12.0)?;
/// let shadow = light.cast(&card, 8.0, 0.0)?;
/// assert!((shadow.radius() - 800.0 * 8.0 / 592.0).abs() < 1e-9);
/// assert_eq!(shadow.density_at([205.0, 160.0]), 1.0);
/// # Ok::<(), penumbral::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Disc { center: DVec2, z: f64, radius: f64 },
    Directional { offset: DVec2, spread: f64 },
}

/// How a point of a plane at the caster's elevation is seen on the receiver: as a circle.
///
/// `center = scale * point + offset`, for a disc `scale = (H - g) / (H - h)` and
/// `radius = R (h - g) / (H - h)` (Soler & Sillion 1998), with the light at height `H`, the caster at `h`, the
/// receiver at `g`; all in scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Projection {
    pub(crate) scale: f64,
    pub(crate) offset: DVec2,
    pub(crate) radius: f64,
}

impl Projection {
    /// What leaves every point where it is: the outline of an ambient shadow, and of a surface itself.
    pub(crate) fn in_place(radius: f64) -> Self {
        Self {
            scale: 1.0,
            offset: DVec2::ZERO,
            radius,
        }
    }

    /// Refuses a shape at `elevation` whose shadow would pass [`MAX_COORDINATE`].
    pub(crate) fn check_reach(&self, shape: &Shape, elevation: f32) -> Result<()> {
        let reach = shape.hull().map_or(0.0, |(min, max)| {
            let far = |p: DVec2| (p * self.scale + self.offset).abs().max_element();
            far(min).max(far(max)) + self.radius
        });
        if reach > MAX_COORDINATE {
            return Err(Error::ShadowTooLarge {
                elevation: f64::from(elevation),
                extent: reach,
            });
        }
        Ok(())
    }

    /// The box that the shadow of a box of the caster's plane lies in.
    pub(crate) fn shaded(&self, (min, max): (DVec2, DVec2)) -> (DVec2, DVec2) {
        let place = |p: DVec2| p * self.scale + self.offset;
        (place(min) - self.radius, place(max) + self.radius)
    }

    pub(crate) fn affine(&self) -> DAffine2 {
        DAffine2::from_mat2_translation(DMat2::from_diagonal(DVec2::splat(self.scale)), self.offset)
    }
}

impl Light {
    /// A disc of `radius` about `center` (x, y, z), all in scene units. Radius 0 is a point: shadows are hard and
    /// antialiased.
    ///
    /// # Errors
    /// A number that is not finite or passes [`MAX_COORDINATE`], a negative radius, z not above 0.
    pub fn new(center: [f32; 3], radius: f32) -> Result<Self> {
        let [x, y, z] = center.map(f64::from);
        Ok(Self {
            kind: Kind::Disc {
                center: DVec2::new(
                    error::coordinate("light.x", x)?,
                    error::coordinate("light.y", y)?,
                ),
                z: error::positive("light.z", z)?,
                radius: error::length("light.radius", f64::from(radius))?,
            },
        })
    }

    /// A light at infinity: each unit of height moves a shadow by `offset` (x, y) and widens its penumbra radius by
    /// `spread`. Shadows look the same wherever the caster is.
    ///
    /// # Errors
    /// A number that is not finite or passes 1000 in magnitude, a negative spread.
    pub fn directional(offset: [f32; 2], spread: f32) -> Result<Self> {
        const STEEPEST: f64 = 1000.0;
        let [x, y] = offset.map(f64::from);
        Ok(Self {
            kind: Kind::Directional {
                offset: DVec2::new(
                    error::within("light.offset.x", x, -STEEPEST, STEEPEST)?,
                    error::within("light.offset.y", y, -STEEPEST, STEEPEST)?,
                ),
                spread: error::within("light.spread", f64::from(spread), 0.0, STEEPEST)?,
            },
        })
    }

    /// Android's light for a window `width` units wide: above the middle of its upper edge, z 600, radius 800
    /// (AOSP, `core/res/res/values/dimens.xml`). It goes with [`Tone::ANDROID`](crate::Tone::ANDROID).
    ///
    /// # Errors
    /// A width that is not finite, not above 0 or passes [`MAX_COORDINATE`].
    pub fn android(width: f32) -> Result<Self> {
        error::positive("width", f64::from(width))?;
        Self::new([width / 2.0, 0.0, 600.0], 800.0)
    }

    /// Flutter's light: directional, (0, -1, 1), a penumbra radius of 800/600 per unit of height. It goes with
    /// [`Tone::FLUTTER`](crate::Tone::FLUTTER).
    #[must_use]
    pub fn flutter() -> Self {
        Self {
            kind: Kind::Directional {
                offset: DVec2::new(0.0, 1.0),
                spread: 800.0 / 600.0,
            },
        }
    }

    /// The shadow of `shape` at `elevation` on the plane at elevation `receiver`, both in scene units. At the
    /// receiver's elevation it is empty.
    ///
    /// # Errors
    /// A number that is not finite or passes [`MAX_COORDINATE`], a caster at or above the light or below its
    /// receiver, and a caster so near the light that its shadow passes [`MAX_COORDINATE`].
    pub fn cast(&self, shape: &Shape, elevation: f32, receiver: f32) -> Result<Shadow> {
        self.cast_all(core::slice::from_ref(shape), elevation, receiver)
    }

    /// The one shadow of several shapes at one `elevation`, united before they are cast: neither a seam where they
    /// abut nor a darker part where they overlap.
    ///
    /// # Errors
    /// As [`Light::cast`].
    pub fn cast_all<S: Borrow<Shape>>(
        &self,
        shapes: &[S],
        elevation: f32,
        receiver: f32,
    ) -> Result<Shadow> {
        let projection = self.projection(elevation, receiver)?;
        for shape in shapes {
            projection.check_reach(shape.borrow(), elevation)?;
        }
        if elevation == receiver {
            return Ok(Shadow::empty());
        }
        Ok(Shadow::project(shapes, &projection))
    }

    /// The shadow of `shape` in a pose of its own on the plane at elevation `receiver` (scene units). What lies below the
    /// receiver or above the light hides nothing, and may be all of it.
    ///
    /// # Errors
    /// A receiver that is not finite, passes [`MAX_COORDINATE`], or is not below the light.
    pub fn cast_posed(&self, shape: &Shape, pose: &Pose, receiver: f32) -> Result<TiltedShadow> {
        let g = error::coordinate("receiver", f64::from(receiver))?;
        match self.kind {
            Kind::Disc { center, z, radius } => {
                if g >= z {
                    return Err(Error::ReceiverNotBelowLight {
                        receiver: g,
                        light_z: z,
                    });
                }
                let radius = radius.max(z * LEAST_LIGHT);
                Ok(TiltedShadow::project(shape, pose, g..z, |point| Circle {
                    center: (z - g) * (point.truncate() - center) + (z - point.z) * center,
                    scale: z - point.z,
                    radius: radius * (point.z - g),
                }))
            }
            Kind::Directional { offset, spread } => {
                let spread = spread.max(LEAST_LIGHT);
                let heights = g..f64::INFINITY;
                Ok(TiltedShadow::project(shape, pose, heights, |point| {
                    Circle {
                        center: point.truncate() + offset * (point.z - g),
                        scale: 1.0,
                        radius: spread * (point.z - g),
                    }
                }))
            }
        }
    }

    /// By how much an outline is larger than its caster at `elevation`, seen on the plane at elevation `receiver`.
    ///
    /// # Errors
    /// As [`Light::cast`].
    pub fn scale(&self, elevation: f32, receiver: f32) -> Result<f64> {
        Ok(self.projection(elevation, receiver)?.scale)
    }

    /// A point of the disc, `at` its centre plus so many radii, over a plane at an elevation: homogeneous, so that a light at
    /// infinity is a direction, with 0 for w.
    #[cfg(feature = "finish")]
    pub(crate) fn point(&self, at: DVec2, elevation: f64) -> DVec4 {
        match self.kind {
            Kind::Disc { center, z, radius } => {
                (center + at * radius).extend(z - elevation).extend(1.0)
            }
            Kind::Directional { offset, spread } => (at * spread - offset).extend(1.0).extend(0.0),
        }
    }

    pub(crate) fn projection(&self, elevation: f32, receiver: f32) -> Result<Projection> {
        let h = error::coordinate("elevation", f64::from(elevation))?;
        let g = error::coordinate("receiver", f64::from(receiver))?;
        if h < g {
            return Err(Error::CasterBelowReceiver {
                elevation: h,
                receiver: g,
            });
        }
        match self.kind {
            Kind::Disc { center, z, radius } => {
                if h >= z {
                    return Err(Error::CasterNotBelowLight {
                        elevation: h,
                        light_z: z,
                    });
                }
                let scale = (z - g) / (z - h);
                Ok(Projection {
                    scale,
                    offset: center - scale * center,
                    radius: radius * (h - g) / (z - h),
                })
            }
            Kind::Directional { offset, spread } => Ok(Projection {
                scale: 1.0,
                offset: offset * (h - g),
                radius: spread * (h - g),
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projection_follows_similar_triangles() {
        let light = Light::new([100.0, 50.0, 600.0], 800.0).unwrap();
        let p = light.projection(8.0, 2.0).unwrap();
        assert!((p.scale - 598.0 / 592.0).abs() < 1e-15);
        assert!((p.radius - 800.0 * 6.0 / 592.0).abs() < 1e-12);
        // The point under the light stays under it.
        let under = p.scale * DVec2::new(100.0, 50.0) + p.offset;
        assert!((under - DVec2::new(100.0, 50.0)).length() < 1e-12);
    }

    #[test]
    fn directional_is_the_far_limit_of_a_disc() {
        // A disc at z with its offset and radius grown with z tends to the directional light.
        let z = 8.0e6;
        let disc = Light::new([0.0, -z, z], z)
            .unwrap()
            .projection(8.0, 0.0)
            .unwrap();
        let far = Light::directional([0.0, 1.0], 1.0)
            .unwrap()
            .projection(8.0, 0.0)
            .unwrap();
        assert!((disc.scale - far.scale).abs() < 1e-5);
        assert!((disc.offset - far.offset).length() < 1e-4);
        assert!((disc.radius - far.radius).abs() < 1e-4);
    }

    #[test]
    fn bad_planes_are_refused() {
        let light = Light::new([0.0, 0.0, 600.0], 800.0).unwrap();
        assert!(matches!(
            light.projection(600.0, 0.0),
            Err(Error::CasterNotBelowLight { .. })
        ));
        assert!(matches!(
            light.projection(1.0, 2.0),
            Err(Error::CasterBelowReceiver { .. })
        ));
        assert!(matches!(
            light.projection(f32::NAN, 0.0),
            Err(Error::NotFinite { .. })
        ));
        assert!(matches!(
            Light::new([0.0, 0.0, 0.0], 1.0),
            Err(Error::NotPositive { .. })
        ));
        assert!(matches!(
            Light::new([0.0, 0.0, 1.0], -1.0),
            Err(Error::OutOfRange { .. })
        ));
        assert!(matches!(
            Light::new([1e9, 0.0, 1.0], 1.0),
            Err(Error::OutOfRange { .. })
        ));
    }
}
