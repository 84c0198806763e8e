//! Triangles by halving squares, for outlines whose detail is no larger than some penumbra radii, such as icons.
//!
//! Densities are sampled on a square lattice, so and so many samples a penumbra radius. Squares of them are halved along a
//! diagonal, and the right triangles that result are halved again, from the right angle to the middle of the longest side,
//! wherever one leaves the [tube](tube::Tube) of what the tolerance allows about the samples. A side is halved for both of its
//! triangles or for neither, so all meet edge to edge (Evans, Kirkpatrick & Townsend 2001, "Right-triangulated irregular
//! networks").
//!
//! Neither the tangent construction nor a triangulator is needed: a mesh takes some hundred microseconds, and where detail is
//! small it has hardly more triangles than refinement's. Along long straight edges it has many more, so outlines with those are
//! left to refinement unless speed is asked for, and so are all that bend density between samples, such as a circle as large
//! as the disc.

mod halves;
mod tips;
mod tube;

use core::f64::consts::FRAC_2_PI;

use fearless_simd::{Simd, dispatch};
use glam::DVec2;

use self::halves::Halves;
use self::tips::Tip;
use self::tube::Tube;
use super::{MeshOptions, MeshQuality, MeshSink, MeshVertex, Profile};
use crate::density::{self, CURVES, Each, PixelOptions, direct};
use crate::error::Result;
use crate::grid::Grid;
use crate::plan::Method;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// The side of the squares that are halved first, in samples: two or three penumbra radii.
const SIDE: usize = 32;

/// Samples a penumbra radius at a tolerance of one level. Fewer leave so much unknown between them that triangles become as
/// small as they allow; more take longer for the same triangles.
const SAMPLES: f64 = 24.0;

/// So many times as many are tried, one after the other.
const FINER: [f64; 3] = [1.0, 1.5, 2.25];

/// The fewest at large tolerances.
const FEWEST: f64 = 18.0;

/// How long an outline's lines and curves are on average, at most, in penumbra radii: to refinement's triangles these are as
/// 1.6 to 1 then, and as 5 to 1 where they are five times as long.
const DETAIL: f64 = 2.0;

/// The largest extent of an outline, in penumbra radii, whatever its detail: beyond, refinement takes no longer.
const WIDEST: f64 = 32.0;

/// The most samples: a mesh that needs them takes as long as its refinement would.
const MOST: usize = 1 << 20;

/// Empty samples beside the shadow on every side, so that what lies between is seen from both.
const MARGIN: f64 = 2.0;

/// How far about a tip samples may know nothing of it, in samples.
const TIP: f64 = 1.5;

/// The part of the tolerance that samples may be off.
const SAMPLE_SHARE: f64 = 0.05;

/// The part of what is left of it that a triangle may be off at samples, and as far as they tell between them.
const SAMPLED: f64 = 0.96;

/// The part of the tolerance that rounding vertices may take.
const ROUNDING_SHARE: f64 = 0.02;

/// What this leaves from mesh to mesh: memory.
#[derive(Debug, Default)]
pub(crate) struct HalvingScratch {
    tube: Tube,
    halves: Halves,
    tips: Vec<Tip>,
    /// Each sample's number among the vertices.
    numbers: Vec<u32>,
    /// The samples that are vertices, by number.
    vertices: Vec<usize>,
}

/// Where the samples are.
#[derive(Debug, Clone, Copy)]
struct Lattice {
    /// The first sample, in scene units, and from each to the next.
    corner: DVec2,
    pitch: f64,
    /// Squares.
    squares: [usize; 2],
}

impl Lattice {
    /// About a shadow, so many samples a penumbra radius.
    fn of(shadow: &Shadow, samples: f64) -> Option<Self> {
        let radius = shadow.radius();
        let (min, max) = shadow.hull()?;
        if (max - min).max_element() > WIDEST * radius {
            return None;
        }
        let pitch = radius / samples;
        let reach = radius + MARGIN * pitch;
        let size = max - min + 2.0 * reach;
        let squares = (size / (pitch * SIDE as f64)).ceil();
        let lattice = Self {
            corner: min.midpoint(max) - squares * (0.5 * pitch * SIDE as f64),
            pitch,
            squares: [squares.x as usize, squares.y as usize],
        };
        let [columns, rows] = lattice.size();
        (columns * rows <= MOST).then_some(lattice)
    }

    /// Columns and rows of samples.
    fn size(&self) -> [usize; 2] {
        self.squares.map(|count| count * SIDE + 1)
    }

    /// The pixels whose centres they are.
    fn grid(&self) -> Grid {
        let [columns, rows] = self.size();
        Grid::of_centers(self.corner, [columns as u32, rows as u32], self.pitch)
    }

    /// Where the sample of a column and row is.
    fn place(&self, sample: [usize; 2]) -> DVec2 {
        self.corner + DVec2::from(sample.map(|at| at as f64)) * self.pitch
    }
}

/// Samples a penumbra radius, at first: at the penumbra's ends density goes with the power 1.5 of the distance.
fn samples(levels: f64) -> f64 {
    (SAMPLES / libm::cbrt(levels * levels)).max(FEWEST)
}

/// How many samples a shadow's mesh takes at least, unless its outline's detail is so large that refinement's triangles are much
/// fewer.
pub(crate) fn forecast(shadow: &Shadow, levels: f64) -> Option<usize> {
    let census = shadow.census();
    let detail = (census.line_length + census.arc_length) / census.pieces;
    let lattice =
        (detail <= DETAIL * shadow.radius()).then(|| Lattice::of(shadow, samples(levels)));
    lattice
        .flatten()
        .map(|lattice| lattice.size().iter().product())
}

/// Gives a sink the triangles of a shadow, if halving suits it: nothing is given otherwise.
pub(super) fn mesh(
    shadow: &Shadow,
    options: &MeshOptions,
    scratch: &mut Scratch,
    sink: &mut impl MeshSink,
) -> Result<Option<MeshQuality>> {
    let levels = options.tolerance.as_levels();
    let soft = options.profile == Profile::Disc && shadow.radius() > 0.0;
    if !soft || !(options.quick || forecast(shadow, levels).is_some()) {
        return Ok(None);
    }
    let samples = samples(levels);
    let mut kept = core::mem::take(&mut scratch.halving);
    let mut edges = scratch.take();
    shadow.edges_into(SAMPLE_SHARE * levels, 0.0, &mut edges);
    tips::find(&edges, shadow.radius(), &mut kept.tips);
    scratch.give(edges);
    let mut found = Ok(None);
    for finer in FINER {
        if let Some(lattice) = Lattice::of(shadow, finer * samples) {
            found = kept.mesh(shadow, options, &lattice, scratch, sink);
        }
        if !matches!(found, Ok(None)) {
            break;
        }
    }
    scratch.halving = kept;
    found
}

impl HalvingScratch {
    /// Gives a sink the triangles between samples, if these are near enough to one another.
    fn mesh(
        &mut self,
        shadow: &Shadow,
        options: &MeshOptions,
        lattice: &Lattice,
        scratch: &mut Scratch,
        sink: &mut impl MeshSink,
    ) -> Result<Option<MeshQuality>> {
        let levels = options.tolerance.as_levels();
        let far = lattice
            .corner
            .abs()
            .max(lattice.place(lattice.size()).abs());
        // Density changes by at most 2 / π over the radius.
        let rounding =
            255.0 * far.max_element() * f64::from(f32::EPSILON) * FRAC_2_PI / shadow.radius();
        if rounding > ROUNDING_SHARE * levels {
            return Ok(None);
        }
        let unsure = SAMPLE_SHARE * levels + direct::ROUNDING + rounding;
        let limit = SAMPLED * (levels - unsure) / 255.0;
        let height = |tip: &Tip| tip.height(lattice.pitch, shadow.radius());
        if self.tips.iter().any(|tip| height(tip) > limit) {
            return Ok(None);
        }
        let limit = limit as f32;
        let grid = lattice.grid();
        let pixels = PixelOptions {
            tolerance: options.tolerance.divided(CURVES / SAMPLE_SHARE),
            method: Some(Method::Direct),
            ..PixelOptions::default()
        };
        let densities = self.tube.begin(lattice.size());
        let mut samples = Each {
            pixels: densities,
            stride: grid.stride(),
            put: |sample: &mut f32, density: f32| *sample = (*sample + density).min(1.0),
        };
        density::draw(shadow, &grid, &pixels, scratch, &mut samples);
        let Self {
            tube, halves, tips, ..
        } = self;
        let fine = dispatch!(scratch.level(), simd => simd.vectorize(
            #[inline(always)]
            || tube.surround(limit),
        ));
        if !fine {
            return Ok(None);
        }
        for tip in tips {
            let place = (tip.center - lattice.corner) / lattice.pitch;
            tube.narrow(place, tip.miss / lattice.pitch + TIP, height(tip) as f32);
        }
        dispatch!(scratch.level(), simd => simd.vectorize(
            #[inline(always)]
            || halves.choose(tube),
        ));
        halves.collect(tube);
        self.number(lattice);
        if self.vertices.len() > options.max_vertices {
            return Ok(None);
        }
        sink.begin(self.vertices.len(), self.halves.triangles.len())?;
        let columns = lattice.size()[0];
        for &sample in &self.vertices {
            let place = [sample % columns, sample / columns];
            sink.vertex(MeshVertex {
                position: lattice.place(place).as_vec2().to_array(),
                density: self.tube.at(place),
            });
        }
        for corners in &self.halves.triangles {
            sink.triangle(corners.map(|sample| self.numbers[sample as usize]));
        }
        Ok(Some(MeshQuality {
            error_levels: levels,
            complete: true,
        }))
    }

    /// Numbers the samples that are corners of triangles, in the order in which they come.
    fn number(&mut self, lattice: &Lattice) {
        const NONE: u32 = u32::MAX;
        self.numbers.clear();
        self.numbers.resize(lattice.size().iter().product(), NONE);
        self.vertices.clear();
        for &corner in self.halves.triangles.iter().flatten() {
            let number = &mut self.numbers[corner as usize];
            if *number == NONE {
                *number = self.vertices.len() as u32;
                self.vertices.push(corner as usize);
            }
        }
    }
}
