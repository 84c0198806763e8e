//! `atlas`: where each method fails, and by how much: its error against the parameter that breaks it.

mod families;

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use penumbral::lab::{self, Errors, Family, Shipping, Technique};
use penumbral::plan::Method;
use penumbral::{Scratch, Tolerance};
use serde::Serialize;

use self::families::{Case, Stress, Trial};
use crate::chart::plot::{self, Line, Mark, Panel};
use crate::{Failure, output};

/// A technique on a case.
#[derive(Serialize)]
struct Row {
    stress: &'static str,
    parameter: &'static str,
    value: f64,
    method: String,
    setting: String,
    max_levels: f64,
    rms_levels: f64,
    /// What a method that ships promises here.
    promised_levels: Option<f64>,
    #[serde(skip)]
    family: Family,
}

impl Row {
    fn fails(&self) -> bool {
        self.promised_levels
            .is_some_and(|promised| self.max_levels > promised)
    }
}

/// A technique that takes longer is spared what is left of a stress.
const SLOW: Duration = Duration::from_millis(1500);

/// Errors below that are drawn on the axis.
const LEAST_LEVELS: f64 = 0.01;

pub(crate) fn run(folder: &Path) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let stresses = families::all();
    let steps = stresses.iter().map(|stress| stress.values.len()).sum();
    let bar = output::progress(steps, "stress");
    let mut rows = Vec::new();
    let mut left_out = String::new();
    for stress in &stresses {
        let mut slow = Vec::new();
        for value in &stress.values {
            measure(stress, *value, &mut rows, &mut slow)?;
            bar.inc(1);
        }
        for (method, value) in slow {
            left_out.push_str(&format!(
                "left out: {method}, {} beyond {value}: too slow\n",
                stress.name
            ));
        }
    }
    bar.finish_and_clear();

    let file = |name: &str| folder.join(name);
    let json = serde_json::to_string_pretty(&rows).map_err(|error| error.to_string())?;
    output::write(&file("atlas.json"), json.as_bytes())?;
    output::write(&file("atlas.csv"), csv(&rows).as_bytes())?;
    let table = markdown(&stresses, &rows);
    output::write(&file("atlas.md"), table.as_bytes())?;
    let panels: Vec<Panel> = stresses.iter().map(|stress| panel(stress, &rows)).collect();
    let rows_of_panels = panels.len().div_ceil(3) as u32;
    plot::save(
        &file("atlas"),
        "Largest error, in levels, against what breaks a method",
        &plot::LEGEND[..5],
        &panels,
        [1860, 60 + 480 * rows_of_panels],
    )?;

    let mut text = table;
    text.push_str(&left_out);
    let failing: Vec<&Row> = rows.iter().filter(|row| row.fails()).collect();
    for row in &failing {
        text.push_str(&format!(
            "fails: {} ({}), {}, {} {}: {:.3} levels\n",
            row.method, row.setting, row.stress, row.parameter, row.value, row.max_levels
        ));
    }
    text.push_str(&format!(
        "cases in which a shipping method passes its tolerance: {}\n",
        failing.len()
    ));
    output::print(&text)
}

/// What a method that ships promises of pixels: its tolerance, and `exact` what it states; a mesh only where pixels are no
/// averages.
fn promised(technique: &dyn Technique, case: &Case) -> Option<f64> {
    let radius = case.shadow.radius() * case.grid.pixels_per_unit();
    match (technique.family(), technique.name()) {
        (Family::Ours, "mesh") if radius >= 3.0 => Some(1.0),
        (Family::Ours, _) => technique.claim().levels,
        _ => None,
    }
}

/// All techniques on a case, but for those that were `slow` on one before.
fn measure(
    stress: &Stress,
    value: f64,
    rows: &mut Vec<Row>,
    slow: &mut Vec<(String, f64)>,
) -> Result<(), Failure> {
    let failed = |error: penumbral::Error| format!("{} {value}: {error}", stress.name);
    let (case, techniques) = match stress.trial {
        Trial::Shadow(case) => (case(value), lab::techniques()),
        Trial::Setting(techniques) => (families::card(), techniques(value)),
        Trial::Own(drawn) => {
            let drawn = drawn(value).map_err(failed)?;
            rows.extend(drawn.into_iter().map(|own| Row {
                stress: stress.name,
                parameter: stress.parameter,
                value,
                method: own.method.to_owned(),
                setting: String::new(),
                max_levels: own.errors.max_levels,
                rms_levels: own.errors.rms_levels,
                promised_levels: own.promised_levels,
                family: own.family,
            }));
            return Ok(());
        }
    };
    let case = case.map_err(failed)?;
    let mut scratch = Scratch::new();
    let pixels = case.grid.width() as usize * case.grid.height() as usize;
    let mut exact = vec![0.0; pixels];
    let reference = Shipping::new(Some(Method::Exact), Tolerance::ONE_LEVEL);
    reference
        .draw(&case.shadow, &case.grid, &mut exact, &mut scratch)
        .map_err(failed)?;
    let mut densities = vec![0.0; pixels];
    for technique in techniques.map_err(failed)? {
        let is_slow = slow.iter().any(|(method, _)| method == technique.name());
        if is_slow || technique.name() == reference.name() {
            continue;
        }
        let start = Instant::now();
        technique
            .draw(&case.shadow, &case.grid, &mut densities, &mut scratch)
            .map_err(failed)?;
        if start.elapsed() > SLOW {
            slow.push((technique.name().to_owned(), value));
        }
        let errors = Errors::between(&densities, &exact);
        let mut promised_levels = promised(technique.as_ref(), &case);
        if technique.name() == "mesh" && promised_levels.is_some_and(|p| errors.max_levels > p) {
            // A mesh that is not complete promises what it says of itself.
            let mesh = case.shadow.mesh(Tolerance::ONE_LEVEL);
            promised_levels = Some(mesh.error_levels());
        }
        rows.push(Row {
            stress: stress.name,
            parameter: stress.parameter,
            value,
            method: technique.name().to_owned(),
            setting: lab::setting(technique.as_ref()),
            max_levels: errors.max_levels,
            rms_levels: errors.rms_levels,
            promised_levels,
            family: technique.family(),
        });
    }
    Ok(())
}

fn csv(rows: &[Row]) -> String {
    let mut text = String::from("stress,parameter,value,method,setting,max_levels,rms_levels\n");
    for row in rows {
        text.push_str(&format!(
            "{},{},{},{},\"{}\",{:.4},{:.4}\n",
            row.stress,
            row.parameter,
            row.value,
            row.method,
            row.setting,
            row.max_levels,
            row.rms_levels
        ));
    }
    text
}

/// The names of methods in a list of rows, in their first order.
fn methods<'a>(rows: impl Iterator<Item = &'a Row>) -> Vec<(&'a str, Family)> {
    let mut names: Vec<(&str, Family)> = Vec::new();
    for row in rows {
        if !names.iter().any(|(name, _)| *name == row.method) {
            names.push((&row.method, row.family));
        }
    }
    names
}

/// A row a method, a column a stress: the worst error and where it is.
fn markdown(stresses: &[Stress], rows: &[Row]) -> String {
    let mut text = String::from(
        "Largest error in levels, and the parameter's value where it is. Those that ship promise 1 level; bold where it is passed.\n\n| method |",
    );
    for stress in stresses {
        text.push_str(&format!(" {} |", stress.name));
    }
    text.push_str(&format!("\n|---|{}\n", "--:|".repeat(stresses.len())));
    for (method, _) in methods(rows.iter()) {
        text.push_str(&format!("| {method} |"));
        for stress in stresses {
            let own = rows
                .iter()
                .filter(|row| row.stress == stress.name && row.method == method);
            let worst = own
                .clone()
                .max_by(|a, b| a.max_levels.total_cmp(&b.max_levels));
            text.push_str(&match worst {
                None => " - |".to_owned(),
                Some(row) if own.clone().any(Row::fails) => {
                    format!(" **{:.1}** at {} |", row.max_levels, row.value)
                }
                Some(row) => format!(" {:.1} at {} |", row.max_levels, row.value),
            });
        }
        text.push('\n');
    }
    text
}

fn panel(stress: &Stress, rows: &[Row]) -> Panel {
    let own = || rows.iter().filter(|row| row.stress == stress.name);
    let mut lines: Vec<Line> = methods(own())
        .into_iter()
        .map(|(method, family)| Line {
            name: method.to_owned(),
            color: plot::of_family(Some(family)),
            bold: family == Family::Ours,
            marks: own()
                .filter(|row| row.method == method)
                .map(|row| Mark {
                    x: row.value,
                    y: row.max_levels.max(LEAST_LEVELS),
                    label: None,
                })
                .collect(),
            pale: Vec::new(),
        })
        .collect();
    lines.reverse();
    Panel {
        x: format!("{}: {}", stress.name, stress.parameter),
        y: String::new(),
        lines,
        front: None,
        level: Some((1.0, "the promise: 1 level")),
    }
}
