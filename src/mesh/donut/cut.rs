//! A mesh cut along loops: the same field, in triangles that the loops do not cross.
//!
//! The triangles that a loop passes are cut together by a constrained Delaunay triangulation (spade), with their sides and
//! the loop as constraints. Every point is rounded to `f32` before, so that the triangulation sees it where it will be drawn.
//! A line is led by way of each point within a step of `f32`: rounding takes next to no point across a line then. Should it
//! all the same, spade refuses a constraint. One of a loop is given up, and triangles stay that the loop crosses; for one of a
//! side, that side is not divided.

use std::collections::{BTreeSet, HashMap, HashSet};

use glam::DVec2;
use spade::handles::{FixedFaceHandle, FixedVertexHandle, PossiblyOuterTag};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use super::boxes::Boxes;
use super::{bounds, crosses, distance};
use crate::mesh::samples::mix_densities;
use crate::mesh::{MeshVertex, ShadowMesh};
use crate::outline::sides;

/// How often sides are tried again without those that could not be divided.
const ROUNDS: usize = 4;

/// The mesh with the triangles cut that `loops` cross, where `f32` has steps of `step` at most.
pub(super) fn cut(mesh: &ShadowMesh, loops: &[Vec<DVec2>], step: f64) -> ShadowMesh {
    let mut whole = HashSet::new();
    for _ in 0..ROUNDS {
        let mut cut = Cut::new(mesh, loops);
        cut.meet(step, &whole);
        cut.interpolate();
        match cut.triangles() {
            Ok(triangles) => {
                return ShadowMesh {
                    vertices: cut.vertices,
                    indices: triangles.concat(),
                    ..*mesh
                };
            }
            Err(sides) => whole.extend(sides),
        }
    }
    mesh.clone()
}

/// A line by way of the vertices on it, each with how far along it is, 0 to 1.
struct Line {
    ends: [u32; 2],
    via: Vec<(f64, u32)>,
}

impl Line {
    fn new(ends: [u32; 2]) -> Self {
        let via = Vec::new();
        Self { ends, via }
    }

    /// All of its vertices from one end to the other.
    fn chain(&self) -> Vec<u32> {
        let mut via = self.via.clone();
        via.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let [from, to] = self.ends;
        let mut chain = vec![from];
        chain.extend(via.into_iter().map(|(_, vertex)| vertex));
        chain.push(to);
        chain.dedup();
        chain
    }
}

struct Corners {
    vertices: [u32; 3],
    /// The lines from each vertex to the next, or back.
    sides: [usize; 3],
    /// Whether a loop crosses it.
    passed: bool,
}

struct Cut {
    /// The mesh's own, then those of the loops, then where loops cross sides.
    vertices: Vec<MeshVertex>,
    numbers: HashMap<[u32; 2], u32>,
    triangles: Vec<Corners>,
    /// The sides of triangles, then the lines of loops.
    lines: Vec<Line>,
    /// How many vertices the mesh has, how many with those of the loops, and how many lines are sides.
    own: usize,
    given: usize,
    sides: usize,
}

impl Cut {
    fn new(mesh: &ShadowMesh, loops: &[Vec<DVec2>]) -> Self {
        let numbers = mesh.vertices.iter().zip(0..);
        let mut cut = Self {
            vertices: mesh.vertices.clone(),
            numbers: numbers
                .map(|(v, number)| (bits(v.position), number))
                .collect(),
            triangles: Vec::with_capacity(mesh.indices.len() / 3),
            lines: Vec::new(),
            own: mesh.vertices.len(),
            given: 0,
            sides: 0,
        };
        let mut found = HashMap::new();
        for &[a, b, c] in mesh.indices.as_chunks::<3>().0 {
            let sides = [[a, b], [b, c], [c, a]].map(|[from, to]| {
                let ends = [from.min(to), from.max(to)];
                *found.entry(ends).or_insert_with(|| {
                    cut.lines.push(Line::new(ends));
                    cut.lines.len() - 1
                })
            });
            cut.triangles.push(Corners {
                vertices: [a, b, c],
                sides,
                passed: false,
            });
        }
        cut.sides = cut.lines.len();
        for points in loops {
            let mut numbers: Vec<u32> = points.iter().map(|&point| cut.number(point)).collect();
            numbers.dedup();
            let ends = sides(&numbers).filter(|(from, to)| from != to);
            cut.lines
                .extend(ends.map(|(from, to)| Line::new([from, to])));
        }
        cut.given = cut.vertices.len();
        cut
    }

    fn at(&self, vertex: u32) -> DVec2 {
        self.vertices[vertex as usize].at()
    }

    /// The vertex at a point, rounded. A new one gets its density from the triangle or side that it lies on.
    fn number(&mut self, point: DVec2) -> u32 {
        let position = point.as_vec2().to_array();
        let density = 0.0;
        *self.numbers.entry(bits(position)).or_insert_with(|| {
            self.vertices.push(MeshVertex { position, density });
            self.vertices.len() as u32 - 1
        })
    }

    /// Leads sides, but for those that are to stay `whole`, and the lines of loops by way of each other's ends and of the
    /// points where they cross.
    fn meet(&mut self, step: f64, whole: &HashSet<usize>) {
        let box_of = |line: &Line| bounds(line.ends.map(|end| self.at(end)));
        let loops = self.lines.iter().enumerate().skip(self.sides);
        let loops = Boxes::new(loops.map(|(number, line)| (box_of(line), number)));
        let mut near = Vec::new();
        for side in (0..self.sides).filter(|side| !whole.contains(side)) {
            let ends = self.lines[side].ends;
            let [a, b] = ends.map(|end| self.at(end));
            let [min, max] = bounds([a, b]);
            loops.meeting([min - step, max + step], &mut near);
            for &line in &near {
                let others = self.lines[line].ends;
                let [p, q] = others.map(|end| self.at(end));
                let beside = others.map(|end| distance(self.at(end), &[a, b]) <= step);
                let touched = ends.map(|end| distance(self.at(end), &[p, q]) <= step);
                for i in 0..2 {
                    if beside[i] {
                        self.lead(side, others[i]);
                    }
                    if touched[i] {
                        self.lead(line, ends[i]);
                    }
                }
                if beside == touched && !beside[0] && !beside[1] && crosses(&[a, b], &[p, q]) {
                    let [from, to] = [p, q].map(|point| (b - a).perp_dot(point - a));
                    let vertex = self.number(p + (q - p) * (from / (from - to)));
                    self.lead(side, vertex);
                    self.lead(line, vertex);
                }
            }
        }
    }

    /// Leads a line by way of a vertex that lies on it and is neither of its ends.
    fn lead(&mut self, line: usize, vertex: u32) {
        let ends = self.lines[line].ends;
        let [from, to] = ends.map(|end| self.at(end));
        let way = to - from;
        let share = (self.at(vertex) - from).dot(way) / way.length_squared();
        if !ends.contains(&vertex) && 0.0 < share && share < 1.0 {
            self.lines[line].via.push((share, vertex));
        }
    }

    /// Finds the triangles that are passed, and the densities of the vertices in them and on their sides.
    fn interpolate(&mut self) {
        let place = |vertex: usize| self.vertices[vertex].at();
        let points = (self.own..self.given).map(|vertex| ([place(vertex); 2], vertex));
        let points = Boxes::new(points);
        let mut near = Vec::new();
        for triangle in &mut self.triangles {
            let [a, b, c] = triangle.vertices.map(|i| self.vertices[i as usize]);
            let [at, from, to] = [a, b, c].map(|v| v.at());
            triangle.passed = triangle
                .sides
                .iter()
                .any(|&side| !self.lines[side].via.is_empty());
            points.meeting(bounds([at, from, to]), &mut near);
            for &number in &near {
                let vertex = &mut self.vertices[number];
                let point = vertex.at();
                let parts =
                    [[from, to], [to, at], [at, from]].map(|[s, t]| (t - s).perp_dot(point - s));
                let whole: f64 = parts.iter().sum();
                if parts.iter().all(|&part| part >= 0.0) && whole > 0.0 {
                    let shares = parts.map(|part| part / whole);
                    vertex.density =
                        mix_densities([a, b, c].map(|v| f64::from(v.density)), shares) as f32;
                    triangle.passed = true;
                }
            }
        }
        for side in &self.lines[..self.sides] {
            let [from, to] = side
                .ends
                .map(|end| f64::from(self.vertices[end as usize].density));
            for &(share, vertex) in &side.via {
                if vertex as usize >= self.own {
                    self.vertices[vertex as usize].density = (from + (to - from) * share) as f32;
                }
            }
        }
    }

    /// The triangles, those that are passed in parts; or the sides that could not be divided.
    fn triangles(&self) -> Result<Vec<[u32; 3]>, Vec<usize>> {
        let passed = || self.triangles.iter().filter(|triangle| triangle.passed);
        let sides: BTreeSet<usize> = passed().flat_map(|triangle| triangle.sides).collect();
        let chains: Vec<Vec<u32>> = sides
            .into_iter()
            .chain(self.sides..self.lines.len())
            .map(|line| self.lines[line].chain())
            .collect();
        let mut parts = Parts::default();
        // Vertices come first: one on a constraint would divide it.
        for &vertex in chains.iter().flatten() {
            parts.insert(vertex, self.at(vertex));
        }
        for chain in &chains {
            parts.constrain(chain);
        }
        let mut broken = Vec::new();
        for triangle in passed() {
            for (&side, from) in triangle.sides.iter().zip(triangle.vertices) {
                let mut chain = self.lines[side].chain();
                if chain[0] != from {
                    chain.reverse();
                }
                if !parts.enclose(&chain) {
                    broken.push(side);
                }
            }
        }
        if !broken.is_empty() {
            return Err(broken);
        }
        let others = self.triangles.iter().filter(|triangle| !triangle.passed);
        let mut triangles: Vec<[u32; 3]> = others.map(|triangle| triangle.vertices).collect();
        triangles.extend(parts.enclosed());
        Ok(triangles)
    }
}

/// The triangulation of what is cut.
#[derive(Default)]
struct Parts {
    faces: ConstrainedDelaunayTriangulation<Point2<f64>>,
    handles: HashMap<u32, FixedVertexHandle>,
    /// The vertex of each handle.
    vertices: Vec<u32>,
    /// Edges along sides, and the faces on their left.
    borders: HashSet<usize>,
    beside: Vec<FixedFaceHandle<PossiblyOuterTag>>,
}

impl Parts {
    fn insert(&mut self, vertex: u32, at: DVec2) {
        if self.handles.contains_key(&vertex) {
            return;
        }
        // Only what is not finite is refused, and no mesh is that.
        if let Ok(handle) = self.faces.insert(Point2::new(at.x, at.y)) {
            self.handles.insert(vertex, handle);
            if handle.index() == self.vertices.len() {
                self.vertices.push(vertex);
            }
        }
    }

    fn steps(&self, chain: &[u32]) -> Vec<[FixedVertexHandle; 2]> {
        let handle = |vertex| self.handles.get(vertex).copied();
        chain
            .windows(2)
            .filter_map(|ends| Some([handle(&ends[0])?, handle(&ends[1])?]))
            .filter(|[from, to]| from != to)
            .collect()
    }

    /// Makes a chain edges, as far as none is in the way.
    fn constrain(&mut self, chain: &[u32]) {
        for [from, to] in self.steps(chain) {
            self.faces.try_add_constraint(from, to);
        }
    }

    /// Takes a chain as part of the border of what lies on its left, if it became edges.
    fn enclose(&mut self, chain: &[u32]) -> bool {
        self.steps(chain).into_iter().all(|[from, to]| {
            let edge = self.faces.get_edge_from_neighbors(from, to);
            if let Some(edge) = edge {
                self.borders.insert(edge.as_undirected().fix().index());
                self.beside.push(edge.face().fix());
            }
            edge.is_some()
        })
    }

    /// The triangles within the borders.
    fn enclosed(self) -> Vec<[u32; 3]> {
        let mut open = self.beside;
        let mut is_enclosed = vec![false; self.faces.num_all_faces()];
        while let Some(face) = open.pop() {
            if core::mem::replace(&mut is_enclosed[face.index()], true) {
                continue;
            }
            if let Some(inner) = self.faces.face(face).as_inner() {
                let edges = inner.adjacent_edges();
                let inwards = edges
                    .iter()
                    .filter(|edge| !self.borders.contains(&edge.as_undirected().fix().index()));
                open.extend(inwards.map(|edge| edge.rev().face().fix()));
            }
        }
        self.faces
            .inner_faces()
            .filter(|face| is_enclosed[face.fix().index()])
            .map(|face| face.vertices().map(|v| self.vertices[v.fix().index()]))
            .collect()
    }
}

/// A key for a position: both zeros are one.
fn bits(position: [f32; 2]) -> [u32; 2] {
    position.map(|x| (x + 0.0).to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of `side` from the origin in two halves, its density growing along both axes.
    fn square(side: f32) -> ShadowMesh {
        let vertex = |x: f32, y: f32| MeshVertex {
            position: [x, y],
            density: (x + 2.0 * y) / (3.0 * side),
        };
        ShadowMesh {
            vertices: vec![
                vertex(0.0, 0.0),
                vertex(side, 0.0),
                vertex(side, side),
                vertex(0.0, side),
            ],
            indices: vec![0, 1, 2, 0, 2, 3],
            ..ShadowMesh::empty()
        }
    }

    fn points(points: &[[f64; 2]]) -> Vec<DVec2> {
        points.iter().copied().map(DVec2::from).collect()
    }

    /// All triangles have area, together the square's, and the field is the square's.
    fn assert_same(vertices: &[MeshVertex], indices: &[u32], side: f32) {
        let mut area = 0.0;
        for corners in indices.as_chunks::<3>().0 {
            let [a, b, c] = corners.map(|i| vertices[i as usize].at());
            let double = (b - a).perp_dot(c - a);
            assert!(double > 0.0);
            area += double / 2.0;
        }
        let side = f64::from(side);
        assert!((area - side * side).abs() < 1e-6 * side * side, "{area}");
        for &corner in indices {
            let MeshVertex { position, density } = vertices[corner as usize];
            let [x, y] = position.map(f64::from);
            assert!((f64::from(density) - (x + 2.0 * y) / (3.0 * side)).abs() < 1e-6);
        }
    }

    #[test]
    fn a_loop_that_is_in_its_own_way_is_given_up_in_part() {
        // Its lines cross one another where no vertex is: the later one is refused.
        let bow = points(&[[1.0, 1.0], [7.0, 6.0], [7.0, 1.0], [1.0, 6.5]]);
        let mesh = square(8.0);
        let cut = cut(&mesh, &[bow], 1e-6);
        assert!(cut.indices.len() > mesh.indices.len());
        assert_same(&cut.vertices, &cut.indices, 8.0);
    }

    #[test]
    fn sides_that_stay_whole_refuse_the_loop_and_nothing_is_torn() {
        let mesh = square(8.0);
        let mut cut = Cut::new(&mesh, &[inset()]);
        let whole: HashSet<usize> = (0..cut.sides).collect();
        cut.meet(1e-6, &whole);
        cut.interpolate();
        let sides = &cut.lines[..cut.sides];
        assert!(sides.iter().all(|side| side.via.is_empty()));
        let triangles = cut.triangles().unwrap().concat();
        assert!(triangles.len() > mesh.indices.len());
        assert_same(&cut.vertices, &triangles, 8.0);
    }

    /// A loop about most of the square, no vertex of it on the diagonal.
    fn inset() -> Vec<DVec2> {
        points(&[[1.0, 1.5], [7.0, 1.0], [7.0, 7.5], [1.0, 7.0]])
    }

    /// The square and a triangle over it whose sides cross the square's.
    fn with_one_more(corners: [[f32; 2]; 3]) -> ShadowMesh {
        let mut mesh = square(8.0);
        let density = 0.5;
        let vertex = |position| MeshVertex { position, density };
        mesh.vertices.extend(corners.map(vertex));
        mesh.indices.extend([4, 5, 6]);
        mesh
    }

    #[test]
    fn sides_that_cannot_be_divided_stay_whole() {
        // The square's sides are in the way of the triangle's: it stays as a whole, and all else is cut.
        let mesh = with_one_more([[3.0, -2.0], [9.0, 3.0], [2.0, 9.0]]);
        let cut = cut(&mesh, &[inset()], 1e-6);
        let (triangle, others) = cut.indices.split_at(3);
        assert_eq!(triangle, [4, 5, 6]);
        assert!(others.len() > 6);
        assert_same(&cut.vertices, others, 8.0);
        // With a vertex of the loop in it there is no way to cut the two.
        let mesh = with_one_more([[3.0, -2.0], [9.0, 0.5], [2.0, 9.0]]);
        assert_eq!(super::cut(&mesh, &[inset()], 1e-6), mesh);
    }
}
