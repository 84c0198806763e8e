//! Polygons in place of contours.

use glam::DVec2;
use lyon::geom::{CubicBezierSegment, Point, QuadraticBezierSegment};

use super::{Contour, Segment};

impl Contour {
    /// The vertices of a polygon nowhere farther than `flatness` from the contour, without the repeated first one.
    ///
    /// Each curve is cut the same way from either end, so that a contour and its reverse have the same vertices.
    pub(crate) fn flatten(&self, flatness: f64) -> Vec<DVec2> {
        let mut vertices = vec![self.start];
        for (from, segment) in self.walk() {
            segment.flatten(from, flatness, &mut vertices);
        }
        vertices.dedup();
        while vertices.len() > 1 && vertices.first() == vertices.last() {
            vertices.pop();
        }
        vertices
    }
}

/// No fewer lines than flattening makes of contours (Wang 1984: of a curve's second differences).
pub(crate) fn lines(contours: &[Contour], flatness: f64) -> usize {
    let of_contour = |contour: &Contour| {
        let of_segment = |(from, segment): (DVec2, &Segment)| segment.lines(from, flatness);
        contour.walk().map(of_segment).sum::<f64>()
    };
    contours.iter().map(of_contour).sum::<f64>() as usize
}

impl Segment {
    fn lines(&self, from: DVec2, flatness: f64) -> f64 {
        let of_curve = |degree: f64, bend: DVec2| {
            let most = degree * (degree - 1.0) / 8.0 * bend.length() / flatness;
            most.sqrt().ceil().max(1.0)
        };
        match *self {
            Self::Line(_) => 1.0,
            Self::Quad(a, to) => of_curve(2.0, from - 2.0 * a + to),
            Self::Cubic(a, b, to) => {
                let bends = [from - 2.0 * a + b, a - 2.0 * b + to];
                of_curve(3.0, bends[0].abs().max(bends[1].abs()))
            }
            Self::Arc(arc) => f64::from(arc.steps(flatness)),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::Path;

    #[cfg(feature = "svg-path")]
    #[test]
    fn there_are_no_more_lines_than_are_told() {
        let curves = [
            "L1 7",
            "Q9 9 4 8",
            "C30 9 -7 -4 10.3 2.7",
            "C5 9 5 -9 .1 .2",
            "A5.1 3.3 30 1 0 4.3 1.7",
        ];
        for curve in curves {
            let path = Path::from_svg(&format!("M.1 .2 {curve}")).unwrap();
            for flatness in [1e-9, 1e-5, 1e-2, 0.3, 10.0] {
                let told = lines(&path.contours, flatness);
                // A contour has a vertex more than lines.
                let got = path.contours[0].flatten(flatness).len() - 1;
                assert!(
                    got <= told && told <= 3 * got + 1,
                    "{curve}, {flatness}: {got} of {told}"
                );
            }
        }
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
}
