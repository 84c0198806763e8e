//! Hidden: the pixels that something opaque covers, on which no shadow is seen.

mod card;
pub(crate) mod inside;

use core::ops::Range;

use self::inside::sort_by_row;
use crate::density::rounded::{LARGEST, Rounded};
use crate::grid::Grid;
use crate::light::Projection;
use crate::path::Contour;
use crate::scratch::Scratch;
use crate::shadow::Shadow;
use crate::shape::{Cover, Shape};

/// Pixels of one grid that need no shadow: those wholly covered by opaque surfaces above the receiver, or clipped away.
///
/// What surfaces hide is a matter of speed alone: whatever is painted over a shadow hides it anyway, and a pixel that is only partly
/// covered is never hidden. [Clips](Self::clip) leave out what would be seen. Of hidden pixels masks are 0, and nothing is blended onto
/// a canvas.
///
/// ```
/// use penumbral::{Color, Grid, Hidden, Light, Paint, PixelOptions, Scratch, Shape};
///
/// let card = Shape::rounded_rect(24.0, 40.0, 312.0, 160.0, 12.0)?;
/// let shadow = Light::android(360.0)?.cast(&card, 8.0, 0.0)?;
/// let grid = Grid::new([0.0, 0.0], [360, 240], 1.0)?;
/// let mut scratch = Scratch::new();
///
/// let mut hidden = Hidden::new(&grid);
/// hidden.add(&card, &mut scratch);
/// let options = PixelOptions::default().with_hidden(&hidden);
/// let mut canvas = vec![255; 360 * 240 * 4];
/// let paint = Paint::new(Color::BLACK, 0.19)?;
/// shadow.blend_rgba8(&grid, &mut canvas, &paint, &options, &mut scratch)?;
/// # Ok::<(), penumbral::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Hidden {
    grid: Grid,
    /// Spans of columns, sorted by row and column, apart from each other.
    spans: Vec<Span>,
    /// Where each row's spans begin, and where the last one's end.
    rows: Vec<u32>,
    /// Memory for sorting.
    sorted: Vec<Span>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Span {
    row: u32,
    start: u32,
    end: u32,
}

impl Hidden {
    /// Nothing hidden on a grid.
    #[must_use]
    pub fn new(grid: &Grid) -> Self {
        let mut hidden = Self {
            grid: *grid,
            spans: Vec::new(),
            rows: Vec::new(),
            sorted: Vec::new(),
        };
        hidden.seal();
        hidden
    }

    /// Nothing hidden on a grid, with the memory of what was.
    pub fn reset(&mut self, grid: &Grid) {
        self.grid = *grid;
        self.spans.clear();
        self.seal();
    }

    /// Hides the pixels that a shape covers wholly.
    pub fn add(&mut self, shape: &Shape, scratch: &mut Scratch) {
        self.add_all(core::iter::once(shape), scratch);
    }

    /// Hides the pixels that one of many shapes covers wholly.
    pub fn add_all<'a>(&mut self, shapes: impl Iterator<Item = &'a Shape>, scratch: &mut Scratch) {
        let mut most = MANY;
        for shape in shapes {
            self.push_covered(shape, scratch);
            // Shapes on one another hide the same pixels: memory is for those, not for all shapes' rows.
            if self.spans.len() > most {
                self.seal();
                most = MANY + 2 * self.spans.len();
            }
        }
        self.seal();
    }

    /// Hides all pixels but those of some columns and rows, such as a rectangle of a canvas that is to be blended again; of several
    /// clips, what is in all of them is seen. What lies beyond the grid is not seen anyway. To fill a rectangle of a mask that is
    /// kept, draw on a grid of that rectangle, with the mask's stride.
    ///
    /// ```
    /// use penumbral::{Grid, Hidden, Light, PixelOptions, Scratch, Shape};
    ///
    /// let shadow = Light::flutter().cast(&Shape::rect(8.0, 8.0, 40.0, 40.0)?, 6.0, 0.0)?;
    /// let grid = Grid::new([0.0, 0.0], [64, 64], 1.0)?;
    /// let mut hidden = Hidden::new(&grid);
    /// hidden.clip(0..20, 30..64);
    /// let options = PixelOptions::default().with_hidden(&hidden);
    /// let mut mask = vec![0; 64 * 64];
    /// shadow.fill_a8(&grid, &mut mask, &options, &mut Scratch::new())?;
    /// assert!(mask[40 * 64 + 10] > 0 && mask[40 * 64 + 30] == 0 && mask[20 * 64 + 10] == 0);
    /// # Ok::<(), penumbral::Error>(())
    /// ```
    pub fn clip(&mut self, columns: Range<u32>, rows: Range<u32>) {
        let width = self.grid.width();
        for row in 0..self.grid.height() {
            let seen = if rows.contains(&row) && !columns.is_empty() {
                columns.start.min(width)..columns.end.min(width)
            } else {
                width..width
            };
            let beside = [0..seen.start, seen.end..width];
            let spans = beside.into_iter().filter(|beside| !beside.is_empty());
            self.spans.extend(spans.map(|beside| Span {
                row,
                start: beside.start,
                end: beside.end,
            }));
        }
        self.seal();
    }

    /// Hides the pixels for which `hides` (column, row) says so.
    #[cfg(feature = "raster")]
    pub(crate) fn add_where(&mut self, mut hides: impl FnMut(u32, u32) -> bool) {
        for row in 0..self.grid.height() {
            let mut start = None;
            for column in 0..=self.grid.width() {
                let hidden = column < self.grid.width() && hides(column, row);
                match (hidden, start) {
                    (true, None) => start = Some(column),
                    (false, Some(first)) => {
                        self.spans.push(Span {
                            row,
                            start: first,
                            end: column,
                        });
                        start = None;
                    }
                    _ => {}
                }
            }
        }
        self.seal();
    }

    /// What is hidden of a window of the grid whose first pixel is at column and row `first`.
    #[cfg(feature = "rayon")]
    pub(crate) fn window(&self, window: &Grid, first: [u32; 2]) -> Self {
        let mut hidden = Self::new(window);
        let [left, top] = first;
        let rows = top..top + window.height();
        let spans = self.spans.iter().filter(|span| rows.contains(&span.row));
        let cut = spans.map(|span| Span {
            row: span.row - top,
            start: span.start.max(left) - left,
            end: span.end.clamp(left, left + window.width()) - left,
        });
        hidden
            .spans
            .extend(cut.filter(|span| span.start < span.end));
        hidden.seal();
        hidden
    }

    /// The grid that it was made for.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    pub(crate) fn hides(&self, column: u32, row: u32) -> bool {
        self.of_row(row)
            .iter()
            .any(|span| span.start <= column && column < span.end)
    }

    /// Calls `see` with the parts of a row's columns that are seen, from left to right.
    #[inline(always)]
    pub(crate) fn seen(&self, row: u32, columns: Range<u32>, mut see: impl FnMut(Range<u32>)) {
        let mut start = columns.start;
        let spans = self.of_row(row);
        let first = spans.partition_point(|span| span.end <= start);
        for span in &spans[first..] {
            if span.start >= columns.end {
                break;
            }
            if span.start > start {
                see(start..span.start);
            }
            start = start.max(span.end);
        }
        if start < columns.end {
            see(start..columns.end);
        }
    }

    /// How many of some rows, from the first one on, hide the same columns.
    pub(crate) fn alike(&self, rows: Range<u32>) -> u32 {
        let columns = |span: &Span| span.start..span.end;
        let first = self.of_row(rows.start);
        let is_alike = |row: &u32| {
            let spans = self.of_row(*row);
            spans.iter().map(columns).eq(first.iter().map(columns))
        };
        let others = rows.start + 1..rows.end;
        1 + others.take_while(is_alike).count() as u32
    }

    fn of_row(&self, row: u32) -> &[Span] {
        let row = row as usize;
        &self.spans[self.rows[row] as usize..self.rows[row + 1] as usize]
    }

    /// Sorts and joins the spans, and finds the rows among them.
    fn seal(&mut self) {
        let height = self.grid.height();
        if self
            .spans
            .is_sorted_by(|a, b| (a.row, a.end) < (b.row, b.start))
        {
            self.rows.clear();
            for (at, span) in self.spans.iter().enumerate() {
                let begun = (span.row as usize + 1).max(self.rows.len());
                self.rows.resize(begun, at as u32);
            }
            self.rows
                .resize(height as usize + 1, self.spans.len() as u32);
            return;
        }
        sort_by_row(
            &self.spans,
            |span| span.row,
            height,
            &mut self.sorted,
            &mut self.rows,
        );
        self.spans.clear();
        for row in 0..height as usize {
            let range = self.rows[row] as usize..self.rows[row + 1] as usize;
            let first = self.spans.len();
            self.rows[row] = first as u32;
            let of_row = &mut self.sorted[range];
            of_row.sort_unstable();
            for span in &*of_row {
                match self.spans[first..].last_mut() {
                    Some(last) if span.start <= last.end => last.end = last.end.max(span.end),
                    _ => self.spans.push(*span),
                }
            }
        }
        self.rows[height as usize] = self.spans.len() as u32;
    }

    fn push_covered(&mut self, shape: &Shape, scratch: &mut Scratch) {
        let (scale, corner) = (self.grid.pixels_per_unit(), self.grid.corner());
        let mut edges = scratch.take();
        if shape.cover == Cover::Simple {
            let (flatness, vertices) = (inside::FLATNESS / scale, &mut scratch.vertices);
            for contour in &shape.contours {
                contour.near(flatness, vertices, &mut edges);
            }
        } else {
            let cover = Shadow::project(&[shape], &Projection::in_place(0.0));
            cover.edges_into(CURVES, 1.0 / scale, &mut edges);
        }
        let size = [self.grid.width(), self.grid.height()];
        let spans = &mut self.spans;
        let push = |row, start, end| spans.push(Span { row, start, end });
        let exact = match shape.cover {
            Cover::Simple => shape.contours.iter().all(Contour::is_of_circles),
            Cover::Rule(_) => shape.is_straight(),
        };
        let card = Rounded::of_loop(&edges).filter(|card| {
            let size = (card.max - card.min).max_element() * scale;
            exact && size <= LARGEST
        });
        if let Some(card) = card {
            let card = Rounded {
                min: card.min * scale - corner,
                max: card.max * scale - corner,
                radii: card.radii.map(|radius| radius * scale),
            };
            card::find(&card, size, push);
        } else {
            let margin = if exact { 0.0 } else { inside::FLATNESS };
            let placed = edges
                .iter()
                .map(|edge| edge.mapped(scale, |p| p * scale - corner));
            scratch.inside.find(placed, margin, size, push);
        }
        scratch.give(edges);
    }
}

/// Spans that are kept as they come before they are joined.
const MANY: usize = 1 << 16;

/// How far lines in place of curves that need a fill rule may move a pixel's coverage, in levels: they are within [`inside::FLATNESS`].
const CURVES: f64 = 2.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::PixelOptions;
    use crate::path::FillRule;

    fn spans(hidden: &Hidden, row: u32) -> Vec<(u32, u32)> {
        hidden
            .of_row(row)
            .iter()
            .map(|s| (s.start, s.end))
            .collect()
    }

    #[test]
    fn whole_pixels_are_hidden_and_no_others() {
        let grid = Grid::new([0.0, 0.0], [30, 12], 1.0).unwrap();
        let mut scratch = Scratch::new();
        let mut hidden = Hidden::new(&grid);
        hidden.add(&Shape::rect(2.5, 1.0, 10.0, 5.5).unwrap(), &mut scratch);
        assert_eq!(spans(&hidden, 0), []);
        assert_eq!(spans(&hidden, 1), [(3, 12)]);
        assert_eq!(spans(&hidden, 5), [(3, 12)]);
        assert_eq!(spans(&hidden, 6), []);
        hidden.add(&Shape::rect(12.0, 0.0, 10.0, 3.0).unwrap(), &mut scratch);
        assert_eq!(spans(&hidden, 1), [(3, 22)]);
        assert_eq!(spans(&hidden, 4), [(3, 12)]);
        let mut seen = Vec::new();
        hidden.seen(1, 0..30, |columns| seen.push(columns));
        assert_eq!(seen, [0..3, 22..30]);
    }

    #[test]
    fn any_shape_hides_the_pixels_of_full_coverage() {
        let grid = Grid::new([0.0, 0.0], [60, 60], 1.0).unwrap();
        let ring = |side: f32| {
            let (a, b) = (30.0 - side, 30.0 + side);
            [[30.0, a], [b, 30.0], [30.0, b], [a, 30.0]]
        };
        let shapes = [
            Shape::circle([30.0, 30.0], 20.3).unwrap(),
            Shape::rounded_rect(3.3, 4.4, 50.0, 40.0, [0.0, 5.0, 10.0, 20.0]).unwrap(),
            Shape::polygon(&[ring(25.0), ring(9.0)], FillRule::EvenOdd).unwrap(),
        ];
        for shape in shapes {
            let mut scratch = Scratch::new();
            let mut hidden = Hidden::new(&grid);
            hidden.add(&shape, &mut scratch);
            let mut coverage = vec![0; 3600];
            let cover = Shadow::project(&[&shape], &Projection::in_place(0.0));
            cover
                .fill_a8(&grid, &mut coverage, &PixelOptions::default(), &mut scratch)
                .unwrap();
            let mut count = 0;
            for row in 0..60 {
                for column in 0..60 {
                    let full = coverage[(row * 60 + column) as usize] == 255;
                    if hidden.hides(column, row) {
                        assert!(full, "{column} {row}");
                        count += 1;
                    }
                }
            }
            let full = coverage.iter().filter(|&&c| c == 255).count();
            assert!(count * 10 >= full * 9, "{count} of {full}");
        }
    }
}
