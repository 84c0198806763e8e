//! Where triangles go.

use penumbral::{Error, MeshBuffers, MeshSink, MeshSlices, MeshVertex, Scratch};

use crate::checks::*;

#[test]
fn sinks_take_what_they_have_room_for() {
    assert_eq!(size_of::<MeshVertex>(), 12);
    let shadow = android_card(8.0);
    let (mesh, mut scratch) = (shadow.mesh(levels(4.0)), Scratch::new());
    let count = [mesh.vertices().len(), mesh.indices().len()];
    let mut into = |sink: &mut MeshBuffers<u16>| shadow.mesh_into(sink, levels(4.0), &mut scratch);
    let mut buffers = MeshBuffers::new();
    let quality = into(&mut buffers).unwrap();
    assert_eq!(
        (quality.error_levels, quality.is_complete()),
        (mesh.error_levels(), true)
    );
    // The second one counts on from the first.
    into(&mut buffers).unwrap();
    assert_eq!(
        [buffers.vertices.len(), buffers.indices.len()],
        count.map(|n| 2 * n)
    );
    let (first, second) = buffers.indices.split_at(count[1]);
    assert!(
        first
            .iter()
            .zip(second)
            .all(|(a, b)| usize::from(*b) == usize::from(*a) + count[0])
    );
    // Sixteen bits are enough for so many, and nothing is written of one too many.
    while buffers.vertices.len() + count[0] <= 1 << 16 {
        into(&mut buffers).unwrap();
    }
    let before = buffers.clone().vertices;
    assert!(matches!(into(&mut buffers), Err(Error::TooMany { .. })));
    assert_eq!(buffers.vertices, before);
    buffers.clear();
    assert_eq!(buffers, MeshBuffers::new());

    let mut vertices = vec![before[0]; count[0]];
    let mut indices = vec![0_u32; count[1] - 1];
    let mut slices = MeshSlices::new(&mut vertices, &mut indices);
    let refused = shadow.mesh_into(&mut slices, levels(4.0), &mut scratch);
    let (needed, length) = (count[1], count[1] - 1);
    let field = "indices";
    assert_eq!(
        refused,
        Err(Error::MeshRoom {
            field,
            length,
            needed
        })
    );
    assert_eq!(slices.filled(), [0, 0]);
    indices.push(0);
    let mut slices = MeshSlices::new(&mut vertices, &mut indices);
    shadow
        .mesh_into(&mut slices, levels(4.0), &mut scratch)
        .unwrap();
    assert_eq!(slices.filled(), count);
    assert_eq!(
        (vertices.as_slice(), indices.as_slice()),
        (mesh.vertices(), mesh.indices())
    );
}

/// The default limit on a mesh's vertices is one that sixteen bits count.
#[test]
fn sixteen_bits_count_65536_vertices() {
    let mut buffers = MeshBuffers::<u16>::new();
    assert!(matches!(
        buffers.begin(65_537, 0),
        Err(Error::TooMany {
            count: 65_537,
            limit: 65_536,
            ..
        })
    ));
    let vertex = MeshVertex {
        position: [0.0; 2],
        density: 0.0,
    };
    buffers.begin(65_536, 1).unwrap();
    (0..65_536).for_each(|_| buffers.vertex(vertex));
    buffers.triangle([0, 1, 65_535]);
    assert_eq!(buffers.indices, [0, 1, u16::MAX]);
    assert!(buffers.begin(1, 0).is_err());
}

#[cfg(feature = "lyon")]
#[test]
fn lyons_buffers_take_meshes() {
    use penumbral::LyonBuffers;
    let shadow = android_card(8.0);
    let mut buffers = lyon::tessellation::VertexBuffers::<MeshVertex, u16>::new();
    let mut sink = LyonBuffers::new(&mut buffers);
    shadow
        .mesh_into(&mut sink, levels(4.0), &mut Scratch::new())
        .unwrap();
    assert_eq!(buffers.vertices, shadow.mesh(levels(4.0)).vertices());
}
