//! The pixels that lie wholly inside a rounded rectangle, row by row.

use crate::density::frame::whole_below;
use crate::density::rounded::Rounded;

/// Calls `push` with row, first column and end of each run of pixels that lie wholly inside of a rounded rectangle in pixels. Rows
/// and columns are those of a grid of `size`.
pub(super) fn find(card: &Rounded, [width, height]: [u32; 2], mut push: impl FnMut(u32, u32, u32)) {
    let [top_left, top_right, bottom_right, bottom_left] = card.radii;
    let (width, height) = (f64::from(width), f64::from(height));
    let ceil = |v: f64| -whole_below(-v) as u32;
    let first = ceil(card.min.y.clamp(0.0, height));
    let end = card.max.y.clamp(0.0, height) as u32;
    let columns = |left: f64, right: f64| {
        let start = ceil((card.min.x + left).clamp(0.0, width));
        let end = (card.max.x - right).clamp(0.0, width) as u32;
        (start, end)
    };
    let (upper, lower) = (top_left.max(top_right), bottom_left.max(bottom_right));
    let between = columns(0.0, 0.0);
    let is_even = top_left == top_right && bottom_left == bottom_right;
    for row in first..end {
        // A row is narrowest where it is nearest to the rectangle's top or bottom.
        let above = f64::from(row) - card.min.y;
        let below = card.max.y - f64::from(row + 1);
        let (start, end) = if above >= upper && below >= lower {
            between
        } else {
            let left = inset(top_left, above).max(inset(bottom_left, below));
            if is_even {
                columns(left, left)
            } else {
                let right = inset(top_right, above).max(inset(bottom_right, below));
                columns(left, right)
            }
        };
        if start < end {
            push(row, start, end);
        }
    }
}

/// How far a corner's circle is drawn in at a `depth` inside of the side that it ends at.
fn inset(radius: f64, depth: f64) -> f64 {
    let rise = radius - depth;
    if rise <= 0.0 {
        return 0.0;
    }
    radius - (radius * radius - rise * rise).max(0.0).sqrt()
}
