//! When two shadows have the same mesh.

use core::f64::consts::{PI, SQRT_2, TAU};

use glam::DVec2;

use crate::mesh::rounding::power_of_two_below;
use crate::mesh::{MeshOptions, Profile};
use crate::outline::Edge;
use crate::path::{FillRule, Segment};
use crate::shadow::Shadow;
use crate::shape::Cover;

/// The part of the tolerance by which shadows of one key may differ.
pub(super) const ALIKE_SHARE: f64 = 0.1;

/// The steps that lengths are counted in, a power of two; 0 where they are compared to the last bit.
///
/// An outline whose points move by d changes the area in a disc by d times its length there. A point comes from up to
/// three vectors (an arc's centre and axes), each a step off in x and y.
pub(super) fn step(shadow: &Shadow, options: &MeshOptions) -> f64 {
    let radius = shadow.radius();
    if options.profile != Profile::Disc || radius == 0.0 {
        return 0.0;
    }
    let reached: f64 = lengths(shadow).map(|l| l.min(2.0 * TAU * radius)).sum();
    if reached == 0.0 {
        return 0.0;
    }
    let change = options.tolerance.as_levels() / 255.0 * ALIKE_SHARE;
    let step = change * PI * radius * radius / (reached * 3.0 * SQRT_2);
    power_of_two_below(step)
}

/// No less than the lengths of the outline's edges.
fn lengths(shadow: &Shadow) -> impl Iterator<Item = f64> {
    let fixed = shadow.fixed().edges().map(Edge::length);
    let contours = shadow
        .curved()
        .iter()
        .flatten()
        .flat_map(|shape| &shape.contours);
    let curved = contours.flat_map(|contour| {
        let closing = (contour.end() - contour.start).length();
        let segments = contour.walk().map(|(from, segment)| match *segment {
            Segment::Line(to) => (to - from).length(),
            Segment::Quad(a, to) => (a - from).length() + (to - a).length(),
            Segment::Cubic(a, b, to) => (a - from).length() + (b - a).length() + (to - b).length(),
            Segment::Arc(arc) => arc.sweep.abs() * (arc.u.length() + arc.v.length()),
        });
        segments.chain([closing])
    });
    fixed.chain(curved)
}

/// All that a mesh depends on, each edge and segment after a mark of its kind.
pub(super) fn write_key(
    shadow: &Shadow,
    options: &MeshOptions,
    origin: DVec2,
    step: f64,
    key: &mut Vec<u64>,
) {
    key.extend([
        shadow.radius().to_bits(),
        options.tolerance.as_levels().to_bits(),
        options.profile as u64,
        options.max_vertices as u64,
        options.effort as u64,
        step.to_bits(),
    ]);
    // Whole numbers as `f64`, of which none is too large. Zero has one sign.
    let count = |value: f64| {
        let steps = if step > 0.0 {
            (value / step).round()
        } else {
            value
        };
        (steps + 0.0).to_bits()
    };
    let vector = |v: DVec2| [count(v.x), count(v.y)];
    let point = |p: DVec2| vector(p - origin);
    for edges in &shadow.fixed().loops {
        key.push(Mark::Loop as u64);
        for edge in edges {
            match edge {
                Edge::Line(line) | Edge::Border(line) => {
                    key.push(Mark::Line as u64);
                    key.extend(point(line.from));
                }
                Edge::Arc(arc) => {
                    key.push(Mark::Arc as u64);
                    key.extend(point(arc.from));
                    key.extend(point(arc.center));
                    key.extend([count(arc.radius), arc.start.to_bits(), arc.sweep.to_bits()]);
                }
            }
        }
    }
    for group in shadow.curved() {
        key.push(Mark::Group as u64);
        for shape in group {
            key.push(match shape.cover {
                Cover::Simple => Mark::Simple,
                Cover::Rule(FillRule::NonZero) => Mark::NonZero,
                Cover::Rule(FillRule::EvenOdd) => Mark::EvenOdd,
            } as u64);
            for contour in &shape.contours {
                key.push(Mark::Loop as u64);
                key.extend(point(contour.start));
                for segment in &contour.segments {
                    match *segment {
                        Segment::Line(to) => {
                            key.push(Mark::Line as u64);
                            key.extend(point(to));
                        }
                        Segment::Quad(a, to) => {
                            key.push(Mark::Quad as u64);
                            key.extend([a, to].map(point).as_flattened());
                        }
                        Segment::Cubic(a, b, to) => {
                            key.push(Mark::Cubic as u64);
                            key.extend([a, b, to].map(point).as_flattened());
                        }
                        Segment::Arc(arc) => {
                            key.push(Mark::Arc as u64);
                            key.extend(
                                [point(arc.center), vector(arc.u), vector(arc.v)].as_flattened(),
                            );
                            key.extend([arc.start.to_bits(), arc.sweep.to_bits()]);
                            key.extend(point(arc.to));
                        }
                    }
                }
            }
        }
    }
}

/// What comes next in a key.
#[derive(Clone, Copy)]
enum Mark {
    Loop,
    Line,
    Arc,
    Quad,
    Cubic,
    Group,
    Simple,
    NonZero,
    EvenOdd,
}
