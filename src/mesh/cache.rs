//! Meshes kept by what they depend on: shape, penumbra radius and scale, but not place.

mod key;

use core::num::NonZeroUsize;

use glam::DVec2;

use self::key::{ALIKE_SHARE, step, write_key};
use super::strips::StripScratch;
use super::{MeshOptions, ShadowMesh};
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// The meshes last used, at most a fixed number of them. A shadow that was moved finds the mesh that it had before.
///
/// Shadows are taken for the same where their outlines, wherever they are, differ by so little that a tenth of the tolerance
/// covers it; with penumbra radius 0, and for other [profiles](crate::Profile) than the disc's, where they do not differ at all.
/// A shadow whose numbers are rounded differently elsewhere may be made anew, never drawn wrong.
///
/// The mesh of a rounded rectangle whose ends do not feel each other across the penumbra is four corners and straight strips
/// between them. The last 64 such sets of corners are kept as well, whatever the lengths between them, so that a card, a row
/// or a pill of a new size takes microseconds where its corners are known; equal corners serve all radii near their own, over the
/// penumbra's. The mesh is the same either way.
///
/// ```
/// use core::num::NonZeroUsize;
/// use penumbral::{Light, MeshCache, Shape, Tolerance};
///
/// let mut cache = MeshCache::new(NonZeroUsize::new(64).unwrap());
/// let light = Light::android(400.0)?;
/// for scroll in [0.0, 8.0, 64.5] {
///     let card = Shape::rounded_rect(16.0, 100.0 + scroll, 300.0, 200.0, 12.0)?;
///     let shadow = light.cast(&card, 8.0, 0.0)?;
///     let kept = cache.mesh(&shadow, Tolerance::ONE_LEVEL);
///     assert!(kept.mesh.error_levels() <= 1.0);
///     // Given to a GPU once for each `id`, drawn with `offset` added to each vertex.
///     assert_eq!(kept.id, 1);
///     assert!(kept.offset[1] > f64::from(100.0 + scroll));
/// }
/// assert_eq!((cache.hits(), cache.misses()), (2, 1));
/// // Another size is another mesh, of the same corners.
/// let card = Shape::rounded_rect(16.0, 100.0, 320.0, 180.0, 12.0)?;
/// cache.mesh(&light.cast(&card, 8.0, 0.0)?, Tolerance::ONE_LEVEL);
/// assert_eq!((cache.misses(), cache.corner_hits(), cache.corner_misses()), (2, 1, 1));
/// # Ok::<(), penumbral::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MeshCache {
    meshes: Vec<Kept>,
    max_meshes: NonZeroUsize,
    pub(super) strips: StripScratch,
    /// The key that is asked for.
    key: Vec<u64>,
    hits: u64,
    misses: u64,
}

/// A mesh that a [`MeshCache`] lends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CachedMesh<'a> {
    /// The triangles, about an origin of their own.
    pub mesh: &'a ShadowMesh,
    /// What is to be added to the vertices' positions, x and y in scene units.
    pub offset: [f64; 2],
    /// The mesh's number among all that the cache made, from 1 on: what a GPU holds of a mesh can be kept by it for as long as the cache
    /// [has](MeshCache::has) it.
    pub id: u64,
}

#[derive(Debug, Clone)]
struct Kept {
    key: Vec<u64>,
    id: u64,
    mesh: ShadowMesh,
    /// The number of the question that it last answered.
    used: u64,
}

impl MeshCache {
    /// An empty one that keeps at most `max_meshes`. Each question compares the keys of all of them.
    #[must_use]
    pub fn new(max_meshes: NonZeroUsize) -> Self {
        Self {
            meshes: Vec::new(),
            max_meshes,
            strips: StripScratch::default(),
            key: Vec::new(),
            hits: 0,
            misses: 0,
        }
    }

    /// The shadow's mesh: with the offset added to its vertices it is within the tolerance, as [`Shadow::mesh`] is, before the sums are
    /// rounded. A new mesh takes the place of the one that was not used for longest.
    pub fn mesh(&mut self, shadow: &Shadow, options: impl Into<MeshOptions>) -> CachedMesh<'_> {
        let options = options.into();
        let origin = shadow.hull().map_or(DVec2::ZERO, |(min, _)| min);
        let step = step(shadow, &options);
        self.key.clear();
        write_key(shadow, &options, origin, step, &mut self.key);
        let index = self.find(|strips| {
            let mut options = options;
            let mut alike = 0.0;
            if step > 0.0 {
                alike = options.tolerance.as_levels() * ALIKE_SHARE;
                options.tolerance = options.tolerance.divided(1.0 / (1.0 - ALIKE_SHARE));
            }
            let mut scratch = Scratch::new();
            core::mem::swap(&mut scratch.meshes.strips, strips);
            let mut mesh = shadow.moved(-origin).mesh_with(&options, &mut scratch);
            core::mem::swap(&mut scratch.meshes.strips, strips);
            mesh.error_levels += alike;
            mesh
        });
        let Kept { id, mesh, .. } = &self.meshes[index];
        CachedMesh {
            mesh,
            offset: origin.to_array(),
            id: *id,
        }
    }

    /// The mesh of a shadow that differs in nothing, not even in its place, or else the one that is made.
    pub(super) fn same(
        &mut self,
        shadow: &Shadow,
        options: &MeshOptions,
        make: impl FnOnce() -> ShadowMesh,
    ) -> &ShadowMesh {
        self.key.clear();
        write_key(shadow, options, DVec2::ZERO, 0.0, &mut self.key);
        let index = self.find(|_| make());
        &self.meshes[index].mesh
    }

    /// Where the mesh with the key that is asked for is kept, made unless it was.
    fn find(&mut self, make: impl FnOnce(&mut StripScratch) -> ShadowMesh) -> usize {
        let found = self.meshes.iter().position(|kept| kept.key == self.key);
        let index = if let Some(index) = found {
            self.hits += 1;
            index
        } else {
            self.misses += 1;
            let mesh = make(&mut self.strips);
            self.keep(mesh)
        };
        self.meshes[index].used = self.hits + self.misses;
        index
    }

    /// Keeps a mesh in place of the one that was not used for longest, and says where.
    fn keep(&mut self, mesh: ShadowMesh) -> usize {
        let kept = Kept {
            key: self.key.clone(),
            id: self.misses,
            mesh,
            used: 0,
        };
        if self.meshes.len() < self.max_meshes.get() {
            self.meshes.push(kept);
            return self.meshes.len() - 1;
        }
        let oldest = self.meshes.iter().enumerate().min_by_key(|(_, k)| k.used);
        let index = oldest.map_or(0, |(index, _)| index);
        self.meshes[index] = kept;
        index
    }

    /// Whether it holds the mesh of that [id](CachedMesh::id).
    #[must_use]
    pub fn has(&self, id: u64) -> bool {
        self.meshes.iter().any(|kept| kept.id == id)
    }

    /// How many meshes it holds.
    #[must_use]
    pub fn len(&self) -> usize {
        self.meshes.len()
    }

    /// Whether it holds none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.meshes.is_empty()
    }

    /// How often a mesh was there.
    #[must_use]
    pub fn hits(&self) -> u64 {
        self.hits
    }

    /// How often a mesh had to be made.
    #[must_use]
    pub fn misses(&self) -> u64 {
        self.misses
    }

    /// How often the mesh of a rounded rectangle had to be made, of corners that were there.
    #[must_use]
    pub fn corner_hits(&self) -> u64 {
        self.strips.hits
    }

    /// How often its corners had to be made as well.
    #[must_use]
    pub fn corner_misses(&self) -> u64 {
        self.strips.misses
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use crate::mesh::Profile;
    use crate::path::{FillRule, Path};
    use crate::shape::Shape;
    use crate::tolerance::Tolerance;

    fn cache(meshes: usize) -> MeshCache {
        MeshCache::new(NonZeroUsize::new(meshes).unwrap())
    }

    fn card(x: f32, y: f32, width: f32) -> Shape {
        Shape::rounded_rect(x, y, width, 50.0, 6.0).unwrap()
    }

    /// A crossing outline with curves of every kind.
    fn blob() -> Shape {
        let mut path = Path::new();
        path.move_to([0.0, 0.0]).quad_to([20.0, -9.0], [40.0, 0.0]);
        path.cubic_to([60.0, 20.0], [-9.0, 20.0], [30.0, 44.0]);
        path.arc_to([9.0, 5.0], 20.0, false, true, [8.0, 40.0])
            .line_to([20.0, -4.0])
            .close();
        Shape::path(&path, FillRule::EvenOdd).unwrap()
    }

    #[test]
    fn a_moved_shadow_finds_its_mesh_and_it_fits() {
        let light = Light::android(360.0).unwrap();
        let star = [[0.0, 0.0], [30.0, 8.0], [60.0, 0.0], [31.0, 50.0]];
        let star = Shape::polygon(&[star], FillRule::NonZero).unwrap();
        for shape in [card(0.0, 0.0, 80.0), star, blob()] {
            let mut cache = cache(4);
            for offset in [[10.0, 20.0], [300.25, 20.5], [17.0, 903.1], [-40.7, -3.3]] {
                let moved = shape.translated(offset).unwrap();
                let shadow = light.cast(&moved, 6.0, 0.0).unwrap();
                let kept = cache.mesh(&shadow, Tolerance::ONE_LEVEL);
                let (mesh, [x, y]) = (kept.mesh, kept.offset);
                assert_eq!(kept.id, 1);
                assert!(mesh.is_complete() && mesh.error_levels() <= 1.0);
                for [a, b, c] in mesh.triangles() {
                    let middle = [0, 1].map(|i: usize| {
                        let sum = a.position[i] + b.position[i] + c.position[i];
                        f64::from(sum) / 3.0 + [x, y][i]
                    });
                    let density = f64::from(a.density + b.density + c.density) / 3.0;
                    let exact = shadow.density_at(middle.map(|v| v as f32));
                    let error = (density - exact).abs() * 255.0;
                    assert!(error <= 1.0, "{offset:?}: {error}");
                }
            }
            assert_eq!((cache.hits(), cache.misses()), (3, 1));
        }
    }

    #[test]
    fn whatever_changes_the_mesh_is_a_miss() {
        let mut cache = cache(20);
        let light = Light::directional([0.0, 0.0], 1.0).unwrap();
        let mut ask = |shape: &Shape, elevation: f32, options: MeshOptions| {
            let shadow = light.cast(shape, elevation, 0.0).unwrap();
            let before = cache.misses();
            cache.mesh(&shadow, options);
            cache.misses() > before
        };
        let one = MeshOptions::new(Tolerance::ONE_LEVEL);
        let four = MeshOptions::new(Tolerance::levels(4.0).unwrap());
        assert!(ask(&card(0.0, 0.0, 80.0), 8.0, one));
        assert!(!ask(&card(0.0, 7.0, 80.0), 8.0, one));
        assert!(ask(&card(0.0, 0.0, 80.1), 8.0, one));
        assert!(ask(&card(0.0, 0.0, 80.0), 8.01, one));
        assert!(ask(&card(0.0, 0.0, 80.0), 8.0, four));
        assert!(ask(&card(0.0, 0.0, 80.0), 8.0, four.with_max_vertices(99)));
        assert!(ask(
            &card(0.0, 0.0, 80.0),
            8.0,
            one.with_profile(Profile::Linear)
        ));
        assert!(ask(&card(0.0, 0.0, 80.0), 0.0, one));
        assert!(!ask(&card(5.0, 0.0, 80.0), 0.0, one));
        assert!(ask(&blob(), 8.0, one));
    }

    #[test]
    fn the_one_not_used_for_longest_goes() {
        let mut cache = cache(2);
        let light = Light::directional([0.0, 0.0], 1.0).unwrap();
        let mut ask = |width: f32| {
            let shadow = light.cast(&card(0.0, 0.0, width), 8.0, 0.0).unwrap();
            let before = cache.hits();
            let id = cache.mesh(&shadow, Tolerance::levels(8.0).unwrap()).id;
            (cache.hits() > before, cache.len(), id)
        };
        let asked = [30.0, 40.0, 30.0, 50.0, 30.0, 40.0].map(&mut ask);
        let hits = asked.map(|(hit, ..)| hit);
        assert_eq!(hits, [false, false, true, false, true, false]);
        assert_eq!(asked.map(|(_, len, _)| len), [1, 2, 2, 2, 2, 2]);
        // What is made again is another mesh to those who keep it.
        assert_eq!(asked.map(|(.., id)| id), [1, 2, 1, 3, 1, 4]);
        assert_eq!(
            [1, 2, 3, 4].map(|id| cache.has(id)),
            [true, false, false, true]
        );
    }
}
