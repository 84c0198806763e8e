//! Phong shading: normals interpolated along edges and scan lines, and the illumination once a pixel (Phong 1975).

use glam::DVec3;

use super::{Canvas, Fragment};
use crate::finish::{Lighting, RimMesh};

pub(super) fn draw(mesh: &RimMesh, lighting: &Lighting, canvas: &mut Canvas) {
    for face in mesh.faces() {
        canvas.each(mesh, face, Fragment::corners(mesh, face), |pixel, at| {
            *pixel = Some(lighting.at(at.point.to_array(), normal(&at).to_array()));
        });
    }
}

pub(super) fn normal(at: &Fragment) -> DVec3 {
    at.normal.normalize_or_zero()
}
