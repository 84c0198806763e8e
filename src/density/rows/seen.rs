//! Where rows of points meet a piece, and what it is to them.

use core::f64::consts::SQRT_2;

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};
use glam::DVec2;

use super::Window;
use super::arcs::{ArcEnd, Power, RowArc};
use super::kernels::{Ramp, RowCut, RowLine, Wide, WideArc, WideLine, least_span};
use super::pieces::{Form, Piece, Slant};
use super::stroke::RowForm;

/// From where pieces are seen.
pub(super) struct View<S: Simd> {
    pub(super) simd: S,
    /// The first pixel.
    pub(super) origin: DVec2,
    /// How far below it each lane's pixel is.
    pub(super) down: f32x16<S>,
    /// From column to column.
    pub(super) pitch: f64,
}

impl<S: Simd> View<S> {
    /// An end of an arc from the first pixel, and its centre's x.
    #[inline(always)]
    fn end(&self, end: DVec2, center_x: f64) -> ArcEnd<S> {
        let (zero, one) = (f32x16::splat(self.simd, 0.0), f32x16::splat(self.simd, 1.0));
        let y = f32x16::splat(self.simd, end.y as f32) - self.down;
        let width = (one - y) * (one + y);
        ArcEnd {
            x: (end.x - center_x) as f32,
            y,
            width: width.simd_gt(zero).select(width.sqrt(), -one),
        }
    }

    /// What is `start` at the first pixel and falls with x by so much.
    #[inline(always)]
    fn ramp(&self, start: f64, slope: f64) -> Ramp<S> {
        Ramp {
            start: f32x16::splat(self.simd, start as f32),
            step: (-slope * self.pitch) as f32,
        }
    }
}

impl Piece {
    #[inline(always)]
    fn x_at(&self, y: f64) -> f64 {
        match self.form {
            Form::Line(Slant { slope, .. }) => self.from.x + (y - self.from.y) * slope,
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

    /// The least and the largest x from which a window in one of the rows from one y to another meets the piece.
    #[inline(always)]
    pub(super) fn extent(&self, [top, bottom]: [f64; 2], window: Window) -> [f64; 2] {
        let reach = window.reach();
        let (low, high) = (self.low.max(top - reach), self.high.min(bottom + reach));
        let (a, b) = (self.x_at(low), self.x_at(high));
        let reach = match self.form {
            // Half of the disc's widest chord between the two heights: lines are too cheap for it to pay.
            Form::Arc { .. } => {
                let nearest = (low - bottom).max(top - high).max(0.0);
                (1.0 - nearest * nearest).sqrt()
            }
            Form::Line(_) => window.reach(),
        };
        let (mut left, mut right) = (a.min(b) - reach, a.max(b) + reach);
        if window == Window::Square {
            return [left, right];
        }
        match self.form {
            Form::Line(Slant { slope, width, .. }) => {
                // A disc farther than 1 from the line does not meet it.
                let [a, b] = [top, bottom].map(|y| self.from.x + (y - self.from.y) * slope);
                left = left.max(a.min(b) - width);
                right = right.min(a.max(b) + width);
            }
            Form::Arc {
                center,
                radius,
                side,
                ..
            } => {
                if low <= center.y && center.y <= high {
                    let farthest = center.x + side * radius;
                    left = left.min(farthest - reach);
                    right = right.max(farthest + reach);
                }
                // A disc farther than 1 from the circle does not meet it. Above and below the circle's middle part a disc beside the centre
                // may meet either half.
                let nearest = (center.y - bottom).max(top - center.y).max(0.0);
                let farthest = (center.y - top).max(bottom - center.y);
                let beside =
                    |r: f64, rise: f64| center.x + side * (r * r - rise * rise).max(0.0).sqrt();
                let inner = (farthest < radius - 1.0).then(|| beside(radius - 1.0, farthest));
                let outer = beside(radius + 1.0, nearest);
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
            Form::Line(slant) => {
                let middle = self.from.x + (y - self.from.y) * slant.slope;
                let across = slant.along.x.abs() + slant.along.y.abs();
                let reach = (wide.radius + wide.half * across) * slant.width;
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

    /// The piece that passes all that pixels average over, as it is seen from a row's columns on.
    #[inline(always)]
    pub(super) fn seen_widely<S: Simd>(&self, view: &View<S>, wide: &Wide) -> RowForm<S> {
        let (half, radius) = (wide.half as f32, wide.radius as f32);
        match self.form {
            Form::Line(Slant { along, .. }) => {
                let [a, b] = [along.x, along.y].map(|part| part.abs() as f32 * half);
                let distance = (self.from - view.origin).perp_dot(along);
                RowForm::WideLine(WideLine {
                    distance: view.ramp(distance, along.y),
                    spans: [a.max(b), a.min(b).max(least_span(half, radius))],
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
                let seen = center - view.origin;
                RowForm::WideArc(WideArc {
                    center: view.ramp(seen.x, 1.0),
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

    /// The part of the squares of a row that the piece cuts.
    #[inline(always)]
    pub(super) fn cut_from<S: Simd>(&self, view: &View<S>) -> RowCut<S> {
        let y = view.origin.y;
        let (low, high) = (self.low.max(y - 0.5), self.high.min(y + 0.5));
        let ends = [low, high].map(|y| self.x_at(y) - view.origin.x);
        let height = high - low;
        RowCut {
            ends: ends.map(|x| view.ramp(x, 1.0)),
            width: ends[1] as f32 - ends[0] as f32,
            height: if self.from.y < self.to.y {
                height
            } else {
                -height
            } as f32,
        }
    }

    /// The piece as discs see it whose rows are no lower than `bottom`; `halves` are `half_disc` at its start's y and at its end's.
    #[inline(always)]
    pub(super) fn seen_from<S: Simd>(
        &self,
        view: &View<S>,
        bottom: f64,
        halves: [f32x16<S>; 2],
    ) -> RowForm<S> {
        let (simd, origin, down) = (view.simd, view.origin, view.down);
        let (from, to) = (self.from - origin, self.to - origin);
        let passes = self.low <= origin.y - 1.0 && self.high >= bottom + 1.0;
        match self.form {
            Form::Line(Slant { along, length, .. }) => {
                let mut distance = view.ramp(from.perp_dot(along), along.y);
                distance.start += down * along.x as f32;
                if passes {
                    return RowForm::ThroughLine(distance);
                }
                let mut start = view.ramp(from.dot(along), along.x);
                start.start -= down * along.y as f32;
                RowForm::Line(RowLine {
                    distance,
                    start,
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
                let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
                let seen = center - origin;
                let center_y = f32x16::splat(simd, seen.y as f32) - down;
                let (from, to) = (view.end(from, seen.x), view.end(to, seen.x));
                // The end that is less high or low, if any is within the disc's height.
                let (from_high, to_high) = (from.y.abs(), to.y.abs());
                let nearer = from_high.simd_lt(to_high);
                let nearer_x =
                    nearer.select(f32x16::splat(simd, from.x), f32x16::splat(simd, to.x));
                let low = f32x16::splat(simd, (self.low - origin.y) as f32) - down;
                let high = f32x16::splat(simd, (self.high - origin.y) as f32) - down;
                let rise = (low.max(-one) + high.min(one)) * 0.5 - center_y;
                let whole = f32x16::splat(simd, radius as f32);
                let beside = ((whole - rise) * (whole + rise)).max(zero).sqrt() * side as f32;
                let middle = from_high.min(to_high).simd_lt(one).select(nearer_x, beside);
                let arc = RowArc {
                    center: view.ramp(seen.x, 1.0),
                    center_y,
                    radius: radius as f32,
                    power: Power::of(seen, radius, view.pitch, down),
                    turn: turn as f32,
                    side: side as f32,
                    from,
                    to,
                    rise: if self.to.y < self.from.y { -1.0 } else { 1.0 },
                    middle,
                    beside,
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
