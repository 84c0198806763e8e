//! Triangles between the rings, and more of them where interpolation is still wrong.
//!
//! Where an edge is straight the rings' values balance the error and nothing is added. Elsewhere each round samples
//! every new triangle and adds a vertex at its worst point, most wrong first, until none is wrong by more than the
//! tolerance.

use core::f64::consts::FRAC_2_PI;
use std::collections::HashMap;

use glam::DVec2;
use spade::handles::{FixedUndirectedEdgeHandle, FixedVertexHandle, VertexHandle};
use spade::{FloatTriangulation, Point2, Triangulation, mitigate_underflow};

use super::field::Field;
use super::measure::{Assessment, Measure};
use super::profile::{Knot, Profile};
use super::regions::{Face, Region, Triangles, Vertex, faces};
use super::settle::settle;
use super::thin::{Corner, TRIED, Thinning, Triangle};
use super::{Effort, Incomplete, MeshOptions, MeshVertex, ShadowMesh};
use crate::outline::sides;

/// Rounds of refinement at most. Each halves the larger triangles: the finest tolerance takes about 12; but the last vertices between a
/// comb's teeth came one a round, and 40 were too few.
const ROUNDS: usize = 200;

/// Vertices nearer to a ring than this, over the penumbra radius, are put on it.
const BESIDE: f64 = 1e-3;

/// Vertices are not added nearer to another than this, over the penumbra radius: nothing would be gained. Slivers along a
/// ring are wrong nearer to their vertices than they should be.
const NEAREST: f64 = 5e-5;

/// The least distance of a triangle's corners from its middle, over the radius, for what is worst at them to be worth a vertex there.
const LARGE: f64 = 0.25;

/// The part of the tolerance that an error found by sampling may reach: the tops between samples are sought, but could be
/// missed.
const SAMPLED: f64 = 0.97;

/// How far away the frame about the shadow is, over the shadow's reach.
const FRAME: f64 = 4.0;

/// The part of the tolerance that is left to interpolation at least, however little rounding leaves: what is above the
/// tolerance then is reported.
const LEAST_SHARE: f64 = 0.25;

/// A closed loop of vertices at one distance from the outline.
pub(super) type Ring = (Knot, Vec<Vec<DVec2>>);

pub(super) struct Refinement {
    measure: Measure,
    options: MeshOptions,
    triangles: Triangles,
    /// Whether a part of a ring could not be built: what lies on which side of it is not known then.
    broken: bool,
    /// For each ring, by how much its vertices differ from the density where they are, to balance errors.
    offsets: Vec<f64>,
    assessed: HashMap<[usize; 3], Assessment>,
}

impl Refinement {
    pub(super) fn new(field: Field, options: MeshOptions, rings: Vec<Ring>) -> Self {
        Self::of(Measure::new(field, options.profile), options, rings)
    }

    /// Whether rings cross, so that a part of one could not be built.
    pub(super) fn is_broken(&self) -> bool {
        self.broken
    }

    /// The same with other rings.
    pub(super) fn with_rings(self, rings: Vec<Ring>) -> Self {
        Self::of(self.measure, self.options, rings)
    }

    fn of(measure: Measure, options: MeshOptions, rings: Vec<Ring>) -> Self {
        let offset = |ring: &Ring| match options.profile {
            Profile::Disc => ring.0.value - Profile::Disc.at(ring.0.t),
            _ => 0.0,
        };
        let mut refinement = Self {
            measure,
            options,
            triangles: Triangles::new(),
            broken: false,
            offsets: rings.iter().map(offset).collect(),
            assessed: HashMap::new(),
        };
        for (index, (_, loops)) in rings.iter().enumerate() {
            for points in loops {
                let handles: Vec<_> = points
                    .iter()
                    .filter_map(|&point| refinement.insert(point, Some(index)))
                    .collect();
                for (from, to) in sides(&handles) {
                    refinement.constrain(from, to);
                }
            }
        }
        refinement
    }

    /// The mesh, its vertices moved by `center`, where positions in `f32` are up to `rounding` off and the field is up to
    /// `unsure` (density).
    pub(super) fn run(mut self, center: DVec2, rounding: f64, unsure: f64) -> ShadowMesh {
        // Density changes by at most 2 / π over the radius.
        let noise = unsure + rounding * FRAC_2_PI / self.measure.radius();
        let tolerance = self.options.tolerance.as_levels() / 255.0;
        let limit = SAMPLED * (tolerance - noise).max(LEAST_SHARE * tolerance);
        let mut stopped = Incomplete::Rounds;
        for _ in 0..ROUNDS {
            let faces = self.faces(Region::Penumbra);
            let mut wrong = self.wrong(&faces, limit, false);
            if wrong.is_empty() {
                wrong = self.wrong(&faces, limit, true);
            }
            wrong.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            let before = self.triangles.num_vertices();
            for &(_, key) in &wrong {
                if self.triangles.num_vertices() >= self.options.max_vertices {
                    break;
                }
                self.mend(key, limit);
            }
            // Where all that is wrong is worst at its corners: a tilted caster's shadow begins in a point with all densities.
            if self.triangles.num_vertices() == before && before < self.options.max_vertices {
                for &(_, key) in &wrong {
                    self.split(key);
                }
            }
            if self.triangles.num_vertices() == before {
                stopped = if before >= self.options.max_vertices {
                    Incomplete::Vertices
                } else {
                    Incomplete::Narrow
                };
                break;
            }
        }
        if self.broken {
            stopped = Incomplete::Edges;
        }
        self.finish(center, limit, noise, rounding, stopped)
    }

    /// The faces that are wrong by more than `limit` where a vertex would mend it, as far as sampled or surely.
    fn wrong(&mut self, faces: &[Face], limit: f64, surely: bool) -> Vec<(f64, [usize; 3])> {
        let mut wrong = Vec::new();
        for &face in faces {
            let (key, assessment) = self.assess(face, surely, limit);
            if assessment.error > limit {
                wrong.push((assessment.error, key));
            }
        }
        wrong
    }

    fn insert(&mut self, point: DVec2, ring: Option<usize>) -> Option<FixedVertexHandle> {
        let last = self.offsets.len() - 1;
        let density = match ring {
            Some(0) => 0.0,
            Some(ring) if ring == last => self.measure.umbra(),
            _ => {
                let offset = ring.map_or(0.0, |ring| self.offsets[ring]);
                (self.measure.target(point) + offset).clamp(0.0, 1.0)
            }
        };
        let position = mitigate_underflow(Point2::new(point.x, point.y));
        self.triangles
            .insert(Vertex {
                position,
                density,
                ring,
            })
            .ok()
    }

    fn constrain(&mut self, from: FixedVertexHandle, to: FixedVertexHandle) {
        if from != to {
            let added = self.triangles.try_add_constraint(from, to);
            self.broken |= added.is_empty() && !self.triangles.exists_constraint(from, to);
        }
    }

    fn faces(&self, wanted: Region) -> Vec<Face> {
        faces(&self.triangles, self.offsets.len() - 1, wanted)
    }

    fn assess(&mut self, face: Face, surely: bool, limit: f64) -> ([usize; 3], Assessment) {
        let corners = self
            .triangles
            .face(face)
            .vertices()
            .map(|vertex| vertex.fix());
        let key = corners.map(|corner| corner.index());
        let known = self.assessed.get(&key).copied();
        if let Some(known) = known.filter(|known| known.sure || !surely) {
            return (key, known);
        }
        let data = corners.map(|corner| *self.triangles.vertex(corner).data());
        let at = data.map(|vertex| DVec2::new(vertex.position.x, vertex.position.y));
        let densities = data.map(|vertex| vertex.density);
        let last = self.offsets.len() - 1;
        // Along the two edges of the penumbra density is 0 and 1 by definition: what is wrong there is their arcs'
        // flattening, and no vertex on the chord mends it.
        let fixed = [0, 1, 2].map(|opposite: usize| {
            let (a, b) = ((opposite + 1) % 3, (opposite + 2) % 3);
            data[a].ring == data[b].ring
                && (data[a].ring == Some(0) || data[a].ring == Some(last))
                && self.triangles.exists_constraint(corners[a], corners[b])
        });
        let result = self.measure.assess(at, densities, fixed, surely, limit);
        self.assessed.insert(key, result);
        (key, result)
    }

    /// Adds a vertex at a triangle's worst point, unless vertices added since have mended it.
    fn mend(&mut self, key: [usize; 3], limit: f64) {
        let [beside, nearest] = [BESIDE, NEAREST].map(|share| share * self.measure.radius());
        let Some(&assessment) = self.assessed.get(&key) else {
            return;
        };
        let corners = key.map(FixedVertexHandle::from_index);
        let untouched = self.is_face(corners);
        if !untouched && self.error_at(assessment.worst) <= limit {
            return;
        }
        let is_near = |handle| (self.place(handle) - assessment.worst).length() < nearest;
        match self.constraint_near(assessment.worst, beside) {
            Some((from, to, edge)) => {
                // A vertex beside a constraint by a rounding error would leave a triangle of no area: the constraint is
                // taken away first and led by way of the vertex after.
                let last = self.offsets.len() - 1;
                let ring = self.triangles.vertex(from).data().ring;
                if ring == Some(0) || ring == Some(last) || is_near(from) || is_near(to) {
                    return;
                }
                let start = self.place(from);
                let way = self.place(to) - start;
                let share = (assessment.worst - start).dot(way) / way.length_squared();
                self.triangles.remove_constraint_edge(edge);
                if let Some(vertex) = self.insert(start + way * share, ring) {
                    self.constrain(from, vertex);
                    self.constrain(vertex, to);
                }
            }
            None if corners.into_iter().any(is_near) => {}
            None => {
                self.insert(assessment.worst, None);
            }
        }
    }

    /// Adds a vertex in the middle of a triangle, if it is still one and large enough.
    fn split(&mut self, key: [usize; 3]) {
        let corners = key.map(FixedVertexHandle::from_index);
        if !self.is_face(corners) {
            return;
        }
        let at = corners.map(|corner| self.place(corner));
        let middle = at.iter().sum::<DVec2>() / 3.0;
        let least = LARGE * self.measure.radius();
        if at.iter().all(|corner| (*corner - middle).length() >= least) {
            self.insert(middle, None);
        }
    }

    fn place(&self, vertex: FixedVertexHandle) -> DVec2 {
        let position = self.triangles.vertex(vertex).position();
        DVec2::new(position.x, position.y)
    }

    /// Whether three vertices are one of the triangles, in their order.
    fn is_face(&self, [a, b, c]: [FixedVertexHandle; 3]) -> bool {
        let edge = self.triangles.get_edge_from_neighbors(a, b);
        edge.is_some_and(|edge| edge.next().to().fix() == c)
    }

    /// The constraint that passes a point within `distance`, if one does.
    fn constraint_near(
        &self,
        point: DVec2,
        distance: f64,
    ) -> Option<(
        FixedVertexHandle,
        FixedVertexHandle,
        FixedUndirectedEdgeHandle,
    )> {
        // Slivers may lie between: the faces at the point alone do not tell.
        let center = Point2::new(point.x, point.y);
        let edges = self
            .triangles
            .get_edges_in_circle(center, distance * distance);
        let near = edges
            .filter(|edge| edge.is_constraint_edge())
            .map(|edge| (edge.distance_2(center), edge));
        let (_, edge) = near.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let [from, to] = edge.vertices().map(|vertex| vertex.fix());
        Some((from, to, edge.fix()))
    }

    /// The difference at a point in the triangulation as it is now.
    fn error_at(&mut self, point: DVec2) -> f64 {
        use spade::PositionInTriangulation::{OnEdge, OnFace};
        let position = Point2::new(point.x, point.y);
        let corners: Vec<Vertex> = match self.triangles.locate(position) {
            OnFace(face) => self
                .triangles
                .face(face)
                .vertices()
                .map(|v| *v.data())
                .to_vec(),
            OnEdge(edge) => self
                .triangles
                .directed_edge(edge)
                .vertices()
                .map(|v| *v.data())
                .to_vec(),
            _ => return 0.0,
        };
        let at = |vertex: &Vertex| DVec2::new(vertex.position.x, vertex.position.y) - point;
        let density = match corners.as_slice() {
            [a, b, c] => {
                let weights = [(b, c), (c, a), (a, b)].map(|(v, w)| at(v).perp_dot(at(w)));
                let sum: f64 = weights.iter().sum();
                (weights[0] * a.density + weights[1] * b.density + weights[2] * c.density) / sum
            }
            [a, b] => {
                let share = at(a).length() / (at(b) - at(a)).length();
                a.density + (b.density - a.density) * share
            }
            _ => return 0.0,
        };
        (density - self.measure.target(point)).abs()
    }

    /// The mesh, which is short of its tolerance, if it is, for why refinement `stopped`.
    fn finish(
        mut self,
        center: DVec2,
        limit: f64,
        noise: f64,
        rounding: f64,
        stopped: Incomplete,
    ) -> ShadowMesh {
        let mut mesh = ShadowMesh::empty();
        let (corners, triangles) = self.all(limit);
        let mut thinning = Thinning::new(&mut self.measure, limit, rounding, corners, triangles);
        match self.options.effort {
            _ if self.broken => {}
            Effort::Quick => {}
            Effort::Usual => thinning.run(TRIED),
            Effort::Few => thinning.run_long(),
        }
        // In `f32` vertices of small penumbrae may come to lie on one another: they become one, and triangles between them
        // nothing.
        let mut merged: HashMap<[u32; 2], u32> = HashMap::new();
        let mut own = |corner: &Corner| {
            let position = (corner.at + center).as_vec2().to_array();
            *merged.entry(position.map(f32::to_bits)).or_insert_with(|| {
                mesh.vertices.push(MeshVertex {
                    position,
                    density: corner.density as f32,
                });
                mesh.vertices.len() as u32 - 1
            })
        };
        let (mut error, mut complete) = (thinning.cut, !self.broken);
        let mut triangles = Vec::new();
        for triangle in thinning.triangles() {
            error = error.max(triangle.exact_error);
            complete &= triangle.error <= limit;
            if triangle.region != Region::Outside {
                triangles.push(
                    triangle
                        .corners
                        .map(|corner| own(&thinning.corners[corner])),
                );
            }
        }
        error = error / SAMPLED + noise;
        mesh.error_levels = if self.broken {
            255.0
        } else {
            255.0 * error.min(1.0)
        };
        let kept = mesh.error_levels <= self.options.tolerance.as_levels();
        complete &= kept || self.options.profile != Profile::Disc;
        mesh.incomplete = (!complete).then_some(stopped);
        mesh.indices = settle(&mesh.vertices, triangles);
        mesh
    }

    /// The triangles of the whole plane about the shadow, within a frame.
    fn all(&mut self, limit: f64) -> (Vec<Corner>, Vec<Triangle>) {
        let reach = self.triangles.vertices().map(|vertex| {
            let at = vertex.position();
            at.x.abs().max(at.y.abs())
        });
        let far = FRAME * reach.fold(self.measure.radius(), f64::max);
        for [x, y] in [[-far, -far], [far, -far], [far, far], [-far, far]] {
            self.insert(DVec2::new(x, y), Some(0));
        }
        let corner = |vertex: VertexHandle<'_, _, _, _, _>| {
            let Vertex {
                position, density, ..
            } = *vertex.data();
            Corner::new(DVec2::new(position.x, position.y), density)
        };
        let corners = self.triangles.vertices().map(corner).collect();
        let umbra = 1.0 - self.measure.umbra();
        let mut all = Vec::new();
        for region in [Region::Penumbra, Region::Umbra, Region::Outside] {
            for face in self.faces(region) {
                let vertices = self.triangles.face(face).vertices();
                let corners = vertices.map(|vertex| vertex.fix().index());
                let (error, exact_error) = match region {
                    Region::Penumbra => {
                        let (_, assessment) = self.assess(face, true, limit);
                        (assessment.error, assessment.exact_error)
                    }
                    Region::Umbra => (0.0, umbra),
                    Region::Outside => (0.0, 0.0),
                };
                all.push(Triangle {
                    corners,
                    region,
                    error,
                    exact_error,
                });
            }
        }
        (corners, all)
    }
}
