//! What an arc adds to the densities of sixteen pixels at once, and what discs have of a whole circle: by where the two
//! circles cross.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};
use glam::DVec2;

use super::kernels::{FRAC_1_PI, Ramp, half_disc_at};

/// asin t - t sqrt(1 - t²) = t³ p(t²) up to t = sqrt(1/2): a minimax fit of p, within 7e-6. It is half of a circular
/// segment's area over its squared radius, t half of its chord over the radius.
const SEGMENT: [f32; 4] = [0.665_331_5, 0.219_642_06, 0.015_186_033, 0.226_079_21];

/// The power of pixels with respect to a circle (Steiner 1826): the squared distance from its centre less its squared radius.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Power<S: Simd> {
    start: f32x16<S>,
    slope: f32,
    curvature: f32,
}

impl<S: Simd> Power<S> {
    /// For a circle whose centre is there from the first pixel, each lane's pixel so far `down` from that one's row; from one column to
    /// the next by so much.
    #[inline(always)]
    pub(crate) fn of(center: DVec2, radius: f64, pitch: f64, down: f32x16<S>) -> Self {
        // A difference of squares taken in single precision would have no digits left.
        let power = center.x * center.x + (center.y - radius) * (center.y + radius);
        Self {
            start: down * (down - (2.0 * center.y) as f32) + power as f32,
            slope: (-2.0 * center.x * pitch) as f32,
            curvature: (pitch * pitch) as f32,
        }
    }

    #[inline(always)]
    pub(crate) fn at(self, columns: f32x16<S>) -> f32x16<S> {
        columns * (columns * self.curvature + self.slope) + self.start
    }
}

/// An end of an arc: its x counted from the arc's centre, its y, and how far right or left of a pixel it may be inside the disc, which
/// is negative where it is above or below it.
#[derive(Debug, Clone, Copy)]
pub(super) struct ArcEnd<S: Simd> {
    pub(super) x: f32,
    pub(super) y: f32x16<S>,
    pub(super) width: f32x16<S>,
}

/// An arc along which y only rises or only falls, seen from pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowArc<S: Simd> {
    pub(super) center: Ramp<S>,
    pub(super) center_y: f32x16<S>,
    pub(super) radius: f32,
    pub(super) power: Power<S>,
    /// 1 where it turns from the x axis to the y axis, else -1.
    pub(super) turn: f32,
    /// 1 where it lies right of its centre, else -1.
    pub(super) side: f32,
    pub(super) from: ArcEnd<S>,
    pub(super) to: ArcEnd<S>,
    /// 1 where y rises along it, else -1.
    pub(super) rise: f32,
    /// The x, counted from its centre, of a point of it within the disc's height.
    pub(super) middle: f32x16<S>,
    /// The same of the point in the middle of that height, which has fewer digits.
    pub(super) beside: f32x16<S>,
    /// `half_disc` at its start's y and at its end's.
    pub(super) halves: [f32x16<S>; 2],
    /// The area between the whole arc and its chord, over π.
    pub(super) segment: f32,
}

/// The area between an arc and its chord, over π, for half of the chord and the square of that.
#[inline(always)]
fn segment<S: Simd>(simd: S, half_chord: f32x16<S>, squared: f32x16<S>, radius: f32) -> f32x16<S> {
    let t2 = (squared * (1.0 / (radius * radius))).min(f32x16::splat(simd, 0.5));
    let [a, b, c, d] = SEGMENT;
    let p = t2 * (t2 * (t2 * d + c) + b) + a;
    squared * half_chord * p * (FRAC_1_PI / radius)
}

/// The area between an arc and its chord, over π, for the squared chord.
pub(super) fn segment_of(squared_chord: f32, radius: f32) -> f32 {
    let t2 = (squared_chord * (0.25 / (radius * radius))).min(0.5);
    let [a, b, c, d] = SEGMENT;
    let p = a + t2 * (b + t2 * (c + t2 * d));
    squared_chord * squared_chord.sqrt() * p * (0.125 * FRAC_1_PI / radius)
}

/// So near to the middle, over the disc's radius, a point of its circle is at its top: rounding moves where circles touch by some 1e-3.
const TOP: f32 = 4e-3;

/// Where the arc's circle crosses the disc's: at one base and as far from it on both sides.
struct Crossings<S: Simd> {
    base: [f32x16<S>; 2],
    aside: [f32x16<S>; 2],
    /// The squared distance of the two centres, 1 over it, and the squared distance of both points over it, where there are any.
    distance: f32x16<S>,
    inverse: f32x16<S>,
    squared: f32x16<S>,
}

impl<S: Simd> Crossings<S> {
    #[inline(always)]
    fn find(simd: S, columns: f32x16<S>, arc: &RowArc<S>) -> Self {
        let center_x = arc.center.at(columns);
        // At `toward` of the way to the arc's centre.
        let power = arc.power.at(columns);
        // Of the centre's own coordinates, so that both points lie on the disc's circle however near to each other the centres
        // are.
        let distance = center_x * center_x + arc.center_y * arc.center_y;
        let inverse = f32x16::splat(simd, 1.0) / distance.max(f32x16::splat(simd, 1e-12));
        let toward = (power + 1.0) * 0.5 * inverse;
        let squared = inverse - toward * toward;
        let aside = squared.max(f32x16::splat(simd, 0.0)).sqrt() * arc.turn;
        Self {
            base: [toward * center_x, toward * arc.center_y],
            aside: [aside * arc.center_y, aside * center_x],
            distance,
            inverse,
            squared,
        }
    }

    /// Where the arc enters the disc.
    #[inline(always)]
    fn enter(&self) -> [f32x16<S>; 2] {
        [self.base[0] - self.aside[0], self.base[1] + self.aside[1]]
    }

    /// Where the arc leaves the disc.
    #[inline(always)]
    fn leave(&self) -> [f32x16<S>; 2] {
        [self.base[0] + self.aside[0], self.base[1] - self.aside[1]]
    }
}

/// What an arc adds that runs inside from one point to another.
#[inline(always)]
fn inside<S: Simd>(
    simd: S,
    from: [f32x16<S>; 2],
    to: [f32x16<S>; 2],
    arc: &RowArc<S>,
) -> f32x16<S> {
    let (chord_x, chord_y) = (to[0] - from[0], to[1] - from[1]);
    let squared = (chord_x * chord_x + chord_y * chord_y) * 0.25;
    (from[0] + to[0]) * chord_y * (0.5 * FRAC_1_PI)
        + segment(simd, squared.sqrt(), squared, arc.radius) * arc.turn
}

/// Whether the circles cross within the arc, where neither of its ends is inside: at the first point it enters, at the second it
/// leaves, in this order or not.
#[inline(always)]
fn crosses<S: Simd>(
    simd: S,
    center_x: f32x16<S>,
    crossings: &Crossings<S>,
    [enter, leave]: [[f32x16<S>; 2]; 2],
    arc: &RowArc<S>,
) -> mask32x16<S> {
    // How far beyond its ends a point may seem to lie that rounding has moved there, and the more of it the nearer the two
    // centres are: over their squared distance.
    const SLACK: f32 = 1e-5;
    const SLACK_NEAR: f32 = 1e-9;
    // Order along the arc is order along y.
    let rise = arc.rise;
    let (enters, leaves) = (enter[1] * rise, leave[1] * rise);
    let slack = crossings.inverse * SLACK_NEAR + SLACK;
    let beside = center_x * arc.side - slack;
    (enter[0] * arc.side).simd_ge(beside)
        & (leave[0] * arc.side).simd_ge(beside)
        & enters.min(leaves).simd_ge(arc.from.y * rise - slack)
        & enters.max(leaves).simd_le(arc.to.y * rise + slack)
        & crossings.squared.simd_gt(f32x16::splat(simd, 0.0))
}

impl<S: Simd> RowArc<S> {
    /// The arc's two ends, and which of them are inside.
    #[inline(always)]
    fn ends(&self, simd: S, center_x: f32x16<S>) -> [End<S>; 2] {
        let beside = self.beside(center_x);
        [
            End::seen(simd, center_x, &self.from, self.halves[0], beside),
            End::seen(simd, center_x, &self.to, self.halves[1], beside),
        ]
    }

    /// What tells on which side of the disc the arc is where a point of it lies at the disc's top or bottom: there its x is a matter of
    /// rounding.
    #[inline(always)]
    fn beside(&self, center_x: f32x16<S>) -> f32x16<S> {
        (center_x + self.beside) * TOP
    }

    /// What it adds where all of it is inside.
    #[inline(always)]
    fn whole(&self, from_x: f32x16<S>, to_x: f32x16<S>) -> f32x16<S> {
        let chord_y = (self.to.y - self.from.y) * (0.5 * FRAC_1_PI);
        (from_x + to_x) * chord_y + self.segment * self.turn
    }

    /// What it adds where nothing of it is inside.
    #[inline(always)]
    fn missed(&self, simd: S, center_x: f32x16<S>) -> f32x16<S> {
        let seen = center_x + self.middle + self.beside(center_x);
        let side = f32x16::splat(simd, 1.0).copysign(seen);
        side * (self.halves[1] - self.halves[0])
    }
}

/// An end of an arc, as a row sees it.
struct End<S: Simd> {
    point: [f32x16<S>; 2],
    is_in: mask32x16<S>,
    /// Its x if it is as high as the disc, or 0, and [`RowArc::beside`]: a crossing beside it may be at the disc's top.
    seen_x: f32x16<S>,
    /// `half_disc` at its y.
    half: f32x16<S>,
}

impl<S: Simd> End<S> {
    #[inline(always)]
    fn seen(
        simd: S,
        center_x: f32x16<S>,
        end: &ArcEnd<S>,
        half: f32x16<S>,
        beside: f32x16<S>,
    ) -> Self {
        let (x, zero) = (center_x + end.x, f32x16::splat(simd, 0.0));
        Self {
            point: [x, end.y],
            is_in: x.abs().simd_lt(end.width),
            seen_x: end.width.simd_gt(zero).select(x, zero) + beside,
            half,
        }
    }

    /// The disc's half at a crossing less that at the height of this end beyond, on the side of the disc where this part is.
    #[inline(always)]
    fn beyond(&self, simd: S, [x, y]: [f32x16<S>; 2]) -> f32x16<S> {
        let side = f32x16::splat(simd, 1.0).copysign(x + self.seen_x);
        (half_disc_at(simd, x, y) - self.half) * side
    }
}

/// An arc of so large a radius that it runs inside between any two of its points that are inside.
#[inline(always)]
pub(super) fn long_arc<S: Simd>(simd: S, columns: f32x16<S>, arc: &RowArc<S>) -> f32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    let center_x = arc.center.at(columns);
    let [from, to] = arc.ends(simd, center_x);
    let (any_in, both_in) = (from.is_in | to.is_in, from.is_in & to.is_in);
    if both_in.all_true() {
        return arc.whole(from.point[0], to.point[0]);
    }
    let crossings = Crossings::find(simd, columns, arc);
    let (enter, leave) = (crossings.enter(), crossings.leave());
    let rise = arc.rise;
    let missed = arc.missed(simd, center_x);
    let mut met = any_in;
    if !any_in.all_true() {
        let passed = !any_in
            & crosses(simd, center_x, &crossings, [enter, leave], arc)
            & (enter[1] * rise).simd_le(leave[1] * rise);
        met |= passed;
        if !met.any_true() {
            return missed;
        }
        if passed.any_true() {
            let p = select_point(from.is_in, from.point, enter);
            let q = select_point(to.is_in, to.point, leave);
            let before = from.is_in.select(zero, from.beyond(simd, enter));
            let after = to.is_in.select(zero, to.beyond(simd, leave));
            return met.select(inside(simd, p, q, arc) + (before - after), missed);
        }
    }
    // At most one crossing, of which a disc's half need be found.
    let crossing = select_point(from.is_in, leave, enter);
    let p = select_point(from.is_in, from.point, crossing);
    let q = select_point(to.is_in, to.point, crossing);
    let end = End {
        seen_x: from.is_in.select(to.seen_x, from.seen_x),
        half: from.is_in.select(to.half, from.half),
        ..from
    };
    let outside = end.beyond(simd, crossing);
    let outside = both_in.select(zero, from.is_in.select(-outside, outside));
    met.select(inside(simd, p, q, arc) + outside, missed)
}

/// One of two points, lane by lane.
#[inline(always)]
fn select_point<S: Simd>(
    mask: mask32x16<S>,
    [x, y]: [f32x16<S>; 2],
    [other_x, other_y]: [f32x16<S>; 2],
) -> [f32x16<S>; 2] {
    [mask.select(x, other_x), mask.select(y, other_y)]
}

#[inline(always)]
pub(super) fn arc<S: Simd>(simd: S, columns: f32x16<S>, arc: &RowArc<S>) -> f32x16<S> {
    // An arc so near to the disc's own circle lies on it: where they cross is a matter of rounding.
    const SAME: f32 = 1e-4;
    let zero = f32x16::splat(simd, 0.0);
    let one = f32x16::splat(simd, 1.0);
    let center_x = arc.center.at(columns);
    let [from, to] = arc.ends(simd, center_x);
    let crossings = Crossings::find(simd, columns, arc);
    let (enter, leave) = (crossings.enter(), crossings.leave());
    let crossed = crosses(simd, center_x, &crossings, [enter, leave], arc);
    let rise = arc.rise;
    let (enters, leaves) = (enter[1] * rise, leave[1] * rise);
    let notched = from.is_in & to.is_in & crossed & leaves.simd_lt(enters);
    let same = (SAME - (arc.radius - 1.0).abs()).max(0.0);
    let met = (from.is_in | to.is_in | (crossed & enters.simd_le(leaves)))
        & crossings.distance.simd_ge(f32x16::splat(simd, same * same));

    // From p to q it runs inside; or, where notched, all but from p to q.
    let p = select_point(from.is_in, from.point, enter);
    let q = select_point(to.is_in, to.point, leave);
    let p = select_point(notched, leave, p);
    let q = select_point(notched, enter, q);
    let inside = inside(simd, p, q, arc);
    let before = from.is_in.select(zero, from.beyond(simd, enter));
    let after = to.is_in.select(zero, to.beyond(simd, leave));
    let added = inside + before - after;
    let notch = half_disc_at(simd, enter[0], enter[1]) - half_disc_at(simd, leave[0], leave[1]);
    let whole = arc.whole(from.point[0], to.point[0]);
    let but_notch = whole - inside + notch * one.copysign(crossings.base[0]);
    met.select(notched.select(but_notch, added), arc.missed(simd, center_x))
}

/// An arc that passes the disc's whole height: the disc's part beyond the two circles' common chord, and the arc's own
/// beyond that.
#[inline(always)]
pub(super) fn through_arc<S: Simd>(simd: S, columns: f32x16<S>, arc: &RowArc<S>) -> f32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    let area = of_large_circle(simd, arc.power.at(columns), arc.radius);
    // On the centre's other side it is the circle's other half that a disc may meet.
    let beyond = (arc.center.at(columns) * arc.side).simd_ge(zero);
    beyond.select(f32x16::splat(simd, 0.5), area) * arc.turn
}

/// What the disc has of a circle larger than it, less a half: its part beyond the two circles' common chord, and the circle's own
/// beyond that. `power` is the centre's squared distance less the squared radius.
#[inline(always)]
fn of_large_circle<S: Simd>(simd: S, power: f32x16<S>, radius: f32) -> f32x16<S> {
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let far = (power + radius * radius).max(zero).sqrt();
    let reach = ((power + 1.0) / (far * 2.0)).max(-one).min(one);
    let squared = (one - reach * reach).max(zero);
    let half_chord = squared.sqrt();
    segment(simd, half_chord, squared, radius) - half_disc_at(simd, half_chord, reach) * 2.0
}

/// What discs have of a circle of that radius, for the pixels' powers with respect to it.
#[inline(always)]
pub(crate) fn circle<S: Simd>(simd: S, power: f32x16<S>, radius: f32) -> f32x16<S> {
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let density = if radius >= core::f32::consts::SQRT_2 {
        of_large_circle(simd, power, radius) + 0.5
    } else {
        // What either has beyond the common chord.
        let squared = (power + radius * radius).max(f32x16::splat(simd, 1e-12));
        let scale = f32x16::splat(simd, 0.5) / squared.sqrt();
        let beyond = |chord: f32x16<S>| {
            let chord = chord.max(-one).min(one);
            let half = (one - chord * chord).max(zero).sqrt();
            f32x16::splat(simd, 0.5) - half_disc_at(simd, half, chord) * 2.0
        };
        let own = (power + 2.0 * radius * radius - 1.0) * scale / radius;
        beyond((power + 1.0) * scale) + beyond(own) * (radius * radius)
    };
    density.max(zero).min(one)
}
