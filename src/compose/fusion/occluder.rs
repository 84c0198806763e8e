//! A caster as chords of the light's disc meet it: loops of lines.

use core::ops::Range;

use glam::DVec2;

use super::wedge::Border;
use crate::apart::around_points;
use crate::tilted::Circle;

/// Along an outline that runs by more than this for each step up, chords change faster than pieces of the disc's height tell.
const SLANTED: f64 = 1.0;

/// One caster as its chords need it. Each of its loops has an origin of its own, a whole pixel: what a pixel is given depends
/// neither on what else there is nor on the grid that shows it.
#[derive(Debug, Clone, Default)]
pub(super) struct Occluder {
    /// The penumbra radius in pixels.
    pub(super) radius: f64,
    loops: Vec<Loop>,
}

#[derive(Debug, Clone, Default)]
pub(super) struct Loop {
    /// In pixels from the scene's origin; all else from here.
    pub(super) base: DVec2,
    pub(super) min: DVec2,
    pub(super) max: DVec2,
    /// The outline's lines but the level ones, each from its lower y to its higher one.
    pub(super) edges: Vec<[DVec2; 2]>,
    /// Those of its edges along which chords change faster than pieces of the disc's height tell.
    pub(super) slanted: Vec<[DVec2; 2]>,
    /// All lines, each with the area on its left where y points up.
    pub(super) lines: Vec<[DVec2; 2]>,
    /// Where the outline turns up or down, and its level lines, from left to right: there the hidden part of a chord begins or
    /// ends at once.
    pub(super) turns: Vec<[DVec2; 2]>,
}

/// What of an occluder discs about points of some rows of pixels may meet, in the memory of that for others.
#[derive(Debug, Default)]
pub(super) struct NearRows {
    loops: Vec<Loop>,
    count: usize,
}

impl NearRows {
    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    pub(super) fn loops(&self) -> &[Loop] {
        &self.loops[..self.count]
    }

    fn push(&mut self) -> &mut Loop {
        if self.count == self.loops.len() {
            self.loops.push(Loop::default());
        }
        self.count += 1;
        &mut self.loops[self.count - 1]
    }
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

    /// Puts what discs about points between two heights may meet into `out`.
    pub(super) fn near_rows(&self, heights: Range<f64>, out: &mut NearRows) {
        for of_loop in &self.loops {
            let low = heights.start - of_loop.base.y - self.radius;
            let high = heights.end - of_loop.base.y + self.radius;
            if of_loop.min.y <= high && of_loop.max.y >= low {
                out.push().become_part(of_loop, low, high);
            }
        }
    }

    /// A whole pixel that depends on nothing but the loops about a point, and up to which x to the right of it that stays so. `near`
    /// is what rows of points with it may meet.
    pub(super) fn origin(&self, near: &NearRows, at: DVec2) -> (Option<DVec2>, f64) {
        let reach = self.radius + 1.0;
        let (mut origin, mut until) = (None, f64::MAX);
        for of_loop in near.loops() {
            let (base, at) = (of_loop.base, at - of_loop.base);
            let (left, right) = (of_loop.min.x - reach, of_loop.max.x + reach);
            if at.x < left {
                until = until.min(base.x + left);
            } else if at.x < right && at.y > of_loop.min.y - reach && at.y < of_loop.max.y + reach {
                until = until.min(base.x + right);
                origin = origin.or(Some(base));
            }
        }
        (origin, until)
    }

    /// The outline where the disc about a point meets it in a single line from one side to the other, or none; and up to which x to
    /// the right of the point that stays so. `near` is what rows of points with it may meet.
    pub(super) fn single_line(&self, near: &NearRows, at: DVec2) -> (Option<Border>, f64) {
        let reach = self.radius;
        let (mut count, mut single, mut until) = (0, None, f64::MAX);
        for of_loop in near.loops() {
            let (base, at) = (of_loop.base.x, at - of_loop.base);
            if at.x > of_loop.max.x + reach {
                continue;
            }
            if at.x < of_loop.min.x - reach {
                until = until.min(base + of_loop.min.x - reach);
                continue;
            }
            for &[from, to] in &of_loop.lines {
                let (low, high) = (from.min(to), from.max(to));
                if at.x > high.x + reach || low.y > at.y + reach || high.y < at.y - reach {
                    continue;
                }
                if at.x < low.x - reach {
                    until = until.min(base + low.x - reach);
                    continue;
                }
                until = until.min(base + high.x + reach);
                count += 1;
                let spans_rows = low.y <= at.y - reach && high.y >= at.y + reach;
                let spans_columns = at.x >= low.x + reach && at.x <= high.x - reach;
                if spans_columns {
                    until = until.min(base + high.x - reach);
                } else if at.x < low.x + reach {
                    until = until.min(base + low.x + reach);
                }
                if spans_rows || spans_columns {
                    single = Some((of_loop.base, from, to - from));
                }
            }
        }
        let border = |(base, from, along): (DVec2, DVec2, DVec2)| Border {
            base,
            from,
            along: along.normalize(),
            radius: self.radius,
        };
        (single.filter(|_| count == 1).map(border), until)
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

    pub(super) fn loops(&self) -> &[Loop] {
        &self.loops
    }
}

impl Loop {
    fn new(polygon: &[DVec2], scale: f64) -> Option<Self> {
        let (min, _) = around_points(polygon.iter().copied())?;
        let base = (min * scale).floor();
        let points: Vec<DVec2> = polygon.iter().map(|&point| point * scale - base).collect();
        let (min, max) = around_points(points.iter().copied())?;
        let mut of_loop = Self {
            base,
            min,
            max,
            ..Self::default()
        };
        let count = points.len();
        for (index, &from) in points.iter().enumerate() {
            let to = points[(index + 1) % count];
            let before = points[(index + count - 1) % count];
            if (from.y - before.y) * (to.y - from.y) < 0.0 {
                of_loop.turns.push([from; 2]);
            }
            of_loop.lines.push([from, to]);
            if from.y < to.y {
                of_loop.edges.push([from, to]);
            } else if to.y < from.y {
                of_loop.edges.push([to, from]);
            } else {
                of_loop.turns.push([from.min(to), from.max(to)]);
            }
        }
        let is_slanted =
            |[from, to]: &[DVec2; 2]| (to.x - from.x).abs() > SLANTED * (to.y - from.y);
        let edges = of_loop.edges.iter().copied();
        of_loop.slanted.extend(edges.filter(is_slanted));
        Some(of_loop)
    }

    /// Becomes what of another loop is between two heights.
    fn become_part(&mut self, of: &Self, low: f64, high: f64) {
        (self.base, self.min, self.max) = (of.base, of.min, of.max);
        for (part, all) in [
            (&mut self.edges, &of.edges),
            (&mut self.slanted, &of.slanted),
            (&mut self.lines, &of.lines),
            (&mut self.turns, &of.turns),
        ] {
            let is_between = |[a, b]: &[DVec2; 2]| a.y.min(b.y) <= high && a.y.max(b.y) >= low;
            part.clear();
            part.extend(all.iter().copied().filter(is_between));
        }
    }
}
