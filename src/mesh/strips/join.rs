//! Rings of vertices joined to triangles.

use glam::DVec2;

/// A vertex of a ring: where it comes round the middle, in quarters, and its number.
#[derive(Debug, Clone, Copy)]
pub(super) struct RingVertex {
    pub(super) turn: f64,
    pub(super) index: u32,
    pub(super) at: DVec2,
}

/// Triangles between a ring and the next one inside.
pub(super) fn join(outer: &[RingVertex], inner: &[RingVertex], triangles: &mut Vec<[u32; 3]>) {
    let at = |ring: &[RingVertex], i: usize| {
        let vertex = ring[i % ring.len()];
        let turns = if i < ring.len() { 0.0 } else { 4.0 };
        (vertex.turn + turns, vertex.index)
    };
    let (mut i, mut j) = (0, 0);
    while i < outer.len() || j < inner.len() {
        let (from, a) = at(outer, i);
        let (to, next) = at(outer, i + 1);
        let (inner_from, b) = at(inner, j);
        let (inner_to, inner_next) = at(inner, j + 1);
        // The side whose middle comes first: its triangle's apex is about opposite.
        if j == inner.len() || (i < outer.len() && from + to <= inner_from + inner_to) {
            push([a, next, b], triangles);
            i += 1;
        } else {
            push([a, inner_next, b], triangles);
            j += 1;
        }
    }
}

/// Triangles that fill a convex ring.
pub(super) fn fill(ring: &[RingVertex], triangles: &mut Vec<[u32; 3]>) {
    let (mut first, mut last) = (0, ring.len() - 1);
    let corners = |corners: [usize; 3]| corners.map(|i| ring[i].index);
    while first + 1 < last {
        push(corners([first, first + 1, last]), triangles);
        first += 1;
        if first + 1 < last {
            push(corners([first, last - 1, last]), triangles);
            last -= 1;
        }
    }
}

/// Adds a triangle, unless two of its vertices are one.
fn push([a, b, c]: [u32; 3], triangles: &mut Vec<[u32; 3]>) {
    if a != b && b != c && c != a {
        triangles.push([a, b, c]);
    }
}
