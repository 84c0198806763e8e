//! Where rows of densities are computed, and the pixels that they serve.

use core::ops::Range;

use super::columns::Columns;
use crate::density::frame::whole_below;
use crate::density::rounded::Rounded;
use crate::density::{cubic, reach};

/// Where rows of densities are computed.
#[derive(Debug)]
pub(super) struct Lattice {
    pub(super) shape: Rounded,
    /// How far a pixel's average reaches.
    pub(super) reach: f64,
    /// The y of row 0, pixels from one to the next, and rows a pixel.
    start: f64,
    pitch: f64,
    density: f64,
    /// Whether pixels are interpolated between them: otherwise there is one for each row of pixels.
    is_apart: bool,
    /// Every so manyth of them is enough, a power of two, except where corners' circles have tips.
    step: i64,
    tips: Range<f64>,
    /// The columns that are computed of a row, and whether pixels are near enough to each other for cubics between them.
    pub(super) columns: Columns,
    pub(super) are_columns_near: bool,
    /// Rows after `straight` up to so many more are like it: they are left out.
    straight: i64,
    alike: i64,
    /// The row of which row 0 is the likeness, if the rectangle's lower half is its upper one's.
    mirror: Option<i64>,
}

impl Lattice {
    /// For a penumbra radius in pixels and a tolerance in levels; `phase` is where in a pixel of the frame a pixel begins.
    pub(super) fn new(shape: &Rounded, radius: f64, levels: f64, phase: f64) -> Self {
        let [tl, tr, br, bl] = shape.radii;
        let steps = Steps::new(shape, radius, levels);
        let between = radius / steps.rows;
        let is_mirrored = tl == bl && tr == br;
        let is_apart = between
            > if is_mirrored {
                NEAREST_MIRRORED
            } else {
                NEAREST
            };
        // Otherwise a row for each row of pixels.
        let (pitch, step) = if !is_apart {
            (1.0, 1)
        } else if steps.has_tips {
            (0.5 * between, 2)
        } else {
            (between, 1)
        };
        let reach = reach(radius);
        let middle = shape.min.y.midpoint(shape.max.y);
        // The middle is one of those that are enough.
        let every = pitch * step as f64;
        let half = (((middle - shape.min.y + reach) / every).ceil() + 1.0) * step as f64;
        let (start, mirror) = match (is_apart, is_mirrored) {
            (true, true) => (middle - half * pitch, Some(2 * half as i64)),
            (true, false) => (-phase - 0.5, None),
            (false, _) => (0.0, None),
        };
        let apart = radius / (CLOSER * steps.columns);
        let mut lattice = Self {
            shape: *shape,
            reach,
            start,
            pitch,
            density: 1.0 / pitch,
            is_apart,
            step,
            tips: 0.0..0.0,
            columns: Columns::apart(apart),
            are_columns_near: apart >= 1.0,
            mirror,
            straight: 0,
            alike: 0,
        };
        let first = lattice.row_at(shape.min.y + tl.max(tr) + reach).ceil() as i64;
        let last = lattice.row_at(shape.max.y - bl.max(br) - reach).floor() as i64;
        (lattice.straight, lattice.alike) = (first, (last - first).max(0));
        if step > 1 {
            let places = tips(shape, radius).map(|y| lattice.folded_at(y));
            let first = places.clone().fold(f64::MAX, f64::min);
            let last = places.fold(f64::MIN, f64::max);
            let beside = TIP * step as f64;
            lattice.tips = first - beside..last + beside;
        }
        lattice
    }

    /// The y of a row among those left.
    pub(super) fn y(&self, row: i64) -> f64 {
        let left_out = if row > self.straight { self.alike } else { 0 };
        self.start + (row + left_out) as f64 * self.pitch
    }

    /// Where among the rows a y is.
    pub(super) fn row_at(&self, y: f64) -> f64 {
        (y - self.start) * self.density
    }

    /// The same in the half of which the other is the likeness.
    fn folded_at(&self, y: f64) -> f64 {
        let place = self.row_at(y);
        self.mirror
            .map_or(place, |mirror| place.min(mirror as f64 - place))
    }

    /// Rows of pixels that are alike and where they are among the lattice's: those that need the same rows one after another.
    pub(super) fn lines(&self, lines: Range<i64>) -> impl Iterator<Item = (Range<i64>, f64)> {
        let place = |line: i64| self.folded_at(line as f64);
        let mut alike = self.alike_lines(&lines);
        let (mut above, mut below) = (lines.start..alike.start, alike.end..lines.end);
        let mut ends = [place(above.start), place(below.end - 1)];
        core::iter::from_fn(move || {
            let [first, last] = ends;
            if !below.is_empty() && (above.is_empty() || last < first) {
                below.end -= 1;
                ends[1] = place(below.end - 1);
                Some((below.end..below.end + 1, last))
            } else if !above.is_empty() {
                above.start += 1;
                ends[0] = place(above.start);
                Some((above.start - 1..above.start, first))
            } else {
                let lines = core::mem::replace(&mut alike, 0..0);
                (!lines.is_empty()).then(|| (lines.clone(), place(lines.start)))
            }
        })
    }

    /// Those of some rows of pixels for which all of the lattice's are alike; from their middle on where there are none.
    fn alike_lines(&self, lines: &Range<i64>) -> Range<i64> {
        let on_lines = |line: i64| line.clamp(lines.start, lines.end);
        let line = |row: i64| self.start + row as f64 * self.pitch;
        let mut start = on_lines(line(self.straight).ceil() as i64);
        let mut end = on_lines(line(self.straight + self.alike).floor() as i64 + 1);
        let is_alike = |line: i64| {
            let cell = self.cell(self.folded_at(line as f64));
            cell.rows == [self.straight; 4]
        };
        while start < end && !is_alike(start) {
            start += 1;
        }
        while start < end && !is_alike(end - 1) {
            end -= 1;
        }
        if start < end {
            return start..end;
        }
        let middle = on_lines(self.shape.min.y.midpoint(self.shape.max.y) as i64);
        middle..middle
    }

    /// The cell at a place among the rows.
    pub(super) fn cell(&self, place: f64) -> Cell {
        let step = if self.tips.contains(&place) {
            1
        } else {
            self.step
        };
        let row = whole_below(place) & -step;
        if self.is_apart {
            let share = (place - row as f64) / step as f64;
            Cell {
                rows: [
                    self.folded(row - step),
                    self.folded(row),
                    self.folded(row + step),
                    self.folded(row + 2 * step),
                ],
                weights: cubic::touching(share),
            }
        } else {
            Cell {
                rows: [self.folded(row); 4],
                weights: [0.0, 1.0, 0.0, 0.0],
            }
        }
    }

    /// A row of which another is a copy, or itself, among those left.
    fn folded(&self, row: i64) -> i64 {
        let row = self.mirror.map_or(row, |mirror| row.min(mirror - row));
        if row <= self.straight {
            row
        } else {
            (row - self.alike).max(self.straight)
        }
    }
}

/// The four rows that pixels are interpolated from, and their weights.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    pub(super) rows: [i64; 4],
    pub(super) weights: [f32; 4],
}

impl Cell {
    /// The rows that it takes: one where all four are alike.
    pub(super) fn distinct(&self) -> &[i64] {
        if self.rows[0] == self.rows[3] {
            &self.rows[..1]
        } else {
            &self.rows
        }
    }
}

/// Columns are so many times as close to each other as rows.
const CLOSER: f64 = 1.4;

/// Rows nearer to each other than this, in pixels, are not worth interpolating between.
const NEAREST: f64 = 1.15;

/// The same where the rows of one half serve both.
const NEAREST_MIRRORED: f64 = 0.65;

/// Rows over those of [`cubic::steps`]: the sum over heights takes less of the tolerance than chords do. Of 24,000 random
/// rectangles at tolerances of 0.5 to 4 levels none passed 0.88 of it.
const ROWS: f64 = 0.68;

/// So many times the distance of rows elsewhere from the centre of a corner's circle, its tip does not show. Of 16,000 rectangles
/// with tips at tolerances of 0.5 to 2 levels none passed 0.95 of it; with 4, one 0.91, and with 3, one 1.08.
const TIP: f64 = 5.0;

/// Rows about tips are worth their own distance where so many times as many are needed there.
const WORTH: f64 = 1.5;

/// Tips that are fewer rows apart than this add up. Of 400,000 cards with tips none passed 0.88 of its tolerance; with 4, and none below 0.5
/// of the penumbra's radius, seven of 200,000 passed half a level.
const TOGETHER: f64 = 7.0;

/// The columns and the rows a penumbra radius for a tolerance.
struct Steps {
    columns: f64,
    rows: f64,
    /// Whether there are tips for which rows are to be twice as many.
    has_tips: bool,
}

impl Steps {
    /// Two of the penumbra's ends may meet on a middle line; and where a disc nearly fills its corner's circle, the density has a tip
    /// at that circle's centre that cubics between few rows do not hold, the less the more such centres are in one place.
    fn new(shape: &Rounded, radius: f64, levels: f64) -> Self {
        let steps = ROWS * cubic::steps(levels);
        let near = |distance: f64, rows: f64| distance.abs() < rows * radius / steps;
        let meet = |distance: f64| near(distance, TOGETHER);
        let size = shape.max - shape.min;
        let [tl, tr, br, bl] = shape.radii;
        let tips = shape.radii.map(|corner| tip(corner / radius));
        let across = meet(size.x - tl - tr) || meet(size.x - bl - br);
        let down = meet(size.y - tl - bl) || meet(size.y - tr - br);
        let together = [1.0, 2.0, 4.0][usize::from(across) + usize::from(down)];
        let tip = tips.into_iter().fold(0.0, f64::max) / levels * together;
        let [columns, rows] = [size.x, size.y].map(|size| {
            let is_thin = near(size - 2.0 * radius, 4.0);
            ROWS * cubic::steps(if is_thin { 0.5 * levels } else { levels })
        });
        let has_tips = tip > WORTH * rows;
        Self {
            columns: columns.max(tip),
            rows: rows.max(if has_tips { 0.5 * tip } else { tip }),
            has_tips,
        }
    }
}

/// The heights of the centres of corners' circles with tips.
fn tips(shape: &Rounded, radius: f64) -> impl Iterator<Item = f64> + Clone {
    let [tl, tr, br, bl] = shape.radii;
    let (top, bottom) = (shape.min.y, shape.max.y);
    let corners = [
        (tl, top + tl),
        (tr, top + tr),
        (br, bottom - br),
        (bl, bottom - bl),
    ];
    let with_tips = corners
        .into_iter()
        .filter(move |(corner, _)| tip(corner / radius) > 0.0);
    with_tips.map(|(_, y)| y)
}

/// The error at the tip of a corner's circle, in levels, times the rows a penumbra radius; `ratio` is the circle's radius over the
/// penumbra's.
fn tip(ratio: f64) -> f64 {
    if (0.8..1.35).contains(&ratio) {
        20.0
    } else if (0.45..1.45).contains(&ratio) {
        13.0
    } else {
        0.0
    }
}
