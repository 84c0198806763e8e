//! Meshes as text: Wavefront OBJ and SVG.

use core::fmt::Write;

use glam::DVec2;

use super::{MeshVertex, ShadowMesh};
use crate::apart::{around, around_points};
use crate::error::{self, Result};
use crate::grid::{LEAST_SCALE, MOST_SCALE};
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

/// Meshes as one SVG picture of so many pixels a scene unit, black with the densities as opacity. Each triangle is filled by the linear
/// gradient that equals its interpolation.
///
/// # Errors
/// A `scale` not from 1/1024 to 1024.
pub fn meshes_to_svg<'a>(
    meshes: impl IntoIterator<Item = &'a ShadowMesh>,
    scale: f32,
) -> Result<String> {
    let scale = error::within("scale", f64::from(scale), LEAST_SCALE, MOST_SCALE)?;
    let mut svg = Svg::new(scale);
    let mut boxes = Vec::new();
    for mesh in meshes {
        svg.draw("<g shape-rendering=\"crispEdges\">");
        svg.draw_mesh(mesh, 1.0, Color::BLACK);
        svg.draw("</g>");
        boxes.extend(around_points(mesh.vertices.iter().map(MeshVertex::at)));
    }
    let (min, max) = around(boxes).unwrap_or((DVec2::ZERO, DVec2::ONE));
    let (min, max) = ((min * scale).floor(), (max * scale).ceil());
    let size = max - min;
    Ok(svg.finish(size.to_array(), min / scale, size / scale))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use crate::shape::Shape;
    use crate::tolerance::Tolerance;

    /// A card that is a unit wide is the picture that the same card is in pixels.
    #[test]
    fn triangles_of_any_unit_are_drawn_in_pixels() {
        let count = |unit: f32| {
            let light = Light::directional([0.0, 0.0], 1.0).unwrap();
            let card = Shape::rounded_rect(unit, unit, 60.0 * unit, 40.0 * unit, 6.0 * unit);
            let shadow = light.cast(&card.unwrap(), 8.0 * unit, 0.0).unwrap();
            let mesh = shadow.mesh(Tolerance::ONE_LEVEL);
            let text = meshes_to_svg([&mesh], 1.0 / unit).unwrap();
            assert!(
                text.contains("width=\"76\" height=\"56\""),
                "{unit}: {text}"
            );
            (text.matches("<path").count(), mesh.triangles().count())
        };
        for unit in [1.0, 1.0 / 64.0, 16.0] {
            let (drawn, made) = count(unit);
            assert!(drawn > made / 2, "{unit}: {drawn} of {made}");
        }
        assert!(meshes_to_svg([], 0.0).is_err());
    }
}
