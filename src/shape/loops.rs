//! Shapes of loops of lines, where lines that follow a curve are arcs and cubics again.
//!
//! What unites and cuts shapes knows nothing but lines, and where there are curves thousands of them. From one vertex to another as many
//! as can be become a single arc that encloses as much with their chord, or a line, or a cubic where that takes many more.

mod cubic;

use glam::DVec2;

use super::{Cover, Shape};
use crate::error::{MAX_COORDINATE, Result};
use crate::outline::{Arc, sides, turn};
use crate::path::{EllipseArc, FillRule, Path, Segment};

/// How many times as many lines as an arc a cubic is to be in place of.
const CUBIC: usize = 3;

impl Shape {
    /// The shape of loops that do not cross, or none without any. If `within` is told, lines are curves and longer lines that all of them are
    /// no farther from.
    pub(super) fn of_loops(loops: &[Vec<DVec2>], within: Option<f64>) -> Result<Option<Self>> {
        if loops.is_empty() {
            return Ok(None);
        }
        let of = |push: &dyn Fn(&mut Path, &[DVec2])| {
            let mut path = Path::new();
            for points in loops {
                push(&mut path, points);
                path.close();
            }
            Self::path(&path, FillRule::NonZero)
        };
        // Loops that touch are drawn as they are faster than by a rule for curves; those thinner than that may be nothing.
        if let Some(within) = within
            && let Ok(fitted) = of(&|path, points| push_fitted(path, points, within))
            && fitted.cover == Cover::Simple
        {
            return Ok(Some(fitted));
        }
        of(&push_lines).map(Some)
    }
}

fn push_lines(path: &mut Path, points: &[DVec2]) {
    if let Some((first, rest)) = points.split_first() {
        path.begin(*first);
        for &to in rest {
            path.push(Segment::Line(to));
        }
    }
}

/// The same from the sharpest corner on, with as few arcs and lines as are found.
fn push_fitted(path: &mut Path, points: &[DVec2], within: f64) {
    let mut points = points.to_vec();
    let first = sharpest(&points);
    points.rotate_left(first);
    points.extend(points.first().copied());
    let mut rest = &points[..];
    if let Some(first) = rest.first() {
        path.begin(*first);
    }
    while rest.len() > 1 {
        let line = (1, Segment::Line(rest[1]));
        let mut found = longest(rest, line, |points| fit(points, within));
        // A cubic costs as much as some arcs.
        let more = CUBIC * found.0;
        let cubic = |points: &[DVec2]| cubic::fit(points, within);
        if let Some(segment) = rest.get(..=more).and_then(cubic) {
            found = longest(rest, (more, segment), cubic);
        }
        path.push(found.1);
        rest = &rest[found.0..];
    }
}

/// The vertex where a polygon turns most.
fn sharpest(points: &[DVec2]) -> usize {
    let lines = sides(points).map(|(from, to)| to - from);
    let lines: Vec<DVec2> = lines.collect();
    let turns = sides(&lines).map(|(a, b)| turn(a, b).abs());
    let sharpest = turns.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    sharpest.map_or(0, |(line, _)| (line + 1) % points.len())
}

/// As many lines as can be from the first of some points on in place of which there is one segment, and that; from some of them on.
fn longest(
    points: &[DVec2],
    (mut count, mut found): (usize, Segment),
    fit: impl Fn(&[DVec2]) -> Option<Segment>,
) -> (usize, Segment) {
    let mut reaches = |more: usize| {
        let fitted = points.get(..=count + more).and_then(&fit);
        if let Some(segment) = fitted {
            (count, found) = (count + more, segment);
        }
        fitted.is_some()
    };
    let mut step = 1;
    while reaches(step) {
        step *= 2;
    }
    while step > 1 {
        step /= 2;
        reaches(step);
    }
    (count, found)
}

/// A line or an arc in place of lines that are nowhere farther from it, or none.
fn fit(points: &[DVec2], within: f64) -> Option<Segment> {
    let (&[from, ..], &[.., to]) = (points, points) else {
        return None;
    };
    let lines = || points.windows(2).map(|line| (line[0], line[1]));
    if let Some(along) = (to - from).try_normalize() {
        let is_near = |(start, end): (DVec2, DVec2)| {
            along.perp_dot(end - from).abs() <= within && along.dot(end - start) > 0.0
        };
        if lines().all(is_near) {
            return Some(Segment::Line(to));
        }
    }
    let double_area = lines()
        .map(|(start, end)| (start - from).perp_dot(end - from))
        .sum();
    let arc = Arc::enclosing(from, to, double_area)
        .filter(|arc| arc.radius + arc.center.abs().max_element() < MAX_COORDINATE)?;
    let is_near = |(start, end): (DVec2, DVec2)| {
        let off = |at: DVec2| (at.distance(arc.center) - arc.radius).abs();
        let turn = (start - arc.center).perp_dot(end - arc.center);
        off(end) <= within && off(start.midpoint(end)) <= within && turn * arc.sweep > 0.0
    };
    lines().all(is_near).then_some(Segment::Arc(EllipseArc {
        center: arc.center,
        u: DVec2::new(arc.radius, 0.0),
        v: DVec2::new(0.0, arc.radius),
        start: arc.start,
        sweep: arc.sweep,
        to,
    }))
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use libm::{cos, sin};

    use super::*;
    use crate::outline::nearest_share;

    fn round(center: DVec2, radius: f64, from: f64, turn: f64, count: u32) -> Vec<DVec2> {
        let angle = |index: u32| from + turn * f64::from(index) / f64::from(count);
        let at = |angle: f64| center + radius * DVec2::new(cos(angle), sin(angle));
        (0..count).map(|index| at(angle(index))).collect()
    }

    fn fitted(points: &[DVec2], within: f64) -> Vec<Segment> {
        let mut path = Path::new();
        push_fitted(&mut path, points, within);
        path.contours[0].segments.clone()
    }

    /// How far lines are from others.
    fn off(points: &[DVec2], from: &[DVec2]) -> f64 {
        let distance = |at: DVec2| {
            let to_line = |(a, b): (DVec2, DVec2)| at.distance(a.lerp(b, nearest_share(a, b, at)));
            sides(from).map(to_line).fold(f64::INFINITY, f64::min)
        };
        let places = sides(points).flat_map(|(a, b)| [a, a.lerp(b, 0.3), a.lerp(b, 0.5)]);
        places.map(distance).fold(0.0, f64::max)
    }

    #[test]
    fn lines_round_a_circle_are_a_few_arcs() {
        let center = DVec2::new(30.0, -20.0);
        let circle = round(center, 8.0, 0.3, TAU, 600);
        let segments = fitted(&circle, 2e-4);
        assert!(segments.len() <= 8, "{}", segments.len());
        for segment in segments {
            let Segment::Arc(arc) = segment else {
                panic!("{segment:?}")
            };
            let middle = arc.center
                + arc.u.length() * {
                    let angle = arc.start + arc.sweep / 2.0;
                    DVec2::new(cos(angle), sin(angle))
                };
            assert!((middle.distance(center) - 8.0).abs() < 2e-4);
        }
    }

    #[test]
    fn corners_and_straight_sides_stay() {
        // A square with two corners cut round.
        let mut points = vec![DVec2::ZERO, DVec2::new(20.0, 0.0)];
        points.extend(round(DVec2::new(15.0, 15.0), 5.0, 0.0, TAU / 4.0, 60));
        points.extend([DVec2::new(15.0, 20.0), DVec2::new(0.0, 20.0)]);
        let segments = fitted(&points, 1e-3);
        let ends: Vec<DVec2> = segments.iter().map(Segment::end).collect();
        for corner in [DVec2::ZERO, DVec2::new(20.0, 0.0), DVec2::new(0.0, 20.0)] {
            assert!(ends.contains(&corner), "{corner} of {ends:?}");
        }
        assert!(segments.len() <= 8, "{}", segments.len());
    }

    #[test]
    fn no_line_is_farther_than_told() {
        for case in 0..12_u32 {
            let (a, b, c) = (f64::from(case % 5), f64::from(case % 7), f64::from(case));
            let at = |index: u32| {
                let t = TAU * f64::from(index) / 1000.0;
                let radius = 10.0 + a * sin(2.0 * t + c) + 0.5 * b * cos(3.0 * t);
                radius * DVec2::new(cos(t), sin(t))
            };
            let points: Vec<DVec2> = (0..1000).map(at).collect();
            for within in [3e-4, 1e-3, 1e-2] {
                let mut path = Path::new();
                push_fitted(&mut path, &points, within);
                path.close();
                let contour = &path.contours[0];
                let flat = contour.flatten(within / 100.0);
                let far = off(&flat, &points).max(off(&points, &flat));
                let count = contour.segments.len();
                assert!(far <= 1.02 * within, "{case}, {within}: {far}");
                assert!(count < 150, "{case}, {within}: {count}");
            }
        }
    }
}
