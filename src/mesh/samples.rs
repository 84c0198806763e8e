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

/// Triangles of more steps than this along their longest side have as many rows at least, unless so few parts are asked for that nothing
/// is to be sure of: crests of the error run along them, and between eight rows of a comb's triangle, eight penumbra radii by a
/// fifth of one, a twentieth was unseen.
const LONG: f64 = 16.0;

/// How often the way up is looked for from a sample: tops are parabolas, and a step short of one is wrong by its square.
const ROUNDS: u32 = 2;

/// Samples of one triangle, and the memory for them.
#[derive(Debug, Clone, Default)]
pub(super) struct Samples {
    weights: Vec<Weights>,
    errors: Vec<f64>,
    /// Those on the way up.
    nearby: Vec<Weights>,
    found: Vec<f64>,
}

impl Samples {
    /// The size of a triangle's largest error, and where it is: of samples `parts` to a side and no farther apart than
    /// `spacing`, in the unit of `at`. From those larger than `near` the way goes up. `errors` gives the errors at samples.
    pub(super) fn worst(
        &mut self,
        at: [DVec2; 3],
        parts: u32,
        spacing: f64,
        near: f64,
        mut errors: impl FnMut(&[Weights], &mut [f64]),
    ) -> (f64, Weights) {
        let steps = self.lattice(at, parts, spacing);
        self.errors.clear();
        self.errors.resize(self.weights.len(), 0.0);
        errors(&self.weights, &mut self.errors);
        // The highest and the lowest sample beside each corner and in the middle: errors that balance have as many tops.
        let mut tops = [(0.0, [0.0; 3]); 8];
        for (&weights, &error) in self.weights.iter().zip(&self.errors) {
            let corner = weights.iter().position(|&weight| weight > 0.5);
            let top = &mut tops[corner.unwrap_or(3) + if error < 0.0 { 4 } else { 0 }];
            if error.abs() > top.0 {
                *top = (error.abs(), weights);
            }
        }
        let mut most = (0.0, [1.0, 0.0, 0.0]);
        for (index, mut top) in tops.into_iter().enumerate() {
            if top.0 > near {
                let sign = if index < 4 { 1.0 } else { -1.0 };
                self.climb(&mut top, sign, steps, &mut errors);
            }
            if top.0 > most.0 {
                most = top;
            }
        }
        most
    }

    /// Calls `take` with each corner and each error beside it, of the samples that were taken before the way up.
    pub(super) fn each_beside(&self, mut take: impl FnMut(usize, f64)) {
        for (weights, error) in self.all() {
            for (corner, weight) in weights.into_iter().enumerate() {
                if weight >= BESIDE {
                    take(corner, error);
                }
            }
        }
    }

    /// The samples that were taken before the way up, and their errors.
    pub(super) fn all(&self) -> impl Iterator<Item = (Weights, f64)> {
        self.weights
            .iter()
            .copied()
            .zip(self.errors.iter().copied())
    }

    /// Lays samples along the longest side of a triangle and along rows beside it, `parts` of them and no farther apart
    /// than `spacing`. Gives the steps along that side and across it.
    fn lattice(&mut self, at: [DVec2; 3], parts: u32, spacing: f64) -> [Weights; 2] {
        let side = |i: usize| at[(i + 2) % 3] - at[(i + 1) % 3];
        let apex = (0..3).fold(0, |best, i| {
            if side(i).length_squared() > side(best).length_squared() {
                i
            } else {
                best
            }
        });
        let [from, to] = [1, 2].map(|next| (apex + next) % 3);
        let length = side(apex).length();
        let height = side(apex).perp_dot(at[apex] - at[from]).abs() / length;
        let parts = f64::from(parts);
        let along = ceil(length / spacing).clamp(parts, MOST.max(parts));
        let least = if along > LONG && 2.0 * parts >= LONG {
            LONG.max(parts)
        } else {
            parts
        };
        let rows = ceil(height / spacing).clamp(least, MOST.max(least));
        self.weights.clear();
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
                weights[from] = rest - along;
                weights[to] = along;
                self.weights.push(weights);
            }
        }
        let along = 1.0 / along;
        let mut steps = [[0.0; 3]; 2];
        (steps[0][to], steps[0][from]) = (along, -along);
        // Straight across: in a slanted triangle the way to the apex leads far along.
        let foot = (at[apex] - at[from]).dot(side(apex)) / (length * length);
        steps[1][apex] = 1.0 / rows;
        (steps[1][from], steps[1][to]) = ((foot - 1.0) / rows, -foot / rows);
        steps
    }

    /// Goes up from a sample between its neighbours.
    fn climb(
        &mut self,
        top: &mut (f64, Weights),
        sign: f64,
        steps: [Weights; 2],
        errors: &mut impl FnMut(&[Weights], &mut [f64]),
    ) {
        let mut scale = 1.0;
        for _ in 0..ROUNDS {
            self.nearby.clear();
            for size in [scale / 2.0, scale / 4.0] {
                for [along, across] in WAYS {
                    let part = |i: usize| {
                        let step = along * steps[0][i] + across * steps[1][i];
                        (top.1[i] + step * size).max(0.0)
                    };
                    let weights = [part(0), part(1), part(2)];
                    let sum: f64 = weights.iter().sum();
                    self.nearby.push(weights.map(|weight| weight / sum));
                }
            }
            self.found.clear();
            self.found.resize(self.nearby.len(), 0.0);
            errors(&self.nearby, &mut self.found);
            for (&weights, &error) in self.nearby.iter().zip(&self.found) {
                if sign * error > top.0 {
                    *top = (sign * error, weights);
                }
            }
            scale /= 4.0;
        }
    }
}

/// From which weight on a sample counts as beside a corner.
const BESIDE: f64 = 0.2;

/// How much of what would balance the samples beside a vertex it is moved by.
const BALANCE: f64 = 0.8;

/// How much less density a vertex is to have so that the errors beside it are as large above as below.
pub(super) fn imbalance([least, most]: [f64; 2]) -> f64 {
    BALANCE * f64::midpoint(least, most)
}

/// The ways from a sample to its neighbours, in steps along and across.
const WAYS: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [1.0, 1.0],
    [0.0, 1.0],
    [-1.0, 1.0],
    [-1.0, 0.0],
    [-1.0, -1.0],
    [0.0, -1.0],
    [1.0, -1.0],
];

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
            let errors = |samples: &[Weights], errors: &mut [f64]| {
                for (weights, error) in samples.iter().zip(errors) {
                    assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
                    assert!(weights.iter().all(|&weight| weight >= 0.0));
                    let p = mix(at, *weights);
                    *error = hill(left, p) + sign * 1.05 * hill(right, p);
                }
                count += samples.len();
            };
            let (most, place) = Samples::default().worst(at, 4, 0.5, 0.5, errors);
            assert!((1.04..=1.05).contains(&most), "{most}");
            assert!((mix(at, place) - right).length() < 0.2);
            assert!(count < 500, "{count}");
        }
    }
}
