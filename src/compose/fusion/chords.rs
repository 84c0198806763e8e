//! The light's disc as chords, on which casters of several elevations are told apart.
//!
//! From a point p a caster of penumbra radius r hides of the disc what its outline covers in the unit of r about p. So a
//! level chord of the disc at height v lies on the line y = p.y + r v of the caster's receiver, and is hidden between the
//! outline's crossings with that line. Crossings of a row of pixels are found once; along the row only their distances change.

use core::f64::consts::{FRAC_1_PI, FRAC_PI_2};

use glam::DVec2;
use libm::{asin, cos, sin};

use crate::tilted::Circle;

/// At most so many pixels of a row are worked on together.
pub(super) const BLOCK: usize = 32;

/// Into so many equal angles the disc's height is cut, and again wherever an outline has a top, a bottom or a level edge.
const PIECES: u32 = 16;

/// Two nodes of the Gauss-Legendre rule a piece, from -1 to 1 (Abramowitz & Stegun 1964, table 25.4).
const GAUSS_2: f64 = 0.577_350_269_189_625_8;

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

    /// Whether the square from `corner` to one pixel on is within `reach` of the box of a loop.
    pub(super) fn is_near(&self, corner: DVec2, reach: f64) -> bool {
        self.loops.iter().any(|of_loop| {
            let corner = corner - of_loop.base;
            (of_loop.min - reach).cmplt(corner + 1.0).all()
                && (of_loop.max + reach).cmpgt(corner).all()
        })
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
    heights: Vec<f64>,
    nodes: Vec<Node>,
    /// A list for each caster.
    hidden: Vec<Spans>,
    /// Of the caster that is gone through: edges that the row's discs may meet, with where the first point is for them, and one
    /// chord's crossings.
    near: Vec<(DVec2, [DVec2; 2])>,
    crossings: Vec<f64>,
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

/// The spans that a caster hides of all chords, one chord after the other.
#[derive(Debug, Default)]
struct Spans {
    /// From and to, in pixels from the first point.
    spans: Vec<[f64; 2]>,
    /// Where each chord's spans begin, and where the last one's end.
    starts: Vec<usize>,
    /// 1 over the penumbra radius in pixels.
    factor: f32,
}

impl Chords {
    /// The chords of a row of points, the first of which each caster sees at a place of its own.
    pub(super) fn place<'a>(
        &mut self,
        casters: impl ExactSizeIterator<Item = (&'a Occluder, DVec2)> + Clone,
    ) {
        self.find_nodes(casters.clone());
        self.hidden.resize_with(casters.len(), Spans::default);
        for ((caster, at), hidden) in casters.zip(&mut self.hidden) {
            hidden.spans.clear();
            hidden.starts.clear();
            hidden.factor = (1.0 / caster.radius) as f32;
            self.near.clear();
            for of_loop in &caster.loops {
                let at = at - of_loop.base;
                let (low, high) = (at.y - caster.radius, at.y + caster.radius);
                if of_loop.min.y > high || of_loop.max.y < low {
                    continue;
                }
                let meets = |edge: &&[DVec2; 2]| edge[0].y <= high && edge[1].y >= low;
                let near = of_loop.edges.iter().filter(meets);
                self.near.extend(near.map(|edge| (at, *edge)));
            }
            for node in &self.nodes {
                hidden.starts.push(hidden.spans.len());
                self.crossings.clear();
                for (at, [from, to]) in &self.near {
                    let level = at.y + caster.radius * node.height;
                    if from.y <= level && level < to.y {
                        let share = (level - from.y) / (to.y - from.y);
                        self.crossings.push(from.x + share * (to.x - from.x) - at.x);
                    }
                }
                self.crossings.sort_by(f64::total_cmp);
                let pairs = self.crossings.chunks_exact(2);
                hidden.spans.extend(pairs.map(|pair| [pair[0], pair[1]]));
            }
            hidden.starts.push(hidden.spans.len());
        }
    }

    fn find_nodes<'a>(&mut self, casters: impl Iterator<Item = (&'a Occluder, DVec2)>) {
        let heights = &mut self.heights;
        heights.clear();
        heights.extend(
            (0..=PIECES).map(|i| FRAC_PI_2 * (2.0 * f64::from(i) / f64::from(PIECES) - 1.0)),
        );
        for (caster, at) in casters {
            for of_loop in &caster.loops {
                let height = |turn: &f64| (turn - (at.y - of_loop.base.y)) / caster.radius;
                let inside = of_loop.turns.iter().map(height);
                heights.extend(inside.filter(|v| v.abs() < 1.0).map(asin));
            }
        }
        heights.sort_by(f64::total_cmp);
        self.nodes.clear();
        for piece in heights.windows(2) {
            let half = (piece[1] - piece[0]) / 2.0;
            if half < 1e-9 {
                continue;
            }
            let middle = piece[0] + half;
            for angle in [middle - GAUSS_2 * half, middle + GAUSS_2 * half] {
                self.nodes.push(Node {
                    height: sin(angle),
                    half: cos(angle) as f32,
                    weight: (half * cos(angle) * FRAC_1_PI) as f32,
                });
            }
        }
    }

    /// The density of one caster at the points that are whole pixels and `offset` behind the first.
    pub(super) fn density(&self, caster: usize, offset: f64, out: &mut [f32; BLOCK]) {
        let hidden = &self.hidden[caster];
        let mut sums = [0.0; BLOCK];
        for (index, node) in self.nodes.iter().enumerate() {
            for &[from, to] in hidden.of(index) {
                for (lane, sum) in sums.iter_mut().enumerate() {
                    let x = lane as f64 + offset;
                    let from = hidden.unit(from - x).max(-node.half);
                    let to = hidden.unit(to - x).min(node.half);
                    *sum += node.weight * (to - from).max(0.0);
                }
            }
        }
        *out = sums.map(|sum| sum.min(1.0));
    }

    /// The part of the disc that both of two casters hide from such points.
    pub(super) fn shared(&self, pair: [usize; 2], offset: f64, out: &mut [f32; BLOCK]) {
        let [a, b] = pair.map(|caster| &self.hidden[caster]);
        let mut sums = [0.0; BLOCK];
        for (index, node) in self.nodes.iter().enumerate() {
            for &[from_a, to_a] in a.of(index) {
                for &[from_b, to_b] in b.of(index) {
                    for (lane, sum) in sums.iter_mut().enumerate() {
                        let x = lane as f64 + offset;
                        let from = a.unit(from_a - x).max(b.unit(from_b - x)).max(-node.half);
                        let to = a.unit(to_a - x).min(b.unit(to_b - x)).min(node.half);
                        *sum += node.weight * (to - from).max(0.0);
                    }
                }
            }
        }
        *out = sums.map(|sum| sum.min(1.0));
    }

    /// What all casters hold back of the light at one of the points, where `held` says what they do together of a ray that
    /// some of them hide (1) and others do not (0).
    pub(super) fn held(&mut self, x: f64, held: impl Fn(&[f32]) -> f32) -> f32 {
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
        }
        sum
    }
}

impl Spans {
    fn of(&self, chord: usize) -> &[[f64; 2]] {
        &self.spans[self.starts[chord]..self.starts[chord + 1]]
    }

    /// A distance in pixels in the unit of the disc.
    fn unit(&self, distance: f64) -> f32 {
        distance as f32 * self.factor
    }
}
