//! How much of something is in one place: sums over squares and those about them.

use std::collections::HashMap;

use glam::DVec2;

/// Sums over squares of side 1. From sum to sum it is memory.
#[derive(Debug, Default)]
pub(crate) struct Squares {
    sums: HashMap<[i64; 2], f64>,
}

impl Squares {
    /// Forgets what was added.
    pub(crate) fn clear(&mut self) {
        self.sums.clear();
    }

    /// Adds to the square that a point is in.
    pub(crate) fn add(&mut self, at: DVec2, value: f64) {
        let square = at.floor().to_array().map(|v| v as i64);
        *self.sums.entry(square).or_default() += value;
    }

    /// The largest sum over a square and the eight about it: no less than that over all that is nearer than 1 to a point that was added,
    /// along both axes.
    pub(crate) fn most(&self) -> f64 {
        let about = |&[x, y]: &[i64; 2]| {
            let near = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [x + dx, y + dy]));
            near.filter_map(|square| self.sums.get(&square))
                .sum::<f64>()
        };
        self.sums.keys().map(about).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_square_about_a_point_holds_more() {
        let mut squares = Squares::default();
        let mut most = |points: &[DVec2], side: f64| {
            squares.clear();
            for point in points {
                squares.add(*point * (2.0 / side), 1.0);
            }
            squares.most()
        };
        let points: Vec<DVec2> = (0..400_u32)
            .map(|i| {
                let [x, y] = [7919, 104_729].map(|step| f64::from(i * step % 1000) / 50.0);
                DVec2::new(x, y * y / 20.0)
            })
            .collect();
        let mut last = 0.0;
        for side in [0.1, 0.7, 2.3, 9.0] {
            let most = most(&points, side);
            let held = |at: &DVec2| {
                let near = points
                    .iter()
                    .filter(|point| (**point - *at).abs().max_element() <= side / 2.0);
                near.count() as f64
            };
            let truth = points.iter().map(held).fold(0.0, f64::max);
            assert!(most >= truth, "{side}: {most} of {truth}");
            assert!(most >= last);
            last = truth;
        }
        // Far from each other they are no crowd, however many there are.
        let apart: Vec<DVec2> = (0..400_u32)
            .map(|i| DVec2::new(f64::from(i % 20), f64::from(i / 20)) * 10.0)
            .collect();
        assert!(most(&apart, 1.0) < 8.0);
        assert_eq!(most(&[], 1.0), 0.0);
    }
}
