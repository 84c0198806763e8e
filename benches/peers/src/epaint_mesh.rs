//! epaint: the mesh of a `RectShape` with blur, which egui's shadows are, for rounded rectangles and circles.
//!
//! It gives a mesh to be drawn by a GPU; here the scan conversion of `triangles.rs` draws it, and most of the time is
//! that. Tessellation is part of every drawing, as it is of every frame of egui's.

use anyhow::Result;
use epaint::emath::pos2;
use epaint::{
    Color32, CornerRadius, Mesh, Rect, RectShape, TessellationOptions, Tessellator, Vertex,
};
use vello_cpu::kurbo::RoundedRect;

use crate::peer::{Draw, Peer};
use crate::scene::{Caster, Scene};
use crate::triangles::{Corner, Triangles};

pub(crate) struct ShadowMesh;

impl Peer for ShadowMesh {
    fn name(&self) -> &'static str {
        "epaint shadow mesh"
    }

    fn prepare<'a>(&self, scene: &'a Scene) -> Result<Option<Draw<'a>>> {
        let shape = |caster: &Caster| {
            let alpha = (caster.opacity * 255.0).round() as u8;
            Some(shadow(caster.rounded?, alpha, caster.radius))
        };
        let Some(shapes) = scene.casters.iter().map(shape).collect::<Option<Vec<_>>>() else {
            return Ok(None);
        };
        let mut tessellator = tessellator();
        let mut mesh = Mesh::default();
        let mut triangles = Triangles::new(scene.width, scene.height);
        Ok(Some(Box::new(move |canvas| {
            mesh.clear();
            for shape in &shapes {
                tessellator.tessellate_rect(shape, &mut mesh);
            }
            for corners in mesh.indices.as_chunks::<3>().0 {
                triangles.fill(corners.map(|i| corner(&mesh.vertices[i as usize])), canvas);
            }
            Ok(())
        })))
    }
}

fn tessellator() -> Tessellator {
    let options = TessellationOptions {
        round_rects_to_pixels: false,
        ..TessellationOptions::default()
    };
    Tessellator::new(1.0, options, [1, 1], Vec::new())
}

/// Its blur is as wide as the penumbra; its corner radii are whole pixels, up to 255.
fn shadow(rounded: RoundedRect, alpha: u8, penumbra: f64) -> RectShape {
    let bounds = rounded.rect();
    let rect = Rect::from_min_max(
        pos2(bounds.x0 as f32, bounds.y0 as f32),
        pos2(bounds.x1 as f32, bounds.y1 as f32),
    );
    let (radii, whole) = (rounded.radii(), |radius: f64| radius.round() as u8);
    let corners = CornerRadius {
        nw: whole(radii.top_left),
        ne: whole(radii.top_right),
        se: whole(radii.bottom_right),
        sw: whole(radii.bottom_left),
    };
    RectShape::filled(rect, corners, Color32::from_black_alpha(alpha))
        .with_blur_width(2.0 * penumbra as f32)
}

fn corner(vertex: &Vertex) -> Corner {
    Corner {
        x: vertex.pos.x,
        y: vertex.pos.y,
        alpha: f32::from(vertex.color.a()),
    }
}
