//! Long straight sides, folded away.
//!
//! Where all of an outline runs along an axis for longer than a disc is wide, density does not change along it. There the plane is
//! cut across and what lies between is taken out, squares are halved over what is left, and it is put back as
//! rectangles from one side of the cut to the other: exact, and of no more triangles however long it is.

use core::iter::once;

use glam::DVec2;

use super::SIDE;
use super::finer::Spot;
use crate::outline::{Edge, bounds};

/// Samples that a fold keeps from what bends density, beyond the penumbra radius: bends are seen from two away.
const CLEAR: f64 = 3.0;

/// The cuts across both axes.
#[derive(Debug, Default)]
pub(super) struct Folds {
    /// Across each axis, where the cuts are, in samples of what is left, and how much is taken out there and before, in scene
    /// units.
    cuts: [Vec<(usize, f64)>; 2],
    /// Where density changes along an axis.
    busy: Vec<[f64; 2]>,
}

/// On which side of the cuts through a sample something lies, across each axis: behind them or before.
pub(super) type Sides = [bool; 2];

impl Folds {
    /// Forgets all cuts.
    pub(super) fn clear(&mut self) {
        for cuts in &mut self.cuts {
            cuts.clear();
        }
    }

    /// Finds those of an outline whose first sample is at `corner`, `pitch` from sample to sample.
    pub(super) fn find(&mut self, edges: &[Edge], radius: f64, corner: DVec2, pitch: f64) {
        let clear = radius + CLEAR * pitch;
        let square = pitch * SIDE as f64;
        for axis in 0..2 {
            let (cuts, busy) = (&mut self.cuts[axis], &mut self.busy);
            cuts.clear();
            busy.clear();
            for edge in edges {
                let Some((min, max)) = bounds(once(edge)) else {
                    continue;
                };
                // They are those of a loop's edges, each without its end.
                let (min, max) = (min.min(edge.to()), max.max(edge.to()));
                let ends = [min[axis], max[axis]];
                if !matches!(edge, Edge::Arc(_)) && min[1 - axis] == max[1 - axis] {
                    busy.extend(ends.map(|end| [end, end]));
                } else {
                    busy.push(ends);
                }
            }
            busy.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
            let (mut end, mut taken) = (f64::INFINITY, 0.0);
            for &[from, to] in &*busy {
                // Cuts lie between whole squares.
                let squares = ((end + clear - corner[axis] - taken) / square).ceil();
                let room = from - clear - corner[axis] - taken - squares * square;
                if room > square {
                    taken += room;
                    cuts.push((squares as usize * SIDE, taken));
                }
                end = if end == f64::INFINITY {
                    to
                } else {
                    end.max(to)
                };
            }
        }
    }

    /// An edge of the outline once what lies between cuts is taken out. `corner` and `pitch` are those of the samples.
    pub(super) fn fold(&self, edge: &Edge, corner: DVec2, pitch: f64) -> Edge {
        let fold = |point: DVec2| {
            let taken = |axis: usize| {
                let mut taken = 0.0;
                for &(cut, next) in &self.cuts[axis] {
                    if point[axis] - taken > corner[axis] + cut as f64 * pitch {
                        taken = next;
                    }
                }
                taken
            };
            point - DVec2::new(taken(0), taken(1))
        };
        match edge {
            // No cut goes through an arc, but its centre may lie anywhere.
            Edge::Arc(arc) => {
                let offset = fold(arc.from) - arc.from;
                edge.mapped(1.0, |point| point + offset)
            }
            _ => edge.mapped(1.0, fold),
        }
    }

    /// Whether there is a cut.
    pub(super) fn any(&self) -> bool {
        self.cuts.iter().any(|cuts| !cuts.is_empty())
    }

    /// How far behind its place among what is left a spot is, on one side of the cuts through it.
    pub(super) fn offset(&self, spot: Spot, sides: Sides) -> DVec2 {
        let offset = |axis: usize| {
            let mut offset = 0.0;
            for &(cut, taken) in &self.cuts[axis] {
                if 2 * cut < spot[axis] || 2 * cut == spot[axis] && sides[axis] {
                    offset = taken;
                }
            }
            offset
        };
        DVec2::new(offset(0), offset(1))
    }

    /// Across which axes a cut goes through a spot.
    pub(super) fn through(&self, spot: Spot) -> [bool; 2] {
        [0, 1].map(|axis| {
            let mut cuts = self.cuts[axis].iter();
            cuts.any(|&(cut, _)| 2 * cut == spot[axis])
        })
    }

    /// The spots where cuts cross.
    pub(super) fn crossings(&self) -> impl Iterator<Item = Spot> {
        let [columns, rows] = &self.cuts;
        let column = |&(x, _): &(usize, f64)| rows.iter().map(move |&(y, _)| [2 * x, 2 * y]);
        columns.iter().flat_map(column)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::at_point;
    use crate::outline::Outline;
    use crate::path::FillRule;
    use crate::shape::Shape;

    #[test]
    fn what_is_left_of_an_outline_has_the_densities_that_all_of_it_has() {
        let ell = [
            [0.0, 0.0],
            [300.0, 0.0],
            [300.0, 60.0],
            [100.0, 60.0],
            [100.0, 400.0],
            [0.0, 400.0],
        ];
        let shapes = [
            Shape::polygon(&[ell], FillRule::NonZero).unwrap(),
            Shape::rounded_rect(3.0, 5.0, 200.0, 250.0, [3.0, 0.0, 40.0, 20.0]).unwrap(),
        ];
        let (radius, pitch) = (8.0, 0.5);
        for shape in shapes {
            let outline = Outline::of_simple(&shape).unwrap();
            let edges: Vec<Edge> = outline.edges().copied().collect();
            let corner = outline.bounds().unwrap().0 - 10.0;
            let mut folds = Folds::default();
            folds.find(&edges, radius, corner, pitch);
            assert!(folds.cuts.iter().all(|cuts| !cuts.is_empty()));
            let fold = |edge| folds.fold(edge, corner, pitch);
            let folded: Vec<Edge> = edges.iter().map(fold).collect();
            for y in (0..2_000).step_by(32) {
                for x in (0..2_000).step_by(32) {
                    for sides in [[false, false], [true, true]] {
                        let place = corner
                            + DVec2::new(f64::from(x as u32), f64::from(y as u32)) * pitch / 2.0;
                        let whole = place + folds.offset([x, y], sides);
                        let density = at_point(folded.iter(), place, radius);
                        assert!((density - at_point(edges.iter(), whole, radius)).abs() < 1e-9);
                    }
                }
            }
        }
    }
}
