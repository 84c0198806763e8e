//! Triangles that are made and what became of them.

use glam::DVec2;

use super::MeshBuffers;

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
    pub(super) complete: bool,
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
        self.complete
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
            complete: quality.complete,
        }
    }

    pub(super) fn empty() -> Self {
        Self {
            vertices: Vec::new(),
            indices: Vec::new(),
            error_levels: 0.0,
            complete: true,
        }
    }
}

/// What became of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MeshQuality {
    /// As [`ShadowMesh::error_levels`].
    pub error_levels: f64,
    /// As [`ShadowMesh::is_complete`].
    pub complete: bool,
}
