//! The rim as triangles between the outline and its inset, with normals and a curvature factor.
//!
//! The inset is the umbra of a shadow whose penumbra is as wide as the rim, so the tangents' loops give the rings; where they
//! collapse the triangulation (spade) runs from one side of the outline to the other, and gets vertices on the ridge between.

use std::collections::HashMap;

use core::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};
use libm::{acos, ceil, cos};
use spade::handles::FixedVertexHandle;
use spade::{Point2, Triangulation, mitigate_underflow};

use super::{Rim, RimSurface};
use crate::error::Result;
use crate::limits::at_most;
use crate::mesh::regions::{Region, Triangles, Vertex, faces};
use crate::mesh::tangents::{ProjectionCircle, tangent_loops};
use crate::outline::{self, Edge, Outline, sides};
use crate::shape::Shape;

/// By how much curves turn from one face to the next at most, radians: 6 degrees.
const TURN: f64 = PI / 30.0;

/// How far lines may be from curves other than circles, of the rim's width: about 6 degrees along a curve as narrow as the rim.
const FLAT: f64 = 1.0 / 750.0;

/// A corner of the outline that turns by more, radians, is sharp: 20 degrees.
const SHARP: f64 = PI / 9.0;

/// How far from a sharp corner edges have a vertex of their own, in widths: beyond it the crease has no say.
const GUARD: f64 = 1.5;

/// Vertices on ridges change the triangles around: no more are level after so many rounds, but for slivers.
const RIDGE_ROUNDS: usize = 4;

/// A rim's mesh may not have more vertices than this.
const MAX_VERTICES: usize = 1 << 18;

/// A vertex of a rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RimVertex {
    /// x and y in scene units, and z over the flat part.
    pub position: [f64; 3],
    /// The mean of the normals of the faces around it, each weighed by its angle there, of unit length.
    pub normal: [f64; 3],
    /// 0 where the surface is flat or gently curved, 1 at a crease.
    pub curvature: f64,
}

/// A triangle of a rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RimFace {
    /// Its vertices' indices.
    pub vertices: [usize; 3],
    /// Its unit normal.
    pub normal: [f64; 3],
}

/// A rim as triangles. Inside of them is the flat part.
///
/// ```
/// use penumbral::Shape;
/// use penumbral::finish::{Rim, RimMesh, RimProfile};
///
/// let card = Shape::rounded_rect(0.0, 0.0, 80.0, 60.0, 12.0)?;
/// let mesh = RimMesh::new(&card, &Rim::new(4.0, 4.0, RimProfile::QuarterRound)?)?;
/// assert!(mesh.vertices().iter().all(|vertex| vertex.curvature == 0.0));
/// # Ok::<(), penumbral::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct RimMesh {
    vertices: Vec<RimVertex>,
    faces: Vec<RimFace>,
}

impl RimMesh {
    /// The mesh of a rim along a shape's outline.
    ///
    /// # Errors
    /// [`Error::TooMany`](crate::Error::TooMany) when it would have more than 2^18 vertices.
    pub fn new(shape: &Shape, rim: &Rim) -> Result<Self> {
        let least = f64::from(f32::EPSILON) * shape.extent();
        let outline = Outline::of_shape(shape, FLAT * rim.width().max(least));
        let center = outline
            .bounds()
            .map_or(DVec2::ZERO, |(min, max)| (min + max) / 2.0);
        let outline = outline.moved(-center);
        let depths = rim.rings();
        let edges = outline.edges().map(|edge| steps(edge) + 2).sum::<usize>();
        at_most(
            "vertices of a rim",
            edges.saturating_mul(depths.len()),
            MAX_VERTICES,
        )?;
        let mut builder = Builder {
            triangles: Triangles::new(),
            last: depths.len() - 1,
        };
        let loops: Vec<Vec<ProjectionCircle>> = outline
            .loops
            .iter()
            .map(|edges| guarded(&polygon(edges), rim.width()))
            .map(|points| {
                let circle = |center| ProjectionCircle {
                    center,
                    radius: rim.width(),
                };
                points.into_iter().map(circle).collect()
            })
            .collect();
        // Round inner corners turn as other curves do.
        let round = rim.width() * (1.0 - cos(TURN / 2.0));
        for (ring, &depth) in depths.iter().enumerate() {
            for points in tangent_loops(&loops, depth, round) {
                builder.push_ring(&points, ring, depth, 1e-6 * rim.width());
            }
        }
        builder.push_creases(&depths, rim.width());
        let surface = RimSurface::of_edges(outline.edges().copied().collect(), rim);
        builder.push_ridges(&surface);
        Ok(builder.finish(rim, center))
    }

    /// The vertices.
    #[must_use]
    pub fn vertices(&self) -> &[RimVertex] {
        &self.vertices
    }

    /// The triangles, none over another.
    #[must_use]
    pub fn faces(&self) -> &[RimFace] {
        &self.faces
    }
}

/// Into how many lines an edge is cut.
fn steps(edge: &Edge) -> usize {
    match edge {
        Edge::Line(_) | Edge::Border(_) => 1,
        Edge::Arc(arc) => ceil(arc.sweep.abs() / TURN).max(1.0) as usize,
    }
}

fn polygon(edges: &[Edge]) -> Vec<DVec2> {
    let mut points = Vec::new();
    for edge in edges {
        points.push(edge.from());
        if let Edge::Arc(arc) = edge {
            let count = steps(edge);
            let at = |step| arc.at(arc.start + arc.sweep * step as f64 / count as f64);
            points.extend((1..count).map(at));
        }
    }
    points
}

/// The polygon with a vertex more on long edges beside sharp corners.
fn guarded(points: &[DVec2], width: f64) -> Vec<DVec2> {
    let count = points.len();
    let along = |i: usize| points[(i + 1) % count] - points[i % count];
    let is_sharp = |i: usize| outline::turn(along(i + count - 1), along(i)).abs() > SHARP;
    let mut guarded = Vec::with_capacity(count);
    for i in 0..count {
        guarded.push(points[i]);
        let (way, length) = (along(i), along(i).length());
        if length > 2.0 * GUARD * width {
            let guard = way * (GUARD * width / length);
            guarded.extend(is_sharp(i).then(|| points[i] + guard));
            guarded.extend(is_sharp(i + 1).then(|| points[(i + 1) % count] - guard));
        }
    }
    guarded
}

struct Builder {
    triangles: Triangles,
    last: usize,
}

impl Builder {
    fn insert(&mut self, at: DVec2, depth: f64, ring: Option<usize>) -> Option<FixedVertexHandle> {
        let position = mitigate_underflow(Point2::new(at.x, at.y));
        let vertex = Vertex {
            position,
            density: depth,
            ring,
        };
        self.triangles.insert(vertex).ok()
    }

    /// A loop of a ring, without what is nearer than `least`: where tangents cross some vertices are all but the same.
    fn push_ring(&mut self, points: &[DVec2], ring: usize, depth: f64, least: f64) {
        let mut kept: Vec<DVec2> = Vec::with_capacity(points.len());
        for &point in points {
            let near = |other: Option<&DVec2>| other.is_some_and(|o| o.distance(point) < least);
            if !near(kept.last()) && !near(kept.first()) {
                kept.push(point);
            }
        }
        if kept.len() < 3 {
            return;
        }
        let handles: Vec<_> = kept
            .iter()
            .filter_map(|&point| self.insert(point, depth, Some(ring)))
            .collect();
        for (from, to) in sides(&handles) {
            self.constrain(from, to);
        }
    }

    fn constrain(&mut self, from: FixedVertexHandle, to: FixedVertexHandle) {
        if from != to {
            // What would cross another constraint stays as the triangulation has it.
            let _ = self.triangles.try_add_constraint(from, to);
        }
    }

    /// Constrains the edges from a sharp corner of each ring to that of the next, along the crease between two sides.
    fn push_creases(&mut self, depths: &[f64], width: f64) {
        let mut rings: Vec<Vec<(DVec2, FixedVertexHandle)>> = vec![Vec::new(); depths.len()];
        for vertex in self.triangles.vertices() {
            if let Some(ring) = vertex.data().ring {
                let position = vertex.position();
                rings[ring].push((DVec2::new(position.x, position.y), vertex.fix()));
            }
        }
        for ring in &mut rings {
            ring.sort_by(|a, b| a.0.x.total_cmp(&b.0.x).then(a.0.y.total_cmp(&b.0.y)));
        }
        let mut creases = Vec::new();
        for (index, pair) in rings.windows(2).enumerate() {
            let inwards = (depths[index + 1] - depths[index]) * width;
            for &(at, handle) in &pair[0] {
                let Some(miter) = self.miter(handle, index) else {
                    continue;
                };
                let expected = at + miter * inwards;
                let near = 1e-3 * inwards;
                let first = pair[1].partition_point(|(other, _)| other.x < expected.x - near);
                let beside = pair[1][first..]
                    .iter()
                    .take_while(|(other, _)| other.x <= expected.x + near);
                let met = beside
                    .clone()
                    .find(|(o, _)| (o.y - expected.y).abs() <= near);
                creases.extend(met.map(|(_, other)| (handle, *other)));
            }
        }
        for (from, to) in creases {
            self.constrain(from, to);
        }
    }

    /// By how much a sharp outer corner of a ring moves for each unit that its edges move inwards.
    fn miter(&self, handle: FixedVertexHandle, ring: usize) -> Option<DVec2> {
        let vertex = self.triangles.vertex(handle);
        let at = |p: Point2<f64>| DVec2::new(p.x, p.y);
        let mut neighbours = vertex
            .out_edges()
            .filter(|edge| edge.is_constraint_edge() && edge.to().data().ring == Some(ring))
            .map(|edge| (at(edge.to().position()) - at(vertex.position())).normalize_or_zero());
        let (a, b) = (neighbours.next()?, neighbours.next()?);
        if neighbours.next().is_some() || outline::turn(-a, b).abs() <= SHARP {
            return None;
        }
        // Halfway between both edges, as far as its distance from either is 1.
        let half = (a + b).normalize_or_zero();
        let across = half.perp_dot(a).abs();
        (across > 0.0).then(|| half / across)
    }

    /// Where faces lie on one ring alone it has collapsed further in: their edges from side to side get a vertex about
    /// their middle, on the ridge and as deep as it is.
    fn push_ridges(&mut self, surface: &RimSurface) {
        for _ in 0..RIDGE_ROUNDS {
            let middles = self.level_middles();
            if middles.is_empty() || self.triangles.num_vertices() + middles.len() > MAX_VERTICES {
                break;
            }
            for (middle, reach) in middles {
                let ridge = surface.ridge_near(middle, reach);
                self.insert(ridge, surface.depth(ridge).min(1.0), None);
            }
        }
    }

    /// The middles and half lengths of the edges from side to side of faces that lie on one ring.
    fn level_middles(&self) -> Vec<(DVec2, f64)> {
        let mut middles = Vec::new();
        for face in faces(&self.triangles, self.last, Region::Penumbra) {
            let face = self.triangles.face(face);
            let rings = face.vertices().map(|vertex| vertex.data().ring);
            if rings[0].is_none() || rings[0] != rings[1] || rings[0] != rings[2] {
                continue;
            }
            for edge in face.adjacent_edges() {
                if !edge.is_constraint_edge() {
                    let [a, b] = edge.positions().map(|p| DVec2::new(p.x, p.y));
                    middles.push(((a + b) / 2.0, a.distance(b) / 2.0));
                }
            }
        }
        // From either side an edge has the same middle.
        let key = |&(at, _): &(DVec2, f64)| (at.x, at.y);
        middles.sort_by(|a, b| {
            let (a, b) = (key(a), key(b));
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        middles.dedup();
        middles
    }

    fn finish(self, rim: &Rim, center: DVec2) -> RimMesh {
        let mut mesh = RimMesh {
            vertices: Vec::new(),
            faces: Vec::new(),
        };
        let mut own: HashMap<usize, usize> = HashMap::new();
        let mut is_inset = Vec::new();
        for face in faces(&self.triangles, self.last, Region::Penumbra) {
            let vertices = self.triangles.face(face).vertices().map(|vertex| {
                *own.entry(vertex.index()).or_insert_with(|| {
                    let Vertex {
                        position,
                        density: depth,
                        ring,
                    } = *vertex.data();
                    let at = DVec2::new(position.x, position.y) + center;
                    mesh.vertices.push(RimVertex {
                        position: at.extend(rim.rise(depth)).to_array(),
                        normal: [0.0; 3],
                        curvature: 0.0,
                    });
                    is_inset.push(ring == Some(self.last));
                    mesh.vertices.len() - 1
                })
            });
            let [a, b, c] = vertices.map(|i| DVec3::from(mesh.vertices[i].position));
            // spade turns its faces one way: up.
            let normal = (b - a).cross(c - a).normalize_or_zero();
            if normal.z > 0.0 {
                mesh.faces.push(RimFace {
                    vertices,
                    normal: normal.to_array(),
                });
            }
        }
        mesh.set_normals(&is_inset);
        mesh.set_curvatures(&is_inset, rim.turn());
        mesh
    }
}

impl RimMesh {
    /// Vertex normals: the mean of the faces' normals (Gouraud 1971), each weighed by its angle at the vertex, so that it does not
    /// matter how a face is cut (Thürmer & Wüthrich 1998). At the inset the flat part is a face as well.
    fn set_normals(&mut self, is_inset: &[bool]) {
        let mut sums = vec![(DVec3::ZERO, 0.0); self.vertices.len()];
        for face in &self.faces {
            let at = face
                .vertices
                .map(|i| DVec3::from(self.vertices[i].position));
            for corner in 0..3 {
                let [a, b] =
                    [1, 2].map(|next| (at[(corner + next) % 3] - at[corner]).normalize_or_zero());
                let angle = acos(a.dot(b).clamp(-1.0, 1.0));
                let (sum, angles) = &mut sums[face.vertices[corner]];
                *sum += DVec3::from(face.normal) * angle;
                *angles += angle;
            }
        }
        for ((vertex, (sum, angles)), is_inset) in self.vertices.iter_mut().zip(sums).zip(is_inset)
        {
            let flat = if *is_inset {
                (TAU - angles).max(0.0)
            } else {
                0.0
            };
            let mean = (sum + DVec3::Z * flat).normalize_or_zero();
            vertex.normal = if mean == DVec3::ZERO { DVec3::Z } else { mean }.to_array();
        }
    }

    /// Curvature factors: from the largest angle between two faces that meet at the vertex. What the steps of curves and of the
    /// profile, which turns by `turn` a step, make of a smooth surface is 0; twice as much is a crease.
    fn set_curvatures(&mut self, is_inset: &[bool], turn: f64) {
        let smooth = 1.5 * (TURN * TURN + turn * turn).sqrt();
        let mut beside: HashMap<[usize; 2], DVec3> = HashMap::new();
        let mut angles = vec![0.0_f64; self.vertices.len()];
        let mut meet = |ends: [usize; 2], a: DVec3, b: DVec3| {
            let angle = acos(a.dot(b).clamp(-1.0, 1.0));
            for end in ends {
                angles[end] = angles[end].max(angle);
            }
        };
        for face in &self.faces {
            let [a, b, c] = face.vertices;
            let normal = DVec3::from(face.normal);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let ends = [from.min(to), from.max(to)];
                match beside.remove(&ends) {
                    Some(other) => meet(ends, normal, other),
                    None => {
                        beside.insert(ends, normal);
                    }
                }
            }
        }
        // Edges of one face are the outline's and the inset's; beside the latter is the flat part.
        for (ends, normal) in beside {
            if ends.iter().all(|&end| is_inset[end]) {
                meet(ends, normal, DVec3::Z);
            }
        }
        for (vertex, angle) in self.vertices.iter_mut().zip(angles) {
            let share = ((angle - smooth) / smooth).clamp(0.0, 1.0);
            vertex.curvature = share * share * (3.0 - 2.0 * share);
        }
    }
}
