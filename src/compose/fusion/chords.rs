//! The light's disc as chords, on which casters of several elevations are told apart.
//!
//! From a point p a caster of penumbra radius r hides of the disc what its outline covers in the unit of r about p. So a
//! level chord of the disc at height v lies on the line y = p.y + r v of the caster's receiver, and is hidden between the
//! outline's crossings with that line. Crossings for some points of a row are found once; from point to point only their
//! distances change.

use core::ops::Range;

use fearless_simd::{Level, Simd, SimdBase, dispatch, f32x16};
use glam::DVec2;
use libm::asin;

use super::occluder::Loop;
use crate::density::lanes::LANES;
use crate::density::quadrature;

/// Into so many equal angles the disc's height is cut, and again wherever an outline has a top, a bottom or a level edge.
const PIECES: u32 = 12;

/// Along slanted edges the height is cut into steps of this over the square root of their slope. Cuts are where a hidden part
/// begins or ends with a slope that two chords a piece do not see, an error of about 4 slope h² levels for a piece of height h.
const SLANTED_STEP: f64 = 0.2;

/// A loop of a caster near some points of a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part<'a> {
    /// The caster's number among those that are told apart; parts of one follow each other.
    pub(super) caster: usize,
    pub(super) of_loop: &'a Loop,
    /// The caster's penumbra radius in pixels.
    pub(super) radius: f64,
    /// The side of the square about its middle that a pixel sees the caster through, in pixels.
    pub(super) side: f64,
    /// The first pixel's middle, as far above or below as the row of points is, in pixels from the loop's base; and how far to
    /// the right of it the last pixel is.
    pub(super) at: DVec2,
    pub(super) width: f64,
}

/// A number for each of the points that are worked on together.
pub(super) type Lane = [f32; LANES];

/// Points in a row of pixels.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Points {
    /// How far their pixels are behind the first one.
    pub(super) pixels: Lane,
    /// How far they are from their pixels' middles, for a square of side 1.
    pub(super) offsets: Lane,
}

/// The chords of some points of a row, and where casters hide them.
#[derive(Debug, Default)]
pub(super) struct Chords {
    /// The nodes of each piece that nothing cuts.
    pieces: Vec<[Node; 2]>,
    /// The angles at which pieces are cut.
    cuts: Vec<f64>,
    nodes: Vec<Node>,
    /// A list for each caster.
    hidden: Vec<Spans>,
    /// Of the caster that is gone through: edges that the points' discs may meet, with where the origin is for them and the
    /// chords that they cross; and up to where each chord's crossings are known.
    near: Vec<(DVec2, [DVec2; 2], Range<usize>)>,
    filled: Vec<usize>,
    /// Memory to walk along one chord.
    ends: Vec<(f32, usize, bool)>,
    inside: Vec<f32>,
    /// Memory to unite spans: where they begin and end, each list in order.
    begins: Vec<Lane>,
    stops: Vec<Lane>,
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
    crossings: Vec<f32>,
    /// Where each chord's crossings begin, and where the last one's end. None if the caster has no part near the points.
    starts: Vec<usize>,
    /// 1 over the penumbra radius in pixels, and the side of a pixel's square.
    factor: f32,
    side: f32,
}

impl Chords {
    /// The chords of some points of a row, for so many casters, of which these are the parts near to them.
    pub(super) fn place(&mut self, casters: usize, parts: &[Part<'_>]) {
        self.find_nodes(parts);
        self.hidden.resize_with(casters, Spans::default);
        for hidden in &mut self.hidden {
            hidden.starts.clear();
            hidden.crossings.clear();
        }
        for parts in parts.chunk_by(|a, b| a.caster == b.caster) {
            let Part {
                caster,
                radius,
                side,
                ..
            } = parts[0];
            let hidden = &mut self.hidden[caster];
            hidden.factor = (1.0 / radius) as f32;
            hidden.side = side as f32;
            // How many crossings each chord has, then where they begin.
            hidden.starts.resize(self.nodes.len() + 1, 0);
            self.near.clear();
            for &Part { of_loop, at, .. } in parts {
                let (low, high) = (at.y - radius, at.y + radius);
                let meets = |edge: &&[DVec2; 2]| edge[0].y <= high && edge[1].y >= low;
                let mut crossed = [0; 2];
                for edge in of_loop.edges.iter().filter(meets) {
                    for (node, point) in crossed.iter_mut().zip(edge) {
                        // Most edges pass the disc.
                        *node = if point.y <= low {
                            0
                        } else if point.y >= high {
                            self.nodes.len()
                        } else {
                            first_from(&self.nodes, (point.y - at.y) / radius, *node)
                        };
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
            hidden.crossings.resize(total, 0.0);
            self.filled.clear();
            self.filled.extend_from_slice(&hidden.starts);
            for (at, [from, to], chords) in &self.near {
                let slope = (to.x - from.x) / (to.y - from.y);
                for chord in chords.clone() {
                    let level = at.y + radius * self.nodes[chord].height;
                    let slot = &mut self.filled[chord];
                    hidden.crossings[*slot] = (from.x + (level - from.y) * slope - at.x) as f32;
                    *slot += 1;
                }
            }
            for chord in hidden.starts.windows(2) {
                match &mut hidden.crossings[chord[0]..chord[1]] {
                    [] | [_] => {}
                    [a, b] => (*a, *b) = (a.min(*b), a.max(*b)),
                    more => more.sort_unstable_by(f32::total_cmp),
                }
            }
        }
    }

    fn find_nodes(&mut self, parts: &[Part<'_>]) {
        self.cuts.clear();
        for part in parts {
            part.cuts(&mut self.cuts);
        }
        self.cuts.sort_unstable_by(f64::total_cmp);
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
        let mut cuts = self.cuts.iter().copied().peekable();
        for (index, whole) in (0..PIECES).zip(&self.pieces) {
            let (mut from, to) = (
                quadrature::angle(index, PIECES),
                quadrature::angle(index + 1, PIECES),
            );
            if cuts.peek().is_none_or(|&cut| cut >= to) {
                self.nodes.extend(whole);
                continue;
            }
            while let Some(cut) = cuts.next_if(|&cut| cut < to) {
                if cut - from > 1e-9 {
                    self.nodes.extend(nodes(from, cut));
                    from = cut;
                }
            }
            self.nodes.extend(nodes(from, to));
        }
    }

    /// The density of one caster at the points.
    pub(super) fn density(&self, level: Level, caster: usize, points: &Points, out: &mut Lane) {
        dispatch!(level, simd => self.add_density(simd, caster, points, out));
    }

    #[inline(always)]
    fn add_density<S: Simd>(&self, simd: S, caster: usize, points: &Points, out: &mut Lane) {
        let splat = |v: f32| f32x16::splat(simd, v);
        let hidden = &self.hidden[caster];
        let x = hidden.at(simd, points);
        let (zero, mut sum) = (splat(0.0), splat(0.0));
        for (index, node) in self.nodes.iter().enumerate() {
            let half = splat(node.half);
            for &[from, to] in hidden.of(index) {
                let from = (splat(from * hidden.factor) - x).max(-half);
                let to = (splat(to * hidden.factor) - x).min(half);
                sum += (to - from).max(zero) * node.weight;
            }
        }
        sum.min(splat(1.0)).store_slice(out);
    }

    /// The part of the disc that both of two casters hide from the points.
    pub(super) fn shared(&self, level: Level, pair: [usize; 2], points: &Points, out: &mut Lane) {
        dispatch!(level, simd => self.add_shared(simd, pair, points, out));
    }

    #[inline(always)]
    fn add_shared<S: Simd>(&self, simd: S, pair: [usize; 2], points: &Points, out: &mut Lane) {
        let splat = |v: f32| f32x16::splat(simd, v);
        let [a, b] = [&self.hidden[pair[0]], &self.hidden[pair[1]]];
        let (x_a, x_b) = (a.at(simd, points), b.at(simd, points));
        let (zero, mut sum) = (splat(0.0), splat(0.0));
        for (index, node) in self.nodes.iter().enumerate() {
            let half = splat(node.half);
            for &[from, to] in a.of(index) {
                let from_a = (splat(from * a.factor) - x_a).max(-half);
                let to_a = (splat(to * a.factor) - x_a).min(half);
                for &[from, to] in b.of(index) {
                    let from = (splat(from * b.factor) - x_b).max(from_a);
                    let to = (splat(to * b.factor) - x_b).min(to_a);
                    sum += (to - from).max(zero) * node.weight;
                }
            }
        }
        sum.min(splat(1.0)).store_slice(out);
    }

    /// The part of the disc that any caster hides from the points, in steps: for each caster in turn what it and those before it
    /// hide counts by its weight.
    pub(super) fn united(
        &mut self,
        level: Level,
        weights: &[f32],
        points: &Points,
        out: &mut Lane,
    ) {
        dispatch!(level, simd => self.add_united(simd, weights, points, out));
    }

    #[inline(always)]
    fn add_united<S: Simd>(&mut self, simd: S, weights: &[f32], points: &Points, out: &mut Lane) {
        let splat = |v: f32| f32x16::splat(simd, v);
        let mut sum = splat(0.0);
        for (index, node) in self.nodes.iter().enumerate() {
            let half = splat(node.half);
            self.begins.clear();
            self.stops.clear();
            for (hidden, &weight) in self.hidden.iter().zip(weights) {
                let x = hidden.at(simd, points);
                for &[from, to] in hidden.of(index) {
                    let from = splat(from * hidden.factor) - x;
                    let to = splat(to * hidden.factor) - x;
                    insert(simd, &mut self.begins, from.max(-half).min(half));
                    insert(simd, &mut self.stops, to.max(-half).min(half));
                }
                if weight == 0.0 {
                    continue;
                }
                // With beginnings and ends in order each by themselves, what is between an end and the next one is hidden but
                // for what is before as many beginnings.
                let (mut before, mut length) = (-half, splat(0.0));
                for (begin, stop) in self.begins.iter().zip(&self.stops) {
                    let begin = f32x16::from_slice(simd, begin);
                    let stop = f32x16::from_slice(simd, stop);
                    length += stop - begin.max(before);
                    before = stop;
                }
                sum += length * (node.weight * weight);
            }
        }
        sum.store_slice(out);
    }

    /// What all casters hold back of the light at one of the points, where `held` says what they do together of a ray that some of
    /// them hide (1) and others do not (0).
    pub(super) fn held(
        &mut self,
        points: &Points,
        lane: usize,
        mut held: impl FnMut(&[f32]) -> f32,
    ) -> f32 {
        let mut sum = 0.0;
        for (index, node) in self.nodes.iter().enumerate() {
            self.ends.clear();
            for (caster, hidden) in self.hidden.iter().enumerate() {
                let x = points.pixels[lane] + points.offsets[lane] * hidden.side;
                for &[from, to] in hidden.of(index) {
                    let from = ((from - x) * hidden.factor).max(-node.half);
                    let to = ((to - x) * hidden.factor).min(node.half);
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

/// Puts a value into a list that is in order, lane by lane.
#[inline(always)]
fn insert<S: Simd>(simd: S, list: &mut Vec<Lane>, value: f32x16<S>) {
    let mut value = value;
    for slot in list.iter_mut() {
        let other = f32x16::from_slice(simd, slot);
        other.min(value).store_slice(slot);
        value = other.max(value);
    }
    let mut last = [0.0; LANES];
    value.store_slice(&mut last);
    list.push(last);
}

impl Part<'_> {
    /// How far from a pixel's middle it still matters to it.
    fn reach(&self) -> f64 {
        self.radius + self.side / 2.0
    }

    /// Whether it may matter to any of the points.
    pub(super) fn is_near(&self) -> bool {
        let reach = self.reach();
        self.of_loop.min.x <= self.at.x + self.width + reach
            && self.of_loop.max.x >= self.at.x - reach
    }

    /// Adds the angles at which the disc's height is to be cut for this part, as far as it is near the points.
    fn cuts(&self, out: &mut Vec<f64>) {
        let reach = self.reach();
        let (left, right) = (self.at.x - reach, self.at.x + self.width + reach);
        let height = |y: f64| (y - self.at.y) / self.radius;
        for [from, to] in &self.of_loop.turns {
            let v = height(from.y);
            if v.abs() < 1.0 && to.x >= left && from.x <= right {
                out.push(asin(v));
            }
        }
        let (lowest, highest) = (self.at.y - self.radius, self.at.y + self.radius);
        for [from, to] in &self.of_loop.slanted {
            let is_beside = from.x.max(to.x) < left || from.x.min(to.x) > right;
            if is_beside || to.y <= lowest || from.y >= highest {
                continue;
            }
            let slope = (to.x - from.x) / (to.y - from.y);
            // Where between its ends it is near.
            let ends = [left, right].map(|x| from.y + (x - from.x) / slope);
            let low = height(from.y.max(ends[0].min(ends[1]))).max(-1.0);
            let high = height(to.y.min(ends[0].max(ends[1]))).min(1.0);
            if low < high {
                let steps = ((high - low) * slope.abs().sqrt() / SLANTED_STEP).ceil();
                let cut = |step: u32| asin(low + (high - low) * (f64::from(step) / steps));
                out.extend((0..=steps as u32).map(cut));
            }
        }
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
    /// Where the points are in the unit of the disc.
    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, points: &Points) -> f32x16<S> {
        let offsets = f32x16::from_slice(simd, &points.offsets) * self.side;
        (f32x16::from_slice(simd, &points.pixels) + offsets) * self.factor
    }

    fn of(&self, chord: usize) -> &[[f32; 2]] {
        let ends = self.starts.get(chord).zip(self.starts.get(chord + 1));
        let crossings = ends.map(|(&first, &end)| &self.crossings[first..end]);
        crossings.unwrap_or_default().as_chunks().0
    }
}
