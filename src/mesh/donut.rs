//! Meshes without what an opaque caster covers anyway.

mod cut;

use glam::DVec2;

use super::{FACET, ShadowMesh, projection_circles, tangent_loops};
use crate::error::{self, Result};
use crate::light::Projection;
use crate::outline::Edge;
use crate::shadow::Shadow;
use crate::shape::Shape;

impl ShadowMesh {
    /// The mesh without what an opaque caster hides, as seen from above: the part inside of `caster` and at least `overlap`
    /// (scene units) from its edges. Triangles that lie on both sides are cut there: along straight edges within a 200th of
    /// the overlap, along curves within a tenth, neither of them nearer than the overlap. One pixel leaves no light gap along an
    /// antialiased edge. What is left is the same field as before. For translucent casters keep the whole mesh.
    ///
    /// ```
    /// use penumbral::{Light, Shape, Tolerance};
    ///
    /// let card = Shape::rounded_rect(16.0, 100.0, 300.0, 200.0, 12.0)?;
    /// let shadow = Light::android(400.0)?.cast(&card, 8.0, 0.0)?;
    /// let mesh = shadow.mesh(Tolerance::ONE_LEVEL);
    /// let visible = mesh.without_covered(&card, 1.0)?;
    /// assert!(visible.indices().len() < mesh.indices().len());
    /// # Ok::<(), penumbral::Error>(())
    /// ```
    ///
    /// # Errors
    /// An overlap that is negative, not finite or passes [`MAX_COORDINATE`](crate::MAX_COORDINATE).
    pub fn without_covered(&self, caster: &Shape, overlap: f32) -> Result<Self> {
        let overlap = error::length("overlap", f64::from(overlap))?;
        let own = Shadow::project(core::slice::from_ref(caster), &Projection::in_place(0.0));
        let flat = (overlap * OVERLAP_FLATNESS).max(own.extent() * FACET);
        let outline = own.outline(flat);
        let curved = !own.is_fixed() || outline.edges().any(|edge| matches!(edge, Edge::Arc(_)));
        // Chords may lie outside of concave curves, and curves are cut into lines twice.
        let margin = if curved {
            overlap + 2.0 * flat
        } else {
            overlap
        };
        let step = f64::from(f32::EPSILON) * self.largest_coordinate();
        // What the cut leaves inside must not be nearer for its own chords and rounding.
        let depth = (margin + ROUNDED * step) / (1.0 - CUT_FLATNESS);
        let circles = projection_circles(&outline, depth, flat);
        let inset = tangent_loops(&circles, 1.0, depth * CUT_FLATNESS);
        let cut = cut::cut(self, &inset, step);
        let lines: Vec<[DVec2; 2]> = outline
            .polygons(flat)
            .iter()
            .flat_map(|points| {
                let next = points.iter().cycle().skip(1);
                points.iter().zip(next).map(|(&from, &to)| [from, to])
            })
            .collect();
        // Whatever could not be cut stays whole: what is left never lacks anything.
        Ok(cut.filtered(|triangle| {
            !is_inside(triangle[0], &lines)
                || lines.iter().any(|line| is_near(triangle, line, margin))
        }))
    }

    fn largest_coordinate(&self) -> f64 {
        let positions = self.vertices.iter().flat_map(|vertex| vertex.position);
        f64::from(positions.fold(0.0, |largest: f32, x| largest.max(x.abs())))
    }

    /// The mesh of the triangles that are kept.
    fn filtered(&self, keep: impl Fn(&[DVec2; 3]) -> bool) -> Self {
        let mut mesh = Self {
            vertices: Vec::new(),
            indices: Vec::new(),
            ..*self
        };
        let mut numbers = vec![None; self.vertices.len()];
        for corners in self.indices.as_chunks::<3>().0 {
            let at = |i: u32| DVec2::from(self.vertices[i as usize].position.map(f64::from));
            if !keep(&corners.map(at)) {
                continue;
            }
            for &corner in corners {
                let number = *numbers[corner as usize].get_or_insert_with(|| {
                    mesh.vertices.push(self.vertices[corner as usize]);
                    mesh.vertices.len() as u32 - 1
                });
                mesh.indices.push(number);
            }
        }
        mesh
    }
}

/// How far chords may be from the caster's curves, over the overlap.
const OVERLAP_FLATNESS: f64 = 1.0 / 32.0;

/// The same for the arcs of the cut about corners, which are as small as the overlap.
const CUT_FLATNESS: f64 = 1.0 / 256.0;

/// How far rounding may take the cut, in steps of `f32`.
const ROUNDED: f64 = 4.0;

/// Whether a ray from the point to growing x crosses an odd number of lines.
fn is_inside(point: DVec2, lines: &[[DVec2; 2]]) -> bool {
    let crossed = |&&[from, to]: &&[DVec2; 2]| {
        let left = (to - from).perp_dot(point - from);
        (from.y > point.y) != (to.y > point.y) && (left > 0.0) == (to.y > from.y)
    };
    lines.iter().filter(crossed).count() % 2 == 1
}

/// Whether a point of the triangle is nearer than `margin` to the line.
fn is_near(triangle: &[DVec2; 3], line: &[DVec2; 2], margin: f64) -> bool {
    let [a, b, c] = *triangle;
    let [from, to] = *line;
    let apart = (a.min(b).min(c) - from.max(to)).max(from.min(to) - a.max(b).max(c));
    if apart.max_element() >= margin {
        return false;
    }
    let sides = [[a, b], [b, c], [c, a]];
    let inside = sides.iter().all(|[s, t]| (t - s).perp_dot(from - s) >= 0.0);
    inside
        || sides.iter().any(|side| {
            crosses(side, line)
                || distance(side[0], line) < margin
                || line.iter().any(|&end| distance(end, side) < margin)
        })
}

fn crosses([a, b]: &[DVec2; 2], [c, d]: &[DVec2; 2]) -> bool {
    let side = |from: DVec2, to: DVec2, point: DVec2| (to - from).perp_dot(point - from) > 0.0;
    side(*a, *b, *c) != side(*a, *b, *d) && side(*c, *d, *a) != side(*c, *d, *b)
}

/// From a point to the nearest of a line.
fn distance(point: DVec2, [from, to]: &[DVec2; 2]) -> f64 {
    let along = to - from;
    let length = along.length_squared();
    let share = if length > 0.0 {
        ((point - from).dot(along) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (point - from - along * share).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use crate::path::FillRule;
    use crate::tolerance::Tolerance;

    fn covers(mesh: &ShadowMesh, point: DVec2) -> bool {
        mesh.triangles().any(|corners| {
            let [a, b, c] = corners.map(|v| DVec2::from(v.position.map(f64::from)));
            let sides = [[a, b], [b, c], [c, a]];
            sides
                .iter()
                .all(|[s, t]| (t - s).perp_dot(point - s) >= 0.0)
        })
    }

    fn area(mesh: &ShadowMesh) -> f64 {
        let of = |[a, b, c]: [DVec2; 3]| (b - a).perp_dot(c - a) / 2.0;
        let triangles = mesh.triangles();
        triangles
            .map(|corners| of(corners.map(|v| DVec2::from(v.position.map(f64::from)))))
            .sum()
    }

    /// The signed distance inside of a rectangle with one radius, written without any of the above.
    fn depth(point: DVec2, min: DVec2, max: DVec2, corner: f64) -> f64 {
        let q = (point - min.midpoint(max)).abs() - (max - min) / 2.0 + corner;
        corner - q.max(DVec2::ZERO).length() - q.max_element().min(0.0)
    }

    /// Checks that what is further out than the overlap stays, and gives the shares of area and triangles that stay.
    fn check(caster: &Shape, depth: impl Fn(DVec2) -> f64, elevation: f32) -> [f64; 2] {
        let light = Light::android(200.0).unwrap();
        let shadow = light.cast(caster, elevation, 0.0).unwrap();
        let mesh = shadow.mesh(Tolerance::ONE_LEVEL);
        let donut = mesh.without_covered(caster, 1.0).unwrap();
        let bounds = shadow.bounds().unwrap();
        let [min, max] = [bounds.min, bounds.max].map(|p| DVec2::from(p.map(f64::from)));
        for i in 0..80 {
            for j in 0..80 {
                let share = (DVec2::new(f64::from(i), f64::from(j)) + 0.5) / 80.0;
                let point = min + (max - min) * share;
                if depth(point) < 1.0 && covers(&mesh, point) {
                    assert!(covers(&donut, point), "a gap at {point}");
                }
            }
        }
        [
            area(&donut) / area(&mesh),
            donut.indices.len() as f64 / mesh.indices.len() as f64,
        ]
    }

    #[test]
    fn nothing_that_is_seen_is_left_out() {
        let (min, max) = (DVec2::new(30.0, 20.0), DVec2::new(150.0, 100.0));
        let card = Shape::rounded_rect(30.0, 20.0, 120.0, 80.0, 12.0).unwrap();
        for elevation in [1.0, 8.0, 30.0] {
            let left = check(&card, |p| depth(p, min, max, 12.0), elevation);
            println!("card at {elevation}: {left:.3?} of area and triangles");
            assert!(elevation > 10.0 || left[0] < 0.5 && left[1] < 0.9);
        }
        let ring = |low: f32, x: f32, y: f32| vec![[low, low], [x, low], [x, y], [low, y]];
        let rings = [ring(30.0, 150.0, 100.0), ring(60.0, 110.0, 75.0)];
        let frame = Shape::polygon(&rings, FillRule::EvenOdd).unwrap();
        let (outer, inner) = (DVec2::splat(30.0), DVec2::splat(60.0));
        let left = check(
            &frame,
            |p| depth(p, outer, max, 0.0).min(-depth(p, inner, DVec2::new(110.0, 75.0), 0.0)),
            6.0,
        );
        println!("frame: {left:.3?} of area and triangles");
        assert!(left[1] < 0.9);
    }

    #[test]
    fn other_casters_and_wide_overlaps_leave_all() {
        let card = Shape::rounded_rect(30.0, 20.0, 120.0, 80.0, 12.0).unwrap();
        let shadow = Light::android(200.0)
            .unwrap()
            .cast(&card, 8.0, 0.0)
            .unwrap();
        let mesh = shadow.mesh(Tolerance::ONE_LEVEL);
        let elsewhere = card.translated([500.0, 0.0]).unwrap();
        let kept = mesh.without_covered(&elsewhere, 1.0).unwrap();
        assert_eq!(kept.indices.len(), mesh.indices.len());
        assert_eq!(kept.error_levels(), mesh.error_levels());
        let wide = mesh.without_covered(&card, 41.0).unwrap();
        assert_eq!(wide.indices.len(), mesh.indices.len());
        // A caster that covers the whole shadow leaves nothing.
        let sheet = Shape::rect(-500.0, -500.0, 2000.0, 2000.0).unwrap();
        let none = mesh.without_covered(&sheet, 1.0).unwrap();
        assert!(none.vertices.is_empty() && none.indices.is_empty());
        assert!(mesh.without_covered(&card, -1.0).is_err());
    }
}
