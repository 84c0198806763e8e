//! Flat shading: the illumination once a face.

use glam::DVec3;

use super::Canvas;
use crate::finish::{Lighting, RimMesh};

pub(super) fn draw(mesh: &RimMesh, lighting: &Lighting, canvas: &mut Canvas) {
    for face in mesh.faces() {
        let corners = face
            .vertices
            .map(|i| DVec3::from(mesh.vertices()[i].position));
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let intensity = lighting.at(middle.to_array(), face.normal);
        canvas.each(mesh, face, [0.0; 3], |pixel, _| *pixel = Some(intensity));
    }
}
