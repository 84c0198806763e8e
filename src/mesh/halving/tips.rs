//! Where density has a tip between samples.

use core::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI, SQRT_2};

use glam::DVec2;
use libm::sin;

use super::Lattice;
use crate::outline::{self, Edge};

/// How near to the penumbra radius a radius of curvature is, over it, where there is a tip: samples tell of all others.
const NEAR: f64 = 0.15;

/// How far about a tip samples may know nothing of it, in samples.
const TIP: f64 = 1.5;

/// What an outline has to turn for one, in radians: less is a fraction of a level.
const TURN: f64 = 0.1;

/// A part of the outline along which the disc's edge runs all at once, from a centre that is common to both. About there density
/// has a ridge like a roof's, or a tip like a cone's if it is a circle, and samples beside it know nothing of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tip {
    /// The centre, in scene units.
    center: DVec2,
    /// How far the radius of curvature is from the penumbra radius, in scene units.
    miss: f64,
    /// How far the outline turns, in radians.
    turn: f64,
}

impl Tip {
    /// Where it is, in samples.
    pub(super) fn place(&self, lattice: &Lattice) -> DVec2 {
        (self.center - lattice.corner) / lattice.pitch
    }

    /// How far about it samples `pitch` apart may know nothing of it, in samples.
    pub(super) fn reach(&self, pitch: f64) -> f64 {
        self.miss / pitch + TIP
    }

    /// How far density may be off between samples `pitch` apart, from what they tell of it.
    pub(super) fn height(&self, pitch: f64, radius: f64) -> f64 {
        // Over the distance from the centre density changes by as much as the part of the disc's edge that is seen from the side.
        let slope = FRAC_2_PI / radius * sin((self.turn / 2.0).min(FRAC_PI_2));
        // The chord over a roof is off by a quarter of its length, that of a cone by a half; diagonals are longer.
        let share = if self.turn > PI { 0.5 } else { 0.25 };
        // A ridge is as blunt as the radii differ.
        let blunt = (pitch / (4.0 * self.miss)).min(1.0);
        slope * share * SQRT_2 * pitch * blunt
    }
}

/// Finds the tips of an outline's edges.
pub(super) fn find(edges: &[Edge], radius: f64, tips: &mut Vec<Tip>) {
    tips.clear();
    let miss = |found: f64| (found - radius).abs();
    let is_near = |found: f64| miss(found) < NEAR * radius;
    // Of the lines before, as long as they turn like the disc: how many, the sum of their centres and radii, and their turn.
    let (mut count, mut centers, mut radii, mut turned) = (0.0, DVec2::ZERO, 0.0, 0.0_f64);
    let mut last: Option<[DVec2; 2]> = None;
    for edge in edges.iter().map(Some).chain([None]) {
        let mut goes_on = false;
        let line = match edge {
            Some(Edge::Line(line) | Edge::Border(line)) => Some([line.from, line.to]),
            Some(Edge::Arc(arc)) if is_near(arc.radius) && arc.sweep.abs() > TURN => {
                tips.push(Tip {
                    center: arc.center,
                    miss: miss(arc.radius),
                    turn: arc.sweep.abs(),
                });
                None
            }
            _ => None,
        };
        if let (Some([start, joint]), Some([from, to])) = (last, line)
            && joint == from
        {
            let (before, after) = (joint - start, to - from);
            let turn = outline::turn(before, after);
            let found = (before.length() + after.length()) / (2.0 * turn.abs());
            if is_near(found) {
                let across = (before.normalize() + after.normalize()).perp().normalize();
                count += 1.0;
                centers += joint + across * found.copysign(turn);
                radii += found;
                turned += turn.abs();
                goes_on = true;
            }
        }
        if !goes_on {
            if turned > TURN {
                tips.push(Tip {
                    center: centers / count,
                    miss: miss(radii / count),
                    turn: turned,
                });
            }
            (count, centers, radii, turned) = (0.0, DVec2::ZERO, 0.0, 0.0);
        }
        last = line;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outline::Outline;
    use crate::path::FillRule;
    use crate::shape::Shape;

    fn tips(shape: &Shape, radius: f64) -> Vec<Tip> {
        let outline = Outline::of_simple(shape).unwrap();
        let edges: Vec<Edge> = outline.edges().copied().collect();
        let mut tips = Vec::new();
        find(&edges, radius, &mut tips);
        tips
    }

    #[test]
    fn circles_and_chords_about_as_large_as_the_disc_have_one_at_their_centre() {
        let center = DVec2::new(3.0, 4.0);
        let circle = Shape::circle([3.0, 4.0], 10.0).unwrap();
        let chords: Vec<[f32; 2]> = (0_u8..40)
            .map(|i| {
                let (sin, cos) = (f32::from(i) * core::f32::consts::TAU / 40.0).sin_cos();
                [3.0 + 10.0 * cos, 4.0 - 10.0 * sin]
            })
            .collect();
        let chords = Shape::polygon(&[chords], FillRule::NonZero).unwrap();
        for shape in [circle, chords] {
            for radius in [9.5, 10.0, 11.0] {
                let found = tips(&shape, radius);
                let turn: f64 = found.iter().map(|tip| tip.turn).sum();
                assert!(turn > 6.0, "{found:?}");
                for tip in found {
                    assert!((tip.center - center).length() < 0.1, "{tip:?}");
                    assert!((tip.miss - (radius - 10.0).abs()).abs() < 0.1, "{tip:?}");
                }
            }
            assert!(tips(&shape, 5.0).is_empty() && tips(&shape, 20.0).is_empty());
        }
        let square = Shape::rect(0.0, 0.0, 20.0, 20.0).unwrap();
        assert!(tips(&square, 10.0).is_empty());
    }
}
