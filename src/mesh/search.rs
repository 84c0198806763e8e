//! Strips that are tried, balanced and made finer until they are within a tolerance.

/// The share of the tolerance that is aimed at first: rules that leave out how bends along and across meet.
const FIRST_AIM: f64 = 1.1;

/// By how much the aim shrinks from try to try, and how many there are.
const COARSEST_STEP: f64 = 0.95;
const FINEST_STEP: f64 = 0.8;
const TRIES: usize = 14;

/// How often vertices' densities are balanced before strips are made finer.
const BALANCES: usize = 4;

/// What strips are made of.
pub(super) trait Strips {
    /// Makes strips that should be within an error; no where they would have no width, or cross.
    fn make(&mut self, aim: f64) -> bool;

    /// The largest error, in density, and as much of it as tells that it is above a limit.
    fn error(&mut self, limit: f64) -> f64;

    /// Moves densities to where errors are as large above as below.
    fn balance(&mut self);
}

/// Makes strips within an error, and tells theirs, if any are found.
pub(super) fn within(limit: f64, strips: &mut impl Strips) -> Option<f64> {
    let mut aim = FIRST_AIM * limit;
    for _ in 0..TRIES {
        let mut error = f64::INFINITY;
        if strips.make(aim) {
            for _ in 0..=BALANCES {
                error = strips.error(limit);
                if error <= limit {
                    return Some(error);
                }
                strips.balance();
            }
        }
        aim *= (limit / error).clamp(FINEST_STEP, COARSEST_STEP);
    }
    None
}
