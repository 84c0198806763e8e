//! Where triangles go: buffers of the caller's.

use super::MeshVertex;
use crate::error::{Error, Result};

/// Takes a mesh. Where nothing is to be allocated, it keeps its memory from mesh to mesh.
pub trait MeshSink {
    /// Comes first: so many vertices and triangles at most are to come.
    ///
    /// # Errors
    /// The sink's own, such as [`Error::TooMany`]: then nothing comes.
    fn begin(&mut self, vertices: usize, triangles: usize) -> Result<()>;

    /// The next vertex. The mesh's first has number 0.
    fn vertex(&mut self, vertex: MeshVertex);

    /// A triangle, by its vertices' numbers, all of which have come before.
    fn triangle(&mut self, corners: [u32; 3]);
}

/// What a vertex is counted by: `u16` or `u32`.
pub trait MeshIndex: Copy + private::Sealed {
    /// The largest number.
    const MAX: u32;

    /// The number, which is at most [`MAX`](MeshIndex::MAX).
    fn of(number: u32) -> Self;
}

impl MeshIndex for u16 {
    const MAX: u32 = u16::MAX as u32;

    fn of(number: u32) -> Self {
        number as u16
    }
}

impl MeshIndex for u32 {
    const MAX: u32 = u32::MAX;

    fn of(number: u32) -> Self {
        number
    }
}

mod private {
    pub trait Sealed {}
    impl Sealed for u16 {}
    impl Sealed for u32 {}
}

/// Vertices and indices that meshes are appended to, one after the other: several shadows make one draw call.
///
/// ```
/// use penumbral::{Light, MeshBuffers, Scratch, Shape, Tolerance};
///
/// let light = Light::android(400.0)?;
/// let (mut buffers, mut scratch) = (MeshBuffers::<u16>::new(), Scratch::new());
/// for y in [100.0, 300.0] {
///     let card = Shape::rounded_rect(16.0, y, 300.0, 150.0, 12.0)?;
///     let shadow = light.cast(&card, 8.0, 0.0)?;
///     shadow.mesh_into(&mut buffers, Tolerance::ONE_LEVEL, &mut scratch)?;
/// }
/// assert_eq!(buffers.indices.len() % 3, 0);
/// buffers.clear(); // for the next frame: the memory stays
/// # Ok::<(), penumbral::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MeshBuffers<I> {
    /// The vertices of all meshes.
    pub vertices: Vec<MeshVertex>,
    /// Three a triangle.
    pub indices: Vec<I>,
    first: u32,
}

/// What they hold counts, not what was begun.
impl<I: PartialEq> PartialEq for MeshBuffers<I> {
    fn eq(&self, other: &Self) -> bool {
        self.vertices == other.vertices && self.indices == other.indices
    }
}

impl<I> Default for MeshBuffers<I> {
    fn default() -> Self {
        Self {
            vertices: Vec::new(),
            indices: Vec::new(),
            first: 0,
        }
    }
}

impl<I> MeshBuffers<I> {
    /// Empty ones; they grow as they are used.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Empties them and keeps their memory.
    pub fn clear(&mut self) {
        self.vertices.clear();
        self.indices.clear();
    }
}

impl<I: MeshIndex> MeshSink for MeshBuffers<I> {
    fn begin(&mut self, vertices: usize, triangles: usize) -> Result<()> {
        let first = self.vertices.len();
        self.first = first_index::<I>(first, vertices)?;
        self.vertices.reserve(vertices);
        self.indices.reserve(3 * triangles);
        Ok(())
    }

    fn vertex(&mut self, vertex: MeshVertex) {
        self.vertices.push(vertex);
    }

    fn triangle(&mut self, corners: [u32; 3]) {
        let first = self.first;
        self.indices
            .extend(corners.map(|corner| I::of(first + corner)));
    }
}

/// The number of the first of so many vertices to come, if all of them can be counted.
fn first_index<I: MeshIndex>(first: usize, vertices: usize) -> Result<u32> {
    // As many as there are numbers from 0 to the largest.
    let limit = (I::MAX as usize).saturating_add(1);
    let count = first.saturating_add(vertices);
    if count > limit {
        return Err(Error::TooMany {
            field: "mesh.vertices",
            count,
            limit,
        });
    }
    Ok(first as u32)
}

/// Slices of the caller's, such as mapped GPU memory, filled from their beginnings on, mesh after mesh.
#[derive(Debug)]
pub struct MeshSlices<'a, I> {
    vertices: &'a mut [MeshVertex],
    indices: &'a mut [I],
    /// How many of each are filled.
    filled: [usize; 2],
    first: u32,
}

impl<'a, I> MeshSlices<'a, I> {
    /// Nothing of them is filled yet.
    #[must_use]
    pub fn new(vertices: &'a mut [MeshVertex], indices: &'a mut [I]) -> Self {
        Self {
            vertices,
            indices,
            filled: [0; 2],
            first: 0,
        }
    }

    /// How many vertices and how many indices are filled.
    #[must_use]
    pub fn filled(&self) -> [usize; 2] {
        self.filled
    }
}

impl<I: MeshIndex> MeshSink for MeshSlices<'_, I> {
    fn begin(&mut self, vertices: usize, triangles: usize) -> Result<()> {
        self.first = first_index::<I>(self.filled[0], vertices)?;
        let room = |field, length: usize, filled: usize, more: usize| {
            let needed = filled.saturating_add(more);
            match length < needed {
                true => Err(Error::MeshRoom {
                    field,
                    length,
                    needed,
                }),
                false => Ok(()),
            }
        };
        let [filled_vertices, filled_indices] = self.filled;
        room("vertices", self.vertices.len(), filled_vertices, vertices)?;
        let indices = triangles.saturating_mul(3);
        room("indices", self.indices.len(), filled_indices, indices)
    }

    fn vertex(&mut self, vertex: MeshVertex) {
        self.vertices[self.filled[0]] = vertex;
        self.filled[0] += 1;
    }

    fn triangle(&mut self, corners: [u32; 3]) {
        let [_, filled] = &mut self.filled;
        for corner in corners {
            self.indices[*filled] = I::of(self.first + corner);
            *filled += 1;
        }
    }
}

/// Appends to lyon's buffers, of any vertex that is made from a [`MeshVertex`].
#[cfg(feature = "lyon")]
impl<V: From<MeshVertex>, I: MeshIndex> MeshSink for LyonBuffers<'_, V, I> {
    fn begin(&mut self, vertices: usize, triangles: usize) -> Result<()> {
        self.first = first_index::<I>(self.buffers.vertices.len(), vertices)?;
        self.buffers.vertices.reserve(vertices);
        self.buffers.indices.reserve(3 * triangles);
        Ok(())
    }

    fn vertex(&mut self, vertex: MeshVertex) {
        self.buffers.vertices.push(V::from(vertex));
    }

    fn triangle(&mut self, corners: [u32; 3]) {
        let first = self.first;
        let indices = corners.map(|corner| I::of(first + corner));
        self.buffers.indices.extend(indices);
    }
}

/// lyon's buffers as a sink.
#[cfg(feature = "lyon")]
#[derive(Debug)]
pub struct LyonBuffers<'a, V, I> {
    buffers: &'a mut lyon::tessellation::VertexBuffers<V, I>,
    first: u32,
}

#[cfg(feature = "lyon")]
impl<'a, V, I> LyonBuffers<'a, V, I> {
    /// Meshes are appended to what the buffers hold.
    #[must_use]
    pub fn new(buffers: &'a mut lyon::tessellation::VertexBuffers<V, I>) -> Self {
        Self { buffers, first: 0 }
    }
}
