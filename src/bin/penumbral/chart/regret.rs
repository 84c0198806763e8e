//! What the plan's choice costs over the best one in hindsight: every shadow by every method that could draw it, in one run.

use std::hint::black_box;
use std::time::{Duration, Instant};

use penumbral::lab::{Errors, Shipping, Technique};
use penumbral::plan::{self, Method, Target};
use penumbral::{Scratch, Tolerance};

use super::measure::{Drawing, Part, draw};
use crate::{Failure, output};

/// A method on a shadow at a tolerance.
pub(crate) struct Trial {
    scene: String,
    pixels: usize,
    radius: f64,
    levels: f64,
    method: Method,
    /// What the method promises, whatever it keeps.
    promised_levels: f64,
    expected_ns: f64,
    measured_ns: f64,
    max_levels: f64,
    chosen: bool,
}

/// Rounds in which every method has its turn: the lowest time counts.
const ROUNDS: usize = 5;

/// How long a method draws in a round, at least.
const TURN: Duration = Duration::from_millis(2);

pub(crate) fn measure(drawings: &[Drawing], quick: bool) -> Result<Vec<Trial>, Failure> {
    let tolerances: &[f32] = if quick { &[1.0] } else { &[0.5, 1.0, 2.0, 4.0] };
    let bar = output::progress(drawings.len() * tolerances.len(), "the plan");
    let mut trials = Vec::new();
    for drawing in drawings {
        for levels in tolerances {
            let tolerance = Tolerance::levels(*levels).map_err(|error| error.to_string())?;
            // Shadows of one scene are much alike.
            for part in drawing.parts.iter().take(3) {
                trials.extend(shadow(drawing, part, tolerance)?);
                trials.extend(mesh(drawing, part, tolerance));
            }
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    Ok(trials)
}

fn shadow(drawing: &Drawing, part: &Part, tolerance: Tolerance) -> Result<Vec<Trial>, Failure> {
    let per_unit = part.grid.pixels_per_unit();
    let target = Target::Pixels(part.grid);
    let choice = plan::choose(&part.shadow, tolerance, target);
    let candidates = plan::candidates(&part.shadow, tolerance, target);
    let mut densities = vec![0.0; part.exact.len()];
    let mut scratch = Scratch::new();
    let mut trials = Vec::new();
    for candidate in candidates {
        let technique = Shipping::new(Some(candidate.method), tolerance);
        draw(&technique, part, &mut densities, &mut scratch)?;
        trials.push(Trial {
            scene: drawing.name.clone(),
            pixels: part.exact.len(),
            radius: part.shadow.radius() * per_unit,
            levels: tolerance.as_levels(),
            method: candidate.method,
            promised_levels: candidate.error_levels,
            expected_ns: candidate.cost_ns,
            measured_ns: f64::INFINITY,
            max_levels: Errors::between(&densities, &part.exact).max_levels,
            chosen: candidate.method == choice.method,
        });
    }
    for round in 0..ROUNDS {
        for trial in &mut trials {
            // It is never near.
            if trial.method == Method::Exact && !trial.chosen && round > 0 {
                continue;
            }
            let technique = Shipping::new(Some(trial.method), tolerance);
            trial.measured_ns =
                trial
                    .measured_ns
                    .min(turn(&technique, part, &mut densities, &mut scratch)?);
        }
    }
    Ok(trials)
}

/// What a mesh of a shadow costs: it is the only method for triangles, but is to be foretold like the others.
fn mesh(drawing: &Drawing, part: &Part, tolerance: Tolerance) -> Option<Trial> {
    let candidate = plan::candidates(&part.shadow, tolerance, Target::Triangles).next()?;
    let (mut spent, mut least, mut max_levels) = (Duration::ZERO, Duration::MAX, 0.0);
    while spent < TURN {
        let begin = Instant::now();
        let mesh = black_box(part.shadow.mesh(tolerance));
        let time = begin.elapsed();
        max_levels = mesh.error_levels();
        (spent, least) = (spent + time, least.min(time));
    }
    Some(Trial {
        scene: drawing.name.clone(),
        pixels: part.exact.len(),
        radius: part.shadow.radius() * part.grid.pixels_per_unit(),
        levels: tolerance.as_levels(),
        method: candidate.method,
        promised_levels: candidate.error_levels,
        expected_ns: candidate.cost_ns,
        measured_ns: least.as_nanos() as f64,
        max_levels,
        chosen: true,
    })
}

fn turn(
    technique: &dyn Technique,
    part: &Part,
    densities: &mut [f32],
    scratch: &mut Scratch,
) -> Result<f64, Failure> {
    let start = Instant::now();
    let mut least = f64::INFINITY;
    loop {
        let begin = Instant::now();
        draw(technique, part, densities, scratch)?;
        black_box(&densities);
        least = least.min(begin.elapsed().as_nanos() as f64);
        if start.elapsed() > TURN {
            return Ok(least);
        }
    }
}

pub(crate) fn csv(trials: &[Trial]) -> String {
    let mut text = String::from(
        "scene,pixels,radius,tolerance,method,expected_ns,measured_ns,max_levels,chosen\n",
    );
    for trial in trials {
        text.push_str(&format!(
            "{},{},{:.3},{},{},{:.0},{:.0},{:.4},{}\n",
            trial.scene,
            trial.pixels,
            trial.radius,
            trial.levels,
            trial.method,
            trial.expected_ns,
            trial.measured_ns,
            trial.max_levels,
            trial.chosen
        ));
    }
    text
}

/// The median and the worst of the chosen method's time over the least of those that promise the tolerance and kept it. One
/// that does not promise it may happen to keep it, which no plan can know: those shadows are counted.
pub(crate) fn summary(trials: &[Trial]) -> String {
    let (meshes, trials): (Vec<&Trial>, Vec<&Trial>) = trials
        .iter()
        .partition(|trial| trial.method == Method::Mesh);
    let mut regrets: Vec<(f64, String)> = Vec::new();
    let (mut broken, mut lucky) = (0, 0);
    for of_shadow in trials.chunk_by(|a, b| {
        (&a.scene, a.levels, a.pixels, a.radius) == (&b.scene, b.levels, b.pixels, b.radius)
    }) {
        let Some(chosen) = of_shadow.iter().find(|trial| trial.chosen) else {
            continue;
        };
        broken += u32::from(chosen.max_levels > chosen.levels.max(0.12));
        let kept = || of_shadow.iter().filter(|t| t.max_levels <= t.levels);
        let is_lucky =
            |t: &&Trial| t.promised_levels > t.levels && t.measured_ns < chosen.measured_ns;
        lucky += u32::from(kept().any(is_lucky));
        let kept = kept().filter(|trial| trial.promised_levels <= trial.levels);
        let Some(best) = kept.min_by(|a, b| a.measured_ns.total_cmp(&b.measured_ns)) else {
            continue;
        };
        regrets.push((
            chosen.measured_ns / best.measured_ns,
            format!(
                "{} at {} levels: {} in place of {}",
                chosen.scene, chosen.levels, chosen.method, best.method
            ),
        ));
    }
    regrets.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (Some(middle), Some(worst)) = (regrets.get(regrets.len() / 2), regrets.last()) else {
        return String::new();
    };
    format!(
        "the plan on {} shadows: median {:.3}, worst {:.3} times the best choice ({}); tolerance not kept: {broken}; a faster method kept it by chance: {lucky}\n",
        regrets.len(),
        middle.0,
        worst.0,
        worst.1
    ) + &forecast(&meshes)
}

/// How far the meshes' times are from what the plan says of them.
fn forecast(meshes: &[&Trial]) -> String {
    let ratio = |trial: &&Trial| trial.measured_ns / trial.expected_ns;
    let mut ratios: Vec<f64> = meshes.iter().map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    let (Some(least), Some(most)) = (ratios.first(), ratios.last()) else {
        return String::new();
    };
    format!(
        "{} meshes took {:.2} times what the plan said, median, and {least:.2} to {most:.2} times\n",
        ratios.len(),
        ratios[ratios.len() / 2]
    )
}
