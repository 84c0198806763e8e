//! penumbral's truth scenes through other crates' shadows and blurs and through memory alone, in one run.
//!
//! Data flows one way: `scene_file.rs` and `truth.rs` make a `Scene`; each peer's file makes of it a drawing (`peer.rs`);
//! `timing.rs` times it, `truth.rs` tells its errors, `report.rs` writes both down.

mod epaint_mesh;
mod floors;
mod image_blur;
mod libblur_masks;
mod mask;
mod ours;
mod peer;
mod report;
mod resvg_filter;
mod scene;
mod scene_file;
mod timing;
mod triangles;
mod truth;
mod vello_rrect;

use std::collections::BTreeMap;
use std::fs;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};

use peer::Peer;
use report::Row;
use scene::Scene;

const FIXTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/truth");

/// Draws penumbral's truth scenes with penumbral and its peers: times, ratios and errors.
#[derive(Parser)]
struct Arguments {
    /// Only these scenes, by the names of their files
    #[arg(long, value_delimiter = ',')]
    scenes: Vec<String>,
    /// How long a peer draws a scene, each round
    #[arg(long, default_value_t = 25)]
    budget_ms: u64,
    /// How often everything is measured: the lower time counts
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// Writes the rows there too
    #[arg(long)]
    json: Option<PathBuf>,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let scenes = read_scenes(&arguments.scenes)?;
    let rows = measure_all(&scenes, &arguments)?;
    print!("{}", report::markdown(&rows, &scenes)?);
    if let Some(path) = &arguments.json {
        let json = serde_json::to_string_pretty(&rows)?;
        fs::write(path, json).with_context(|| path.display().to_string())?;
    }
    Ok(())
}

/// The scenes of these names, or all where there are none.
fn read_scenes(names: &[String]) -> Result<Vec<Scene>> {
    let mut paths: Vec<PathBuf> = if names.is_empty() {
        let entries = fs::read_dir(FIXTURES).context(FIXTURES)?;
        let all: Result<Vec<PathBuf>, _> = entries.map(|entry| entry.map(|e| e.path())).collect();
        all?
    } else {
        let path = |name: &String| Path::new(FIXTURES).join(format!("{name}.json"));
        names.iter().map(path).collect()
    };
    paths.retain(|path| path.extension().is_some_and(|e| e == "json"));
    paths.sort();
    ensure!(!paths.is_empty(), "no scenes in {FIXTURES}");
    let read = |path: &PathBuf| Scene::read(path).with_context(|| path.display().to_string());
    paths.iter().map(read).collect()
}

/// Every peer on every scene, so many rounds; rounds are apart in time, so that one busy minute spoils one of them.
fn measure_all(scenes: &[Scene], arguments: &Arguments) -> Result<Vec<Row>> {
    let peers = peer::all();
    let budget = Duration::from_millis(arguments.budget_ms);
    let steps = scenes.len() * peers.len() * arguments.rounds as usize;
    let progress = ProgressBar::new(steps as u64);
    progress.set_style(ProgressStyle::with_template(
        "{pos}/{len} [{elapsed}] {wide_bar} {msg}",
    )?);
    let mut rows: BTreeMap<(usize, usize), Row> = BTreeMap::new();
    for _ in 0..arguments.rounds {
        for (s, scene) in scenes.iter().enumerate() {
            for (p, peer) in peers.iter().enumerate() {
                progress.set_message(format!("{}: {}", scene.name, peer.name()));
                let row = measure(peer.as_ref(), scene, budget)
                    .with_context(|| format!("{} on {}", peer.name(), scene.name))?;
                if let Some(row) = row {
                    rows.entry((s, p))
                        .and_modify(|kept| kept.keep_lower(&row))
                        .or_insert(row);
                }
                progress.inc(1);
            }
        }
    }
    progress.finish_and_clear();
    Ok(rows.into_values().collect())
}

/// A peer on a scene: its errors in a first drawing, then its time on the same canvas.
fn measure(peer: &dyn Peer, scene: &Scene, budget: Duration) -> Result<Option<Row>> {
    let Some(mut draw) = peer.prepare(scene)? else {
        return Ok(None);
    };
    let mut canvas = scene.white_canvas();
    draw(&mut canvas)?;
    let errors = peer.draws_density().then(|| scene.truth.errors(&canvas));
    let ns = timing::median_ns(budget, || draw(black_box(&mut canvas)))?;
    Ok(Some(Row::new(peer.name(), scene, ns, errors)))
}
