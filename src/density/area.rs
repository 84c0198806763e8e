//! The area that an outline and a disc share, in closed form.
//!
//! By Green's theorem the area is a sum over the edges, half the integral of x dy - y dx about the disc's centre: along
//! the part of an edge inside the disc, and along the disc's own circle instead of the parts outside, each of which
//! spans a circular sector. A line inside spans a triangle; an arc inside spans a triangle and its circular segment.
//! The sum is signed, so concave outlines and holes need no case of their own.

use core::f64::consts::{FRAC_PI_4, PI, TAU};

use glam::DVec2;
use libm::{asin, atan2, sin};

use crate::outline::{Arc, Edge, turn};

/// The fraction of the disc of `radius` about `point` that lies inside the edges; for radius 0, whether the point does.
pub(crate) fn at_point<'a>(
    edges: impl Iterator<Item = &'a Edge>,
    point: DVec2,
    radius: f64,
) -> f64 {
    // The disc becomes the unit disc about the origin; a point keeps its unit.
    let (disc, factor) = if radius > 0.0 {
        (1.0, 1.0 / radius)
    } else {
        (0.0, 1.0)
    };
    let place = |p: DVec2| (p - point) * factor;
    let double_area: f64 = edges
        .map(|edge| match edge {
            Edge::Line(line) if disc > 0.0 => of_line(place(line.from), place(line.to)),
            Edge::Line(line) | Edge::Border(line) => turn(place(line.from), place(line.to)),
            Edge::Arc(arc) => of_arc(&arc.mapped(factor, place), disc),
        })
        .sum();
    settled(double_area / TAU)
}

/// A density as near to 0 or 1 as rounding leaves one where there is nothing, or all: some 1e-16 for each edge.
const ROUNDING: f64 = 1e-12;

/// A density without the rounding that a sum of angles leaves about nothing and about all.
pub(super) fn settled(density: f64) -> f64 {
    if density < ROUNDING {
        0.0
    } else if density > 1.0 - ROUNDING {
        1.0
    } else {
        density
    }
}

/// The area of the unit disc between y = 0 and `t`, right of its centre: from -π/4 to π/4.
pub(crate) fn half_area(t: f64) -> f64 {
    let t = t.clamp(-1.0, 1.0);
    f64::midpoint(t * ((1.0 - t) * (1.0 + t)).sqrt(), asin(t))
}

/// Twice the area that a line spans with the unit disc about the origin.
pub(super) fn of_line(from: DVec2, to: DVec2) -> f64 {
    /// The square of a distance from which on an end has few digits left for the disc.
    const FAR: f64 = 1e12;
    if from.length_squared() > FAR.max(to.length_squared()) {
        return -of_line(to, from);
    }
    let length = (to - from).length();
    if length == 0.0 {
        return 0.0;
    }
    let along = (to - from) / length;
    // The line's signed distance, and its points by their distance from the foot point: differences of squared
    // distances would lose all digits where the disc is small.
    let distance = from.perp_dot(along);
    if distance.abs() >= 1.0 {
        return turn(from, to);
    }
    let half_chord = ((1.0 - distance) * (1.0 + distance)).sqrt();
    let start = from.dot(along);
    let first = start.max(-half_chord);
    let last = (start + length).min(half_chord);
    if first >= last {
        return turn(from, to);
    }
    let foot = from - start * along;
    let mut area = distance * (last - first);
    if first > start {
        area += turn(from, foot + first * along);
    }
    if last < start + length {
        area += turn(foot + last * along, to);
    }
    area
}

/// Twice the area that an arc spans with the disc of radius `disc`, 1 or 0, about the origin.
fn of_arc(arc: &Arc, disc: f64) -> f64 {
    let distance = arc.center.length();
    // The arc's points in the disc are those within `half_width` of the one nearest to the origin. By half angles:
    // the cosine alone would lose all digits where the disc is small.
    let half_width = if arc.radius + distance <= disc {
        PI
    } else if (arc.radius - distance).abs() >= disc {
        0.0
    } else {
        let past = arc.radius - distance;
        2.0 * asin(
            ((disc - past) * (disc + past) / (4.0 * arc.radius * distance))
                .sqrt()
                .min(1.0),
        )
    };
    let nearest = atan2(-arc.center.y, -arc.center.x);
    let mut area = 0.0;
    arc.split(nearest, half_width, |piece, inside| {
        area += if inside {
            piece.from.perp_dot(piece.to)
                + piece.radius * piece.radius * (piece.sweep - sin(piece.sweep))
        } else {
            angle_of_arc(&piece, distance < piece.radius)
        };
    });
    area
}

/// The angle that an arc spans, seen from the origin.
///
/// From outside of its circle an arc spans less than a half turn. From inside, between chord and arc, it spans more,
/// up to a half turn plus half of its own sweep, in its own direction: then the angle of its chord has the other sign
/// and is at least a quarter turn for sweeps of at most a half turn. (A smaller one of the other sign is rounding.)
fn angle_of_arc(arc: &Arc, from_inside: bool) -> f64 {
    let chord = turn(arc.from, arc.to);
    if from_inside && chord * arc.sweep < 0.0 && chord.abs() > FRAC_PI_4 {
        chord + if arc.sweep > 0.0 { TAU } else { -TAU }
    } else {
        chord
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::outline::Outline;
    use crate::shape::Shape;

    fn density(shape: &Shape, point: [f64; 2], radius: f64) -> f64 {
        at_point(
            Outline::of_simple(shape).unwrap().edges(),
            DVec2::from_array(point),
            radius,
        )
    }

    /// The profile of a straight edge, F(t).
    fn edge_profile(t: f64) -> f64 {
        0.5 + (t * (1.0 - t * t).sqrt() + t.asin()) / PI
    }

    #[test]
    fn a_straight_edge_has_the_discs_profile() {
        let half_plane = Shape::rect(0.0, -1000.0, 2000.0, 2000.0).unwrap();
        for i in -10..=10 {
            let t = f64::from(i) / 10.0;
            let error = density(&half_plane, [t * 7.0, 3.0], 7.0) - edge_profile(t);
            assert!(error.abs() < 1e-13, "{t}: {error:e}");
        }
    }

    #[test]
    fn a_sharp_corner_hides_a_quarter_at_its_tip() {
        let quadrant = Shape::rect(0.0, 0.0, 1000.0, 1000.0).unwrap();
        assert!((density(&quadrant, [0.0, 0.0], 9.0) - 0.25).abs() < 1e-13);
        // Within 3.5 levels of the product of its edges' profiles, and no closer everywhere.
        let mut worst: f64 = 0.0;
        for i in -20..=20 {
            for j in -20..=20 {
                let (x, y) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                let product = edge_profile(x) * edge_profile(y);
                worst = worst.max((density(&quadrant, [x, y], 1.0) - product).abs());
            }
        }
        assert!((3.0..3.5).contains(&(worst * 255.0)), "{}", worst * 255.0);
    }

    #[test]
    fn circle_in_circle_is_the_lens() {
        // Two unit circles at distance d share 2 acos(d/2) - d/2 sqrt(4 - d²).
        let circle = Shape::circle([0.0, 0.0], 1.0).unwrap();
        for d in [0.0, 1e-9, 0.3, 1.0, 1.7, 1.999_999, 2.0, 2.5] {
            let lens = if d < 2.0 {
                2.0 * (d / 2.0_f64).acos() - d / 2.0 * (4.0 - d * d).sqrt()
            } else {
                0.0
            };
            for direction in [0.0_f64, 0.7, FRAC_PI_2, 3.0] {
                let got = density(&circle, [d * direction.cos(), d * direction.sin()], 1.0);
                assert!(
                    (got - lens / PI).abs() < 1e-13,
                    "{d} {direction}: {got} {}",
                    lens / PI
                );
            }
        }
        // A circle inside the disc, and a disc inside the circle, anywhere between its chord and its arcs.
        assert!((density(&circle, [0.5, 0.2], 4.0) - 1.0 / 16.0).abs() < 1e-14);
        for point in [
            [0.0, 0.0],
            [0.0, 0.85],
            [0.0, -0.85],
            [0.85, 0.0],
            [-0.85, 0.01],
        ] {
            assert!(
                (density(&circle, point, 0.1) - 1.0).abs() < 1e-14,
                "{point:?}"
            );
            assert_eq!(density(&circle, point, 0.0), 1.0);
        }
        assert_eq!(density(&circle, [0.8, 0.8], 0.0), 0.0);
    }

    #[test]
    fn arcs_agree_with_fine_polygons() {
        let shape = Shape::rounded_rect(0.0, 0.0, 60.0, 30.0, [12.0, 4.0, 15.0, 0.0]).unwrap();
        let outline = Outline::of_simple(&shape).unwrap();
        let fine = Shape::polygon(
            &outline
                .polygons(1e-5)
                .iter()
                .map(|polygon| {
                    polygon
                        .iter()
                        .map(|p| [p.x as f32, p.y as f32])
                        .collect::<Vec<_>>()
                })
                .collect::<Vec<_>>(),
            crate::path::FillRule::NonZero,
        )
        .unwrap();
        for radius in [0.3, 4.0, 12.0, 40.0] {
            for i in 0..20 {
                for j in 0..20 {
                    let point = [f64::from(i) * 4.1 - 10.0, f64::from(j) * 2.7 - 10.0];
                    let error = density(&shape, point, radius) - density(&fine, point, radius);
                    assert!(error.abs() < 3e-5, "{point:?} r {radius}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn small_discs_on_far_long_edges_keep_their_digits() {
        let shape = Shape::rect(-1e6, -1e6, 1e6, 2e6).unwrap();
        for t in [-0.9, -0.3, 0.0, 0.5] {
            let radius = 1e-3;
            let error = density(&shape, [-t * radius, 17.3], radius) - edge_profile(t);
            assert!(error.abs() < 1e-6, "{error:e}");
        }
    }
}
