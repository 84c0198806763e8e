//! Paths: contours of lines, quadratics, cubics and elliptical arcs, and their flattening.

mod parts;

use core::f64::consts::{PI, TAU};

use glam::{DAffine2, DVec2};
use libm::{acos, atan2, cos, sin, sqrt};
use lyon::geom::{CubicBezierSegment, Point, QuadraticBezierSegment};

pub(crate) use parts::{Curve, Part};

use crate::error::{self, Error, MAX_SEGMENTS, Result};

/// Which parts of the plane a path with several or self-crossing contours covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum FillRule {
    /// Where the contours wind round a point a number of times that is not 0 in sum.
    #[default]
    NonZero,
    /// Where the contours wind round a point an odd number of times.
    EvenOdd,
}

/// Contours of lines, quadratics, cubics and elliptical arcs. An open contour is closed by a line, as in every fill.
///
/// ```
/// use penumbral::{FillRule, Path, Shape};
///
/// let mut bubble = Path::new();
/// bubble.move_to([0.0, 0.0]).line_to([80.0, 0.0]);
/// bubble.arc_to([8.0, 8.0], 0.0, false, true, [88.0, 8.0]);
/// bubble.line_to([88.0, 40.0]).quad_to([40.0, 40.0], [30.0, 60.0]).close();
/// let shape = Shape::path(&bubble, FillRule::NonZero)?;
/// # Ok::<(), penumbral::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Path {
    pub(crate) contours: Vec<Contour>,
    /// Where a segment without a `move_to` of its own begins.
    next: Option<DVec2>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Contour {
    pub(crate) start: DVec2,
    pub(crate) segments: Vec<Segment>,
    /// Whether it was closed by word: a fill closes it anyway, a stroke does not.
    pub(crate) closed: bool,
}

/// A piece of a contour, from where the last one ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Segment {
    Line(DVec2),
    Quad(DVec2, DVec2),
    Cubic(DVec2, DVec2, DVec2),
    Arc(EllipseArc),
}

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

impl Path {
    /// A path without contours.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Begins a contour at `to`.
    pub fn move_to(&mut self, to: [f32; 2]) -> &mut Self {
        self.begin(point(to));
        self
    }

    /// A straight line to `to`.
    pub fn line_to(&mut self, to: [f32; 2]) -> &mut Self {
        self.push(Segment::Line(point(to)));
        self
    }

    /// A quadratic Bézier curve to `to`.
    pub fn quad_to(&mut self, control: [f32; 2], to: [f32; 2]) -> &mut Self {
        self.push(Segment::Quad(point(control), point(to)));
        self
    }

    /// A cubic Bézier curve to `to`.
    pub fn cubic_to(&mut self, control1: [f32; 2], control2: [f32; 2], to: [f32; 2]) -> &mut Self {
        self.push(Segment::Cubic(point(control1), point(control2), point(to)));
        self
    }

    /// An elliptical arc to `to`, as in SVG: half axes `radii`, the first of them turned by `rotation` (radians), the
    /// longer way round when `large`, with growing angles (clockwise where y points down) when `positive`. Radii too
    /// small to reach are scaled up and a zero radius makes a line, both as SVG has it.
    pub fn arc_to(
        &mut self,
        radii: [f32; 2],
        rotation: f32,
        large: bool,
        positive: bool,
        to: [f32; 2],
    ) -> &mut Self {
        self.arc(
            point(radii),
            f64::from(rotation),
            large,
            positive,
            point(to),
        );
        self
    }

    /// Closes the contour by a line to its start, where the next one begins unless `move_to` says otherwise.
    pub fn close(&mut self) -> &mut Self {
        if let Some(contour) = self.contours.last_mut() {
            contour.closed = true;
            self.next = Some(contour.start);
        }
        self
    }

    pub(crate) fn begin(&mut self, start: DVec2) {
        self.contours.push(Contour {
            start,
            segments: Vec::new(),
            closed: false,
        });
        self.next = None;
    }

    pub(crate) fn push(&mut self, segment: Segment) {
        if let Some(start) = self.next {
            self.begin(start);
        }
        if self.contours.is_empty() {
            self.begin(DVec2::ZERO);
        }
        if let Some(contour) = self.contours.last_mut() {
            contour.segments.push(segment);
        }
    }

    /// Where the next segment begins.
    pub(crate) fn current(&self) -> DVec2 {
        self.next
            .or_else(|| self.contours.last().map(Contour::end))
            .unwrap_or(DVec2::ZERO)
    }

    pub(crate) fn arc(
        &mut self,
        radii: DVec2,
        rotation: f64,
        large: bool,
        positive: bool,
        to: DVec2,
    ) {
        let from = self.current();
        let segment = EllipseArc::through(from, radii, rotation, large, positive, to)
            .map_or(Segment::Line(to), Segment::Arc);
        self.push(segment);
    }

    /// Checks every number and the number of segments.
    pub(crate) fn validate(&self) -> Result<()> {
        let count = self
            .contours
            .iter()
            .map(|contour| contour.segments.len())
            .sum();
        if count == 0 {
            return Err(Error::EmptyPath { field: "path" });
        }
        if count > MAX_SEGMENTS {
            return Err(Error::TooMany {
                field: "path segments",
                count,
                limit: MAX_SEGMENTS,
            });
        }
        for contour in &self.contours {
            coordinates("path", contour.start)?;
            for segment in &contour.segments {
                match *segment {
                    Segment::Line(to) => coordinates("path", to)?,
                    Segment::Quad(a, to) => {
                        coordinates("path", a)?;
                        coordinates("path", to)?;
                    }
                    Segment::Cubic(a, b, to) => {
                        coordinates("path", a)?;
                        coordinates("path", b)?;
                        coordinates("path", to)?;
                    }
                    Segment::Arc(arc) => {
                        for v in [arc.center, arc.u, arc.v, arc.to] {
                            coordinates("path arc", v)?;
                        }
                        error::coordinate("path arc rotation", arc.start)?;
                        error::coordinate("path arc rotation", arc.sweep)?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Checks both coordinates of a point.
pub(crate) fn coordinates(field: &'static str, v: DVec2) -> Result<()> {
    error::coordinate(field, v.x)?;
    error::coordinate(field, v.y)?;
    Ok(())
}

fn point(p: [f32; 2]) -> DVec2 {
    DVec2::new(f64::from(p[0]), f64::from(p[1]))
}

impl Contour {
    pub(crate) fn end(&self) -> DVec2 {
        self.segments.last().map_or(self.start, Segment::end)
    }

    pub(crate) fn is_straight(&self) -> bool {
        self.segments
            .iter()
            .all(|segment| matches!(segment, Segment::Line(_)))
    }

    /// Whether it is made of lines and circular arcs alone.
    pub(crate) fn is_of_circles(&self) -> bool {
        self.segments.iter().all(|segment| match segment {
            Segment::Line(_) => true,
            Segment::Arc(arc) => arc.is_circular(),
            Segment::Quad(..) | Segment::Cubic(..) => false,
        })
    }

    pub(crate) fn transformed(&self, affine: &DAffine2) -> Self {
        let map = |p| affine.transform_point2(p);
        let segments = self
            .segments
            .iter()
            .map(|segment| match *segment {
                Segment::Line(to) => Segment::Line(map(to)),
                Segment::Quad(a, to) => Segment::Quad(map(a), map(to)),
                Segment::Cubic(a, b, to) => Segment::Cubic(map(a), map(b), map(to)),
                Segment::Arc(arc) => Segment::Arc(EllipseArc {
                    center: map(arc.center),
                    u: affine.transform_vector2(arc.u),
                    v: affine.transform_vector2(arc.v),
                    to: map(arc.to),
                    ..arc
                }),
            })
            .collect();
        Self {
            start: map(self.start),
            segments,
            closed: self.closed,
        }
    }

    /// The vertices of a polygon nowhere farther than `flatness` from the contour, without the repeated first one.
    ///
    /// Each curve is cut the same way from either end, so that a contour and its reverse have the same vertices.
    pub(crate) fn flatten(&self, flatness: f64) -> Vec<DVec2> {
        let mut vertices = vec![self.start];
        let mut from = self.start;
        for segment in &self.segments {
            segment.flatten(from, flatness, &mut vertices);
            from = segment.end();
        }
        vertices.dedup();
        while vertices.len() > 1 && vertices.first() == vertices.last() {
            vertices.pop();
        }
        vertices
    }
}

impl Segment {
    pub(crate) fn end(&self) -> DVec2 {
        match *self {
            Self::Line(to) | Self::Quad(_, to) | Self::Cubic(_, _, to) => to,
            Self::Arc(arc) => arc.to,
        }
    }

    pub(crate) fn flatten(&self, from: DVec2, flatness: f64, out: &mut Vec<DVec2>) {
        let first = out.len();
        let to = self.end();
        let backwards = self.is_backwards(from);
        match *self {
            Self::Line(_) => {}
            // Out and back on a line: every point but the farthest would leave a sliver between its two ways.
            Self::Quad(control, _) if from == to => {
                out.extend([from.lerp(control, 0.5), to]);
                return;
            }
            Self::Cubic(c1, c2, _) if from == to && c1 == c2 => {
                out.extend([from.lerp(c1, 0.75), to]);
                return;
            }
            Self::Quad(control, _) => {
                let (a, b) = if backwards { (to, from) } else { (from, to) };
                let curve = QuadraticBezierSegment {
                    from: lyon_point(a),
                    ctrl: lyon_point(control),
                    to: lyon_point(b),
                };
                curve.for_each_flattened(flatness, &mut |line| {
                    out.push(DVec2::new(line.to.x, line.to.y));
                });
            }
            Self::Cubic(c1, c2, _) => {
                let (a, c1, c2, b) = if backwards {
                    (to, c2, c1, from)
                } else {
                    (from, c1, c2, to)
                };
                let curve = CubicBezierSegment {
                    from: lyon_point(a),
                    ctrl1: lyon_point(c1),
                    ctrl2: lyon_point(c2),
                    to: lyon_point(b),
                };
                curve.for_each_flattened(flatness, &mut |line| {
                    out.push(DVec2::new(line.to.x, line.to.y));
                });
            }
            Self::Arc(arc) => {
                arc.flatten(flatness, out);
                out.push(to);
                return;
            }
        }
        // The last vertex of a curve is its end: the one that is kept is exact.
        if out.len() > first {
            out.pop();
        }
        if backwards {
            out[first..].reverse();
        }
        out.push(to);
    }

    /// Whether the segment is the one of the two ways along its curve that is cut from its end.
    fn is_backwards(&self, from: DVec2) -> bool {
        let to = self.end();
        let (leaving, arriving) = match *self {
            // Only a loop needs more than its ends to tell.
            Self::Cubic(c1, c2, _) if from == to => (c1, c2),
            _ => (from, to),
        };
        (arriving.x, arriving.y) < (leaving.x, leaving.y)
    }
}

fn lyon_point(p: DVec2) -> Point<f64> {
    Point::new(p.x, p.y)
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
    fn through(
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
        let away = sqrt((1.0 / h.length_squared() - 1.0).max(0.0));
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

    /// Pushes the vertices between the arc's ends.
    fn flatten(&self, flatness: f64, out: &mut Vec<DVec2>) {
        let longest = sqrt(self.u.length_squared() + self.v.length_squared());
        let count = arc_steps(longest, self.sweep, flatness);
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

    #[test]
    fn curves_are_flattened_alike_from_both_ends() {
        let mut forth = Path::new();
        forth
            .move_to([0.1, 0.2])
            .cubic_to([3.0, 9.0], [7.0, -4.0], [10.3, 2.7]);
        forth.quad_to([9.0, 9.0], [4.0, 8.0]);
        let mut back = Path::new();
        back.move_to([4.0, 8.0]).quad_to([9.0, 9.0], [10.3, 2.7]);
        back.cubic_to([7.0, -4.0], [3.0, 9.0], [0.1, 0.2]);
        let mut reversed = back.contours[0].flatten(1e-3);
        reversed.reverse();
        assert_eq!(forth.contours[0].flatten(1e-3), reversed);
    }

    #[test]
    fn arcs_and_loops_are_flattened_alike_both_ways() {
        let from = [0.1, 0.2];
        let mut ways: Vec<[Path; 2]> = Vec::new();
        for (large, positive) in [(false, false), (false, true), (true, false), (true, true)] {
            let arc = |from, positive, to| {
                let mut path = Path::new();
                path.move_to(from)
                    .arc_to([5.1, 3.3], 0.5, large, positive, to);
                path
            };
            for to in [[4.3, 1.7], [30.0, -7.0], [-2.0, 3.0]] {
                ways.push([arc(from, positive, to), arc(to, !positive, from)]);
            }
        }
        let cubic = |a, b| {
            let mut path = Path::new();
            path.move_to(from).cubic_to(a, b, from);
            path
        };
        ways.push([cubic([9.0, 4.3], [2.0, 7.1]), cubic([2.0, 7.1], [9.0, 4.3])]);
        for [forth, back] in ways {
            for flatness in [1e-5, 1e-3, 1.0] {
                let forth = forth.contours[0].flatten(flatness);
                let mut back = back.contours[0].flatten(flatness);
                // A loop begins where it ends.
                let closed = usize::from(forth[0] == back[0]);
                back[closed..].reverse();
                assert_eq!(forth, back);
            }
        }
    }

    #[test]
    fn curves_that_come_back_on_a_line_enclose_nothing() {
        let mut path = Path::new();
        path.move_to([5.25, 14.25])
            .quad_to([19.25, 16.0], [5.25, 14.25])
            .cubic_to([1.25, 2.25], [1.25, 2.25], [5.25, 14.25]);
        let at = |x, y| DVec2::new(x, y);
        assert_eq!(
            path.contours[0].flatten(1e-3),
            [
                at(5.25, 14.25),
                at(12.25, 15.125),
                at(5.25, 14.25),
                at(2.25, 5.25)
            ]
        );
    }

    #[test]
    fn segments_after_close_begin_a_contour() {
        let mut path = Path::new();
        path.move_to([1.0, 1.0])
            .line_to([2.0, 1.0])
            .line_to([2.0, 2.0])
            .close();
        path.line_to([5.0, 5.0]);
        assert_eq!(path.contours.len(), 2);
        assert_eq!(path.contours[1].start, DVec2::ONE);
    }
}
