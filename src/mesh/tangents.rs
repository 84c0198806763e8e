//! The tangent construction (Zhu & Craik, US 9,639,976): a circle round each projected vertex, exterior tangents to the
//! circles for the penumbra's outer edge, interior tangents for the umbra.
//!
//! A tangent is drawn along every edge, and from one tangent to the next an arc of the vertex' circle where the loop bends
//! away, or by way of the vertex itself where it bends inwards. The winding number of such a loop is 1 inside the
//! outline, plus or minus 1 in each strip between an edge and its tangent and in each sector of a circle. So the
//! penumbra's outer edge bounds where it is positive for tangents outside, and the umbra where it is positive for
//! tangents inside: concave corners, holes that close and umbrae that split or vanish need no case of their own.

use glam::DVec2;
use libm::{cos, sin};

use crate::outline::{self, Outline, Winding, resolve_loops};
use crate::path::arc_steps;

/// The light's disc as seen on the receiver through a vertex of the caster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ProjectionCircle {
    pub(crate) center: DVec2,
    pub(crate) radius: f64,
}

/// Vertices nearer to one another than this, over the penumbra radius, are one: where paths cross they come twice, a rounding error apart,
/// and the line from one to the other leads anywhere.
const ONE_VERTEX: f64 = 1e-9;

/// The circles round the vertices of an outline that is seen through one radius everywhere.
pub(super) fn projection_circles(
    outline: &Outline,
    radius: f64,
    flatness: f64,
) -> Vec<Vec<ProjectionCircle>> {
    let circle = |center| ProjectionCircle { center, radius };
    let is_one = |a: DVec2, b: DVec2| (a - b).length() <= ONE_VERTEX * radius;
    let mut polygons = outline.polygons(flatness);
    for points in &mut polygons {
        points.dedup_by(|next, point| is_one(*next, *point));
        while let [first, .., last] = points[..]
            && is_one(first, last)
        {
            points.pop();
        }
    }
    polygons
        .into_iter()
        .map(|points| points.into_iter().map(circle).collect())
        .collect()
}

/// The loops along the tangents to the circles of `t` times their radius: outside of the outline for t < 0, inside for
/// t > 0, the outline for 0. The outline's loops are oriented with their inside on the left where y points up.
///
/// Arcs are cut into lines within `flatness`. Straight tangents get two more vertices where a disc about them begins to
/// reach the circles at their ends, because up to there the density changes along the tangent and from there on it does
/// not.
pub(crate) fn tangent_loops(
    loops: &[Vec<ProjectionCircle>],
    t: f64,
    flatness: f64,
) -> Vec<Vec<DVec2>> {
    let raw: Vec<Vec<DVec2>> = loops
        .iter()
        .map(|circles| tangent_loop(circles, t, flatness))
        .collect();
    resolve_loops(&raw, Winding::Positive, true)
}

fn tangent_loop(circles: &[ProjectionCircle], t: f64, flatness: f64) -> Vec<DVec2> {
    let share = t.abs();
    let count = circles.len();
    let side = if t < 0.0 { -1.0 } else { 1.0 };
    let normals: Vec<DVec2> = (0..count)
        .map(|i| tangent_normal(circles[i], circles[(i + 1) % count], share, side))
        .collect();
    let radius = |i: usize| circles[i % count].radius * share;
    // The angle by which the tangent turns at each vertex, and whether so little that one vertex halfway serves both.
    let turns: Vec<f64> = (0..count)
        .map(|i| {
            let before = normals[(i + count - 1) % count];
            outline::turn(before, normals[i])
        })
        .collect();
    let bends_away = |i: usize| turns[i % count] * side <= 0.0;
    // Where it bends inwards the strips of both edges overlap. The way by the vertex counts that part twice, the one vertex
    // once: it is in neither loop as long as both strips hold it.
    let length = |i: usize| (circles[(i + 1) % count].center - circles[i].center).length();
    let overlaps = |i: usize| {
        let i = i % count;
        radius(i) * turns[i].abs() <= length(i).min(length((i + count - 1) % count))
    };
    let is_slight = |i: usize| {
        (bends_away(i) || overlaps(i))
            && radius(i) * (1.0 - cos(turns[i % count] / 2.0)) <= flatness
    };
    let halfway = |i: usize| {
        let turn = turns[i % count] / 2.0;
        let before = normals[(i + count - 1) % count];
        circles[i % count].center + DVec2::new(cos(turn), sin(turn)).rotate(before) * radius(i)
    };
    let mut vertices = Vec::with_capacity(4 * count);
    for i in 0..count {
        let center = circles[i].center;
        let before = normals[(i + count - 1) % count];
        if is_slight(i) {
            // The tangent begins there.
        } else if bends_away(i) {
            let steps = arc_steps(radius(i), turns[i], flatness);
            vertices.extend((0..steps).map(|step| {
                let angle = turns[i] * f64::from(step) / f64::from(steps);
                center + DVec2::new(cos(angle), sin(angle)).rotate(before) * radius(i)
            }));
        } else {
            vertices.extend([center + before * radius(i), center]);
        }
        let end = |i: usize, normal: DVec2| {
            if is_slight(i) {
                halfway(i)
            } else {
                circles[i % count].center + normal * radius(i)
            }
        };
        let (from, to) = (end(i, normals[i]), end(i + 1, normals[i]));
        vertices.push(from);
        let length = (to - from).length();
        let reach = |i: usize| {
            circles[i % count].radius * reach_past_corner(side * turns[i % count], share)
        };
        let (first, last) = (reach(i), reach(i + 1));
        if 0.0 < share && share < 1.0 && first + last < length {
            vertices.extend([
                from + (to - from) * (first / length),
                to - (to - from) * (last / length),
            ]);
        }
        vertices.push(to);
    }
    vertices.dedup();
    vertices
}

/// How far along a tangent at `share` of the radius from its edge, in radii from the corner on, a disc still reaches the
/// edge beyond the corner, which turns by `turn` towards the tangent (away from it if negative).
fn reach_past_corner(turn: f64, share: f64) -> f64 {
    let (sin_turn, cos_turn) = (sin(turn), cos(turn));
    let to_corner = ((1.0 - share) * (1.0 + share)).sqrt();
    if turn <= 0.0 {
        return to_corner;
    }
    // The disc touches the other edge's line from (1 - share cos) / sin on: that is on the edge when its foot point is.
    let to_line = (1.0 - share * cos_turn) / sin_turn.max(SHARPEST);
    let foot = share * sin_turn - to_line * cos_turn;
    if foot > 0.0 { to_line } else { to_corner }
}

/// Beyond the sharpest corners' reach refinement finds its own vertices.
const SHARPEST: f64 = 0.2;

/// The unit normal of the line that touches both circles on the left (`side` 1) or right (-1) of the way from one to the
/// other: its part along the way is the difference of the radii over the distance. Where one circle holds the other no
/// line touches both, and the normal points along the way.
pub(super) fn tangent_normal(
    from: ProjectionCircle,
    to: ProjectionCircle,
    share: f64,
    side: f64,
) -> DVec2 {
    let way = to.center - from.center;
    let distance = way.length();
    if distance == 0.0 {
        return DVec2::X;
    }
    let along = (share * (from.radius - to.radius) / distance).clamp(-1.0, 1.0);
    let across = ((1.0 - along) * (1.0 + along)).sqrt();
    let direction = way / distance;
    direction * along + direction.perp() * (side * across)
}

#[cfg(test)]
pub(super) mod tests {
    use core::f64::consts::PI;

    use super::*;
    use crate::outline::sides;

    fn circles(points: &[[f64; 2]], radius: f64) -> Vec<ProjectionCircle> {
        points
            .iter()
            .map(|&p| ProjectionCircle {
                center: DVec2::from_array(p),
                radius,
            })
            .collect()
    }

    pub(in crate::mesh) fn area(loops: &[Vec<DVec2>]) -> f64 {
        loops
            .iter()
            .map(|points| sides(points).map(|(a, b)| a.perp_dot(b)).sum::<f64>() / 2.0)
            .sum()
    }

    const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];

    #[test]
    fn a_square_grows_by_strips_and_quarter_circles() {
        let square = circles(&SQUARE, 3.0);
        let outer = tangent_loops(std::slice::from_ref(&square), -1.0, 1e-4);
        assert_eq!(outer.len(), 1);
        assert!((area(&outer) - (100.0 + 120.0 + 9.0 * PI)).abs() < 1e-2);
        let umbra = tangent_loops(std::slice::from_ref(&square), 1.0, 1e-4);
        assert!((area(&umbra) - 16.0).abs() < 1e-9);
        let outline = tangent_loops(std::slice::from_ref(&square), 0.0, 1e-4);
        assert!((area(&outline) - 100.0).abs() < 1e-9);
        // Between rings straight tangents keep the vertices where the corners come into reach.
        let ring = tangent_loops(&[square], -0.6, 1e-4);
        assert!(
            ring[0]
                .iter()
                .any(|p| (*p - DVec2::new(2.4, -1.8)).length() < 1e-9)
        );
    }

    #[test]
    fn umbrae_vanish_split_and_have_round_inner_corners() {
        assert!(tangent_loops(&[circles(&SQUARE, 5.1)], 1.0, 1e-3).is_empty());
        // Two rooms and a corridor narrower than the light.
        let rooms = [
            [0.0, 0.0],
            [10.0, 0.0],
            [10.0, 4.0],
            [20.0, 4.0],
            [20.0, 0.0],
            [30.0, 0.0],
            [30.0, 10.0],
            [20.0, 10.0],
            [20.0, 6.0],
            [10.0, 6.0],
            [10.0, 10.0],
            [0.0, 10.0],
        ];
        assert_eq!(tangent_loops(&[circles(&rooms, 2.0)], 1.0, 1e-3).len(), 2);
        assert_eq!(tangent_loops(&[circles(&rooms, 0.5)], 1.0, 1e-3).len(), 1);
        // An inner corner's circle is cut out of the umbra.
        let ell = [
            [0.0, 0.0],
            [20.0, 0.0],
            [20.0, 10.0],
            [10.0, 10.0],
            [10.0, 20.0],
            [0.0, 20.0],
        ];
        let umbra = tangent_loops(&[circles(&ell, 2.0)], 1.0, 1e-4);
        // The outline less a strip of 2 along each edge, where strips overlap at outer and leave a sector at the inner corner.
        let expected = 300.0 - 80.0 * 2.0 + 5.0 * 4.0 - PI;
        assert!(
            (area(&umbra) - expected).abs() < 1e-2,
            "{} {expected}",
            area(&umbra)
        );
    }

    #[test]
    fn holes_shrink_outside_and_grow_inside() {
        let outer = circles(
            &[[-10.0, -10.0], [20.0, -10.0], [20.0, 20.0], [-10.0, 20.0]],
            2.0,
        );
        let hole: Vec<_> = circles(&SQUARE, 2.0).into_iter().rev().collect();
        let grown = tangent_loops(&[outer.clone(), hole.clone()], -1.0, 1e-4);
        assert!((area(&grown) - (900.0 + 240.0 + 4.0 * PI - 36.0)).abs() < 1e-2);
        let umbra = tangent_loops(&[outer.clone(), hole], 1.0, 1e-4);
        assert!((area(&umbra) - (26.0 * 26.0 - (100.0 + 80.0 + 4.0 * PI))).abs() < 1e-2);
        // A hole narrower than the light closes.
        let slot: Vec<_> = circles(&[[0.0, 0.0], [10.0, 0.0], [10.0, 3.0], [0.0, 3.0]], 2.0)
            .into_iter()
            .rev()
            .collect();
        assert_eq!(tangent_loops(&[outer, slot], -1.0, 1e-3).len(), 1);
    }

    #[test]
    fn circles_of_several_radii_have_slanted_tangents() {
        // A card that stands with one edge on the ground: circles of radius 0 there and 4 at the far edge.
        let tilted = vec![
            ProjectionCircle {
                center: DVec2::ZERO,
                radius: 0.0,
            },
            ProjectionCircle {
                center: DVec2::new(20.0, 0.0),
                radius: 4.0,
            },
            ProjectionCircle {
                center: DVec2::new(20.0, 20.0),
                radius: 4.0,
            },
            ProjectionCircle {
                center: DVec2::new(0.0, 20.0),
                radius: 0.0,
            },
        ];
        let outer = tangent_loops(std::slice::from_ref(&tilted), -1.0, 1e-4);
        // Every tangent keeps its distance from both circles: the lowest point lies on the circle at (20, 0).
        let lowest = outer[0].iter().map(|p| p.y).fold(f64::MAX, f64::min);
        assert!((lowest + 4.0).abs() < 1e-3);
        let touch = DVec2::new(20.0 - 4.0 * 0.2, -4.0 * (1.0_f64 - 0.04).sqrt());
        assert!(
            outer[0].iter().any(|p| (*p - touch).length() < 1e-9),
            "{:?}",
            outer[0]
        );
        let umbra = tangent_loops(&[tilted], 1.0, 1e-4);
        let right = umbra[0].iter().map(|p| p.x).fold(f64::MIN, f64::max);
        assert!((right - 16.0).abs() < 1e-3);
        // One circle inside another: only the larger one shows.
        let nested = vec![
            ProjectionCircle {
                center: DVec2::ZERO,
                radius: 9.0,
            },
            ProjectionCircle {
                center: DVec2::new(2.0, 0.0),
                radius: 1.0,
            },
            ProjectionCircle {
                center: DVec2::new(1.0, 2.0),
                radius: 1.0,
            },
        ];
        let outer = tangent_loops(&[nested], -1.0, 1e-4);
        assert!(outer.iter().flatten().all(|p| p.length() < 9.5));
    }
}
