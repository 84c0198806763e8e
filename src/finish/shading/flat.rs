//! Flat shading: the illumination once a face.

use glam::DVec3;

use super::{Canvas, Shading};
use crate::finish::{Lighting, RimMesh};

/// Flat shading: each face has the intensity of its middle. Curved surfaces look faceted.
#[derive(Debug, Clone, Copy)]
pub struct Flat;

impl Shading for Flat {
    fn name(&self) -> &'static str {
        "flat"
    }

    fn draw(&self, mesh: &RimMesh, lighting: &Lighting, canvas: &mut Canvas) {
        for face in mesh.faces() {
            let corners = face
                .vertices
                .map(|i| DVec3::from(mesh.vertices()[i].position));
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            let intensity = lighting.at(middle.to_array(), face.normal);
            canvas.each(mesh, face, [0.0; 3], |pixel, _| *pixel = Some(intensity));
        }
    }
}
