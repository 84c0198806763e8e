//! Curves as lines that cover the same area.
//!
//! A parabola's part with the chord c and the rise S, from the middle of the chord to the middle of the part, is replaced by two
//! lines from its ends to an apex 4/3 S from the middle of the chord. Along the chord, t from 0 to 1, the curve rises by
//! 4 t (1 - t) S, the lines by 8/3 t S up to the middle: the curve is up to S / 9 above the lines, from a third on up to S / 3 below,
//! and the area between is 0 in each half. From an end to the third it is 2/81 of |c × S|.
//!
//! Cubics differ from the parabolas that go their way by √3 / 36 of their third difference at most, to one side in their
//! first half and as much to the other in the second: they get the same two lines, by their own area.

use glam::DVec2;
use libm::cbrt;

use super::Edge;
use super::fit::{self, BORDERS, Fineness, Fit, bulge, is_hairpin, push_line};
use crate::path::{Contour, Part};

/// The area that is left where the disc's edge crosses a balanced curve twice, over |c × S|.
const LOBES: f64 = 4.0 / 81.0;

/// The largest distance between a cubic and the parabola that goes its way, over its third difference.
const TWIST_REACH: f64 = 0.048_112_522_432_468_816;

/// The area that this leaves at two crossings, over the third difference times the derivative.
const TWIST_LOBES: f64 = 1.0 / 32.0;

/// Two lines in place of a part.
pub(super) struct Chords {
    part: Part,
    /// By how much the apex is moved for the area that the part has beyond the parabola's.
    across: DVec2,
}

impl Contour {
    /// Pushes the contour's edges, closed: lines and circular arcs as they are, other curves as lines that cover the same
    /// area.
    pub(crate) fn chords(&self, fineness: &Fineness, out: &mut Vec<Edge>) {
        fit::push_contour::<Chords>(self, fineness, out);
    }
}

impl Fit for Chords {
    fn root_of_width(excess: f64) -> f64 {
        excess.sqrt()
    }

    fn root_of_area(excess: f64) -> f64 {
        cbrt(excess)
    }

    fn new(part: &Part) -> Self {
        let chord = part.chord();
        let across = if is_hairpin(part) {
            DVec2::ZERO
        } else {
            -chord.perp() * (part.double_area_beyond_parabola() / chord.length_squared())
        };
        Self {
            part: *part,
            across,
        }
    }

    fn deviation(&self) -> f64 {
        let part = &self.part;
        part.rise().length() / 3.0 + part.twist().length() * TWIST_REACH + self.across.length()
    }

    fn lobes(&self) -> f64 {
        LOBES * bulge(&self.part)
    }

    fn unbalanced(&self) -> f64 {
        let part = &self.part;
        if is_hairpin(part) {
            return f64::INFINITY;
        }
        let twist = part.twist();
        let turn = [part.leaving, part.arriving].map(|along| twist.perp_dot(along).abs());
        let left = self.lobes() + TWIST_LOBES * turn[0].max(turn[1]);
        BORDERS * left + part.double_area_beyond_parabola().abs() / 2.0
    }

    fn push(&self, out: &mut Vec<Edge>) {
        // The point that makes a triangle of the part's area with its ends: that of the parabola, moved across the chord.
        let Part { from, to, .. } = self.part;
        let apex = from + (self.part.chord() / 2.0 + self.part.rise() * (4.0 / 3.0) + self.across);
        push_line(from, apex, out);
        push_line(apex, to, out);
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use super::*;
    use crate::density::{at_point, flatness};
    use crate::outline::{Outline, area, sides};
    use crate::path::{FillRule, Path};
    use crate::shape::Shape;

    fn edges(contour: &Contour, levels: f64, radius: f64) -> Vec<Edge> {
        let mut edges = Vec::new();
        contour.chords(&Fineness::new(levels, radius, 1.0), &mut edges);
        assert!(sides(&edges).all(|(a, b)| a.to() == b.from()));
        edges
    }

    /// A circle about the origin as everybody draws it.
    fn four_cubics(radius: f32) -> Path {
        let (r, h) = (radius, radius * 0.552_284_8);
        let mut path = Path::new();
        path.move_to([r, 0.0])
            .cubic_to([r, h], [h, r], [0.0, r])
            .cubic_to([-h, r], [-r, h], [-r, 0.0])
            .cubic_to([-r, -h], [-h, -r], [0.0, -r])
            .cubic_to([h, -r], [r, -h], [r, 0.0])
            .close();
        path
    }

    #[test]
    fn lines_cover_the_area_of_their_curves() {
        let mut parabolas = Path::new();
        parabolas
            .move_to([10.0, 20.0])
            .quad_to([50.0, -30.0], [90.0, 25.0])
            .quad_to([120.0, 80.0], [40.0, 70.0]);
        // Triangles with the start, and a third of each parabola's own.
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let triangle = cross([80.0, 5.0], [30.0, 50.0]) / 2.0;
        let exact = triangle
            + (cross([40.0, -50.0], [80.0, 5.0]) + cross([30.0, 55.0], [-50.0, 45.0])) / 3.0;
        for (levels, radius) in [(0.1, 0.0), (0.1, 3.0), (0.1, 30.0), (5.0, 10.0)] {
            let edges = edges(&parabolas.contours[0], levels, radius);
            assert!((area(edges.iter()) / exact - 1.0).abs() < 1e-9);
        }
        // Cubics have it too, whatever their shape.
        let mut cubics = Path::new();
        cubics
            .move_to([0.0, 0.0])
            .cubic_to([40.0, -60.0], [90.0, 70.0], [100.0, 10.0])
            .cubic_to([130.0, 90.0], [-20.0, 120.0], [5.0, 60.0]);
        let fine = area(edges(&cubics.contours[0], 1e-4, 0.0).iter());
        for (levels, radius) in [(0.1, 3.0), (0.1, 30.0), (5.0, 10.0)] {
            let coarse = edges(&cubics.contours[0], levels, radius);
            assert!((area(coarse.iter()) / fine - 1.0).abs() < 1e-9);
        }
        let ellipse = Shape::ellipse([3.0, 4.0], [80.0, 30.0]).unwrap();
        let area = area(edges(&ellipse.contours[0], 5.0, 20.0).iter());
        assert!((area / (2400.0 * PI) - 1.0).abs() < 2e-5, "{area}");
    }

    #[test]
    fn lines_and_circular_arcs_stay_as_they_are() {
        let mut path = Path::new();
        path.move_to([0.0, 0.0])
            .line_to([10.0, 0.0])
            .line_to([10.0, 0.0])
            .arc_to([5.0, 5.0], 0.0, true, true, [10.0, 6.0])
            .line_to([0.0, 6.0])
            .line_to([0.0, 0.0])
            .close();
        let edges = edges(&path.contours[0], 0.1, 4.0);
        let arcs = edges.iter().filter(|edge| matches!(edge, Edge::Arc(_)));
        assert_eq!((arcs.count(), edges.len()), (2, 5));
    }

    #[test]
    fn more_is_asked_of_small_discs_and_tolerances() {
        let path = four_cubics(50.0);
        let count = |levels, radius| edges(&path.contours[0], levels, radius).len();
        assert!(count(0.1, 1.0) > count(0.1, 8.0));
        assert!(count(0.1, 8.0) > count(0.1, 200.0));
        assert!(count(0.1, 8.0) > count(1.0, 8.0));
        // No more than chords on the curve would take.
        let flatness = flatness(0.1, 8.0, 1.0);
        assert!(count(0.1, 8.0) * 2 < path.contours[0].flatten(flatness).len());
    }

    #[test]
    fn curves_are_cut_alike_wherever_they_lie() {
        let path = |x: f32, y: f32| {
            let mut path = Path::new();
            path.move_to([x, y])
                .cubic_to(
                    [x + 40.5, y - 60.0],
                    [x + 90.0, y + 70.25],
                    [x + 100.0, y + 10.0],
                )
                .quad_to([x + 130.0, y + 90.0], [x + 5.0, y + 60.0]);
            path
        };
        let moved = edges(&path(4096.0, -512.0).contours[0], 0.1, 5.0);
        let edges = edges(&path(0.0, 0.0).contours[0], 0.1, 5.0);
        assert_eq!(edges.len(), moved.len());
        for (edge, moved) in edges.iter().zip(&moved) {
            let there = edge.from() + DVec2::new(4096.0, -512.0);
            assert!((there - moved.from()).length() < 1e-11);
        }
    }

    #[test]
    fn discs_that_run_along_the_curve_see_no_more_error() {
        for radius in [8.0_f32, 24.0] {
            let path = four_cubics(radius);
            let fine = Shape::path(&path, FillRule::NonZero).unwrap();
            let fine = Outline::of_flattened(&fine, 1e-6);
            for levels in [0.1, 1.0, 10.0] {
                let mut worst: f64 = 0.0;
                for i in -30..=30 {
                    let disc = f64::from(radius) * (1.0 + f64::from(i) * 1e-4);
                    let edges = edges(&path.contours[0], levels, disc);
                    let density = |edges: &mut dyn Iterator<Item = &Edge>| {
                        at_point(edges, DVec2::ZERO, disc) * 255.0
                    };
                    let error = density(&mut edges.iter()) - density(&mut fine.edges());
                    worst = worst.max(error.abs());
                }
                println!("radius {radius}, {levels} levels: {worst:.3}");
                assert!(worst <= levels, "{levels}: {worst}");
            }
        }
    }
}
