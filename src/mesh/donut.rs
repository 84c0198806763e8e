//! Meshes without what an opaque caster covers anyway.

mod boxes;
mod cut;

use boxes::{Boxes, Extent};
use glam::DVec2;

use super::ShadowMesh;
use super::skeleton::FACET;
use super::tangents::{projection_circles, tangent_loops};
use crate::error::{self, Result};
use crate::light::Projection;
use crate::outline::{Edge, nearest_share, sides};
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
            .flat_map(|points| sides(points).map(<[DVec2; 2]>::from))
            .collect();
        let boxes = Boxes::new(lines.iter().map(|&line| bounds(line)).zip(0..));
        let mut near = Vec::new();
        // Whatever could not be cut stays whole: what is left never lacks anything.
        Ok(cut.filtered(|triangle| {
            let [min, max] = bounds(*triangle);
            boxes.meeting([min - margin, max + margin], &mut near);
            near.iter()
                .any(|&line| is_near(triangle, &lines[line], margin))
                || !is_inside(triangle[0], &lines, &boxes, &mut near)
        }))
    }

    fn largest_coordinate(&self) -> f64 {
        let positions = self.vertices.iter().flat_map(|vertex| vertex.position);
        f64::from(positions.fold(0.0, |largest: f32, x| largest.max(x.abs())))
    }

    /// The mesh of the triangles that are kept.
    fn filtered(&self, mut keep: impl FnMut(&[DVec2; 3]) -> bool) -> Self {
        let mut mesh = Self {
            vertices: Vec::new(),
            indices: Vec::new(),
            ..*self
        };
        let mut numbers = vec![None; self.vertices.len()];
        for corners in self.indices.as_chunks::<3>().0 {
            let at = |i: u32| self.vertices[i as usize].at();
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

/// What holds some points.
fn bounds<const N: usize>(points: [DVec2; N]) -> Extent {
    let nothing = [DVec2::INFINITY, DVec2::NEG_INFINITY];
    points
        .into_iter()
        .fold(nothing, |[min, max], p| [min.min(p), max.max(p)])
}

/// Whether a ray from the point crosses an odd number of lines. It goes the short way: few lines are there.
fn is_inside(point: DVec2, lines: &[[DVec2; 2]], boxes: &Boxes, near: &mut Vec<usize>) -> bool {
    let [min, max] = boxes.bounds();
    let upwards = max.y - min.y < max.x - min.x;
    let turned = |p: DVec2| if upwards { DVec2::new(p.y, p.x) } else { p };
    let mut end = point;
    end[usize::from(upwards)] = f64::INFINITY;
    boxes.meeting([point, end], near);
    let point = turned(point);
    let crossed = |&&line: &&usize| {
        let [from, to] = lines[line].map(turned);
        let left = (to - from).perp_dot(point - from);
        (from.y > point.y) != (to.y > point.y) && (left > 0.0) == (to.y > from.y)
    };
    near.iter().filter(crossed).count() % 2 == 1
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
    (point - from - (to - from) * nearest_share(*from, *to, point)).length()
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::light::Light;
    use crate::mesh::tangents;
    use crate::outline::intersect_loops;
    use crate::path::{FillRule, Path};
    use crate::tolerance::Tolerance;

    /// Where the tests' casters lie: they are 120 x 80.
    const MIN: DVec2 = DVec2::new(30.0, 20.0);
    const MAX: DVec2 = DVec2::new(150.0, 100.0);

    fn corners(mesh: &ShadowMesh) -> impl Iterator<Item = [DVec2; 3]> {
        let place = |corners: [super::super::MeshVertex; 3]| corners.map(|v| v.at());
        mesh.triangles().map(place)
    }

    /// The density at a point in the triangles, if it lies in one.
    fn density(mesh: &ShadowMesh, point: DVec2) -> Option<f64> {
        let mut found = corners(mesh).zip(mesh.triangles());
        found.find_map(|([a, b, c], vertices)| {
            let parts = [[b, c], [c, a], [a, b]].map(|[s, t]| (t - s).perp_dot(point - s));
            parts.iter().all(|&part| part >= 0.0).then(|| {
                let weighed = parts.iter().zip(vertices);
                let sum: f64 = weighed.map(|(part, v)| part * f64::from(v.density)).sum();
                sum / parts.iter().sum::<f64>()
            })
        })
    }

    fn area(mesh: &ShadowMesh) -> f64 {
        let of = |[a, b, c]: [DVec2; 3]| (b - a).perp_dot(c - a) / 2.0;
        corners(mesh).map(of).sum()
    }

    /// The signed distance inside of a rectangle with one radius, written without any of the above.
    fn depth(point: DVec2, min: DVec2, max: DVec2, corner: f64) -> f64 {
        let q = (point - min.midpoint(max)).abs() - (max - min) / 2.0 + corner;
        corner - q.max(DVec2::ZERO).length() - q.max_element().min(0.0)
    }

    /// How far inside a point is.
    type Depth = Box<dyn Fn(DVec2) -> f64>;

    /// Polygons, circles and curves, convex and not, with the signed distance inside of each.
    fn casters() -> Vec<(&'static str, Shape, Depth)> {
        let ring = |x: f32, y: f32, far_x: f32, far_y: f32| {
            vec![[x, y], [far_x, y], [far_x, far_y], [x, far_y]]
        };
        let rings = [
            ring(30.0, 20.0, 150.0, 100.0),
            ring(60.0, 40.0, 110.0, 75.0),
        ];
        let ell = [
            30.0, 20.0, 150.0, 20.0, 150.0, 60.0, 90.0, 60.0, 90.0, 100.0, 30.0, 100.0,
        ];
        let ell = [ell.as_chunks::<2>().0.to_vec()];
        let mut disc = Path::new();
        for radius in [40.0, 18.0] {
            disc.move_to([90.0 - radius, 60.0])
                .arc_to([radius; 2], 0.0, false, true, [90.0 + radius, 60.0])
                .arc_to([radius; 2], 0.0, false, true, [90.0 - radius, 60.0])
                .close();
        }
        let off_center = |p: DVec2| (p - DVec2::new(90.0, 60.0)).length();
        let whole = |p| depth(p, MIN, MAX, 0.0);
        let hole = |p| depth(p, DVec2::new(60.0, 40.0), DVec2::new(110.0, 75.0), 0.0);
        let notch = |p| depth(p, DVec2::new(90.0, 60.0), DVec2::splat(900.0), 0.0);
        vec![
            (
                "card",
                Shape::rounded_rect(30.0, 20.0, 120.0, 80.0, 12.0).unwrap(),
                Box::new(|p| depth(p, MIN, MAX, 12.0)),
            ),
            (
                "rectangle",
                Shape::rect(30.0, 20.0, 120.0, 80.0).unwrap(),
                Box::new(whole),
            ),
            (
                "circle",
                Shape::circle([90.0, 60.0], 40.0).unwrap(),
                Box::new(move |p| 40.0 - off_center(p)),
            ),
            (
                "frame",
                Shape::polygon(&rings, FillRule::EvenOdd).unwrap(),
                Box::new(move |p| whole(p).min(-hole(p))),
            ),
            (
                "L",
                Shape::polygon(&ell, FillRule::NonZero).unwrap(),
                Box::new(move |p| whole(p).min(-notch(p))),
            ),
            (
                "ring",
                Shape::path(&disc, FillRule::EvenOdd).unwrap(),
                Box::new(move |p| (40.0 - off_center(p)).min(off_center(p) - 18.0)),
            ),
        ]
    }

    /// With Android's light, `away` from the origin as the caster is.
    fn mesh_of(caster: &Shape, elevation: f32, away: f32) -> ShadowMesh {
        let light = Light::new([away + 100.0, away, 600.0], 800.0).unwrap();
        let shadow = light.cast(caster, elevation, 0.0).unwrap();
        shadow.mesh(Tolerance::ONE_LEVEL)
    }

    /// Triangles have area and meet edge to edge, but for the mesh's own edge and the cut.
    fn check_structure(donut: &ShadowMesh, is_cut: impl Fn(DVec2) -> bool) {
        assert!(corners(donut).all(|[a, b, c]| (b - a).perp_dot(c - a) > 0.0));
        let mut edges = HashSet::new();
        for &[a, b, c] in donut.indices.as_chunks::<3>().0 {
            for edge in [[a, b], [b, c], [c, a]] {
                assert!(edges.insert(edge), "two triangles on one side of an edge");
            }
        }
        for &[from, to] in edges.iter().filter(|&&[a, b]| !edges.contains(&[b, a])) {
            let ends = [from, to].map(|end| donut.vertices[end as usize]);
            let at = ends.map(|end| end.at());
            assert!(
                ends.iter().all(|end| end.density == 0.0) || at.into_iter().all(&is_cut),
                "an open edge from {} to {}",
                at[0],
                at[1]
            );
        }
    }

    #[test]
    fn what_is_hidden_goes_and_all_else_is_the_same_field() {
        for (name, caster, depth) in casters() {
            for (elevation, overlap) in
                [(1.0, 1.0), (8.0, 0.25), (8.0, 1.0), (30.0, 6.0), (8.0, 0.0)]
            {
                let mesh = mesh_of(&caster, elevation, 0.0);
                let donut = mesh.without_covered(&caster, overlap).unwrap();
                let overlap = f64::from(overlap);
                let most = overlap * 1.1 + 4e-3;
                check_structure(&donut, |p| (overlap - 1e-4..most).contains(&depth(p)));
                for i in 0..900 {
                    let share = DVec2::new(f64::from(i % 30), f64::from(i / 30)) + 0.5;
                    let point = MIN - 20.0 + (MAX - MIN + 40.0) * share / 30.0;
                    let left = density(&donut, point);
                    if depth(point) < overlap {
                        let all = density(&mesh, point);
                        assert_eq!(left.is_some(), all.is_some(), "{name}: at {point}");
                        let apart = left.unwrap_or(0.0) - all.unwrap_or(0.0);
                        assert!(apart.abs() < 1e-5, "{name}: {apart} at {point}");
                    } else if depth(point) > most {
                        assert!(left.is_none(), "{name}: left at {point}");
                    }
                }
                println!(
                    "{name} at {elevation}, overlap {overlap}: {:.3} of the area, {} triangles of {}",
                    area(&donut) / area(&mesh),
                    donut.indices.len() / 3,
                    mesh.indices.len() / 3
                );
            }
        }
    }

    #[test]
    fn what_goes_is_all_of_the_inset_and_no_more() {
        let caster = Shape::rect(30.0, 20.0, 120.0, 80.0).unwrap();
        for (elevation, overlap) in [(1.0, 0.0), (4.0, 1.0), (20.0, 0.5), (60.0, 20.0)] {
            let mesh = mesh_of(&caster, elevation, 0.0);
            let donut = mesh.without_covered(&caster, overlap).unwrap();
            // As far in as chords would be to stay clear of the overlap.
            let inset = DVec2::splat(f64::from(overlap) / (1.0 - CUT_FLATNESS));
            let (min, max) = (MIN + inset, MAX - inset);
            let inset = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
            let gone: f64 = corners(&mesh)
                .map(|corners| {
                    tangents::tests::area(&intersect_loops(&[corners.to_vec()], &[inset.to_vec()]))
                })
                .sum();
            let expected = area(&mesh) - gone;
            assert!(gone > 1000.0 && (area(&donut) - expected).abs() < 0.05);
        }
    }

    #[test]
    fn far_from_the_origin_nothing_is_torn() {
        // Steps of `f32` are 1 / 128 there: every crossing moves by a visible part of a triangle.
        for (name, caster, depth) in casters() {
            let away = 100_000.0;
            let moved = caster.translated([away; 2]).unwrap();
            let mesh = mesh_of(&moved, 8.0, away);
            for overlap in [0.0, 0.9, 1.0, 1.3, 3.0] {
                let donut = mesh.without_covered(&moved, overlap).unwrap();
                let most = f64::from(overlap) * 1.1 + 0.1;
                check_structure(&donut, |p| {
                    (f64::from(overlap) - 0.05..most).contains(&depth(p - f64::from(away)))
                });
                assert!(area(&donut) < 0.7 * area(&mesh), "{name}");
            }
        }
    }

    #[test]
    fn other_casters_and_wide_overlaps_leave_all() {
        let card = Shape::rounded_rect(30.0, 20.0, 120.0, 80.0, 12.0).unwrap();
        let mesh = mesh_of(&card, 8.0, 0.0);
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

    #[cfg(feature = "raster")]
    #[test]
    fn no_light_shows_between_shadow_and_caster() {
        use crate::grid::Grid;
        use tiny_skia::{Color, FillRule, Paint, PathBuilder, Pixmap, Transform};

        let mut builder = PathBuilder::new();
        builder.move_to(30.3, 20.2);
        builder.line_to(150.1, 35.7);
        builder.line_to(95.4, 61.9);
        builder.quad_to(120.0, 90.0, 70.6, 99.5);
        builder.line_to(45.2, 100.0);
        builder.close();
        let path = builder.finish().unwrap();
        let caster = Shape::path(&Path::from(&path), crate::path::FillRule::NonZero).unwrap();
        let mesh = mesh_of(&caster, 8.0, 0.0);
        let grid = Grid::new([0.0, 0.0], [200, 140], 1.0).unwrap();
        let mut densities = vec![0.0; 200 * 140];
        let mut compose = |mesh: &ShadowMesh| {
            mesh.rasterize(&grid, &mut densities).unwrap();
            let mut pixmap = Pixmap::new(200, 140).unwrap();
            pixmap.fill(Color::WHITE);
            for (pixel, density) in pixmap
                .data_mut()
                .as_chunks_mut::<4>()
                .0
                .iter_mut()
                .zip(&densities)
            {
                pixel[..3].fill((255.0 * (1.0 - density)).round() as u8);
            }
            let mut paint = Paint::default();
            paint.set_color_rgba8(40, 120, 90, 255);
            pixmap.fill_path(
                &path,
                &paint,
                FillRule::Winding,
                Transform::identity(),
                None,
            );
            pixmap.take()
        };
        let donut = mesh.without_covered(&caster, 1.0).unwrap();
        let largest = |a: &[u8], b: &[u8]| a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max();
        let whole = compose(&mesh);
        assert!(largest(&whole, &compose(&donut)) <= Some(1));
        // A caster one and a half pixels larger than what is drawn lets light through: the comparison sees it.
        let wide = [1.03, 0.0, 0.0, 1.03, -2.7, -1.8];
        let gap = mesh
            .without_covered(&caster.transformed(wide).unwrap(), 0.0)
            .unwrap();
        assert!(largest(&whole, &compose(&gap)) > Some(20));
    }
}
