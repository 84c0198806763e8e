//! Gouraud shading: intensities interpolated along edges and scan lines (Gouraud 1971).

use glam::DVec2;

use super::{Canvas, Shading};
use crate::finish::{Intensity, Lighting, RimMesh};

/// Gouraud shading: the illumination once a vertex. It cannot find a highlight inside of a face, and where intensity bends at an
/// edge the eye sees a band (Mach 1865).
#[derive(Debug, Clone, Copy)]
pub struct Gouraud;

impl Shading for Gouraud {
    fn name(&self) -> &'static str {
        "gouraud"
    }

    fn draw(&self, mesh: &RimMesh, lighting: &Lighting, canvas: &mut Canvas) {
        let vertices = mesh.vertices().iter();
        let intensities: Vec<DVec2> = vertices
            .map(|vertex| DVec2::from(lighting.intensity(vertex.position, vertex.normal)))
            .collect();
        for face in mesh.faces() {
            let corners = face.vertices.map(|index| intensities[index]);
            canvas.each(mesh, face, corners, |pixel, at| {
                *pixel = Some(Intensity::new((at.x, at.y)));
            });
        }
    }
}
