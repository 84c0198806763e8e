//! Curvature-driven shading: each pixel's normal is the face's where the surface has a crease, and the vertices' where it is round
//! (Anderson, US 2016/0049001).

use glam::DVec3;

use super::{Canvas, Fragment};
use crate::finish::{Lighting, RimFace, RimMesh};

/// How soon the face's normal takes over beside a crease, where a vertex' normal is a mean over the crease: it is so wrong there
/// by up to half of the crease's angle, of which x (1 - x)^7, at most 1/17, is left over all factors x.
const TAKEOVER: i32 = 7;

pub(super) fn draw(mesh: &RimMesh, lighting: &Lighting, canvas: &mut Canvas) {
    for face in mesh.faces() {
        canvas.each(mesh, face, Fragment::corners(mesh, face), |pixel, at| {
            let normal = normal(&at, face);
            *pixel = Some(lighting.at(at.point.to_array(), normal.to_array()));
        });
    }
}

pub(super) fn normal(at: &Fragment, face: &RimFace) -> DVec3 {
    let round = at.normal.normalize_or_zero();
    // Powers of whole numbers are the platform's own: this one is a product.
    let rest = (1.0 - at.curvature).clamp(0.0, 1.0);
    let mut share = 1.0;
    for _ in 0..TAKEOVER {
        share *= rest;
    }
    let flat = DVec3::from(face.normal);
    (flat + (round - flat) * share).normalize_or_zero()
}
