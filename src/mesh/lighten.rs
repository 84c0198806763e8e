//! Fewer lines for the same densities.
//!
//! What a disc sees of a curve is an area. So a run of chords that bends gently one way is replaced by two lines that cover
//! as much: what moves a density is no more than where the disc's edge cuts through such a run.

use core::f64::consts::PI;

use glam::DVec2;

use crate::outline;

/// The least chords in a run: two would be two lines again.
const FEWEST: usize = 3;

/// The most that a run turns, in radians.
const MOST_TURN: f64 = 0.7;

/// The part of a run's area that the disc's edge may leave over where it goes in and where it comes out, at two borders at
/// once: lines and a circular arc lie 0.074 of the area apart to either side, other curves up to twice as far.
const LEFT_OVER: f64 = 0.3;

/// From which of its own radii on the disc's edge runs along a curve, and which part of the area runs have there: it cuts
/// through up to twenty at once.
const ALONG: [f64; 2] = [0.7, 1.4];
const ALONG_SHARE: f64 = 1.0 / 40.0;

/// The closed loop with fewer vertices: no density seen through `radius` moves by more than `change`, its chords' own
/// error apart.
pub(super) fn lighten(points: &[DVec2], radius: f64, change: f64) -> Vec<DVec2> {
    let count = points.len();
    let at = |i: usize| points[i % count];
    let turn = |i: usize| {
        let (before, after) = (at(i) - at(i + count - 1), at(i + 1) - at(i));
        outline::turn(before, after)
    };
    let limit = change * PI * radius * radius / LEFT_OVER;
    // Runs begin at corners.
    let first = (0..count).find(|&i| turn(i).abs() > MOST_TURN).unwrap_or(0);
    let mut kept = Vec::new();
    let mut i = first;
    while i < first + count {
        let start = at(i);
        kept.push(start);
        let (mut end, mut turned, mut double_area) = (i + 1, 0.0, 0.0);
        let mut apex = None;
        while end < first + count {
            let bend = turn(end);
            let chord = at(end + 1) - start;
            let next = double_area + (at(end) - start).perp_dot(chord);
            let total: f64 = turned + bend;
            let bent = chord.length() / (radius * total.abs());
            let along = (ALONG[0]..ALONG[1]).contains(&bent);
            let share = if along { ALONG_SHARE } else { 1.0 };
            let one_way = turned * bend >= 0.0 && total.abs() <= MOST_TURN;
            if !one_way || next.abs() / 2.0 > limit * share {
                break;
            }
            (end, turned, double_area) = (end + 1, total, next);
            // The triangle on the chord that has the run's area.
            apex = Some(start.midpoint(at(end)) - chord.perp() * (next / chord.length_squared()));
        }
        if end - i >= FEWEST {
            kept.extend(apex.filter(|apex| apex.is_finite()));
            i = end;
        } else {
            i += 1;
        }
    }
    kept
}
