//! What is apart from what: boxes in groups.

use glam::DVec2;

/// Sorts boxed items into groups, each apart from all others: a group's boxes overlap or touch in a chain.
pub(crate) fn overlapping<T>(mut boxed: Vec<(DVec2, DVec2, T)>) -> Vec<Vec<T>> {
    let mut open: Vec<(DVec2, DVec2, Vec<T>)> = Vec::new();
    boxed.sort_by(|a, b| {
        let key = |s: &(DVec2, DVec2, T)| (s.0.x, s.0.y);
        key(a)
            .partial_cmp(&key(b))
            .unwrap_or(core::cmp::Ordering::Equal)
    });
    let mut groups = Vec::new();
    for (min, max, item) in boxed {
        let (mut min, mut max, mut group) = (min, max, vec![item]);
        let mut index = 0;
        while index < open.len() {
            if open[index].1.x < min.x {
                groups.push(open.swap_remove(index).2);
            } else if open[index].0.y <= max.y && open[index].1.y >= min.y {
                let (other_min, other_max, members) = open.swap_remove(index);
                // The grown box may meet groups that were passed over.
                (min, max, index) = (min.min(other_min), max.max(other_max), 0);
                group.splice(0..0, members);
            } else {
                index += 1;
            }
        }
        open.push((min, max, group));
    }
    groups.extend(open.into_iter().map(|(_, _, group)| group));
    groups
}
