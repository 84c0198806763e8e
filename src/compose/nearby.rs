//! Which boxes are near a place: the canvas in cells, each with a list.

use core::ops::Range;

use glam::DVec2;

use super::Receiver;

/// So many cells a side: few enough that a surface over all of the canvas is cheap to note.
const CELLS: usize = 24;

/// Boxes by the cells of the canvas that they meet.
#[derive(Debug)]
pub(super) struct Nearby {
    min: DVec2,
    size: DVec2,
    cells: Vec<Vec<u32>>,
}

impl Nearby {
    /// Notes boxes on the canvas; those that miss it are near nothing.
    pub(super) fn new(canvas: &Receiver, boxes: &[Option<(DVec2, DVec2)>]) -> Self {
        let mut nearby = Self {
            min: canvas.min,
            size: canvas.max - canvas.min,
            cells: vec![Vec::new(); CELLS * CELLS],
        };
        for (index, bounds) in boxes.iter().enumerate() {
            if let Some((min, max)) = *bounds
                && min.cmple(canvas.max).all()
                && max.cmpge(canvas.min).all()
            {
                let [columns, rows] = nearby.cells_of(min, max);
                for row in rows {
                    for column in columns.clone() {
                        nearby.cells[row * CELLS + column].push(index as u32);
                    }
                }
            }
        }
        nearby
    }

    /// The boxes that may meet a receiver, in their order.
    pub(super) fn of(&self, receiver: &Receiver) -> Vec<usize> {
        let [columns, rows] = self.cells_of(receiver.min, receiver.max);
        let cells = rows.flat_map(|row| &self.cells[row * CELLS..][columns.clone()]);
        let mut found: Vec<usize> = cells.flatten().map(|&index| index as usize).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    fn cells_of(&self, min: DVec2, max: DVec2) -> [Range<usize>; 2] {
        let cell = |p: DVec2| {
            let cell = (p - self.min) / self.size * CELLS as f64;
            cell.floor()
                .clamp(DVec2::ZERO, DVec2::splat((CELLS - 1) as f64))
        };
        let (first, last) = (cell(min), cell(max));
        [0, 1].map(|axis| first[axis] as usize..last[axis] as usize + 1)
    }
}
