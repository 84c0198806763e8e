//! Rounding to `f32` without leaving gaps.
//!
//! Three vertices that are nearly in line may be in line, or past it, once they are rounded. To leave such a triangle out
//! would part its neighbours: one keeps the long side, the others the two short ones. Instead its middle vertex goes into
//! the long side, and into the triangle beyond.

use std::collections::HashMap;

use super::MeshVertex;

type Triangle = [u32; 3];

/// The triangles without those that have no area left, their neighbours mended.
pub(super) fn settle(vertices: &[MeshVertex], triangles: Vec<Triangle>) -> Vec<u32> {
    let at = |index: u32| vertices[index as usize].at();
    let has_area = |[a, b, c]: Triangle| (at(b) - at(a)).perp_dot(at(c) - at(a)) > 0.0;
    let mut flat: Vec<usize> = (0..triangles.len())
        .filter(|&i| !has_area(triangles[i]))
        .collect();
    if flat.is_empty() {
        return triangles.concat();
    }
    let mut triangles: Vec<Option<Triangle>> = triangles.into_iter().map(Some).collect();
    let mut owner: HashMap<(u32, u32), usize> = HashMap::new();
    for (index, triangle) in triangles.iter().enumerate() {
        for side in triangle.iter().flat_map(sides) {
            owner.insert(side, index);
        }
    }
    // Each step takes a flat triangle away and gives its middle vertex to a neighbour: more steps than there are
    // triangles would go in circles.
    for _ in 0..4 * triangles.len() {
        let Some(index) = flat.pop() else { break };
        let Some(triangle) = triangles[index].take() else {
            continue;
        };
        let [a, b, c] = triangle;
        if a == b || b == c || c == a {
            continue;
        }
        let longest = sides(&triangle).into_iter().max_by(|s, t| {
            (at(s.1) - at(s.0))
                .length()
                .total_cmp(&(at(t.1) - at(t.0)).length())
        });
        let Some((from, to)) = longest else { continue };
        let middle = a ^ b ^ c ^ from ^ to;
        let Some(&beyond) = owner.get(&(to, from)) else {
            continue;
        };
        let Some(neighbor) = triangles[beyond].take() else {
            continue;
        };
        let apex = neighbor[0] ^ neighbor[1] ^ neighbor[2] ^ from ^ to;
        for part in [[to, middle, apex], [middle, from, apex]] {
            for side in sides(&part) {
                owner.insert(side, triangles.len());
            }
            if !has_area(part) {
                flat.push(triangles.len());
            }
            triangles.push(Some(part));
        }
    }
    triangles
        .into_iter()
        .flatten()
        .filter(|&triangle| has_area(triangle))
        .flatten()
        .collect()
}

fn sides([a, b, c]: &Triangle) -> [(u32, u32); 3] {
    [(*a, *b), (*b, *c), (*c, *a)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_triangle_gives_its_middle_vertex_away() {
        let vertex = |x: f32, y: f32| MeshVertex {
            position: [x, y],
            density: 0.0,
        };
        // A square in two halves with a flat triangle between: 0 and 2 are the diagonal's ends, 4 is its middle.
        let vertices = [
            vertex(0.0, 0.0),
            vertex(2.0, 0.0),
            vertex(2.0, 2.0),
            vertex(0.0, 2.0),
            vertex(1.0, 1.0),
        ];
        let triangles = vec![[0, 1, 2], [0, 2, 4], [0, 4, 3], [4, 2, 3]];
        let settled = settle(&vertices, triangles);
        let mut parts: Vec<Vec<u32>> = settled.chunks(3).map(<[u32]>::to_vec).collect();
        parts.sort();
        assert_eq!(parts, [[0, 4, 3], [2, 4, 1], [4, 0, 1], [4, 2, 3]]);
    }
}
