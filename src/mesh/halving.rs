//! Triangles by halving squares, for outlines whose detail is no larger than some penumbra radii, such as icons.
//!
//! Densities are sampled on a square lattice, so and so many samples a penumbra radius, and in the middle between four samples each,
//! which no sample tells of where ends of penumbrae bend density to both sides; where density bends too much for that, it is sampled
//! at [half the distance](finer). Squares of samples are halved along a
//! diagonal, and the right triangles that result are halved again, from the right angle to the middle of the longest side,
//! wherever one leaves the [tube](tube::Tube) of what the tolerance allows about the samples. A side is halved for both of its
//! triangles or for neither, so all meet edge to edge (Evans, Kirkpatrick & Townsend 2001, "Right-triangulated irregular
//! networks").
//!
//! Neither the tangent construction nor a triangulator is needed: a mesh takes some hundred microseconds. Sides along the axes are [folded away](folds::Folds) where they are long;
//! along others and about large corners there are many more triangles, so such outlines are left to refinement unless speed is
//! asked for, and so are all that bend density between samples too much, such as a circle as large as the disc.

mod finer;
mod folds;
mod halves;
mod tips;
mod tube;

use fearless_simd::{Simd, dispatch};
use glam::DVec2;

use self::finer::{Finer, KINDS, Spot, spot_key, spot_of};
use self::folds::{Folds, Sides};
use self::halves::Halves;
use self::tips::Tip;
use self::tube::Tube;
use super::rounding::{rounding_levels, step};
use super::{Effort, MeshOptions, MeshQuality, MeshSink, MeshVertex, Profile};
use crate::density::tiles::{self, Lattice, Tiles};
use crate::error::Result;
use crate::outline::{self, Edge};
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// The side of the squares that are halved first, in samples: two or three penumbra radii.
const SIDE: usize = 32;

/// Samples a penumbra radius at a tolerance of one level. Fewer leave so much unknown between them that triangles become as
/// small as they allow; more take longer for the same triangles.
const SAMPLES: f64 = 22.0;

/// How often a lattice is laid: one that shows too little of what lies between its samples tells how much finer the next has to be,
/// so many times at least.
const LATTICES: u32 = 4;
const FINER: f64 = 1.05;

/// How many times as near to one another samples are where there are some between them.
const TWICE: f64 = 2.0;

/// How many times as many samples a penumbra radius are tried at most, and how many times as many from try to try where tips
/// are hidden.
const FINEST: f64 = 4.0;
const FINER_FOR_TIPS: f64 = 1.25;

/// The fewest at large tolerances.
const FEWEST: f64 = 18.0;

/// How long an outline's lines and curves are on average, at most, in penumbra radii: to refinement's triangles, before these are
/// thinned, there are 1.6 to 1 then, and 5 to 1 where they are five times as long.
const DETAIL: f64 = 2.0;

/// The largest extent of an outline, in penumbra radii, whatever its detail: beyond, refinement takes no longer.
const WIDEST: f64 = 32.0;

/// The least extent of an outline that is folded, in penumbra radii.
const FOLDED: f64 = 3.0;

/// The most samples: a mesh that needs them takes as long as its refinement would.
const MOST: usize = 1 << 20;

/// Empty samples beside the shadow on every side, so that what lies between is seen from both.
const MARGIN: f64 = 2.0;

/// The part of the tolerance that samples may be off.
const SAMPLE_SHARE: f64 = 0.05;

/// How much of the largest bend between samples may be elsewhere as well, where samples show less of it, at a tolerance of one level:
/// where two ends of penumbrae nearly coincide, density goes with the power 0.5 of the distance. Finer tolerances see more of that.
const HIDDEN: f64 = 0.75;

/// The part of what is left of it that a triangle may be off at samples, and as far as they tell between them.
const SAMPLED: f64 = 0.92;

/// The part of the tolerance that rounding vertices may take.
const ROUNDING_SHARE: f64 = 0.02;

/// What this leaves from mesh to mesh: memory.
#[derive(Debug, Default)]
pub(crate) struct HalvingScratch {
    folds: Folds,
    /// The outline's edges without what is folded away.
    folded: Vec<Edge>,
    tips: Vec<Tip>,
    tiles: Tiles,
    tube: Tube,
    finer: Finer,
    halves: Halves,
    /// The triangles, by the spots at their corners and on which side of a cut each of these is.
    corners: Vec<[u32; 3]>,
    /// The number of each such spot among the vertices.
    numbers: Vec<u32>,
    /// Those that are vertices, by number.
    vertices: Vec<u32>,
}

impl Lattice {
    /// How many there are.
    fn count(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// Where a spot is.
    fn place(&self, spot: Spot) -> DVec2 {
        self.corner + DVec2::from(spot.map(|at| at as f64)) * (self.pitch / 2.0)
    }

    /// A spot as a number, with the sides of cuts on which it is.
    fn key(&self, spot: Spot, sides: Sides) -> u32 {
        let sides = usize::from(sides[0]) + 2 * usize::from(sides[1]);
        (sides * KINDS * self.count()) as u32 + spot_key(spot, self.size)
    }

    /// The spot and the sides of a number.
    fn of_key(&self, key: u32) -> (Spot, Sides) {
        let all = (KINDS * self.count()) as u32;
        let sides = key / all;
        (spot_of(key % all, self.size), [sides % 2 == 1, sides > 1])
    }
}

/// Samples a penumbra radius, at first: at the penumbra's ends density goes with the power 1.5 of the distance.
fn samples(levels: f64) -> f64 {
    (SAMPLES / libm::cbrt(levels * levels)).max(FEWEST)
}

/// Whether an outline has so little between its corners that refinement would take about as many triangles before it is thinned.
fn is_detailed(shadow: &Shadow) -> bool {
    let census = shadow.census();
    census.line_length + census.arc_length + census.curve_length
        <= DETAIL * shadow.radius() * census.pieces
}

/// Pushes a shadow's edges as samples are drawn of them.
fn push_edges(shadow: &Shadow, levels: f64, edges: &mut Vec<Edge>) {
    shadow.edges_into(SAMPLE_SHARE * levels, 0.0, edges);
}

/// How many samples a shadow's mesh takes at least, unless its outline's detail is so large that refinement's triangles are much
/// fewer.
pub(crate) fn forecast(shadow: &Shadow, levels: f64) -> Option<usize> {
    let mut edges = Vec::new();
    push_edges(shadow, levels, &mut edges);
    let mut scratch = HalvingScratch::default();
    let lattice = scratch.lay(&edges, shadow.radius(), samples(levels))?;
    is_detailed(shadow).then_some(lattice.count())
}

/// Gives a sink the triangles of a shadow, if halving suits it: nothing is given otherwise.
pub(super) fn mesh(
    shadow: &Shadow,
    options: &MeshOptions,
    scratch: &mut Scratch,
    sink: &mut impl MeshSink,
) -> Result<Option<MeshQuality>> {
    let soft = options.profile == Profile::Disc && shadow.radius() > 0.0;
    if !soft || !(options.effort == Effort::Quick || is_detailed(shadow)) {
        return Ok(None);
    }
    let levels = options.tolerance.as_levels();
    let mut kept = core::mem::take(&mut scratch.halving);
    let mut edges = scratch.take();
    push_edges(shadow, levels, &mut edges);
    let (mut finer, mut found) = (1.0, Ok(None));
    for _ in 0..LATTICES {
        if finer > FINEST {
            break;
        }
        let Some(lattice) = kept.lay(&edges, shadow.radius(), finer * samples(levels)) else {
            break;
        };
        let times = kept.sample(shadow, levels, &lattice, scratch);
        if times <= 1.0 {
            found = kept.give(options, &lattice, scratch, sink);
            break;
        }
        finer *= times.max(FINER);
    }
    scratch.give(edges);
    scratch.halving = kept;
    found
}

impl HalvingScratch {
    /// Lays a lattice over an outline, so many samples a penumbra radius, if it is not too large. What it folds away is not laid over.
    fn lay(&mut self, edges: &[Edge], radius: f64, samples: f64) -> Option<Lattice> {
        let (min, max) = outline::bounds(edges.iter())?;
        let pitch = radius / samples;
        let corner = min - (radius + MARGIN * pitch);
        self.folded.clear();
        if (max - min).max_element() > FOLDED * radius {
            self.folds.find(edges, radius, corner, pitch);
            let folded = edges
                .iter()
                .map(|edge| self.folds.fold(edge, corner, pitch));
            self.folded.extend(folded);
        } else {
            self.folds.clear();
            self.folded.extend(edges);
        }
        let (_, max) = outline::bounds(self.folded.iter())?;
        if (max - min).max_element() > WIDEST * radius {
            return None;
        }
        let end = max + (radius + MARGIN * pitch);
        let squares = ((end - corner) / (pitch * SIDE as f64)).ceil();
        let lattice = Lattice {
            corner,
            pitch,
            size: [squares.x, squares.y].map(|count| count as usize * SIDE + 1),
        };
        (lattice.count() <= MOST).then_some(lattice)
    }

    /// Takes samples. Gives so many times as many as would be near enough to one another: no more than 1 if they are.
    fn sample(
        &mut self,
        shadow: &Shadow,
        levels: f64,
        lattice: &Lattice,
        scratch: &Scratch,
    ) -> f64 {
        let radius = shadow.radius();
        let end = lattice.size.map(|count| 2 * count);
        let end = lattice.place(end) + self.folds.offset(end, [true; 2]);
        let rounding = rounding_levels(step(lattice.corner, end), radius);
        if rounding > ROUNDING_SHARE * levels {
            return f64::INFINITY;
        }
        let unsure = SAMPLE_SHARE * levels + tiles::ROUNDING + rounding;
        let limit = SAMPLED * (levels - unsure) / 255.0;
        tips::find(&self.folded, radius, &mut self.tips);
        // Where tips are, samples between samples may be needed.
        let hides = |times: f64| {
            let mut tips = self.tips.iter();
            let pitch = lattice.pitch / (times * TWICE);
            tips.any(|tip| tip.height(pitch, radius) > limit)
        };
        let mut times = 1.0;
        while hides(times) && times <= FINEST {
            times *= FINER_FOR_TIPS;
        }
        if times > 1.0 {
            return times;
        }
        let limit = limit as f32;
        let hidden = (HIDDEN / levels).clamp(HIDDEN, 1.0) as f32;
        let Self {
            folded,
            tips,
            tiles,
            tube,
            finer,
            ..
        } = self;
        let [samples, centers] = tube.begin(lattice.size);
        let level = scratch.level();
        tiles.load(folded, radius, lattice);
        let offsets = [[0.0; 2], [0.5; 2]];
        dispatch!(level, simd => {
            tiles.fill(simd, radius, lattice, offsets, None, [samples, centers]);
        });
        dispatch!(level, simd => simd.vectorize(
            #[inline(always)]
            || tube.surround(limit, hidden),
        ));
        for tip in &*tips {
            let height = tip.height(lattice.pitch, radius) as f32;
            tube.narrow(tip.place(lattice), tip.reach(lattice.pitch), height);
        }
        // At the penumbra's ends, where it bends most, density goes with the power 1.5.
        let times_for = |bend: f32| libm::cbrt(f64::from(bend * bend));
        let times = times_for(tube.worst());
        if times > TWICE {
            return (times / TWICE).max(FINER);
        }
        finer.begin(lattice.size);
        if times > 1.0 {
            finer.find(tube);
        }
        dispatch!(level, simd => simd.vectorize(
            #[inline(always)]
            || tube.balance(),
        ));
        if !finer.any() {
            return times;
        }
        dispatch!(level, simd => finer.sample(simd, tiles, radius, lattice));
        times_for(finer.surround(tube, tips, lattice, radius))
    }

    /// Gives a sink the triangles between samples.
    fn give(
        &mut self,
        options: &MeshOptions,
        lattice: &Lattice,
        scratch: &Scratch,
        sink: &mut impl MeshSink,
    ) -> Result<Option<MeshQuality>> {
        let (level, levels) = (scratch.level(), options.tolerance.as_levels());
        let Self {
            tube,
            finer,
            halves,
            ..
        } = self;
        finer.choose(tube);
        dispatch!(level, simd => simd.vectorize(
            #[inline(always)]
            || halves.choose(simd, tube, finer),
        ));
        halves.collect(tube, finer);
        self.unfold(lattice);
        self.number(lattice);
        if self.vertices.len() > options.max_vertices {
            return Ok(None);
        }
        sink.begin(self.vertices.len(), self.corners.len())?;
        for &key in &self.vertices {
            let (spot, sides) = lattice.of_key(key);
            let position = lattice.place(spot) + self.folds.offset(spot, sides);
            sink.vertex(MeshVertex {
                position: position.as_vec2().to_array(),
                density: self.finer.vertex_at(&self.tube, spot),
            });
        }
        for corners in &self.corners {
            sink.triangle(corners.map(|key| self.numbers[key as usize]));
        }
        Ok(Some(MeshQuality::new(levels, None)))
    }

    /// Puts the triangles on their sides of the cuts, and rectangles between the sides.
    fn unfold(&mut self, lattice: &Lattice) {
        let Self { folds, corners, .. } = self;
        corners.clear();
        if !folds.any() {
            corners.extend(&self.halves.triangles);
            return;
        }
        for triangle in &self.halves.triangles {
            let spots = triangle.map(|key| lattice.of_key(key).0);
            let [a, b, c] = spots;
            let end = [0, 1].map(|axis: usize| a[axis].max(b[axis]).max(c[axis]));
            let sides = |spot: Spot| {
                let through = folds.through(spot);
                [0, 1].map(|axis: usize| through[axis] && spot[axis] < end[axis])
            };
            corners.push(spots.map(|spot| lattice.key(spot, sides(spot))));
            for [from, to] in [[a, b], [b, c], [c, a]] {
                for axis in 0..2 {
                    // Of the triangles beside a cut, those before it.
                    let on_cut = |at: Spot| folds.through(at)[axis] && at[axis] == end[axis];
                    if on_cut(from) && on_cut(to) {
                        let key = |at: Spot, behind: bool| {
                            let mut sides = sides(at);
                            sides[axis] = behind;
                            lattice.key(at, sides)
                        };
                        let near = [from, to].map(|at| key(at, false));
                        let far = [from, to].map(|at| key(at, true));
                        corners.push([near[1], near[0], far[0]]);
                        corners.push([near[1], far[0], far[1]]);
                    }
                }
            }
        }
        for spot in folds.crossings() {
            if self.finer.vertex_at(&self.tube, spot) > 0.0 {
                let [a, b, c, d] = [[false, false], [true, false], [true, true], [false, true]]
                    .map(|sides| lattice.key(spot, sides));
                corners.extend([[a, b, c], [a, c, d]]);
            }
        }
    }

    /// Numbers the corners of triangles in the order in which they come.
    fn number(&mut self, lattice: &Lattice) {
        const NONE: u32 = u32::MAX;
        let kinds = if self.finer.any() { KINDS } else { 1 };
        let all = if self.folds.any() { 4 * KINDS } else { kinds };
        self.numbers.clear();
        self.numbers.reserve(KINDS * lattice.count());
        self.numbers.resize(all * lattice.count(), NONE);
        self.vertices.clear();
        for &corner in self.corners.as_flattened() {
            let number = &mut self.numbers[corner as usize];
            if *number == NONE {
                *number = self.vertices.len() as u32;
                self.vertices.push(corner);
            }
        }
    }
}
