//! Shadow volumes (Crow 1977; Nishita & Nakamae 1983; "Realistic Rendering", slides 70 to 75), where the receiver cuts them.
//!
//! The shadow volume of a point of light is bounded by the planes through it and the caster's contour; on the receiver it is
//! the caster's projection. A disc of light is a regular polygon of its area. The penumbra volume is the smallest convex
//! one that holds the shadow volumes of all its corners, the umbra volume what these have in common. In the umbra
//! nothing of the light is seen, outside of the penumbra all of it, and between them what the caster leaves of the polygon.

use core::f64::consts::{PI, TAU};

use glam::DVec2;
use libm::{cos, sin};

use super::view::{View, holds};
use super::{Claim, Family, Parameter, Technique};
use crate::error::{self, Result};
use crate::grid::Grid;
use crate::outline::sides;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// Umbra and penumbra volume of a light of so many corners; one corner is a point of light.
#[derive(Debug, Clone, Copy)]
pub struct ShadowVolume {
    corners: u32,
}

impl ShadowVolume {
    /// A light of so many corners.
    ///
    /// # Errors
    /// Neither 1 nor from 3 to 256 corners.
    pub fn new(corners: u32) -> Result<Self> {
        let least = if corners == 1 { 1.0 } else { 3.0 };
        error::within("corners", f64::from(corners), least, 256.0)?;
        Ok(Self { corners })
    }

    /// The light's corners; its area is the unit disc's.
    fn light(self) -> Vec<DVec2> {
        if self.corners == 1 {
            return vec![DVec2::ZERO];
        }
        let count = f64::from(self.corners);
        let radius = (TAU / (count * sin(TAU / count))).sqrt();
        let corner = |i: u32| {
            let angle = TAU * (f64::from(i) + 0.5) / count;
            DVec2::new(cos(angle), sin(angle)) * radius
        };
        (0..self.corners).map(corner).collect()
    }
}

/// The smallest convex polygon round points, its inside on the left (Andrew 1979).
pub(super) fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let mut hull: Vec<DVec2> = Vec::new();
    let mut half = |points: &mut dyn Iterator<Item = DVec2>| {
        let kept = hull.len();
        for point in points {
            while hull.len() >= kept + 2 {
                let (a, b) = (hull[hull.len() - 2], hull[hull.len() - 1]);
                if (b - a).perp_dot(point - b) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(point);
        }
        hull.pop();
    };
    half(&mut points.iter().copied());
    half(&mut points.iter().rev().copied());
    hull
}

/// Whether a convex polygon holds a point.
fn in_convex(polygon: &[DVec2], point: DVec2) -> bool {
    sides(polygon).all(|(a, b)| (b - a).perp_dot(point - a) >= 0.0)
}

/// Twice the signed area between a convex polygon and the triangle of the origin and a line: summed over an outline's
/// lines, twice the area that outline and polygon share.
fn shared(light: &[DVec2], from: DVec2, to: DVec2, spare: &mut [Vec<DVec2>; 2]) -> f64 {
    let turn = from.perp_dot(to);
    if turn == 0.0 {
        return 0.0;
    }
    let [inside, next] = spare;
    inside.clear();
    inside.extend([DVec2::ZERO, from, to]);
    // Cut by one side of the light after the other (Sutherland & Hodgman 1974).
    for (a, b) in sides(light) {
        let height = |p: DVec2| (b - a).perp_dot(p - a);
        next.clear();
        for (p, q) in sides(inside) {
            let (hp, hq) = (height(p), height(q));
            if hp >= 0.0 {
                next.push(p);
            }
            if (hp >= 0.0) != (hq >= 0.0) {
                next.push(p + (q - p) * (hp / (hp - hq)));
            }
        }
        core::mem::swap(inside, next);
    }
    sides(inside).map(|(p, q)| p.perp_dot(q)).sum()
}

impl Technique for ShadowVolume {
    fn name(&self) -> &'static str {
        "shadow-volume"
    }

    fn family(&self) -> Family {
        Family::Geometry
    }

    fn parameters(&self) -> Vec<Parameter> {
        let corners = f64::from(self.corners);
        vec![Parameter::number("corners", corners, "", [1.0, 256.0])]
    }

    fn refusal(&self, shadow: &Shadow, _: &Grid) -> Option<&'static str> {
        let convex = shadow.exact_outline().loops.len() == 1;
        (!convex).then_some("between holes, what all corners' volumes share need not be umbra")
    }

    fn claim(&self) -> Claim {
        Claim {
            levels: None,
            why: "a polygon in place of the disc: exact for that light, where casters are convex",
        }
    }

    fn draw(
        &self,
        shadow: &Shadow,
        grid: &Grid,
        densities: &mut [f32],
        _: &mut Scratch,
    ) -> Result<()> {
        let view = View::new(shadow, grid, 0.1);
        let light = self.light();
        let radius = view.radius;
        // A corner of the light throws the outline's points the other way.
        let thrown = |point: DVec2| light.iter().map(move |corner| point - *corner * radius);
        let penumbra = hull(view.lines().flat_map(|(a, _)| thrown(a)).collect());
        let reach = light[0].length() * radius;
        let mut spare = [Vec::new(), Vec::new()];
        view.draw(grid, reach, densities, |center, _, lines| {
            if radius == 0.0 || light.len() == 1 {
                return f64::from(u8::from(holds(lines, center)));
            }
            if !in_convex(&penumbra, center) {
                return 0.0;
            }
            if light.iter().all(|c| holds(lines, center + *c * radius)) {
                return 1.0;
            }
            let place = |p: DVec2| (p - center) / radius;
            let double: f64 = lines
                .iter()
                .map(|(a, b)| shared(&light, place(*a), place(*b), &mut spare))
                .sum();
            (double / (2.0 * PI)).clamp(0.0, 1.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{card, errors, on_grid};
    use super::*;
    use crate::path::FillRule;
    use crate::shape::Shape;

    #[test]
    fn more_corners_are_more_of_a_disc() {
        let (shadow, grid) = card(9.0);
        for (corners, allowed) in [(4, 20.0), (8, 4.0), (16, 1.0), (64, 0.1)] {
            let got = errors(&ShadowVolume::new(corners).unwrap(), &shadow, &grid);
            println!("{corners} corners: {got:?}");
            assert!(got.max_levels < allowed, "{corners}: {got:?}");
        }
        assert!(ShadowVolume::new(2).is_err());
    }

    #[test]
    fn what_all_corners_lose_is_no_umbra_behind_a_hole() {
        let square = |a: f32, b: f32| [[a, a], [b, a], [b, b], [a, b]];
        let shape =
            Shape::polygon(&[square(10.0, 90.0), square(47.0, 53.0)], FillRule::EvenOdd).unwrap();
        let (shadow, grid) = on_grid(&shape, 10.0, [100, 100]);
        let volume = ShadowVolume::new(16).unwrap();
        assert!(volume.refusal(&shadow, &grid).is_some());
        let got = errors(&volume, &shadow, &grid);
        println!("{got:?}");
        assert!(got.max_levels > 25.0, "{got:?}");
    }
}
