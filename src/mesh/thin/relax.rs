//! Fewer triangles still, for longer: between rounds of thinning vertices move to where the triangles about them are less wrong, so that
//! more sides can go. Those on the penumbra's edges move as well, where what it loses there is flat enough.

use glam::DVec2;

use super::{Fit, LARGE_CUT, LOST, Opposite, Place, Thinning};
use crate::mesh::regions::Region;

/// Rounds at most, and the part of the triangles that each has to take away for another.
const ROUNDS: usize = 12;
const WORTHWHILE: f64 = 0.02;

/// How far vertices are tried to be moved, over their shortest side.
const STEPS: [f64; 2] = [0.3, 0.1];

/// Ways to move.
const WAYS: [[f64; 2]; 4] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];

impl Thinning<'_> {
    /// Takes away what it can as long as moving vertices leads on.
    pub(in crate::mesh) fn run_long(&mut self) {
        self.most_cut = LARGE_CUT * self.limit;
        self.spare = LOST
            * self
                .shares()
                .map(|[area, mass]| mass.min(self.limit * area))
                .sum::<f64>();
        self.run(usize::MAX);
        for _ in 0..ROUNDS {
            let before = self.triangles().count() as f64;
            for vertex in 0..self.corners.len() {
                let place = self.place(vertex);
                if place != Place::Fixed && self.bears(vertex) {
                    self.relax(vertex, place);
                }
            }
            for corner in &mut self.corners {
                corner.fresh = true;
            }
            self.run(usize::MAX);
            if self.triangles().count() as f64 > (1.0 - WORTHWHILE) * before {
                break;
            }
        }
    }

    /// The area and mass of each triangle in the penumbra.
    fn shares(&self) -> impl Iterator<Item = [f64; 2]> {
        let penumbra = self.triangles().filter(|t| t.region == Region::Penumbra);
        penumbra.map(|triangle| {
            let [a, b, c] = triangle.corners.map(|corner| &self.corners[corner]);
            let area = 0.5 * (b.at - a.at).perp_dot(c.at - a.at);
            [area, area * (a.density + b.density + c.density) / 3.0]
        })
    }

    /// Moves a vertex to where the triangles about it are less wrong.
    fn relax(&mut self, vertex: usize, place: Place) {
        let sides: Vec<Opposite> = self.star(vertex).collect();
        let penumbra = sides
            .iter()
            .map(|&(index, _)| &self.triangles[index])
            .filter(|triangle| triangle.region == Region::Penumbra);
        let mut best = self.energy(penumbra.map(|triangle| triangle.error));
        let at = self.corners[vertex].at;
        let length = |&(_, [other, _]): &Opposite| (self.corners[other].at - at).length();
        let shortest = sides.iter().map(length).fold(f64::INFINITY, f64::min);
        let mut found = self.try_at(vertex, place, at, &sides, &mut best);
        for step in STEPS {
            for way in WAYS {
                let to = at + DVec2::from(way) * (step * shortest);
                found = self.try_at(vertex, place, to, &sides, &mut best).or(found);
            }
        }
        if let Some(fit) = found {
            self.move_to(vertex, &sides, fit);
        }
    }

    /// What triangles are wrong by, which is to be lowered: the worst count most.
    fn energy(&self, errors: impl Iterator<Item = f64>) -> f64 {
        let share = |error: f64| error * error / (self.limit * self.limit);
        errors.map(|error| share(error) * share(error)).sum()
    }

    /// What a vertex may be elsewhere, if that is better than the best so far.
    fn try_at(
        &mut self,
        vertex: usize,
        place: Place,
        to: DVec2,
        sides: &[Opposite],
        best: &mut f64,
    ) -> Option<Fit> {
        let forced = match place {
            Place::Edge(_) => Some(self.corners[vertex].density),
            _ => None,
        };
        let fit = self.fit(to, forced, sides)?;
        let energy = self.energy(fit.assessments.iter().flatten().map(|found| found.error));
        if energy >= *best {
            return None;
        }
        let fit = match place {
            Place::Edge(ends) => self.cut(vertex, ends, fit)?,
            _ => fit,
        };
        *best = energy;
        Some(fit)
    }

    fn move_to(&mut self, vertex: usize, sides: &[Opposite], fit: Fit) {
        self.lose(&fit);
        for (&(index, _), assessment) in sides.iter().zip(fit.assessments) {
            self.triangles[index].note(assessment);
        }
        let corner = &mut self.corners[vertex];
        (corner.at, corner.density) = (fit.at, fit.density);
    }
}
