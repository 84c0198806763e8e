//! Scan conversion: the pixels whose centres a triangle covers, row by row, with what its corners hold interpolated along its
//! edges and between them along each scan line (Gouraud 1971).

use core::ops::{Add, Div, Mul, Range, Sub};

use glam::DVec2;

/// What can be interpolated.
pub(crate) trait Value:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self> + Div<f64, Output = Self>
{
}

impl<T> Value for T where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T> + Div<f64, Output = T>
{
}

/// A corner in pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Corner<T> {
    pub(crate) at: DVec2,
    pub(crate) value: T,
}

/// An edge from its upper to its lower end. Both triangles at an edge build it from the same two corners, so they find the
/// same place for it on every scan line.
#[derive(Debug, Clone, Copy)]
struct Side<T> {
    top: Corner<T>,
    /// Changes of x and value from one scan line to the next.
    slope: f64,
    value_slope: T,
    bottom: f64,
}

impl<T: Value> Side<T> {
    fn between(a: Corner<T>, b: Corner<T>) -> Self {
        let (top, bottom) = if (a.at.y, a.at.x) <= (b.at.y, b.at.x) {
            (a, b)
        } else {
            (b, a)
        };
        let height = bottom.at.y - top.at.y;
        let per_line = if height > 0.0 { 1.0 / height } else { 0.0 };
        Self {
            top,
            slope: (bottom.at.x - top.at.x) * per_line,
            value_slope: (bottom.value - top.value) * per_line,
            bottom: bottom.at.y,
        }
    }

    fn spans(&self, y: f64) -> bool {
        self.top.at.y <= y && y < self.bottom
    }

    /// x and value on the scan line at `y`.
    fn at(&self, y: f64) -> (f64, T) {
        let down = y - self.top.at.y;
        (
            self.top.at.x + self.slope * down,
            self.top.value + self.value_slope * down,
        )
    }
}

/// The pixels of one row that a triangle covers.
#[derive(Debug, Clone)]
pub(crate) struct Run<T> {
    pub(crate) row: i64,
    pub(crate) columns: Range<i64>,
    /// The value at the first pixel's centre, and its change from one pixel to the next.
    pub(crate) first: T,
    pub(crate) step: T,
}

/// Gives `put` the runs of a triangle within some columns and rows. A pixel centre on an edge belongs to the triangle right
/// of it or below, so none is in two triangles and none left out.
pub(crate) fn scan_convert<T: Value>(
    [a, b, c]: [Corner<T>; 3],
    columns: &Range<i64>,
    rows: &Range<i64>,
    mut put: impl FnMut(Run<T>),
) {
    let sides = [
        Side::between(a, b),
        Side::between(b, c),
        Side::between(c, a),
    ];
    let tops = sides.iter().map(|side| side.top.at.y);
    let bottoms = sides.iter().map(|side| side.bottom);
    let (top, bottom) = (
        tops.fold(f64::MAX, f64::min),
        bottoms.fold(f64::MIN, f64::max),
    );
    for row in centers(top, bottom, rows) {
        let y = row as f64 + 0.5;
        let mut crossed = sides
            .iter()
            .filter(|side| side.spans(y))
            .map(|side| side.at(y));
        let (Some(first), Some(second)) = (crossed.next(), crossed.next()) else {
            continue;
        };
        let (left, right) = if first.0 <= second.0 {
            (first, second)
        } else {
            (second, first)
        };
        let width = right.0 - left.0;
        if width <= 0.0 {
            continue;
        }
        let step = (right.1 - left.1) / width;
        let columns = centers(left.0, right.0, columns);
        if columns.is_empty() {
            continue;
        }
        let first = left.1 + step * (columns.start as f64 + 0.5 - left.0);
        put(Run {
            row,
            columns,
            first,
            step,
        });
    }
}

/// The indices, among some, of the pixels whose centres are at or after `from` and before `to`.
fn centers(from: f64, to: f64, among: &Range<i64>) -> Range<i64> {
    let index = |v: f64| (v - 0.5).ceil().clamp(among.start as f64, among.end as f64) as i64;
    index(from)..index(to)
}
