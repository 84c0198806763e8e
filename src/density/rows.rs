//! Rows of densities in single precision: the outline's pieces that a row of discs can meet, the columns that each of
//! them varies on, and constants between.
//!
//! What a piece adds is constant left and right of the columns near it, so a row is a list of spans, most of them
//! constant, and steps between. The steps are whole numbers that cancel along a closed loop: outside of the shadow the
//! density is 0 and in the umbra 1, exactly, however many pieces there are.

mod arcs;
mod bands;
mod chains;
mod kernels;
mod pieces;
mod seen;

pub(crate) use arcs::{Power, RowCircle, circle};
pub(crate) use bands::{BAND, Bands, to_tiles};
pub(crate) use kernels::{Wide, half_disc, half_discs, line_at, turns, whole_disc};
pub(crate) use pieces::{ERROR, arc_chord, each_line, sort};

use core::ops::Range;

use fearless_simd::{Simd, SimdBase, f32x16};
use glam::DVec2;

use super::Sink;
use super::lanes::{LANES, lanes};
use crate::outline::Edge;
use arcs::RowArc;
use chains::Passing;
use kernels::{Ramp, RowCut, RowLine, WideArc, WideLine};
use pieces::Piece;
use seen::View;

/// What a density is the average over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Window {
    /// The unit disc.
    Disc,
    /// The unit square.
    Square,
}

impl Window {
    /// How far from its centre it reaches along an axis.
    fn reach(self) -> f64 {
        match self {
            Self::Disc => 1.0,
            Self::Square => 0.5,
        }
    }

    /// What lies right of its centre between y = 0 and `t`.
    pub(crate) fn half(self, t: f64) -> f32 {
        match self {
            Self::Disc if t.abs() >= 1.0 => 0.25_f32.copysign(t as f32),
            Self::Disc => half_disc(t as f32),
            Self::Square => 0.5 * (t as f32).clamp(-0.5, 0.5),
        }
    }
}

/// One of the rows of points that a pixel's average is taken from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    /// From the pixel's centre, in the windows' unit.
    pub(crate) offset: f64,
    pub(crate) weight: f64,
    /// The factor on the columns' offsets.
    pub(crate) spread: f64,
}

/// The points that a pixel's average is taken from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Points<'a> {
    pub(crate) lines: &'a [Line],
    /// Offsets in columns, and weights.
    pub(crate) columns: &'a [(f32, f32)],
    /// What they stand for, if there is more than one.
    pub(crate) wide: Option<Wide>,
}

impl Points<'static> {
    /// The pixel's centre alone.
    pub(crate) const CENTER: Self = Self {
        lines: &[Line {
            offset: 0.0,
            weight: 1.0,
            spread: 1.0,
        }],
        columns: &[(0.0, 1.0)],
        wide: None,
    };
}

impl Points<'_> {
    fn height(&self) -> f64 {
        self.lines
            .iter()
            .map(|line| line.offset)
            .fold(0.0, f64::max)
    }

    fn width(&self) -> f64 {
        let farthest = self.columns.iter().map(|(offset, _)| *offset);
        f64::from(farthest.fold(0.0, f32::max))
    }
}

/// A part of a row that was computed.
#[derive(Debug, Clone)]
struct Span {
    columns: Range<i64>,
    kind: Kind,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Constant(f32),
    /// Where its values begin.
    Values(usize),
}

#[derive(Debug, Clone, Copy)]
enum RowForm<S: Simd> {
    /// The signed distance of a line that passes the disc's whole height.
    ThroughLine(Ramp<S>),
    Line(RowLine<S>),
    /// An arc that passes the disc's whole height.
    ThroughArc(RowArc<S>),
    /// An arc that runs inside between any two of its points that are inside.
    LongArc(RowArc<S>),
    Arc(RowArc<S>),
    Cut(RowCut<S>),
    /// A line or an arc that passes all that a pixel averages over.
    WideLine(WideLine<S>),
    WideArc(WideArc<S>),
}

/// Steps count whole units of 2^-30 of density.
const UNIT: f64 = (1_u64 << 30) as f64;

/// What one piece of the outline does to a row.
#[derive(Debug, Clone, Copy)]
struct Entry {
    first: i64,
    end: i64,
    /// What its passing adds to all columns from `end` on.
    step: i64,
    piece: u32,
    /// Which of the rows of points it is seen from, or [`ALL`] of them at once.
    line: u32,
    /// The window's half at the y of its two ends.
    halves: [f32; 2],
}

/// The number of no row of points.
const ALL: u32 = u32::MAX;

/// Draws rows of one outline, from top to bottom.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    pieces: Vec<Piece>,
    /// How many pieces have been reached, and those of them that have not been left behind.
    reached: usize,
    active: Vec<u32>,
    entries: Vec<Entry>,
    /// The entries by their first column.
    order: Vec<u32>,
    /// Steps left of the columns that are drawn.
    before: i64,
    y: f64,
    /// Where the entries of a cluster end, and their steps.
    steps: Vec<(i64, i64)>,
    spans: Vec<Span>,
    values: Vec<f32>,
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

/// Columns after which a piece's numbers are taken anew in double precision: beyond, single precision would show.
const STRETCH: i64 = 512;

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
        self.reached = 0;
        self.active.clear();
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
        while let Some(piece) = pieces.get(self.reached).filter(|p| p.low < y + reach) {
            if piece.high > y - reach {
                self.active.push(self.reached as u32);
            }
            self.reached += 1;
        }
        self.active
            .retain(|&index| pieces[index as usize].high > y - reach);
        self.entries.clear();
        self.before = 0;
        self.y = y;
        let next = pieces.get(self.reached).map_or(f64::INFINITY, |p| p.low);
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
        for &index in &self.active {
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
        self.values.clear();
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
            self.push_constant(at..from, base);
            if to > from {
                self.cluster(simd, start..next, from..to, base, lattice, points);
            }
            at = to;
            base = after;
        }
        self.push_constant(at..columns.end, base);
    }

    fn push_constant(&mut self, columns: Range<i64>, steps: i64) {
        let density = density(steps);
        if !columns.is_empty() && density > 0.0 {
            self.spans.push(Span {
                columns,
                kind: Kind::Constant(density),
            });
        }
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
        let start = self.values.len();
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
            self.values.resize(end, (sum as f64 / UNIT) as f32);
            sum += step;
        }
        let end = start + count as usize;
        self.values.resize(end, (sum as f64 / UNIT) as f32);
        let values = &mut self.values[start..];
        for &index in &self.order[cluster] {
            let entry = &self.entries[index as usize];
            let skipped = (columns.start - entry.first).max(0) / stride;
            let from = entry.first + skipped * stride;
            let to = entry.end.min(columns.end);
            if from < to {
                let place = (from - left) as usize;
                let strides = ((to - from + stride - 1) / stride) as usize;
                let wide = points.wide.filter(|_| entry.line == ALL);
                let (points, line) = match wide {
                    Some(_) => (&Points::CENTER, 0),
                    None => (points, entry.line as usize),
                };
                let piece = &self.pieces[entry.piece as usize];
                let line = &points.lines[line];
                let mut part = &mut values[place..place + strides * LANES];
                let mut column = from;
                // Long ones stretch by stretch, counted from where the piece begins.
                while !part.is_empty() {
                    let origin = entry.first + (column - entry.first) / STRETCH * STRETCH;
                    let stop = (origin + STRETCH - column).min(part.len() as i64);
                    let (now, rest) = part.split_at_mut(stop as usize);
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
                                columns: lanes(simd) + (column - origin) as f32,
                                step: LANES as f32,
                                halves,
                                line,
                                points: points.columns,
                            };
                            stroke.add_to(simd, now);
                        },
                    );
                    part = rest;
                    column += stop;
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
        self.spans.push(Span {
            columns,
            kind: Kind::Values(start + LANES),
        });
    }

    /// Gives `sink` what was computed of row `y` within `columns`, counted from `origin`.
    #[inline(always)]
    pub(crate) fn give(&self, y: u32, columns: Range<i64>, origin: i64, sink: &mut dyn Sink) {
        for span in &self.spans {
            let start = span.columns.start.max(columns.start);
            let end = span.columns.end.min(columns.end);
            if start >= end {
                continue;
            }
            let first = (start - origin) as u32;
            match span.kind {
                Kind::Constant(density) => {
                    sink.constant(y..y + 1, first..(end - origin) as u32, density);
                }
                Kind::Values(place) => {
                    let place = place + (start - span.columns.start) as usize;
                    sink.values(
                        y..y + 1,
                        first..(end - origin) as u32,
                        &self.values[place..],
                    );
                }
            }
        }
    }
}

/// A piece over some columns.
struct Stroke<'a, S: Simd> {
    form: RowForm<S>,
    /// The column of each lane, and from each vector to the next.
    columns: f32x16<S>,
    step: f32,
    /// The window's half at the y of the piece's two ends.
    halves: [f32x16<S>; 2],
    line: &'a Line,
    points: &'a [(f32, f32)],
}

impl<S: Simd> Stroke<'_, S> {
    /// Adds the piece's densities to those of the columns.
    fn add_to(&self, simd: S, values: &mut [f32]) {
        // A closure of its own for each kernel, or they would not be one loop with it.
        macro_rules! add {
            ($kernel:expr) => {
                simd.vectorize(
                    #[inline(always)]
                    || self.add(simd, values, $kernel),
                )
            };
        }
        match &self.form {
            RowForm::WideLine(line) => add!(
                #[inline(always)]
                |columns| kernels::wide_line(simd, columns, line)
            ),
            RowForm::WideArc(arc) => add!(
                #[inline(always)]
                |columns| kernels::wide_arc(simd, columns, arc)
            ),
            RowForm::ThroughLine(distance) => add!(
                #[inline(always)]
                |columns| kernels::through_line(simd, columns, *distance)
            ),
            RowForm::Line(line) => add!(
                #[inline(always)]
                |columns| kernels::line(simd, columns, line)
            ),
            RowForm::ThroughArc(arc) => add!(
                #[inline(always)]
                |columns| arcs::through_arc(simd, columns, arc)
            ),
            RowForm::LongArc(arc) => add!(
                #[inline(always)]
                |columns| arcs::long_arc(simd, columns, arc)
            ),
            RowForm::Arc(arc) => add!(
                #[inline(always)]
                |columns| arcs::arc(simd, columns, arc)
            ),
            RowForm::Cut(cut) => add!(
                #[inline(always)]
                |columns| kernels::cut(simd, columns, cut)
            ),
        }
    }

    #[inline(always)]
    fn add(&self, simd: S, values: &mut [f32], kernel: impl Fn(f32x16<S>) -> f32x16<S>) {
        // What a piece adds counts from the middle between what it is far left and far right.
        let middle = self.halves[0] - self.halves[1];
        let (weight, spread) = (self.line.weight as f32, self.line.spread as f32);
        let mut columns = self.columns;
        if let [_] = self.points {
            for values in values.chunks_exact_mut(LANES) {
                let sum = f32x16::from_slice(simd, values) + (kernel(columns) + middle);
                sum.store_slice(values);
                columns += self.step;
            }
            return;
        }
        for values in values.chunks_exact_mut(LANES) {
            let mut sum = middle;
            for (offset, share) in self.points {
                sum += kernel(columns + *offset * spread) * *share;
            }
            let sum = f32x16::from_slice(simd, values) + sum * weight;
            sum.store_slice(values);
            columns += self.step;
        }
    }
}

/// The columns of the entries from one on that follow each other without a gap, and the first of those after them; `reached` tells each
/// one's first column and its end.
#[inline(always)]
fn cluster(start: usize, count: usize, reached: impl Fn(usize) -> [i64; 2]) -> ([i64; 2], usize) {
    let [first, mut end] = reached(start);
    let mut next = start + 1;
    while next < count {
        let [other, other_end] = reached(next);
        if other > end {
            break;
        }
        end = end.max(other_end);
        next += 1;
    }
    ([first, end], next)
}

fn density(steps: i64) -> f32 {
    ((steps as f64 / UNIT) as f32).clamp(0.0, 1.0)
}

/// What a piece adds to all on its right, seen from a row of points. Each end is rounded alone, so that what follows cancels
/// it.
#[inline(always)]
fn step(line: &Line, halves: [f32; 2]) -> i64 {
    let whole = |half: f32| (2.0 * UNIT * line.weight * f64::from(half)) as i64;
    whole(halves[0]) - whole(halves[1])
}

/// Makes the entries of one row.
struct Maker<'a> {
    columns: Range<i64>,
    lattice: &'a Lattice,
    width: f64,
    entries: &'a mut Vec<Entry>,
    before: &'a mut i64,
}

impl Maker<'_> {
    #[inline(always)]
    fn add(&mut self, index: u32, piece: &Piece, y: f64, number: u32, line: &Line) {
        let window = self.lattice.window;
        let reach = window.reach();
        if piece.low >= y + reach || piece.high <= y - reach {
            return;
        }
        let halves = [piece.from.y - y, piece.to.y - y].map(|rise| window.half(rise));
        let spread = line.spread * self.width * self.lattice.pitch;
        let extent = piece.extent([y; 2], window);
        let step = step(line, halves);
        self.push(index, number, halves, step, extent, spread);
    }

    /// Adds a piece that passes all that a pixel averages over.
    #[inline(always)]
    fn add_wide(&mut self, index: u32, piece: &Piece, y: f64, wide: &Wide, lines: &[Line]) {
        let falls = 0.25_f32.copysign((piece.from.y - piece.to.y) as f32);
        let halves = [falls, -falls];
        // As the rows of points would have it one by one, so that pieces that end in them cancel it.
        let step = lines.iter().map(|line| step(line, halves)).sum();
        self.push(index, ALL, halves, step, piece.wide_extent(y, wide), 0.0);
    }

    #[inline(always)]
    fn push(
        &mut self,
        index: u32,
        number: u32,
        halves: [f32; 2],
        step: i64,
        [left, right]: [f64; 2],
        spread: f64,
    ) {
        // One column to spare on both sides, whichever way these are rounded.
        let column = |x: f64| ((x - self.lattice.start) * self.lattice.density) as i64;
        let first = column(left - spread) - 1;
        let end = column(right + spread) + 2;
        let stride = LANES as i64;
        let end = first + (end - first + stride - 1) / stride * stride;
        if end <= self.columns.start {
            *self.before += step;
        } else if first < self.columns.end {
            self.entries.push(Entry {
                first,
                end,
                step,
                piece: index,
                line: number,
                halves,
            });
        }
    }
}
