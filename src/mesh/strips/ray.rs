//! Rays from a corner's pole across the penumbra, and the knots on them.
//!
//! A straight piece of length h over a curve whose slope changes by d over it is wrong by h d / 8 in its middle, and by
//! half of that where its ends share the error. So pieces of equal sqrt(h d) are equally wrong, and what a sequence of
//! samples adds up to, divided by that, is the number of pieces that it takes. Only slopes are needed for it.

use glam::DVec2;

use super::corner::Corner;
use super::fan::Rings;

/// Intervals along a ray at which slopes are sampled.
pub(super) const STEPS: usize = 24;

/// The part of a piece's error that the steepest piece has left on either side of where the curve is steepest. There
/// its middle is right by itself: a whole piece on one side would waste it.
pub(super) const MIDDLE: f64 = 0.75;

/// A ray from the pole outwards, as far as density changes along it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    pub(super) direction: DVec2,
    /// From the umbra, or the pole where there is none, to the penumbra's outer edge.
    pub(super) distances: [f64; STEPS + 1],
    pub(super) gradients: [DVec2; STEPS + 1],
    /// The bends from the first sample up to each.
    bends: [f64; STEPS + 1],
    /// The bends from the inner end to where the density is steepest, and from there to the outer end.
    pub(super) inside: f64,
    pub(super) outside: f64,
    /// The sample nearest to the steepest place.
    pub(super) steepest: usize,
}

/// Where a ring meets a ray.
#[derive(Debug, Clone, Copy)]
pub(super) struct Knot {
    pub(super) direction: DVec2,
    pub(super) distance: f64,
    /// The distance from the ray's inner end over its length.
    pub(super) place: f64,
    pub(super) gradient: DVec2,
    /// What balances the errors of the pieces along the ray.
    pub(super) offset: f64,
    /// How much the ring bends from here to the next ray.
    pub(super) bend: f64,
}

impl Knot {
    pub(super) fn at(&self) -> DVec2 {
        self.direction * self.distance
    }
}

impl Ray {
    /// Samples a ray that points towards somewhere.
    pub(super) fn new(corner: &Corner, towards: DVec2) -> Self {
        let direction = towards.normalize();
        let [from, to] = span(corner, direction);
        let mut ray = Self {
            direction,
            distances: [0.0; STEPS + 1],
            gradients: [DVec2::ZERO; STEPS + 1],
            bends: [0.0; STEPS + 1],
            inside: 0.0,
            outside: 0.0,
            steepest: 0,
        };
        for step in 0..=STEPS {
            // Most samples where the density begins and ends to change.
            let share = step as f64 / STEPS as f64;
            let distance = from + (to - from) * share * share * (3.0 - 2.0 * share);
            ray.distances[step] = distance;
            ray.gradients[step] = corner.gradient(direction * distance);
        }
        ray.measure();
        ray
    }

    /// Finds the bends.
    fn measure(&mut self) {
        let slopes = self.gradients.map(|gradient| -gradient.dot(self.direction));
        let at = &self.distances;
        let part = |rise: f64, length: f64| (rise * length).abs().sqrt();
        for step in 1..=STEPS {
            let rise = slopes[step] - slopes[step - 1];
            self.bends[step] = self.bends[step - 1] + part(rise, at[step] - at[step - 1]);
            if slopes[step] > slopes[self.steepest] {
                self.steepest = step;
            }
        }
        // Between the samples it is at the top of a parabola: a jump from sample to sample would tear the rings.
        let middle = self.steepest.clamp(1, STEPS - 1);
        let [before, after] = [middle - 1, middle + 1];
        let chord = |i: usize, j: usize| (slopes[j] - slopes[i]) / (at[j] - at[i]);
        let (rise, fall) = (chord(before, middle), chord(middle, after));
        let curve = (fall - rise) / (at[after] - at[before]);
        let top = if curve < 0.0 {
            f64::midpoint(at[before], at[middle]) - rise / (2.0 * curve)
        } else {
            at[self.steepest]
        };
        let top = top.clamp(at[before], at[after]);
        let height = slopes[before] + (top - at[before]) * (rise + curve * (top - at[middle]));
        let low = if top < at[middle] { before } else { middle };
        let high = low + 1;
        self.inside = self.bends[low] + part(height - slopes[low], top - at[low]);
        self.outside =
            self.bends[STEPS] - self.bends[high] + part(height - slopes[high], at[high] - top);
    }

    /// Where a ring meets the ray.
    pub(super) fn knot(&self, ring: usize, rings: &Rings) -> Knot {
        let (bent, offset) = if ring < rings.outside {
            let piece = self.outside / (rings.outside as f64 + MIDDLE);
            (
                self.bends[STEPS] - piece * (ring + 1) as f64,
                -piece * piece / 16.0,
            )
        } else {
            let piece = self.inside / (rings.inside as f64 + MIDDLE);
            let before = rings.count() - ring;
            (piece * before as f64, piece * piece / 16.0)
        };
        let after = self
            .bends
            .iter()
            .position(|&b| b > bent)
            .unwrap_or(STEPS)
            .max(1);
        let width = self.bends[after] - self.bends[after - 1];
        let share = if width > 0.0 {
            (bent - self.bends[after - 1]) / width
        } else {
            0.5
        };
        let mix = |values: &[f64; STEPS + 1]| {
            values[after - 1] + (values[after] - values[after - 1]) * share
        };
        // Squares of slopes are smooth where the density begins to change, slopes are not.
        let distance = mix(&self.distances);
        let [from, to] = [self.distances[0], self.distances[STEPS]];
        let [before, behind] = [after - 1, after].map(|i| {
            let gradient = self.gradients[i];
            gradient * gradient.length()
        });
        let gradient = before.lerp(behind, share);
        Knot {
            direction: self.direction,
            distance,
            place: (distance - from) / (to - from),
            gradient: gradient / gradient.length().sqrt().max(f64::MIN_POSITIVE),
            offset,
            bend: 0.0,
        }
    }
}

/// Where a ray leaves the umbra, or the pole where there is none, and where it leaves the penumbra.
pub(super) fn span(corner: &Corner, direction: DVec2) -> [f64; 2] {
    let (tip, round) = (corner.tip, corner.radii[0]);
    let from = if corner.has_umbra() {
        reach(tip - 1.0, round - 1.0, direction)
    } else {
        0.0
    };
    [from, reach(tip + 1.0, round + 1.0, direction)]
}

/// How far from the pole a ray leaves a quarter of a rounded rectangle, with its corner at `tip`.
fn reach(tip: DVec2, radius: f64, direction: DVec2) -> f64 {
    let to_side = |axis: usize| {
        if direction[axis] > 0.0 {
            tip[axis].max(0.0) / direction[axis]
        } else {
            f64::INFINITY
        }
    };
    let nearest = to_side(0).min(to_side(1));
    let center = tip - radius;
    let at = direction * nearest;
    if radius <= 0.0 || at.x < center.x || at.y < center.y {
        return nearest;
    }
    let across = center.perp_dot(direction);
    center.dot(direction) + (radius * radius - across * across).max(0.0).sqrt()
}
