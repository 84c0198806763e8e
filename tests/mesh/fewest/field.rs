//! One shadow's densities on a lattice, and how wrong a triangle is there.

use glam::DVec2;
use penumbral::Shadow;

/// Samples a penumbra radius.
pub(super) const STEP: f64 = 32.0;

/// Samples about the shadow that are 0.
const MARGIN: f64 = 4.0;

/// A corner of a triangle: where it is, in samples, and its density.
pub(super) type Corner = (DVec2, f64);

/// A difference that is linear in the density of a corner: what it is where that is 0, and the corner's weight.
pub(super) type Difference = [f64; 2];

pub(super) struct Field {
    /// The first sample, in scene units, and from each to the next.
    origin: DVec2,
    pitch: f64,
    size: [usize; 2],
    densities: Vec<f64>,
}

impl Field {
    pub(super) fn new(shadow: &Shadow) -> Self {
        let bounds = shadow.bounds().unwrap();
        let [min, max] = [bounds.min, bounds.max].map(|v| DVec2::from(v.map(f64::from)));
        let pitch = shadow.radius() / STEP;
        let origin = min - MARGIN * pitch;
        let size = ((max - min) / pitch + 2.0 * MARGIN).ceil();
        let size = [size.x as usize + 1, size.y as usize + 1];
        let densities = (0..size[0] * size[1]).map(|i| {
            let place = [i % size[0], i / size[0]].map(|at| at as f64);
            let point = origin + DVec2::from(place) * pitch;
            shadow.density_at(point.as_vec2().to_array())
        });
        Self {
            origin,
            pitch,
            size,
            densities: densities.collect(),
        }
    }

    /// The lattice's last sample.
    pub(super) fn end(&self) -> DVec2 {
        DVec2::from(self.size.map(|count| (count - 1) as f64))
    }

    /// Samples from scene units, and back.
    pub(super) fn to_samples(&self, point: DVec2) -> DVec2 {
        (point - self.origin) / self.pitch
    }

    pub(super) fn to_scene(&self, place: DVec2) -> DVec2 {
        self.origin + place * self.pitch
    }

    fn sample(&self, x: f64, y: f64) -> f64 {
        let [columns, rows] = self.size;
        if x < 0.0 || y < 0.0 || x >= columns as f64 || y >= rows as f64 {
            return 0.0;
        }
        self.densities[y as usize * columns + x as usize]
    }

    /// The density between samples, by cubic interpolation.
    pub(super) fn at(&self, place: DVec2) -> f64 {
        let first = place.floor();
        let [x, y] = (place - first).to_array().map(cubic);
        let row = |j: usize| -> f64 {
            let row = first.y + j as f64 - 1.0;
            (0..4)
                .map(|i| x[i] * self.sample(first.x + i as f64 - 1.0, row))
                .sum()
        };
        (0..4).map(|j| y[j] * row(j)).sum()
    }

    /// Pushes the differences at samples in a triangle, as they depend on the density of `apex`.
    pub(super) fn push_inside(&self, apex: DVec2, [a, b]: [Corner; 2], out: &mut Vec<Difference>) {
        let area = (a.0 - apex).perp_dot(b.0 - apex);
        // The weights of two corners change by so much from sample to sample.
        let weight = |from: DVec2, to: DVec2| {
            let way = (to - from) / area;
            (DVec2::new(-way.y, way.x), from)
        };
        let (apex_growth, apex_zero) = weight(a.0, b.0);
        let (a_growth, a_zero) = weight(b.0, apex);
        let min = apex.min(a.0).min(b.0).ceil().max(DVec2::ZERO);
        let max = apex.max(a.0).max(b.0).floor().min(self.end());
        let sides = [[apex, a.0], [a.0, b.0], [b.0, apex]];
        let mut y = min.y;
        while y <= max.y {
            let (mut left, mut right) = (min.x, max.x);
            for [from, to] in sides {
                let slope = to.y - from.y;
                if slope != 0.0 {
                    let x = from.x + (to.x - from.x) * ((y - from.y) / slope);
                    // A side that goes up has the inside on its left.
                    if slope > 0.0 {
                        right = right.min(x);
                    } else {
                        left = left.max(x);
                    }
                }
            }
            let mut x = left.ceil();
            while x <= right {
                let place = DVec2::new(x, y);
                let of_apex = apex_growth.dot(place - apex_zero);
                let of_a = a_growth.dot(place - a_zero);
                let rest = of_a * a.1 + (1.0 - of_apex - of_a) * b.1;
                out.push([rest - self.sample(x, y), of_apex]);
                x += 1.0;
            }
            y += 1.0;
        }
    }

    /// The same along a side from `apex`, both of its ends included.
    pub(super) fn push_side(&self, apex: DVec2, end: Corner, out: &mut Vec<Difference>) {
        let parts = (end.0 - apex).length().ceil().clamp(4.0, 4096.0);
        for i in 0..=parts as u32 {
            let share = f64::from(i) / parts;
            let density = self.at(apex + (end.0 - apex) * share);
            out.push([share * end.1 - density, 1.0 - share]);
        }
    }
}

/// The weights of four samples about a place between the middle two.
fn cubic(t: f64) -> [f64; 4] {
    [
        t * (t * (1.0 - 0.5 * t) - 0.5),
        1.0 + t * t * (1.5 * t - 2.5),
        t * (t * (2.0 - 1.5 * t) + 0.5),
        0.5 * t * t * (t - 1.0),
    ]
}
