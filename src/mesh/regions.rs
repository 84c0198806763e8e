//! Which triangles between the rings are penumbra, and which are umbra or outside.

use spade::handles::{FixedFaceHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

/// The triangulation between the rings: their edges are its constraints.
pub(crate) type Triangles = ConstrainedDelaunayTriangulation<Vertex>;
pub(crate) type Face = FixedFaceHandle<InnerTag>;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Vertex {
    pub(crate) position: Point2<f64>,
    pub(crate) density: f64,
    /// The ring it was made for: 0 is the outer edge.
    pub(crate) ring: Option<usize>,
}

impl HasPosition for Vertex {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

/// On which side of the penumbra's two edges a face lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Region {
    Outside,
    Penumbra,
    Umbra,
}

/// The faces of a region, found by walking in from outside and minding the penumbra's two edges, the
/// rings 0 and `last`.
pub(crate) fn faces(triangles: &Triangles, last: usize, wanted: Region) -> Vec<Face> {
    let mut regions: Vec<Option<Region>> = vec![None; triangles.num_all_faces()];
    let mut open = vec![triangles.outer_face().fix()];
    regions[open[0].index()] = Some(Region::Outside);
    let mut found = Vec::new();
    while let Some(face) = open.pop() {
        let Some(region) = regions[face.index()] else {
            continue;
        };
        let face = triangles.face(face);
        if let Some(inner) = face.as_inner().filter(|_| region == wanted) {
            found.push(inner.fix());
        }
        let edges: Vec<_> = match face.as_inner() {
            Some(inner) => inner.adjacent_edges().to_vec(),
            None => triangles.convex_hull().collect(),
        };
        for edge in edges {
            let next = edge.rev().face().fix();
            if regions[next.index()].is_some() {
                continue;
            }
            let (from, to) = (edge.from().data().ring, edge.to().data().ring);
            let crosses =
                |ring| edge.is_constraint_edge() && from == Some(ring) && to == Some(ring);
            regions[next.index()] = Some(match region {
                Region::Outside if crosses(0) => Region::Penumbra,
                Region::Penumbra if crosses(0) => Region::Outside,
                Region::Penumbra if crosses(last) => Region::Umbra,
                Region::Umbra if crosses(last) => Region::Penumbra,
                same => same,
            });
            open.push(next);
        }
    }
    found.sort_by_key(|face| face.index());
    found
}
