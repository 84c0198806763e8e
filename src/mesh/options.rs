//! How a mesh is made: how near, how large, in what time.

use super::Profile;
use crate::tolerance::Tolerance;

/// How a mesh is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshOptions {
    pub(super) tolerance: Tolerance,
    pub(super) profile: Profile,
    pub(super) max_vertices: usize,
    pub(super) effort: Effort,
}

/// How long making a mesh may take, for how few triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Effort {
    /// Strips about rounded rectangles and along gentle curves, halving for outlines of small detail, refinement for all others.
    Usual,
    Quick,
    Few,
}

impl MeshOptions {
    /// Within `tolerance` of the exact density, with at most 65,536 vertices, or as many as the outline's own corners need.
    #[must_use]
    pub fn new(tolerance: Tolerance) -> Self {
        Self {
            tolerance,
            profile: Profile::Disc,
            max_vertices: 1 << 16,
            effort: Effort::Usual,
        }
    }

    /// With another profile: the tolerance then holds against that profile's densities.
    #[must_use]
    pub fn with_profile(mut self, profile: Profile) -> Self {
        self.profile = profile;
        self
    }

    /// With another limit on vertices, or as many as the outline's own corners need. A mesh that is kept from its tolerance by that is not
    /// [complete](crate::ShadowMesh::is_complete).
    #[must_use]
    pub fn with_max_vertices(mut self, max_vertices: usize) -> Self {
        self.max_vertices = max_vertices;
        self
    }

    /// With a mesh that is made as soon as may be, of up to ten times the triangles: for shadows that change in every frame,
    /// such as a card's that rises. Otherwise time is only saved where a mesh of [few](Self::few) triangles
    /// would take more than a hundred times as long, as it does for icons under a wide penumbra, for a sixth to a quarter of them.
    ///
    /// ```
    /// use penumbral::{FillRule, Light, MeshOptions, Path, Shape, Tolerance};
    ///
    /// let mut path = Path::new();
    /// path.move_to([0.0, 0.0]).line_to([300.0, 0.0]).line_to([150.0, 90.0]).close();
    /// let flag = Shape::path(&path, FillRule::NonZero)?;
    /// let shadow = Light::android(400.0)?.cast(&flag, 16.0, 0.0)?;
    /// let options = MeshOptions::new(Tolerance::ONE_LEVEL);
    /// let [few, soon] = [options.few(), options.quick()].map(|options| shadow.mesh(options));
    /// assert!(few.indices().len() < soon.indices().len());
    /// assert!(soon.error_levels() <= 1.0);
    /// # Ok::<(), penumbral::Error>(())
    /// ```
    #[must_use]
    pub fn quick(mut self) -> Self {
        self.effort = Effort::Quick;
        self
    }

    /// With a mesh of as few triangles as are found, however small the outline's detail: for shadows that are made once and kept. One takes
    /// from tens of milliseconds to some seconds.
    #[must_use]
    pub fn few(mut self) -> Self {
        self.effort = Effort::Few;
        self
    }
}

impl From<Tolerance> for MeshOptions {
    fn from(tolerance: Tolerance) -> Self {
        Self::new(tolerance)
    }
}
