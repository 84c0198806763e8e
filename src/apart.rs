//! What is apart from what: boxes in groups.

use glam::DVec2;

/// Sorts boxed items into groups that are apart from each other: a group's boxes overlap or touch in a chain. The boxes around two
/// groups may overlap.
pub(crate) fn overlapping<T>(mut boxed: Vec<(DVec2, DVec2, T)>) -> Vec<Vec<T>> {
    boxed.sort_by(|a, b| a.0.x.total_cmp(&b.0.x).then(a.0.y.total_cmp(&b.0.y)));
    // Of each box another one of its group, or itself; from box to box all come to the group's first.
    let mut leaders: Vec<usize> = Vec::with_capacity(boxed.len());
    let mut open: Vec<usize> = Vec::new();
    for (index, (min, max, _)) in boxed.iter().enumerate() {
        leaders.push(index);
        open.retain(|&other| boxed[other].1.x >= min.x);
        for &other in &open {
            if boxed[other].0.y <= max.y && boxed[other].1.y >= min.y {
                let (a, b) = (first(&mut leaders, other), first(&mut leaders, index));
                leaders[a.max(b)] = a.min(b);
            }
        }
        open.push(index);
    }
    let mut groups: Vec<Vec<T>> = boxed.iter().map(|_| Vec::new()).collect();
    for (index, (_, _, item)) in boxed.into_iter().enumerate() {
        groups[first(&mut leaders, index)].push(item);
    }
    groups.retain(|group| !group.is_empty());
    groups
}

/// The smallest box that holds some boxes, or none for none.
pub(crate) fn around(boxes: impl IntoIterator<Item = (DVec2, DVec2)>) -> Option<(DVec2, DVec2)> {
    let boxes = boxes.into_iter();
    boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

/// The smallest box that holds some points, or none for none.
pub(crate) fn around_points(points: impl IntoIterator<Item = DVec2>) -> Option<(DVec2, DVec2)> {
    around(points.into_iter().map(|point| (point, point)))
}

/// The first box of a group.
fn first(leaders: &mut [usize], mut index: usize) -> usize {
    while leaders[index] != index {
        leaders[index] = leaders[leaders[index]];
        index = leaders[index];
    }
    index
}
