//! Gouraud shading: intensities interpolated along edges and scan lines (Gouraud 1971).

use glam::DVec2;

use super::Canvas;
use crate::finish::{Intensity, Lighting, RimMesh};

pub(super) fn draw(mesh: &RimMesh, lighting: &Lighting, canvas: &mut Canvas) {
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
