//! Curves as pixels need them: by few pieces that are not on the curve but cover the same area.
//!
//! What a pixel sees of a caster is an area, that inside of a disc. So each part of a curve is replaced by lines or an arc that
//! enclose as much with the part's chord, a *fit*: of parts that lie in the disc as a whole nothing remains. Where the disc's edge cuts
//! through a part no more is left than the largest area that the curve and its fit have between them from an end on.
//!
//! So there are two ways for a part to be fine enough:
//!
//! - It is *narrow*: no point of it is farther from its fit than flattening allows anyway.
//! - It is *balanced*: where the disc's edge crosses the curve, going in and coming out, it leaves too small an area.
//!   A disc smaller than the part cannot see more either: that is all by which the fit lies above the curve, and all by
//!   which it lies below.
//!
//! Only where the disc's edge runs along the curve may it cut through many parts, and each of them twice. That takes a
//! curve with nearly the disc's own radius all along: so the sum over such parts has a bound of its own. For circles
//! whose radius differs from the disc's by a fifth the first bound held, at a twentieth it was passed by half.

use core::f64::consts::PI;

use glam::DVec2;

use super::of_shape::circular;
use super::{Edge, Line};
use crate::density::flatness;
use crate::path::{Contour, Curve, Part, Segment};

/// A curve has no more parts than this, whatever is asked for.
const MOST_PARTS: u32 = 4096;

/// For how many borders in one disc the error is meant: a stroke has two, and so has the tip of a corner. Counted for one,
/// hearts and letters passed their tolerance by half, others by more.
pub(super) const BORDERS: f64 = 2.0;

/// How near a curve's radius must be to the disc's for the disc's edge to run along it.
const ALONG: f64 = 0.05;

/// What replaces a part of a curve.
pub(super) trait Fit {
    /// The root of their excess by which more parts are needed for them to be narrow.
    fn root_of_width(excess: f64) -> f64;

    /// The same for them to be balanced.
    fn root_of_area(excess: f64) -> f64;

    /// For a part.
    fn new(part: &Part) -> Self;

    /// How far any point of the part may be from it.
    fn deviation(&self) -> f64;

    /// The area that is left where the disc's edge crosses it twice.
    fn lobes(&self) -> f64;

    /// All that the disc's edge may leave over where it cuts through the part.
    fn unbalanced(&self) -> f64;

    fn push(&self, out: &mut Vec<Edge>);
}

/// How wrong the fits of a curve may be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fineness {
    /// How far they may be from the curve when their errors do not cancel.
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

/// Pushes a contour's edges, closed: lines and circular arcs as they are, and fits of other curves.
pub(super) fn push_contour<F: Fit>(contour: &Contour, fineness: &Fineness, out: &mut Vec<Edge>) {
    for (from, segment) in contour.walk() {
        push_segment::<F>(from, segment, fineness, out);
    }
    push_line(contour.end(), contour.start, out);
}

fn push_segment<F: Fit>(from: DVec2, segment: &Segment, fineness: &Fineness, out: &mut Vec<Edge>) {
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
    for part in curve.parts(part_count::<F>(&curve, fineness)) {
        F::new(&part).push(out);
    }
}

pub(super) fn push_line(from: DVec2, to: DVec2, out: &mut Vec<Edge>) {
    if from != to {
        out.push(Edge::Line(Line { from, to }));
    }
}

/// Whether a part ends so near its start that its chord says little about it.
pub(super) fn is_hairpin(part: &Part) -> bool {
    let longest = part
        .leaving
        .length_squared()
        .max(part.arriving.length_squared());
    part.chord().length_squared() * 64.0 <= longest
}

/// Into how many parts a curve is cut: about the fewest that are fine enough.
fn part_count<F: Fit>(curve: &Curve, fineness: &Fineness) -> u32 {
    let mut count = curve.fewest_parts();
    while count < MOST_PARTS {
        let excess = excess::<F>(curve, count, fineness);
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
fn excess<F: Fit>(curve: &Curve, count: u32, fineness: &Fineness) -> f64 {
    let (mut worst, mut length, mut along): (f64, f64, f64) = (0.0, 0.0, 0.0);
    let mut all_along = true;
    for part in curve.parts(count) {
        let chord = part.chord().length();
        length += chord;
        let runs_along = runs_along(&part, chord, fineness.radius);
        all_along &= runs_along;
        let fit = F::new(&part);
        let unbalanced = fit.unbalanced() / fineness.area;
        if unbalanced <= 1.0 && !runs_along {
            continue;
        }
        let wide = fit.deviation() / fineness.flat;
        if wide > 1.0 {
            worst = worst.max(F::root_of_width(wide).min(F::root_of_area(unbalanced)));
            along += f64::from(u8::from(runs_along)) * fit.lobes();
        }
    }
    if along > 0.0 {
        // The next curve may go on as this one ends; and all may, round the disc, where all of this one does.
        let around = 2.0 * PI * fineness.radius / length;
        let rounds = if all_along { around.max(2.0) } else { 2.0 };
        worst = worst.max(F::root_of_width(along * rounds / fineness.area));
    }
    worst
}

/// |c × S|, which is 3/2 of the area between the parabola that goes a part's way and its chord c; S is the rise.
pub(super) fn bulge(part: &Part) -> f64 {
    part.chord().perp_dot(part.rise()).abs()
}

/// Whether a part is bent nearly as much as the disc's edge.
fn runs_along(part: &Part, chord: f64, radius: f64) -> bool {
    let turn = 8.0 * bulge(part) / (chord * chord);
    // The turn over the length is the curvature, some percent too large where the part turns far.
    (turn * radius / chord - 1.0).abs() < ALONG * (1.0 + turn * turn)
}
