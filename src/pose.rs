//! Pose: where a flat shape is in space.

use glam::{DVec2, DVec3};
use libm::{cos, sin};

use crate::error::{self, Error, Result};
use crate::outline::{Winding, resolve};
use crate::path::FillRule;
use crate::shadow::Shadow;
use crate::shape::Shape;
use crate::tilted::{Circle, TiltedShadow};

/// A flat shape's place in space: an affine map of its own plane. The point (x, y) of the shape is at
/// `origin + x * along_x + y * along_y`, with z the elevation above the ground, all in scene units.
///
/// ```
/// use penumbral::{Light, Pose, Shape};
///
/// // A card at elevation 80 that has turned by a third of a right angle about its own middle line.
/// let card = Shape::rounded_rect(100.0, 100.0, 160.0, 120.0, 8.0)?;
/// let pose = Pose::turned(80.0, [180.0, 160.0], [0.0, 1.0], core::f32::consts::FRAC_PI_6)?;
/// let shadow = Light::android(360.0)?.cast_posed(&card, &pose, 0.0)?;
/// assert!(shadow.density_at([180.0, 180.0]) > 0.3);
/// # Ok::<(), penumbral::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    origin: DVec3,
    along_x: DVec3,
    along_y: DVec3,
}

impl Pose {
    /// Any affine map of the plane into space.
    ///
    /// # Errors
    /// A number that is not finite or passes [`MAX_COORDINATE`](crate::MAX_COORDINATE).
    pub fn new(origin: [f32; 3], along_x: [f32; 3], along_y: [f32; 3]) -> Result<Self> {
        let vector = |field, v: [f32; 3]| -> Result<DVec3> {
            for number in v {
                error::coordinate(field, f64::from(number))?;
            }
            Ok(DVec3::from_array(v.map(f64::from)))
        };
        Ok(Self {
            origin: vector("pose.origin", origin)?,
            along_x: vector("pose.along_x", along_x)?,
            along_y: vector("pose.along_y", along_y)?,
        })
    }

    /// A shape at `elevation`, turned by `angle` (radians) about the line through `pivot` (x, y) in the direction `axis`
    /// (x, y; of any length): what lies to the line's left where y points up, to its right on a screen, rises.
    ///
    /// # Errors
    /// A number that is not finite or passes [`MAX_COORDINATE`](crate::MAX_COORDINATE), an axis without a direction.
    pub fn turned(elevation: f32, pivot: [f32; 2], axis: [f32; 2], angle: f32) -> Result<Self> {
        let elevation = error::coordinate("elevation", f64::from(elevation))?;
        let point = |field, v: [f32; 2]| -> Result<DVec2> {
            Ok(DVec2::new(
                error::coordinate(field, f64::from(v[0]))?,
                error::coordinate(field, f64::from(v[1]))?,
            ))
        };
        let pivot = point("pose.pivot", pivot)?;
        let axis = point("pose.axis", axis)?;
        error::positive("length of pose.axis", axis.length())?;
        let angle = f64::from(angle);
        if !angle.is_finite() {
            return Err(Error::NotFinite {
                field: "pose.angle",
                value: angle,
            });
        }
        let axis = axis.normalize();
        let across = axis.perp();
        let (sin, cos) = (sin(angle), cos(angle));
        let turn = |v: DVec2| {
            let flat = axis * v.dot(axis) + across * (v.dot(across) * cos);
            flat.extend(v.dot(across) * sin)
        };
        Ok(Self {
            origin: pivot.extend(elevation) - turn(pivot),
            along_x: turn(DVec2::X),
            along_y: turn(DVec2::Y),
        })
    }

    /// A rectangle (x, y, width, height) whose corners have these elevations, from the one of least x and y clockwise where y
    /// points down.
    ///
    /// # Errors
    /// Numbers that are not finite or pass [`MAX_COORDINATE`](crate::MAX_COORDINATE), a width or height not above 0,
    /// corners that are not of one plane.
    pub fn of_corners(rect: [f32; 4], elevations: [f32; 4]) -> Result<Self> {
        let [x, y, width, height] = rect.map(f64::from);
        error::coordinate("x", x)?;
        error::coordinate("y", y)?;
        error::positive("width", width)?;
        error::positive("height", height)?;
        let [a, b, c, d] = elevations.map(f64::from);
        for elevation in [a, b, c, d] {
            error::coordinate("elevation", elevation)?;
        }
        let bend = a + c - b - d;
        if bend.abs() > 1e-5 * (a.abs() + b.abs() + c.abs() + d.abs()) {
            return Err(Error::NotFlat { bend });
        }
        let (rise_x, rise_y) = ((b - a) / width, (d - a) / height);
        Ok(Self {
            origin: DVec3::new(0.0, 0.0, a - x * rise_x - y * rise_y),
            along_x: DVec3::new(1.0, 0.0, rise_x),
            along_y: DVec3::new(0.0, 1.0, rise_y),
        })
    }

    /// The same, higher by `height`.
    pub(crate) fn raised(&self, height: f64) -> Self {
        Self {
            origin: self.origin + DVec3::Z * height,
            ..*self
        }
    }

    /// What a shape covers seen from above, but for what is below the ground.
    pub(crate) fn cover(&self, shape: &Shape) -> Shadow {
        // Straight down, by a light that is a point.
        let loops = TiltedShadow::project(shape, self, 0.0..f64::INFINITY, |point| Circle {
            center: point.truncate(),
            scale: 1.0,
            radius: 0.0,
        });
        let polygons: Vec<Vec<DVec2>> = loops
            .loops
            .iter()
            .map(|circles| circles.iter().map(|circle| circle.center).collect())
            .collect();
        Shadow::of_outline(resolve(&polygons, Winding::Rule(FillRule::NonZero)))
    }

    /// Where a point of the shape is.
    pub(crate) fn place(&self, point: DVec2) -> DVec3 {
        self.origin + point.x * self.along_x + point.y * self.along_y
    }
}

#[cfg(test)]
mod tests {
    use core::f32::consts::{FRAC_PI_2, PI};

    use super::*;

    #[test]
    fn a_flip_goes_over_the_upright_card_to_its_mirror() {
        let at = |angle: f32, p: [f64; 2]| {
            Pose::turned(50.0, [10.0, 20.0], [0.0, 2.0], angle)
                .unwrap()
                .place(DVec2::from_array(p))
        };
        let near = |a: DVec3, b: [f64; 3]| (a - DVec3::from_array(b)).length() < 1e-5;
        assert!(near(at(0.0, [4.0, 7.0]), [4.0, 7.0, 50.0]));
        assert!(near(at(FRAC_PI_2, [4.0, 7.0]), [10.0, 7.0, 56.0]));
        assert!(near(at(PI, [4.0, 7.0]), [16.0, 7.0, 50.0]));
    }

    #[test]
    fn corners_must_be_of_one_plane() {
        let pose = Pose::of_corners([10.0, 20.0, 40.0, 30.0], [5.0, 9.0, 15.0, 11.0]).unwrap();
        assert_eq!(pose.place(DVec2::new(50.0, 50.0)).z, 15.0);
        assert!(matches!(
            Pose::of_corners([10.0, 20.0, 40.0, 30.0], [5.0, 9.0, 14.0, 11.0]),
            Err(Error::NotFlat { .. })
        ));
        assert!(Pose::turned(1.0, [0.0, 0.0], [0.0, 0.0], 1.0).is_err());
    }
}
