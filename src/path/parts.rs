//! Curves cut into equal parts of their parameter, every one of them a cubic.
//!
//! A part knows its ends and how it leaves and arrives. All else comes from differences of these, so that a curve is
//! taken for the same wherever it lies.

use core::f64::consts::FRAC_PI_4;

use glam::DVec2;
use libm::{cos, sin, tan};

use super::{EllipseArc, Segment};

/// A segment that is not straight.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Curve {
    from: DVec2,
    to: DVec2,
    kind: Kind,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    /// A cubic by its two control points and its end, counted from its start.
    Cubic([DVec2; 3]),
    Arc(EllipseArc),
}

/// A part of a curve, as a cubic in Hermite's form: its ends, and its derivatives there over a parameter from 0 to 1.
/// Of an ellipse it is the usual approximation, for parts of an eighth turn within 5e-6 of the half diameters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    pub(crate) from: DVec2,
    pub(crate) to: DVec2,
    pub(crate) leaving: DVec2,
    pub(crate) arriving: DVec2,
}

impl Curve {
    /// The curve of a segment that begins at `from`, or none for a line.
    pub(crate) fn new(from: DVec2, segment: &Segment) -> Option<Self> {
        let (to, kind) = match *segment {
            Segment::Line(_) => return None,
            Segment::Quad(control, to) => {
                let (control, end) = (control - from, to - from);
                let first = control * (2.0 / 3.0);
                (to, Kind::Cubic([first, first + end / 3.0, end]))
            }
            Segment::Cubic(a, b, to) => (to, Kind::Cubic([a - from, b - from, to - from])),
            Segment::Arc(arc) => (arc.to, Kind::Arc(arc)),
        };
        Some(Self { from, to, kind })
    }

    /// The fewest parts into which it may be cut: of an arc none may be longer than an eighth turn.
    pub(crate) fn fewest_parts(&self) -> u32 {
        match self.kind {
            Kind::Cubic(_) => 1,
            Kind::Arc(arc) => (arc.sweep.abs() / FRAC_PI_4).ceil().max(1.0) as u32,
        }
    }

    /// How far the chord of the whole curve may be from it; that of one of n parts n² times less.
    pub(crate) fn sagitta(&self) -> f64 {
        match self.kind {
            Kind::Cubic([a, b, end]) => {
                let bends = [b - 2.0 * a, a - 2.0 * b + end];
                let most = bends.map(DVec2::length_squared);
                0.75 * most[0].max(most[1]).sqrt()
            }
            Kind::Arc(arc) => {
                let longest = (arc.u.length_squared() + arc.v.length_squared()).sqrt();
                longest * arc.sweep * arc.sweep / 8.0
            }
        }
    }

    /// The `count` parts in order, each beginning where the last one ended.
    pub(crate) fn parts(&self, count: u32) -> impl Iterator<Item = Part> {
        let mut last = self.knot(0, count);
        (1..=count).map(move |index| {
            let next = self.knot(index, count);
            let (from, leaving) = core::mem::replace(&mut last, next);
            let (to, arriving) = next;
            Part {
                from,
                to,
                leaving,
                arriving,
            }
        })
    }

    /// Where the part after the first `index` of `count` begins, and the derivative there over a part.
    fn knot(&self, index: u32, count: u32) -> (DVec2, DVec2) {
        let step = 1.0 / f64::from(count);
        let t = f64::from(index) / f64::from(count);
        let s = 1.0 - t;
        let (offset, derivative) = match self.kind {
            Kind::Cubic([a, b, end]) => (
                3.0 * s * t * (a * s + b * t) + end * (t * t * t),
                (a * (s * s) + (b - a) * (2.0 * s * t) + (end - b) * (t * t)) * (3.0 * step),
            ),
            Kind::Arc(arc) => {
                let angle = arc.start + arc.sweep * t;
                let (sine, cosine) = (sin(angle), cos(angle));
                // A cubic comes closest to the arc with handles a little longer than its derivative says.
                let handle = 4.0 * tan(arc.sweep * step / 4.0);
                (
                    (arc.center - self.from) + arc.u * cosine + arc.v * sine,
                    (arc.v * cosine - arc.u * sine) * handle,
                )
            }
        };
        let point = match index {
            0 => self.from,
            _ if index == count => self.to,
            _ => self.from + offset,
        };
        (point, derivative)
    }
}

impl Part {
    pub(crate) fn chord(&self) -> DVec2 {
        self.to - self.from
    }

    /// The legs of its control polygon: it heads nowhere but between them.
    pub(crate) fn legs(&self) -> [DVec2; 3] {
        let (first, last) = (self.leaving / 3.0, self.arriving / 3.0);
        [first, self.chord() - first - last, last]
    }

    /// How far from the middle of its chord the middle of the parabola is that goes the way it does.
    pub(crate) fn rise(&self) -> DVec2 {
        (self.leaving - self.arriving) / 8.0
    }

    /// Its third difference, a sixth of its third derivative: what makes it no parabola.
    pub(crate) fn twist(&self) -> DVec2 {
        self.leaving + self.arriving - 2.0 * self.chord()
    }

    /// The point at a parameter from 0 to 1.
    pub(crate) fn at(&self, t: f64) -> DVec2 {
        let s = 1.0 - t;
        let along = self.chord() * (t * t * (s + s + 1.0));
        self.from + along + self.leaving * (t * s * s) - self.arriving * (t * t * s)
    }

    /// The derivative at a parameter from 0 to 1.
    pub(crate) fn derivative(&self, t: f64) -> DVec2 {
        let s = 1.0 - t;
        let along = self.chord() * (6.0 * t * s);
        along + self.leaving * (s * (s - 2.0 * t)) - self.arriving * (t * (s + s - t))
    }

    /// Twice the area between it and its chord.
    pub(crate) fn double_area(&self) -> f64 {
        (self.leaving - self.arriving).perp_dot(self.chord()) / 6.0
            + self.double_area_beyond_parabola()
    }

    /// Twice the area between it and its chord, beyond that of the parabola that goes the way it does.
    pub(crate) fn double_area_beyond_parabola(&self) -> f64 {
        let bend = (self.leaving - self.arriving).perp_dot(self.chord());
        (bend - self.leaving.perp_dot(self.arriving)) / 30.0
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use super::*;

    #[test]
    fn parts_join_and_sum_up_to_the_whole() {
        let from = DVec2::new(3.0, 1.0);
        let segment = Segment::Cubic(
            DVec2::new(9.0, -4.0),
            DVec2::new(-2.0, 8.0),
            DVec2::new(7.0, 6.0),
        );
        let curve = Curve::new(from, &segment).unwrap();
        let area = |count| {
            let parts: Vec<Part> = curve.parts(count).collect();
            assert_eq!(parts[0].from, from);
            assert_eq!(parts[parts.len() - 1].to, DVec2::new(7.0, 6.0));
            assert!(parts.windows(2).all(|pair| pair[0].to == pair[1].from));
            let of_chords = |p: &Part| (p.from - from).perp_dot(p.chord());
            parts
                .iter()
                .map(|part| of_chords(part) + part.double_area())
                .sum::<f64>()
        };
        let whole = area(1);
        assert!(whole.abs() > 1.0);
        for count in [2, 3, 7, 64] {
            assert!((area(count) - whole).abs() < 1e-12, "{count}");
        }
    }

    #[test]
    fn eighths_of_an_ellipse_are_nearly_arcs() {
        let arc = EllipseArc {
            center: DVec2::new(5.0, 6.0),
            u: DVec2::new(3.0, 1.0),
            v: DVec2::new(-2.0, 1.5),
            start: 0.3,
            sweep: PI,
            to: DVec2::new(5.0, 6.0)
                - DVec2::new(3.0, 1.0) * cos(0.3)
                - DVec2::new(-2.0, 1.5) * sin(0.3),
        };
        let from = arc.center + arc.u * cos(0.3) + arc.v * sin(0.3);
        let curve = Curve::new(from, &Segment::Arc(arc)).unwrap();
        assert_eq!(curve.fewest_parts(), 4);
        let exact = arc.u.perp_dot(arc.v) * (FRAC_PI_4 - sin(FRAC_PI_4));
        for part in curve.parts(4) {
            assert!((part.double_area() / exact - 1.0).abs() < 1e-4);
        }
    }
}
