//! Triangles over which linear interpolation of density stays within a tolerance.
//!
//! Rounded rectangles and circles are strips between rings, which need no triangulator, and so are [gentle convex
//! curves](gentle). Outlines of small detail, such as
//! icons, are [halved squares](halving), and so is whatever is to be there [quickly](MeshOptions::quick). For all other outlines,
//! and where nothing of that was found, the tangent construction gives the skeleton: rings from the penumbra's outer edge to the
//! umbra, at the distances that suit the profile best. Between them and inside of the umbra a constrained Delaunay triangulation
//! (spade); where the result is still wrong, as at corners and where there is no umbra, vertices are added until it is not, and then
//! those are taken away that it does without. Shadows without a penumbra are filled by lyon.
//!
//! The tangent construction follows US 9,639,976; quick meshes, pixels ([`Shadow::fill_a8`]) and point queries do not use it.

mod cache;
mod cells;
mod compact;
mod donut;
mod export;
mod field;
mod gentle;
mod gouraud;
pub(crate) mod halving;
mod lighten;
mod measure;
mod options;
mod profile;
mod refine;
pub(crate) mod regions;
mod rounding;
mod samples;
mod search;
mod settle;
mod sink;
mod skeleton;
pub(crate) mod strips;
pub(crate) mod tangents;
mod thin;
mod tilted;
mod triangles;
mod umbra;
mod umbra_bounds;

pub use cache::{CachedMesh, MeshCache};
pub use compact::{CompactMesh, CompactVertex};
pub use export::meshes_to_svg;
use options::Effort;
pub use options::MeshOptions;
pub use profile::Profile;
#[cfg(feature = "lyon")]
pub use sink::LyonBuffers;
pub use sink::{MeshBuffers, MeshIndex, MeshSink, MeshSlices};
pub use triangles::{Incomplete, MeshQuality, MeshVertex, ShadowMesh};

use crate::error::Result;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

impl Shadow {
    /// Triangles with a density at each vertex, within the tolerance of the exact density wherever they are interpolated
    /// and outside of them, unless the mesh says that it is not [complete](ShadowMesh::is_complete). With penumbra radius 0
    /// they fill the outline, with chords within 1e-5 of its extent, and the error is that of no penumbra: none.
    ///
    /// The density is that of points, no average over pixels: where a penumbra is narrower than some 3 pixels a GPU needs several samples
    /// a pixel for edges that are not jagged.
    ///
    /// ```
    /// use penumbral::{Light, Shape, Tolerance};
    ///
    /// let card = Shape::rounded_rect(16.0, 100.0, 300.0, 200.0, 12.0)?;
    /// let shadow = Light::android(400.0)?.cast(&card, 8.0, 0.0)?;
    /// let mesh = shadow.mesh(Tolerance::levels(4.0)?);
    /// assert!(mesh.error_levels() <= 4.0);
    /// # Ok::<(), penumbral::Error>(())
    /// ```
    #[must_use]
    pub fn mesh(&self, options: impl Into<MeshOptions>) -> ShadowMesh {
        self.mesh_with(&options.into(), &mut Scratch::new())
    }

    /// The mesh, with the corners that a scratch keeps.
    fn mesh_with(&self, options: &MeshOptions, scratch: &mut Scratch) -> ShadowMesh {
        let mut buffers = MeshBuffers::new();
        match self.patterned(options, scratch, &mut buffers) {
            Ok(Some(quality)) => ShadowMesh::filled(buffers, quality),
            _ => self.unpatterned(options, scratch),
        }
    }

    /// The mesh by triangulation; of parts that do not meet one mesh after another: each is what suits it, however many there are.
    fn unpatterned(&self, options: &MeshOptions, scratch: &mut Scratch) -> ShadowMesh {
        if self.apart().is_empty() {
            return self.triangulated(options);
        }
        let mut all = ShadowMesh::empty();
        let mut options = *options;
        for part in self.apart() {
            let mesh = part.mesh_with(&options, scratch);
            options.max_vertices = options.max_vertices.saturating_sub(mesh.vertices.len());
            all.append(mesh);
        }
        all
    }

    /// Gives the triangles of [`Shadow::mesh`] to a sink.
    ///
    /// Nothing is allocated once `scratch` and the sink have grown, for rounded rectangles and circles wherever they are,
    /// whatever the lengths between corners that do not feel each other and while these stay about as round over the penumbra
    /// radius, and for other shadows that stay as and where they are: of these it keeps the last sixteen. Where more of them come
    /// again, or move, a [`MeshCache`] keeps them.
    ///
    /// # Errors
    /// What the sink refuses, before it is given anything.
    pub fn mesh_into(
        &self,
        sink: &mut impl MeshSink,
        options: impl Into<MeshOptions>,
        scratch: &mut Scratch,
    ) -> Result<MeshQuality> {
        let options = options.into();
        if let Some(quality) = self.patterned(&options, scratch, sink)? {
            return Ok(quality);
        }
        let mesh = scratch.meshes.same(self, &options, || {
            self.unpatterned(&options, &mut Scratch::new())
        });
        sink.begin(mesh.vertices.len(), mesh.indices.len() / 3)?;
        for &vertex in &mesh.vertices {
            sink.vertex(vertex);
        }
        for &corners in mesh.indices.as_chunks().0 {
            sink.triangle(corners);
        }
        Ok(MeshQuality::new(mesh.error_levels, mesh.incomplete))
    }

    /// The mesh without a triangulation, if the shadow is one of those that do without: not of several parts, each of which may be.
    fn patterned(
        &self,
        options: &MeshOptions,
        scratch: &mut Scratch,
        sink: &mut impl MeshSink,
    ) -> Result<Option<MeshQuality>> {
        if !self.apart().is_empty() {
            return Ok(None);
        }
        match options.effort {
            Effort::Few => Ok(None),
            Effort::Quick => match halving::mesh(self, options, scratch, sink)? {
                None => self.strips(options, scratch, sink),
                found => Ok(found),
            },
            Effort::Usual => match self.strips(options, scratch, sink)? {
                None => halving::mesh(self, options, scratch, sink),
                found => Ok(found),
            },
        }
    }

    /// The mesh by triangulation, or in strips along a gentle curve; of whichever has fewer triangles where few are asked for.
    fn triangulated(&self, options: &MeshOptions) -> ShadowMesh {
        let gentle = self.gentle(options);
        if options.effort != Effort::Few {
            return gentle.unwrap_or_else(|| self.refined(options));
        }
        let mut strips = MeshBuffers::new();
        let strips = match self.strips(options, &mut Scratch::new(), &mut strips) {
            Ok(Some(quality)) => Some(ShadowMesh::filled(strips, quality)),
            _ => None,
        };
        let refined = self.refined(options);
        let all = gentle.into_iter().chain(strips).chain([refined]);
        let size = |mesh: &ShadowMesh| (!mesh.is_complete(), mesh.indices.len());
        all.min_by_key(size).unwrap_or_else(ShadowMesh::empty)
    }
}
