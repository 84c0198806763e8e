//! A gentle convex curve, and places along it.

use core::f64::consts::TAU;

use glam::DVec2;
use libm::tan;

use crate::outline;

/// How far a vertex turns at most, in radians: beyond, it is a corner.
const CORNER: f64 = 0.3;

/// The least part of each side that is left along the umbra: circles of curvature are larger than the disc by a tenth.
const LEFT: f64 = 0.1;

/// How far from a place to either side a disc sees how much the curve bends, in penumbra radii.
const SEEN: f64 = 0.7;

/// A closed convex loop of lines without corners.
#[derive(Debug)]
pub(super) struct Curve {
    points: Vec<DVec2>,
    /// The way out at each point.
    normals: Vec<DVec2>,
    /// The curvature that a disc sees at each point, over that of the disc.
    curvatures: Vec<f64>,
    /// Of the line from each point to the next: its length, and how much of the curve's turn it stands for.
    lengths: Vec<f64>,
    turns: Vec<f64>,
}

/// A place on a curve.
pub(super) struct Station {
    pub(super) at: DVec2,
    /// The way out.
    pub(super) normal: DVec2,
    /// How far round the curve, from 0 to 1.
    pub(super) turn: f64,
    curvature: f64,
}

impl Station {
    /// How far outwards density is as steep as at `t` across a straight edge, both in penumbra radii: where the chord that the disc and a
    /// circle of the curve's curvature share is as long. It is t + √(R² - 1 + t²) - R, if the circle's radius is R.
    pub(super) fn distance_at(&self, t: f64) -> f64 {
        let rest = self.curvature * (1.0 - t * t);
        t - rest / (1.0 + (1.0 - self.curvature * rest).sqrt())
    }
}

impl Curve {
    /// Of a loop within `flatness` of an outline, if all its circles of curvature are larger than the disc.
    pub(super) fn new(points: Vec<DVec2>, radius: f64, flatness: f64) -> Option<Self> {
        let count = points.len();
        let way = |i: usize| points[(i + 1) % count] - points[i % count];
        let corner = |i: usize| {
            let (before, after) = (way(i + count - 1), way(i));
            outline::turn(before, after)
        };
        let corners: Vec<f64> = (0..count).map(corner).collect();
        let lengths: Vec<f64> = (0..count).map(|i| way(i).length()).collect();
        // Rounding may turn a straight line back.
        let back = -flatness / radius;
        let is_convex = corners.iter().all(|turn| (back..CORNER).contains(turn));
        let goes_once_round = (corners.iter().sum::<f64>() - TAU).abs() < 1e-6;
        let is_gentle = (0..count).all(|i| {
            let ends = [i, (i + 1) % count].map(|end| tan(corners[end] / 2.0).max(0.0));
            // A point that comes twice is refused with the corners.
            lengths[i] - radius * (ends[0] + ends[1]) > LEFT * lengths[i]
        });
        if count < 3 || !is_convex || !goes_once_round || !is_gentle {
            return None;
        }
        let normal = |i: usize| {
            let along = way(i + count - 1).normalize() + way(i).normalize();
            -along.perp().normalize()
        };
        let normals = (0..count).map(normal).collect();
        let turn = |i: usize| f64::midpoint(corners[i], corners[(i + 1) % count]).max(0.0);
        Some(Self {
            normals,
            curvatures: curvatures(&lengths, &corners, radius),
            turns: (0..count).map(turn).collect(),
            points,
            lengths,
        })
    }

    /// How much each line bends at a distance outwards: a chord of so much is off by an eighth of its square.
    pub(super) fn bends(&self, distance: f64) -> impl Iterator<Item = f64> {
        let lines = self.lengths.iter().zip(&self.turns);
        lines.map(move |(length, turn)| ((length + distance * turn) * turn).sqrt())
    }

    /// How many times as long lines are at a distance outwards, at most.
    pub(super) fn most_growth(&self, distance: f64) -> f64 {
        let lines = self.lengths.iter().zip(&self.turns);
        let growth = lines.map(|(length, turn)| 1.0 + distance * turn / length);
        growth.fold(1.0, f64::max)
    }

    /// Calls `take` with so many stations: the first where the curve has bent by so much, each a `step` on.
    pub(super) fn stations(
        &self,
        first: f64,
        step: f64,
        count: usize,
        mut take: impl FnMut(&Station),
    ) {
        let lines = self.points.len();
        let (mut taken, mut done) = (0, 0.0);
        for (line, bend) in self.bends(0.0).enumerate() {
            let to = (line + 1) % lines;
            while taken < count && first + step * taken as f64 <= done + bend {
                let share = if bend > 0.0 {
                    (first + step * taken as f64 - done) / bend
                } else {
                    0.0
                };
                let [from, next] = [self.curvatures[line], self.curvatures[to]];
                take(&Station {
                    at: self.points[line].lerp(self.points[to], share),
                    normal: self.normals[line].lerp(self.normals[to], share).normalize(),
                    turn: (line as f64 + share) / lines as f64,
                    curvature: from + (next - from) * share,
                });
                taken += 1;
            }
            done += bend;
        }
    }
}

/// The curvature that a disc sees at each point of a loop, over that of the disc.
fn curvatures(lengths: &[f64], corners: &[f64], radius: f64) -> Vec<f64> {
    let count = lengths.len();
    let reach = SEEN * radius;
    // From a point on, what is turned within reach.
    let turned = |from: usize, next: fn(usize, usize) -> usize, line: fn(usize, usize) -> usize| {
        let (mut turned, mut length, mut at) = (0.0, 0.0, from);
        loop {
            length += lengths[line(at, count)];
            if length >= reach {
                return turned;
            }
            at = next(at, count);
            turned += corners[at].max(0.0);
        }
    };
    let ahead = |from| turned(from, |at, count| (at + 1) % count, |at, _| at);
    let behind = |from| {
        let before = |at: usize, count: usize| (at + count - 1) % count;
        turned(from, before, before)
    };
    let seen = |i: usize| (corners[i].max(0.0) + ahead(i) + behind(i)) / (2.0 * SEEN);
    (0..count).map(|i| seen(i).min(1.0 - LEFT)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ellipse(a: f64, b: f64) -> Vec<DVec2> {
        let point = |i: u16| {
            let (sin, cos) = (f64::from(i) * TAU / 720.0).sin_cos();
            DVec2::new(a * cos, b * sin)
        };
        (0..720).map(point).collect()
    }

    #[test]
    fn curves_are_gentle_as_long_as_their_circles_are_larger_than_the_disc() {
        // The smallest has the radius b² / a.
        for (radius, is_gentle) in [(1.0, true), (27.0, true), (31.0, false), (60.0, false)] {
            let curve = Curve::new(ellipse(80.0, 50.0), radius, 0.01);
            assert_eq!(curve.is_some(), is_gentle, "{radius}");
        }
        let square = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]].map(DVec2::from);
        assert!(Curve::new(square.to_vec(), 1.0, 0.01).is_none());
        let mut turned_round = ellipse(80.0, 50.0);
        turned_round.reverse();
        assert!(Curve::new(turned_round, 1.0, 0.01).is_none());
        let mut twice = ellipse(80.0, 50.0);
        twice.insert(9, twice[9]);
        assert!(Curve::new(twice, 1.0, 0.01).is_none());
    }

    #[test]
    fn distances_are_where_disc_and_circle_share_a_chord_as_long() {
        let radius = 10.0;
        for circle in [12.0, 30.0, 1e4] {
            let curve = Curve::new(ellipse(circle, circle), radius, 0.01).unwrap();
            let step = curve.bends(0.0).sum::<f64>() / 7.0;
            let mut count = 0;
            curve.stations(0.5 * step, step, 7, |station| {
                for t in [-1.0, -0.6, 0.0, 0.3, 1.0] {
                    let between = circle + radius * station.distance_at(t);
                    let across =
                        (between * between + radius * radius - circle * circle) / (2.0 * between);
                    assert!(
                        (across / radius - t).abs() < 0.02,
                        "{circle}, {t}: {across}"
                    );
                }
                count += 1;
            });
            assert_eq!(count, 7);
        }
    }
}
