//! The umbra: large, flat, and filled by lyon.

use std::collections::HashMap;

use glam::DVec2;
use lyon::math::point;
use lyon::path::{EndpointId, Path};
use lyon::tessellation::{
    BuffersBuilder, FillOptions, FillRule, FillTessellator, FillVertex, VertexBuffers,
};

use super::{MeshVertex, ShadowMesh};

/// A vertex of a loop: where it is and its index in the mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct LoopVertex {
    pub(super) position: DVec2,
    pub(super) index: u32,
}

/// Triangles that fill the loops, by their vertices' own indices, appended to the mesh. lyon works in `f32`: a vertex
/// that it finds where lines of the loops cross in that precision is appended with `density`.
pub(super) fn fill(loops: &[Vec<LoopVertex>], density: f32, center: DVec2, mesh: &mut ShadowMesh) {
    let mut builder = Path::builder();
    let mut own: HashMap<EndpointId, u32> = HashMap::new();
    for vertex_loop in loops {
        let Some((first, rest)) = vertex_loop.split_first() else {
            continue;
        };
        let place = |v: &LoopVertex| point(v.position.x as f32, v.position.y as f32);
        own.insert(builder.begin(place(first)), first.index);
        for vertex in rest {
            own.insert(builder.line_to(place(vertex)), vertex.index);
        }
        builder.end(true);
    }
    let path = builder.build();
    let mut buffers: VertexBuffers<(Option<u32>, [f32; 2]), u32> = VertexBuffers::new();
    let mut output = BuffersBuilder::new(&mut buffers, |vertex: FillVertex<'_>| {
        let found = vertex.as_endpoint_id().and_then(|id| own.get(&id).copied());
        (found, vertex.position().to_array())
    });
    let options = FillOptions::default()
        .with_fill_rule(FillRule::NonZero)
        .with_tolerance(1e-6);
    let filled = FillTessellator::new().tessellate_with_ids(
        path.id_iter(),
        &path,
        None,
        &options,
        &mut output,
    );
    if filled.is_err() {
        // The loops are finite and few enough, so lyon has no reason; but a mesh without its umbra must say so.
        mesh.error_levels = 255.0 * f64::from(density);
        mesh.complete = false;
        return;
    }
    let found: Vec<u32> = buffers
        .vertices
        .iter()
        .map(|&(found, position)| {
            found.unwrap_or_else(|| {
                let at = DVec2::from(position.map(f64::from)) + center;
                mesh.vertices.push(MeshVertex {
                    position: at.as_vec2().to_array(),
                    density,
                });
                mesh.vertices.len() as u32 - 1
            })
        })
        .collect();
    for corners in buffers.indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|i: usize| found[corners[i] as usize]);
        let [a, b, c] =
            corners.map(|i| DVec2::from(mesh.vertices[i as usize].position.map(f64::from)));
        let turn = (b - a).perp_dot(c - a);
        if turn > 0.0 {
            mesh.indices.extend(corners);
        } else if turn < 0.0 {
            mesh.indices.extend([corners[0], corners[2], corners[1]]);
        }
    }
}

/// A mesh of nothing but an umbra.
pub(super) fn mesh(loops: &[Vec<DVec2>], center: DVec2) -> ShadowMesh {
    let mut mesh = ShadowMesh::empty();
    let mut index = 0;
    let loops: Vec<Vec<LoopVertex>> = loops
        .iter()
        .map(|points| {
            points
                .iter()
                .map(|&position| {
                    mesh.vertices.push(MeshVertex {
                        position: (position + center).as_vec2().to_array(),
                        density: 1.0,
                    });
                    index += 1;
                    LoopVertex {
                        position,
                        index: index - 1,
                    }
                })
                .collect()
        })
        .collect();
    fill(&loops, 1.0, center, &mut mesh);
    mesh
}
