//! Curves as circular arcs that cover the same area.
//!
//! A part is replaced by the arc through its ends that encloses as much with its chord. Where the curvature is no circle's it grows
//! along the part: then the arc lies to one side of the curve in its first half and to the other in the second, farthest from it near a
//! quarter and three quarters of the way.

use glam::DVec2;
use libm::{atan2, cbrt, sin, tan};

use super::chords::Chords;
use super::fit::{self, BORDERS, Fineness, Fit, is_hairpin};
use super::{Arc, Edge};
use crate::path::{Contour, Part};

/// Arcs turn no farther, in radians: their series ends.
const FARTHEST: f64 = 1.0;

/// Arcs that turn less, in radians, are lines.
const STRAIGHT: f64 = 1e-7;

/// How far from the arc the curve is at most, over the farthest of the points that are asked: they lie near the farthest ones.
const BETWEEN: f64 = 1.05;

/// Where along a part its distance from the arc is asked.
const ASKED: [f64; 3] = [0.25, 0.5, 0.75];

/// The area that is left where the disc's edge crosses the arc twice, over its length and the largest distance: the two lobes of a
/// cubic with zeros at its ends and middle.
const LOBES: f64 = 0.65;

/// An arc in place of a part, or lines where there is none.
pub(super) struct Arcs {
    chords: Chords,
    arc: Option<Arc>,
    deviation: f64,
}

impl Contour {
    /// Pushes the contour's edges, closed: lines and circular arcs as they are, other curves as arcs that cover the same
    /// area.
    pub(crate) fn arcs(&self, fineness: &Fineness, out: &mut Vec<Edge>) {
        fit::push_contour::<Arcs>(self, fineness, out);
    }
}

impl Arc {
    /// The arc from one point to another that encloses half of an area with its chord, on the right of that if it is above 0 where y
    /// points up; none where it would be straight or turn far.
    pub(crate) fn enclosing(from: DVec2, to: DVec2, double_area: f64) -> Option<Self> {
        let chord = to - from;
        // A turn by t encloses t / 6 (1 + t² / 30 + t⁴ / 840) of half the chord's square: this turned round.
        let x = 6.0 * double_area / chord.length_squared();
        let x2 = x * x;
        let sweep = x * (1.0 - x2 * (1.0 / 30.0 - x2 * (3.0 / 1400.0)));
        if !(STRAIGHT..=FARTHEST).contains(&sweep.abs()) {
            return None;
        }
        let center = from + chord / 2.0 + chord.perp() * (0.5 / tan(sweep / 2.0));
        let spoke = from - center;
        Some(Self {
            center,
            radius: chord.length() * 0.5 / sin(sweep.abs() / 2.0),
            start: atan2(spoke.y, spoke.x),
            sweep,
            from,
            to,
        })
    }
}

impl Fit for Arcs {
    fn root_of_width(excess: f64) -> f64 {
        cbrt(excess)
    }

    fn root_of_area(excess: f64) -> f64 {
        excess.sqrt().sqrt()
    }

    fn new(part: &Part) -> Self {
        let chords = Chords::new(part);
        let arc = (!is_hairpin(part))
            .then(|| Arc::enclosing(part.from, part.to, part.double_area()))
            .flatten();
        let deviation = arc.map_or(chords.deviation(), |arc| {
            let distances = ASKED.map(|t| ((part.at(t) - arc.center).length() - arc.radius).abs());
            BETWEEN * distances.into_iter().fold(0.0, f64::max)
        });
        Self {
            chords,
            arc,
            deviation,
        }
    }

    fn deviation(&self) -> f64 {
        self.deviation
    }

    fn lobes(&self) -> f64 {
        self.arc.map_or(self.chords.lobes(), |arc| {
            LOBES * self.deviation * arc.radius * arc.sweep.abs()
        })
    }

    fn unbalanced(&self) -> f64 {
        if self.arc.is_some() {
            BORDERS * self.lobes()
        } else {
            self.chords.unbalanced()
        }
    }

    fn push(&self, out: &mut Vec<Edge>) {
        match self.arc {
            Some(arc) => out.push(Edge::Arc(arc)),
            None => self.chords.push(out),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::at_point;
    use crate::outline::{Outline, sides};
    use crate::path::{FillRule, Path};
    use crate::shape::Shape;

    /// A heart, and a leaf that turns both ways.
    fn paths() -> [Path; 2] {
        let mut heart = Path::new();
        heart
            .move_to([60.0, 110.0])
            .cubic_to([0.0, 70.0], [-10.0, 35.0], [5.0, 17.0])
            .cubic_to([22.0, -2.0], [50.0, 5.0], [60.0, 28.0])
            .cubic_to([70.0, 5.0], [98.0, -2.0], [115.0, 17.0])
            .cubic_to([130.0, 35.0], [120.0, 70.0], [60.0, 110.0])
            .close();
        let mut leaf = Path::new();
        leaf.move_to([0.0, 60.0])
            .cubic_to([40.0, -20.0], [70.0, 90.0], [110.0, 30.0])
            .quad_to([120.0, 120.0], [0.0, 60.0])
            .close();
        [heart, leaf]
    }

    fn edges(path: &Path, levels: f64, radius: f64) -> Vec<Edge> {
        let mut edges = Vec::new();
        path.contours[0].arcs(&Fineness::new(levels, radius, 1.0), &mut edges);
        assert!(sides(&edges).all(|(a, b)| a.to() == b.from()));
        edges
    }

    #[test]
    fn arcs_end_where_their_parts_do_and_cover_the_same_area() {
        for path in paths() {
            let area =
                |edges: &[Edge]| -> f64 { edges.iter().map(|e| e.double_area(DVec2::ZERO)).sum() };
            let exact = area(&edges(&path, 1e-5, 1.0));
            for (levels, radius) in [(0.1, 1.0), (0.25, 20.0), (4.0, 60.0)] {
                let edges = edges(&path, levels, radius);
                let found = area(&edges);
                assert!(
                    (found / exact - 1.0).abs() < 2e-5,
                    "{levels} {radius}: {found}"
                );
                let mut count = 0;
                for edge in &edges {
                    let Edge::Arc(arc) = edge else { continue };
                    count += 1;
                    assert!((arc.at(arc.start) - arc.from).length() < 1e-9);
                    assert!((arc.at(arc.start + arc.sweep) - arc.to).length() < 1e-9);
                }
                assert!(count > 0, "{levels} {radius}: no arcs");
            }
        }
    }

    #[test]
    fn no_density_moves_by_more_than_was_asked_and_arcs_are_fewer_than_lines() {
        for path in paths() {
            let shape = Shape::path(&path, FillRule::NonZero).unwrap();
            let fine = Outline::of_flattened(&shape, 1e-5);
            for radius in [1.0, 4.0, 15.0, 40.0, 90.0] {
                for levels in [0.1, 0.25, 1.0] {
                    let edges = edges(&path, levels, radius);
                    let mut lines = Vec::new();
                    let fineness = Fineness::new(levels, radius, 1.0);
                    path.contours[0].chords(&fineness, &mut lines);
                    assert!(edges.len() <= lines.len());
                    let mut worst: f64 = 0.0;
                    for row in -4..=24 {
                        for column in -4..=24 {
                            let point = DVec2::new(f64::from(column), f64::from(row)) * 5.7;
                            let found = at_point(edges.iter(), point, radius);
                            let exact = at_point(fine.edges(), point, radius);
                            worst = worst.max((found - exact).abs() * 255.0);
                        }
                    }
                    println!(
                        "radius {radius}, {levels} levels: {worst:.4}, {} arcs, {} lines",
                        edges.len(),
                        lines.len()
                    );
                    assert!(worst <= levels, "radius {radius}, {levels}: {worst}");
                }
            }
        }
    }
}
