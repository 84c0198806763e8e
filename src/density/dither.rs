//! The last rounding to 8 bits: to the nearest, or spread by an ordered pattern.

use core::ops::Range;

/// Where rows are in a buffer, and which pixel of the dithering pattern the first one is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Layout {
    pub(crate) stride: usize,
    /// The pattern's column and row, or none to round to the nearest.
    pub(crate) dither: Option<[u32; 2]>,
}

impl Layout {
    /// Those of some rows that round alike, one group after another.
    #[inline(always)]
    pub(super) fn alike(&self, mut rows: Range<u32>) -> impl Iterator<Item = Range<u32>> {
        core::iter::from_fn(move || {
            let first = rows.start;
            let end = if self.dither.is_none() {
                rows.end
            } else {
                first + 1
            };
            rows.start = end;
            (first < rows.end).then_some(first..end)
        })
    }
}

/// The side of the dithering pattern, in pixels.
pub(super) const PATTERN: usize = 8;

/// Bayer's ordered dithering (Bayer 1973): the ranks 0 to 63 of an 8 x 8 pattern. Each 2 x 2, 4 x 4 and 8 x 8 block holds
/// evenly spread thresholds, so a slope becomes no band wider than a few pixels.
const BAYER: [[u8; PATTERN]; PATTERN] = {
    let mut pattern = [[0; PATTERN]; PATTERN];
    let mut y = 0;
    while y < 8 {
        let mut x = 0;
        while x < 8 {
            let mut rank = 0;
            let mut bit = 0;
            while bit < 3 {
                let (across, down) = ((x >> bit) & 1, (y >> bit) & 1);
                rank |= (((across ^ down) << 1) | down) << (2 * (2 - bit));
                bit += 1;
            }
            pattern[y][x] = rank as u8;
            x += 1;
        }
        y += 1;
    }
    pattern
};

/// What is added to eight pixels before their last 8 bits are cut off, in 256ths, from column `first` of row `y` on: so on
/// for each eight behind them.
#[inline(always)]
pub(super) fn thresholds(layout: &Layout, y: u32, first: u32) -> [u16; PATTERN] {
    match layout.dither {
        None => [128; PATTERN],
        Some([left, top]) => {
            let row = &BAYER[(y.wrapping_add(top) & 7) as usize];
            let mut thresholds = [0; PATTERN];
            for (lane, threshold) in thresholds.iter_mut().enumerate() {
                let column = first.wrapping_add(left).wrapping_add(lane as u32) & 7;
                *threshold = u16::from(row[column as usize]) * 4 + 2;
            }
            thresholds
        }
    }
}
