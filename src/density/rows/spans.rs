//! What was computed of some rows that are drawn together, from the left to the right.

use core::ops::Range;

use super::entries;
use crate::density::Sink;

/// Parts of so many rows. Elsewhere their densities are 0.
#[derive(Debug, Default)]
pub(super) struct Spans<const ROWS: usize> {
    all: Vec<Span<ROWS>>,
    /// Densities row by row.
    pub(super) values: Vec<f32>,
}

#[derive(Debug, Clone)]
struct Span<const ROWS: usize> {
    columns: Range<i64>,
    kind: Kind<ROWS>,
}

#[derive(Debug, Clone, Copy)]
enum Kind<const ROWS: usize> {
    /// One for each row.
    Constant([f32; ROWS]),
    /// Where the values of the first row begin.
    Values(usize),
}

impl<const ROWS: usize> Spans<ROWS> {
    /// Forgets what was computed.
    pub(super) fn clear(&mut self) {
        self.all.clear();
        self.values.clear();
    }

    /// Takes columns that are constant: what the steps of each row add up to.
    pub(super) fn push_constant(&mut self, columns: Range<i64>, steps: [i64; ROWS]) {
        let densities = steps.map(entries::density);
        if !columns.is_empty() && densities.iter().any(|&density| density > 0.0) {
            let kind = Kind::Constant(densities);
            self.all.push(Span { columns, kind });
        }
    }

    /// Takes columns whose values are there already, those of the first row from `place` on.
    pub(super) fn push_values(&mut self, columns: Range<i64>, place: usize) {
        let kind = Kind::Values(place);
        self.all.push(Span { columns, kind });
    }

    /// Gives `sink` what is within `columns` of one of the rows, the grid's row `y`. Columns are counted from `origin`.
    #[inline(always)]
    pub(super) fn give(
        &self,
        row: usize,
        y: u32,
        columns: &Range<i64>,
        origin: i64,
        sink: &mut dyn Sink,
    ) {
        for span in &self.all {
            let start = span.columns.start.max(columns.start);
            let end = span.columns.end.min(columns.end);
            if start >= end {
                continue;
            }
            let on_grid = (start - origin) as u32..(end - origin) as u32;
            match span.kind {
                Kind::Constant(densities) => {
                    if densities[row] > 0.0 {
                        sink.constant(y..y + 1, on_grid, densities[row]);
                    }
                }
                Kind::Values(place) => {
                    let width = (span.columns.end - span.columns.start) as usize;
                    let place = place + row * width + (start - span.columns.start) as usize;
                    sink.values(y..y + 1, on_grid, &self.values[place..]);
                }
            }
        }
    }
}
