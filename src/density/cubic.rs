//! Densities between rows (Catmull & Rom 1974).

use fearless_simd::{Simd, SimdBase, f32x16};

use super::lanes::LANES;

/// The weights of four neighbours, for a point `share` of the way from the second to the third.
#[inline(always)]
pub(super) fn weights(share: f64) -> [f32; 4] {
    at(&POWERS, share as f32)
}

/// The same with what errs least at the power of 1.5, as which densities leave 0 and 1: a share is taken of the second difference of four
/// rows, which straight lines do not have.
#[inline(always)]
pub(super) fn touching(share: f64) -> [f32; 4] {
    const TAKEN: f32 = 0.07;
    /// `TAKEN` t (1 - t) of it.
    const TOUCHING: [[f32; 4]; 4] = {
        let [constant, mut linear, mut square, cube] = POWERS;
        let mut neighbour = 0;
        while neighbour < 4 {
            linear[neighbour] -= TAKEN * DIFFERENCE[neighbour];
            square[neighbour] += TAKEN * DIFFERENCE[neighbour];
            neighbour += 1;
        }
        [constant, linear, square, cube]
    };
    at(&TOUCHING, share as f32)
}

/// The weights by the powers of the share.
const POWERS: [[f32; 4]; 4] = [
    [0.0, 1.0, 0.0, 0.0],
    [-0.5, 0.0, 0.5, 0.0],
    [1.0, -2.5, 2.0, -0.5],
    [-0.5, 1.5, -1.5, 0.5],
];

/// The second difference of four.
const DIFFERENCE: [f32; 4] = [1.0, -1.0, -1.0, 1.0];

#[inline(always)]
fn at([constant, linear, square, cube]: &[[f32; 4]; 4], t: f32) -> [f32; 4] {
    let mut weights = [0.0; 4];
    for (neighbour, weight) in weights.iter_mut().enumerate() {
        *weight = ((cube[neighbour] * t + square[neighbour]) * t + linear[neighbour]) * t
            + constant[neighbour];
    }
    weights
}

/// The density between four neighbours, by their weights.
#[inline(always)]
pub(super) fn sum<S: Simd>(simd: S, [a, b, c, d]: [f32x16<S>; 4], weights: [f32; 4]) -> f32x16<S> {
    let sum = a * weights[0] + b * weights[1] + (c * weights[2] + d * weights[3]);
    sum.max(f32x16::splat(simd, 0.0))
        .min(f32x16::splat(simd, 1.0))
}

/// Puts densities between four rows, by their weights, into `to`: whole vectors of them.
#[inline(always)]
pub(super) fn between<S: Simd>(simd: S, rows: [&[f32]; 4], weights: [f32; 4], to: &mut [f32]) {
    let [a, b, c, d] = rows;
    let to = to.as_chunks_mut::<LANES>().0.iter_mut();
    let outer = a
        .as_chunks::<LANES>()
        .0
        .iter()
        .zip(d.as_chunks::<LANES>().0);
    let inner = b
        .as_chunks::<LANES>()
        .0
        .iter()
        .zip(c.as_chunks::<LANES>().0);
    for ((to, (a, d)), (b, c)) in to.zip(outer).zip(inner) {
        let (a, b) = (f32x16::from_slice(simd, a), f32x16::from_slice(simd, b));
        let (c, d) = (f32x16::from_slice(simd, c), f32x16::from_slice(simd, d));
        sum(simd, [a, b, c, d], weights).store_slice(to);
    }
}

/// The rows a penumbra radius for a tolerance of one level: at 12, 13 of 4,000 random shapes passed it, by up to
/// a half, where errors of chords, cubics and curves come together. Fitted to shapes, no bound.
const STEPS: f64 = 14.0;

/// The rows a penumbra radius that keep the penumbra's ends within a tolerance: their error falls with the power of 1.5.
pub(super) fn steps(levels: f64) -> f64 {
    STEPS * libm::pow(1.0 / levels, if levels < 1.0 { 1.0 / 1.5 } else { 0.5 })
}
