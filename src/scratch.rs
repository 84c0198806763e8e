//! Memory that one drawing leaves to the next.

use crate::outline::Edge;

/// Buffers that pixel methods need while they work, kept so that drawing again allocates little or nothing. It holds no
/// results: any scratch serves any shadow.
#[derive(Debug, Default)]
pub struct Scratch {
    /// Lists of edges that are not in use.
    edges: Vec<Vec<Edge>>,
}

impl Scratch {
    /// An empty one; it grows as it is used.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    pub(crate) fn take(&mut self) -> Vec<Edge> {
        self.edges.pop().unwrap_or_default()
    }

    pub(crate) fn give(&mut self, mut edges: Vec<Edge>) {
        edges.clear();
        self.edges.push(edges);
    }
}
