//! Where a triangle is most wrong.
//!
//! Density bends on the scale of the penumbra radius, and its error has some few tops on each piece of that size. Samples are
//! near enough to one another to have one on the slope of each top; from the highest the way goes up from there.

use glam::DVec2;
use libm::ceil;

/// Weights of a triangle's corners.
pub(super) type Weights = [f64; 3];

/// The most samples along a side: one that is longer yet is straight for most of its length.
const MOST: f64 = 128.0;

/// How often the steps of the way up are halved. Tops are parabolas: a step short of one is wrong by its square.
const HALVINGS: u32 = 3;

/// The most steps of one size: more would lead past the neighbouring samples.
const STEPS: u32 = 4;

/// The size of a triangle's largest error, and where it is: of samples `parts` to a side and no farther apart than `spacing`,
/// in the unit of `at`. From those larger than `near` the way goes up. Each sample is told of as well.
pub(super) fn worst(
    at: [DVec2; 3],
    parts: u32,
    spacing: f64,
    near: f64,
    mut error: impl FnMut(Weights) -> f64,
    mut tell: impl FnMut(Weights, f64),
) -> (f64, Weights) {
    // The highest and the lowest sample beside each corner and in the middle: errors that balance have as many tops.
    let mut tops = [(0.0, [0.0; 3]); 8];
    lattice(at, parts, spacing, |weights| {
        let found = error(weights);
        tell(weights, found);
        let corner = weights.iter().position(|&weight| weight > 0.5);
        let top = &mut tops[corner.unwrap_or(3) + if found < 0.0 { 4 } else { 0 }];
        if found.abs() > top.0 {
            *top = (found.abs(), weights);
        }
    });
    let mut most = (0.0, [1.0, 0.0, 0.0]);
    for (index, mut top) in tops.into_iter().enumerate() {
        if top.0 > near {
            let sign = if index < 4 { 1.0 } else { -1.0 };
            top = climb(top, 0.5 / f64::from(parts), |weights| sign * error(weights));
        }
        if top.0 > most.0 {
            most = top;
        }
    }
    most
}

/// Samples along the longest side of a triangle and along rows beside it, `parts` of them and no farther apart than
/// `spacing`, in the unit of `at`.
fn lattice(at: [DVec2; 3], parts: u32, spacing: f64, mut sample: impl FnMut(Weights)) {
    let side = |i: usize| at[(i + 2) % 3] - at[(i + 1) % 3];
    let apex = (0..3).fold(0, |best, i| {
        if side(i).length_squared() > side(best).length_squared() {
            i
        } else {
            best
        }
    });
    let length = side(apex).length();
    let height = side(apex).perp_dot(at[apex] - at[(apex + 1) % 3]).abs() / length;
    let parts = f64::from(parts);
    let rows = ceil(height / spacing).clamp(parts, MOST.max(parts));
    for row in 0..=rows as u32 {
        let up = f64::from(row) / rows;
        let rest = 1.0 - up;
        let count = ceil(length * rest / spacing).clamp(ceil(parts * rest), MOST.max(parts));
        for i in 0..=count as u32 {
            let along = if count > 0.0 {
                rest * f64::from(i) / count
            } else {
                0.0
            };
            let mut weights = [0.0; 3];
            weights[apex] = up;
            weights[(apex + 1) % 3] = rest - along;
            weights[(apex + 2) % 3] = along;
            sample(weights);
        }
    }
}

/// The largest value on the way up from a sample, and where it is. Steps begin with the share `step` of a side.
fn climb(from: (f64, Weights), step: f64, mut value: impl FnMut(Weights) -> f64) -> (f64, Weights) {
    let (mut most, mut top) = from;
    let mut step = step;
    for _ in 0..HALVINGS {
        for _ in 0..STEPS {
            let mut next = None;
            for (to, other) in [(0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)] {
                let mut weights = top;
                let part = step.min(weights[other]);
                weights[to] += part;
                weights[other] -= part;
                let found = value(weights);
                if part > 0.0 && found > most {
                    (most, next) = (found, Some(weights));
                }
            }
            let Some(weights) = next else { break };
            top = weights;
        }
        step /= 2.0;
    }
    (most, top)
}

/// What is mixed from corners by weights.
pub(super) fn mix(corners: [DVec2; 3], weights: Weights) -> DVec2 {
    corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
}

/// The same for densities.
pub(super) fn mix_densities(corners: [f64; 3], weights: Weights) -> f64 {
    corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_as_near_as_asked_for_and_climb_to_the_tops() {
        let at = [DVec2::ZERO, DVec2::new(40.0, 0.0), DVec2::new(1.0, 1.5)];
        let hill = |top: DVec2, p: DVec2| (1.0 - (p - top).length_squared()).max(0.0);
        // One is a little higher than the other, and lower by samples alone.
        let (left, right) = (DVec2::new(7.3, 0.0), DVec2::new(30.12, 0.13));
        for sign in [1.0, -1.0] {
            let mut count = 0;
            let error = |weights: Weights| {
                let p = mix(at, weights);
                hill(left, p) + sign * 1.05 * hill(right, p)
            };
            let tell = |weights: Weights, _: f64| {
                assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
                assert!(weights.iter().all(|&weight| weight >= 0.0));
                count += 1;
            };
            let (most, place) = worst(at, 4, 0.5, 0.5, error, tell);
            assert!((1.04..=1.05).contains(&most), "{most}");
            assert!((mix(at, place) - right).length() < 0.2);
            assert!(count < 500, "{count}");
        }
    }
}
