//! Cutting an outline down to a box.
//!
//! What lies outside of a side of the box is replaced by its projection on that side. Seen from anywhere inside, the
//! loops wind as before, so a disc that stays in the box meets the same area; and a region of many edges is left with
//! the few that it can meet.

use core::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;
use libm::acos;

use super::{Edge, Line};

/// The part of the plane where the coordinate along `axis` is at least `bound`, or at most.
#[derive(Clone, Copy)]
struct HalfPlane {
    axis: usize,
    bound: f64,
    above: bool,
}

/// Cuts loops to the box from `min` to `max` into `out`, using `scratch`, and tells whether an edge of the outline
/// itself is left. `out` holds one list of edges: their order within a loop is kept, the loops' limits are not.
pub(crate) fn clip_to_box(
    edges: &[Edge],
    min: DVec2,
    max: DVec2,
    scratch: &mut Vec<Edge>,
    out: &mut Vec<Edge>,
) -> bool {
    let side = |from: &[Edge], to: &mut Vec<Edge>, axis, bound, above| {
        to.clear();
        let plane = HalfPlane { axis, bound, above };
        for edge in from {
            plane.clip(edge, to);
        }
    };
    side(edges, scratch, 0, min.x, true);
    side(scratch, out, 0, max.x, false);
    side(out, scratch, 1, min.y, true);
    side(scratch, out, 1, max.y, false);
    out.iter().any(|edge| !matches!(edge, Edge::Border(_)))
}

impl HalfPlane {
    /// How far inside a point is.
    fn depth(&self, p: DVec2) -> f64 {
        let depth = p[self.axis] - self.bound;
        if self.above { depth } else { -depth }
    }

    fn project(&self, mut p: DVec2) -> DVec2 {
        p[self.axis] = self.bound;
        p
    }

    fn clip(&self, edge: &Edge, out: &mut Vec<Edge>) {
        match *edge {
            Edge::Line(line) => self.clip_line(line, Edge::Line, out),
            Edge::Border(line) => self.clip_line(line, Edge::Border, out),
            Edge::Arc(arc) => {
                // The coordinate along the axis is center + radius cos(θ - φ), φ the axis' direction.
                let offset = (self.bound - arc.center[self.axis]) / arc.radius;
                let direction = if self.axis == 0 { 0.0 } else { FRAC_PI_2 };
                let (middle, cosine) = if self.above {
                    (direction, offset)
                } else {
                    (direction + PI, -offset)
                };
                let half_width = if cosine >= 1.0 {
                    0.0
                } else if cosine <= -1.0 {
                    PI
                } else {
                    acos(cosine)
                };
                arc.split(middle, half_width, |mut piece, inside| {
                    if !inside {
                        self.push_outside(piece.from, piece.to, out);
                        return;
                    }
                    // Rounding may leave a cut end beside the side: it belongs on it.
                    for end in [&mut piece.from, &mut piece.to] {
                        if self.depth(*end) < 0.0 {
                            *end = self.project(*end);
                        }
                    }
                    out.push(Edge::Arc(piece));
                });
            }
        }
    }

    fn clip_line(&self, line: Line, kind: fn(Line) -> Edge, out: &mut Vec<Edge>) {
        let (a, b) = (self.depth(line.from), self.depth(line.to));
        if a >= 0.0 && b >= 0.0 {
            out.push(kind(line));
        } else if a < 0.0 && b < 0.0 {
            self.push_outside(line.from, line.to, out);
        } else {
            let cut = self.project(line.from + (line.to - line.from) * (a / (a - b)));
            if a < 0.0 {
                self.push_outside(line.from, cut, out);
                out.push(kind(Line {
                    from: cut,
                    to: line.to,
                }));
            } else {
                out.push(kind(Line {
                    from: line.from,
                    to: cut,
                }));
                self.push_outside(cut, line.to, out);
            }
        }
    }

    /// The projection of what runs outside from `from` to `to`, joined to the one before it.
    fn push_outside(&self, from: DVec2, to: DVec2, out: &mut Vec<Edge>) {
        let (from, to) = (self.project(from), self.project(to));
        if let Some(Edge::Border(last)) = out.last_mut()
            && last.to == from
            && last.from[self.axis] == self.bound
        {
            last.to = to;
            if last.from == to {
                out.pop();
            }
            return;
        }
        if from != to {
            out.push(Edge::Border(Line { from, to }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outline::Outline;
    use crate::shape::Shape;

    fn clipped_area(shape: &Shape, min: DVec2, max: DVec2) -> (f64, bool) {
        let edges: Vec<Edge> = Outline::of_simple(shape)
            .unwrap()
            .edges()
            .copied()
            .collect();
        let (mut scratch, mut out) = (Vec::new(), Vec::new());
        let met = clip_to_box(&edges, min, max, &mut scratch, &mut out);
        (Outline { loops: vec![out] }.area(), met)
    }

    #[test]
    fn circles_are_cut_to_their_exact_area() {
        let circle = Shape::circle([0.0, 0.0], 2.0).unwrap();
        let quarter = clipped_area(&circle, DVec2::ZERO, DVec2::splat(3.0));
        assert!((quarter.0 - PI).abs() < 1e-12 && quarter.1);
        // A strip through the middle: 2 (x sqrt(4 - x²) + 4 asin(x / 2)) from -1 to 1, over 2.
        let strip = clipped_area(&circle, DVec2::new(-1.0, -5.0), DVec2::new(1.0, 5.0));
        let expected = 2.0 * (3.0_f64.sqrt() + 4.0 * (0.5_f64).asin());
        assert!((strip.0 - expected).abs() < 1e-12);
        // Inside, outside, and beside a box.
        assert_eq!(
            clipped_area(&circle, DVec2::splat(-0.5), DVec2::splat(0.5)),
            (1.0, false)
        );
        assert_eq!(
            clipped_area(&circle, DVec2::splat(1.6), DVec2::splat(3.0)),
            (0.0, false)
        );
        let whole = clipped_area(&circle, DVec2::splat(-3.0), DVec2::splat(3.0));
        assert!((whole.0 - 4.0 * PI).abs() < 1e-12);
    }

    #[test]
    fn rectangles_keep_what_is_in_the_box() {
        let rect = Shape::rect(0.0, 0.0, 10.0, 4.0).unwrap();
        let (area, met) = clipped_area(&rect, DVec2::new(2.0, -1.0), DVec2::new(5.0, 3.0));
        assert!((area - 9.0).abs() < 1e-12 && met);
        assert_eq!(
            clipped_area(&rect, DVec2::new(20.0, 0.0), DVec2::new(30.0, 4.0)).0,
            0.0
        );
    }
}
