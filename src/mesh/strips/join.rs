//! Rings of vertices joined to triangles.

use glam::DVec2;

/// A vertex of a ring: whose corner's it is, where it comes round the middle, in quarters, and its number.
#[derive(Debug, Clone, Copy)]
pub(in crate::mesh) struct RingVertex {
    pub(in crate::mesh) quarter: usize,
    pub(in crate::mesh) turn: f64,
    pub(in crate::mesh) index: u32,
    pub(in crate::mesh) at: DVec2,
}

/// Triangles between a ring and the next one inside.
pub(in crate::mesh) fn join(
    outer: &[RingVertex],
    inner: &[RingVertex],
    triangles: &mut Vec<[u32; 3]>,
) {
    let at = |ring: &[RingVertex], i: usize| {
        let vertex = ring[i % ring.len()];
        let rounds = i / ring.len();
        let turn = vertex.turn + 4.0 * rounds as f64;
        (vertex.quarter + 4 * rounds, turn, vertex.index)
    };
    // What leads from corner to corner comes after all of the one and before all of the other: it may be of any length, and what it
    // faced of a corner would be needles as long.
    let middle = |(from, turn, _): (usize, f64, u32), (to, next, _): (usize, f64, u32)| {
        if from % 4 == to % 4 {
            f64::midpoint(turn, next)
        } else {
            to as f64
        }
    };
    let (mut i, mut j) = (0, 0);
    while i < outer.len() || j < inner.len() {
        let [from, to] = [i, i + 1].map(|i| at(outer, i));
        let [inner_from, inner_to] = [j, j + 1].map(|j| at(inner, j));
        let (a, b) = (from.2, inner_from.2);
        let is_outer_first = middle(from, to) <= middle(inner_from, inner_to);
        // The side whose middle comes first: its triangle's apex is about opposite.
        if j == inner.len() || (i < outer.len() && is_outer_first) {
            push([a, to.2, b], triangles);
            i += 1;
        } else {
            push([a, inner_to.2, b], triangles);
            j += 1;
        }
    }
}

/// Triangles that fill a convex ring.
pub(in crate::mesh) fn fill(ring: &[RingVertex], triangles: &mut Vec<[u32; 3]>) {
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
