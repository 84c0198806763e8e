//! What there is to draw of a shadow, as the plan wants to know it.

use glam::DVec2;

use super::Shadow;
use crate::outline::Edge;
use crate::path::Segment;

/// How many edges an outline is drawn as, how long they are together and how large its box, in scene units.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Census {
    pub(crate) lines: f64,
    pub(crate) line_length: f64,
    pub(crate) arcs: f64,
    pub(crate) arc_length: f64,
    /// Curves that are drawn as arcs, and from end to end.
    pub(crate) curves: f64,
    pub(crate) curve_length: f64,
    /// Lines, arcs and curves as they were given.
    pub(crate) pieces: f64,
    pub(crate) size: DVec2,
}

impl Census {
    pub(crate) fn add(&mut self, edge: &Edge) {
        let (count, length) = match edge {
            Edge::Arc(_) => (&mut self.arcs, &mut self.arc_length),
            Edge::Line(_) | Edge::Border(_) => (&mut self.lines, &mut self.line_length),
        };
        *count += 1.0;
        *length += edge.length();
    }
}

impl Shadow {
    /// What there is to draw.
    pub(crate) fn census(&self) -> Census {
        // What is left when fills are resolved is drawn as about so many lines a curve.
        const LINES: f64 = 40.0;
        let mut census = Census::default();
        for edge in self.fixed.edges() {
            census.pieces += 1.0;
            census.add(edge);
        }
        let simple = self.has_simple_curves();
        for contour in self
            .curved
            .iter()
            .flatten()
            .flat_map(|shape| &shape.contours)
        {
            for (from, segment) in contour.walk() {
                census.pieces += 1.0;
                let length = (segment.end() - from).length();
                if !simple {
                    census.lines += LINES;
                    census.line_length += length;
                } else if matches!(segment, Segment::Line(_)) {
                    census.lines += 1.0;
                    census.line_length += length;
                } else {
                    census.curves += 1.0;
                    census.curve_length += length;
                }
            }
        }
        census.size = self.hull().map_or(DVec2::ZERO, |(min, max)| max - min);
        census
    }
}
