//! One piece over some columns: its kernel, at each of a pixel's points.

use fearless_simd::{Simd, SimdBase, f32x16};

use super::arcs::{self, RowArc};
use super::kernels::{self, Ramp, RowCut, RowLine, WideArc, WideLine};
use super::points::Line;
use crate::density::lanes::LANES;

/// What a piece is to the columns of a row.
#[derive(Debug, Clone, Copy)]
pub(super) enum RowForm<S: Simd> {
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

/// A piece over some columns.
pub(super) struct Stroke<'a, S: Simd> {
    pub(super) form: RowForm<S>,
    /// The column of each lane, and from each vector to the next.
    pub(super) columns: f32x16<S>,
    pub(super) step: f32,
    /// The window's half at the y of the piece's two ends.
    pub(super) halves: [f32x16<S>; 2],
    pub(super) line: &'a Line,
    pub(super) points: &'a [(f32, f32)],
}

impl<S: Simd> Stroke<'_, S> {
    /// Adds the piece's densities to those of the columns.
    pub(super) fn add_to(&self, simd: S, values: &mut [f32]) {
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
