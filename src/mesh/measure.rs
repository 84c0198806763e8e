//! How wrong a triangle is: its densities next to a shadow's.

use glam::DVec2;

use super::field::Field;
use super::profile::Profile;
use super::samples::{Samples, Weights, mix, mix_densities};

/// Into how many parts a triangle's sides are cut to find what is wrong, and to be sure of it.
const COARSE: u32 = 4;
const FINE: u32 = 8;

/// How far samples are apart at most, in penumbra radii: long triangles run past corners that are shorter than a part. To be sure of what
/// is there they are nearer: under many dots, or along a needle, density has tops a quarter of a radius apart, of which large triangles
/// passed their tolerance by an eighth.
const SPACING: f64 = 0.2;
const SURE_SPACING: f64 = 0.1;

/// From which part of the limit on the way from samples to the tops beside them is gone.
const NEAR: f64 = 0.8;

/// A corner's weight that does not count.
const NO_WEIGHT: f64 = 1e-9;

/// What sampling found out about a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Assessment {
    /// The largest difference from the profile's density, where a vertex would mend it.
    pub(super) error: f64,
    /// Where that is.
    pub(super) worst: DVec2,
    /// The largest of all samples, those on the way up to other tops too.
    pub(super) most: f64,
    /// The largest difference from the exact density.
    pub(super) exact_error: f64,
    /// Whether all of it was looked at, and not only some samples.
    pub(super) sure: bool,
}

/// A shadow's densities, as a profile shows them, to measure triangles against.
pub(super) struct Measure {
    field: Field,
    profile: Profile,
    samples: Samples,
    /// Where they are.
    points: Vec<DVec2>,
}

impl Measure {
    pub(super) fn new(field: Field, profile: Profile) -> Self {
        Self {
            field,
            profile,
            samples: Samples::default(),
            points: Vec::new(),
        }
    }

    /// The penumbra radius, in the outline's unit.
    pub(super) fn radius(&self) -> f64 {
        self.field.radius()
    }

    /// The density that a vertex or sample at `point` should have.
    pub(super) fn target(&mut self, point: DVec2) -> f64 {
        self.profile.in_place_of(self.field.at(point))
    }

    /// The density that the umbra should have.
    pub(super) fn umbra(&self) -> f64 {
        self.profile.in_place_of(1.0)
    }

    /// How wrong a triangle is that has these densities at its corners, as far as sampled, or surely as far as it may come near to
    /// `limit`. Along the sides opposite of `fixed` corners a vertex would mend nothing.
    pub(super) fn assess(
        &mut self,
        at: [DVec2; 3],
        densities: [f64; 3],
        fixed: [bool; 3],
        surely: bool,
        limit: f64,
    ) -> Assessment {
        let (mut most, mut exact_error) = (0.0_f64, 0.0_f64);
        let radius = self.radius();
        let Self {
            field,
            profile,
            samples,
            points,
        } = self;
        let look = |samples: &[Weights], errors: &mut [f64]| {
            points.clear();
            points.extend(samples.iter().map(|&weights| mix(at, weights)));
            field.at_all(points, errors);
            for (weights, error) in samples.iter().zip(errors) {
                let density = mix_densities(densities, *weights);
                let exact = *error;
                exact_error = exact_error.max((density - exact).abs());
                // Where a vertex would mend nothing there is no error to be mended.
                let mendable = (0..3).all(|i| !fixed[i] || weights[i] > 0.0);
                *error = if mendable {
                    density - profile.in_place_of(exact)
                } else {
                    0.0
                };
                most = most.max(error.abs());
            }
        };
        let (parts, spacing, near) = if surely {
            (FINE, SURE_SPACING, NEAR * limit)
        } else {
            (COARSE, SPACING, f64::INFINITY)
        };
        let (error, worst) = samples.worst(at, parts, spacing * radius, near, look);
        Assessment {
            error,
            worst: mix(at, worst),
            most,
            exact_error,
            sure: surely,
        }
    }

    /// The least and the largest density that a triangle's first corner may have so that no sample is off by more than `limit`.
    pub(super) fn allowed(
        &mut self,
        at: [DVec2; 3],
        [second, third]: [f64; 2],
        limit: f64,
    ) -> (f64, f64) {
        self.assess(at, [0.0, second, third], [false; 3], false, limit);
        let (mut low, mut high) = (0.0_f64, 1.0_f64);
        for ([weight, ..], error) in self.samples.all() {
            if weight > NO_WEIGHT {
                low = low.max((-limit - error) / weight);
                high = high.min((limit - error) / weight);
            } else if error.abs() > limit {
                return (1.0, 0.0);
            }
        }
        (low, high)
    }
}
