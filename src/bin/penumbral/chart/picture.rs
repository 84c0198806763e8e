//! What a chart shows: methods as lines through their settings, and the front that none of them is beyond.

use penumbral::lab::Family;

use super::measure::Row;
use super::plot::{Line, Mark as Dot, Panel};

/// A method over all scenes that it is meant for, setting by setting.
pub(crate) struct Series {
    pub(crate) name: String,
    pub(crate) family: Option<Family>,
    pub(crate) marks: Vec<Mark>,
}

/// A setting.
pub(crate) struct Mark {
    pub(crate) setting: String,
    /// The geometric mean over the scenes.
    pub(crate) ms_per_mp: f64,
    /// The worst of the scenes.
    pub(crate) max_levels: f64,
    /// The root of the mean square of the scenes.
    pub(crate) rms_levels: f64,
}

/// A chart and its two panels: the largest error and the rms.
pub(crate) struct Picture {
    pub(crate) title: String,
    pub(crate) panels: Vec<Panel>,
    pub(crate) size: [u32; 2],
}

/// Methods in their first rows' order; scenes that a method is not meant for do not count.
pub(crate) fn series<'a>(rows: impl Iterator<Item = &'a Row>) -> Vec<Series> {
    let rows: Vec<&Row> = rows.filter(|row| !row.refused).collect();
    let mut all: Vec<Series> = Vec::new();
    let mut seen: Vec<(&str, &str)> = Vec::new();
    for row in &rows {
        let key = (row.method.as_str(), row.setting.as_str());
        if seen.contains(&key) {
            continue;
        }
        seen.push(key);
        let own: Vec<&&Row> = rows
            .iter()
            .filter(|other| (other.method.as_str(), other.setting.as_str()) == key)
            .collect();
        let count = own.len() as f64;
        let mark = Mark {
            setting: row.setting.clone(),
            ms_per_mp: (own.iter().map(|r| r.ms_per_mp.ln()).sum::<f64>() / count).exp(),
            max_levels: own.iter().map(|r| r.max_levels).fold(0.0, f64::max),
            rms_levels: (own.iter().map(|r| r.rms_levels.powi(2)).sum::<f64>() / count).sqrt(),
        };
        match all.iter_mut().find(|series| series.name == row.method) {
            Some(series) => series.marks.push(mark),
            None => all.push(Series {
                name: row.method.clone(),
                family: row.family,
                marks: vec![mark],
            }),
        }
    }
    all
}

/// Below that, errors are drawn on the axis: rounding to 8 bits is 500 times as much.
const LEAST_LEVELS: f64 = 0.02;

impl Picture {
    /// All methods, and the front.
    pub(crate) fn of_all<'a>(rows: impl Iterator<Item = &'a Row>) -> Self {
        let all = series(rows);
        let panel = |what: &str, levels: fn(&Mark) -> f64| {
            let lines: Vec<Line> = all
                .iter()
                .filter(|series| series.name != "exact")
                .map(|series| {
                    // Of many settings only the best are worth a place.
                    let mut line = line(series, levels, false);
                    let best = front(std::slice::from_ref(&line));
                    line.marks.retain(|mark| best.contains(&(mark.x, mark.y)));
                    line.marks.sort_by(|a, b| a.x.total_cmp(&b.x));
                    line
                })
                .collect();
            Panel {
                y: format!("{what}, levels of 255"),
                x: "time, ms per megapixel".to_owned(),
                front: Some(front(&lines)),
                lines,
                level: None,
            }
        };
        Self {
            title: "Time against error: every method over all scenes".to_owned(),
            panels: vec![
                panel("largest error of any pixel of any scene", |m| m.max_levels),
                panel("rms error", |m| m.rms_levels),
            ],
            size: [1500, 760],
        }
    }

    /// One family's methods by their settings, with a pale dot for each scene.
    pub(crate) fn of_family(family: Family, rows: &[Row]) -> Self {
        let own = rows
            .iter()
            .filter(|row| row.family == Some(family) && !row.refused && row.method != "exact");
        Self::of_rows(&format!("Time against error: {family}"), own)
    }

    /// Some methods by their settings, with a pale dot for each scene.
    pub(crate) fn of_rows<'a>(title: &str, rows: impl Iterator<Item = &'a Row> + Clone) -> Self {
        let own = || rows.clone();
        let all = series(own());
        let panel = |what: &str, levels: fn(&Mark) -> f64, of_row: fn(&Row) -> f64| {
            let mut lines: Vec<Line> = Vec::new();
            for (index, series) in all.iter().enumerate() {
                let mut line = line(series, levels, true);
                line.color = super::plot::distinct(index);
                let scenes = own().filter(|row| row.method == series.name);
                line.pale = scenes
                    .map(|row| (row.ms_per_mp, of_row(row).max(LEAST_LEVELS)))
                    .collect();
                lines.push(line);
            }
            Panel {
                y: format!("{what}, levels of 255"),
                x: "time, ms per megapixel".to_owned(),
                front: None,
                lines,
                level: None,
            }
        };
        Self {
            title: title.to_owned(),
            panels: vec![
                panel("largest error", |m| m.max_levels, |r| r.max_levels),
                panel("rms error", |m| m.rms_levels, |r| r.rms_levels),
            ],
            size: [1500, 760],
        }
    }
}

fn line(series: &Series, levels: fn(&Mark) -> f64, settings: bool) -> Line {
    Line {
        name: series.name.clone(),
        color: super::plot::of_family(series.family),
        bold: series.family == Some(Family::Ours),
        marks: series
            .marks
            .iter()
            .map(|mark| Dot {
                x: mark.ms_per_mp,
                y: levels(mark).max(LEAST_LEVELS),
                label: settings.then(|| short(&mark.setting)),
            })
            .collect(),
        pale: Vec::new(),
    }
}

/// A setting in fewer letters.
fn short(setting: &str) -> String {
    let words = [
        ("tolerance ", ""),
        (" levels", ""),
        ("samples ", ""),
        ("texels ", ""),
        (" a pixel", "/px"),
        ("kernel ", ""),
        ("region ", ""),
        ("corners ", ""),
        ("rays ", ""),
        ("profile ", ""),
        ("umbra ", ""),
        (", bias 0", ""),
        (", and 0 px", ""),
    ];
    let mut text = setting.to_owned();
    for (long, short) in words {
        text = text.replace(long, short);
    }
    text
}

/// The marks that no other is both left of and below, from left to right.
fn front(lines: &[Line]) -> Vec<(f64, f64)> {
    let mut marks: Vec<(f64, f64)> = lines
        .iter()
        .flat_map(|line| line.marks.iter().map(|mark| (mark.x, mark.y)))
        .collect();
    marks.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut least = f64::INFINITY;
    marks.retain(|mark| {
        let best = mark.1 < least;
        least = least.min(mark.1);
        best
    });
    marks
}
