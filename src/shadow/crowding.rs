//! How much of curves one disc may see.

use std::collections::HashMap;

use glam::DVec2;

use crate::path::Segment;
use crate::shape::Shape;

/// A chord that is longer than so many radii is counted as one of that length, about its middle: such curves are nearly straight for a disc.
const LONGEST: f64 = 4.0;

/// How many times its own circumference a disc may see of the curves of some shapes, at least 1. Curves are cut into chords as if there
/// were one that long: of more, areas between chords and curves add up.
///
/// Lengths are counted by squares of the radius's size, of which a disc meets nine at most. They begin at `corner`, one of the shapes': where
/// these are changes nothing.
pub(super) fn crowding<'a>(
    shapes: impl Iterator<Item = &'a Shape>,
    radius: f64,
    corner: DVec2,
) -> f64 {
    let mut lengths: HashMap<[i64; 2], f64> = HashMap::new();
    let mut chords = Vec::new();
    for contour in shapes.flat_map(|shape| &shape.contours) {
        let mut from = contour.start;
        let place = |point: DVec2| (point - corner) / radius;
        for segment in &contour.segments {
            if !matches!(segment, Segment::Line(_)) {
                chords.clear();
                segment.flatten(from, radius / 8.0, &mut chords);
                let mut start = place(from);
                for &end in &chords {
                    add(start, place(end), &mut lengths);
                    start = place(end);
                }
            }
            from = segment.end();
        }
    }
    let about = |&[x, y]: &[i64; 2]| {
        let near = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [x + dx, y + dy]));
        near.filter_map(|square| lengths.get(&square)).sum::<f64>()
    };
    let most = lengths.keys().map(about).fold(0.0, f64::max);
    (most / core::f64::consts::TAU).max(1.0)
}

/// Adds a chord's length, in radii, to the squares that it is in.
fn add(start: DVec2, end: DVec2, lengths: &mut HashMap<[i64; 2], f64>) {
    let (chord, middle) = (end - start, start.midpoint(end));
    let length = chord.length().min(LONGEST);
    let way = chord.normalize_or_zero() * length;
    let count = length.ceil().max(1.0);
    for part in 0..count as u32 {
        let at = middle + way * ((f64::from(part) + 0.5) / count - 0.5);
        let square = [at.x, at.y].map(|v| v.floor() as i64);
        *lengths.entry(square).or_default() += length / count;
    }
}
