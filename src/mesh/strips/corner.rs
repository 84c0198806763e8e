//! A rounded rectangle as one of its corners sees it: its density and the density's gradient, in closed form.
//!
//! Along rows both sides of the rectangle are known, so the area that it shares with a disc is the integral over y of
//! its right side less its left one, each clamped to the disc (Green's theorem). The gradient takes no angle at all:
//! moving the disc adds area along its own circle inside the outline, and by the divergence theorem that is the sum of
//! the chords that the outline cuts from the disc, turned by a quarter.

use core::f64::consts::{FRAC_1_PI, FRAC_PI_4};

use glam::DVec2;

use crate::density::half_area;

/// A rounded rectangle in units of the penumbra radius, about any origin.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Corner {
    /// The corner that looks: where its two sides meet, rounded or not.
    pub(super) tip: DVec2,
    /// The opposite corner, at less x and y; at negative infinity where no disc reaches it.
    pub(super) far: DVec2,
    /// The corners' radii: of the tip, of the one of less x, of the far one, of the one of less y.
    pub(super) radii: [f64; 4],
}

impl Corner {
    /// The part of the unit disc about `point` that lies inside, to 0.001 level.
    pub(super) fn density(&self, point: DVec2) -> f64 {
        let (max, min) = (self.tip - point, self.far - point);
        let [tip, left, far, below] = self.radii;
        let right = clamped(max.x, [min.y, max.y], [below, tip]);
        let left = clamped(-min.x, [min.y, max.y], [far, left]);
        ((right + left) * FRAC_1_PI).clamp(0.0, 1.0)
    }

    /// What is so far on the way to another corner that is felt as far.
    pub(super) fn towards(&self, other: &Self, share: f64) -> Self {
        let radius = |i: usize| self.radii[i] + (other.radii[i] - self.radii[i]) * share;
        Self {
            tip: self.tip.lerp(other.tip, share),
            far: self.far,
            radii: [0, 1, 2, 3].map(radius),
        }
    }

    /// Whether a whole disc has room between the sides.
    pub(super) fn has_umbra(&self) -> bool {
        (self.tip - self.far).min_element() >= 2.0
    }

    /// The gradient of the density.
    pub(super) fn gradient(&self, point: DVec2) -> DVec2 {
        let (max, min) = (self.tip - point, self.far - point);
        let [tip, left, far, below] = self.radii;
        // Where the outline leaves the disc, less where it enters it.
        let mut ways = DVec2::ZERO;
        // Sides from less to more along each axis: `x` and `y` are the same side of a square to either.
        let mut side = |distance: f64, [from, to]: [f64; 2], turn: fn(f64, f64) -> DVec2| {
            if distance.abs() < 1.0 {
                let half = ((1.0 - distance) * (1.0 + distance)).sqrt();
                if from <= half && half < to {
                    ways += turn(distance, half);
                }
                if from <= -half && -half < to {
                    ways -= turn(distance, -half);
                }
            }
        };
        side(max.x, [min.y + below, max.y - tip], |d, along| {
            DVec2::new(d, along)
        });
        side(-min.x, [-max.y + left, -min.y - far], |d, along| {
            DVec2::new(-d, -along)
        });
        side(max.y, [-max.x + tip, -min.x - left], |d, along| {
            DVec2::new(-along, d)
        });
        side(-min.y, [min.x + far, max.x - below], |d, along| {
            DVec2::new(along, -d)
        });
        let mut round = |corner: DVec2, radius: f64, outwards: DVec2| {
            if radius > 0.0 {
                ways += ways_of_arc(corner - radius * outwards, radius, outwards);
            }
        };
        round(max, tip, DVec2::ONE);
        round(DVec2::new(min.x, max.y), left, DVec2::new(-1.0, 1.0));
        round(min, far, DVec2::NEG_ONE);
        round(DVec2::new(max.x, min.y), below, DVec2::new(1.0, -1.0));
        ways.perp() * FRAC_1_PI
    }
}

/// Where a quarter circle leaves the unit disc, less where it enters it.
fn ways_of_arc(center: DVec2, radius: f64, outwards: DVec2) -> DVec2 {
    let squared = center.length_squared();
    let distance = squared.sqrt();
    if !(distance < 1.0 + radius && distance > (1.0 - radius).abs()) {
        return DVec2::ZERO;
    }
    let along = (1.0 - radius * radius + squared) / (2.0 * distance);
    let across = ((1.0 - along) * (1.0 + along)).max(0.0).sqrt();
    let (to, side) = (center / distance, (center / distance).perp());
    let mut ways = DVec2::ZERO;
    // Anticlockwise a circle passes the disc's centre from the left of the way between their centres to the right.
    for (point, sign) in [
        (to * along - side * across, 1.0),
        (to * along + side * across, -1.0),
    ] {
        let from_center = (point - center) * outwards;
        if from_center.x >= 0.0 && from_center.y >= 0.0 {
            ways += point * sign;
        }
    }
    ways
}

/// The integral over y of a right side's x, clamped to the unit disc: the side at `x` from the first of `ends` to the
/// second, where corners of `radii` round it.
fn clamped(x: f64, ends: [f64; 2], radii: [f64; 2]) -> f64 {
    let (first, last) = (ends[0].max(-1.0), ends[1].min(1.0));
    if first >= last {
        return 0.0;
    }
    let whole = quick_half_area(last) - quick_half_area(first);
    if x <= -1.0 {
        return -whole;
    }
    if x - radii[0].max(radii[1]) >= 1.0 {
        return whole;
    }
    let [low, high] = [ends[0] + radii[0], ends[1] - radii[1]];
    let mut sum = straight(x, low.clamp(first, last), high.clamp(first, last));
    if low > first {
        let center = DVec2::new(x - radii[0], low);
        sum += rounded(center, radii[0], first, low.min(last));
    }
    if high < last {
        let center = DVec2::new(x - radii[1], high);
        sum += rounded(center, radii[1], high.max(first), last);
    }
    sum
}

fn straight(x: f64, from: f64, to: f64) -> f64 {
    if from >= to {
        return 0.0;
    }
    let whole = quick_half_area(to) - quick_half_area(from);
    if x.abs() >= 1.0 {
        return whole.copysign(x);
    }
    let half = ((1.0 - x) * (1.0 + x)).sqrt();
    let (start, end) = (from.clamp(-half, half), to.clamp(-half, half));
    let within = quick_half_area(end) - quick_half_area(start);
    x * (end - start) + (whole - within).copysign(x)
}

fn rounded(center: DVec2, radius: f64, from: f64, to: f64) -> f64 {
    // In between the two circles' crossings the same one of them is nearer all the way.
    let squared = center.length_squared();
    let distance = squared.sqrt();
    let mut cuts = [to; 3];
    if distance > 0.0 {
        let along = (1.0 - radius * radius + squared) / (2.0 * distance);
        if along.abs() < 1.0 {
            let across = ((1.0 - along) * (1.0 + along)).sqrt();
            let (to_center, side) = (center / distance, center.perp() / distance);
            let mut count = 0;
            for point in [
                to_center * along - side * across,
                to_center * along + side * across,
            ] {
                if point.x >= center.x && point.y > from && point.y < to {
                    cuts[count] = point.y;
                    count += 1;
                }
            }
            if cuts[0] > cuts[1] {
                cuts.swap(0, 1);
            }
        }
    }
    let mut sum = 0.0;
    let mut start = from;
    for end in cuts {
        if end <= start {
            continue;
        }
        let middle = f64::midpoint(start, end);
        let disc = (1.0 - middle * middle).max(0.0).sqrt();
        let up = middle - center.y;
        let side = center.x + (radius * radius - up * up).max(0.0).sqrt();
        sum += if side.abs() >= disc {
            (quick_half_area(end) - quick_half_area(start)).copysign(side)
        } else {
            let half = if radius > LARGE {
                half_area
            } else {
                quick_half_area
            };
            let turned = |y: f64| half((y - center.y) / radius);
            center.x * (end - start) + radius * radius * (turned(end) - turned(start))
        };
        start = end;
    }
    sum
}

/// Up to this radius of a corner, over the penumbra's, its square leaves of the polynomial's error less than 0.001 level.
const LARGE: f64 = 32.0;

/// [`half_area`] to 2.5e-9, without an arcsine: π/4 less what is left to the disc's edge,
/// which over v^1.5, v = 1 - |t|, is smooth. A polynomial through Chebyshev's points.
fn quick_half_area(t: f64) -> f64 {
    let v = 1.0 - t.abs();
    if v <= 0.0 {
        return FRAC_PI_4.copysign(t);
    }
    // In pairs, which don't wait for one another.
    let [a, b, c, d, e, f, g, h] = TAIL;
    let (squared, pair) = (v * v, |low: f64, high: f64| low + high * v);
    let low = pair(a, b) + pair(c, d) * squared;
    let high = pair(e, f) + pair(g, h) * squared;
    let smooth = low + high * (squared * squared);
    (FRAC_PI_4 - v * v.sqrt() * smooth).copysign(t)
}

const TAIL: [f64; 8] = [
    0.942_809_043_067_312_4,
    -0.141_421_545_758_107_14,
    -0.012_622_989_869_475_132,
    -0.002_485_612_629_768_282_6,
    -0.000_514_360_986_960_921_6,
    -0.000_408_562_371_558_209_7,
    0.000_167_666_741_181_495_18,
    -0.000_125_472_307_004_776_72,
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::at_point;
    use crate::outline::Outline;
    use crate::shape::{CornerRadii, Shape};

    #[test]
    fn it_is_the_closed_form_to_a_ten_thousandth_of_a_level() {
        let cases = [
            (DVec2::new(3.0, 2.0), [0.5, 0.25, 0.0, 1.0]),
            (DVec2::new(1.5, 0.5), [0.25; 4]),
            (DVec2::new(0.75, 0.25), [0.125, 0.0, 0.25, 0.0]),
            (DVec2::new(4.0, 4.0), [4.0; 4]),
            (DVec2::new(0.5, 0.5), [0.5; 4]),
            (DVec2::new(6.0, 2.0), [2.0, 1.0, 2.0, 1.5]),
        ];
        for (half, radii) in cases {
            let corner = Corner {
                tip: half,
                far: -half,
                radii,
            };
            let [tip, left, far, below] = radii.map(|r: f64| r as f32);
            let shape = Shape::rounded_rect(
                -half.x as f32,
                -half.y as f32,
                2.0 * half.x as f32,
                2.0 * half.y as f32,
                CornerRadii::from([far, below, tip, left]),
            )
            .unwrap();
            let outline = Outline::of_simple(&shape).unwrap();
            for i in -30..=30 {
                for j in -30..=30 {
                    let share = DVec2::new(f64::from(i), f64::from(j)) / 29.7;
                    let point = share * (half + 1.0);
                    let exact = |p: DVec2| at_point(outline.edges(), p, 1.0);
                    let error = corner.density(point) - exact(point);
                    assert!(error.abs() < 1e-7, "{half} {radii:?} {point}: {error:e}");
                    const STEP: f64 = 1e-5;
                    let slope = |along: DVec2| {
                        (exact(point + along * STEP) - exact(point - along * STEP)) / (2.0 * STEP)
                    };
                    let gradient = DVec2::new(slope(DVec2::X), slope(DVec2::Y));
                    let error = (corner.gradient(point) - gradient).length();
                    assert!(
                        error < 2e-3,
                        "{half} {radii:?} {point}: {error:e} of {gradient}"
                    );
                }
            }
        }
    }
}
