//! Curves as lines near to them: for what asks where an outline is, not what a disc sees of it.

use glam::DVec2;

use super::of_shape::circular;
use super::{Edge, fit};
use crate::path::{Contour, Segment};

impl Contour {
    /// Pushes the contour's edges, closed: lines and circular arcs as they are, other curves as lines within `flatness` of
    /// them. `vertices` is memory.
    pub(crate) fn near(&self, flatness: f64, vertices: &mut Vec<DVec2>, out: &mut Vec<Edge>) {
        for (mut from, segment) in self.walk() {
            match segment {
                Segment::Arc(arc) if let Some(arcs) = circular(from, arc) => {
                    out.extend(arcs.map(Edge::Arc));
                }
                _ => {
                    vertices.clear();
                    segment.flatten(from, flatness, vertices);
                    for to in vertices.iter() {
                        fit::push_line(from, *to, out);
                        from = *to;
                    }
                }
            }
        }
        fit::push_line(self.end(), self.start, out);
    }
}
