//! `chart`: every method's time against its error, on every scene; and what the plan's choice costs over the best one.

mod measure;
mod picture;
pub(crate) mod plot;
mod regret;
mod report;
#[cfg(feature = "finish")]
mod shading;

use std::fs;
use std::path::{Path, PathBuf};

use penumbral::lab::{self, Family, Technique};

use self::measure::{Drawing, Row};
use self::picture::{Picture, Series};
use crate::{Failure, output};

/// What is to be charted, and where to.
pub(crate) struct Options<'a> {
    pub(crate) folder: &'a Path,
    pub(crate) scenes: &'a Path,
    pub(crate) peers: Option<&'a Path>,
    pub(crate) quick: bool,
}

/// The scenes of a quick chart: a card, one without an umbra, one narrower than a pixel, a concave path, a curved one.
const QUICK: [&str; 5] = [
    "material-08dp",
    "huge-penumbra",
    "tiny-penumbra",
    "path-star",
    "path-heart",
];

/// By how many degrees the tilted card is turned.
const TILTS: [f64; 3] = [20.0, 10.0, 30.0];

/// Pixels a scene unit.
const SIZES: [f32; 2] = [1.0, 2.0];

pub(crate) fn run(options: &Options<'_>) -> Result<(), Failure> {
    fs::create_dir_all(options.folder)
        .map_err(|error| format!("{}: {error}", options.folder.display()))?;
    let sizes = if options.quick {
        &SIZES[..1]
    } else {
        &SIZES[..]
    };
    let only = if options.quick { &QUICK[..] } else { &[] };
    let drawings = measure::drawings(options.scenes, sizes, only)?;
    let techniques = if options.quick {
        lab::techniques()
    } else {
        lab::settings()
    }
    .map_err(|error| error.to_string())?;
    let (mut rows, left_out) = measure::all(&techniques, &drawings)?;
    let tilts = if options.quick {
        &TILTS[..1]
    } else {
        &TILTS[..]
    };
    rows.extend(measure::tilted(tilts)?);
    let peers = peers(options)?;
    let regrets = regret::measure(&drawings, options.quick)?;

    let file = |name: &str| options.folder.join(name);
    output::write(&file("chart.json"), measure::json(&rows)?.as_bytes())?;
    output::write(&file("chart.csv"), measure::csv(&rows).as_bytes())?;
    output::write(&file("plan.csv"), regret::csv(&regrets).as_bytes())?;
    let mut pictures = vec![(
        "chart".to_owned(),
        Picture::of_all(rows.iter().chain(&peers)),
    )];
    for family in Family::ALL {
        pictures.push((format!("chart-{family}"), Picture::of_family(family, &rows)));
    }
    #[cfg(feature = "finish")]
    {
        let rows = shading::rows()?;
        output::write(&file("shading.csv"), measure::csv(&rows).as_bytes())?;
        pictures.push(("chart-shading".to_owned(), shading::picture(&rows)));
    }
    let mut drawn = Vec::new();
    for (name, picture) in &pictures {
        let legend = if name == "chart" {
            &plot::LEGEND[..]
        } else {
            &[]
        };
        let svg = plot::save(
            &file(name),
            &picture.title,
            legend,
            &picture.panels,
            picture.size,
        )?;
        drawn.push((picture.title.clone(), svg));
    }
    let best = lab::techniques().map_err(|error| error.to_string())?;
    let beaten = beaten(&rows, &peers);
    let page = report::page(&drawn, &drawings, &best, &rows, &beaten)?;
    output::write(&file("report.html"), page.as_bytes())?;

    let mut text = summary(&rows, &peers);
    for line in &beaten {
        text.push_str(line);
        text.push('\n');
    }
    text.push_str(&regret::summary(&regrets));
    for line in &left_out {
        text.push_str(line);
        text.push('\n');
    }
    output::print(&text)
}

/// The peers' rows, where there is a file of them.
fn peers(options: &Options<'_>) -> Result<Vec<Row>, Failure> {
    let path = match options.peers {
        Some(path) => path.to_owned(),
        None => options.folder.join("peers.json"),
    };
    if options.peers.is_none() && !path.exists() {
        return Ok(Vec::new());
    }
    let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    measure::peers(&text).map_err(|error| format!("{}: {error}", path.display()))
}

/// All that were measured, a line each.
fn summary(rows: &[Row], peers: &[Row]) -> String {
    let all: Vec<Series> = picture::series(rows.iter().chain(peers));
    let mut text = String::from(
        "| method | setting | ms/MP | largest, levels | rms, levels |\n|---|---|--:|--:|--:|\n",
    );
    for series in &all {
        for mark in &series.marks {
            text.push_str(&format!(
                "| {} | {} | {:.3} | {:.2} | {:.3} |\n",
                series.name, mark.setting, mark.ms_per_mp, mark.max_levels, mark.rms_levels
            ));
        }
    }
    text
}

/// Where a method that is not ours is both faster and nearer than one that ships on a scene: how many such rows there are, and
/// each with the reason for it.
fn beaten(rows: &[Row], peers: &[Row]) -> Vec<String> {
    let mut lines = Vec::new();
    for ours in rows.iter().filter(|row| row.is_promised()) {
        let better = rows.iter().chain(peers).filter(|other| {
            other.family != Some(Family::Ours)
                && other.scene == ours.scene
                && other.ms_per_mp < ours.ms_per_mp
                && other.max_levels < ours.max_levels
        });
        for other in better {
            lines.push(format!(
                "beaten: {} ({}) by {} ({}) on {}: {:.3} and {:.3} ms/MP, {:.2} and {:.2} levels: {}",
                ours.method,
                ours.setting,
                other.method,
                other.setting,
                ours.scene,
                ours.ms_per_mp,
                other.ms_per_mp,
                ours.max_levels,
                other.max_levels,
                reason(&ours.method)
            ));
        }
    }
    let count = lines.len();
    lines.insert(
        0,
        format!("shipping methods beaten in both time and error: {count}"),
    );
    lines
}

/// Why a method of ours may be beaten.
fn reason(method: &str) -> &'static str {
    match method {
        "mesh" => "a mesh is built once for a GPU, here it is built and drawn for each picture",
        "auto" | "tilted" => "users get it",
        _ => "drawn by force: users get the plan's choice, auto",
    }
}

/// Every technique of a list draws every shadow of a drawing: the largest error is kept. Shared with the atlas.
pub(crate) fn named(technique: &dyn Technique) -> String {
    let setting = lab::setting(technique);
    if setting.is_empty() {
        technique.name().to_owned()
    } else {
        format!("{} ({setting})", technique.name())
    }
}

/// The folder of a path's scenes, or a failure that says what to give.
pub(crate) fn scene_files(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let entries = fs::read_dir(folder).map_err(|error| {
        format!(
            "{}: {error}: give a folder of scenes by --scenes",
            folder.display()
        )
    })?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    files.sort();
    if files.is_empty() {
        return Err(format!("{}: no scenes in it", folder.display()));
    }
    Ok(files)
}

/// All drawings are of one size at least.
impl Drawing {
    pub(crate) fn is_base_size(&self) -> bool {
        !self.name.contains('@')
    }
}
