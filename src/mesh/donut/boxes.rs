//! Which of many boxes meet a box: a tree of halves.

use core::ops::Range;

use glam::DVec2;

/// The least and the largest coordinates.
pub(super) type Extent = [DVec2; 2];

/// How many boxes are looked at one by one.
const LEAF: usize = 8;

/// Boxes with their numbers, halved at the middle along the longer side of what holds them, and halved again.
pub(super) struct Boxes {
    items: Vec<(Extent, usize)>,
    /// What holds all of them, then what holds either half of what the one at `i` does at `2 i + 1` and `2 i + 2`.
    holders: Vec<Extent>,
}

impl Boxes {
    /// Boxes with numbers of their own.
    pub(super) fn new(items: impl Iterator<Item = (Extent, usize)>) -> Self {
        let mut boxes = Self {
            items: items.collect(),
            holders: Vec::new(),
        };
        boxes.halve(0, 0..boxes.items.len());
        boxes
    }

    fn halve(&mut self, holder: usize, range: Range<usize>) {
        let items = &mut self.items[range.clone()];
        let nothing = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        let bounds = items.iter().fold(nothing, |[min, max], ([from, to], _)| {
            [min.min(*from), max.max(*to)]
        });
        if self.holders.len() <= holder {
            self.holders.resize(holder + 1, nothing);
        }
        self.holders[holder] = bounds;
        if items.len() <= LEAF {
            return;
        }
        let [width, height] = (bounds[1] - bounds[0]).to_array();
        let axis = usize::from(height > width);
        let middle = |[from, to]: &Extent| from[axis] + to[axis];
        let half = items.len() / 2;
        items.select_nth_unstable_by(half, |a, b| {
            middle(&a.0).total_cmp(&middle(&b.0)).then(a.1.cmp(&b.1))
        });
        let split = range.start + half;
        self.halve(2 * holder + 1, range.start..split);
        self.halve(2 * holder + 2, split..range.end);
    }

    /// What holds all of them.
    pub(super) fn bounds(&self) -> Extent {
        self.holders[0]
    }

    /// The numbers of those that meet `bounds`, in order.
    pub(super) fn meeting(&self, bounds: Extent, found: &mut Vec<usize>) {
        found.clear();
        self.find(bounds, 0, 0..self.items.len(), found);
        found.sort_unstable();
    }

    fn find(&self, bounds: Extent, holder: usize, range: Range<usize>, found: &mut Vec<usize>) {
        if !meet(&bounds, &self.holders[holder]) {
            return;
        }
        if range.len() <= LEAF {
            let items = self.items[range].iter();
            found.extend(
                items
                    .filter(|item| meet(&bounds, &item.0))
                    .map(|item| item.1),
            );
            return;
        }
        let split = range.start + range.len() / 2;
        self.find(bounds, 2 * holder + 1, range.start..split, found);
        self.find(bounds, 2 * holder + 2, split..range.end, found);
    }
}

fn meet([min, max]: &Extent, [from, to]: &Extent) -> bool {
    min.cmple(*to).all() && from.cmple(*max).all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn those_that_meet_a_box_are_found_and_no_others() {
        // Squares on a spiral, one in ten long.
        let square = |i: u32| {
            let t = f64::from(i) * 0.1;
            let at = DVec2::new(libm::cos(t), libm::sin(t)) * t;
            let size = if i.is_multiple_of(10) {
                DVec2::new(9.0, 0.1)
            } else {
                DVec2::splat(0.3)
            };
            [at, at + size]
        };
        for count in [0, 1, 8, 9, 1000] {
            let all: Vec<Extent> = (0..count).map(square).collect();
            let boxes = Boxes::new(all.iter().copied().zip(0..));
            let mut found = vec![7];
            for asked in (0..200).map(|i| square(5 * i)) {
                boxes.meeting(asked, &mut found);
                let expected = (0..all.len()).filter(|&i| meet(&all[i], &asked));
                assert_eq!(found, expected.collect::<Vec<_>>());
            }
        }
    }
}
