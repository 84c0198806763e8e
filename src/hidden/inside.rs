//! The pixels that lie wholly inside an outline, row by row.
//!
//! An edge keeps a run of each row's pixels from being wholly inside, those that it passes. Between such runs all pixels
//! of a row have one winding number, and it changes by the edges that cross the row's middle.

use core::f64::consts::SQRT_2;

use glam::DVec2;

use crate::density::frame::whole_below;
use crate::outline::{Arc, Edge};

/// The part of an edge in one row.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Crossing {
    row: u32,
    /// By how much the winding number is larger right of it.
    winding: i32,
    /// The first column that it may pass and the first behind it that it does not.
    left: i32,
    right: i32,
}

/// Memory for the crossings of one outline.
#[derive(Debug, Default)]
pub(crate) struct Inside {
    crossings: Vec<Crossing>,
    /// The same row by row, and where each row's begin.
    sorted: Vec<Crossing>,
    starts: Vec<u32>,
}

/// Beyond all columns that a grid may have.
const FAR: f64 = 2e9;

/// How far from a curve the lines in its place may be, in pixels: so much is kept from them.
pub(crate) const FLATNESS: f64 = 1.0 / 16.0;

impl Inside {
    /// Calls `push` with row, first column and end of each run of pixels that lie wholly inside of edges in pixels, whose
    /// straight ones are `margin` pixels at most from what they stand for. Rows and columns are those of a grid of `size`.
    pub(crate) fn find(
        &mut self,
        edges: impl Iterator<Item = Edge>,
        margin: f64,
        [width, height]: [u32; 2],
        mut push: impl FnMut(u32, u32, u32),
    ) {
        self.crossings.clear();
        for edge in edges {
            match edge {
                Edge::Line(line) | Edge::Border(line) => {
                    self.push_line(line.from, line.to, margin, height);
                }
                Edge::Arc(arc) => self.push_arc(&arc, margin, height),
            }
        }
        sort_by_row(
            &self.crossings,
            |crossing| crossing.row,
            height,
            &mut self.sorted,
            &mut self.starts,
        );
        let columns = width as i32;
        for row in 0..height {
            let range = self.starts[row as usize] as usize..self.starts[row as usize + 1] as usize;
            let crossings = &mut self.sorted[range];
            crossings.sort_unstable_by_key(|crossing| crossing.left);
            let (mut winding, mut reached) = (0, 0);
            for crossing in &*crossings {
                let end = crossing.left.min(columns);
                if winding != 0 && end > reached {
                    push(row, reached as u32, end as u32);
                }
                reached = reached.max(crossing.right);
                winding += crossing.winding;
            }
        }
    }

    fn push_line(&mut self, from: DVec2, to: DVec2, margin: f64, height: u32) {
        let (upper, lower, sign) = if from.y < to.y {
            (from, to, 1)
        } else {
            (to, from, -1)
        };
        let first = (upper.y - margin).floor().max(0.0);
        let end = (lower.y + margin).ceil().min(f64::from(height));
        if first >= end {
            return;
        }
        let slope = if upper.y < lower.y {
            (lower.x - upper.x) / (lower.y - upper.y)
        } else {
            0.0
        };
        let (least, most) = (upper.x.min(lower.x), upper.x.max(lower.x));
        let at = |y: f64| (upper.x + (y - upper.y) * slope).clamp(least, most);
        // A level line is passed by all of its row.
        let level = upper.y == lower.y;
        for row in first as u32..end as u32 {
            let y = f64::from(row);
            // What it stands for may pass the row where the line itself is so much above or below.
            let (top, bottom) = (at(y - margin), at(y + 1.0 + margin));
            let crosses = upper.y <= y + 0.5 && y + 0.5 < lower.y;
            let (left, right) = if level {
                (least, most)
            } else {
                (top.min(bottom), top.max(bottom))
            };
            self.crossings.push(Crossing {
                row,
                winding: if crosses { sign } else { 0 },
                left: column(left - margin),
                right: -column(-right - margin),
            });
        }
    }

    /// As chords that are [`FLATNESS`] pixels at most from it.
    fn push_arc(&mut self, arc: &Arc, margin: f64, height: u32) {
        // A chord's sagitta is radius angle² / 8.
        let angle = (8.0 * FLATNESS / arc.radius.max(FLATNESS))
            .sqrt()
            .min(SQRT_2);
        let count = (arc.sweep.abs() / angle).ceil().max(1.0);
        let step = arc.sweep / count;
        let turn = DVec2::new(libm::cos(step), libm::sin(step));
        let (mut from, mut spoke) = (arc.from, arc.from - arc.center);
        for index in 1..=count as u64 {
            spoke = turn.rotate(spoke);
            let to = if index as f64 == count {
                arc.to
            } else {
                arc.center + spoke
            };
            self.push_line(from, to, margin.max(FLATNESS), height);
            from = to;
        }
    }
}

/// The column that an x is in; what is far left or right is held at [`FAR`].
fn column(x: f64) -> i32 {
    whole_below(x.clamp(-FAR, FAR)) as i32
}

/// Sorts items by their rows, each row's as they were, into `sorted`; row n's begin at `starts[n]`.
pub(super) fn sort_by_row<T: Copy + Default>(
    items: &[T],
    row: impl Fn(&T) -> u32,
    rows: u32,
    sorted: &mut Vec<T>,
    starts: &mut Vec<u32>,
) {
    starts.clear();
    starts.resize(rows as usize + 1, 0);
    for item in items {
        starts[row(item) as usize] += 1;
    }
    let mut sum = 0;
    for start in starts.iter_mut() {
        sum += *start;
        *start = sum;
    }
    sorted.clear();
    sorted.resize(items.len(), T::default());
    for item in items.iter().rev() {
        let start = &mut starts[row(item) as usize];
        *start -= 1;
        sorted[*start as usize] = *item;
    }
}
