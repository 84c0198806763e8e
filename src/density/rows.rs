//! Rows of densities in single precision: the outline's pieces that a row of discs can meet, the columns that each of
//! them varies on, and constants between.
//!
//! What a piece adds is constant left and right of the columns near it, so a row is a list of spans, most of them
//! constant, and steps between. The steps are whole numbers that cancel along a closed loop: outside of the shadow the
//! density is 0 and in the umbra 1, exactly, however many pieces there are.

mod arcs;
mod bands;
mod chains;
mod entries;
mod kernels;
mod pieces;
mod points;
mod seen;
mod spans;
mod stroke;

pub(crate) use arcs::{Power, circle};
pub(crate) use bands::{BAND, Bands, to_tiles};
pub(crate) use kernels::{Wide, half_disc, half_discs, line_at, turns, whole_disc};
pub(crate) use pieces::{ERROR, Slant, arc_chord, each_line, sort};
pub(crate) use points::{Line, Points, Window};

use core::ops::Range;

use fearless_simd::{Simd, SimdBase, f32x16};
use glam::DVec2;

use super::Sink;
use super::lanes::{LANES, lanes};
use super::sweep::Sweep;
use crate::outline::Edge;
use chains::Passing;
use entries::{ALL, Entry, Maker, UNIT, cluster};
use pieces::Piece;
use seen::View;
use spans::Spans;
use stroke::{RowForm, Stroke};

/// Draws rows of one outline, from top to bottom.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    pieces: Vec<Piece>,
    sweep: Sweep,
    entries: Vec<Entry>,
    /// The entries by their first column.
    order: Vec<u32>,
    /// Steps left of the columns that are drawn.
    before: i64,
    y: f64,
    /// Where the entries of a cluster end, and their steps.
    steps: Vec<(i64, i64)>,
    spans: Spans<1>,
    /// Up to where rows are the same as the last.
    still_until: f64,
}

/// Where rows and columns are, in the windows' unit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lattice {
    pub(crate) window: Window,
    /// The x of column 0, and from column to column.
    pub(crate) start: f64,
    pub(crate) pitch: f64,
    /// Columns a unit.
    pub(crate) density: f64,
}

/// Columns of an entry that begins at `first` in stretches, counted from there, each with where it is seen from: after so many columns a
/// piece's numbers are taken anew in double precision, as beyond single precision would show.
#[inline(always)]
fn stretches(first: i64, columns: Range<i64>) -> impl Iterator<Item = (i64, Range<i64>)> {
    const STRETCH: i64 = 512;
    let mut at = columns.start;
    core::iter::from_fn(move || {
        let origin = first + (at - first) / STRETCH * STRETCH;
        let stretch = at..(origin + STRETCH).min(columns.end);
        at = stretch.end;
        (!stretch.is_empty()).then_some((origin, stretch))
    })
}

impl Rows {
    /// Takes the outline's edges, in the windows' unit, for windows of the kind given and pixels that average over these points.
    pub(crate) fn load(
        &mut self,
        edges: impl Iterator<Item = Edge>,
        window: Window,
        points: &Points<'_>,
    ) {
        pieces::cut(edges, window, points.wide.as_ref(), &mut self.pieces);
        self.rewind();
    }

    /// Back to the top.
    pub(crate) fn rewind(&mut self) {
        self.sweep.rewind();
        self.still_until = f64::NEG_INFINITY;
    }

    /// Whether the row at `y` is the same as the last.
    pub(crate) fn is_still(&self, y: f64) -> bool {
        y < self.still_until
    }

    /// Goes to the row of pixels at `y`, below the last. Only `columns` will be asked for.
    pub(crate) fn go_to(
        &mut self,
        y: f64,
        columns: Range<i64>,
        lattice: &Lattice,
        points: &Points<'_>,
    ) {
        let reach = lattice.window.reach() + points.height();
        let pieces = &self.pieces;
        self.sweep
            .go_to(pieces, [y - reach, y + reach], |p| [p.low, p.high]);
        self.entries.clear();
        self.before = 0;
        self.y = y;
        let next = self.sweep.ahead(pieces).map_or(f64::INFINITY, |p| p.low);
        let mut still_until = next - reach;
        // A piece that passes all that a pixel averages over is seen otherwise than one that does not.
        let all = points.wide.map_or(reach, |wide| wide.half + wide.radius);
        let mut maker = Maker {
            columns,
            lattice,
            width: points.width(),
            entries: &mut self.entries,
            before: &mut self.before,
        };
        for &index in self.sweep.active() {
            let piece = &pieces[index as usize];
            let still = piece.is_upright() && piece.low <= y - all;
            still_until = still_until.min(if still {
                piece.high - all
            } else {
                f64::NEG_INFINITY
            });
            if let Some(wide) = &points.wide {
                match piece.passes(y, wide) {
                    Passing::All => {
                        maker.add_wide(index, piece, y, wide, points.lines);
                        continue;
                    }
                    Passing::Elsewhere => continue,
                    Passing::Not => {}
                }
            }
            for (number, line) in points.lines.iter().enumerate() {
                maker.add(index, piece, y + line.offset, number as u32, line);
            }
        }
        self.still_until = still_until;
        self.order.clear();
        self.order.extend(0..self.entries.len() as u32);
        let entries = &self.entries;
        self.order
            .sort_unstable_by_key(|&index| (entries[index as usize].first, index));
    }

    /// Forgets what was computed.
    pub(crate) fn clear(&mut self) {
        self.spans.clear();
    }

    /// Computes the row over `columns`, right of what was computed of it before.
    // One copy a SIMD level: where methods inlined it, compilers took minutes.
    #[inline(never)]
    pub(crate) fn compute<S: Simd>(
        &mut self,
        simd: S,
        columns: Range<i64>,
        lattice: &Lattice,
        points: &Points<'_>,
    ) {
        let mut base = self.before;
        let mut at = columns.start;
        let mut next = 0;
        while next < self.order.len() && at < columns.end {
            let start = next;
            let ([first, end], stop) = cluster(next, self.order.len(), |at| {
                let entry = &self.entries[self.order[at] as usize];
                [entry.first, entry.end]
            });
            next = stop;
            let entries = self.order[start..next].iter();
            let steps = entries.map(|&index| self.entries[index as usize].step);
            let after = base + steps.sum::<i64>();
            let (from, to) = (first.clamp(at, columns.end), end.clamp(at, columns.end));
            self.spans.push_constant(at..from, [base]);
            if to > from {
                self.cluster(simd, start..next, from..to, base, lattice, points);
            }
            at = to;
            base = after;
        }
        self.spans.push_constant(at..columns.end, [base]);
    }

    /// Computes the densities of `columns`, all within the entries' cluster.
    fn cluster<S: Simd>(
        &mut self,
        simd: S,
        cluster: Range<usize>,
        columns: Range<i64>,
        base: i64,
        lattice: &Lattice,
        points: &Points<'_>,
    ) {
        // Whole strides of an entry may begin before the columns and end after them.
        let stride = LANES as i64;
        let computed = &mut self.spans.values;
        let start = computed.len();
        let left = columns.start - stride;
        let count = columns.end + stride - left;
        // Steps are summed before they are rounded: what lies left of the columns that are drawn changes nothing.
        self.steps.clear();
        let stepping = self.order[cluster.clone()].iter();
        self.steps.extend(stepping.map(|&index| {
            let entry = &self.entries[index as usize];
            (entry.end, entry.step)
        }));
        self.steps.sort_unstable();
        let (mut sum, mut at) = (base, 0);
        for &(end, step) in &self.steps {
            at = (end - left).clamp(at, count);
            let end = start + at as usize;
            computed.resize(end, (sum as f64 / UNIT) as f32);
            sum += step;
        }
        let end = start + count as usize;
        computed.resize(end, (sum as f64 / UNIT) as f32);
        let values = &mut computed[start..];
        for &index in &self.order[cluster] {
            let entry = &self.entries[index as usize];
            let skipped = (columns.start - entry.first).max(0) / stride;
            let from = entry.first + skipped * stride;
            let to = entry.end.min(columns.end);
            if from < to {
                let strides = (to - from + stride - 1) / stride;
                let wide = points.wide.filter(|_| entry.line == ALL);
                let (points, line) = match wide {
                    Some(_) => (&Points::CENTER, 0),
                    None => (points, entry.line as usize),
                };
                let piece = &self.pieces[entry.piece as usize];
                let line = &points.lines[line];
                for (origin, part) in stretches(entry.first, from..from + strides * stride) {
                    let now = &mut values[(part.start - left) as usize..(part.end - left) as usize];
                    let x = lattice.start + origin as f64 * lattice.pitch;
                    simd.vectorize(
                        #[inline(always)]
                        || {
                            let view = View {
                                simd,
                                origin: DVec2::new(x, self.y + line.offset),
                                down: f32x16::splat(simd, 0.0),
                                pitch: lattice.pitch,
                            };
                            let halves = entry.halves.map(|half| f32x16::splat(simd, half));
                            let form = match wide {
                                Some(wide) => piece.seen_widely(&view, &wide),
                                None if lattice.window == Window::Square => {
                                    RowForm::Cut(piece.cut_from(&view))
                                }
                                None => piece.seen_from(&view, view.origin.y, halves),
                            };
                            let stroke = Stroke {
                                form,
                                columns: lanes(simd) + (part.start - origin) as f32,
                                step: LANES as f32,
                                halves,
                                line,
                                points: points.columns,
                            };
                            stroke.add_to(simd, now);
                        },
                    );
                }
            }
        }
        simd.vectorize(
            #[inline(always)]
            || {
                for value in values.iter_mut() {
                    *value = value.clamp(0.0, 1.0);
                }
            },
        );
        self.spans.push_values(columns, start + LANES);
    }

    /// Gives `sink` what was computed of row `y` within `columns`, counted from `origin`.
    #[inline(always)]
    pub(crate) fn give(&self, y: u32, columns: &Range<i64>, origin: i64, sink: &mut dyn Sink) {
        self.spans.give(0, y, columns, origin, sink);
    }
}
