//! Where the vertices of a corner belong: on the knots of rays from its pole, and along the rings that join them.

use core::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4};
use core::ops::Range;

use glam::DVec2;
use libm::{ceil, cos, sin};

use super::corner::Corner;
use super::ray::{Knot, Ray, STEPS, span};

/// The distance between rays where the corner begins and ends to be felt, in penumbra radii along the outline.
const SPACING: f64 = 0.2;

/// Rays over the rest of a large corner's arc.
const ARC_RAYS: u32 = 4;

/// A vertex about the pole, in penumbra radii.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    pub(super) at: DVec2,
    pub(super) density: f64,
}

impl Point {
    /// Where it comes round the pole: 0 along the x axis, 1 along the y axis.
    pub(super) fn turn(&self) -> f64 {
        let sum = self.at.x + self.at.y;
        if sum > 0.0 { self.at.y / sum } else { 0.5 }
    }
}

/// How many rings there are between the outermost and the innermost loop, and how wrong they may be, in density.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Rings {
    /// Rings outside of where the density is steepest.
    pub(super) outside: usize,
    /// Rings inside of there.
    pub(super) inside: usize,
    /// The error of pieces along a ring.
    pub(super) along: f64,
    /// Whether rings have vertices where corners begin and end.
    pub(super) anchored: bool,
}

impl Rings {
    pub(super) fn count(&self) -> usize {
        self.outside + self.inside
    }
}

/// How much a ring bends, and how much of it up to where the umbra has its corner, if that is beside the ring.
#[derive(Debug, Clone, Copy)]
struct RingBends {
    total: f64,
    tip: Option<f64>,
}

impl RingBends {
    /// How many vertices the ring takes before the umbra's corner, if that has one, and how many after.
    fn counts(&self, rings: &Rings) -> [f64; 2] {
        let most = 4.0 * rings.along.sqrt();
        match self.tip {
            // Without a vertex there the last ring could cut the corner of a sharp umbra.
            Some(tip) if !rings.anchored => {
                [tip, self.total - tip].map(|bend| ceil((bend / most - 0.5).max(0.0)))
            }
            tip if rings.anchored => {
                let tip = tip.unwrap_or(self.total);
                [tip, self.total - tip].map(|bend| ceil(bend / most))
            }
            // Half of a step into a corner serves as well as where it begins, unless the corner beyond the side differs.
            _ => [ceil(self.total / most).max(1.0), 0.0],
        }
    }
}

/// How many vertices each ring has, before the corner of the umbra and after it where the ring has one there.
pub(super) type Counts = Vec<[f64; 2]>;

/// The rays and vertices of one corner. Its pole is the origin.
#[derive(Debug, Clone, Default)]
pub(super) struct Fan {
    rays: Vec<Ray>,
    /// Those of the ring that is being placed.
    knots: Vec<Knot>,
    pub(super) points: Vec<Point>,
    /// Where in `points` each ring ends.
    ends: Vec<usize>,
}

/// The bends of a corner, where they are largest: along a ray outside and inside of the steepest point, and along the
/// steepest ring.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Bends {
    pub(super) outside: f64,
    pub(super) inside: f64,
    pub(super) along: f64,
}

impl Bends {
    pub(super) fn max(self, other: Self) -> Self {
        Self {
            outside: self.outside.max(other.outside),
            inside: self.inside.max(other.inside),
            along: self.along.max(other.along),
        }
    }
}

impl Fan {
    /// Samples the corner.
    pub(super) fn sample(&mut self, corner: &Corner) -> Bends {
        self.rays.clear();
        let tip = corner.tip;
        let round = corner.radii[0];
        let reach = |axis: usize| (tip[axis] - round + 1.0).min(tip[axis]);
        let (up, across) = (reach(1), reach(0));
        let count = |length: f64| ceil(length / SPACING).max(3.0) as u32;
        let (ups, acrosses) = (count(up), count(across));
        for i in 0..ups {
            let y = up * f64::from(i) / f64::from(ups);
            self.rays.push(Ray::new(corner, DVec2::new(tip.x, y)));
        }
        let (first, last) = (DVec2::new(tip.x, up), DVec2::new(across, tip.y));
        let between = if first == last { 0 } else { ARC_RAYS };
        for i in 0..between {
            let share = f64::from(i) / f64::from(between);
            self.rays.push(Ray::new(corner, first.lerp(last, share)));
        }
        for i in (0..=acrosses).rev() {
            let x = across * f64::from(i) / f64::from(acrosses);
            self.rays.push(Ray::new(corner, DVec2::new(x, tip.y)));
        }
        let mut bends = Bends::default();
        for ray in &self.rays {
            bends.outside = bends.outside.max(ray.outside);
            bends.inside = bends.inside.max(ray.inside);
        }
        let steepest = |ray: &Ray| {
            let step = ray.steepest;
            (ray.direction * ray.distances[step], ray.gradients[step])
        };
        bends.along = self
            .rays
            .windows(2)
            .map(|pair| bend(steepest(&pair[0]), steepest(&pair[1])))
            .sum();
        bends
    }

    /// The least widths of the outermost and the innermost strip.
    fn end_widths(&self, rings: &Rings) -> [f64; 2] {
        let widths = |ray: &Ray| {
            let [inner, outer] = [ray.distances[0], ray.distances[STEPS]];
            let Some(last) = rings.count().checked_sub(1) else {
                return [outer - inner; 2];
            };
            let [first, last] = [0, last].map(|ring| ray.knot(ring, rings).distance);
            [outer - first, last - inner]
        };
        let least = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].min(b[1])];
        self.rays.iter().map(widths).fold([f64::INFINITY; 2], least)
    }

    /// Counts the vertices of every ring, if they are more than were counted before; no where the outermost or the innermost
    /// strip has no width.
    pub(super) fn count(&mut self, corner: &Corner, rings: &Rings, counts: &mut Counts) -> bool {
        let [outer, inner] = self.end_widths(rings);
        let umbra = corner.has_umbra();
        if outer < NARROWEST || (umbra && inner < NARROWEST) {
            return false;
        }
        let round = corner.radii[0];
        counts.resize(rings.count() + 2, [0.0; 2]);
        let mut more = |ring: usize, [before, after]: [f64; 2]| {
            let [b, a] = counts[ring];
            counts[ring] = [before.max(b), after.max(a)];
        };
        more(0, [tangents(round + 1.0, BEYOND * outer), 0.0]);
        for ring in 0..rings.count() {
            let bends = self.find_knots(corner, rings, ring);
            more(ring + 1, bends.counts(rings));
        }
        if umbra {
            more(
                rings.count() + 1,
                [tangents(round - 1.0, BEYOND * inner), 0.0],
            );
        }
        true
    }

    /// Places so many vertices of every ring.
    pub(super) fn place(&mut self, corner: &Corner, rings: &Rings, counts: &Counts) {
        self.points.clear();
        self.ends.clear();
        let round = corner.radii[0];
        self.arc(corner.tip - round, round + 1.0, counts[0][0], 0.0);
        for ring in 0..rings.count() {
            let bends = self.find_knots(corner, rings, ring);
            self.place_ring(corner, rings, &bends, counts[ring + 1]);
        }
        if corner.has_umbra() {
            let center = corner.tip - round.max(1.0);
            self.arc(center, round - 1.0, counts[rings.count() + 1][0], 1.0);
        } else {
            let pole = Point {
                at: DVec2::ZERO,
                density: corner.density(DVec2::ZERO),
            };
            self.points.push(pole);
            self.ends.push(self.points.len());
        }
    }

    /// Which of the points are a ring's, from the x axis on.
    pub(super) fn ring(&self, ring: usize) -> Range<usize> {
        let start = if ring == 0 { 0 } else { self.ends[ring - 1] };
        start..self.ends[ring]
    }

    /// So many tangents' corners along a quarter circle.
    fn arc(&mut self, center: DVec2, radius: f64, count: f64, density: f64) {
        if radius <= 0.0 {
            self.points.push(Point {
                at: center,
                density,
            });
        } else {
            let half = FRAC_PI_4 / count;
            let reach = radius / cos(half);
            let (mut direction, turn) = (
                DVec2::new(cos(half), sin(half)),
                DVec2::new(cos(2.0 * half), sin(2.0 * half)),
            );
            for _ in 0..count as u32 {
                self.points.push(Point {
                    at: center + direction * reach,
                    density,
                });
                direction = turn.rotate(direction);
            }
        }
        self.ends.push(self.points.len());
    }

    /// Finds where a ring between the outermost loop and the innermost meets the rays, and how it bends.
    fn find_knots(&mut self, corner: &Corner, rings: &Rings, ring: usize) -> RingBends {
        self.knots.clear();
        let knots = self.rays.iter().map(|ray| ray.knot(ring, rings));
        self.knots.extend(knots);
        let pieces = self.knots.len() - 1;
        let sharp = (1.0 - corner.radii[0] / SHARP).max(0.0);
        let geometry = GEOMETRY + SHARP_GEOMETRY * sharp;
        for piece in 0..pieces {
            let way = |piece: usize| self.knots[piece + 1].at() - self.knots[piece].at();
            let [a, b] = [self.knots[piece], self.knots[piece + 1]];
            let along = (b.gradient - a.gradient).dot(way(piece)).abs();
            // Where density bends less than the ring does, lines between few vertices would cross other rings.
            // Beyond its ends it is straight, or goes on as its own mirror image.
            let before = if piece == 0 { DVec2::Y } else { way(piece - 1) };
            let after = if piece + 1 == pieces {
                DVec2::NEG_X
            } else {
                way(piece + 1)
            };
            let turn = before
                .normalize_or_zero()
                .perp_dot(after.normalize_or_zero());
            let slope = f64::midpoint(a.gradient.length(), b.gradient.length());
            let around = slope * way(piece).length() * turn.abs() / 2.0;
            self.knots[piece].bend = along.max(geometry * around).sqrt();
        }
        let last = ring + 1 == rings.count();
        RingBends {
            total: self.knots[..pieces].iter().map(|knot| knot.bend).sum(),
            tip: self.tip_bend(corner).filter(|_| last),
        }
    }

    /// Places the vertices of the ring whose knots were found.
    fn place_ring(
        &mut self,
        corner: &Corner,
        rings: &Rings,
        bends: &RingBends,
        [before, after]: [f64; 2],
    ) {
        let total = bends.total;
        match bends.tip {
            Some(tip) if !rings.anchored => {
                let step = tip / (before + 0.5);
                self.place_knots(corner, step / 2.0, step, before);
                let step = (total - tip) / (after + 0.5);
                self.place_knots(corner, tip, step, after + 1.0);
            }
            tip if rings.anchored => {
                let tip = tip.unwrap_or(total);
                self.place_knots(corner, 0.0, tip / before.max(1.0), before);
                let step = (total - tip) / after.max(1.0);
                self.place_knots(corner, tip, step, after + 1.0);
            }
            _ => {
                let step = total / before;
                self.place_knots(corner, step / 2.0, step, before);
            }
        }
        self.ends.push(self.points.len());
    }

    /// How far the ring of `knots` bends up to where the umbra has its corner, if there is one.
    fn tip_bend(&self, corner: &Corner) -> Option<f64> {
        if !corner.has_umbra() {
            return None;
        }
        let round = corner.radii[0].max(1.0);
        let tip = corner.tip - round + (round - 1.0) * FRAC_1_SQRT_2;
        let mut bent = 0.0;
        for pair in self.knots.windows(2) {
            let [a, b] = [&pair[0], &pair[1]].map(|knot| knot.direction.perp_dot(tip));
            if b <= 0.0 {
                let share = if a > b {
                    (a / (a - b)).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                return Some(bent + pair[0].bend * share);
            }
            bent += pair[0].bend;
        }
        Some(bent)
    }

    /// Places vertices along the ring of `knots`: where it has bent by `first`, and `count` in all, each a `step` on.
    fn place_knots(&mut self, corner: &Corner, first: f64, step: f64, count: f64) {
        let pieces = self.knots.len() - 1;
        let (mut piece, mut done) = (0, 0.0);
        for i in 0..count as u32 {
            let bent = first + step * f64::from(i);
            while piece + 1 < pieces && bent > done + self.knots[piece].bend {
                done += self.knots[piece].bend;
                piece += 1;
            }
            let [a, b] = [&self.knots[piece], &self.knots[piece + 1]];
            let share = if a.bend > 0.0 {
                ((bent - done) / a.bend).clamp(0.0, 1.0)
            } else {
                0.0
            };
            let direction = a.direction.lerp(b.direction, share).normalize();
            let [from, to] = span(corner, direction);
            let place = a.place + (b.place - a.place) * share;
            let at = direction * (from + (to - from) * place);
            let offset = a.offset + (b.offset - a.offset) * share + step * step / 16.0;
            self.points.push(Point {
                at,
                density: (corner.density(at) + offset).clamp(0.0, 1.0),
            });
        }
    }
}

/// The part of a ring's own bends that counts where density bends less, and what a sharp corner adds to it: along its
/// sides rings leave their straight way at once.
const GEOMETRY: f64 = 0.6;
const SHARP_GEOMETRY: f64 = 0.9;

/// Corners are sharp up to this radius, in penumbra radii.
const SHARP: f64 = 0.05;

/// The narrowest strip beside them, in penumbra radii: one without width would take chords without end.
const NARROWEST: f64 = 1e-3;

/// How far the corners of the two outermost loops may be from their arcs, over the width of the strip beside them.
const BEYOND: f64 = 0.08;

/// How many tangents of a quarter circle have no corner more than `beyond` away from it.
fn tangents(radius: f64, beyond: f64) -> f64 {
    if radius <= 0.0 {
        return 0.0;
    }
    // 1 / cos - 1 is about half of the square.
    ceil(FRAC_PI_4 / (2.0 * beyond / radius).sqrt()).max(1.0)
}

/// How much density bends from one place with its gradient to another: the root of length times change of slope.
fn bend(from: (DVec2, DVec2), to: (DVec2, DVec2)) -> f64 {
    let way = to.0 - from.0;
    // Length times change of slope along the way: its length is in there twice.
    (to.1 - from.1).dot(way).abs().sqrt()
}
