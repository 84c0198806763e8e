//! Random paths that can be drawn in other ways.

#![expect(clippy::panic, reason = "a path that is refused fails the test")]

use penumbral::{Error, FillRule, Path, Shape};

use super::Random;

/// A contour's segment, from where the last one ended.
#[derive(Debug, Clone, Copy)]
pub enum Piece {
    Line([f32; 2]),
    Quad([f32; 2], [f32; 2]),
    Cubic([f32; 2], [f32; 2], [f32; 2]),
    /// Radii, rotation, the longer way, growing angles, end.
    Arc([f32; 2], f32, bool, bool, [f32; 2]),
}

impl Piece {
    pub fn end(self) -> [f32; 2] {
        match self {
            Self::Line(to) | Self::Quad(_, to) | Self::Cubic(_, _, to) | Self::Arc(.., to) => to,
        }
    }

    /// The same from its end to `from`, where it began.
    pub fn reversed(self, from: [f32; 2]) -> Self {
        match self {
            Self::Line(_) => Self::Line(from),
            Self::Quad(a, _) => Self::Quad(a, from),
            Self::Cubic(a, b, _) => Self::Cubic(b, a, from),
            Self::Arc(radii, rotation, large, positive, _) => {
                Self::Arc(radii, rotation, large, !positive, from)
            }
        }
    }
}

/// A path that can be drawn in other ways: each contour by its pieces, the last of which ends where the first begins.
#[derive(Debug, Clone)]
pub struct Drawn {
    pub contours: Vec<Vec<Piece>>,
    pub rule: FillRule,
}

impl Drawn {
    /// Contours of all kinds of pieces within a square, or of lines alone, on quarters of a unit: crossing themselves, with
    /// points twice, spikes and pieces without length.
    pub fn random(random: &mut Random, side: f32, curves: bool) -> Self {
        let point = |random: &mut Random| {
            let quarters = (4.0 * side) as usize + 1;
            [0; 2].map(|_| random.below(quarters) as f32 / 4.0)
        };
        let mut contours = Vec::new();
        for _ in 0..random.pick(&[1, 1, 1, 2, 3]) {
            let start = point(random);
            let (mut before, mut last) = (start, start);
            let mut pieces = Vec::new();
            for _ in 0..2 + random.below(7) {
                let to = match random.below(10) {
                    0 => last,
                    1 => before,
                    2 => [last[0], point(random)[1]],
                    3 => [point(random)[0], last[1]],
                    4 => [0, 1].map(|axis| (last[axis] + before[axis]) / 2.0),
                    _ => point(random),
                };
                pieces.push(match random.below(6) {
                    0 if curves => Piece::Quad(point(random), to),
                    1 if curves => Piece::Cubic(point(random), point(random), to),
                    2 if curves => {
                        let radii = [0; 2].map(|_| random.below(40) as f32 / 2.0);
                        let rotation = random.pick(&[0.0, 0.0, 0.5, 1.5]);
                        Piece::Arc(radii, rotation, random.chance(0.5), random.chance(0.5), to)
                    }
                    _ => Piece::Line(to),
                });
                (before, last) = (last, to);
            }
            pieces.push(Piece::Line(start));
            contours.push(pieces);
        }
        let rule = random.pick(&[FillRule::NonZero, FillRule::EvenOdd]);
        Self { contours, rule }
    }

    /// None where it has no width or no height.
    pub fn shape(&self) -> Option<Shape> {
        let mut path = Path::new();
        for pieces in &self.contours {
            path.move_to(pieces.last()?.end());
            for piece in pieces {
                match *piece {
                    Piece::Line(to) => path.line_to(to),
                    Piece::Quad(a, to) => path.quad_to(a, to),
                    Piece::Cubic(a, b, to) => path.cubic_to(a, b, to),
                    Piece::Arc(radii, rotation, large, positive, to) => {
                        path.arc_to(radii, rotation, large, positive, to)
                    }
                };
            }
        }
        match Shape::path(&path, self.rule) {
            Ok(shape) => Some(shape),
            Err(Error::NotPositive { .. } | Error::EmptyPath { .. }) => None,
            Err(error) => panic!("{error}: {self:?}"),
        }
    }

    pub fn reversed(&self) -> Self {
        let reversed = |pieces: &Vec<Piece>| {
            let ends = pieces.iter().map(|piece| piece.end());
            let starts = pieces
                .last()
                .into_iter()
                .map(|piece| piece.end())
                .chain(ends);
            let pairs: Vec<_> = pieces.iter().zip(starts).collect();
            pairs
                .into_iter()
                .rev()
                .map(|(piece, start)| piece.reversed(start))
                .collect()
        };
        Self {
            contours: self.contours.iter().map(reversed).collect(),
            rule: self.rule,
        }
    }

    /// The same with each contour begun some pieces later, and the contours in another order.
    pub fn started_at(&self, piece: usize) -> Self {
        let mut other = self.clone();
        for pieces in &mut other.contours {
            let count = pieces.len();
            pieces.rotate_left(piece % count);
        }
        let count = other.contours.len();
        other.contours.rotate_left(piece % count);
        other
    }
}
