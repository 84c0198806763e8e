//! The pixels that lie wholly inside an outline, row by row.
//!
//! An edge keeps a run of each row's pixels from being wholly inside, those that it passes. Between such runs all pixels
//! of a row have one winding number, and it changes by the edges that cross the row's middle.

use core::f64::consts::SQRT_2;

use glam::DVec2;

use crate::density::frame::whole_below;
use crate::outline::{Arc, Edge};

/// A line that is not left of or right of what it stands for by more than a margin.
#[derive(Debug, Clone, Copy, Default)]
struct Line {
    upper: DVec2,
    lower: DVec2,
    slope: f64,
    margin: f64,
    /// By how much the winding number is larger right of it.
    winding: i32,
    /// The rows that it may pass: the first, and the first behind them.
    rows: [u32; 2],
}

/// The part of a line in one row.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    winding: i32,
    /// The first column that it may pass and the first behind it that it does not.
    left: i32,
    right: i32,
}

/// Memory for the lines of one outline.
#[derive(Debug, Default)]
pub(crate) struct Inside {
    lines: Vec<Line>,
    /// The same by their first rows, and where each row's begin.
    sorted: Vec<Line>,
    starts: Vec<u32>,
    /// Those that may pass a row, and what they do there.
    active: Vec<u32>,
    crossings: Vec<Crossing>,
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
        self.lines.clear();
        for edge in edges {
            match edge {
                Edge::Line(line) | Edge::Border(line) => {
                    self.lines
                        .extend(Line::new(line.from, line.to, margin, height));
                }
                Edge::Arc(arc) => self.push_arc(&arc, margin, height),
            }
        }
        let Self {
            lines,
            sorted,
            starts,
            active,
            crossings,
        } = self;
        sort_by_row(lines, |line| line.rows[0], height, sorted, starts);
        active.clear();
        let columns = width as i32;
        for row in 0..height {
            active.extend(starts[row as usize]..starts[row as usize + 1]);
            active.retain(|&line| row < sorted[line as usize].rows[1]);
            crossings.clear();
            crossings.extend(active.iter().map(|&line| sorted[line as usize].in_row(row)));
            crossings.sort_unstable_by_key(|crossing| crossing.left);
            let (mut winding, mut passed) = (0, 0);
            for crossing in &*crossings {
                let end = crossing.left.min(columns);
                if winding != 0 && end > passed {
                    push(row, passed as u32, end as u32);
                }
                passed = passed.max(crossing.right);
                winding += crossing.winding;
            }
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
            self.lines
                .extend(Line::new(from, to, margin.max(FLATNESS), height));
            from = to;
        }
    }
}

impl Line {
    /// None if it passes no row.
    #[inline(always)]
    fn new(from: DVec2, to: DVec2, margin: f64, height: u32) -> Option<Self> {
        let (upper, lower, winding) = if from.y < to.y {
            (from, to, 1)
        } else {
            (to, from, -1)
        };
        let first = (upper.y - margin).floor().max(0.0);
        let end = (lower.y + margin).ceil().min(f64::from(height));
        (first < end).then(|| Self {
            upper,
            lower,
            slope: (lower.x - upper.x) / (lower.y - upper.y),
            margin,
            winding,
            rows: [first as u32, end as u32],
        })
    }

    #[inline(always)]
    fn in_row(&self, row: u32) -> Crossing {
        let Self {
            upper,
            lower,
            slope,
            margin,
            ..
        } = *self;
        let (least, most) = (upper.x.min(lower.x), upper.x.max(lower.x));
        let y = f64::from(row);
        // A level line is passed by all of its row.
        let (left, right) = if upper.y == lower.y {
            (least, most)
        } else {
            let at = |y: f64| (upper.x + (y - upper.y) * slope).clamp(least, most);
            // What it stands for may pass the row where the line itself is so much above or below.
            let (top, bottom) = (at(y - margin), at(y + 1.0 + margin));
            (top.min(bottom), top.max(bottom))
        };
        let crosses = upper.y <= y + 0.5 && y + 0.5 < lower.y;
        Crossing {
            winding: if crosses { self.winding } else { 0 },
            left: column(left - margin),
            right: -column(-right - margin),
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
