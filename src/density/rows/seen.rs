//! Where rows of points meet a piece, and what it is to them.

use core::f64::consts::SQRT_2;

use glam::DVec2;

use super::arcs::{Power, RowArc};
use super::kernels::{LEAST_SPAN, Ramp, RowCut, RowLine, Wide, WideArc, WideLine};
use super::pieces::{Form, Piece};
use super::{Lattice, RowForm, Window};

impl Piece {
    #[inline(always)]
    fn x_at(&self, y: f64) -> f64 {
        match self.form {
            Form::Line { slope, .. } => self.from.x + (y - self.from.y) * slope,
            Form::Arc {
                center,
                radius,
                side,
                ..
            } => {
                let rise = y - center.y;
                center.x + side * (radius * radius - rise * rise).max(0.0).sqrt()
            }
        }
    }

    /// Where the part of the piece that windows in the row at `y` meet begins and ends, from the row.
    #[inline(always)]
    fn met(&self, y: f64, window: Window) -> [f64; 2] {
        let reach = window.reach();
        [(self.low - y).max(-reach), (self.high - y).min(reach)]
    }

    /// The least and the largest x from which a window in the row at `y` meets the piece.
    #[inline(always)]
    pub(super) fn extent(&self, y: f64, window: Window) -> [f64; 2] {
        let [low, high] = self.met(y, window);
        let (a, b) = (self.x_at(y + low), self.x_at(y + high));
        let reach = match self.form {
            // Half of the disc's widest chord between the two heights: lines are too cheap for it to pay.
            Form::Arc { .. } => {
                let nearest = low.max(-high).max(0.0);
                (1.0 - nearest * nearest).sqrt()
            }
            Form::Line { .. } => window.reach(),
        };
        let (mut left, mut right) = (a.min(b) - reach, a.max(b) + reach);
        if window == Window::Square {
            return [left, right];
        }
        match self.form {
            Form::Line { slope, width, .. } => {
                // A disc farther than 1 from the line does not meet it.
                let middle = self.from.x + (y - self.from.y) * slope;
                left = left.max(middle - width);
                right = right.min(middle + width);
            }
            Form::Arc {
                center,
                radius,
                side,
                ..
            } => {
                let rise = center.y - y;
                if low <= rise && rise <= high {
                    let farthest = center.x + side * radius;
                    left = left.min(farthest - reach);
                    right = right.max(farthest + reach);
                }
                // A disc farther than 1 from the circle does not meet it. Above and below the circle's middle part a disc beside the centre
                // may meet either half.
                let beside = |r: f64| center.x + side * (r * r - rise * rise).max(0.0).sqrt();
                let ends = [radius - 1.0, radius + 1.0];
                let inner = (rise.abs() < ends[0]).then(|| beside(ends[0]));
                let outer = beside(ends[1]);
                let (least, most) = if side > 0.0 {
                    (inner.unwrap_or(left), outer)
                } else {
                    (outer, inner.unwrap_or(right))
                };
                (left, right) = (left.max(least), right.min(most));
            }
        }
        [left, right.max(left)]
    }

    /// The least and the largest x from which a pixel of the row at `y` averages over points that see the piece.
    #[inline(always)]
    pub(super) fn wide_extent(&self, y: f64, wide: &Wide) -> [f64; 2] {
        let reach = wide.half + wide.radius;
        match self.form {
            Form::Line {
                along,
                slope,
                width,
                ..
            } => {
                let middle = self.from.x + (y - self.from.y) * slope;
                let across = along.x.abs() + along.y.abs();
                let reach = (wide.radius + wide.half * across) * width;
                [middle - reach, middle + reach]
            }
            Form::Arc {
                center,
                radius,
                side,
                ..
            } => {
                let (a, b) = (self.x_at(y - reach), self.x_at(y + reach));
                let (mut left, mut right) = (a.min(b) - reach, a.max(b) + reach);
                if (center.y - y).abs() <= reach {
                    let farthest = center.x + side * radius;
                    left = left.min(farthest - reach);
                    right = right.max(farthest + reach);
                }
                [left, right]
            }
        }
    }

    /// The piece that passes all that pixels average over, as a row sees it from its column at `origin`.
    #[inline(always)]
    pub(super) fn seen_widely(&self, origin: DVec2, lattice: &Lattice, wide: &Wide) -> RowForm {
        let ramp = |start: f64, slope: f64| Ramp {
            start: start as f32,
            step: (-slope * lattice.pitch) as f32,
        };
        let (half, radius) = (wide.half as f32, wide.radius as f32);
        match self.form {
            Form::Line { along, .. } => {
                let [a, b] = [along.x, along.y].map(|part| part.abs() as f32 * half);
                RowForm::WideLine(WideLine {
                    distance: ramp((self.from - origin).perp_dot(along), along.y),
                    spans: [a.max(b), a.min(b).max(LEAST_SPAN * half)],
                    radius,
                })
            }
            Form::Arc {
                center,
                radius: arc_radius,
                turn,
                side,
                ..
            } => {
                let seen = center - origin;
                RowForm::WideArc(WideArc {
                    center: ramp(seen.x, 1.0),
                    center_y: seen.y as f32,
                    arc_radius: arc_radius as f32,
                    turn: turn as f32,
                    side: side as f32,
                    half,
                    radius,
                })
            }
        }
    }

    /// The piece as a row sees it from its column at `origin`.
    #[inline(always)]
    pub(super) fn seen_from(&self, origin: DVec2, lattice: &Lattice, halves: [f32; 2]) -> RowForm {
        let [low, high] = self.met(origin.y, lattice.window);
        let (from, to) = (self.from - origin, self.to - origin);
        let passes = self.low <= origin.y - 1.0 && self.high >= origin.y + 1.0;
        let ramp = |start: f64, slope: f64| Ramp {
            start: start as f32,
            step: (-slope * lattice.pitch) as f32,
        };
        match self.form {
            Form::Line { along, .. } if lattice.window == Window::Square => {
                let ends = [low, high].map(|rise| ramp(self.x_at(origin.y + rise) - origin.x, 1.0));
                let upwards = along.y > 0.0;
                RowForm::Cut(RowCut {
                    ends,
                    height: if upwards { high - low } else { low - high } as f32,
                })
            }
            Form::Line { along, length, .. } => {
                let distance = ramp(from.perp_dot(along), along.y);
                if passes {
                    return RowForm::ThroughLine(distance);
                }
                RowForm::Line(RowLine {
                    distance,
                    start: ramp(from.dot(along), along.x),
                    length: length as f32,
                    along: along.as_vec2().to_array(),
                    halves,
                })
            }
            Form::Arc {
                center,
                radius,
                turn,
                side,
                segment,
            } => {
                let seen = center - origin;
                let end = |end: DVec2| {
                    // Negative where the end is above or below the disc.
                    let width = 1.0 - end.y * end.y;
                    let width = if width > 0.0 { width.sqrt() } else { -1.0 };
                    [end.x - seen.x, end.y, width].map(|v| v as f32)
                };
                // The end that is less high or low, if any is within the disc's height.
                let nearer = if from.y.abs() < to.y.abs() { from } else { to };
                let middle = if nearer.y.abs() < 1.0 {
                    nearer.x
                } else {
                    self.x_at(origin.y + (low + high) / 2.0) - origin.x
                };
                let arc = RowArc {
                    center: ramp(seen.x, 1.0),
                    center_y: seen.y as f32,
                    radius: radius as f32,
                    power: Power::of(seen, radius, lattice.pitch),
                    turn: turn as f32,
                    side: side as f32,
                    from: end(from),
                    to: end(to),
                    middle: (middle - seen.x) as f32,
                    halves,
                    segment,
                };
                if radius < SQRT_2 {
                    RowForm::Arc(arc)
                } else if passes {
                    RowForm::ThroughArc(arc)
                } else {
                    RowForm::LongArc(arc)
                }
            }
        }
    }
}
