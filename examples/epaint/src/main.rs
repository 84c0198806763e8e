//! Shadows into an `epaint::Mesh`, as egui draws it: the vertices are epaint's own from the start, nothing is copied.

use anyhow::{Result, ensure};
use epaint::{Color32, Mesh, Vertex, WHITE_UV, pos2};
use penumbral::{Error, FillRule, Light, MeshSink, MeshVertex, Scratch, Shadow, Shape, Tolerance};

/// Appends triangles to a mesh, in black of this strength.
struct Ink<'a> {
    mesh: &'a mut Mesh,
    strength: f32,
    first: u32,
}

impl MeshSink for Ink<'_> {
    fn begin(&mut self, vertices: usize, triangles: usize) -> penumbral::Result<()> {
        let first = self.mesh.vertices.len();
        let count = first.saturating_add(vertices);
        self.first = u32::try_from(first).map_err(|_| Error::TooMany {
            field: "mesh.vertices",
            count,
            limit: u32::MAX as usize,
        })?;
        self.mesh.reserve_vertices(vertices);
        self.mesh.reserve_triangles(triangles);
        Ok(())
    }

    fn vertex(&mut self, vertex: MeshVertex) {
        let [x, y] = vertex.position;
        // Black stays black when it is multiplied by its alpha.
        let alpha = (vertex.density * self.strength * 255.0).round() as u8;
        self.mesh.vertices.push(Vertex {
            pos: pos2(x, y),
            uv: WHITE_UV,
            color: Color32::from_black_alpha(alpha),
        });
    }

    fn triangle(&mut self, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|corner| self.first + corner);
        self.mesh.add_triangle(a, b, c);
    }
}

fn shadows() -> Result<[Shadow; 2]> {
    let light = Light::android(400.0)?;
    let card = Shape::rounded_rect(16.0, 40.0, 160.0, 120.0, 12.0)?;
    let star: Vec<[f32; 2]> = (0_u8..10)
        .map(|i| {
            let (sin, cos) = (f32::from(i) * core::f32::consts::PI / 5.0).sin_cos();
            let radius = if i % 2 == 0 { 60.0 } else { 25.0 };
            [280.0 + radius * sin, 100.0 - radius * cos]
        })
        .collect();
    let star = Shape::polygon(&[star], FillRule::NonZero)?;
    Ok([light.cast(&card, 8.0, 0.0)?, light.cast(&star, 3.0, 0.0)?])
}

fn main() -> Result<()> {
    const STRENGTH: f32 = 0.19;
    let (mut mesh, mut scratch) = (Mesh::default(), Scratch::new());
    let mut triangles = 0;
    for shadow in shadows()? {
        let mut ink = Ink {
            mesh: &mut mesh,
            strength: STRENGTH,
            first: 0,
        };
        let quality = shadow.mesh_into(&mut ink, Tolerance::ONE_LEVEL, &mut scratch)?;
        ensure!(
            quality.is_complete(),
            "a mesh is {} levels off",
            quality.error_levels
        );
        triangles += shadow.mesh(Tolerance::ONE_LEVEL).indices().len() / 3;
    }
    ensure!(mesh.is_valid(), "an index has no vertex");
    ensure!(
        mesh.indices.len() == 3 * triangles,
        "{} indices",
        mesh.indices.len()
    );
    let darkest = mesh.vertices.iter().map(|vertex| vertex.color.a()).max();
    ensure!(
        darkest == Some((STRENGTH * 255.0).round() as u8),
        "{darkest:?}"
    );
    println!(
        "{} vertices, {triangles} triangles, in {:?}",
        mesh.vertices.len(),
        mesh.calc_bounds()
    );
    Ok(())
}
