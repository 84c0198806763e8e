//! Triangles over which linear interpolation of density stays within a tolerance.
//!
//! Rounded rectangles and circles are strips between rings, which need no triangulator, and so are [gentle convex
//! curves](gentle). Outlines of small detail, such as
//! icons, are [halved squares](halving), and so is whatever is to be there [quickly](MeshOptions::quick). For all other outlines,
//! and where nothing of that was found, the tangent construction gives the skeleton: rings from the penumbra's outer edge to the
//! umbra, at the distances that suit the profile best. Between them and inside of the umbra a constrained Delaunay triangulation
//! (spade); where the result is still wrong, as at corners and where there is no umbra, vertices are added until it is not, and then
//! those are taken away that it does without. Shadows without a penumbra are filled by lyon.
//!
//! The tangent construction follows US 9,639,976; quick meshes, pixels ([`Shadow::fill_a8`]) and point queries do not use it.

mod cache;
mod cells;
mod compact;
mod donut;
mod export;
mod field;
mod gentle;
mod gouraud;
pub(crate) mod halving;
mod lighten;
mod measure;
mod options;
mod profile;
mod refine;
pub(crate) mod regions;
mod samples;
mod search;
mod settle;
mod sink;
pub(crate) mod strips;
pub(crate) mod tangents;
mod thin;
mod tilted;
mod triangles;
mod umbra;

use core::f64::consts::{FRAC_2_PI, PI};

use glam::DVec2;

pub use cache::{CachedMesh, MeshCache};
use cells::Cells;
pub use compact::{CompactMesh, CompactVertex};
pub use export::meshes_to_svg;
use field::Field;
use lighten::lighten;
use options::Effort;
pub use options::MeshOptions;
pub use profile::Profile;
use profile::{Knot, Pieces};
use refine::Refinement;
#[cfg(feature = "lyon")]
pub use sink::LyonBuffers;
pub use sink::{MeshBuffers, MeshIndex, MeshSink, MeshSlices};
use strips::Strips;
use tangents::{ProjectionCircle, tangent_loops};
pub use triangles::{Incomplete, MeshQuality, MeshVertex, ShadowMesh};

use crate::apart::around_points;
use crate::error::Result;
use crate::outline::{Edge, Outline};
use crate::scratch::Scratch;
use crate::shadow::{Bounds, Shadow};

impl Shadow {
    /// Triangles with a density at each vertex, within the tolerance of the exact density wherever they are interpolated
    /// and outside of them, unless the mesh says that it is not [complete](ShadowMesh::is_complete). With penumbra radius 0
    /// they fill the outline, with chords within 1e-5 of its extent, and the error is that of no penumbra: none.
    ///
    /// The density is that of points, no average over pixels: where a penumbra is narrower than some 3 pixels a GPU needs several samples
    /// a pixel for edges that are not jagged.
    ///
    /// ```
    /// use penumbral::{Light, Shape, Tolerance};
    ///
    /// let card = Shape::rounded_rect(16.0, 100.0, 300.0, 200.0, 12.0)?;
    /// let shadow = Light::android(400.0)?.cast(&card, 8.0, 0.0)?;
    /// let mesh = shadow.mesh(Tolerance::levels(4.0)?);
    /// assert!(mesh.error_levels() <= 4.0);
    /// # Ok::<(), penumbral::Error>(())
    /// ```
    #[must_use]
    pub fn mesh(&self, options: impl Into<MeshOptions>) -> ShadowMesh {
        self.mesh_with(&options.into(), &mut Scratch::new())
    }

    /// The mesh, with the corners that a scratch keeps.
    fn mesh_with(&self, options: &MeshOptions, scratch: &mut Scratch) -> ShadowMesh {
        let mut buffers = MeshBuffers::new();
        match self.patterned(options, scratch, &mut buffers) {
            Ok(Some(quality)) => ShadowMesh::filled(buffers, quality),
            _ => self.unpatterned(options, scratch),
        }
    }

    /// The mesh by triangulation; of parts that do not meet one mesh after another: each is what suits it, however many there are.
    fn unpatterned(&self, options: &MeshOptions, scratch: &mut Scratch) -> ShadowMesh {
        if self.apart().is_empty() {
            return self.triangulated(options);
        }
        let mut all = ShadowMesh::empty();
        let mut options = *options;
        for part in self.apart() {
            let mesh = part.mesh_with(&options, scratch);
            options.max_vertices = options.max_vertices.saturating_sub(mesh.vertices.len());
            all.append(mesh);
        }
        all
    }

    /// Gives the triangles of [`Shadow::mesh`] to a sink.
    ///
    /// Nothing is allocated once `scratch` and the sink have grown, for rounded rectangles and circles wherever they are,
    /// whatever the lengths between corners that do not feel each other and while these stay about as round over the penumbra
    /// radius, and for other shadows that stay as and where they are: of these it keeps the last sixteen. Where more of them come
    /// again, or move, a [`MeshCache`] keeps them.
    ///
    /// # Errors
    /// What the sink refuses, before it is given anything.
    pub fn mesh_into(
        &self,
        sink: &mut impl MeshSink,
        options: impl Into<MeshOptions>,
        scratch: &mut Scratch,
    ) -> Result<MeshQuality> {
        let options = options.into();
        if let Some(quality) = self.patterned(&options, scratch, sink)? {
            return Ok(quality);
        }
        let mesh = scratch.meshes.same(self, &options, || {
            self.unpatterned(&options, &mut Scratch::new())
        });
        sink.begin(mesh.vertices.len(), mesh.indices.len() / 3)?;
        for &vertex in &mesh.vertices {
            sink.vertex(vertex);
        }
        for &corners in mesh.indices.as_chunks().0 {
            sink.triangle(corners);
        }
        Ok(MeshQuality::new(mesh.error_levels, mesh.incomplete))
    }

    /// The mesh without a triangulation, if the shadow is one of those that do without: not of several parts, each of which may be.
    fn patterned(
        &self,
        options: &MeshOptions,
        scratch: &mut Scratch,
        sink: &mut impl MeshSink,
    ) -> Result<Option<MeshQuality>> {
        if !self.apart().is_empty() {
            return Ok(None);
        }
        match options.effort {
            Effort::Few => Ok(None),
            Effort::Quick => match halving::mesh(self, options, scratch, sink)? {
                None => self.strips(options, scratch, sink),
                found => Ok(found),
            },
            Effort::Usual => match self.strips(options, scratch, sink)? {
                None => halving::mesh(self, options, scratch, sink),
                found => Ok(found),
            },
        }
    }

    /// The mesh by triangulation, or in strips along a gentle curve; of whichever has fewer triangles where few are asked for.
    fn triangulated(&self, options: &MeshOptions) -> ShadowMesh {
        let gentle = self.gentle(options);
        if options.effort != Effort::Few {
            return gentle.unwrap_or_else(|| self.refined(options));
        }
        let mut strips = MeshBuffers::new();
        let strips = match self.strips(options, &mut Scratch::new(), &mut strips) {
            Ok(Some(quality)) => Some(ShadowMesh::filled(strips, quality)),
            _ => None,
        };
        let refined = self.refined(options);
        let all = gentle.into_iter().chain(strips).chain([refined]);
        let size = |mesh: &ShadowMesh| (!mesh.is_complete(), mesh.indices.len());
        all.min_by_key(size).unwrap_or_else(ShadowMesh::empty)
    }

    /// The mesh in strips, if the shadow is one of those that have them.
    fn strips(
        &self,
        options: &MeshOptions,
        scratch: &mut Scratch,
        sink: &mut impl MeshSink,
    ) -> Result<Option<MeshQuality>> {
        let radius = self.radius();
        let disc = options.profile == Profile::Disc && radius > 0.0;
        let Some(rounded) = self.rounded().filter(|_| disc) else {
            return Ok(None);
        };
        let step = step(rounded.min, rounded.max);
        let Some(strips) = Strips::of(&rounded, radius) else {
            return Ok(None);
        };
        let levels = options.tolerance.as_levels();
        let rounding = rounding_levels(step, radius);
        // In powers of two, so that shadows at other places go by the same template.
        let share = if rounding > levels * ROUNDING_SHARE {
            2.0 * power_of_two_below(rounding)
        } else {
            levels * ROUNDING_SHARE
        };
        if share > levels * MOST_ROUNDING {
            return Ok(None);
        }
        let error = strips.mesh(
            levels - share,
            step,
            options.max_vertices,
            &mut scratch.meshes.strips,
            sink,
        )?;
        Ok(error.map(|error| MeshQuality::new(error + rounding, None)))
    }

    /// The mesh by triangulation and refinement.
    fn refined(&self, options: &MeshOptions) -> ShadowMesh {
        let mut options = *options;
        let levels = options.tolerance.as_levels();
        let radius = self.radius();
        let facet = self.extent() * FACET;
        let flat = if radius == 0.0 {
            facet
        } else {
            ring_flatness(radius, levels)
        };
        let outline = self.outline(flat);
        let Some((min, max)) = outline.bounds() else {
            return ShadowMesh::empty();
        };
        // Far from the origin the triangulations would lose digits. From a centre that `f32` holds, positions that it
        // holds have exact differences.
        let center = min.midpoint(max).as_vec2().as_dvec2();
        let outline = outline.moved(-center);
        if radius == 0.0 {
            return umbra::mesh(&outline.polygons(facet), center);
        }
        let step = step(min, max);
        if radius < step * NARROWEST {
            // `f32` has no room for the rings of such a penumbra: a hard edge is half of density away from it, and at the
            // tip of a sharp corner all.
            return umbra::mesh(&outline.polygons(facet), center).short_of(Incomplete::Narrow);
        }

        // What rounding leaves nothing of is refined as far as it leaves some.
        let rounding = rounding_levels(step, radius);
        let is_coarser = rounding > levels * REFINED_ROUNDING;
        if is_coarser {
            options.tolerance = options
                .tolerance
                .divided(levels * REFINED_ROUNDING / rounding);
        }
        let levels = options.tolerance.as_levels();
        let pieces = pieces(levels, rounding);
        let mut flat = ring_flatness(radius, levels);
        loop {
            let circles = projection_circles(&outline, radius, flat);
            let count = circles.iter().map(Vec::len).sum::<usize>() * pieces.knots.len();
            // A penumbra that is very narrow for its outline has too many vertices from the start: coarser rings leave
            // refinement room, and what error remains is reported.
            if 2 * count > options.max_vertices && flat < facet {
                flat *= 4.0;
                continue;
            }
            let loops = |knot: &Knot| (*knot, tangent_loops(&circles, knot.t, flat));
            let rings = pieces.knots.iter().map(loops).collect();
            let (field, unsure) = self.field(&outline, levels, center);
            let mut mesh = Refinement::new(field, options, rings).run(center, step, unsure);
            if flat > ring_flatness(radius, levels) {
                mesh.incomplete = mesh.incomplete.and(Some(Incomplete::Vertices));
            }
            if is_coarser {
                mesh.incomplete = mesh.incomplete.or(Some(Incomplete::Narrow));
            }
            return mesh;
        }
    }
}

impl Shadow {
    /// What errors are measured against, about a centre, and by how much (density) it may itself be off.
    fn field(&self, outline: &Outline, levels: f64, center: DVec2) -> (Field, f64) {
        let radius = self.radius();
        let share = FIELD_SHARE * levels;
        let curved = !self.is_fixed() || outline.edges().any(|e| matches!(e, Edge::Arc(_)));
        let unsure = if curved { CURVED * share / 255.0 } else { 0.0 } + cells::NOISE;
        let mut loops = self.polygons_within(share, 0.0);
        // What is left out of many at once adds up.
        let lighter = share / self.crowding(0.0, true) / 255.0;
        for points in &mut loops {
            for point in &mut *points {
                *point -= center;
            }
            *points = lighten(points, radius, lighter);
        }
        (Field::Level(Cells::new(&loops, radius)), unsure)
    }
}

impl Shadow {
    /// The smallest box that holds the umbra, or none where the light is nowhere wholly hidden. Of paths it takes milliseconds, and for
    /// detailed ones under a wide penumbra more.
    #[must_use]
    pub fn umbra_bounds(&self) -> Option<Bounds> {
        let outline = self.exact_outline();
        let (min, max) = outline.bounds()?;
        if self.radius() == 0.0 {
            return Some(Bounds::outwards(min, max));
        }
        // The light is hidden where a disc is within the outline: there is none in a smaller one.
        let disc = PI * self.radius() * self.radius();
        if outline.area() < disc || (max - min).min_element() < 2.0 * self.radius() {
            return None;
        }
        let center = min.midpoint(max);
        let flat = (self.radius() * UMBRA_FLATNESS).max(self.extent() * UMBRA_FACET);
        let circles = projection_circles(&outline.moved(-center), self.radius(), flat);
        let loops = tangent_loops(&circles, 1.0, flat);
        let (min, max) = around_points(loops.into_iter().flatten())?;
        Some(Bounds::outwards(min + center, max + center))
    }
}

/// Vertices nearer to one another than this, over the penumbra radius, are one: where paths cross they come twice, a rounding error apart,
/// and the line from one to the other leads anywhere.
const ONE_VERTEX: f64 = 1e-9;

/// The circles round the vertices of an outline that is seen through one radius everywhere.
fn projection_circles(outline: &Outline, radius: f64, flatness: f64) -> Vec<Vec<ProjectionCircle>> {
    let circle = |center| ProjectionCircle { center, radius };
    let is_one = |a: DVec2, b: DVec2| (a - b).length() <= ONE_VERTEX * radius;
    let mut polygons = outline.polygons(flatness);
    for points in &mut polygons {
        points.dedup_by(|next, point| is_one(*next, *point));
        while let [first, .., last] = points[..]
            && is_one(first, last)
        {
            points.pop();
        }
    }
    polygons
        .into_iter()
        .map(|points| points.into_iter().map(circle).collect())
        .collect()
}

/// How far the chords of an umbra's arcs may be from them, over the penumbra radius.
const UMBRA_FLATNESS: f64 = 1e-4;

/// The same over the outline's extent, where the radius is next to nothing.
const UMBRA_FACET: f64 = 1e-7;

/// The part of the tolerance that a strip of chords across a disc, and lines in place of runs of them, may each use up where
/// errors are measured.
const FIELD_SHARE: f64 = 0.02;

/// Both of them, and the strips all along the disc's edge where a circle is as large as the disc: π times one across.
const CURVED: f64 = 4.2;

/// The part of the tolerance that straight pieces of the profile may use. Were it all, as with five pieces for one level,
/// corners would need three times the triangles for the thousandths that are left.
const SLACK: f64 = 0.85;

/// How far chords of rings may be from their arcs, over the penumbra radius and a tolerance of one level. Refinement mends
/// what is too coarse: half of it took a tenth more triangles, twice as much no fewer.
const RING_FLATNESS: f64 = 0.01;

/// The straight pieces of the profile of rings whose vertices are rounded by so many levels.
fn pieces(levels: f64, rounding: f64) -> &'static Pieces {
    let taken = if rounding > levels * SPARE {
        TAKEN * rounding
    } else {
        0.0
    };
    Pieces::within((levels - taken) / 255.0 * SLACK)
}

fn ring_flatness(radius: f64, levels: f64) -> f64 {
    radius * (RING_FLATNESS * levels).min(COARSEST_RING)
}

/// The same at large tolerances: beyond, rings could cross.
const COARSEST_RING: f64 = 0.02;

/// How far `f32` may tell places of a box apart.
fn step(min: DVec2, max: DVec2) -> f64 {
    min.abs().max(max.abs()).max_element() * f64::from(f32::EPSILON)
}

/// The narrowest penumbra that is drawn, in steps of `f32` at its coordinates.
const NARROWEST: f64 = 64.0;

/// The part of the tolerance that strips leave to the rounding of their vertices, and the most that they do where that takes more: a
/// triangulation would take a hundred times as long.
const ROUNDING_SHARE: f64 = 1.0 / 256.0;
const MOST_ROUNDING: f64 = 0.25;

/// The most of the tolerance that the rounding of vertices may be where triangles are refined.
const REFINED_ROUNDING: f64 = 0.5;

/// What it may take that straight pieces of the profile need not make up for.
const SPARE: f64 = 1.0 / 32.0;

/// What they make up for, over it: with all else that is taken of the tolerance as much as before is left beside them.
const TAKEN: f64 = 1.2;

/// How wrong densities may be for coordinates that are rounded to `f32`, which tells places a `step` apart, in levels: density changes by
/// at most 2 / π over the penumbra radius.
fn rounding_levels(step: f64, radius: f64) -> f64 {
    255.0 * step * FRAC_2_PI / radius
}

/// The power of two at or below a number above 0: that without its fraction bits.
fn power_of_two_below(value: f64) -> f64 {
    f64::from_bits(value.to_bits() >> 52 << 52)
}

/// How far the chords of a hard shadow's arcs may be from them, over its extent.
const FACET: f64 = 1e-5;

/// A closed loop of vertices at one distance from the outline.
type Ring = (Knot, Vec<Vec<DVec2>>);
