//! The median time of something done again and again.

use std::time::{Duration, Instant};

use anyhow::Result;

/// A sample takes at least this long: the clock's own cost does not show.
const LEAST_SAMPLE: Duration = Duration::from_micros(50);
/// Slow things get as many samples as this, whatever the budget.
const FEWEST_SAMPLES: usize = 5;

/// The median time of one `work` in nanoseconds, warm; about `budget` is spent on it.
pub(crate) fn median_ns(budget: Duration, mut work: impl FnMut() -> Result<()>) -> Result<f64> {
    let runs_a_sample = warm_up(budget / 4, &mut work)?;
    let mut samples = Vec::new();
    let start = Instant::now();
    while samples.len() < FEWEST_SAMPLES || start.elapsed() < budget {
        let start = Instant::now();
        for _ in 0..runs_a_sample {
            work()?;
        }
        samples.push(start.elapsed().as_secs_f64() * 1e9 / f64::from(runs_a_sample));
    }
    samples.sort_by(f64::total_cmp);
    Ok(samples[samples.len() / 2])
}

/// Works for `budget`, once at least, and tells how many runs make a sample.
fn warm_up(budget: Duration, work: &mut impl FnMut() -> Result<()>) -> Result<u32> {
    let start = Instant::now();
    let mut runs = 0_u32;
    while runs == 0 || start.elapsed() < budget {
        work()?;
        runs += 1;
    }
    let run = start.elapsed().as_secs_f64() / f64::from(runs);
    Ok((LEAST_SAMPLE.as_secs_f64() / run).ceil().max(1.0) as u32)
}
