//! How much of curves one disc may see.

use glam::DVec2;

use crate::outline::Edge;
use crate::path::{Segment, arc_steps};
use crate::shape::Shape;
use crate::squares::Squares;

/// A chord that is longer than so many radii is counted as one of that length, about its middle: such curves are nearly straight for what
/// sees them.
const LONGEST: f64 = 4.0;

/// How far the chords that are counted may be from their curves, in the radius of what sees them.
const COARSE: f64 = 1.0 / 8.0;

/// Chords of curves, from point to point.
pub(super) type Chords = Vec<[DVec2; 2]>;

/// Adds chords of the shapes' curves for what is of a radius.
pub(super) fn push_curves<'a>(
    shapes: impl Iterator<Item = &'a Shape>,
    radius: f64,
    chords: &mut Chords,
) {
    let mut ends = Vec::new();
    for contour in shapes.flat_map(|shape| &shape.contours) {
        for (mut from, segment) in contour.walk() {
            if !matches!(segment, Segment::Line(_)) {
                ends.clear();
                segment.flatten(from, COARSE * radius, &mut ends);
                for &end in &ends {
                    chords.push([from, end]);
                    from = end;
                }
            }
        }
    }
}

/// The same of arcs among edges.
pub(super) fn push_arcs<'a>(
    edges: impl Iterator<Item = &'a Edge>,
    radius: f64,
    chords: &mut Chords,
) {
    for edge in edges {
        if let Edge::Arc(arc) = edge {
            let count = arc_steps(arc.radius, arc.sweep, COARSE * radius);
            let at = |i: u32| arc.at(arc.start + arc.sweep * f64::from(i) / f64::from(count));
            chords.extend((0..count).map(|i| [at(i), at(i + 1)]));
        }
    }
}

/// How many times its own circumference a disc of a radius may see of curves, at least 1. Curves are cut into lines as if there were one
/// that long: of more, areas between these and curves add up.
///
/// Lengths are counted by squares of the radius's size, of which a disc meets nine at most. They begin at `corner`, that of what has the
/// curves: where it is changes nothing.
pub(super) fn crowding(chords: &Chords, radius: f64, corner: DVec2) -> f64 {
    let mut lengths = Squares::default();
    let place = |point: DVec2| (point - corner) / radius;
    for chord in chords {
        let [start, end] = chord.map(place);
        add(start, end, &mut lengths);
    }
    (lengths.most() / core::f64::consts::TAU).max(1.0)
}

/// Adds a chord's length, in radii, to the squares that it is in.
fn add(start: DVec2, end: DVec2, lengths: &mut Squares) {
    let (chord, middle) = (end - start, start.midpoint(end));
    let length = chord.length().min(LONGEST);
    let way = chord.normalize_or_zero() * length;
    let count = length.ceil().max(1.0);
    for part in 0..count as u32 {
        let at = middle + way * ((f64::from(part) + 0.5) / count - 0.5);
        lengths.add(at, length / count);
    }
}
