//! Bands of four rows, drawn by tiles of four by four pixels.
//!
//! What finds the pieces that discs may meet, and where, is shared by four rows; and of a tile's sixteen discs more lie alike to a piece
//! than of as many in a row.

use core::ops::Range;

use fearless_simd::{Simd, SimdBase, SimdCombine, SimdFloat, f32x4, f32x16, i32x16};
use glam::DVec2;

use super::entries::{self, UNIT};
use super::kernels::half_discs;
use super::pieces::{self, Piece};
use super::seen::View;
use super::spans::Spans;
use super::stroke::Stroke;
use super::{Lattice, Points, Window, stretches};
use crate::density::Sink;
use crate::density::lanes::{LANES, spread};
use crate::density::sweep::Sweep;
use crate::outline::Edge;

/// Rows of a band, and columns of a tile.
pub(crate) const BAND: i64 = SIDE as i64;
const SIDE: usize = 4;

/// From a band's first row to its last, in pixels.
const HEIGHT: f64 = (SIDE - 1) as f64;

/// What one piece of the outline does to a band, seen from one of its pixels' lines of points.
#[derive(Debug, Clone, Copy)]
struct Entry {
    first: i64,
    end: i64,
    piece: u32,
    line: u32,
    /// What its passing adds to all columns of each row from `end` on.
    steps: [i32; SIDE],
    /// `half_disc` at the y of its two ends, seen from each row.
    halves: [[f32; SIDE]; 2],
}

/// Draws bands of one outline, from top to bottom.
#[derive(Debug, Default)]
pub(crate) struct Bands {
    pieces: Vec<Piece>,
    sweep: Sweep,
    /// By their first column, then as pieces and lines are numbered: whatever columns are asked for, sums have one order.
    entries: Vec<Entry>,
    /// Steps left of the columns that are drawn.
    before: [i64; SIDE],
    top: f64,
    /// Where the entries of a cluster end, and their steps.
    steps: Vec<(i64, [i32; SIDE])>,
    /// The densities of a cluster, tile by tile.
    tiles: Vec<f32>,
    spans: Spans<SIDE>,
    /// Bands that end above it are the same as the last.
    still_until: f64,
}

/// Columns extended to whole tiles.
pub(crate) fn to_tiles(columns: &Range<i64>) -> Range<i64> {
    columns.start.div_euclid(BAND) * BAND..(columns.end + BAND - 1).div_euclid(BAND) * BAND
}

/// The column of each of a tile's lanes.
const COLUMNS: [f32; LANES] = {
    let mut columns = [0.0; LANES];
    let mut lane = 0;
    while lane < LANES {
        columns[lane] = (lane % SIDE) as f32;
        lane += 1;
    }
    columns
};

/// A band's rows.
const ROWS: [f32; SIDE] = [0.0, 1.0, 2.0, 3.0];

impl Bands {
    /// Takes the outline's edges, in penumbra radii.
    pub(crate) fn load(&mut self, edges: impl Iterator<Item = Edge>) {
        pieces::cut(edges, Window::Disc, None, &mut self.pieces);
        self.sweep.rewind();
        self.still_until = f64::NEG_INFINITY;
    }

    /// Whether the band whose last row is at `bottom` is the same as the last band.
    pub(crate) fn is_still(&self, bottom: f64) -> bool {
        bottom < self.still_until
    }

    /// Goes to the band whose first row is at `top`, below the last. Only `columns` will be asked for.
    // One copy a SIMD level.
    #[inline(never)]
    pub(crate) fn go_to<S: Simd>(
        &mut self,
        simd: S,
        top: f64,
        columns: &Range<i64>,
        lattice: &Lattice,
        points: &Points<'_>,
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.find_entries(simd, top, columns, lattice, points),
        );
        self.entries
            .sort_unstable_by_key(|entry| (entry.first, entry.piece, entry.line));
    }

    #[inline(always)]
    fn find_entries<S: Simd>(
        &mut self,
        simd: S,
        top: f64,
        columns: &Range<i64>,
        lattice: &Lattice,
        points: &Points<'_>,
    ) {
        let (height, spread) = (points.height(), points.width() * lattice.pitch);
        let rows = HEIGHT * lattice.pitch;
        let (bottom, reach) = (top + rows, 1.0 + height);
        let pieces = &self.pieces;
        self.sweep
            .go_to(pieces, [top - reach, bottom + reach], |p| [p.low, p.high]);
        self.entries.clear();
        self.before = [0; SIDE];
        self.top = top;
        let next = self.sweep.ahead(pieces).map_or(f64::INFINITY, |p| p.low);
        self.still_until = next - reach;
        let down = f32x4::from_slice(simd, &ROWS) * lattice.pitch as f32;
        for &index in self.sweep.active() {
            let piece = &pieces[index as usize];
            let still = piece.is_upright() && piece.low <= top - reach;
            self.still_until = self.still_until.min(if still {
                piece.high - reach
            } else {
                f64::NEG_INFINITY
            });
            let [left, right] = piece.extent([top - height, bottom + height], Window::Disc);
            // One column to spare on both sides, whichever way these are rounded.
            let column = |x: f64| ((x - lattice.start) * lattice.density) as i64;
            let reached = to_tiles(&(column(left - spread) - 1..column(right + spread) + 2));
            if reached.start >= columns.end {
                continue;
            }
            for (number, line) in points.lines.iter().enumerate() {
                let top = top + line.offset;
                if piece.low >= top + rows + 1.0 || piece.high <= top - 1.0 {
                    continue;
                }
                let (halves, steps) = piece.halves(simd, top, down, line.weight);
                if reached.end <= columns.start {
                    add(&mut self.before, steps);
                } else {
                    self.entries.push(Entry {
                        first: reached.start,
                        end: reached.end,
                        piece: index,
                        line: number as u32,
                        steps,
                        halves,
                    });
                }
            }
        }
    }

    /// Forgets what was computed.
    pub(crate) fn clear(&mut self) {
        self.spans.clear();
    }

    /// Computes the band over `columns`, which are whole tiles, right of what was computed of it before.
    // One copy a SIMD level.
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
        while next < self.entries.len() && at < columns.end {
            let start = next;
            let ([first, end], stop) = entries::cluster(next, self.entries.len(), |at| {
                let entry = &self.entries[at];
                [entry.first, entry.end]
            });
            next = stop;
            let mut after = base;
            for entry in &self.entries[start..next] {
                add(&mut after, entry.steps);
            }
            let (from, to) = (first.clamp(at, columns.end), end.clamp(at, columns.end));
            self.spans.push_constant(at..from, base);
            if to > from {
                self.cluster(simd, start..next, from..to, base, lattice, points);
            }
            at = to;
            base = after;
        }
        self.spans.push_constant(at..columns.end, base);
    }

    /// Computes the densities of `columns`, all within the entries' cluster.
    fn cluster<S: Simd>(
        &mut self,
        simd: S,
        cluster: Range<usize>,
        columns: Range<i64>,
        base: [i64; SIDE],
        lattice: &Lattice,
        points: &Points<'_>,
    ) {
        let width = (columns.end - columns.start) as usize;
        self.lay_steps(simd, &cluster, &columns, base);
        let down = simd.vectorize(
            #[inline(always)]
            || spread(simd, ROWS) * lattice.pitch as f32,
        );
        for entry in &self.entries[cluster] {
            let from = entry.first.max(columns.start);
            let to = entry.end.min(columns.end);
            let piece = &self.pieces[entry.piece as usize];
            if from >= to {
                continue;
            }
            let line = &points.lines[entry.line as usize];
            let top = self.top + line.offset;
            let place = |column: i64| (column - columns.start) as usize * SIDE;
            for (origin, part) in stretches(entry.first, from..to) {
                let now = &mut self.tiles[place(part.start)..place(part.end)];
                simd.vectorize(
                    #[inline(always)]
                    || {
                        let x = lattice.start + origin as f64 * lattice.pitch;
                        let view = View {
                            simd,
                            origin: DVec2::new(x, top),
                            down,
                            pitch: lattice.pitch,
                        };
                        let bottom = top + HEIGHT * lattice.pitch;
                        let halves = [spread(simd, entry.halves[0]), spread(simd, entry.halves[1])];
                        let stroke = Stroke {
                            form: piece.seen_from(&view, bottom, halves),
                            columns: f32x16::from_slice(simd, &COLUMNS)
                                + (part.start - origin) as f32,
                            step: SIDE as f32,
                            halves,
                            line,
                            points: points.columns,
                        };
                        stroke.add_to(simd, now);
                    },
                );
            }
        }
        let values = &mut self.spans.values;
        let start = values.len();
        values.resize(start + SIDE * width + LANES, 0.0);
        let values = &mut values[start..];
        simd.vectorize(
            #[inline(always)]
            || untile(simd, &self.tiles, width, values),
        );
        self.spans.push_values(columns, start);
    }

    /// Puts what the entries' steps add up to into the tiles of a cluster.
    #[inline(always)]
    fn lay_steps<S: Simd>(
        &mut self,
        simd: S,
        cluster: &Range<usize>,
        columns: &Range<i64>,
        base: [i64; SIDE],
    ) {
        let width = columns.end - columns.start;
        // Steps are summed before they are rounded: what lies left of the columns that are drawn changes nothing.
        self.steps.clear();
        let stepping = self.entries[cluster.clone()].iter();
        self.steps
            .extend(stepping.map(|entry| (entry.end, entry.steps)));
        self.steps.sort_unstable_by_key(|(end, _)| *end);
        let Self { steps, tiles, .. } = self;
        tiles.resize(width as usize * SIDE, 0.0);
        simd.vectorize(
            #[inline(always)]
            || {
                let (mut sums, mut at) = (base, 0);
                let last = (columns.end, [0; SIDE]);
                for (end, steps) in steps.iter().chain(core::iter::once(&last)) {
                    let end = (end - columns.start).clamp(at, width);
                    let lanes = spread(simd, sums.map(|sum| (sum as f64 / UNIT) as f32));
                    let part = &mut tiles[at as usize * SIDE..end as usize * SIDE];
                    for tile in part.as_chunks_mut::<LANES>().0 {
                        lanes.store_slice(tile);
                    }
                    add(&mut sums, *steps);
                    at = end;
                }
            },
        );
    }

    /// Gives `sink` what was computed of one of the band's rows, the grid's row `y`, within `columns`, counted from `origin`.
    #[inline(always)]
    pub(crate) fn give(
        &self,
        row: usize,
        y: u32,
        columns: &Range<i64>,
        origin: i64,
        sink: &mut dyn Sink,
    ) {
        self.spans.give(row, y, columns, origin, sink);
    }
}

/// Densities of tiles row by row, held between 0 and 1.
#[inline(always)]
fn untile<S: Simd>(simd: S, tiles: &[f32], width: usize, values: &mut [f32]) {
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let (a, rest) = values.split_at_mut(width);
    let (b, rest) = rest.split_at_mut(width);
    let (c, d) = rest.split_at_mut(width);
    let [a, b, c, d] = [a, b, c, d].map(|row| row.as_chunks_mut::<SIDE>().0.iter_mut());
    let rows = a.zip(b).zip(c.zip(d));
    for (tile, ((a, b), (c, d))) in tiles.as_chunks::<LANES>().0.iter().zip(rows) {
        let mut held = [0.0; LANES];
        f32x16::from_slice(simd, tile)
            .max(zero)
            .min(one)
            .store_slice(&mut held);
        for column in 0..SIDE {
            a[column] = held[column];
            b[column] = held[SIDE + column];
            c[column] = held[2 * SIDE + column];
            d[column] = held[3 * SIDE + column];
        }
    }
}

impl Piece {
    /// `half_disc` at the y of its two ends, seen from rows so far `down` from `top`, and what its passing adds to all on its right if
    /// they count by a `weight`. Each end is rounded alone, so that what follows cancels it.
    #[inline(always)]
    fn halves<S: Simd>(
        &self,
        simd: S,
        top: f64,
        down: f32x4<S>,
        weight: f64,
    ) -> ([[f32; SIDE]; 2], [i32; SIDE]) {
        let from = f32x4::splat(simd, (self.from.y - top) as f32) - down;
        let to = f32x4::splat(simd, (self.to.y - top) as f32) - down;
        let ends = from.combine(to);
        let halves = half_discs(simd, ends.combine(ends));
        let whole: i32x16<S> = (halves * (2.0 * UNIT * weight) as f32).to_int();
        let (mut ends, mut units) = ([0.0; LANES], [0; LANES]);
        halves.store_slice(&mut ends);
        whole.store_slice(&mut units);
        let [a, b, c, d, e, f, g, h, ..] = ends;
        let halves = [[a, b, c, d], [e, f, g, h]];
        let [a, b, c, d, e, f, g, h, ..] = units;
        (halves, [a - e, b - f, c - g, d - h])
    }
}

/// Adds each row's step to its sum.
#[inline(always)]
fn add(sums: &mut [i64; SIDE], steps: [i32; SIDE]) {
    for (sum, step) in sums.iter_mut().zip(steps) {
        *sum += i64::from(step);
    }
}
