//! What was wrong with an input, where, and what to do about it.

use core::fmt;

/// Coordinates, sizes, radii and elevations may not pass this magnitude, in scene units: 2^24, where an
/// `f32` stops telling one unit from the next.
pub const MAX_COORDINATE: f64 = 16_777_216.0;

/// A picture may not have more pixels than this (8192 x 4096, a little over 8K UHD): 128 MiB.
pub const MAX_PIXELS: u64 = 1 << 25;

/// A path may not have more segments, and a polygon not more points, than this.
pub const MAX_SEGMENTS: usize = 1 << 20;

/// A scene file may not be longer than this, in bytes: a path of [`MAX_SEGMENTS`] with all its digits fits twice.
pub const MAX_SCENE_LENGTH: usize = 1 << 26;

/// The result of whatever can refuse its input.
pub type Result<T, E = Error> = core::result::Result<T, E>;

/// Why an input was refused. Each names the field and the value.
///
/// | error | an input that causes it |
/// |---|---|
/// | [`NotFinite`](Error::NotFinite) | `Shape::rect(f32::NAN, 0.0, 1.0, 1.0)` |
/// | [`OutOfRange`](Error::OutOfRange) | `Shape::rect(1e9, 0.0, 1.0, 1.0)`, `Tolerance::levels(65.0)` |
/// | [`NotPositive`](Error::NotPositive) | `Shape::circle([0.0, 0.0], 0.0)`, a polygon without width or height |
/// | [`EmptyPath`](Error::EmptyPath) | `Shape::path(&Path::new(), FillRule::NonZero)` |
/// | [`TooMany`](Error::TooMany) | a polygon of more than [`MAX_SEGMENTS`] points, a scene over its [`Limits`](crate::Limits) |
/// | [`PathData`](Error::PathData) | `Path::from_svg("M 0 0 L")` |
/// | [`CasterNotBelowLight`](Error::CasterNotBelowLight) | a cast from elevation 600 under a light at z = 600 |
/// | [`ReceiverNotBelowLight`](Error::ReceiverNotBelowLight) | a tilted surface's cast on a receiver at 600 under a light at z = 600 |
/// | [`CasterBelowReceiver`](Error::CasterBelowReceiver) | a cast from elevation 1 on a receiver at 2 |
/// | [`ShadowTooLarge`](Error::ShadowTooLarge) | a cast from elevation 599.99994 under a light at z = 600 |
/// | [`PictureSize`](Error::PictureSize) | `Grid::new([0.0, 0.0], [0, 5], 1.0)`, a canvas of a million units square |
/// | [`BufferSize`](Error::BufferSize) | 99 bytes for a grid of 10 x 10, a pixmap of another size than its scene |
/// | [`MeshRoom`](Error::MeshRoom) | [`MeshSlices`](crate::MeshSlices) of ten vertices for a mesh of a hundred |
/// | [`OtherGrid`](Error::OtherGrid) | [`PixelOptions::with_hidden`](crate::PixelOptions::with_hidden) that was made for another grid |
/// | [`NotFlat`](Error::NotFlat) | [`Pose::of_corners`](crate::Pose::of_corners) with the elevations 5, 9, 14, 11 |
/// | [`NotOpaque`](Error::NotOpaque) | a scene's background `#fafafa80` |
/// | [`NotInSvg`](Error::NotInSvg) | `Scene::to_svg` of a scene with linear blending |
/// | [`NotFinished`](Error::NotFinished) | a tilted surface with a finish (feature `finish`) |
/// | [`NotClipped`](Error::NotClipped) | `Surface::clipped` of a tilted surface |
/// | [`Scene`](Error::Scene) | a scene file that ends early, has an unknown field or any of the above |
/// | [`Stopped`](Error::Stopped) | a `Renderer::render_while` that is told not to go on |
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Something was made for other pixels than those to be drawn.
    #[error("{field} was made for another grid: make it for the grid that is drawn")]
    OtherGrid {
        /// What was made for them.
        field: &'static str,
    },
    /// A drawing was stopped by its caller.
    #[error("the drawing was stopped: what is drawn of the picture is not whole")]
    Stopped,
    /// A number is NaN or infinite.
    #[error(
        "{field} is {}: give a finite number{}",
        Shown(*value),
        if value.is_infinite() { ", no larger than an f32 holds" } else { "" }
    )]
    NotFinite {
        /// The field that holds it.
        field: &'static str,
        /// The value.
        value: f64,
    },
    /// A number lies outside its range.
    #[error("{field} is {}: give a number from {} to {}", Shown(*value), Shown(*min), Shown(*max))]
    OutOfRange {
        /// The field that holds it.
        field: &'static str,
        /// The value.
        value: f64,
        /// The least value that is taken.
        min: f64,
        /// The largest value that is taken.
        max: f64,
    },
    /// A width, height, radius or extent that must be positive is zero or negative.
    #[error("{field} is {}: give a number above 0", Shown(*value))]
    NotPositive {
        /// The field that holds it.
        field: &'static str,
        /// The value.
        value: f64,
    },
    /// The caster is at or above the light: no plane below would be in its shadow.
    #[error(
        "elevation {} is not below the light at z = {}: lower the caster or raise the light",
        Shown(*elevation),
        Shown(*light_z)
    )]
    CasterNotBelowLight {
        /// The caster's elevation, scene units.
        elevation: f64,
        /// The light's z, scene units.
        light_z: f64,
    },
    /// The receiver is at or above the light: nothing between them casts on it.
    #[error(
        "receiver {} is not below the light at z = {}: lower the receiver or raise the light",
        Shown(*receiver),
        Shown(*light_z)
    )]
    ReceiverNotBelowLight {
        /// The receiver's elevation, scene units.
        receiver: f64,
        /// The light's z, scene units.
        light_z: f64,
    },
    /// The caster is below its receiver.
    #[error(
        "elevation {} is below the receiver at {}: a caster must be at or above what it shades",
        Shown(*elevation),
        Shown(*receiver)
    )]
    CasterBelowReceiver {
        /// The caster's elevation, scene units.
        elevation: f64,
        /// The receiver's elevation, scene units.
        receiver: f64,
    },
    /// The caster is so near the light that its shadow passes [`MAX_COORDINATE`].
    #[error(
        "the shadow of a caster at elevation {} reaches {extent:.3e} units, over {MAX_COORDINATE}: move it away from the light",
        Shown(*elevation)
    )]
    ShadowTooLarge {
        /// The caster's elevation, scene units.
        elevation: f64,
        /// How far the shadow would reach, scene units.
        extent: f64,
    },
    /// Corners that are not of one plane.
    #[error("the corners' elevations miss one plane by {}: the first and third must add up to the second and fourth", Shown(*bend))]
    NotFlat {
        /// The first and third elevation less the second and fourth, scene units.
        bend: f64,
    },
    /// What an SVG picture of a scene cannot hold.
    #[error("{what} cannot be written as SVG: write a PNG picture")]
    NotInSvg {
        /// What of the scene.
        what: &'static str,
    },
    /// A tilted surface or an image inside a clip.
    #[error("a tilted surface and an image are not clipped: put them outside of the clipped group")]
    NotClipped,
    /// A finish on a tilted surface or an image.
    #[error("a tilted surface and an image take no finish: leave it out")]
    NotFinished,
    /// A ground that something would be seen through.
    #[error("{field} has the alpha {alpha} of 255: give an opaque colour")]
    NotOpaque {
        /// The field that holds it.
        field: &'static str,
        /// The colour's alpha.
        alpha: u8,
    },
    /// A path or polygon without a single line or curve.
    #[error("{field} encloses nothing: give a contour of at least three points")]
    EmptyPath {
        /// The field that holds it.
        field: &'static str,
    },
    /// A path, polygon, list or scene larger than its limit.
    #[error("{count} {field}, over the limit of {limit}: simplify or split what has them")]
    TooMany {
        /// The field that holds it.
        field: &'static str,
        /// How many there are.
        count: usize,
        /// How many may be.
        limit: usize,
    },
    /// SVG path data that cannot be read.
    #[error("SVG path data, character {position}: {reason}")]
    PathData {
        /// Where reading stopped, in characters, from 1.
        position: usize,
        /// What is wrong there.
        reason: String,
    },
    /// A picture that is empty or has more than [`MAX_PIXELS`] pixels.
    #[error("a picture of {width} x {height} pixels: give 1 to {MAX_PIXELS} pixels in all")]
    PictureSize {
        /// Columns.
        width: u64,
        /// Rows.
        height: u64,
    },
    /// A pixel buffer that is too short for its grid, or of another size than the picture.
    #[error(
        "the buffer holds {length} bytes or pixels, the grid needs {needed}: allocate stride x height"
    )]
    BufferSize {
        /// What it holds.
        length: usize,
        /// What it should hold.
        needed: usize,
    },
    /// Slices that a mesh may not fit into.
    #[error("there is room for {length} {field}, the mesh may need {needed}: give a longer slice")]
    MeshRoom {
        /// What the slice holds: vertices or indices.
        field: &'static str,
        /// How many of them.
        length: usize,
        /// How many there may be, with those that it has already.
        needed: usize,
    },
    /// A scene file that cannot be understood.
    #[error("line {line}, column {column}, {field}: {reason}")]
    Scene {
        /// The line, from 1.
        line: usize,
        /// The column, in characters, from 1.
        column: usize,
        /// The field, as in `surfaces[3].radius`.
        field: String,
        /// What is wrong and what to do.
        reason: String,
    },
}

#[cfg(feature = "scene")]
impl Error {
    /// The same with the field by the name that another place has for it, if it is among these.
    pub(crate) fn renamed(mut self, names: &[[&'static str; 2]]) -> Self {
        if let Self::NotFinite { field, .. }
        | Self::OutOfRange { field, .. }
        | Self::NotPositive { field, .. } = &mut self
            && let Some([_, here]) = names.iter().find(|[name, _]| *name == *field)
        {
            *field = here;
        }
        self
    }

    /// Whether it is an elevation that was refused.
    pub(crate) fn is_of_elevation(&self) -> bool {
        matches!(
            self,
            Self::CasterNotBelowLight { .. }
                | Self::CasterBelowReceiver { .. }
                | Self::ShadowTooLarge { .. }
                | Self::NotFinite {
                    field: "elevation",
                    ..
                }
                | Self::OutOfRange {
                    field: "elevation",
                    ..
                }
        )
    }
}

/// A number as its user wrote it: most were given as `f32`, and their doubles end in digits that nobody wrote.
struct Shown(f64);

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let single = self.0 as f32;
        let plain = (1e-4..1e9).contains(&self.0.abs()) || self.0 == 0.0 || !self.0.is_finite();
        match (f64::from(single) == self.0, plain) {
            (true, true) => write!(f, "{single}"),
            (true, false) => write!(f, "{single:e}"),
            (false, true) => write!(f, "{}", self.0),
            (false, false) => write!(f, "{:e}", self.0),
        }
    }
}

/// The value as `f64`, when it is finite and within `±MAX_COORDINATE`.
pub(crate) fn coordinate(field: &'static str, value: f64) -> Result<f64> {
    within(field, value, -MAX_COORDINATE, MAX_COORDINATE)
}

/// The value, when it is finite, at least 0 and at most `MAX_COORDINATE`.
pub(crate) fn length(field: &'static str, value: f64) -> Result<f64> {
    within(field, value, 0.0, MAX_COORDINATE)
}

/// The value, when it is finite, above 0 and at most `MAX_COORDINATE`.
pub(crate) fn positive(field: &'static str, value: f64) -> Result<f64> {
    let value = finite(field, value)?;
    if value <= 0.0 {
        return Err(Error::NotPositive { field, value });
    }
    length(field, value)
}

/// The value, when it is finite and from `min` to `max`.
pub(crate) fn within(field: &'static str, value: f64, min: f64, max: f64) -> Result<f64> {
    let value = finite(field, value)?;
    if !(min..=max).contains(&value) {
        return Err(Error::OutOfRange {
            field,
            value,
            min,
            max,
        });
    }
    Ok(value)
}

/// Checks that nothing is seen through a colour of such an alpha.
pub(crate) fn opaque(field: &'static str, alpha: u8) -> Result<()> {
    if alpha == u8::MAX {
        Ok(())
    } else {
        Err(Error::NotOpaque { field, alpha })
    }
}

fn finite(field: &'static str, value: f64) -> Result<f64> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(Error::NotFinite { field, value })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_field_value_and_remedy() {
        let text = positive("radius", -2.0).unwrap_err().to_string();
        assert_eq!(text, "radius is -2: give a number above 0");
        let text = coordinate("x", 1e9).unwrap_err().to_string();
        assert_eq!(text, "x is 1e9: give a number from -16777216 to 16777216");
        assert_eq!(
            length("z", f64::NAN).unwrap_err().to_string(),
            "z is NaN: give a finite number"
        );
    }
}
