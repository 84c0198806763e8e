//! Meshes as text: Wavefront OBJ and SVG.

use core::fmt::Write;

use glam::DVec2;

use super::{MeshVertex, ShadowMesh};
use crate::apart::{around, around_points};
use crate::svg::Svg;
use crate::tone::Color;

impl ShadowMesh {
    /// The mesh as Wavefront OBJ: a vertex has its density as z, so that a viewer shows it as a relief, all in the fewest digits that are
    /// read back as they were; the group is named `name`. `first` is the number of vertices before it in the same file.
    #[must_use]
    pub fn to_obj(&self, name: &str, first: usize) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "o {}", name.replace(char::is_whitespace, "_"));
        for vertex in &self.vertices {
            let MeshVertex {
                position: [x, y],
                density,
            } = vertex;
            let _ = writeln!(text, "v {x} {y} {density}");
        }
        for corners in self.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i: usize| corners[i] as usize + first + 1);
            let _ = writeln!(text, "f {a} {b} {c}");
        }
        text
    }
}

/// Meshes as one SVG picture, one pixel a unit, black with the densities as opacity. Each triangle is filled by the linear
/// gradient that equals its interpolation.
#[must_use]
pub fn meshes_to_svg<'a>(meshes: impl IntoIterator<Item = &'a ShadowMesh>) -> String {
    let mut svg = Svg::new(1.0);
    let mut boxes = Vec::new();
    for mesh in meshes {
        svg.draw("<g shape-rendering=\"crispEdges\">");
        svg.draw_mesh(mesh, 1.0, Color::BLACK);
        svg.draw("</g>");
        boxes.extend(around_points(mesh.vertices.iter().map(MeshVertex::at)));
    }
    let (min, max) = around(boxes).unwrap_or((DVec2::ZERO, DVec2::ONE));
    let (min, max) = (min.floor(), max.ceil());
    svg.finish((max - min).to_array(), min, max - min)
}
