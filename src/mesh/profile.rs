//! Profiles: density across a straight edge, and its best approximation by straight pieces.

use core::f64::consts::{FRAC_PI_2, PI};
use std::sync::OnceLock;

use libm::{asin, cbrt, cos, exp};

/// How density grows across a straight edge, from the outer edge of the penumbra to the umbra.
///
/// `Disc` is the light's own and the only exact one; the others are for those who want the look of other engines. Where
/// an outline is not straight, and where there is no umbra, each shows the value that it has on a straight edge where
/// the exact density is the same, so that no rule of thumb is needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum Profile {
    /// A straight ramp.
    Linear,
    /// Half a period of the cosine.
    Cosine,
    /// A uniform disc's: `1/2 + (t sqrt(1 - t²) + asin t) / π`.
    #[default]
    Disc,
    /// Skia's: `exp(-4 (1 - u)²) - 0.018` with u from 0 at the outer edge to 1 at the umbra; 0.35 at the outline and
    /// 0.982 in the umbra.
    Skia,
}

impl Profile {
    /// The value at the signed distance `t` inside the outline in units of the penumbra radius, clamped to -1 to 1.
    #[must_use]
    pub fn at(self, t: f64) -> f64 {
        let t = t.clamp(-1.0, 1.0);
        let along = f64::midpoint(t, 1.0);
        match self {
            Self::Linear => along,
            Self::Cosine => (1.0 - cos(PI * along)) / 2.0,
            Self::Disc => 0.5 + (t * (1.0 - t * t).sqrt() + asin(t)) / PI,
            Self::Skia => (exp(-4.0 * (1.0 - along) * (1.0 - along)) - 0.018).max(0.0),
        }
    }

    /// The profile's value where the disc's own has the value `density`, 0 to 1.
    #[must_use]
    pub fn in_place_of(self, density: f64) -> f64 {
        match self {
            Self::Disc => density,
            _ => self.at(disc_distance(density)),
        }
    }
}

/// The signed distance inside a straight edge, in units of the penumbra radius, where the disc's profile has the density.
fn disc_distance(density: f64) -> f64 {
    // F is odd about 1/2 and convex below it: Newton's steps from the outer side never pass the solution. Near the end
    // F is 2/3 (2 (1 + t))^1.5 / π.
    let tail = density.min(1.0 - density).max(0.0);
    let root = cbrt(1.5 * PI * tail);
    let mut past = root * root / 2.0;
    for _ in 0..6 {
        let t = past.min(1.0) - 1.0;
        let slope = ((1.0 - t) * (1.0 + t)).sqrt() / FRAC_PI_2;
        if slope == 0.0 {
            break;
        }
        past = (past - (Profile::Disc.at(t) - tail) / slope).clamp(0.0, 1.0);
    }
    if density < 0.5 {
        past - 1.0
    } else {
        1.0 - past
    }
}

/// A point of a profile that is drawn in straight pieces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Knot {
    /// Signed distance inside the outline over the penumbra radius.
    pub(crate) t: f64,
    /// The value that balances the pieces' errors.
    pub(crate) value: f64,
}

/// The disc's profile in straight pieces whose largest error is as small as their number allows.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pieces {
    pub(crate) knots: Vec<Knot>,
    /// The largest error, in density.
    pub(crate) error: f64,
}

impl Pieces {
    /// The fewest pieces within `error` (density), of up to 41.
    pub(crate) fn within(error: f64) -> &'static Self {
        static TABLE: [OnceLock<Pieces>; 21] = [const { OnceLock::new() }; 21];
        // Even numbers are no better than the odd number before: the middle piece goes straight through the point of
        // inflection, which a knot there would waste.
        let pieces = |inner: usize| TABLE[inner].get_or_init(|| Self::balanced(inner as u32));
        let last = TABLE.len() - 1;
        let enough = (0..last).find(|&inner| pieces(inner).error <= error);
        pieces(enough.unwrap_or(last))
    }

    /// 2 `inner` + 1 pieces: 0 at -1, 1 at 1, and `inner` knots on either side of the outline.
    ///
    /// Where the profile is convex a chord lies above it. With every inner knot e below the profile and every chord at
    /// most e above, all errors balance; e is the least for which the knots reach the outline.
    fn balanced(inner: u32) -> Self {
        let (mut low, mut high) = (0.0, 0.25);
        for _ in 0..60 {
            let error = f64::midpoint(low, high);
            if march(inner, error).is_some() {
                high = error;
            } else {
                low = error;
            }
        }
        let outside = march(inner, high).unwrap_or_default();
        let inside = outside.iter().rev().map(|knot| Knot {
            t: -knot.t,
            value: 1.0 - knot.value,
        });
        let knots = outside.iter().copied().chain(inside).collect();
        Self { knots, error: high }
    }
}

/// The knots from the outer edge, each as far from the last as `error` allows, when the piece after them reaches the
/// outline's 1/2 within `error`.
fn march(inner: u32, error: f64) -> Option<Vec<Knot>> {
    let mut knots = vec![Knot {
        t: -1.0,
        value: 0.0,
    }];
    let mut last = knots[0];
    for _ in 0..inner {
        let next = |t: f64| Knot {
            t,
            value: Profile::Disc.at(t) - error,
        };
        let (mut near, mut far) = (last.t, 0.0);
        for _ in 0..60 {
            let t = f64::midpoint(near, far);
            if overshoot(last, next(t)) <= error {
                near = t;
            } else {
                far = t;
            }
        }
        last = next(near);
        knots.push(last);
    }
    (overshoot(last, Knot { t: 0.0, value: 0.5 }) <= error).then_some(knots)
}

/// How far the chord between two knots outside of the outline rises above the profile: most where the profile's slope,
/// 2 sqrt(1 - t²) / π, is the chord's.
fn overshoot(from: Knot, to: Knot) -> f64 {
    if to.t <= from.t {
        return 0.0;
    }
    let slope = (to.value - from.value) / (to.t - from.t);
    let scaled = (slope * FRAC_PI_2).clamp(0.0, 1.0);
    let t = (-(1.0 - scaled * scaled).sqrt()).clamp(from.t, to.t);
    from.value + slope * (t - from.t) - Profile::Disc.at(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest difference between the disc's profile and its interpolation, in levels, by dense sampling.
    fn levels(knots: &[Knot]) -> f64 {
        let mut worst: f64 = 0.0;
        for pair in knots.windows(2) {
            for i in 0..=1000 {
                let s = f64::from(i) / 1000.0;
                let t = pair[0].t + (pair[1].t - pair[0].t) * s;
                let value = pair[0].value + (pair[1].value - pair[0].value) * s;
                worst = worst.max((value - Profile::Disc.at(t)).abs());
            }
        }
        worst * 255.0
    }

    #[test]
    fn five_balanced_pieces_are_within_one_level_and_a_tenth() {
        let pieces = Pieces::within(1.1 / 255.0);
        assert_eq!(pieces.knots.len(), 6);
        assert!(levels(&pieces.knots) <= 1.1, "{}", levels(&pieces.knots));
        assert!((levels(&pieces.knots) - pieces.error * 255.0).abs() < 1e-3);
        let fewer = Pieces::balanced(1);
        assert_eq!(fewer.knots.len(), 4);
        assert!(levels(&fewer.knots) > 2.5);
        for (count, expected) in [(0, 14.8), (1, 3.0), (2, 1.1), (3, 0.6), (4, 0.4)] {
            let error = Pieces::balanced(count).error * 255.0;
            println!("{} pieces: {error:.3} levels", 2 * count + 1);
            assert!(error < expected * 1.2, "{error}");
        }
    }

    #[test]
    fn eight_pieces_of_exact_values_are_within_one_level() {
        // Knots whose chords all rise by the same height: found by marching with values on the profile.
        let march = |error: f64| {
            let mut knots = vec![Knot {
                t: -1.0,
                value: 0.0,
            }];
            while let Some(&last) = knots.last()
                && last.t < 0.0
            {
                let exact = |t: f64| Knot {
                    t,
                    value: Profile::Disc.at(t),
                };
                let far = (1..=4000)
                    .map(|i| last.t - last.t * f64::from(i) / 4000.0)
                    .take_while(|&t| overshoot(last, exact(t)) <= error)
                    .last();
                knots.push(exact(far.unwrap_or(0.0)));
            }
            knots
        };
        let outside = march(1.0 / 255.0);
        assert!(
            outside.len() <= 5,
            "{} pieces on one side",
            outside.len() - 1
        );
        assert!(levels(&outside) <= 1.001, "{}", levels(&outside));
    }

    #[test]
    fn distances_invert_the_profile() {
        for i in 0..=1000 {
            let t = f64::from(i) / 500.0 - 1.0;
            let back = disc_distance(Profile::Disc.at(t));
            assert!((back - t).abs() < 1e-6, "{t} {back}");
        }
    }

    #[test]
    fn other_looks_keep_their_marks() {
        assert!((Profile::Skia.at(0.0) - 0.35).abs() < 1e-3);
        assert!((Profile::Skia.at(1.0) - 0.982).abs() < 1e-12);
        assert!((Profile::Cosine.at(0.0) - 0.5).abs() < 1e-12);
        for profile in [
            Profile::Linear,
            Profile::Cosine,
            Profile::Disc,
            Profile::Skia,
        ] {
            assert!(profile.at(-1.0) < 1e-3);
            for i in 0..=40 {
                let t = f64::from(i) / 20.0 - 1.0;
                let through = profile.in_place_of(Profile::Disc.at(t));
                assert!((through - profile.at(t)).abs() < 1e-6, "{profile:?} {t}");
            }
        }
    }
}
