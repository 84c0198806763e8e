//! The classical tangent mesh (Zhu & Craik, US 9,639,976), as its kind is drawn: two rings and a strip between them.
//!
//! Each vertex of the caster is projected, and a circle of the penumbra radius drawn round it. Exterior tangents to the circles
//! bound the penumbra, interior ones the umbra; each vertex of the outer ring is joined to the nearest of the inner, and a
//! profile is laid across. What follows from drawing it so is kept, so that it can be seen: the outline is its convex
//! hull, the strip knows nothing of corners, and a caster without an umbra gets one by a rule of thumb.
//!
//! The crate's own [`ShadowMesh`] begins with the same tangents and refines what they leave.

use core::f64::consts::PI;

use glam::DVec2;
use libm::{cos, sin};

use super::shadow_volume::hull;
use super::view::View;
use super::{Claim, Family, Parameter, Technique};
use crate::error::Result;
use crate::grid::Grid;
use crate::mesh::{MeshVertex, Profile, ShadowMesh};
use crate::outline::{sides, turn};
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// How the umbra is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Umbra {
    /// Inside of the interior tangents. Where nothing is, inside of those to the largest circles that leave something, with
    /// the density 1/2 (inset / r + 1), as Skia has it.
    Tangents,
    /// Each vertex moved towards the centroid by its circle's radius, as Android's `SpotShadow` had it: a right angle's sides
    /// move by 0.71 of it only, and of a long bar's only its ends. Where every circle reaches the centroid, a twentieth of the outline
    /// about it, weaker by the least part of a circle that is before it.
    Centroid,
}

/// Two rings, and a profile across.
#[derive(Debug, Clone, Copy)]
pub struct Tangent {
    profile: Profile,
    umbra: Umbra,
}

/// Vertices of the outer ring for a half turn (`SpotShadow`).
const PER_HALF_TURN: f64 = 18.0;

impl Tangent {
    /// With a profile and a rule for the umbra.
    #[must_use]
    pub fn new(profile: Profile, umbra: Umbra) -> Self {
        Self { profile, umbra }
    }

    /// The inner ring, its inside on the left, and the density there.
    fn inner_ring(&self, outline: &[DVec2], radius: f64) -> (Vec<DVec2>, f64) {
        match self.umbra {
            Umbra::Tangents => {
                let umbra = inset(outline, radius);
                if umbra.len() > 2 {
                    return (umbra, 1.0);
                }
                let (mut low, mut high) = (0.0, radius);
                for _ in 0..40 {
                    let middle = f64::midpoint(low, high);
                    if inset(outline, middle).len() > 2 {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                // A ring of no size has no nearest vertices.
                let least = inset(outline, low * 0.98);
                (least, f64::midpoint(low / radius, 1.0))
            }
            Umbra::Centroid => {
                let centroid = centroid(outline);
                let reach = |v: &DVec2| radius / (centroid - *v).length();
                let least = outline.iter().map(reach).fold(f64::MAX, f64::min);
                if least >= 1.0 {
                    let ring = outline.iter().map(|v| centroid.lerp(*v, 0.05));
                    return (ring.collect(), 1.0 / least);
                }
                let ring = outline.iter().map(|v| v.lerp(centroid, reach(v).min(0.99)));
                (hull(ring.collect()), 1.0)
            }
        }
    }
}

/// Round arcs about the vertices of a convex polygon, joined by the tangents along its sides.
fn outer_ring(outline: &[DVec2], radius: f64) -> Vec<DVec2> {
    let count = outline.len();
    let normal = |i: usize| {
        let side = outline[(i + 1) % count] - outline[i % count];
        -side.perp().normalize_or_zero()
    };
    let mut ring = Vec::new();
    for (i, vertex) in outline.iter().enumerate() {
        let (before, after) = (normal(i + count - 1), normal(i));
        let turn = turn(before, after);
        let steps = (turn * PER_HALF_TURN / PI).ceil().max(1.0) as u32;
        ring.extend((0..=steps).map(|step| {
            let angle = turn * f64::from(step) / f64::from(steps);
            *vertex + DVec2::new(cos(angle), sin(angle)).rotate(before) * radius
        }));
    }
    ring.dedup();
    ring
}

/// A convex polygon within its sides moved inwards by `distance`: nothing where they leave nothing.
fn inset(outline: &[DVec2], distance: f64) -> Vec<DVec2> {
    let mut kept = outline.to_vec();
    for (a, b) in sides(outline) {
        let inwards = (b - a).perp().normalize_or_zero();
        let height = |p: DVec2| inwards.dot(p - a) - distance;
        let before = core::mem::take(&mut kept);
        for (p, q) in sides(&before) {
            let (hp, hq) = (height(p), height(q));
            if hp >= 0.0 {
                kept.push(p);
            }
            if (hp >= 0.0) != (hq >= 0.0) {
                kept.push(p + (q - p) * (hp / (hp - hq)));
            }
        }
    }
    kept
}

fn centroid(polygon: &[DVec2]) -> DVec2 {
    let Some(&origin) = polygon.first() else {
        return DVec2::ZERO;
    };
    let (mut sum, mut area) = (DVec2::ZERO, 0.0);
    for (a, b) in sides(polygon) {
        let (a, b) = (a - origin, b - origin);
        sum += (a + b) * a.perp_dot(b);
        area += a.perp_dot(b);
    }
    origin + sum / (3.0 * area)
}

/// Triangles from every vertex of the outer ring to the nearest of the inner, and from the inner to its middle.
fn join(outer: &[DVec2], inner: &[DVec2], density: f64) -> (Vec<(DVec2, f64)>, Vec<u32>) {
    let mut vertices: Vec<(DVec2, f64)> = outer.iter().map(|p| (*p, 0.0)).collect();
    vertices.extend(inner.iter().map(|p| (*p, density)));
    let middle = vertices.len() as u32;
    vertices.push((inner.iter().sum::<DVec2>() / inner.len() as f64, density));
    let nearest = |p: &DVec2| {
        let distance = |i: &usize| (inner[*i] - *p).length_squared();
        (0..inner.len())
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .unwrap_or(0)
    };
    let partners: Vec<usize> = outer.iter().map(nearest).collect();
    let at = |i: usize| (outer.len() + i % inner.len()) as u32;
    let mut indices = Vec::new();
    for (i, &partner) in partners.iter().enumerate() {
        let next = (i + 1) % outer.len();
        indices.extend([i as u32, next as u32, at(partner)]);
        let forward = (partners[next] + inner.len() - partner) % inner.len();
        if forward <= inner.len() / 2 {
            for step in partner..partner + forward {
                indices.extend([at(step), next as u32, at(step + 1)]);
            }
        } else {
            for step in 0..inner.len() - forward {
                let from = partner + inner.len() - step;
                indices.extend([at(from), next as u32, at(from - 1)]);
            }
        }
    }
    for i in 0..inner.len() {
        indices.extend([at(i), at(i + 1), middle]);
    }
    (vertices, indices)
}

impl Technique for Tangent {
    fn name(&self) -> &'static str {
        "tangent"
    }

    fn family(&self) -> Family {
        Family::Geometry
    }

    fn parameters(&self) -> Vec<Parameter> {
        let profile = match self.profile {
            Profile::Linear => "linear",
            Profile::Cosine => "cosine",
            Profile::Disc => "disc",
            Profile::Skia => "skia",
        };
        let umbra = match self.umbra {
            Umbra::Tangents => "tangents",
            Umbra::Centroid => "centroid",
        };
        vec![
            Parameter::choice("profile", profile, &["linear", "cosine", "disc", "skia"]),
            Parameter::choice("umbra", umbra, &["tangents", "centroid"]),
        ]
    }

    fn refusal(&self, shadow: &Shadow, _: &Grid) -> Option<&'static str> {
        let outline = shadow.exact_outline();
        let polygons = outline.polygons(shadow.extent() * 1e-4);
        let area = |points: &[DVec2]| sides(points).map(|(a, b)| a.perp_dot(b)).sum::<f64>();
        let convex = match polygons.as_slice() {
            [only] => area(&hull(only.clone())) <= area(only) * (1.0 + 1e-3),
            _ => false,
        };
        (!convex).then_some("it is not convex: its hull is drawn")
    }

    fn claim(&self) -> Claim {
        Claim {
            levels: None,
            why: "another profile than the disc's, and none that suits corners; without an umbra a rule of thumb",
        }
    }

    fn draw(
        &self,
        shadow: &Shadow,
        grid: &Grid,
        densities: &mut [f32],
        _: &mut Scratch,
    ) -> Result<()> {
        grid.check_buffer(densities.len())?;
        let view = View::new(shadow, grid, 0.5);
        let outline = hull(view.lines().map(|(a, _)| a).collect());
        let (vertices, indices) = if outline.len() < 3 {
            (Vec::new(), Vec::new())
        } else if view.radius > 0.0 {
            let (inner, density) = self.inner_ring(&outline, view.radius);
            join(&outer_ring(&outline, view.radius), &inner, density)
        } else {
            let fan = |i: usize| [0, i as u32, i as u32 + 1];
            let indices = (1..outline.len() - 1).flat_map(fan).collect();
            (outline.iter().map(|p| (*p, 1.0)).collect(), indices)
        };
        let vertex = |(position, density): (DVec2, f64)| MeshVertex {
            position: ((position + grid.corner()) / grid.pixels_per_unit())
                .as_vec2()
                .to_array(),
            density: density as f32,
        };
        let mesh = ShadowMesh::of_triangles(vertices.into_iter().map(vertex).collect(), indices);
        mesh.rasterize(grid, densities)?;
        for y in 0..grid.height() as usize {
            for density in &mut densities[y * grid.stride()..][..grid.width() as usize] {
                if *density > 0.0 {
                    *density = self.profile.at(2.0 * f64::from(*density) - 1.0) as f32;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{card, errors, on_grid};
    use super::*;
    use crate::shape::Shape;

    fn mesh(profile: Profile, umbra: Umbra) -> Tangent {
        Tangent::new(profile, umbra)
    }

    #[test]
    fn profiles_are_off_as_they_are_known_to_be() {
        // Far from corners.
        let shape = Shape::rect(-200.0, -300.0, 240.0, 600.0).unwrap();
        let (shadow, grid) = on_grid(&shape, 12.0, [80, 40]);
        for (profile, from, to) in [
            (Profile::Linear, 14.0, 15.5),
            (Profile::Cosine, 11.5, 13.5),
            (Profile::Skia, 38.0, 42.0),
            (Profile::Disc, 0.0, 0.2),
        ] {
            let got = errors(&mesh(profile, Umbra::Tangents), &shadow, &grid);
            println!("{profile:?}: {got:?}");
            assert!((from..to).contains(&got.max_levels), "{profile:?}: {got:?}");
        }
    }

    #[test]
    fn the_centroid_rule_thickens_bars() {
        let bar = Shape::rect(30.0, 38.0, 200.0, 4.0).unwrap();
        let (shadow, grid) = on_grid(&bar, 13.0, [260, 80]);
        let tangents = errors(&mesh(Profile::Cosine, Umbra::Tangents), &shadow, &grid);
        let centroid = errors(&mesh(Profile::Cosine, Umbra::Centroid), &shadow, &grid);
        println!("{tangents:?} {centroid:?}");
        // 0.8 of all density, as measured of Android's.
        assert!(centroid.max_levels > 180.0, "{centroid:?}");
        assert!(tangents.max_levels > 40.0 && tangents.max_levels < centroid.max_levels);
        let (shadow, grid) = card(9.0);
        let card = errors(&mesh(Profile::Cosine, Umbra::Tangents), &shadow, &grid);
        assert!((20.0..60.0).contains(&card.max_levels), "{card:?}");
    }
}
