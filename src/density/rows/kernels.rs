//! What one piece of the outline adds to the densities of sixteen pixels at once, in single precision.
//!
//! By Green's theorem the area that the outline shares with the unit disc about a pixel is the sum over its pieces of the
//! integral of x dy, with x held between the circle's two sides: left of the disc a piece counts -sqrt(1 - y²), right of it
//! +sqrt(1 - y²). No angle is needed, and far pieces are differences of one function of their ends' y, which cancel along
//! a closed loop. All values are divided by π, so that they add up to density.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16};

pub(super) const FRAC_1_PI: f32 = core::f32::consts::FRAC_1_PI;

/// 1/4 - S(t)/π = v^1.5 q(v), v = 1 - |t|, S(t) the integral of sqrt(1 - u²) from 0 to t: a minimax fit of q, within
/// 3e-4 level, and none at t = 0, where two halves meet.
const HALF_DISC: [f32; 4] = [
    0.300_174_3,
    -0.045_521_595,
    -0.002_828_069_3,
    -0.001_824_623_4,
];

/// asin u / 2π = u p(u²) up to u = sqrt(1/2): a minimax fit of p, within 1e-4 level. A disc that a corner only touches is left what this
/// and the fit of its halves differ by.
const ARC_SINE: [f32; 5] = [
    0.159_160_64,
    0.026_317_384,
    0.014_039_524,
    -0.001_191_363_2,
    0.017_534_016,
];

/// The area of the unit disc between y = 0 and `t`, right of its centre, over π: from -1/4 to 1/4.
pub(crate) fn half_disc(t: f32) -> f32 {
    let v = (1.0 - t.abs()).max(0.0);
    let [a, b, c, d] = HALF_DISC;
    let tail = v * v.sqrt() * (a + v * (b + v * (c + v * d)));
    (0.25 - tail).copysign(t)
}

/// As [`half_disc`], for sixteen numbers.
#[inline(always)]
pub(crate) fn half_discs<S: Simd>(simd: S, t: f32x16<S>) -> f32x16<S> {
    let v = (f32x16::splat(simd, 1.0) - t.abs()).max(f32x16::splat(simd, 0.0));
    let [a, b, c, d] = HALF_DISC;
    let tail = v * v.sqrt() * (v * (v * (v * d + c) + b) + a);
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
pub(super) fn half_disc_at<S: Simd>(simd: S, x: f32x16<S>, y: f32x16<S>) -> f32x16<S> {
    let (x, height) = (x.abs(), y.abs());
    let angle = quarter_turns(simd, x, height);
    (x * height * (0.5 * FRAC_1_PI) + angle).copysign(y)
}

/// What of the disc lies inside of a straight border so far inside of which its middle is: the profile F.
#[inline(always)]
pub(crate) fn whole_disc<S: Simd>(simd: S, depth: f32x16<S>) -> f32x16<S> {
    half_discs(simd, depth) * 2.0 + 0.5
}

/// A number of each lane that changes by the same step from column to column.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ramp<S: Simd> {
    pub(super) start: f32x16<S>,
    pub(super) step: f32,
}

impl<S: Simd> Ramp<S> {
    #[inline(always)]
    pub(super) fn at(self, columns: f32x16<S>) -> f32x16<S> {
        columns * self.step + self.start
    }
}

/// A line that passes the disc's whole height: its profile is F(t) - 1/2.
#[inline(always)]
pub(super) fn through_line<S: Simd>(simd: S, columns: f32x16<S>, distance: Ramp<S>) -> f32x16<S> {
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
#[derive(Debug, Clone, Copy)]
pub(super) struct WideLine<S: Simd> {
    pub(super) distance: Ramp<S>,
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
pub(super) fn wide_line<S: Simd>(simd: S, columns: f32x16<S>, line: &WideLine<S>) -> f32x16<S> {
    let [larger, smaller] = line.spans;
    let spans = [f32x16::splat(simd, larger), f32x16::splat(simd, smaller)];
    mean_of_profile(simd, line.distance.at(columns), spans, line.radius) - 0.5
}

/// An arc that passes all that a pixel averages over, seen from a row of pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct WideArc<S: Simd> {
    pub(super) center: Ramp<S>,
    pub(super) center_y: f32,
    pub(super) arc_radius: f32,
    pub(super) turn: f32,
    pub(super) side: f32,
    /// Half of the square's side, and the disc's radius.
    pub(super) half: f32,
    pub(super) radius: f32,
}

/// The smaller span of a square's side is no less than these shares of half of the side and of the disc's radius: a quotient of two tiny
/// differences has no digits, and what it lacks adds up over all edges of a grating.
pub(super) fn least_span(half: f32, radius: f32) -> f32 {
    const OF_SIDE: f32 = 0.02;
    const OF_RADIUS: f32 = 0.006;
    (OF_SIDE * half).max(OF_RADIUS * radius)
}

/// As the line that touches the arc nearest to the pixel, moved by the arc's mean distance from it: the mean square along it,
/// of the disc's chord and of the square, over twice the arc's radius. Both are taken for normally distributed.
#[inline(always)]
pub(super) fn wide_arc<S: Simd>(simd: S, columns: f32x16<S>, arc: &WideArc<S>) -> f32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    let x = arc.center.at(columns);
    let far = (x * x + arc.center_y * arc.center_y)
        .max(f32x16::splat(simd, 1e-12))
        .sqrt();
    let (across, down) = (x.abs() / far, f32x16::splat(simd, arc.center_y.abs()) / far);
    let least = f32x16::splat(simd, least_span(arc.half, arc.radius));
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
#[derive(Debug, Clone, Copy)]
pub(super) struct RowLine<S: Simd> {
    /// Its signed distance, and where on it its start is, counted from the foot point.
    pub(super) distance: Ramp<S>,
    pub(super) start: Ramp<S>,
    pub(super) length: f32,
    pub(super) along: [f32; 2],
    /// `half_disc` at its start's y and at its end's.
    pub(super) halves: [f32x16<S>; 2],
}

#[inline(always)]
pub(super) fn line<S: Simd>(simd: S, columns: f32x16<S>, line: &RowLine<S>) -> f32x16<S> {
    let distance = line.distance.at(columns);
    let start = line.start.at(columns);
    line_at(simd, distance, start, line.length, line.along, line.halves)
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

/// A line within the height of a row of pixels, whose squares it cuts.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowCut<S: Simd> {
    /// The x of its two ends, and from one to the other.
    pub(super) ends: [Ramp<S>; 2],
    pub(super) width: f32,
    pub(super) height: f32,
}

/// The coverage that a line adds to unit squares: as for discs, with x held between the square's two sides.
#[inline(always)]
pub(super) fn cut<S: Simd>(simd: S, columns: f32x16<S>, cut: &RowCut<S>) -> f32x16<S> {
    /// Ends nearer to each other than this are one: a quotient of two tiny differences has no digits.
    const STEEP: f32 = 1e-3;
    let half = f32x16::splat(simd, 0.5);
    let (from, to) = (cut.ends[0].at(columns), cut.ends[1].at(columns));
    let width = cut.width;
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
