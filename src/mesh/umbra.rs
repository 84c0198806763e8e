//! A shadow that is all umbra: flat, and filled by lyon.

use std::collections::HashMap;

use glam::DVec2;
use lyon::math::point;
use lyon::path::{EndpointId, Path};
use lyon::tessellation::{
    BuffersBuilder, FillOptions, FillRule, FillTessellator, FillVertex, VertexBuffers,
};

use super::settle::settle;
use super::{Incomplete, MeshVertex, ShadowMesh};

/// A vertex of a loop: where it is and its index in the mesh.
#[derive(Debug, Clone, Copy)]
struct LoopVertex {
    position: DVec2,
    index: u32,
}

/// Triangles that fill the loops, by their vertices' own indices. lyon works in `f32`: for a vertex that it finds where
/// lines of the loops cross in that precision `extra` gives an index. Should lyon fail, there are none.
fn fill(
    loops: &[Vec<LoopVertex>],
    mut extra: impl FnMut([f32; 2]) -> u32,
) -> Option<Vec<[u32; 3]>> {
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
    FillTessellator::new()
        .tessellate_with_ids(path.id_iter(), &path, None, &options, &mut output)
        .ok()?;
    let found: Vec<u32> = buffers
        .vertices
        .iter()
        .map(|&(found, position)| found.unwrap_or_else(|| extra(position)))
        .collect();
    // All of lyon's triangles turn the same way: together they tell which, where one without area cannot.
    let triangles = buffers.indices.chunks_exact(3);
    let turn = |corners: &[u32]| {
        let at = |i: usize| DVec2::from(buffers.vertices[corners[i] as usize].1.map(f64::from));
        (at(1) - at(0)).perp_dot(at(2) - at(0))
    };
    let order = if triangles.clone().map(turn).sum::<f64>() < 0.0 {
        [0, 2, 1]
    } else {
        [0, 1, 2]
    };
    Some(
        triangles
            .map(|corners| order.map(|i: usize| found[corners[i] as usize]))
            .collect(),
    )
}

/// A mesh of nothing but an umbra.
pub(super) fn mesh(loops: &[Vec<DVec2>], center: DVec2) -> ShadowMesh {
    let mut mesh = ShadowMesh::empty();
    let mut add = |position: DVec2| {
        mesh.vertices.push(MeshVertex {
            position: (position + center).as_vec2().to_array(),
            density: 1.0,
        });
        mesh.vertices.len() as u32 - 1
    };
    let loops: Vec<Vec<LoopVertex>> = loops
        .iter()
        .map(|points| {
            let vertex = |&position: &DVec2| LoopVertex {
                position,
                index: add(position),
            };
            points.iter().map(vertex).collect()
        })
        .collect();
    match fill(&loops, |position| add(DVec2::from(position.map(f64::from)))) {
        Some(triangles) => {
            mesh.indices = settle(&mesh.vertices, triangles);
            mesh
        }
        // The loops are finite and few enough, so lyon has no reason; but a mesh without its umbra must say so.
        None => mesh.short_of(Incomplete::Edges),
    }
}
