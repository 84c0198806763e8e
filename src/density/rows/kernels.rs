//! What one piece of the outline adds to the densities of sixteen pixels of a row at once, in single precision.
//!
//! By Green's theorem the area that the outline shares with the unit disc about a pixel is the sum over its pieces of the
//! integral of x dy, with x held between the circle's two sides: left of the disc a piece counts -sqrt(1 - y²), right of it
//! +sqrt(1 - y²). No angle is needed, and far pieces are differences of one function of their ends' y, which cancel along
//! a closed loop. All values are divided by π, so that they add up to density.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};

const FRAC_1_PI: f32 = core::f32::consts::FRAC_1_PI;

/// 1/4 - S(t)/π = v^1.5 q(v), v = 1 - |t|, S(t) the integral of sqrt(1 - u²) from 0 to t: a minimax fit of q, within
/// 2e-5 level.
const HALF_DISC: [f32; 5] = [
    0.300_095_32,
    -0.044_906_14,
    -0.004_424_930_6,
    -0.000_129_709,
    -0.000_634_450_06,
];

/// asin u / 2π = u p(u²) up to u = sqrt(1/2): a minimax fit of p, within 1e-4 level.
const ARC_SINE: [f32; 5] = [
    0.159_160_64,
    0.026_317_384,
    0.014_039_524,
    -0.001_191_363_2,
    0.017_534_016,
];

/// asin t - t sqrt(1 - t²) = t³ p(t²) up to t = sqrt(1/2): a minimax fit of p, within 1e-6. It is half of a circular
/// segment's area over its squared radius, t half of its chord over the radius.
const SEGMENT: [f32; 5] = [
    0.666_950_5,
    0.193_937_35,
    0.151_199_71,
    -0.068_558_15,
    0.225_219_19,
];

/// The area of the unit disc between y = 0 and `t`, right of its centre, over π: from -1/4 to 1/4.
pub(crate) fn half_disc(t: f32) -> f32 {
    let v = (1.0 - t.abs()).max(0.0);
    let [a, b, c, d, e] = HALF_DISC;
    let tail = v * v.sqrt() * (a + v * (b + v * (c + v * (d + v * e))));
    (0.25 - tail).copysign(t)
}

/// As [`half_disc`], for sixteen numbers.
#[inline(always)]
pub(crate) fn half_discs<S: Simd>(simd: S, t: f32x16<S>) -> f32x16<S> {
    let v = (f32x16::splat(simd, 1.0) - t.abs()).max(f32x16::splat(simd, 0.0));
    let [a, b, c, d, e] = HALF_DISC;
    let tail = v * v.sqrt() * (v * (v * (v * (v * e + d) + c) + b) + a);
    (f32x16::splat(simd, 0.25) - tail).copysign(t)
}

/// The angle of a point (x, y) of the circle whose coordinates are not negative, in turns.
#[inline(always)]
fn quarter_turns<S: Simd>(simd: S, x: f32x16<S>, y: f32x16<S>) -> f32x16<S> {
    let u = x.min(y);
    let u2 = u * u;
    let [a, b, c, d, e] = ARC_SINE;
    let sine = u * (u2 * (u2 * (u2 * (u2 * e + d) + c) + b) + a);
    y.simd_le(x).select(sine, f32x16::splat(simd, 0.25) - sine)
}

/// The angle of a point (x, y) of the circle, from -1/2 turn to 1/2.
#[inline(always)]
pub(crate) fn turns<S: Simd>(simd: S, x: f32x16<S>, y: f32x16<S>) -> f32x16<S> {
    let near = quarter_turns(simd, x.abs(), y.abs());
    let is_left = x.simd_lt(f32x16::splat(simd, 0.0));
    is_left
        .select(f32x16::splat(simd, 0.5) - near, near)
        .copysign(y)
}

/// `half_disc(y)` for a point (x, y) of the circle: without a root, as x is one.
#[inline(always)]
fn half_disc_at<S: Simd>(simd: S, x: f32x16<S>, y: f32x16<S>) -> f32x16<S> {
    let (x, height) = (x.abs(), y.abs());
    let angle = quarter_turns(simd, x, height);
    (x * height * (0.5 * FRAC_1_PI) + angle).copysign(y)
}

/// What of the disc lies inside of a straight border so far inside of which its middle is: the profile F.
#[inline(always)]
pub(crate) fn whole_disc<S: Simd>(simd: S, depth: f32x16<S>) -> f32x16<S> {
    half_discs(simd, depth) * 2.0 + 0.5
}

/// A number that changes by the same step from pixel to pixel.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Ramp {
    pub(super) start: f32,
    pub(super) step: f32,
}

impl Ramp {
    #[inline(always)]
    fn at<S: Simd>(self, columns: f32x16<S>) -> f32x16<S> {
        columns * self.step + self.start
    }
}

/// A line that passes the disc's whole height: its profile is F(t) - 1/2.
#[inline(always)]
pub(super) fn through_line<S: Simd>(simd: S, columns: f32x16<S>, distance: Ramp) -> f32x16<S> {
    half_discs(simd, distance.at(columns)) * 2.0
}

/// F's second integral, from where F begins, is v^3.5 q(v) up to t = 0, v = 1 - |t|: a minimax fit of q, within 5e-10.
const SECOND: [f32; 5] = [
    0.068_594_73,
    -0.005_710_144,
    -0.000_342_512_4,
    -0.000_020_107_516,
    -0.000_021_966_567,
];

/// The second integral of F, the profile of a straight edge.
#[inline(always)]
fn second_integral<S: Simd>(simd: S, t: f32x16<S>) -> f32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    let v = (f32x16::splat(simd, 1.0) - t.abs()).max(zero);
    let [a, b, c, d, e] = SECOND;
    let tail = v * v * v * v.sqrt() * (v * (v * (v * (v * e + d) + c) + b) + a);
    // F(t) + F(-t) = 1.
    let inside = t * t * 0.5 + 0.125 - tail;
    t.simd_gt(zero).select(inside, tail)
}

/// What a pixel averages over: a square about its centre, of discs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wide {
    /// Half of the square's side, and the disc's radius.
    pub(crate) half: f64,
    pub(crate) radius: f64,
}

/// A line that passes all that a pixel averages over, seen from a row of pixels.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct WideLine {
    pub(super) distance: Ramp,
    /// Half of what the square's sides span across the line, the larger and the smaller.
    pub(super) spans: [f32; 2],
    pub(super) radius: f32,
}

/// The mean of F over a square: its second difference along both sides.
#[inline(always)]
fn mean_of_profile<S: Simd>(
    simd: S,
    distance: f32x16<S>,
    [larger, smaller]: [f32x16<S>; 2],
    radius: f32,
) -> f32x16<S> {
    // Farther away nothing changes but the differences' digits.
    let reach = larger + smaller + radius;
    let distance = distance.max(-reach).min(reach);
    let scale = 1.0 / radius;
    let (distance, outer, inner) = (
        distance * scale,
        (larger + smaller) * scale,
        (larger - smaller) * scale,
    );
    let outer = second_integral(simd, distance + outer) + second_integral(simd, distance - outer);
    let inner = second_integral(simd, distance + inner) + second_integral(simd, distance - inner);
    (outer - inner) * (radius * radius * 0.25) / (larger * smaller)
}

#[inline(always)]
pub(super) fn wide_line<S: Simd>(simd: S, columns: f32x16<S>, line: &WideLine) -> f32x16<S> {
    let [larger, smaller] = line.spans;
    let spans = [f32x16::splat(simd, larger), f32x16::splat(simd, smaller)];
    mean_of_profile(simd, line.distance.at(columns), spans, line.radius) - 0.5
}

/// An arc that passes all that a pixel averages over, seen from a row of pixels.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct WideArc {
    pub(super) center: Ramp,
    pub(super) center_y: f32,
    pub(super) arc_radius: f32,
    pub(super) turn: f32,
    pub(super) side: f32,
    /// Half of the square's side, and the disc's radius.
    pub(super) half: f32,
    pub(super) radius: f32,
}

/// The share of a square's side that its smaller span counts at least: a quotient of two tiny differences has no digits.
pub(super) const LEAST_SPAN: f32 = 0.004;

/// As the line that touches the arc nearest to the pixel, moved by the arc's mean distance from it: the mean square along it,
/// of the disc's chord and of the square, over twice the arc's radius. Both are taken for normally distributed.
#[inline(always)]
pub(super) fn wide_arc<S: Simd>(simd: S, columns: f32x16<S>, arc: &WideArc) -> f32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    let x = arc.center.at(columns);
    let far = (x * x + arc.center_y * arc.center_y)
        .max(f32x16::splat(simd, 1e-12))
        .sqrt();
    let (across, down) = (x.abs() / far, f32x16::splat(simd, arc.center_y.abs()) / far);
    let least = f32x16::splat(simd, LEAST_SPAN * arc.half);
    let spans = [
        across.max(down) * arc.half,
        (across.min(down) * arc.half).max(least),
    ];
    let distance = f32x16::splat(simd, arc.arc_radius) - far;
    // Of the distance the disc has the share of its variance in that of both, and what is left of variance by the square.
    let (disc, square) = (arc.radius * arc.radius, arc.half * arc.half);
    let share = disc / (disc + square * (4.0 / 3.0));
    let of_disc = distance * distance * (share * share) + square * (share / 3.0);
    let chord = (f32x16::splat(simd, disc) - of_disc).max(zero);
    let beside = (chord + square) * (1.0 / (6.0 * arc.arc_radius));
    let mean = mean_of_profile(simd, distance - beside, spans, arc.radius) - 0.5;
    // On the centre's other side it is the circle's other half that is near.
    let beyond = (x * arc.side).simd_ge(zero);
    beyond.select(f32x16::splat(simd, 0.5), mean) * arc.turn
}

/// A line that ends within the disc's height, seen from a row of pixels.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct RowLine {
    /// Its signed distance, and where on it its start is, counted from the foot point.
    pub(super) distance: Ramp,
    pub(super) start: Ramp,
    pub(super) length: f32,
    pub(super) along: [f32; 2],
    /// `half_disc` at its start's y and at its end's.
    pub(super) halves: [f32; 2],
}

#[inline(always)]
pub(super) fn line<S: Simd>(simd: S, columns: f32x16<S>, line: &RowLine) -> f32x16<S> {
    let distance = line.distance.at(columns);
    let start = line.start.at(columns);
    let halves = [
        f32x16::splat(simd, line.halves[0]),
        f32x16::splat(simd, line.halves[1]),
    ];
    line_at(simd, distance, start, line.length, line.along, halves)
}

/// A line by its signed distance and where on it its start is, counted from the foot point; `halves` are `half_disc` at its
/// start's y and at its end's.
#[inline(always)]
pub(crate) fn line_at<S: Simd>(
    simd: S,
    distance: f32x16<S>,
    start: f32x16<S>,
    length: f32,
    [along_x, along_y]: [f32; 2],
    halves: [f32x16<S>; 2],
) -> f32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    let one = f32x16::splat(simd, 1.0);
    let end = start + length;
    let half_chord = (one - distance * distance).max(zero).sqrt();
    // The part inside the disc; where there is none, both are the end nearer to it.
    let begins = start.simd_lt(-half_chord);
    let goes_on = half_chord.simd_lt(end);
    let first = (-half_chord).max(start).min(end);
    let last = half_chord.max(start).min(end);
    let met = first.simd_lt(last);
    let foot_x = distance * along_y;
    let beside = one.copysign(foot_x + first * along_x) * (halves[1] - halves[0]);
    if !met.any_true() {
        return beside;
    }

    let inside =
        (last - first) * (foot_x + (first + last) * (0.5 * along_x)) * (along_y * FRAC_1_PI);
    let foot_y = -(distance * along_x);
    let (chord_x, chord_y) = (half_chord * along_x, half_chord * along_y);
    // What lies outside, where there is some.
    let mut added = inside;
    if begins.any_true() {
        let (x, y) = (foot_x - chord_x, foot_y - chord_y);
        let before = (half_disc_at(simd, x, y) - halves[0]) * one.copysign(x);
        added += begins.select(before, zero);
    }
    if goes_on.any_true() {
        let (x, y) = (foot_x + chord_x, foot_y + chord_y);
        let after = (half_disc_at(simd, x, y) - halves[1]) * one.copysign(x);
        added -= goes_on.select(after, zero);
    }
    met.select(added, beside)
}

/// An arc along which y only rises or only falls, seen from a row of pixels.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct RowArc {
    pub(super) center: Ramp,
    pub(super) center_y: f32,
    pub(super) radius: f32,
    /// The pixel's squared distance from the centre less the squared radius: its value, slope and curvature. A
    /// difference of squares taken in single precision would have no digits left.
    pub(super) power: [f32; 3],
    /// 1 where it turns from the x axis to the y axis, else -1.
    pub(super) turn: f32,
    /// 1 where it lies right of its centre, else -1.
    pub(super) side: f32,
    /// Its ends, x counted from its centre, and how far right or left of the pixel they may be inside the disc.
    pub(super) from: [f32; 3],
    pub(super) to: [f32; 3],
    /// The x, counted from its centre, of a point of it within the disc's height.
    pub(super) middle: f32,
    /// `half_disc` at its start's y and at its end's.
    pub(super) halves: [f32; 2],
    /// The area between the whole arc and its chord, over π.
    pub(super) segment: f32,
}

/// The area between an arc and its chord, over π, for half of the chord and the square of that.
#[inline(always)]
fn segment<S: Simd>(simd: S, half_chord: f32x16<S>, squared: f32x16<S>, radius: f32) -> f32x16<S> {
    let t2 = (squared * (1.0 / (radius * radius))).min(f32x16::splat(simd, 0.5));
    let [a, b, c, d, e] = SEGMENT;
    let p = t2 * (t2 * (t2 * (t2 * e + d) + c) + b) + a;
    squared * half_chord * p * (FRAC_1_PI / radius)
}

/// The area between an arc and its chord, over π, for the squared chord.
pub(super) fn segment_of(squared_chord: f32, radius: f32) -> f32 {
    let t2 = (squared_chord * (0.25 / (radius * radius))).min(0.5);
    let [a, b, c, d, e] = SEGMENT;
    let p = a + t2 * (b + t2 * (c + t2 * (d + t2 * e)));
    squared_chord * squared_chord.sqrt() * p * (0.125 * FRAC_1_PI / radius)
}

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
    fn find(simd: S, columns: f32x16<S>, arc: &RowArc) -> Self {
        let center_x = arc.center.at(columns);
        // At `toward` of the way to the arc's centre.
        let power = arc.power(columns);
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
fn inside<S: Simd>(simd: S, from: [f32x16<S>; 2], to: [f32x16<S>; 2], arc: &RowArc) -> f32x16<S> {
    let (chord_x, chord_y) = (to[0] - from[0], to[1] - from[1]);
    let squared = (chord_x * chord_x + chord_y * chord_y) * 0.25;
    (from[0] + to[0]) * chord_y * (0.5 * FRAC_1_PI)
        + segment(simd, squared.sqrt(), squared, arc.radius) * arc.turn
}

/// The disc's half at a crossing less that at the height of the arc's end beyond, on the side of the disc where this part is.
#[inline(always)]
fn beyond<S: Simd>(simd: S, [x, y]: [f32x16<S>; 2], end: f32x16<S>, half: f32x16<S>) -> f32x16<S> {
    (half_disc_at(simd, x, y) - half) * f32x16::splat(simd, 1.0).copysign(x + end)
}

/// Whether the circles cross within the arc, where neither of its ends is inside: at the first point it enters, at the second it
/// leaves, in this order or not.
#[inline(always)]
fn crosses<S: Simd>(
    simd: S,
    center_x: f32x16<S>,
    crossings: &Crossings<S>,
    [enter, leave]: [[f32x16<S>; 2]; 2],
    arc: &RowArc,
) -> mask32x16<S> {
    // How far beyond its ends a point may seem to lie that rounding has moved there, and the more of it the nearer the two
    // centres are: over their squared distance.
    const SLACK: f32 = 1e-5;
    const SLACK_NEAR: f32 = 1e-9;
    // Order along the arc is order along y.
    let rise = arc.rise();
    let (enters, leaves) = (enter[1] * rise, leave[1] * rise);
    let slack = crossings.inverse * SLACK_NEAR + SLACK;
    let beside = center_x * arc.side - slack;
    (enter[0] * arc.side).simd_ge(beside)
        & (leave[0] * arc.side).simd_ge(beside)
        & enters.min(leaves).simd_ge(-slack + arc.from[1] * rise)
        & enters.max(leaves).simd_le(slack + arc.to[1] * rise)
        & crossings.squared.simd_gt(f32x16::splat(simd, 0.0))
}

impl RowArc {
    /// 1 where y rises along it, else -1.
    #[inline(always)]
    fn rise(&self) -> f32 {
        if self.to[1] < self.from[1] { -1.0 } else { 1.0 }
    }

    /// The x of an end if it is as high as the disc, or 0: a crossing beside it may be at the disc's top, where rounding decides on
    /// which side it is.
    #[inline(always)]
    fn seen_end<S: Simd>(&self, simd: S, end: usize, x: f32x16<S>) -> f32x16<S> {
        let [.., width] = [self.from, self.to][end];
        if width > 0.0 {
            x
        } else {
            f32x16::splat(simd, 0.0)
        }
    }

    #[inline(always)]
    fn power<S: Simd>(&self, columns: f32x16<S>) -> f32x16<S> {
        let [power, slope, curvature] = self.power;
        columns * (columns * curvature + slope) + power
    }

    /// What it adds where all of it is inside.
    #[inline(always)]
    fn whole<S: Simd>(&self, from_x: f32x16<S>, to_x: f32x16<S>) -> f32x16<S> {
        let chord_y = (self.to[1] - self.from[1]) * (0.5 * FRAC_1_PI);
        (from_x + to_x) * chord_y + self.segment * self.turn
    }

    /// What it adds where nothing of it is inside.
    #[inline(always)]
    fn missed<S: Simd>(&self, simd: S, center_x: f32x16<S>) -> f32x16<S> {
        let side = f32x16::splat(simd, 1.0).copysign(center_x + self.middle);
        side * (self.halves[1] - self.halves[0])
    }
}

/// An arc of so large a radius that it runs inside between any two of its points that are inside.
#[inline(always)]
pub(super) fn long_arc<S: Simd>(simd: S, columns: f32x16<S>, arc: &RowArc) -> f32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    let splat = |v: f32| f32x16::splat(simd, v);
    let center_x = arc.center.at(columns);
    let [from_x, from_y, from_width] = arc.from;
    let [to_x, to_y, to_width] = arc.to;
    let (from_x, to_x) = (center_x + from_x, center_x + to_x);
    let from_in = from_x.abs().simd_lt(splat(from_width));
    let to_in = to_x.abs().simd_lt(splat(to_width));
    let (any_in, both_in) = (from_in | to_in, from_in & to_in);
    if both_in.all_true() {
        return arc.whole(from_x, to_x);
    }
    let crossings = Crossings::find(simd, columns, arc);
    let (enter, leave) = (crossings.enter(), crossings.leave());
    let rise = arc.rise();
    let from = [from_x, splat(from_y)];
    let to = [to_x, splat(to_y)];
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
            let p = select_point(from_in, from, enter);
            let q = select_point(to_in, to, leave);
            let before = beyond(
                simd,
                enter,
                arc.seen_end(simd, 0, from_x),
                splat(arc.halves[0]),
            );
            let after = beyond(
                simd,
                leave,
                arc.seen_end(simd, 1, to_x),
                splat(arc.halves[1]),
            );
            let outside = from_in.select(zero, before) - to_in.select(zero, after);
            return met.select(inside(simd, p, q, arc) + outside, missed);
        }
    }
    // At most one crossing, of which a disc's half need be found.
    let crossing = select_point(from_in, leave, enter);
    let p = select_point(from_in, from, crossing);
    let q = select_point(to_in, to, crossing);
    let end = from_in.select(arc.seen_end(simd, 1, to_x), arc.seen_end(simd, 0, from_x));
    let half = from_in.select(splat(arc.halves[1]), splat(arc.halves[0]));
    let outside = beyond(simd, crossing, end, half);
    let outside = both_in.select(zero, from_in.select(-outside, outside));
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
pub(super) fn arc<S: Simd>(simd: S, columns: f32x16<S>, arc: &RowArc) -> f32x16<S> {
    // An arc so near to the disc's own circle lies on it: where they cross is a matter of rounding.
    const SAME: f32 = 1e-4;
    let zero = f32x16::splat(simd, 0.0);
    let one = f32x16::splat(simd, 1.0);
    let splat = |v: f32| f32x16::splat(simd, v);
    let center_x = arc.center.at(columns);
    let [from_x, from_y, from_width] = arc.from;
    let [to_x, to_y, to_width] = arc.to;
    let (from_x, to_x) = (center_x + from_x, center_x + to_x);
    let from_in = from_x.abs().simd_lt(splat(from_width));
    let to_in = to_x.abs().simd_lt(splat(to_width));
    let crossings = Crossings::find(simd, columns, arc);
    let (enter, leave) = (crossings.enter(), crossings.leave());
    let crossed = crosses(simd, center_x, &crossings, [enter, leave], arc);
    let rise = arc.rise();
    let (enters, leaves) = (enter[1] * rise, leave[1] * rise);
    let notched = from_in & to_in & crossed & leaves.simd_lt(enters);
    let same = (SAME - (arc.radius - 1.0).abs()).max(0.0);
    let met = (from_in | to_in | (crossed & enters.simd_le(leaves)))
        & crossings.distance.simd_ge(splat(same * same));

    // From p to q it runs inside; or, where notched, all but from p to q.
    let p = [
        notched.select(leave[0], from_in.select(from_x, enter[0])),
        notched.select(leave[1], from_in.select(splat(from_y), enter[1])),
    ];
    let q = [
        notched.select(enter[0], to_in.select(to_x, leave[0])),
        notched.select(enter[1], to_in.select(splat(to_y), leave[1])),
    ];
    let inside = inside(simd, p, q, arc);
    let before = beyond(
        simd,
        enter,
        arc.seen_end(simd, 0, from_x),
        splat(arc.halves[0]),
    );
    let after = beyond(
        simd,
        leave,
        arc.seen_end(simd, 1, to_x),
        splat(arc.halves[1]),
    );
    let added = inside + from_in.select(zero, before) - to_in.select(zero, after);
    let notch = half_disc_at(simd, enter[0], enter[1]) - half_disc_at(simd, leave[0], leave[1]);
    let but_notch = arc.whole(from_x, to_x) - inside + notch * one.copysign(crossings.base[0]);
    met.select(notched.select(but_notch, added), arc.missed(simd, center_x))
}

/// An arc that passes the disc's whole height: the disc's part beyond the two circles' common chord, and the arc's own
/// beyond that.
#[inline(always)]
pub(super) fn through_arc<S: Simd>(simd: S, columns: f32x16<S>, arc: &RowArc) -> f32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    let area = of_large_circle(simd, arc.power(columns), arc.radius);
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

/// A circle, seen from a row of pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RowCircle {
    /// A pixel's squared distance from the centre less the squared radius: its value, slope and curvature.
    pub(crate) power: [f32; 3],
    pub(crate) radius: f32,
}

/// What discs have of a circle.
#[inline(always)]
pub(crate) fn circle<S: Simd>(simd: S, columns: f32x16<S>, circle: &RowCircle) -> f32x16<S> {
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let (radius, [power, slope, curvature]) = (circle.radius, circle.power);
    let power = columns * (columns * curvature + slope) + power;
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

/// A line within the height of a row of pixels, whose squares it cuts.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct RowCut {
    /// The x of its two ends.
    pub(super) ends: [Ramp; 2],
    pub(super) height: f32,
}

/// The coverage that a line adds to unit squares: as for discs, with x held between the square's two sides.
#[inline(always)]
pub(super) fn cut<S: Simd>(simd: S, columns: f32x16<S>, cut: &RowCut) -> f32x16<S> {
    /// Ends nearer to each other than this are one: a quotient of two tiny differences has no digits.
    const STEEP: f32 = 1e-3;
    let half = f32x16::splat(simd, 0.5);
    let (from, to) = (cut.ends[0].at(columns), cut.ends[1].at(columns));
    let width = cut.ends[1].start - cut.ends[0].start;
    if width.abs() < STEEP {
        return ((from + to) * half).max(-half).min(half) * cut.height;
    }
    (held_integral(simd, to) - held_integral(simd, from)) * (cut.height / width)
}

/// The integral of x held between the square's two sides.
#[inline(always)]
fn held_integral<S: Simd>(simd: S, x: f32x16<S>) -> f32x16<S> {
    let half = f32x16::splat(simd, 0.5);
    let inside = x.max(-half).min(half);
    // Half the square within, a line of slope 1/2 beyond.
    half * inside * inside + (x.abs() - inside.abs()) * half
}
