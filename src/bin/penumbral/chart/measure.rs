//! Scenes as shadows on their own pixels, and what each technique makes of them in which time.

use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

use penumbral::lab::{self, Errors, Family, Shipping, Technique};
use penumbral::plan::Method;
use penumbral::{Grid, Scratch, Shadow, Tolerance};
use serde::{Deserialize, Serialize};

use crate::tilt::{self, Turned};
use crate::{Failure, output, read_scene};

/// The shadows of a scene's ground, each on the pixels of its bounds.
pub(crate) struct Drawing {
    /// The scene's file, and `@2` for two pixels a unit.
    pub(crate) name: String,
    pub(crate) parts: Vec<Part>,
}

/// A shadow and its pixels.
pub(crate) struct Part {
    pub(crate) shadow: Shadow,
    pub(crate) grid: Grid,
    pub(crate) exact: Vec<f32>,
}

/// A technique on a drawing.
#[derive(Serialize, Deserialize, Clone)]
pub(crate) struct Row {
    #[serde(alias = "peer")]
    pub(crate) method: String,
    #[serde(default)]
    pub(crate) setting: String,
    pub(crate) scene: String,
    /// The largest penumbra radius, pixels.
    pub(crate) radius: f64,
    /// The time of a drawing over the megapixels of the shadows' bounds.
    pub(crate) ms_per_mp: f64,
    pub(crate) max_levels: f64,
    pub(crate) rms_levels: f64,
    /// None for peers.
    #[serde(skip)]
    pub(crate) family: Option<Family>,
    /// Why the technique is not meant for the scene.
    #[serde(skip)]
    pub(crate) refused: bool,
}

impl Row {
    /// Whether it is one of the methods that ship, at a tolerance of 4 levels or less.
    pub(crate) fn is_promised(&self) -> bool {
        self.family == Some(Family::Ours) && !self.refused && self.method != "exact"
    }
}

impl Drawing {
    pub(crate) fn megapixels(&self) -> f64 {
        let pixels = |part: &Part| f64::from(part.grid.width()) * f64::from(part.grid.height());
        self.parts.iter().map(pixels).sum::<f64>() / 1e6
    }

    /// The largest penumbra radius, pixels.
    pub(crate) fn radius(&self) -> f64 {
        let radius = |part: &Part| part.shadow.radius() * part.grid.pixels_per_unit();
        self.parts.iter().map(radius).fold(0.0, f64::max)
    }
}

/// The drawings of a folder's scenes at sizes in pixels a unit, smallest first; of those named only, if any are.
pub(crate) fn drawings(
    folder: &Path,
    sizes: &[f32],
    only: &[&str],
) -> Result<Vec<Drawing>, Failure> {
    let mut drawings = Vec::new();
    for path in super::scene_files(folder)? {
        let stem = path
            .file_stem()
            .map(|stem| stem.to_string_lossy().into_owned())
            .unwrap_or_default();
        if !only.is_empty() && !only.contains(&stem.as_str()) {
            continue;
        }
        let scene = read_scene(&path)?;
        for size in sizes {
            let scaled = scene
                .clone()
                .with_scale(scene.scale() * size)
                .map_err(|error| error.to_string())?;
            let canvas = scaled.grid().map_err(|error| error.to_string())?;
            let mut parts = Vec::new();
            for (shadow, _) in lab::ground_casts(&scaled).map_err(|error| error.to_string())? {
                parts.extend(part(shadow, &canvas)?);
            }
            let name = if *size == 1.0 {
                stem.clone()
            } else {
                format!("{stem}@{size}")
            };
            drawings.push(Drawing { name, parts });
        }
    }
    drawings.sort_by(|a, b| a.megapixels().total_cmp(&b.megapixels()));
    Ok(drawings)
}

/// A shadow on the pixels of its bounds, as far as a canvas at the origin shows them; none where that is nothing.
fn part(shadow: Shadow, canvas: &Grid) -> Result<Option<Part>, Failure> {
    let Some(bounds) = shadow.bounds() else {
        return Ok(None);
    };
    let scale = canvas.pixels_per_unit();
    let size = [canvas.width(), canvas.height()].map(f64::from);
    let low = [0, 1].map(|i: usize| {
        (f64::from(bounds.min[i]) * scale)
            .floor()
            .clamp(0.0, size[i])
    });
    let high = [0, 1].map(|i: usize| {
        (f64::from(bounds.max[i]) * scale)
            .ceil()
            .clamp(0.0, size[i])
    });
    let [width, height] = [0, 1].map(|i: usize| (high[i] - low[i]) as u32);
    if width == 0 || height == 0 {
        return Ok(None);
    }
    let origin = low.map(|v| (v / scale) as f32);
    let grid = Grid::new(origin, [width, height], scale as f32).map_err(|e| e.to_string())?;
    let mut exact = vec![0.0; width as usize * height as usize];
    Shipping::new(Some(Method::Exact), Tolerance::ONE_LEVEL)
        .draw(&shadow, &grid, &mut exact, &mut Scratch::new())
        .map_err(|error| error.to_string())?;
    Ok(Some(Part {
        shadow,
        grid,
        exact,
    }))
}

/// How long a technique draws a scene again and again.
pub(crate) const BUDGET: Duration = Duration::from_millis(20);

/// A technique that would take longer than this for one drawing is left out of it.
const LONGEST: f64 = 4.0;

/// Every technique on every drawing, and what was left out. A technique whose last drawing tells that the next would take too
/// long does not draw it.
pub(crate) fn all(
    techniques: &[Box<dyn Technique>],
    drawings: &[Drawing],
) -> Result<(Vec<Row>, Vec<String>), Failure> {
    let bar = output::progress(techniques.len() * drawings.len(), "measuring");
    let mut rows = Vec::new();
    let mut left_out = Vec::new();
    for technique in techniques {
        let mut scratch = Scratch::new();
        let mut seconds_per_mp: f64 = 0.0;
        for drawing in drawings {
            bar.inc(1);
            let expected = seconds_per_mp * drawing.megapixels();
            if expected > LONGEST {
                left_out.push(format!(
                    "left out: {} on {}, about {expected:.0} s",
                    super::named(technique.as_ref()),
                    drawing.name
                ));
                continue;
            }
            let row = measure(technique.as_ref(), drawing, &mut scratch)?;
            seconds_per_mp = row.ms_per_mp / 1e3;
            rows.push(row);
        }
    }
    bar.finish_and_clear();
    Ok((rows, left_out))
}

fn measure(
    technique: &dyn Technique,
    drawing: &Drawing,
    scratch: &mut Scratch,
) -> Result<Row, Failure> {
    let largest = drawing.parts.iter().map(|part| part.exact.len()).max();
    let mut densities = vec![0.0; largest.unwrap_or(0)];
    let (mut max, mut squares, mut pixels) = (0.0_f64, 0.0, 0.0);
    // The first drawing warms up memory and tells the errors.
    let start = Instant::now();
    for part in &drawing.parts {
        draw(technique, part, &mut densities, scratch)?;
        let errors = Errors::between(&densities[..part.exact.len()], &part.exact);
        max = max.max(errors.max_levels);
        squares += errors.rms_levels * errors.rms_levels * part.exact.len() as f64;
        pixels += part.exact.len() as f64;
    }
    let least = least_time(start.elapsed(), || {
        for part in &drawing.parts {
            draw(technique, part, &mut densities, scratch)?;
        }
        black_box(&densities);
        Ok(())
    })?;
    Ok(Row {
        method: technique.name().to_owned(),
        setting: lab::setting(technique),
        scene: drawing.name.clone(),
        radius: drawing.radius(),
        ms_per_mp: least * 1e3 / drawing.megapixels(),
        max_levels: max,
        rms_levels: (squares / f64::max(pixels, 1.0)).sqrt(),
        family: Some(technique.family()),
        refused: drawing
            .parts
            .iter()
            .any(|part| technique.refusal(&part.shadow, &part.grid).is_some()),
    })
}

/// The least of some drawings' times in seconds, where the first took so long.
fn least_time(
    first: Duration,
    mut draw: impl FnMut() -> Result<(), Failure>,
) -> Result<f64, Failure> {
    let (mut spent, mut least, mut times) = (first, first, 0);
    while times < 3 && spent < Duration::from_secs(1) || spent < BUDGET {
        let start = Instant::now();
        draw()?;
        let time = start.elapsed();
        least = least.min(time);
        spent += time;
        times += 1;
    }
    Ok(least.as_secs_f64())
}

/// The card that turns, by what can draw it: shadows without one penumbra radius are not for techniques.
pub(crate) fn tilted(degrees: &[f64]) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    let mut scratch = Scratch::new();
    for degrees in degrees {
        let card = Turned::by(*degrees).map_err(|error| error.to_string())?;
        let mut densities = vec![0.0; card.pixels()];
        for method in tilt::Method::ALL {
            let mut draw = || {
                let drawn = card.draw(method, &mut densities, &mut scratch);
                black_box(&densities);
                drawn.map_err(|error| format!("{}: {error}", method.name()))
            };
            let start = Instant::now();
            draw()?;
            let least = least_time(start.elapsed(), draw)?;
            let errors = card.errors(&densities);
            rows.push(Row {
                method: method.name().to_owned(),
                setting: String::new(),
                scene: format!("tilted-{degrees}"),
                radius: card.radius,
                ms_per_mp: least * 1e9 / card.pixels() as f64,
                max_levels: errors.max_levels,
                rms_levels: errors.rms_levels,
                family: Some(method.family()),
                refused: false,
            });
        }
    }
    Ok(rows)
}

pub(super) fn draw(
    technique: &dyn Technique,
    part: &Part,
    densities: &mut [f32],
    scratch: &mut Scratch,
) -> Result<(), Failure> {
    technique
        .draw(
            &part.shadow,
            &part.grid,
            &mut densities[..part.exact.len()],
            scratch,
        )
        .map_err(|error| format!("{}: {error}", super::named(technique)))
}

pub(crate) fn json(rows: &[Row]) -> Result<String, Failure> {
    serde_json::to_string_pretty(rows).map_err(|error| error.to_string())
}

pub(crate) fn csv(rows: &[Row]) -> String {
    let mut text = String::from("method,setting,scene,radius,ms_per_mp,max_levels,rms_levels\n");
    for row in rows {
        text.push_str(&format!(
            "{},\"{}\",{},{:.3},{:.4},{:.4},{:.4}\n",
            row.method,
            row.setting,
            row.scene,
            row.radius,
            row.ms_per_mp,
            row.max_levels,
            row.rms_levels
        ));
    }
    text
}

/// The rows of the peers' own run (`benches/peers`), less those that have no errors and penumbral itself.
pub(crate) fn peers(text: &str) -> Result<Vec<Row>, serde_json::Error> {
    let values: Vec<serde_json::Value> = serde_json::from_str(text)?;
    values
        .into_iter()
        .filter(|row| row["max_levels"].is_number())
        .filter(|row| !row["peer"].as_str().unwrap_or("").starts_with("penumbral"))
        .map(serde_json::from_value)
        .collect()
}
