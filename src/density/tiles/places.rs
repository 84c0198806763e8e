//! A tile's places, as vectors have them.

use glam::DVec2;

use super::{REACH, SIDE};
use crate::density::lanes::LANES;

/// Where densities are taken: so many places to each sample.
#[derive(Debug)]
pub(super) struct Places<const N: usize> {
    /// From each sample to its places, in radii.
    pub(super) offsets: [DVec2; N],
    /// From sample to sample, and the largest of the offsets.
    pub(super) step: f64,
    far: f64,
    /// A tile's places, each by all its samples, about the middle of these.
    pub(super) xs: [[f32; LANES]; N],
    pub(super) ys: [[f32; LANES]; N],
    /// The y of the tile's rows at two places, and again: the last half are unused.
    pub(super) downs: [[f32; LANES]; N],
}

impl<const N: usize> Places<N> {
    pub(super) fn new(offsets: [[f64; 2]; N], step: f64) -> Self {
        let offsets = offsets.map(|offset| DVec2::from(offset) * step);
        let far = offsets.iter().map(|offset| offset.max_element());
        let [mut xs, mut ys, mut downs] = [[[0.0; LANES]; N]; 3];
        let from_middle = |at: usize| (at as f64 - REACH) * step;
        for place in 0..N {
            for lane in 0..LANES {
                let of = (2 * place + lane % (2 * SIDE) / SIDE).min(N - 1);
                xs[place][lane] = (from_middle(lane % SIDE) + offsets[place].x) as f32;
                ys[place][lane] = (from_middle(lane / SIDE) + offsets[place].y) as f32;
                downs[place][lane] = (from_middle(lane % SIDE) + offsets[of].y) as f32;
            }
        }
        Self {
            offsets,
            step,
            far: far.fold(0.0, f64::max),
            xs,
            ys,
            downs,
        }
    }

    /// From the middle of a tile's places to the outer ones.
    pub(super) fn reach(&self) -> f64 {
        REACH * self.step + self.far / 2.0
    }
}
