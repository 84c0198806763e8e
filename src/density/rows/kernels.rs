//! What one piece of the outline adds to the densities of sixteen pixels of a row at once, in single precision.
//!
//! By Green's theorem the area that the outline shares with the unit disc about a pixel is the sum over its pieces of the
//! integral of x dy, with x held between the circle's two sides: left of the disc a piece counts -sqrt(1 - y²), right of it
//! +sqrt(1 - y²). No angle is needed, and far pieces are differences of one function of their ends' y, which cancel along
//! a closed loop. All values are divided by π, so that they add up to density.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};

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
pub(crate) fn half_disc_x8<S: Simd>(simd: S, t: f32x16<S>) -> f32x16<S> {
    let v = (f32x16::splat(simd, 1.0) - t.abs()).max(f32x16::splat(simd, 0.0));
    let [a, b, c, d, e] = HALF_DISC;
    let tail = v * v.sqrt() * (v * (v * (v * (v * e + d) + c) + b) + a);
    (f32x16::splat(simd, 0.25) - tail).copysign(t)
}

/// `half_disc(y)` for a point (x, y) of the circle: without a root, as x is one.
#[inline(always)]
fn half_disc_at<S: Simd>(simd: S, x: f32x16<S>, y: f32x16<S>) -> f32x16<S> {
    let (x, height) = (x.abs(), y.abs());
    let flat = height.simd_le(x);
    let u = x.min(height);
    let u2 = u * u;
    let [a, b, c, d, e] = ARC_SINE;
    let sine = u * (u2 * (u2 * (u2 * (u2 * e + d) + c) + b) + a);
    let angle = flat.select(sine, f32x16::splat(simd, 0.25) - sine);
    (x * height * (0.5 * FRAC_1_PI) + angle).copysign(y)
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
    half_disc_x8(simd, distance.at(columns)) * 2.0
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
    let foot_y = -(distance * along_x);
    let inside =
        (last - first) * (foot_x + (first + last) * (0.5 * along_x)) * (along_y * FRAC_1_PI);
    let (chord_x, chord_y) = (half_chord * along_x, half_chord * along_y);
    let (enter_x, leave_x) = (foot_x - chord_x, foot_x + chord_x);
    let before = half_disc_at(simd, enter_x, foot_y - chord_y) - halves[0];
    let after = -(half_disc_at(simd, leave_x, foot_y + chord_y) - halves[1]);
    let added = inside
        + begins.select(before * one.copysign(enter_x), zero)
        + goes_on.select(after * one.copysign(leave_x), zero);
    let beside = one.copysign(foot_x + first * along_x) * (halves[1] - halves[0]);
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

/// The area between an arc and its chord, over π, for the squared chord.
#[inline(always)]
fn segment<S: Simd>(simd: S, squared_chord: f32x16<S>, radius: f32) -> f32x16<S> {
    let quarter = 0.25 / (radius * radius);
    let t2 = (squared_chord * quarter).min(f32x16::splat(simd, 0.5));
    let [a, b, c, d, e] = SEGMENT;
    let p = t2 * (t2 * (t2 * (t2 * e + d) + c) + b) + a;
    squared_chord * squared_chord.sqrt() * p * (0.125 * FRAC_1_PI / radius)
}

/// As [`segment`], for one number.
pub(super) fn segment_of(squared_chord: f32, radius: f32) -> f32 {
    let t2 = (squared_chord * (0.25 / (radius * radius))).min(0.5);
    let [a, b, c, d, e] = SEGMENT;
    let p = a + t2 * (b + t2 * (c + t2 * (d + t2 * e)));
    squared_chord * squared_chord.sqrt() * p * (0.125 * FRAC_1_PI / radius)
}

#[inline(always)]
pub(super) fn arc<S: Simd>(simd: S, columns: f32x16<S>, arc: &RowArc) -> f32x16<S> {
    // How far beyond its ends a point may seem to lie that rounding has moved there, and the more of it the nearer the two
    // centres are: over their squared distance.
    const SLACK: f32 = 1e-5;
    const SLACK_NEAR: f32 = 1e-9;
    // An arc so near to the disc's own circle lies on it: where they cross is a matter of rounding.
    const SAME: f32 = 1e-4;
    let zero = f32x16::splat(simd, 0.0);
    let one = f32x16::splat(simd, 1.0);

    let center_x = arc.center.at(columns);
    let [from_x, from_y, from_width] = arc.from;
    let [to_x, to_y, to_width] = arc.to;
    let (from_x, to_x) = (center_x + from_x, center_x + to_x);
    let from_in = from_x.abs().simd_lt(from_width);
    let to_in = to_x.abs().simd_lt(to_width);

    // The two circles cross on both sides of the point at `toward` of the way to the arc's centre.
    let [power, slope, curvature] = arc.power;
    let power = columns * (columns * curvature + slope) + power;
    // Of the centre's own coordinates, so that both points lie on the disc's circle however near to each other the centres
    // are.
    let distance = center_x * center_x + arc.center_y * arc.center_y;
    let inverse = one / distance.max(f32x16::splat(simd, 1e-12));
    let toward = (power + 1.0) * 0.5 * inverse;
    let squared = inverse - toward * toward;
    let aside = squared.max(zero).sqrt() * arc.turn;
    let (base_x, base_y) = (toward * center_x, toward * arc.center_y);
    let (off_x, off_y) = (aside * arc.center_y, aside * center_x);
    let (enter_x, enter_y) = (base_x - off_x, base_y + off_y);
    let (leave_x, leave_y) = (base_x + off_x, base_y - off_y);

    // Order along the arc is order along y.
    let rise = if to_y < from_y { -1.0 } else { 1.0 };
    let (enters, leaves) = (enter_y * rise, leave_y * rise);
    let slack = inverse * SLACK_NEAR + SLACK;
    let beside = center_x * arc.side - slack;
    let crossed = (enter_x * arc.side).simd_ge(beside)
        & (leave_x * arc.side).simd_ge(beside)
        & enters.min(leaves).simd_ge(-slack + from_y * rise)
        & enters.max(leaves).simd_le(slack + to_y * rise)
        & squared.simd_gt(zero);
    let notched = from_in & to_in & crossed & leaves.simd_lt(enters);
    let same = (SAME - (arc.radius - 1.0).abs()).max(0.0);
    let met = (from_in | to_in | (crossed & enters.simd_le(leaves)))
        & distance.simd_ge(f32x16::splat(simd, same * same));

    // From p to q it runs inside; or, where notched, all but from p to q.
    let splat = |v: f32| f32x16::splat(simd, v);
    let p_x = notched.select(leave_x, from_in.select(from_x, enter_x));
    let p_y = notched.select(leave_y, from_in.select(splat(from_y), enter_y));
    let q_x = notched.select(enter_x, to_in.select(to_x, leave_x));
    let q_y = notched.select(enter_y, to_in.select(splat(to_y), leave_y));
    let (chord_x, chord_y) = (q_x - p_x, q_y - p_y);
    let inside = (p_x + q_x) * chord_y * (0.5 * FRAC_1_PI)
        + segment(simd, chord_x * chord_x + chord_y * chord_y, arc.radius) * arc.turn;

    let enter_half = half_disc_at(simd, enter_x, enter_y);
    let leave_half = half_disc_at(simd, leave_x, leave_y);
    // What lies outside is on one side of the disc as a whole. A crossing may be at the disc's top, where rounding decides
    // on which side it is.
    let enter_side = if from_width > 0.0 {
        enter_x + from_x
    } else {
        enter_x
    };
    let leave_side = if to_width > 0.0 {
        leave_x + to_x
    } else {
        leave_x
    };
    let before = (enter_half - arc.halves[0]) * one.copysign(enter_side);
    let after = (leave_half - arc.halves[1]) * one.copysign(leave_side);
    let added = inside + from_in.select(zero, before) - to_in.select(zero, after);
    let whole = (from_x + to_x) * ((to_y - from_y) * 0.5 * FRAC_1_PI) + arc.segment * arc.turn;
    let but_notch = whole - inside + (enter_half - leave_half) * one.copysign(base_x);
    let missed = one.copysign(center_x + arc.middle) * (arc.halves[1] - arc.halves[0]);
    met.select(notched.select(but_notch, added), missed)
}

/// An arc that passes the disc's whole height: the disc's part beyond the two circles' common chord, and the arc's own
/// beyond that.
#[inline(always)]
pub(super) fn through_arc<S: Simd>(simd: S, columns: f32x16<S>, arc: &RowArc) -> f32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    let one = f32x16::splat(simd, 1.0);
    let [power, slope, curvature] = arc.power;
    let power = columns * (columns * curvature + slope) + power;
    let far = (power + arc.radius * arc.radius).sqrt();
    let reach = ((power + 1.0) / (far * 2.0)).max(-one).min(one);
    let squared = (one - reach * reach).max(zero);
    let half_chord = squared.sqrt();
    let area =
        segment(simd, squared * 4.0, arc.radius) - half_disc_at(simd, half_chord, reach) * 2.0;
    // On the centre's other side it is the circle's other half that a disc may meet.
    let beyond = (arc.center.at(columns) * arc.side).simd_ge(zero);
    beyond.select(f32x16::splat(simd, 0.5), area) * arc.turn
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
