//! Detail on the flat part of a surface: texture, bumps, a frame of normal and tangent, and what it mirrors.

use glam::{DVec2, DVec3};
use libm::{cos, sin};

use super::tile::Tile;
use super::{Intensity, Lighting};
use crate::error::{self, Result};

/// The farthest that fibres turn, in radians.
pub(crate) const MOST_TURN: f64 = 1000.0;

/// Bumps: a table of heights that tilts the normal and leaves the surface flat (Blinn 1978).
#[derive(Debug, Clone, PartialEq)]
pub struct Bump {
    heights: Tile,
    depth: f64,
}

/// Brushed metal: besides the normal the tangent is perturbed, along which its fibres run (Kajiya 1985).
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    grain: Tile,
    depth: f64,
    angle: f64,
    twist: f64,
}

/// What is mirrored: an image on a plane above the surface, met by the reflected view ray.
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    image: Tile,
    height: f64,
    strength: f64,
}

impl Bump {
    /// Heights from 0 where the image is black to `depth` (scene units) where it is white.
    ///
    /// # Errors
    /// A depth that is not finite or passes [`MAX_COORDINATE`](crate::MAX_COORDINATE).
    pub fn new(heights: Tile, depth: f32) -> Result<Self> {
        Ok(Self {
            heights,
            depth: error::coordinate("bump.depth", f64::from(depth))?,
        })
    }
}

impl Frame {
    /// Fibres at an `angle` from the x axis towards y (radians). The grain's red is their height, up to `depth` (scene units);
    /// its green turns them by up to `twist` (radians) either way.
    ///
    /// # Errors
    /// A number that is not finite, a depth that passes [`MAX_COORDINATE`](crate::MAX_COORDINATE), an angle or a twist of over 1000.
    pub fn new(grain: Tile, depth: f32, angle: f32, twist: f32) -> Result<Self> {
        Ok(Self {
            grain,
            depth: error::coordinate("frame.depth", f64::from(depth))?,
            angle: error::within("frame.angle", f64::from(angle), -MOST_TURN, MOST_TURN)?,
            twist: error::within("frame.twist", f64::from(twist), -MOST_TURN, MOST_TURN)?,
        })
    }
}

impl Environment {
    /// An image `height` (scene units) above the surface, of which a `strength` (0 to 1) is mirrored.
    ///
    /// # Errors
    /// A height that is not above 0 or passes [`MAX_COORDINATE`](crate::MAX_COORDINATE), a strength out of range.
    pub fn new(image: Tile, height: f32, strength: f32) -> Result<Self> {
        Ok(Self {
            image,
            height: error::positive("environment.height", f64::from(height))?,
            strength: error::within("environment.strength", f64::from(strength), 0.0, 1.0)?,
        })
    }
}

/// All of a flat part's detail.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Detail {
    pub(super) texture: Option<Tile>,
    pub(super) bump: Option<Bump>,
    pub(super) frame: Option<Frame>,
    pub(super) environment: Option<Environment>,
}

impl Detail {
    /// The colour, 0 to 255, of a pixel of the flat part: its middle and side in scene units.
    pub(super) fn color(
        &self,
        fill: [u8; 3],
        middle: DVec2,
        side: f64,
        lighting: &Lighting,
    ) -> [u8; 3] {
        let mut fill = DVec3::from(fill.map(f64::from));
        let pixel = DVec2::splat(side);
        if let Some(texture) = &self.texture {
            let average = texture.average(middle, pixel);
            fill = fill * (1.0 - average.w) + average.truncate() * 255.0;
        }
        let mut slope = DVec2::ZERO;
        if let Some(bump) = &self.bump {
            slope += slope_of(&bump.heights, middle, side) * bump.depth;
        }
        if let Some(frame) = &self.frame {
            slope += slope_of(&frame.grain, middle, side) * frame.depth;
        }
        let normal = (-slope).extend(1.0).normalize();
        let point = middle.extend(0.0).to_array();
        let intensity = match &self.frame {
            Some(frame) => lighting.at_fibres(point, normal, frame.tangent(normal, middle, side)),
            None => lighting.at(point, normal.to_array()),
        };
        let lit = lit(fill, intensity);
        let mirrored = self.environment.as_ref().and_then(|environment| {
            let color = environment.color(normal, middle, side)?;
            Some(lit + (color - lit) * environment.strength)
        });
        mirrored
            .unwrap_or(lit)
            .to_array()
            .map(|channel| (channel + 0.5).clamp(0.0, 255.0) as u8)
    }
}

fn lit(fill: DVec3, intensity: Intensity) -> DVec3 {
    fill * f64::from(intensity.body) + 255.0 * f64::from(intensity.gloss)
}

/// The slope of the red channel, per scene unit: from the averages over squares to either side, no smaller than a pixel, and than a
/// texel, over which heights are then linear.
fn slope_of(tile: &Tile, middle: DVec2, side: f64) -> DVec2 {
    let size = tile.texel().max(DVec2::splat(side));
    let along = |way: DVec2, length: f64| {
        let [after, before] =
            [way, -way].map(|way| tile.average(middle + way * (length / 2.0), size).x);
        (after - before) / length
    };
    DVec2::new(along(DVec2::X, size.x), along(DVec2::Y, size.y))
}

impl Frame {
    /// The tangent, perpendicular to the normal.
    fn tangent(&self, normal: DVec3, middle: DVec2, side: f64) -> DVec3 {
        let size = self.grain.texel().max(DVec2::splat(side));
        let turn = 2.0 * self.grain.average(middle, size).y - 1.0;
        let angle = self.angle + self.twist * turn;
        let along = DVec2::new(cos(angle), sin(angle)).extend(0.0);
        (along - normal * along.dot(normal)).normalize_or(DVec3::X)
    }
}

impl Environment {
    /// The colour that the view ray meets, reflected to 2 N (N·V) - V: none where it goes down. The pixel is as large there as
    /// here: what bumps spread is a mean over less than they show.
    fn color(&self, normal: DVec3, middle: DVec2, side: f64) -> Option<DVec3> {
        let reflected = normal * (2.0 * normal.z) - DVec3::Z;
        if reflected.z <= 0.0 {
            return None;
        }
        let met = middle + reflected.truncate() * (self.height / reflected.z);
        let size = self.image.texel().max(DVec2::splat(side));
        let average = self.image.average(met, size);
        (average.w > 0.0).then(|| average.truncate() * (255.0 / average.w))
    }
}
