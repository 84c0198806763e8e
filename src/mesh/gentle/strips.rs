//! Strips between rings, and how wrong they are.

use glam::DVec2;

use crate::mesh::field::Field;
use crate::mesh::samples::{Samples, Weights, imbalance, mix, mix_densities};
use crate::mesh::strips::join::{RingVertex, fill, join};

/// Into how many parts samples cut a triangle's sides: while strips are looked for, and to be sure of them.
const PARTS: [u32; 2] = [4, 8];

/// How far samples are apart at most, in penumbra radii.
const SPACING: f64 = 0.2;

/// From which part of the limit on the way from samples to the tops beside them is gone.
const NEAR: f64 = 0.7;

/// Triangles, and what is known of their error.
#[derive(Debug, Default)]
pub(super) struct Strips {
    pub(super) places: Vec<DVec2>,
    pub(super) densities: Vec<f64>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Whether densities are 0 or 1 by definition.
    fixed: Vec<bool>,
    /// The least and the largest error found beside each vertex.
    beside: Vec<[f64; 2]>,
    /// The exact densities at samples, few and many, triangle by triangle.
    exact: [Vec<f64>; 2],
}

impl Strips {
    pub(super) fn clear(&mut self) {
        self.places.clear();
        self.densities.clear();
        self.triangles.clear();
        self.fixed.clear();
        for exact in &mut self.exact {
            exact.clear();
        }
    }

    /// Adds a vertex that is to have so much less than the exact density.
    pub(super) fn push(&mut self, at: DVec2, less: f64) -> u32 {
        self.push_vertex(at, -less, false)
    }

    /// Adds a vertex of a density.
    pub(super) fn push_fixed(&mut self, at: DVec2, density: f64) -> u32 {
        self.push_vertex(at, density, true)
    }

    fn push_vertex(&mut self, at: DVec2, density: f64, fixed: bool) -> u32 {
        self.places.push(at);
        self.densities.push(density);
        self.fixed.push(fixed);
        self.places.len() as u32 - 1
    }

    /// Adds the triangles between two rings.
    pub(super) fn join(&mut self, outer: &[RingVertex], inner: &[RingVertex]) {
        join(outer, inner, &mut self.triangles);
    }

    /// Adds those within the innermost.
    pub(super) fn fill(&mut self, ring: &[RingVertex]) {
        fill(ring, &mut self.triangles);
    }

    /// Adds the exact density to that of each vertex which is not fixed.
    pub(super) fn raise(&mut self, field: &mut Field) {
        let mut exact = vec![0.0; self.places.len()];
        field.at_all(&self.places, &mut exact);
        for (index, density) in self.densities.iter_mut().enumerate() {
            if !self.fixed[index] {
                *density = (exact[index] + *density).clamp(0.0, 1.0);
            }
        }
    }

    /// Whether no triangle is turned round.
    pub(super) fn are_ordered(&self) -> bool {
        self.triangles.iter().all(|corners| {
            let [a, b, c] = corners.map(|i| self.places[i as usize]);
            (b - a).perp_dot(c - a) > 0.0
        })
    }

    /// The largest error, in density: looked at more closely as long as it is not too large.
    pub(super) fn measure(&mut self, field: &mut Field, limit: f64, samples: &mut Samples) -> f64 {
        let mut worst = f64::INFINITY;
        for (look, near) in [(0, f64::INFINITY), (1, f64::INFINITY), (1, NEAR * limit)] {
            worst = self.measure_at(look, near, field, samples);
            if worst > limit {
                break;
            }
        }
        worst
    }

    /// The same at few samples or many, and from those whose error is larger than `near` on the way up. Each vertex keeps the extremes
    /// of the samples beside it.
    fn measure_at(
        &mut self,
        look: usize,
        near: f64,
        field: &mut Field,
        samples: &mut Samples,
    ) -> f64 {
        let spacing = SPACING * field.radius();
        let exact = &mut self.exact[look];
        let is_known = !exact.is_empty();
        let (mut known, mut points) = (0, Vec::new());
        self.beside.clear();
        self.beside.resize(self.places.len(), [0.0; 2]);
        let mut worst: f64 = 0.0;
        for corners in &self.triangles {
            let corners = corners.map(|i| i as usize);
            let densities = corners.map(|i| self.densities[i]);
            // The umbra is what it is.
            if densities == [1.0; 3] && corners.iter().all(|&i| self.fixed[i]) {
                continue;
            }
            let at = corners.map(|i| self.places[i]);
            let mut is_first = true;
            let errors = |weights: &[Weights], errors: &mut [f64]| {
                if is_first && is_known {
                    errors.copy_from_slice(&exact[known..known + weights.len()]);
                } else {
                    points.clear();
                    points.extend(weights.iter().map(|&weights| mix(at, weights)));
                    field.at_all(&points, errors);
                    if is_first {
                        exact.extend_from_slice(errors);
                    }
                }
                if is_first {
                    known += weights.len();
                    is_first = false;
                }
                for (&weights, error) in weights.iter().zip(errors) {
                    *error = mix_densities(densities, weights) - *error;
                }
            };
            let (error, _) = samples.worst(at, PARTS[look], spacing, near, errors);
            worst = worst.max(error);
            samples.each_beside(|corner, error| {
                let [least, most] = &mut self.beside[corners[corner]];
                (*least, *most) = (least.min(error), most.max(error));
            });
        }
        worst
    }

    /// Moves densities to where the errors beside each vertex are as large above as below.
    pub(super) fn balance(&mut self) {
        for (index, density) in self.densities.iter_mut().enumerate() {
            if !self.fixed[index] {
                *density = (*density - imbalance(self.beside[index])).clamp(0.0, 1.0);
            }
        }
    }
}
