//! The rim: how a surface falls from its flat part to its outline.

use glam::{DVec2, DVec3};
use libm::{atan2, cos, sin};

use core::f64::consts::{FRAC_PI_2, PI};

use crate::error::{self, Result};

/// A rim along a surface's outline, inside of it: over `width` it falls by `height` below the flat part (scene units both).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rim {
    width: f64,
    height: f64,
    profile: RimProfile,
    steps: u32,
}

/// The rim's section.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum RimProfile {
    /// A plane slope, with an edge at either end.
    Bevel,
    /// A quarter of an ellipse: level where it meets the flat part, upright at the outline.
    #[default]
    QuarterRound,
    /// Half a wave of a cosine, level at either end.
    Cosine,
}

impl Rim {
    /// A rim of `width` and `height`, scene units, in 24 steps.
    ///
    /// # Errors
    /// A width or height that is not finite, not above 0 or passes [`MAX_COORDINATE`](crate::MAX_COORDINATE).
    pub fn new(width: f32, height: f32, profile: RimProfile) -> Result<Self> {
        Ok(Self {
            width: error::positive("rim.width", f64::from(width))?,
            height: error::positive("rim.height", f64::from(height))?,
            profile,
            steps: 24,
        })
    }

    /// The same as a mesh of so many rows of faces, 1 to 64: a quarter round turns by 90 degrees over the steps.
    ///
    /// # Errors
    /// Another number of steps.
    pub fn with_steps(mut self, steps: u32) -> Result<Self> {
        error::within("rim.steps", f64::from(steps), 1.0, 64.0)?;
        self.steps = steps;
        Ok(self)
    }

    /// The width, scene units.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.width
    }

    /// The height, scene units.
    #[must_use]
    pub fn height(&self) -> f64 {
        self.height
    }

    /// The depths of the mesh's rings: 0 at the outline, 1 at the flat part. Those of a quarter round turn by one angle each.
    pub(super) fn rings(&self) -> Vec<f64> {
        let share = |step: u32| f64::from(step) / f64::from(self.steps);
        let depth = |step| match self.profile {
            RimProfile::QuarterRound => 1.0 - cos(FRAC_PI_2 * share(step)),
            RimProfile::Bevel | RimProfile::Cosine => share(step),
        };
        let inner = (1..self.steps).map(depth);
        [0.0].into_iter().chain(inner).chain([1.0]).collect()
    }

    /// How far above the flat part a point is, at most 0, scene units.
    pub(super) fn rise(&self, depth: f64) -> f64 {
        let depth = depth.clamp(0.0, 1.0);
        let share = match self.profile {
            RimProfile::Bevel => depth,
            RimProfile::QuarterRound => (depth * (2.0 - depth)).sqrt(),
            RimProfile::Cosine => (1.0 - cos(PI * depth)) / 2.0,
        };
        self.height * (share - 1.0)
    }

    /// The unit normal where `outwards` is the way to the nearest point of the outline: up from the flat part on.
    pub(super) fn normal(&self, depth: f64, outwards: DVec2) -> DVec3 {
        if depth >= 1.0 {
            return DVec3::Z;
        }
        let depth = depth.max(0.0);
        let (across, up) = match self.profile {
            RimProfile::Bevel => (self.height, self.width),
            // The ellipse's gradient.
            RimProfile::QuarterRound => (
                self.height * (1.0 - depth),
                self.width * (depth * (2.0 - depth)).sqrt(),
            ),
            RimProfile::Cosine => (FRAC_PI_2 * self.height * sin(PI * depth), self.width),
        };
        let length = (across * across + up * up).sqrt();
        (outwards * (across / length)).extend(up / length)
    }

    /// The largest angle between the normals of one ring and the next, radians.
    pub(super) fn turn(&self) -> f64 {
        if self.profile == RimProfile::Bevel {
            return 0.0;
        }
        let angles: Vec<f64> = self
            .rings()
            .iter()
            .map(|&depth| {
                let normal = self.normal(depth, DVec2::X);
                atan2(normal.x, normal.z)
            })
            .collect();
        let turns = angles.windows(2).map(|pair| (pair[0] - pair[1]).abs());
        turns.fold(0.0, f64::max)
    }
}
