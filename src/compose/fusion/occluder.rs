//! A caster as chords of the light's disc meet it: loops of lines.

use glam::DVec2;

use crate::tilted::Circle;

/// One caster as its chords need it. Each of its loops has an origin of its own, a whole pixel: what a pixel is given depends
/// neither on what else there is nor on the grid that shows it.
#[derive(Debug, Clone, Default)]
pub(super) struct Occluder {
    /// The penumbra radius in pixels.
    pub(super) radius: f64,
    pub(super) loops: Vec<Loop>,
}

#[derive(Debug, Clone)]
pub(super) struct Loop {
    /// In pixels from the scene's origin; all else from here.
    pub(super) base: DVec2,
    pub(super) min: DVec2,
    pub(super) max: DVec2,
    /// The outline's lines but the level ones, each from its lower y to its higher one.
    pub(super) edges: Vec<[DVec2; 2]>,
    /// All lines, each with the area on its left where y points up.
    lines: Vec<[DVec2; 2]>,
    /// Where the outline turns up or down, and its level lines, from left to right: there the hidden part of a chord begins or
    /// ends at once.
    pub(super) turns: Vec<[DVec2; 2]>,
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

    /// Puts the loops that discs about points of the pixels' row that begins at height `y` may meet into `out`.
    pub(super) fn near_row(&self, y: f64, out: &mut Vec<usize>) {
        let is_near = |(index, of_loop): (usize, &Loop)| {
            let y = y - of_loop.base.y;
            let meets = of_loop.min.y <= y + 1.0 + self.radius && of_loop.max.y >= y - self.radius;
            meets.then_some(index)
        };
        out.extend(self.loops.iter().enumerate().filter_map(is_near));
    }

    /// The direction of the outline where the disc about a point meets it in a single line from one side to the other, or none;
    /// and up to which x to the right of the point that stays so. `near` are the loops that the point's row may meet.
    pub(super) fn single_line(&self, near: &[usize], at: DVec2) -> (Option<DVec2>, f64) {
        let reach = self.radius;
        let (mut count, mut single, mut until) = (0, None, f64::MAX);
        for of_loop in near.iter().map(|&index| &self.loops[index]) {
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
                    single = Some(to - from);
                }
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
            min: points.iter().copied().fold(DVec2::MAX, DVec2::min),
            max: points.iter().copied().fold(DVec2::MIN, DVec2::max),
            edges: Vec::new(),
            lines: Vec::new(),
            turns: Vec::new(),
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
        Some(of_loop)
    }
}
