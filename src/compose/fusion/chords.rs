//! The light's disc as chords, on which casters of several elevations are told apart.
//!
//! From a point p a caster of penumbra radius r hides of the disc what its outline covers in the unit of r about p. So a
//! level chord of the disc at height v lies on the line y = p.y + r v of the caster's receiver, and is hidden between the
//! outline's crossings with that line. Crossings of a row of pixels are found once; along the row only their distances change.

use core::f64::consts::{FRAC_1_PI, FRAC_PI_2};

use glam::DVec2;
use libm::{asin, cos, sin};

/// So many pixels of a row are worked on together. Blocks begin at whole multiples of it in the casters' own pixels, so that
/// what a pixel is given does not depend on the grid that shows it.
pub(super) const BLOCK: usize = 32;

/// Into so many equal angles the disc's height is cut, and again wherever an outline has a top, a bottom or a level edge.
const PIECES: u32 = 16;

/// Two nodes of the Gauss-Legendre rule a piece, from -1 to 1 (Abramowitz & Stegun 1964, table 25.4).
const GAUSS_2: f64 = 0.577_350_269_189_625_8;

/// One caster as its row of chords needs it: lengths in pixels from the casters' common origin.
#[derive(Debug, Default)]
pub(super) struct Occluder {
    pub(super) radius: f64,
    /// The outline's lines but the level ones, each from its lower y to its higher one.
    edges: Vec<[DVec2; 2]>,
    /// Where the outline turns up or down: there the hidden part of a chord begins or ends at once.
    turns: Vec<f64>,
}

impl Occluder {
    pub(super) fn new(polygons: &[Vec<DVec2>], radius: f64) -> Self {
        let mut occluder = Self {
            radius,
            ..Self::default()
        };
        for polygon in polygons {
            let count = polygon.len();
            for (index, &from) in polygon.iter().enumerate() {
                let to = polygon[(index + 1) % count];
                let before = polygon[(index + count - 1) % count];
                if (from.y - before.y) * (to.y - from.y) <= 0.0 {
                    occluder.turns.push(from.y);
                }
                if from.y < to.y {
                    occluder.edges.push([from, to]);
                } else if to.y < from.y {
                    occluder.edges.push([to, from]);
                }
            }
        }
        occluder.turns.sort_by(f64::total_cmp);
        occluder.turns.dedup();
        occluder
    }
}

/// The chords of one row of points, and where casters hide them.
#[derive(Debug, Default)]
pub(super) struct Chords {
    heights: Vec<f64>,
    nodes: Vec<Node>,
    /// A list for each caster.
    hidden: Vec<Spans>,
    /// Of the caster that is gone through: edges that the row's discs may meet, and one chord's crossings.
    near: Vec<[DVec2; 2]>,
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
    /// From and to, in pixels from the row's block.
    spans: Vec<[f32; 2]>,
    /// Where each chord's spans begin, and where the last one's end.
    starts: Vec<usize>,
    /// 1 over the penumbra radius in pixels.
    factor: f32,
}

impl Chords {
    /// The chords of the points at height `y`, with distances along them from `x`.
    pub(super) fn place<'a>(
        &mut self,
        casters: impl ExactSizeIterator<Item = &'a Occluder> + Clone,
        x: f64,
        y: f64,
    ) {
        self.find_nodes(casters.clone(), y);
        self.hidden.resize_with(casters.len(), Spans::default);
        for (caster, hidden) in casters.zip(&mut self.hidden) {
            hidden.spans.clear();
            hidden.starts.clear();
            hidden.factor = (1.0 / caster.radius) as f32;
            let (low, high) = (y - caster.radius, y + caster.radius);
            self.near.clear();
            let meets = |edge: &&[DVec2; 2]| edge[0].y <= high && edge[1].y >= low;
            self.near.extend(caster.edges.iter().filter(meets));
            for node in &self.nodes {
                let level = y + caster.radius * node.height;
                hidden.starts.push(hidden.spans.len());
                self.crossings.clear();
                for [from, to] in &self.near {
                    if from.y <= level && level < to.y {
                        let share = (level - from.y) / (to.y - from.y);
                        self.crossings.push(from.x + share * (to.x - from.x) - x);
                    }
                }
                self.crossings.sort_by(f64::total_cmp);
                let pairs = self.crossings.chunks_exact(2);
                hidden
                    .spans
                    .extend(pairs.map(|pair| [pair[0] as f32, pair[1] as f32]));
            }
            hidden.starts.push(hidden.spans.len());
        }
    }

    fn find_nodes<'a>(&mut self, casters: impl Iterator<Item = &'a Occluder>, y: f64) {
        let heights = &mut self.heights;
        heights.clear();
        heights.extend(
            (0..=PIECES).map(|i| FRAC_PI_2 * (2.0 * f64::from(i) / f64::from(PIECES) - 1.0)),
        );
        for caster in casters {
            let height = |turn: &f64| (turn - y) / caster.radius;
            let inside = caster.turns.iter().map(height);
            heights.extend(inside.filter(|v| v.abs() < 1.0).map(asin));
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

    /// The density of one caster at the block's points, which are `offset` behind whole pixels.
    pub(super) fn density(&self, caster: usize, offset: f32, out: &mut [f32; BLOCK]) {
        let hidden = &self.hidden[caster];
        let mut sums = [0.0; BLOCK];
        for (index, node) in self.nodes.iter().enumerate() {
            for &[from, to] in hidden.of(index) {
                for (lane, sum) in sums.iter_mut().enumerate() {
                    let x = lane as f32 + offset;
                    let from = ((from - x) * hidden.factor).max(-node.half);
                    let to = ((to - x) * hidden.factor).min(node.half);
                    *sum += node.weight * (to - from).max(0.0);
                }
            }
        }
        *out = sums.map(|sum| sum.min(1.0));
    }

    /// The part of the disc that both of two casters hide from the block's points.
    pub(super) fn shared(&self, pair: [usize; 2], offset: f32, out: &mut [f32; BLOCK]) {
        let [a, b] = pair.map(|caster| &self.hidden[caster]);
        let mut sums = [0.0; BLOCK];
        for (index, node) in self.nodes.iter().enumerate() {
            for &[from_a, to_a] in a.of(index) {
                for &[from_b, to_b] in b.of(index) {
                    for (lane, sum) in sums.iter_mut().enumerate() {
                        let x = lane as f32 + offset;
                        let from = ((from_a - x) * a.factor)
                            .max((from_b - x) * b.factor)
                            .max(-node.half);
                        let to = ((to_a - x) * a.factor)
                            .min((to_b - x) * b.factor)
                            .min(node.half);
                        *sum += node.weight * (to - from).max(0.0);
                    }
                }
            }
        }
        *out = sums.map(|sum| sum.min(1.0));
    }

    /// What all casters hold back of the light at one point of the block, where `held` says what they do together of a ray that
    /// some of them hide (1) and others do not (0).
    pub(super) fn held(&mut self, x: f32, held: impl Fn(&[f32]) -> f32) -> f32 {
        let mut sum = 0.0;
        for (index, node) in self.nodes.iter().enumerate() {
            self.ends.clear();
            for (caster, hidden) in self.hidden.iter().enumerate() {
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
        }
        sum
    }
}

impl Spans {
    fn of(&self, chord: usize) -> &[[f32; 2]] {
        &self.spans[self.starts[chord]..self.starts[chord + 1]]
    }
}
