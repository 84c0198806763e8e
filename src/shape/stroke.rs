//! Strokes: a pen's way along a path as a shape.

mod pen;
mod way;

use self::pen::Pen;
use super::Shape;
use crate::error::{self, Error, Result};
use crate::limits::at_most;
use crate::outline::{Winding, resolve_loops};
use crate::path::{FillRule, Path, Segment, lines};

/// How far from a curve of a stroke its lines may be, in scene units.
const FLATNESS: f64 = 5e-4;

/// The most that is over the stroke's extent: a scene unit may be anything.
const RELATIVE_FLATNESS: f64 = 4e-6;

/// A stroke may not have more lines than this before it is united: where a wide one overlaps itself they cross in as many places as the
/// square of their number.
const MAX_LINES: usize = 1 << 18;

/// How a stroke ends where its path is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LineCap {
    /// At the path's own end.
    #[default]
    Butt,
    /// Half a width on.
    Square,
    /// With a half circle.
    Round,
}

/// How a stroke turns where its path has a corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LineJoin {
    /// With a point, or as `Bevel` where that would be longer than the limit allows.
    #[default]
    Miter,
    /// With an arc.
    Round,
    /// Cut off.
    Bevel,
}

/// A pen: its width in scene units, and what it does at ends and corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    width: f32,
    cap: LineCap,
    join: LineJoin,
    miter_limit: f32,
}

impl Stroke {
    /// A pen of a width (scene units) with butt ends and mitred corners up to four times the width, as in SVG.
    ///
    /// # Errors
    /// A width that is not finite, not above 0 or passes [`MAX_COORDINATE`](crate::MAX_COORDINATE).
    pub fn new(width: f32) -> Result<Self> {
        error::positive("stroke width", f64::from(width))?;
        Ok(Self {
            width,
            cap: LineCap::default(),
            join: LineJoin::default(),
            miter_limit: 4.0,
        })
    }

    /// The same with other ends.
    #[must_use]
    pub fn with_cap(mut self, cap: LineCap) -> Self {
        self.cap = cap;
        self
    }

    /// The same with other corners.
    #[must_use]
    pub fn with_join(mut self, join: LineJoin) -> Self {
        self.join = join;
        self
    }

    /// The same with corners as long as `limit` times the width.
    ///
    /// # Errors
    /// A limit not from 1 to 1000.
    pub fn with_miter_limit(mut self, limit: f32) -> Result<Self> {
        error::within("miter limit", f64::from(limit), 1.0, 1000.0)?;
        self.miter_limit = limit;
        Ok(self)
    }
}

impl Shape {
    /// What a pen draws along a path, open contours as well as closed ones, as SVG has it. Curves are right within 0.0005 scene units, and
    /// no coarser than four millionths of the larger side of the box of all points, control points among them, and the width together;
    /// but next to a bend tighter than the pen, where an end that is not round cuts across it, by up to some hundred times that.
    ///
    /// # Errors
    /// A path without segments or that draws nothing, a number that is not finite or passes
    /// [`MAX_COORDINATE`](crate::MAX_COORDINATE), more than [`MAX_SEGMENTS`](crate::MAX_SEGMENTS) segments, or more than 2^18
    /// lines along the path and round its ends and corners.
    ///
    /// ```
    /// use penumbral::{LineCap, Path, Shape, Stroke};
    ///
    /// let mut tick = Path::new();
    /// tick.move_to([4.0, 12.0]).line_to([10.0, 18.0]).line_to([20.0, 6.0]);
    /// let shape = Shape::stroke(&tick, &Stroke::new(2.0)?.with_cap(LineCap::Round))?;
    /// # Ok::<(), penumbral::Error>(())
    /// ```
    pub fn stroke(path: &Path, stroke: &Stroke) -> Result<Self> {
        let mut path = path.clone();
        for contour in &mut path.contours {
            // As in SVG, a contour that is closed at once is a dot.
            if contour.closed && contour.segments.is_empty() {
                contour.segments.push(Segment::Line(contour.start));
            }
        }
        path.validate()?;
        let filled = Self {
            contours: path.contours,
            cover: super::Cover::Rule(FillRule::NonZero),
        };
        let extent = filled.extent() + f64::from(stroke.width);
        // Lines are a third of it inside of the curve and their ends as much outside, which are the ends of arcs in place of them.
        let flatness = FLATNESS.min(RELATIVE_FLATNESS * extent) / 3.0;
        let within = 2.0 * flatness;
        let mut count = lines(&filled.contours, flatness);
        at_most("lines of a stroke", count, MAX_LINES)?;
        let pen = Pen::new(stroke, flatness);
        let mut sides = Vec::new();
        for contour in &filled.contours {
            if contour.segments.is_empty() {
                continue;
            }
            let (way, closed) = way::way(contour, &pen);
            sides.append(&mut pen.cover(&way, closed, &mut count)?);
        }
        let loops = resolve_loops(&sides, Winding::Positive, false);
        let is_round = stroke.cap == LineCap::Round || stroke.join == LineJoin::Round;
        let is_straight = filled.is_straight() && !is_round;
        Self::of_loops(&loops, (!is_straight).then_some(within))?
            .ok_or(Error::EmptyPath { field: "stroke" })
    }
}

#[cfg(test)]
#[cfg(feature = "svg-path")]
mod tests {
    use core::f64::consts::PI;

    use glam::DVec2;

    use super::*;
    use crate::outline::{Outline, nearest_share, sides, winding};
    use crate::path::Contour;

    const JOINS: [LineJoin; 3] = [LineJoin::Miter, LineJoin::Round, LineJoin::Bevel];
    const CAPS: [LineCap; 3] = [LineCap::Butt, LineCap::Square, LineCap::Round];

    fn drawn(data: &str, stroke: &Stroke) -> Shape {
        Shape::stroke(&Path::from_svg(data).unwrap(), stroke).unwrap()
    }

    fn area(shape: &Shape) -> f64 {
        Outline::of_flattened(shape, 1e-6).area()
    }

    #[test]
    fn areas_of_strokes_are_those_of_pens() {
        let pen = Stroke::new(4.0).unwrap();
        let of = |data, pen: &Stroke| area(&drawn(data, pen));
        let line = "M1000 20L1030 60";
        assert!((of(line, &pen) - 200.0).abs() < 1e-9);
        assert!((of(line, &pen.with_cap(LineCap::Square)) - 216.0).abs() < 1e-9);
        let round = of(line, &pen.with_cap(LineCap::Round)) - (200.0 + 4.0 * PI);
        assert!(round.abs() < 1e-3, "{round}");

        // An open corner and a closed one: the second has two corners more and one side.
        assert!((of("M0 0H40V30", &pen) - 4.0 * 70.0).abs() < 1e-9);
        // A mitred ring about the triangle 40, 30, 50 is its length times the width and the corners' points less their dents.
        let (inside, semi) = (600.0, 60.0);
        let inset = |d: f64| inside * (1.0 - d * semi / inside).powi(2);
        let grown = of("M0 0H40V30Z", &pen) - (inset(-2.0) - inset(2.0));
        assert!(grown.abs() < 1e-9, "{grown}");

        // A ring of curves has no corners, whatever the joins.
        for join in JOINS {
            let ring = "M0 50A50 50 0 0 1 50 0A50 50 0 1 1 0 50Z";
            let off = of(ring, &pen.with_join(join)) - 4.0 * 100.0 * PI;
            assert!(off.abs() < 0.1, "{join:?}: {off}");
        }
    }

    #[test]
    fn strokes_are_as_round_in_any_unit() {
        let pen = |unit: f32| Stroke::new(4.0 * unit).unwrap().with_cap(LineCap::Round);
        for unit in [1e-3, 1.0, 1e4] {
            let mut line = Path::new();
            line.move_to([0.0, 0.0]).line_to([3.0 * unit, 4.0 * unit]);
            let flatness = 1e-6 * f64::from(unit);
            let shape = Shape::stroke(&line, &pen(unit)).unwrap();
            let area = Outline::of_flattened(&shape, flatness).area() / f64::from(unit).powi(2);
            let error = area - (20.0 + 4.0 * PI);
            assert!(error.abs() < 1e-3, "a unit of {unit}: {error}");
        }
    }

    #[test]
    fn mitres_are_as_long_as_svg_says() {
        // 1 / sin(angle / 2) is 4 at 28.96 degrees.
        for (angle, is_bevel) in [(28.0_f64, true), (29.0, false)] {
            let (sine, cosine) = (angle.to_radians() / 2.0).sin_cos();
            let (x, y) = (100.0 * cosine, 100.0 * sine);
            let corner = drawn(
                &format!("M{x} {y}L0 0L{x} -{y}"),
                &Stroke::new(4.0).unwrap(),
            );
            let (min, _) = corner.hull().unwrap();
            let tip = if is_bevel { 2.0 * sine } else { 2.0 / sine };
            assert!((min.x + tip).abs() < 1e-6, "{angle}: {}", min.x);
        }
    }

    #[test]
    fn curves_end_across_where_they_head() {
        let pen = Stroke::new(4.0).unwrap();
        let drawn = |data| drawn(data, &pen.with_miter_limit(2.0).unwrap());
        let has = |shape: &Shape, corners: &[[f64; 2]]| {
            let ends = shape.contours.iter().flat_map(Contour::walk);
            let ends: Vec<DVec2> = ends.map(|(_, segment)| segment.end()).collect();
            for &corner in corners {
                let is_there = |end: &DVec2| end.distance(DVec2::from_array(corner)) < 1e-9;
                assert!(ends.iter().any(is_there), "{corner:?} of {ends:?}");
            }
        };
        let bend = drawn("M0 0Q10 0 10 10");
        has(&bend, &[[0.0, -2.0], [0.0, 2.0], [8.0, 10.0], [12.0, 10.0]]);
        let (min, max) = bend.hull().unwrap();
        let off = (min - DVec2::new(0.0, -2.0)).abs() + (max - DVec2::new(12.0, 10.0)).abs();
        assert!(off.max_element() < FLATNESS, "{min} {max}");
        // The same where they meet in a right corner.
        let corner = drawn("M0 0Q10 0 10 10Q10 20 0 20M10 10Q20 10 30 20");
        has(
            &corner,
            &[[0.0, -2.0], [0.0, 2.0], [0.0, 18.0], [0.0, 22.0]],
        );
        let (_, max) = corner.hull().unwrap();
        assert!((max.y - 22.0).abs() < FLATNESS);
        let bends = drawn("M10 0C10 5 5 10 0 10C-5 10-10 15-10 20");
        has(
            &bends,
            &[[-12.0, 20.0], [-8.0, 20.0], [8.0, 0.0], [12.0, 0.0]],
        );
        let (min, _) = bends.hull().unwrap();
        assert!((min.x + 12.0).abs() < FLATNESS);
        let (min, max) = drawn("M20 0Q10 0 0 10Q10 20 20 20").hull().unwrap();
        assert!((min.x + 2.0 * 2.0_f64.sqrt()).abs() < 1e-9, "{min} {max}");
    }

    #[test]
    fn what_has_no_length_is_a_dot() {
        let pen = Stroke::new(4.0).unwrap();
        for dot in [
            "M5 5h0",
            "M5 5Z",
            "M5 5L5 5Z",
            "M5 5C5 5 5 5 5 5",
            "M0 0M5 5Z",
        ] {
            assert_eq!(
                drawn(dot, &pen.with_cap(LineCap::Square)).hull(),
                Some((DVec2::splat(3.0), DVec2::splat(7.0)))
            );
            let round = area(&drawn(dot, &pen.with_cap(LineCap::Round)));
            assert!((round - 4.0 * PI).abs() < 1e-2);
            assert!(Shape::stroke(&Path::from_svg(dot).unwrap(), &pen).is_err());
        }
    }

    #[test]
    fn slight_bows_and_hairlines_are_drawn() {
        // The circles that bows are arcs of pass the largest coordinate.
        for (length, bow) in [(400.0, 0.002), (1000.0, 0.01), (3000.0, 0.001)] {
            let data = format!("M0 0Q{} {bow} {length} 0", length / 2.0);
            let off = area(&drawn(&data, &Stroke::new(4.0).unwrap())) - 4.0 * length;
            assert!(off.abs() < 0.05, "{data}: {off}");
        }
        // No thicker than the tolerance.
        for (data, width) in [("M0 0H1000", 1e-4), ("M0 0Q12 0.000012 24 0", 2.4e-6)] {
            let pen = Stroke::new(width).unwrap().with_cap(LineCap::Round);
            let (min, max) = drawn(data, &pen).hull().unwrap();
            assert!((max - min).min_element() > 0.0, "{data}");
        }
    }

    #[test]
    fn strokes_of_too_many_lines_are_refused() {
        let mut zigzag = Path::new();
        zigzag.move_to([0.0, 0.0]);
        for i in 1..1000_u16 {
            zigzag.line_to([10.0 * f32::from(i), f32::from(i % 2 * 17)]);
        }
        let pen = Stroke::new(2e4).unwrap();
        assert!(Shape::stroke(&zigzag, &pen.with_join(LineJoin::Bevel)).is_ok());
        assert!(matches!(
            Shape::stroke(&zigzag, &pen.with_join(LineJoin::Round)),
            Err(Error::TooMany { .. })
        ));
    }

    #[test]
    fn what_draws_nothing_is_refused() {
        let mut dot = Path::new();
        dot.move_to([5.0, 5.0]).line_to([5.0, 5.0]);
        assert!(Shape::stroke(&dot, &Stroke::new(1.0).unwrap()).is_err());
        assert!(Stroke::new(0.0).is_err());
        assert!(Stroke::new(1.0).unwrap().with_miter_limit(0.5).is_err());
    }

    /// Numbers from 0 to 1.
    fn random(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    /// The loops round a shape, as lines far nearer to it than the flatness.
    fn loops(shape: &Shape) -> Vec<Vec<DVec2>> {
        let loops = shape.contours.iter();
        loops.map(|contour| contour.flatten(1e-6)).collect()
    }

    fn covers(loops: &[Vec<DVec2>], at: DVec2) -> bool {
        winding(loops.iter().flat_map(|points| sides(points)), at) != 0
    }

    /// How far inside of a convex polygon a point is.
    fn inside(polygon: &[DVec2], at: DVec2) -> f64 {
        let next = polygon.iter().cycle().skip(1);
        let sides: Vec<_> = polygon.iter().zip(next).map(|(&a, &b)| (a, b)).collect();
        let area: f64 = sides.iter().map(|(a, b)| a.perp_dot(*b)).sum();
        if area.abs() < 1e-9 {
            return f64::NEG_INFINITY;
        }
        let of_side =
            |(a, b): &(DVec2, DVec2)| area.signum() * (b - a).normalize().perp_dot(at - a);
        sides.iter().map(of_side).fold(f64::INFINITY, f64::min)
    }

    /// How far inside of what the pen covers along lines a point is, by what SVG says of each line, corner and end.
    fn pen(points: &[DVec2], closed: bool, stroke: &Stroke, at: DVec2) -> f64 {
        let half = f64::from(stroke.width) / 2.0;
        let count = points.len();
        let mut most = f64::NEG_INFINITY;
        let lines = if closed { count } else { count - 1 };
        let along = |line: usize| (points[(line + 1) % count] - points[line]).normalize();
        for line in 0..lines {
            let along = half * along(line);
            let side = along.perp();
            let more = |is_end: bool| {
                let is_square = is_end && !closed && stroke.cap == LineCap::Square;
                f64::from(u8::from(is_square)) * along
            };
            let from = points[line] - more(line == 0);
            let to = points[(line + 1) % count] + more(line + 1 == lines);
            most = most.max(inside(
                &[from + side, to + side, to - side, from - side],
                at,
            ));
        }
        let circle = |index: usize| half - points[index].distance(at);
        if !closed && stroke.cap == LineCap::Round {
            // Half a circle each.
            let ends = [(0, -along(0)), (count - 1, along(lines - 1))];
            for (end, out) in ends {
                most = most.max(circle(end).min(out.dot(at - points[end])));
            }
        }
        let corners = points[..lines]
            .iter()
            .enumerate()
            .skip(usize::from(!closed));
        for (line, &center) in corners {
            let [before, after] = [along((line + count - 1) % count), along(line)];
            let side = -half * before.perp_dot(after).signum();
            let [a, b] = [before, after].map(|along| center + side * along.perp());
            let from = at - center;
            most = most.max(match stroke.join {
                LineJoin::Round => circle(line).min(before.dot(from)).min(-after.dot(from)),
                _ => inside(&[center, a, b], at),
            });
            let sine = ((1.0 + before.dot(after)) / 2.0).sqrt();
            if stroke.join == LineJoin::Miter && 1.0 <= f64::from(stroke.miter_limit) * sine {
                let tip = center + (a.midpoint(b) - center) / (sine * sine);
                most = most.max(inside(&[center, a, tip, b], at));
            }
        }
        most
    }

    #[test]
    fn strokes_cover_what_pens_do() {
        for case in 0..1000_u32 {
            let mut random = random(u64::from(case));
            let mut pick = |count: usize| (random() * count as f64) as usize;
            let count = 2 + pick(5);
            let closed = count > 2 && pick(2) == 0;
            let (is_short, is_whole) = (pick(3) == 0, pick(2) == 0);
            let width = [1.0, 2.0, 4.0, 7.0, 12.0][pick(5)];
            let stroke = Stroke::new(width).unwrap();
            let stroke = stroke.with_cap(CAPS[pick(3)]).with_join(JOINS[pick(3)]);
            let limit = [1.0, 1.5, 4.0, 10.0][pick(4)];
            let stroke = stroke.with_miter_limit(limit).unwrap();
            let mut points: Vec<DVec2> = Vec::new();
            while points.len() < count {
                let free = DVec2::new(random(), random());
                let next = match points.last() {
                    Some(last) if is_short => last + 8.0 * free - 4.0,
                    _ => 40.0 * free,
                };
                let next = if is_whole { next.round() } else { next };
                if points.last().is_none_or(|last| last.distance(next) > 0.01)
                    && points
                        .first()
                        .is_none_or(|first| first.distance(next) > 0.01)
                {
                    points.push(next);
                }
            }
            let mut path = Path::new();
            path.begin(points[0]);
            for &to in &points[1..] {
                path.push(Segment::Line(to));
            }
            if closed {
                path.close();
            }
            let loops = loops(&Shape::stroke(&path, &stroke).unwrap());
            let flatness = if stroke.join == LineJoin::Round || stroke.cap == LineCap::Round {
                FLATNESS
            } else {
                1e-6
            };
            for sample in 0..100 {
                let near = points[sample % count]
                    + 2.0 * f64::from(width) * (DVec2::new(random(), random()) - 0.5);
                let far = 70.0 * DVec2::new(random(), random()) - 15.0;
                for at in [near, far] {
                    let depth = pen(&points, closed, &stroke, at);
                    assert!(
                        depth.abs() < flatness || covers(&loops, at) == (depth > 0.0),
                        "case {case}: {points:?}, {closed}, {stroke:?}: {depth} at {at}"
                    );
                }
            }
        }
    }

    /// As dots of icons are drawn: all is covered, in pieces.
    #[test]
    fn rings_tighter_than_their_pen_are_discs() {
        for (radius, width) in [(0.5, 2.0), (1.0, 4.0), (5.0, 30.0)] {
            for ring in [
                "A R R 0 1 1 0 -RA R R 0 1 1 0 RZ",
                "A R R 0 1 1 0 -RA R R 0 1 1 0 R",
            ] {
                let data = format!("M0 R{ring}").replace('R', &radius.to_string());
                let pen = Stroke::new(width).unwrap().with_cap(LineCap::Round);
                let shape = drawn(&data, &pen.with_join(LineJoin::Round));
                let outer = radius + f64::from(width) / 2.0;
                let off = area(&shape) / (PI * outer * outer) - 1.0;
                assert!(off.abs() < 1e-4, "{radius}, {width}: {off}");
            }
        }
    }

    #[test]
    fn curves_are_covered_as_far_as_the_pen_reaches() {
        for case in 0..24_u32 {
            let mut random = random(u64::from(case));
            let mut point = || 40.0 * DVec2::new(random(), random());
            let mut path = Path::new();
            path.begin(point());
            path.push(Segment::Cubic(point(), point(), point()));
            path.push(Segment::Quad(point(), point()));
            path.arc(
                DVec2::splat(9.0),
                0.0,
                case % 2 == 0,
                case % 3 == 0,
                point(),
            );
            if case % 5 == 0 {
                path.close();
            }
            let mut points = path.contours[0].flatten(1e-4);
            points.extend(path.contours[0].closed.then(|| points[0]));
            let width = [1.0, 2.0, 8.0, 30.0][case as usize % 4];
            let (half, close) = (f64::from(width) / 2.0, FLATNESS + 1e-4);
            let stroke = Stroke::new(width).unwrap().with_join(LineJoin::Round);
            let stroke = stroke.with_cap(LineCap::Round);
            let loops = loops(&Shape::stroke(&path, &stroke).unwrap());
            let lengths = points.windows(2).map(|line| line[0].distance(line[1]));
            let lengths: Vec<f64> = lengths.collect();
            for _ in 0..50 {
                let mut way = random() * lengths.iter().sum::<f64>();
                let is_passed = |length: &f64| {
                    way -= length;
                    way < 0.0
                };
                let index = lengths.iter().position(is_passed).unwrap();
                let [from, to] = [points[index], points[index + 1]];
                // Beside the curve all is covered, and far from it nothing.
                let aside = (2.0 * random() - 1.0) * (half - close);
                let beside = from.lerp(to, random()) + aside * (to - from).normalize().perp();
                assert!(covers(&loops, beside), "case {case}: {beside} of {path:?}");
                let at = from + 4.0 * half * (DVec2::new(random(), random()) - 0.5);
                let distance = points.windows(2).map(|line| {
                    let share = nearest_share(line[0], line[1], at);
                    at.distance(line[0].lerp(line[1], share))
                });
                let nearest = distance.fold(f64::INFINITY, f64::min);
                assert!(
                    nearest < half + close || !covers(&loops, at),
                    "case {case}: {at}, {nearest} from {path:?}"
                );
            }
        }
    }
}
