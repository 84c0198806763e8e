//! A cubic in place of lines: the one that leaves and arrives as they do and has their area and its first moment (Levien 2021, "Fitting cubic
//! Bézier curves").

use glam::{DMat2, DVec2};
use libm::{cos, sin};

use crate::outline::turn;
use crate::path::{Part, Segment};

/// Handles are neither shorter nor longer than these, over the chord: such curves have a cusp or a loop.
const SHORTEST: f64 = 0.02;
const LONGEST: f64 = 2.0;

/// Steps that are taken to find the handles: each has about half more digits than the one before.
const STEPS: usize = 12;

/// How near the moment is to come, over the chord: far below what curves are fitted to.
const NEAR: f64 = 1e-13;

/// The longest line, over the chord: its ends and its middle tell how far it is from a curve.
const LINE: f64 = 0.25;

/// Points and weights of Gauss-Legendre quadrature from 0 to 1, exact for the area and the moment under a cubic.
const GAUSS: [[f64; 2]; 5] = [
    [0.046_910_077_030_668, 0.118_463_442_528_094_54],
    [0.230_765_344_947_158_46, 0.239_314_335_249_683_24],
    [0.5, 0.284_444_444_444_444_44],
    [0.769_234_655_052_841_6, 0.239_314_335_249_683_24],
    [0.953_089_922_969_332, 0.118_463_442_528_094_54],
];

/// A cubic that lines, four points at least, are nowhere farther from than `within`, or none.
pub(super) fn fit(points: &[DVec2], within: f64) -> Option<Segment> {
    let (&[from, second, third, ..], &[.., a, b, to]) = (points, points) else {
        return None;
    };
    let chord = to - from;
    let longest = points.windows(2).map(|line| line[0].distance(line[1]));
    if points.len() < 4 || longest.fold(0.0, f64::max) > LINE * chord.length() {
        return None;
    }
    // Chords from 0 to 1.
    let frame = DMat2::from_cols(chord, chord.perp());
    let local = frame.inverse();
    let mut under = Integrals::default();
    for line in points.windows(2) {
        under.add_line(local * (line[0] - from), local * (line[1] - from));
    }
    let leaving = (local * heading([from, second, third])?).normalize();
    let arriving = (local * -heading([to, b, a])?).normalize();
    let [first, last] = handles(leaving, arriving, under)?;
    let cubic = Part {
        from,
        to,
        leaving: frame * (leaving * first) * 3.0,
        arriving: frame * (arriving * last) * 3.0,
    };
    let [leaving, _, arriving] = cubic.legs();
    is_near(&cubic, points, within).then_some(Segment::Cubic(from + leaving, to - arriving, to))
}

/// Where the circle through three points heads at the first of them.
fn heading([at, next, last]: [DVec2; 3]) -> Option<DVec2> {
    let (first, second) = (next - at, last - next);
    let turn = turn(first, second);
    let before = turn * first.length() / (first.length() + second.length());
    first
        .try_normalize()
        .map(|along| DVec2::new(cos(before), -sin(before)).rotate(along))
}

/// The area between a curve and the x axis and its first moment in x.
#[derive(Debug, Default, Clone, Copy)]
struct Integrals {
    area: f64,
    moment: f64,
}

impl Integrals {
    fn add_line(&mut self, from: DVec2, to: DVec2) {
        let way = to - from;
        self.area += way.x * (from.y + way.y / 2.0);
        self.moment += way.x
            * (from.x * from.y + (from.x * way.y + from.y * way.x) / 2.0 + way.x * way.y / 3.0);
    }

    /// Of a cubic from 0 to 1 with handles of these lengths.
    fn of(leaving: DVec2, arriving: DVec2, [first, last]: [f64; 2]) -> Self {
        let cubic = Part {
            from: DVec2::ZERO,
            to: DVec2::X,
            leaving: leaving * first * 3.0,
            arriving: arriving * last * 3.0,
        };
        let mut under = Self::default();
        for [t, weight] in GAUSS {
            let (at, derivative) = (cubic.at(t), cubic.derivative(t));
            under.area += weight * at.y * derivative.x;
            under.moment += weight * at.x * at.y * derivative.x;
        }
        under
    }
}

/// The lengths of handles that leave a cubic from 0 to 1 an area and its moment.
fn handles(leaving: DVec2, arriving: DVec2, under: Integrals) -> Option<[f64; 2]> {
    // The area is linear in either of them.
    let area = |handles| Integrals::of(leaving, arriving, handles).area;
    let (of_first, of_last) = (area([1.0, 0.0]), area([0.0, 1.0]));
    let of_both = area([1.0, 1.0]) - of_first - of_last;
    let with = |first: f64| {
        let last = (under.area - of_first * first) / (of_last + of_both * first);
        [first, last]
    };
    let miss = |first: f64| Integrals::of(leaving, arriving, with(first)).moment - under.moment;
    // By secants, from about where those of an arc are.
    let (mut before, mut first) = (0.34, 0.38);
    let (mut miss_before, mut missed) = (miss(before), miss(first));
    for _ in 0..STEPS {
        if missed.abs() <= NEAR {
            break;
        }
        let next = first - missed * (first - before) / (missed - miss_before);
        (before, miss_before) = (first, missed);
        (first, missed) = (next, miss(next));
    }
    let handles = with(first);
    let is_fit = |handle: &f64| (SHORTEST..=LONGEST).contains(handle);
    handles.iter().all(is_fit).then_some(handles)
}

/// Whether lines, whose ends are a cubic's own, go its way and are nowhere farther from it.
fn is_near(cubic: &Part, points: &[DVec2], within: f64) -> bool {
    let mut before = 0.0;
    let mut is_next = |point: DVec2| {
        // Two steps along tangents come so near to where it is nearest that the distance is the same.
        let mut t = before;
        for _ in 0..2 {
            let derivative = cubic.derivative(t);
            t += (point - cubic.at(t)).dot(derivative) / derivative.length_squared();
        }
        let is_behind = t > before && t <= 1.0 + SLACK;
        before = t;
        is_behind && cubic.at(t).distance_squared(point) <= within * within
    };
    let mut lines = points.windows(2);
    lines.all(|line| is_next(line[0].midpoint(line[1])) && is_next(line[1]))
}

/// How far behind its end, over its length, the last point may be found.
const SLACK: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines along a cubic.
    fn lines(cubic: &Part, count: u32) -> Vec<DVec2> {
        let at = |index: u32| cubic.at(f64::from(index) / f64::from(count));
        (0..=count).map(at).collect()
    }

    #[test]
    fn cubics_are_found_from_their_lines() {
        let cubic = |points: [[f64; 2]; 4]| {
            let [from, a, b, to] = points.map(DVec2::from_array);
            let (leaving, arriving) = (3.0 * (a - from), 3.0 * (to - b));
            let part = Part {
                from,
                to,
                leaving,
                arriving,
            };
            (part, [a, b])
        };
        for points in [
            [[3.0, 4.0], [5.0, 9.0], [11.0, 10.0], [14.0, 6.0]],
            [[0.0, 0.0], [-7.0, 2.0], [-9.0, 6.0], [-8.0, 12.0]],
            [[100.0, 0.0], [103.0, 0.0], [109.0, -3.0], [110.0, -9.0]],
        ] {
            let (given, handles) = cubic(points);
            let lines = lines(&given, 400);
            let Some(Segment::Cubic(a, b, to)) = fit(&lines, 1e-4) else {
                panic!("{points:?}")
            };
            assert!(to == given.to && a.distance(handles[0]) < 1e-2, "{a}");
            assert!(b.distance(handles[1]) < 1e-2, "{b}");
        }
    }

    #[test]
    fn what_no_cubic_goes_along_is_refused() {
        let zigzag: Vec<DVec2> = (0_u8..20)
            .map(|i| DVec2::new(f64::from(i), f64::from(i % 2)))
            .collect();
        assert!(fit(&zigzag, 0.1).is_none());
        // There and back.
        let there: Vec<DVec2> = (0_u8..20)
            .map(|i| DVec2::new(10.0 - (f64::from(i) - 10.0).abs(), 0.0))
            .collect();
        assert!(fit(&there, 0.1).is_none());
        assert!(fit(&zigzag[..3], 10.0).is_none());
    }
}
