//! What was measured, as Markdown and as JSON.

use std::fmt::Write as _;

use serde::Serialize;

use crate::ours;
use crate::scene::Scene;
use crate::truth::Errors;

/// A peer on a scene.
#[derive(Serialize, Clone)]
pub(crate) struct Row {
    pub(crate) peer: &'static str,
    pub(crate) scene: String,
    /// The scene's largest penumbra radius, pixels.
    pub(crate) radius: f64,
    /// The median time of a drawing.
    pub(crate) ns: f64,
    /// The same over the megapixels of the shadows' bounds.
    pub(crate) ms_per_mp: f64,
    pub(crate) max_levels: Option<f64>,
    pub(crate) rms_levels: Option<f64>,
}

impl Row {
    pub(crate) fn new(peer: &'static str, scene: &Scene, ns: f64, errors: Option<Errors>) -> Self {
        Self {
            peer,
            scene: scene.name.clone(),
            radius: scene.radius(),
            ns,
            ms_per_mp: ns / 1e6 / scene.megapixels(),
            max_levels: errors.map(|errors| errors.max),
            rms_levels: errors.map(|errors| errors.rms),
        }
    }

    /// Keeps the lower of two rounds' times: a busy machine only ever adds to them.
    pub(crate) fn keep_lower(&mut self, other: &Self) {
        self.ns = self.ns.min(other.ns);
        self.ms_per_mp = self.ms_per_mp.min(other.ms_per_mp);
    }
}

/// A table of the peers over all scenes, then one a scene.
pub(crate) fn markdown(rows: &[Row], scenes: &[Scene]) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    write_peers(&mut text, rows)?;
    for scene in scenes {
        write_scene(&mut text, rows, scene)?;
    }
    Ok(text)
}

/// A peer over all scenes that it draws.
struct Summary {
    peer: &'static str,
    scenes: usize,
    ms_per_mp: f64,
    ratio: f64,
    /// Median and worst of the scenes' largest errors.
    errors: Option<[f64; 2]>,
}

fn summary(peer: &'static str, rows: &[Row]) -> Summary {
    let own: Vec<&Row> = rows.iter().filter(|row| row.peer == peer).collect();
    let mut errors: Vec<f64> = own.iter().filter_map(|row| row.max_levels).collect();
    errors.sort_by(f64::total_cmp);
    Summary {
        peer,
        scenes: own.len(),
        ms_per_mp: geometric_mean(own.iter().map(|row| row.ms_per_mp)),
        ratio: geometric_mean(own.iter().filter_map(|row| ratio(row, rows))),
        errors: errors.last().map(|worst| [median(&errors), *worst]),
    }
}

fn write_peers(text: &mut String, rows: &[Row]) -> std::fmt::Result {
    let mut peers: Vec<&'static str> = Vec::new();
    for row in rows {
        if !peers.contains(&row.peer) {
            peers.push(row.peer);
        }
    }
    let mut summaries: Vec<Summary> = peers.iter().map(|peer| summary(peer, rows)).collect();
    summaries.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
    writeln!(
        text,
        "| peer | scenes | ms/MP, geometric mean | time / {} | largest error, levels: median / worst |\n|---|--:|--:|--:|--:|",
        ours::NAME
    )?;
    for summary in &summaries {
        let errors = summary.errors.map_or("-".to_owned(), |[median, worst]| {
            format!("{median:.2} / {worst:.2}")
        });
        writeln!(
            text,
            "| {} | {} | {} | {} | {errors} |",
            summary.peer,
            summary.scenes,
            three_digits(summary.ms_per_mp),
            three_digits(summary.ratio),
        )?;
    }
    Ok(())
}

fn write_scene(text: &mut String, rows: &[Row], scene: &Scene) -> std::fmt::Result {
    writeln!(
        text,
        "\n### {}\n\n{} x {}, casters: {}, r up to {:.2} px, shadow bounds {:.3} MP\n",
        scene.name,
        scene.width,
        scene.height,
        scene.casters.len(),
        scene.radius(),
        scene.megapixels(),
    )?;
    writeln!(
        text,
        "| peer | µs | ms/MP | time / {} | largest error, levels | rms |\n|---|--:|--:|--:|--:|--:|",
        ours::NAME
    )?;
    let mut own: Vec<&Row> = rows.iter().filter(|row| row.scene == scene.name).collect();
    own.sort_by(|a, b| a.ns.total_cmp(&b.ns));
    for row in own {
        let levels = |levels: Option<f64>| levels.map_or("-".to_owned(), |v| format!("{v:.2}"));
        writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} |",
            row.peer,
            three_digits(row.ns / 1e3),
            three_digits(row.ms_per_mp),
            ratio(row, rows).map_or("-".to_owned(), three_digits),
            levels(row.max_levels),
            levels(row.rms_levels),
        )?;
    }
    Ok(())
}

/// A row's time over penumbral's on the same scene.
fn ratio(row: &Row, rows: &[Row]) -> Option<f64> {
    let ours = rows
        .iter()
        .find(|other| other.peer == ours::NAME && other.scene == row.scene)?;
    Some(row.ns / ours.ns)
}

/// The middle of sorted values, of which there is one at least.
fn median(sorted: &[f64]) -> f64 {
    let (low, high) = ((sorted.len() - 1) / 2, sorted.len() / 2);
    (sorted[low] + sorted[high]) / 2.0
}

fn geometric_mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), v| (sum + v.ln(), count + 1));
    (sum / f64::from(count)).exp()
}

/// Three digits that count, and all before the point.
fn three_digits(value: f64) -> String {
    let before_point = value.abs().log10().floor().max(-3.0) as i32 + 1;
    format!("{value:.*}", (3 - before_point).max(0) as usize)
}
