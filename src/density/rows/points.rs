//! What densities are averages over, and the points of a pixel that they are taken at.

use super::kernels::{Wide, half_disc};

/// What a density is the average over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Window {
    /// The unit disc.
    Disc,
    /// The unit square.
    Square,
}

impl Window {
    /// How far from its centre it reaches along an axis.
    pub(super) fn reach(self) -> f64 {
        match self {
            Self::Disc => 1.0,
            Self::Square => 0.5,
        }
    }

    /// What lies right of its centre between y = 0 and `t`.
    pub(crate) fn half(self, t: f64) -> f32 {
        match self {
            Self::Disc if t.abs() >= 1.0 => 0.25_f32.copysign(t as f32),
            Self::Disc => half_disc(t as f32),
            Self::Square => 0.5 * (t as f32).clamp(-0.5, 0.5),
        }
    }
}

/// One of the rows of points that a pixel's average is taken from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    /// From the pixel's centre, in the windows' unit.
    pub(crate) offset: f64,
    pub(crate) weight: f64,
    /// The factor on the columns' offsets.
    pub(crate) spread: f64,
}

/// The points that a pixel's average is taken from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Points<'a> {
    pub(crate) lines: &'a [Line],
    /// Offsets in columns, and weights.
    pub(crate) columns: &'a [(f32, f32)],
    /// What they stand for, if there is more than one.
    pub(crate) wide: Option<Wide>,
}

impl Points<'static> {
    /// The pixel's centre alone.
    pub(crate) const CENTER: Self = Self {
        lines: &[Line {
            offset: 0.0,
            weight: 1.0,
            spread: 1.0,
        }],
        columns: &[(0.0, 1.0)],
        wide: None,
    };
}

impl Points<'_> {
    pub(super) fn height(&self) -> f64 {
        self.lines
            .iter()
            .map(|line| line.offset)
            .fold(0.0, f64::max)
    }

    pub(super) fn width(&self) -> f64 {
        let farthest = self.columns.iter().map(|(offset, _)| *offset);
        f64::from(farthest.fold(0.0, f32::max))
    }
}
