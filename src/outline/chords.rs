//! Curves as pixels need them: by lines that are not the curve's chords but cover the same area.
//!
//! What a pixel sees of a caster is an area, that inside of a disc. A parabola's piece with the chord c and the rise S,
//! from the middle of the chord to the middle of the piece, is replaced by two lines from its ends to an apex 4/3 S from
//! the middle of the chord. Along the chord, t from 0 to 1, the curve rises by 4 t (1 - t) S, the lines by 8/3 t S up to
//! the middle: the curve is up to S / 9 above the lines, from a third on up to S / 3 below, and the area between is 0 in
//! each half. Of pieces that lie in the disc as a whole nothing remains. Where the disc's edge cuts through a piece no
//! more is left than the area from an end to the third, 2/81 of |c × S|.
//!
//! So there are two ways for a piece to be fine enough:
//!
//! - It is *narrow*: no point of it is farther from its lines than flattening allows anyway.
//! - It is *balanced*: where the disc's edge crosses the curve, going in and coming out, it leaves at most 4/81 |c × S|.
//!   A disc smaller than the piece cannot see more either: that is all by which the lines lie above the curve, and all by
//!   which they lie below.
//!
//! Only where the disc's edge runs along the curve may it cut through many pieces, and each of them twice. That takes a
//! curve with nearly the disc's own radius all along: so the sum over such pieces has a bound of its own. For circles
//! whose radius differs from the disc's by a fifth the first bound held, at a twentieth it was passed by half.
//!
//! Cubics differ from the parabolas that go their way by √3 / 36 of their third difference at most, to one side in their
//! first half and as much to the other in the second: they get the same two lines, by their own area.

use core::f64::consts::PI;

use glam::DVec2;
use libm::cbrt;

use super::{Edge, Line, circular};
use crate::density::flatness;
use crate::path::{Contour, Curve, Part, Segment};

/// A curve has no more parts than this, whatever is asked for.
const MOST_PARTS: u32 = 4096;

/// The area that is left where the disc's edge crosses a balanced curve twice, over |c × S|.
const LOBES: f64 = 4.0 / 81.0;

/// The largest distance between a cubic and the parabola that goes its way, over its third difference.
const TWIST_REACH: f64 = 0.048_112_522_432_468_816;

/// The area that this leaves at two crossings, over the third difference times the derivative.
const TWIST_LOBES: f64 = 1.0 / 32.0;

/// For how many borders in one disc the error is meant: a stroke has two, and so has the tip of a corner. Counted for one,
/// hearts and letters passed their tolerance by half, others by more.
const BORDERS: f64 = 2.0;

/// How near a curve's radius must be to the disc's for the disc's edge to run along it.
const ALONG: f64 = 0.05;

/// How wrong the lines of a curve may be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fineness {
    /// How far lines may be from the curve when their errors do not cancel.
    flat: f64,
    /// The area by which what a disc or a pixel sees may be wrong.
    area: f64,
    /// The disc's radius.
    radius: f64,
}

impl Fineness {
    /// What moves no density by more than `levels`, for discs of `radius` and pixels of side `pixel`.
    pub(crate) fn new(levels: f64, radius: f64, pixel: f64) -> Self {
        // The density is an average over both: the larger one alone makes it right.
        let seen = (PI * radius * radius).max(pixel * pixel);
        Self {
            flat: flatness(levels, radius, pixel),
            area: levels / 255.0 * seen,
            radius,
        }
    }
}

impl Contour {
    /// Pushes the contour's edges, closed: lines and circular arcs as they are, other curves as lines that cover the same
    /// area.
    pub(crate) fn chords(&self, fineness: &Fineness, out: &mut Vec<Edge>) {
        let mut from = self.start;
        for segment in &self.segments {
            push_segment(from, segment, fineness, out);
            from = segment.end();
        }
        push_line(from, self.start, out);
    }
}

fn push_segment(from: DVec2, segment: &Segment, fineness: &Fineness, out: &mut Vec<Edge>) {
    if let Segment::Arc(arc) = segment
        && let Some(arcs) = circular(from, arc)
    {
        out.extend(arcs.map(Edge::Arc));
        return;
    }
    let Some(curve) = Curve::new(from, segment) else {
        push_line(from, segment.end(), out);
        return;
    };
    for part in curve.parts(part_count(&curve, fineness)) {
        let apex = apex(&part);
        push_line(part.from, apex, out);
        push_line(apex, part.to, out);
    }
}

fn push_line(from: DVec2, to: DVec2, out: &mut Vec<Edge>) {
    if from != to {
        out.push(Edge::Line(Line { from, to }));
    }
}

/// The point that makes a triangle of the part's area with its ends: that of the parabola, moved across the chord.
fn apex(part: &Part) -> DVec2 {
    let parabola = part.chord() / 2.0 + part.rise() * (4.0 / 3.0);
    part.from + parabola + across(part)
}

/// By how much the apex is moved for the area that the part has beyond the parabola's.
fn across(part: &Part) -> DVec2 {
    let chord = part.chord();
    if is_hairpin(part) {
        return DVec2::ZERO;
    }
    -chord.perp() * (part.double_area_beyond_parabola() / chord.length_squared())
}

/// Whether a part ends so near its start that its chord says little about it.
fn is_hairpin(part: &Part) -> bool {
    let longest = part
        .leaving
        .length_squared()
        .max(part.arriving.length_squared());
    part.chord().length_squared() * 64.0 <= longest
}

/// Into how many parts a curve is cut: about the fewest that are fine enough.
fn part_count(curve: &Curve, fineness: &Fineness) -> u32 {
    let mut count = curve.fewest_parts();
    while count < MOST_PARTS {
        let excess = excess(curve, count, fineness);
        if excess <= 1.0 {
            break;
        }
        // Few parts miss by more than the powers of their number say: shorter steps do not go past the fewest.
        let step = f64::from(count) * (excess - 1.0) * 0.7;
        count = (f64::from(count) + step.ceil()).min(f64::from(MOST_PARTS)) as u32;
    }
    count
}

/// How many times more parts it would take for all to be fine enough; less than 1 says no more than that they are.
fn excess(curve: &Curve, count: u32, fineness: &Fineness) -> f64 {
    let (mut worst, mut length, mut along): (f64, f64, f64) = (0.0, 0.0, 0.0);
    let mut all_along = true;
    for part in curve.parts(count) {
        let chord = part.chord().length();
        length += chord;
        let runs_along = runs_along(&part, chord, fineness.radius);
        all_along &= runs_along;
        let unbalanced = unbalanced(&part) / fineness.area;
        if unbalanced <= 1.0 && !runs_along {
            continue;
        }
        let wide = deviation(&part) / fineness.flat;
        if wide > 1.0 {
            worst = worst.max(wide.sqrt().min(cbrt(unbalanced)));
            along += f64::from(u8::from(runs_along)) * LOBES * bulge(&part);
        }
    }
    if along > 0.0 {
        // The next curve may go on as this one ends; and all may, round the disc, where all of this one does.
        let around = 2.0 * PI * fineness.radius / length;
        let rounds = if all_along { around.max(2.0) } else { 2.0 };
        worst = worst.max((along * rounds / fineness.area).sqrt());
    }
    worst
}

/// How far any point of the part may be from its two lines.
fn deviation(part: &Part) -> f64 {
    part.rise().length() / 3.0 + part.twist().length() * TWIST_REACH + across(part).length()
}

/// The area that the disc's edge may leave over where it cuts through the part.
fn unbalanced(part: &Part) -> f64 {
    if is_hairpin(part) {
        return f64::INFINITY;
    }
    let twist = part.twist();
    let turn = [part.leaving, part.arriving].map(|along| twist.perp_dot(along).abs());
    let left = LOBES * bulge(part) + TWIST_LOBES * turn[0].max(turn[1]);
    BORDERS * left + part.double_area_beyond_parabola().abs() / 2.0
}

/// |c × S|, which is 3/2 of the area between the parabola and its chord.
fn bulge(part: &Part) -> f64 {
    part.chord().perp_dot(part.rise()).abs()
}

/// Whether a part is bent nearly as much as the disc's edge.
fn runs_along(part: &Part, chord: f64, radius: f64) -> bool {
    let turn = 8.0 * bulge(part) / (chord * chord);
    // The turn over the length is the curvature, some percent too large where the part turns far.
    (turn * radius / chord - 1.0).abs() < ALONG * (1.0 + turn * turn)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::at_point;
    use crate::outline::Outline;
    use crate::path::{FillRule, Path};
    use crate::shape::Shape;

    fn edges(contour: &Contour, levels: f64, radius: f64) -> Vec<Edge> {
        let mut edges = Vec::new();
        contour.chords(&Fineness::new(levels, radius, 1.0), &mut edges);
        let nexts = edges.iter().cycle().skip(1);
        assert!(edges.iter().zip(nexts).all(|(a, b)| a.to() == b.from()));
        edges
    }

    fn area(edges: &[Edge]) -> f64 {
        let origin = edges[0].from();
        edges
            .iter()
            .map(|edge| edge.double_area(origin))
            .sum::<f64>()
            / 2.0
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
            assert!((area(&edges) / exact - 1.0).abs() < 1e-9);
        }
        // Cubics have it too, whatever their shape.
        let mut cubics = Path::new();
        cubics
            .move_to([0.0, 0.0])
            .cubic_to([40.0, -60.0], [90.0, 70.0], [100.0, 10.0])
            .cubic_to([130.0, 90.0], [-20.0, 120.0], [5.0, 60.0]);
        let fine = area(&edges(&cubics.contours[0], 1e-4, 0.0));
        for (levels, radius) in [(0.1, 3.0), (0.1, 30.0), (5.0, 10.0)] {
            let coarse = edges(&cubics.contours[0], levels, radius);
            assert!((area(&coarse) / fine - 1.0).abs() < 1e-9);
        }
        let ellipse = Shape::ellipse([3.0, 4.0], [80.0, 30.0]).unwrap();
        let area = area(&edges(&ellipse.contours[0], 5.0, 20.0));
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
