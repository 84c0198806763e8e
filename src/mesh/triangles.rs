//! Triangles that are made and what became of them.

use glam::DVec2;
use thiserror::Error;

use super::MeshBuffers;
use crate::error::MAX_COORDINATE;

/// A vertex: 12 bytes, as a GPU takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct MeshVertex {
    /// x and y in scene units.
    pub position: [f32; 2],
    /// The density there, 0 to 1.
    pub density: f32,
}

impl MeshVertex {
    /// Where it is.
    pub(crate) fn at(&self) -> DVec2 {
        DVec2::from(self.position.map(f64::from))
    }
}

/// Triangles with a density at each vertex, to be interpolated linearly.
#[derive(Debug, Clone, PartialEq)]
pub struct ShadowMesh {
    pub(super) vertices: Vec<MeshVertex>,
    pub(super) indices: Vec<u32>,
    pub(super) error_levels: f64,
    pub(super) incomplete: Option<Incomplete>,
}

impl ShadowMesh {
    /// The vertices. Those on the penumbra's outer edge have density 0.
    #[must_use]
    pub fn vertices(&self) -> &[MeshVertex] {
        &self.vertices
    }

    /// Three indices a triangle, all turning the same way: clockwise where y points down, as on screens,
    /// counter-clockwise where it points up.
    #[must_use]
    pub fn indices(&self) -> &[u32] {
        &self.indices
    }

    /// The triangles, as their three vertices.
    pub fn triangles(&self) -> impl Iterator<Item = [MeshVertex; 3]> {
        self.indices
            .chunks_exact(3)
            .map(|corners| [0, 1, 2].map(|i: usize| self.vertices[corners[i] as usize]))
    }

    /// The largest difference from the exact density, in levels: the largest found by samples in each triangle and on the way
    /// up from them, a few hundredths more for what they may have missed, and what rounding vertices to `f32` and
    /// flattening curves may add. For profiles other than the disc's it holds their own difference too.
    #[must_use]
    pub fn error_levels(&self) -> f64 {
        self.error_levels
    }

    /// Whether the tolerance was reached: before the limit on vertices, and in spite of rounding.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.incomplete.is_none()
    }

    /// What kept the mesh from its tolerance, unless it is complete.
    #[must_use]
    pub fn incomplete(&self) -> Option<Incomplete> {
        self.incomplete
    }

    /// Triangles that were made elsewhere, to be drawn as they are.
    #[cfg(feature = "lab")]
    pub(crate) fn of_triangles(vertices: Vec<MeshVertex>, indices: Vec<u32>) -> Self {
        Self {
            vertices,
            indices,
            ..Self::empty()
        }
    }

    pub(super) fn filled(buffers: MeshBuffers<u32>, quality: MeshQuality) -> Self {
        Self {
            vertices: buffers.vertices,
            indices: buffers.indices,
            error_levels: quality.error_levels,
            incomplete: quality.incomplete,
        }
    }

    /// The same, which may be wrong by all there is.
    pub(super) fn short_of(self, reason: Incomplete) -> Self {
        Self {
            error_levels: 255.0,
            incomplete: Some(reason),
            ..self
        }
    }

    /// Adds the triangles of another mesh that does not meet this one.
    pub(super) fn append(&mut self, other: Self) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(other.vertices);
        self.indices
            .extend(other.indices.into_iter().map(|index| first + index));
        self.error_levels = self.error_levels.max(other.error_levels);
        self.incomplete = self.incomplete.or(other.incomplete);
    }

    pub(super) fn empty() -> Self {
        Self {
            vertices: Vec::new(),
            indices: Vec::new(),
            error_levels: 0.0,
            incomplete: None,
        }
    }
}

/// What keeps a mesh from its tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Incomplete {
    /// The limit on vertices was reached ([`MeshOptions::with_max_vertices`](crate::MeshOptions::with_max_vertices)).
    #[error("it reached the limit on vertices: allow more of them, or a larger tolerance")]
    Vertices,
    /// The penumbra is too narrow for positions in `f32`: everywhere, at large coordinates or under a light next to a point, or in
    /// places, as where a tilted caster touches its receiver.
    #[error(
        "its penumbra is too narrow for positions in single precision, everywhere or where the caster touches its receiver"
    )]
    Narrow,
    /// Vertices were added for as many rounds as there are.
    #[error("it took too many rounds to refine: allow a larger tolerance")]
    Rounds,
    /// The shadow passes [`MAX_COORDINATE`](crate::MAX_COORDINATE), as that of a caster does which reaches the light's plane.
    #[error(
        "the shadow has no end within {MAX_COORDINATE} units: move its caster away from the light"
    )]
    Endless,
    /// An edge of the penumbra could not be triangulated.
    #[error("an edge of its penumbra could not be triangulated")]
    Edges,
}

/// What became of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MeshQuality {
    /// As [`ShadowMesh::error_levels`].
    pub error_levels: f64,
    /// As [`ShadowMesh::incomplete`].
    pub incomplete: Option<Incomplete>,
}

impl MeshQuality {
    pub(super) fn new(error_levels: f64, incomplete: Option<Incomplete>) -> Self {
        Self {
            error_levels,
            incomplete,
        }
    }

    /// As [`ShadowMesh::is_complete`].
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.incomplete.is_none()
    }
}
