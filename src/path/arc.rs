//! Arcs of ellipses.

use core::f64::consts::{PI, TAU};

use glam::DVec2;
use libm::{acos, atan2, cos, sin};

/// How far an arc turns, in radians, for all of its ellipse to hold it well: a quarter turn is in the same box either way.
const SHORT: f64 = 1.2;

/// The points `center + u cos θ + v sin θ`, θ from `start` to `start + sweep` (radians): an arc of the ellipse with the
/// conjugate half diameters `u` and `v`. An affine map maps the three vectors and keeps the angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EllipseArc {
    pub(crate) center: DVec2,
    pub(crate) u: DVec2,
    pub(crate) v: DVec2,
    pub(crate) start: f64,
    pub(crate) sweep: f64,
    pub(crate) to: DVec2,
}

impl EllipseArc {
    /// Whether its half diameters are equal and perpendicular: it is a circle's.
    pub(crate) fn is_circular(&self) -> bool {
        // Rounding of an affine map leaves some 1e-16; a millionth of that in levels.
        let slack = 1e-12 * self.u.length();
        (self.v - self.turn() * self.u.perp()).length() <= slack
    }

    /// 1 where its angles grow from the x axis to the y axis, else -1.
    pub(crate) fn turn(&self) -> f64 {
        if self.u.perp_dot(self.v) < 0.0 {
            -1.0
        } else {
            1.0
        }
    }

    /// The arc of SVG's endpoint form (SVG 1.1, appendix F.6.5 and F.6.6), or none where SVG has a line.
    pub(super) fn through(
        from: DVec2,
        radii: DVec2,
        rotation: f64,
        large: bool,
        positive: bool,
        to: DVec2,
    ) -> Option<Self> {
        let radii = radii.abs();
        if radii.x == 0.0 || radii.y == 0.0 || from == to {
            return None;
        }
        if !positive {
            // The other way round the same arc: the same numbers.
            let arc = Self::through(to, radii, rotation, large, true, from);
            return arc.map(|arc| arc.reversed(to));
        }
        let (sin_rotation, cos_rotation) = (sin(rotation), cos(rotation));
        let axis = DVec2::new(cos_rotation, sin_rotation);
        // The half chord in the ellipse's own frame, in units of its half axes.
        let half = (from - to) / 2.0;
        let h = DVec2::new(half.dot(axis), axis.perp_dot(half)) / radii;
        let grow = h.length().max(1.0);
        let (radii, h) = (radii * grow, h / grow);
        let away = (1.0 / h.length_squared() - 1.0).max(0.0).sqrt();
        let side = if large { -1.0 } else { 1.0 };
        let c = side * away * DVec2::new(h.y, -h.x);
        let (u, v) = (axis * radii.x, axis.perp() * radii.y);
        let (a, b) = (h - c, -h - c);
        let angle = |v: DVec2| on_steps(atan2(v.y, v.x));
        let start = angle(a);
        let mut sweep = angle(b) - start;
        if sweep < 0.0 || (large && sweep == 0.0) {
            sweep += on_steps(TAU);
        }
        Some(Self {
            center: (from + to) / 2.0 + u * c.x + v * c.y,
            u,
            v,
            start,
            sweep,
            to,
        })
    }

    /// The same from its end to `to`, where it began.
    pub(crate) fn reversed(&self, to: DVec2) -> Self {
        Self {
            start: self.start + self.sweep,
            sweep: -self.sweep,
            to,
            ..*self
        }
    }

    /// Two corners of a box that holds it, as well as its ends: short arcs of large ellipses take little room.
    pub(crate) fn hull(&self, from: DVec2) -> [DVec2; 2] {
        if self.sweep.abs() > SHORT {
            let extent = (self.u * self.u + self.v * self.v).map(f64::sqrt);
            return [self.center - extent, self.center + extent];
        }
        // Where its ends' tangents meet.
        let spokes = (from - self.center) + (self.to - self.center);
        [self.center + spokes / (1.0 + cos(self.sweep)); 2]
    }

    /// Into how many lines it is cut.
    pub(super) fn steps(&self, flatness: f64) -> u32 {
        let longest = (self.u.length_squared() + self.v.length_squared()).sqrt();
        arc_steps(longest, self.sweep, flatness)
    }

    /// Pushes the vertices between the arc's ends.
    pub(super) fn flatten(&self, flatness: f64, out: &mut Vec<DVec2>) {
        let count = self.steps(flatness);
        for i in 1..count {
            // From the nearer end: the same angles in both directions.
            let part = |steps: u32| self.sweep * (f64::from(steps) / f64::from(count));
            let angle = if 2 * i <= count {
                self.start + part(i)
            } else {
                (self.start + self.sweep) - part(count - i)
            };
            out.push(self.center + self.u * cos(angle) + self.v * sin(angle));
        }
    }
}

/// An angle (radians) on steps of 2^-48: sums and differences of such angles are exact, so that an arc and its reverse have
/// the same.
fn on_steps(angle: f64) -> f64 {
    const STEPS: f64 = (1_u64 << 48) as f64;
    (angle * STEPS).round() / STEPS
}

/// Into how many equal steps an arc of `sweep` radians is cut, so that its chords stay within `flatness` of it: a chord
/// over the angle a is `radius (1 - cos(a / 2))` away. At most a right angle each, at most 2^20 steps: enough for
/// a chord within 1e-4 of the largest circle that coordinates allow.
pub(crate) fn arc_steps(radius: f64, sweep: f64, flatness: f64) -> u32 {
    const MOST: f64 = 1_048_576.0;
    let widest = if flatness < radius {
        2.0 * acos(1.0 - flatness / radius)
    } else {
        PI
    };
    (sweep.abs() / widest.min(PI / 2.0)).ceil().clamp(1.0, MOST) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::{Path, Segment};

    #[test]
    fn arcs_end_where_they_should() {
        let mut path = Path::new();
        path.move_to([10.0, 0.0]);
        path.arc_to([10.0, 10.0], 0.3, false, true, [0.0, 10.0]);
        let Segment::Arc(arc) = path.contours[0].segments[0] else {
            panic!("an arc");
        };
        assert!(arc.center.length() < 1e-6, "{:?}", arc.center);
        assert!((arc.sweep - PI / 2.0).abs() < 1e-6);
        let vertices = path.contours[0].flatten(1e-3);
        assert!(
            vertices
                .iter()
                .all(|v| (v.length() - 10.0).abs() < 2e-6 && v.x > -1e-9 && v.y > -1e-9)
        );
        let sagitta = vertices
            .windows(2)
            .map(|w| 10.0 - w[0].midpoint(w[1]).length())
            .fold(0.0, f64::max);
        assert!(sagitta < 1e-3, "{sagitta}");
    }

    #[test]
    fn hulls_hold_arcs_and_little_more_where_they_are_short() {
        let (u, v) = (DVec2::new(300.0, 40.0), DVec2::new(-90.0, 200.0));
        for sweep in [-3.0, -1.1, -0.02, 0.02, 1.1, 1.3, 3.0] {
            for start in [0.0, 1.0, 2.0, 4.0] {
                let at = |angle: f64| u * cos(angle) + v * sin(angle);
                let arc = EllipseArc {
                    center: DVec2::ZERO,
                    u,
                    v,
                    start,
                    sweep,
                    to: at(start + sweep),
                };
                let from = at(start);
                let [a, b] = arc.hull(from);
                let min = from.min(arc.to).min(a).min(b) - 1e-9;
                let max = from.max(arc.to).max(a).max(b) + 1e-9;
                for part in 0..=20 {
                    let at = at(start + sweep * f64::from(part) / 20.0);
                    assert!(at.cmpge(min).all() && at.cmple(max).all());
                }
                let size = (max - min).max_element();
                assert!(sweep.abs() > 1.0 || size < 10.0, "{sweep}: {size}");
            }
        }
    }

    #[test]
    fn small_radii_grow_and_flags_choose_the_way_round() {
        for (large, positive) in [(false, false), (false, true), (true, false), (true, true)] {
            let mut path = Path::new();
            path.move_to([0.0, 0.0])
                .arc_to([5.0, 3.0], 0.5, large, positive, [4.0, 1.0]);
            let Segment::Arc(arc) = path.contours[0].segments[0] else {
                panic!("an arc");
            };
            assert_eq!(arc.sweep > 0.0, positive);
            assert_eq!(arc.sweep.abs() > PI, large);
            let at = |angle: f64| arc.center + arc.u * cos(angle) + arc.v * sin(angle);
            assert!(at(arc.start).length() < 1e-9);
            assert!((at(arc.start + arc.sweep) - DVec2::new(4.0, 1.0)).length() < 1e-9);
        }
        let mut path = Path::new();
        path.move_to([0.0, 0.0])
            .arc_to([1.0, 1.0], 0.0, false, true, [10.0, 0.0]);
        let Segment::Arc(arc) = path.contours[0].segments[0] else {
            panic!("an arc");
        };
        assert!((arc.u.length() - 5.0).abs() < 1e-9);
    }
}
