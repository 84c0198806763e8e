//! The light's disc as chords, on which casters of several elevations are told apart.
//!
//! From a point p a caster of penumbra radius r hides of the disc what its outline covers in the unit of r about p. So a
//! level chord of the disc at height v lies on the line y = p.y + r v of the caster's receiver, and is hidden between the
//! outline's crossings with that line. Crossings of a row of pixels are found once; along the row only their distances change.

use core::ops::Range;

use fearless_simd::{Level, Simd, SimdBase, dispatch, f32x16};
use glam::DVec2;
use libm::{asin, floor};

use crate::density::lanes::{LANES, lanes};
use crate::density::quadrature;
use crate::tilted::Circle;

/// So many pixels of a row are worked on together.
pub(super) const BLOCK: usize = LANES;

/// Where the block of a point begins that is so far behind the origin, and the point's number in it. Blocks do not depend on
/// what is asked for: nor do the bits of what is found.
pub(super) fn block_of(offset: f64) -> (f64, usize) {
    let lane = (floor(offset) as i64).rem_euclid(BLOCK as i64);
    (offset - lane as f64, lane as usize)
}

/// Into so many equal angles the disc's height is cut, and again wherever an outline has a top, a bottom or a level edge.
const PIECES: u32 = 12;

/// One caster as its chords need it. Each of its loops has an origin of its own, a whole pixel: what a pixel is given depends
/// neither on what else there is nor on the grid that shows it.
#[derive(Debug, Clone, Default)]
pub(super) struct Occluder {
    /// The penumbra radius in pixels.
    pub(super) radius: f64,
    loops: Vec<Loop>,
}

#[derive(Debug, Clone)]
struct Loop {
    /// In pixels from the scene's origin; all else from here.
    base: DVec2,
    min: DVec2,
    max: DVec2,
    /// The outline's lines but the level ones, each from its lower y to its higher one.
    edges: Vec<[DVec2; 2]>,
    /// All lines, each with the area on its left where y points up.
    lines: Vec<[DVec2; 2]>,
    /// Where the outline turns up or down: there the hidden part of a chord begins or ends at once.
    turns: Vec<f64>,
}

impl Occluder {
    /// Of polygons in pixels from the scene's origin, of which there are `scale` a unit of theirs.
    pub(super) fn new(polygons: &[Vec<DVec2>], scale: f64, radius: f64) -> Self {
        Self {
            radius,
            loops: polygons
                .iter()
                .filter_map(|polygon| Loop::new(polygon, scale))
                .collect(),
        }
    }

    /// A whole pixel of its own, from the scene's origin.
    pub(super) fn origin(&self) -> DVec2 {
        self.loops.first().map_or(DVec2::ZERO, |first| first.base)
    }

    /// Puts the lines that discs about points at height `y` may meet into `out`, in pixels from the scene's origin.
    pub(super) fn lines_near(&self, y: f64, out: &mut Vec<[DVec2; 2]>) {
        for of_loop in &self.loops {
            let y = y - of_loop.base.y;
            let (low, high) = (y - self.radius, y + self.radius);
            if of_loop.min.y <= high && of_loop.max.y >= low {
                let meets = |line: &&[DVec2; 2]| {
                    line[0].y.min(line[1].y) <= high && line[0].y.max(line[1].y) >= low
                };
                let near = of_loop.lines.iter().filter(meets);
                out.extend(near.map(|line| line.map(|point| point + of_loop.base)));
            }
        }
    }

    /// The direction of the outline where the disc about a point meets it in a single line from one side to the other, or none;
    /// and up to which x to the right of the point that stays so.
    pub(super) fn single_line(&self, lines: &[[DVec2; 2]], at: DVec2) -> (Option<DVec2>, f64) {
        let reach = self.radius;
        let (mut count, mut single, mut until) = (0, None, f64::MAX);
        for &[from, to] in lines {
            let (low, high) = (from.min(to), from.max(to));
            if at.x > high.x + reach {
                continue;
            }
            if at.x < low.x - reach {
                until = until.min(low.x - reach);
                continue;
            }
            until = until.min(high.x + reach);
            count += 1;
            let spans_rows = low.y <= at.y - reach && high.y >= at.y + reach;
            let spans_columns = at.x >= low.x + reach && at.x <= high.x - reach;
            if spans_columns {
                until = until.min(high.x - reach);
            } else if at.x < low.x + reach {
                until = until.min(low.x + reach);
            }
            if spans_rows || spans_columns {
                single = Some(to - from);
            }
        }
        (single.filter(|_| count == 1), until)
    }

    /// A caster of many radii as one point sees it, on the light's unit disc.
    pub(super) fn seen_from(point: DVec2, loops: &[Vec<Circle>]) -> Self {
        let polygons: Vec<Vec<DVec2>> = loops
            .iter()
            .map(|circles| {
                circles
                    .iter()
                    .map(|circle| circle.seen_from(point))
                    .collect()
            })
            .collect();
        Self::new(&polygons, 1.0, 1.0)
    }
}

impl Loop {
    fn new(polygon: &[DVec2], scale: f64) -> Option<Self> {
        let min = polygon.iter().copied().reduce(DVec2::min)?;
        let base = (min * scale).floor();
        let points: Vec<DVec2> = polygon.iter().map(|&point| point * scale - base).collect();
        let mut of_loop = Self {
            base,
            min: DVec2::ZERO,
            max: DVec2::ZERO,
            edges: Vec::new(),
            lines: Vec::new(),
            turns: Vec::new(),
        };
        of_loop.min = points.iter().copied().fold(DVec2::MAX, DVec2::min);
        of_loop.max = points.iter().copied().fold(DVec2::MIN, DVec2::max);
        let count = points.len();
        for (index, &from) in points.iter().enumerate() {
            let to = points[(index + 1) % count];
            let before = points[(index + count - 1) % count];
            if (from.y - before.y) * (to.y - from.y) <= 0.0 {
                of_loop.turns.push(from.y);
            }
            of_loop.lines.push([from, to]);
            if from.y < to.y {
                of_loop.edges.push([from, to]);
            } else if to.y < from.y {
                of_loop.edges.push([to, from]);
            }
        }
        of_loop.turns.sort_by(f64::total_cmp);
        of_loop.turns.dedup();
        Some(of_loop)
    }
}

/// The chords of one row of points, and where casters hide them.
#[derive(Debug, Default)]
pub(super) struct Chords {
    /// The nodes of each piece that no turn cuts.
    pieces: Vec<[Node; 2]>,
    /// The angles at which outlines turn.
    turns: Vec<f64>,
    nodes: Vec<Node>,
    /// A list for each caster.
    hidden: Vec<Spans>,
    /// Of the caster that is gone through: edges that the row's discs may meet, with where the first point is for them and the
    /// chords that they cross; and up to where each chord's crossings are known.
    near: Vec<(DVec2, [DVec2; 2], Range<usize>)>,
    filled: Vec<usize>,
    /// Memory to walk along one chord.
    ends: Vec<(f32, usize, bool)>,
    inside: Vec<f32>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    /// The chord's height from the disc's middle, half its length, and what a unit of it is of the disc's area.
    height: f64,
    half: f32,
    weight: f32,
}

/// The spans that a caster hides of all chords.
#[derive(Debug, Default)]
struct Spans {
    /// Where they begin and end, in pixels from the origin, from left to right, one chord after the other.
    crossings: Vec<f64>,
    /// Where each chord's crossings begin, and where the last one's end.
    starts: Vec<usize>,
    /// 1 over the penumbra radius in pixels.
    factor: f32,
}

impl Chords {
    /// The chords of a row of points; each caster sees the row's origin at a place of its own.
    pub(super) fn place<'a>(
        &mut self,
        casters: impl ExactSizeIterator<Item = (&'a Occluder, DVec2)> + Clone,
    ) {
        self.find_nodes(casters.clone());
        self.hidden.resize_with(casters.len(), Spans::default);
        for ((caster, at), hidden) in casters.zip(&mut self.hidden) {
            hidden.factor = (1.0 / caster.radius) as f32;
            // How many crossings each chord has, then where they begin.
            hidden.starts.clear();
            hidden.starts.resize(self.nodes.len() + 1, 0);
            self.near.clear();
            for of_loop in &caster.loops {
                let at = at - of_loop.base;
                let (low, high) = (at.y - caster.radius, at.y + caster.radius);
                if of_loop.min.y > high || of_loop.max.y < low {
                    continue;
                }
                let meets = |edge: &&[DVec2; 2]| edge[0].y <= high && edge[1].y >= low;
                let mut crossed = [0; 2];
                for edge in of_loop.edges.iter().filter(meets) {
                    for (node, point) in crossed.iter_mut().zip(edge) {
                        *node = first_from(&self.nodes, (point.y - at.y) / caster.radius, *node);
                    }
                    let [first, end] = crossed;
                    if first < end {
                        self.near.push((at, *edge, first..end));
                        for count in &mut hidden.starts[first..end] {
                            *count += 1;
                        }
                    }
                }
            }
            let mut total = 0;
            for start in &mut hidden.starts {
                total += core::mem::replace(start, total);
            }
            hidden.crossings.clear();
            hidden.crossings.resize(total, 0.0);
            self.filled.clear();
            self.filled.extend_from_slice(&hidden.starts);
            for (at, [from, to], chords) in &self.near {
                let slope = (to.x - from.x) / (to.y - from.y);
                for chord in chords.clone() {
                    let level = at.y + caster.radius * self.nodes[chord].height;
                    let slot = &mut self.filled[chord];
                    hidden.crossings[*slot] = from.x + (level - from.y) * slope - at.x;
                    *slot += 1;
                }
            }
            for chord in hidden.starts.windows(2) {
                match &mut hidden.crossings[chord[0]..chord[1]] {
                    [] | [_] => {}
                    [a, b] => (*a, *b) = (a.min(*b), a.max(*b)),
                    more => more.sort_unstable_by(f64::total_cmp),
                }
            }
        }
    }

    fn find_nodes<'a>(&mut self, casters: impl Iterator<Item = (&'a Occluder, DVec2)>) {
        let turns = &mut self.turns;
        turns.clear();
        for (caster, at) in casters {
            for of_loop in &caster.loops {
                let height = |turn: &f64| (turn - (at.y - of_loop.base.y)) / caster.radius;
                let inside = of_loop.turns.iter().map(height);
                turns.extend(inside.filter(|v| v.abs() < 1.0).map(asin));
            }
        }
        turns.sort_by(f64::total_cmp);
        if self.pieces.is_empty() {
            let piece = |index: u32| {
                nodes(
                    quadrature::angle(index, PIECES),
                    quadrature::angle(index + 1, PIECES),
                )
            };
            self.pieces = (0..PIECES).map(piece).collect();
        }
        self.nodes.clear();
        let mut turns = turns.iter().copied().peekable();
        for (index, whole) in (0..PIECES).zip(&self.pieces) {
            let (mut from, to) = (
                quadrature::angle(index, PIECES),
                quadrature::angle(index + 1, PIECES),
            );
            if turns.peek().is_none_or(|&turn| turn >= to) {
                self.nodes.extend(whole);
                continue;
            }
            while let Some(turn) = turns.next_if(|&turn| turn < to) {
                if turn - from > 1e-9 {
                    self.nodes.extend(nodes(from, turn));
                    from = turn;
                }
            }
            self.nodes.extend(nodes(from, to));
        }
    }

    /// The density of one caster at the points of a block that begins so far behind the origin.
    pub(super) fn density(&self, level: Level, caster: usize, block: f64, out: &mut [f32; BLOCK]) {
        dispatch!(level, simd => self.add_density(simd, caster, block, out));
    }

    #[inline(always)]
    fn add_density<S: Simd>(&self, simd: S, caster: usize, block: f64, out: &mut [f32; BLOCK]) {
        let splat = |v: f32| f32x16::splat(simd, v);
        let hidden = &self.hidden[caster];
        let x = hidden.lanes(simd);
        let (zero, mut sum) = (splat(0.0), splat(0.0));
        for (index, node) in self.nodes.iter().enumerate() {
            let half = splat(node.half);
            for &[from, to] in hidden.of(index) {
                let from = (splat(hidden.unit(from - block)) - x).max(-half);
                let to = (splat(hidden.unit(to - block)) - x).min(half);
                sum += (to - from).max(zero) * node.weight;
            }
        }
        sum.min(splat(1.0)).store_slice(out);
    }

    /// The part of the disc that both of two casters hide from such points.
    pub(super) fn shared(
        &self,
        level: Level,
        pair: [usize; 2],
        block: f64,
        out: &mut [f32; BLOCK],
    ) {
        dispatch!(level, simd => self.add_shared(simd, pair, block, out));
    }

    #[inline(always)]
    fn add_shared<S: Simd>(&self, simd: S, pair: [usize; 2], block: f64, out: &mut [f32; BLOCK]) {
        let splat = |v: f32| f32x16::splat(simd, v);
        let [a, b] = pair.map(|caster| &self.hidden[caster]);
        let (x_a, x_b) = (a.lanes(simd), b.lanes(simd));
        let (zero, mut sum) = (splat(0.0), splat(0.0));
        for (index, node) in self.nodes.iter().enumerate() {
            let half = splat(node.half);
            for &[from, to] in a.of(index) {
                let from_a = (splat(a.unit(from - block)) - x_a).max(-half);
                let to_a = (splat(a.unit(to - block)) - x_a).min(half);
                for &[from, to] in b.of(index) {
                    let from = (splat(b.unit(from - block)) - x_b).max(from_a);
                    let to = (splat(b.unit(to - block)) - x_b).min(to_a);
                    sum += (to - from).max(zero) * node.weight;
                }
            }
        }
        sum.min(splat(1.0)).store_slice(out);
    }

    /// What all casters hold back of the light at one of the points, where `held` says what they do together of a ray that
    /// some of them hide (1) and others do not (0).
    pub(super) fn held(&mut self, x: f64, mut held: impl FnMut(&[f32]) -> f32) -> f32 {
        let mut sum = 0.0;
        for (index, node) in self.nodes.iter().enumerate() {
            self.ends.clear();
            for (caster, hidden) in self.hidden.iter().enumerate() {
                for &[from, to] in hidden.of(index) {
                    let from = hidden.unit(from - x).max(-node.half);
                    let to = hidden.unit(to - x).min(node.half);
                    if from < to {
                        self.ends.push((from, caster, true));
                        self.ends.push((to, caster, false));
                    }
                }
            }
            self.ends.sort_by(|a, b| a.0.total_cmp(&b.0));
            self.inside.clear();
            self.inside.resize(self.hidden.len(), 0.0);
            let mut done = -node.half;
            for &(at, caster, begins) in &self.ends {
                if at > done {
                    sum += node.weight * (at - done) * held(&self.inside);
                    done = at;
                }
                self.inside[caster] = if begins { 1.0 } else { 0.0 };
            }
            sum += node.weight * (node.half - done) * held(&self.inside);
        }
        sum
    }
}

/// The first node that is not below a height, by way of one that is near to it.
fn first_from(nodes: &[Node], height: f64, near: usize) -> usize {
    let mut first = near;
    while first > 0 && nodes[first - 1].height >= height {
        first -= 1;
    }
    while first < nodes.len() && nodes[first].height < height {
        first += 1;
    }
    first
}

/// The nodes between two angles.
fn nodes(from: f64, to: f64) -> [Node; 2] {
    quadrature::chords_between(from, to).map(|chord| Node {
        height: chord.height,
        half: chord.half as f32,
        weight: chord.weight as f32,
    })
}

impl Spans {
    fn of(&self, chord: usize) -> &[[f64; 2]] {
        self.crossings[self.starts[chord]..self.starts[chord + 1]]
            .as_chunks()
            .0
    }

    /// How far behind its block's first one each point is, in the unit of the disc.
    #[inline(always)]
    fn lanes<S: Simd>(&self, simd: S) -> f32x16<S> {
        lanes(simd) * self.factor
    }

    /// A distance in pixels in the unit of the disc.
    fn unit(&self, distance: f64) -> f32 {
        distance as f32 * self.factor
    }
}
