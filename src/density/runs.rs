//! Runs of pixels, so many at a time: to begin costs a sink as much as some ten pixels do.

use core::ops::Range;

use super::Sink;
use super::lanes::LANES;

/// Some columns of a row.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) row: u32,
    pub(crate) columns: Range<u32>,
}

/// Each of some runs with its densities, and what is behind these: those of all runs are one after another.
#[inline(always)]
pub(crate) fn each<'a>(
    runs: &'a [Run],
    mut densities: &'a [f32],
) -> impl Iterator<Item = (&'a Run, &'a [f32])> {
    runs.iter().map(move |run| {
        let of_run = densities;
        densities = &of_run[run.columns.len()..];
        (run, of_run)
    })
}

/// Pixels after which a sink is given the runs so far: their densities do not leave the nearest cache.
const MANY: usize = 32 * LANES;

/// Runs that a sink is yet to be given. From drawing to drawing it is memory.
#[derive(Debug, Default)]
pub(crate) struct Runs {
    runs: Vec<Run>,
    values: Vec<f32>,
    count: usize,
}

impl Runs {
    /// Gets ready for rows of up to so many pixels.
    pub(crate) fn begin(&mut self, longest: usize) {
        // Whole vectors are written from any place on.
        let length = (MANY + longest).next_multiple_of(LANES) + LANES;
        self.values.resize(length, 0.0);
    }

    /// Adds a run; where its densities are to be put, in whole vectors.
    #[inline(always)]
    pub(crate) fn push(&mut self, run: Run) -> &mut [f32] {
        let (start, length) = (self.count, run.columns.len());
        self.count += length;
        self.runs.push(run);
        &mut self.values[start..][..length.next_multiple_of(LANES)]
    }

    /// What was put of all runs, to be changed in whole vectors.
    pub(crate) fn values(&mut self) -> &mut [f32] {
        &mut self.values[..self.count.next_multiple_of(LANES)]
    }

    /// Whether it is time to give them, at a row's end.
    pub(crate) fn are_many(&self) -> bool {
        self.count >= MANY
    }

    /// Gives a sink all runs: none are left.
    pub(crate) fn give(&mut self, sink: &mut dyn Sink) {
        sink.runs(&self.runs, &self.values);
        self.runs.clear();
        self.count = 0;
    }
}
