//! Where rows of densities are computed, and the pixels that they serve.

use core::ops::Range;

use super::columns::Columns;
use crate::density::chords::GROUP;
use crate::density::cubic;
use crate::density::rounded::Rounded;

/// Where rows of densities are computed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lattice {
    /// The y of row 0, and pixels from one to the next.
    pub(super) start: f64,
    pub(super) pitch: f64,
    /// Whether pixels are interpolated between them: otherwise there is one for each row of pixels.
    pub(super) is_apart: bool,
    /// The columns that are computed of a row.
    pub(super) columns: Columns,
    /// Strips from one to the next.
    pub(super) strips: i64,
    /// Rows after `straight` up to so many more are like it: they are left out of the strips.
    pub(super) straight: i64,
    pub(super) alike: i64,
    /// The row of which row 0 is the likeness, if the rectangle's lower half is its upper one's.
    pub(super) mirror: Option<i64>,
    /// The first strip.
    pub(super) first: i64,
}

impl Lattice {
    /// For a penumbra radius in pixels and a tolerance in levels; `phase` is where in a pixel of the frame a pixel begins.
    pub(super) fn new(shape: &Rounded, radius: f64, levels: f64, phase: f64) -> Self {
        let [tl, tr, br, bl] = shape.radii;
        let [columns, steps] = steps(shape, radius, levels);
        let between = radius / steps;
        let is_mirrored = tl == bl && tr == br;
        let is_apart = between
            > if is_mirrored {
                NEAREST_MIRRORED
            } else {
                NEAREST
            };
        let (pitch, strips) = if is_apart {
            let strips = GROUP as f64 * cubic::steps(levels) / steps;
            (between, (strips - 0.2).ceil() as i64)
        } else {
            // A row for each row of pixels.
            let strips = (ALIGNED * cubic::steps(levels) / radius - 0.1).ceil();
            (1.0, strips.max(1.0) as i64)
        };
        let middle = shape.min.y.midpoint(shape.max.y);
        let half = ((middle - shape.min.y + radius) / pitch).ceil() + 1.0;
        let (start, mirror) = match (is_apart, is_mirrored) {
            (true, true) => (middle - half * pitch, Some(2 * half as i64)),
            (true, false) => (-phase - 0.5, None),
            (false, _) => (0.0, None),
        };
        let mut lattice = Self {
            start,
            pitch,
            is_apart,
            columns: Columns::apart(radius / (CLOSER * columns)),
            strips,
            mirror,
            straight: 0,
            alike: 0,
            first: 0,
        };
        let reach = radius + 2.0 * lattice.height();
        let first = lattice.row_at(shape.min.y + tl.max(tr) + reach).ceil() as i64;
        let last = lattice.row_at(shape.max.y - bl.max(br) - reach).floor() as i64;
        (lattice.straight, lattice.alike) = (first, (last - first).max(0));
        let top = (shape.min.y - lattice.start) / lattice.height();
        // Chords that begin above the rectangle may end within it.
        lattice.first = ((top / GROUP as f64).floor() as i64 - 1) * GROUP;
        lattice
    }

    /// The height of a strip, in pixels.
    pub(super) fn height(&self) -> f64 {
        self.pitch / self.strips as f64
    }

    /// Where among the rows a y is.
    pub(super) fn row_at(&self, y: f64) -> f64 {
        (y - self.start) / self.pitch
    }

    /// Takes the next row of pixels: those that need the same rows one after another.
    pub(super) fn next(&self, lines: &mut Range<i64>) -> Option<i64> {
        let place = |line: i64| {
            let place = self.row_at(line as f64);
            self.mirror
                .map_or(place, |mirror| place.min(mirror as f64 - place))
        };
        if !lines.is_empty() && place(lines.end - 1) < place(lines.start) {
            lines.next_back()
        } else {
            lines.next()
        }
    }

    /// A row of which another is a copy, or itself, among those left.
    pub(super) fn folded(&self, row: i64) -> i64 {
        let row = self.mirror.map_or(row, |mirror| row.min(mirror - row));
        if row <= self.straight {
            row
        } else {
            (row - self.alike).max(self.straight)
        }
    }
}

/// Strips where each row of pixels is computed, over the rows that cubics between them would need: without cubics fewer
/// are enough.
const ALIGNED: f64 = 2.0;

/// Columns are so many times as close to each other as rows.
const CLOSER: f64 = 1.15;

/// Rows nearer to each other than this, in pixels, are not worth interpolating between.
const NEAREST: f64 = 1.25;

/// The same where the rows of one half serve both.
const NEAREST_MIRRORED: f64 = 0.8;

/// The columns and the rows a penumbra radius for a tolerance. Two of the penumbra's ends may meet on a middle line; and where a disc
/// nearly fills its corner's circle, the density has a tip at that circle's centre that cubics between few rows do not
/// hold, the less the more such centres are in one place.
fn steps(shape: &Rounded, radius: f64, levels: f64) -> [f64; 2] {
    let steps = cubic::steps(levels);
    let near = |distance: f64| distance.abs() < 4.0 * radius / steps;
    let size = shape.max - shape.min;
    let [tl, tr, br, bl] = shape.radii;
    let mut tip = 0.0;
    if shape
        .radii
        .iter()
        .any(|corner| (0.8..1.35).contains(&(corner / radius)))
    {
        let across = near(size.x - tl - tr) || near(size.x - bl - br);
        let down = near(size.y - tl - bl) || near(size.y - tr - br);
        tip = TIP / levels * [1.0, 2.0, 4.0][usize::from(across) + usize::from(down)];
    }
    [size.x, size.y].map(|size| {
        let ends = if near(size - 2.0 * radius) { 2.0 } else { 1.0 };
        cubic::steps(levels / ends).max(tip)
    })
}

/// The error at a tip, in levels, times the rows a penumbra radius.
const TIP: f64 = 20.0;
