//! Memory that one drawing leaves to the next.

use core::num::NonZeroUsize;
use core::ops::Range;

use fearless_simd::Level;
use glam::DVec2;

use crate::compose::Fusion;
use crate::density::grid::GridScratch;
use crate::density::nine_patch::NinePatchScratch;
use crate::density::rows::{BAND, Bands, Rows};
use crate::density::runs::Runs;
use crate::hidden::inside::Inside;
use crate::mesh::MeshCache;
use crate::mesh::halving::HalvingScratch;
use crate::outline::Edge;
use crate::squares::Squares;

/// Meshes that are kept: enough for one picture's few outlines, and at most some tens of megabytes.
const KEPT_MESHES: NonZeroUsize = NonZeroUsize::MIN.saturating_add(15);

/// Buffers that drawings need while they work, kept so that drawing again allocates little or nothing, and tables and
/// templates of the last corners. What it holds changes no result: any scratch serves any shadow.
#[derive(Debug)]
pub struct Scratch {
    /// The best SIMD level of this machine. All give the same bits.
    level: Level,
    /// Lists of edges that are not in use.
    edges: Vec<Vec<Edge>>,
    /// Vertices of one curve.
    pub(crate) vertices: Vec<DVec2>,
    pub(crate) squares: Squares,
    pub(crate) rows: Rows,
    pub(crate) bands: Bands,
    pub(crate) nine_patch: NinePatchScratch,
    pub(crate) grid: GridScratch,
    /// Densities that a sink is yet to be given.
    pub(crate) runs: Runs,
    pub(crate) inside: Inside,
    pub(crate) fusion: Fusion,
    pub(crate) halving: HalvingScratch,
    /// Meshes that took a triangulation, and templates of strips.
    pub(crate) meshes: MeshCache,
    /// The columns of a row that are to be drawn.
    pub(crate) wanted: Vec<Range<i64>>,
    /// The same for each row of a band.
    pub(crate) wanted_of_rows: [Vec<Range<i64>>; BAND as usize],
}

impl Default for Scratch {
    fn default() -> Self {
        Self::at_level(Level::new())
    }
}

impl Scratch {
    /// An empty one; it grows as it is used.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    pub(crate) fn at_level(level: Level) -> Self {
        Self {
            level,
            edges: Vec::new(),
            vertices: Vec::new(),
            squares: Squares::default(),
            rows: Rows::default(),
            bands: Bands::default(),
            nine_patch: NinePatchScratch::default(),
            grid: GridScratch::default(),
            runs: Runs::default(),
            inside: Inside::default(),
            fusion: Fusion::default(),
            halving: HalvingScratch::default(),
            meshes: MeshCache::new(KEPT_MESHES),
            wanted: Vec::new(),
            wanted_of_rows: Default::default(),
        }
    }

    pub(crate) fn level(&self) -> Level {
        self.level
    }

    pub(crate) fn take(&mut self) -> Vec<Edge> {
        self.edges.pop().unwrap_or_default()
    }

    pub(crate) fn give(&mut self, mut edges: Vec<Edge>) {
        edges.clear();
        self.edges.push(edges);
    }
}

/// Every level that this machine has.
#[cfg(all(test, not(penumbral_scalar)))]
pub(crate) fn levels() -> Vec<Level> {
    let best = Level::new();
    let mut levels = Vec::new();
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        levels.extend(best.as_sse2().map(Level::Sse2));
        levels.extend(best.as_sse4_2().map(Level::Sse4_2));
        levels.extend(best.as_avx2().map(Level::Avx2));
    }
    levels.push(best);
    levels
}

/// The scalar level and the best, with which all others are compared where it was not asked for:
/// `RUSTFLAGS='--cfg penumbral_scalar' cargo test --lib every_simd_level`.
#[cfg(all(test, penumbral_scalar))]
pub(crate) fn levels() -> Vec<Level> {
    let scalar = Level::Fallback(fearless_simd::Fallback::new());
    vec![scalar, Level::new()]
}
