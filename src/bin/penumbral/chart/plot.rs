//! Panels with logarithmic axes, as SVG and as PNG (plotters).

use std::io::Cursor;
use std::path::Path;
use std::sync::Once;

use image::{ImageBuffer, ImageFormat, Rgb};
use penumbral::lab::Family;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::register_font;

use crate::{Failure, output};

/// A panel of a picture.
pub(crate) struct Panel {
    pub(crate) x: String,
    pub(crate) y: String,
    pub(crate) lines: Vec<Line>,
    /// Steps that nothing is beyond.
    pub(crate) front: Option<Vec<(f64, f64)>>,
    /// A horizontal line and what it says.
    pub(crate) level: Option<(f64, &'static str)>,
}

/// A method's marks, joined.
pub(crate) struct Line {
    pub(crate) name: String,
    pub(crate) color: RGBColor,
    pub(crate) bold: bool,
    pub(crate) marks: Vec<Mark>,
    /// Small dots without labels.
    pub(crate) pale: Vec<(f64, f64)>,
}

/// A mark, and what stands beside it.
pub(crate) struct Mark {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) label: Option<String>,
}

/// The colour of a family; peers have none.
pub(crate) fn of_family(family: Option<Family>) -> RGBColor {
    match family {
        Some(Family::Ours) => RGBColor(0, 102, 204),
        Some(Family::Blurs) => RGBColor(214, 101, 21),
        Some(Family::Samples) => RGBColor(120, 84, 170),
        Some(Family::Maps) => RGBColor(28, 140, 90),
        Some(Family::Geometry) => RGBColor(190, 40, 70),
        _ => RGBColor(110, 110, 110),
    }
}

/// What the colours of all families mean.
pub(crate) const LEGEND: [(Option<Family>, &str); 6] = [
    (Some(Family::Ours), "ours"),
    (Some(Family::Blurs), "blurs"),
    (Some(Family::Samples), "samples"),
    (Some(Family::Maps), "maps"),
    (Some(Family::Geometry), "geometry"),
    (None, "other crates"),
];

/// Colours that are told apart side by side (Okabe & Ito 2008, and darker ones).
pub(crate) fn distinct(index: usize) -> RGBColor {
    const COLORS: [(u8, u8, u8); 12] = [
        (0, 114, 178),
        (213, 94, 0),
        (0, 158, 115),
        (204, 121, 167),
        (86, 80, 160),
        (160, 120, 0),
        (60, 60, 60),
        (0, 150, 200),
        (150, 40, 40),
        (90, 150, 40),
        (200, 60, 130),
        (120, 120, 120),
    ];
    let (r, g, b) = COLORS[index % COLORS.len()];
    RGBColor(r, g, b)
}

/// PNGs have so many pixels for one of the SVG.
const FINENESS: u32 = 2;

/// Writes a picture beside each other as `path` with .svg and .png, and gives the SVG's text.
pub(crate) fn save(
    path: &Path,
    title: &str,
    legend: &[(Option<Family>, &str)],
    panels: &[Panel],
    size: [u32; 2],
) -> Result<String, Failure> {
    static FONT: Once = Once::new();
    FONT.call_once(|| {
        // A font that is not one would fail every label below.
        let _ = register_font(
            "sans-serif",
            FontStyle::Normal,
            epaint_default_fonts::UBUNTU_LIGHT,
        );
    });
    let failed = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (size[0], size[1])).into_drawing_area();
        draw(&root, (title, legend), panels, 1).map_err(|error| failed(&error))?;
    }
    output::write(&path.with_extension("svg"), svg.as_bytes())?;

    let [width, height] = size.map(|side| side * FINENESS);
    let mut pixels = vec![0; width as usize * height as usize * 3];
    {
        let root = BitMapBackend::with_buffer(&mut pixels, (width, height)).into_drawing_area();
        draw(&root, (title, legend), panels, FINENESS).map_err(|error| failed(&error))?;
    }
    let picture: ImageBuffer<Rgb<u8>, Vec<u8>> = ImageBuffer::from_raw(width, height, pixels)
        .ok_or("the chart does not fill its picture")?;
    let mut png = Cursor::new(Vec::new());
    picture
        .write_to(&mut png, ImageFormat::Png)
        .map_err(|error| failed(&error))?;
    output::write(&path.with_extension("png"), &png.into_inner())?;
    Ok(svg)
}

type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

fn draw<B: DrawingBackend>(
    root: &DrawingArea<B, Shift>,
    (title, legend): (&str, &[(Option<Family>, &str)]),
    panels: &[Panel],
    scale: u32,
) -> Drawn<B> {
    root.fill(&WHITE)?;
    let (top, root) = root.split_vertically(44 * scale);
    let style = ("sans-serif", 24 * scale).into_font().color(&BLACK);
    top.draw_text(title, &style, (14 * scale as i32, 12 * scale as i32))?;
    let mut x = top.dim_in_pixel().0 as i32 - 14 * scale as i32;
    for (family, words) in legend.iter().rev() {
        let style = ("sans-serif", 17 * scale)
            .into_font()
            .color(&of_family(*family));
        let width = top.estimate_text_size(words, &style)?.0 as i32;
        x -= width;
        top.draw_text(words, &style, (x, 17 * scale as i32))?;
        x -= 22 * scale as i32;
    }
    let columns = panels.len().min(3);
    let rows = panels.len().div_ceil(columns);
    for (area, panel) in root.split_evenly((rows, columns)).iter().zip(panels) {
        draw_panel(area, panel, scale)?;
    }
    root.present()
}

/// The decades that hold all values.
fn decades(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for value in values.filter(|v| v.is_finite() && *v > 0.0) {
        (low, high) = (low.min(value), high.max(value));
    }
    if low > high {
        return 0.1..10.0;
    }
    // Some room for labels, most of it on the right.
    10.0_f64.powf((low.log10() * 4.0 - 1.2).floor() / 4.0)
        ..10.0_f64.powf((high.log10() * 4.0 + 1.6).ceil() / 4.0)
}

fn draw_panel<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    panel: &Panel,
    scale: u32,
) -> Drawn<B> {
    let values = |pick: fn(&(f64, f64)) -> f64| {
        panel.lines.iter().flat_map(move |line| {
            let marks = line.marks.iter().map(|mark| (mark.x, mark.y));
            marks
                .chain(line.pale.iter().copied())
                .map(move |mark| pick(&mark))
        })
    };
    let number = |v: &f64| {
        if *v >= 1e4 || *v < 1e-3 {
            format!("{v:.0e}")
        } else {
            format!("{}", (*v * 1e4).round() / 1e4)
        }
    };
    let mut chart = ChartBuilder::on(area)
        .margin(12 * scale)
        .x_label_area_size(44 * scale)
        .y_label_area_size(60 * scale)
        .build_cartesian_2d(
            decades(values(|m| m.0)).log_scale(),
            decades(values(|m| m.1)).log_scale(),
        )?;
    chart
        .configure_mesh()
        .x_desc(panel.x.as_str())
        .y_desc(panel.y.as_str())
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .axis_desc_style(("sans-serif", 16 * scale))
        .label_style(("sans-serif", 13 * scale))
        .bold_line_style(RGBColor(225, 225, 225))
        .light_line_style(RGBColor(243, 243, 243))
        .draw()?;
    let mut labels = Labels::default();
    if let Some(front) = &panel.front {
        let mut steps = Vec::new();
        for (index, &(x, y)) in front.iter().enumerate() {
            if index > 0 {
                steps.push((x, front[index - 1].1));
            }
            steps.push((x, y));
        }
        let style = RGBColor(40, 40, 40).mix(0.35).stroke_width(5 * scale);
        chart.draw_series(LineSeries::new(steps, style))?;
    }
    if let Some((level, words)) = panel.level {
        let range = chart.x_range();
        let style = RGBColor(0, 102, 204).mix(0.6).stroke_width(scale);
        let ends = [(range.start, level), (range.end, level)];
        chart.draw_series(LineSeries::new(ends, style))?;
        let at = chart.backend_coord(&(range.start, level));
        let style = ("sans-serif", 12 * scale)
            .into_font()
            .color(&RGBColor(0, 102, 204));
        area_text(area, words, (at.0 + 4, at.1 - 14 * scale as i32), &style)?;
    }
    for line in &panel.lines {
        let pale = line.color.mix(0.22).filled();
        chart.draw_series(line.pale.iter().map(|&at| Circle::new(at, 2 * scale, pale)))?;
    }
    for line in &panel.lines {
        let width = if line.bold { 3 } else { 1 };
        let style = line.color.stroke_width(width * scale);
        let points = line.marks.iter().map(|mark| (mark.x, mark.y));
        chart.draw_series(LineSeries::new(points, style))?;
        let size = if line.bold { 5 } else { 4 } * scale;
        chart.draw_series(
            line.marks
                .iter()
                .map(|mark| Circle::new((mark.x, mark.y), size, line.color.filled())),
        )?;
        for mark in &line.marks {
            labels.keep_clear(chart.backend_coord(&(mark.x, mark.y)), size as i32);
        }
    }
    // Names first: they must find room.
    let (width, height) = area.dim_in_pixel();
    let base = area.get_base_pixel();
    let box_ = [
        base.0,
        base.1,
        base.0 + width as i32,
        base.1 + height as i32,
    ];
    for line in &panel.lines {
        let Some(mark) = line.marks.last() else {
            continue;
        };
        let size = if line.bold { 16 } else { 14 } * scale;
        let style = ("sans-serif", size).into_font().color(&line.color);
        let at = chart.backend_coord(&(mark.x, mark.y));
        let place = labels.place(at, &line.name, size as i32, box_);
        area_text(area, &line.name, place, &style)?;
    }
    for line in &panel.lines {
        for mark in &line.marks {
            if let Some(label) = &mark.label {
                let size = 11 * scale;
                let style = ("sans-serif", size).into_font().color(&line.color);
                let at = chart.backend_coord(&(mark.x, mark.y));
                let place = labels.place(at, label, size as i32, box_);
                area_text(area, label, place, &style)?;
            }
        }
    }
    Ok(())
}

/// Text at a place of the whole picture.
fn area_text<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    text: &str,
    place: (i32, i32),
    style: &TextStyle<'_>,
) -> Drawn<B> {
    let base = area.get_base_pixel();
    area.draw_text(text, style, (place.0 - base.0, place.1 - base.1))
}

/// Boxes that labels are kept out of: left, top, right, bottom.
#[derive(Default)]
struct Labels {
    taken: Vec<[i32; 4]>,
}

impl Labels {
    fn keep_clear(&mut self, at: (i32, i32), size: i32) {
        self.taken
            .push([at.0 - size, at.1 - size, at.0 + size, at.1 + size]);
    }

    /// Where the text's upper left corner is, so near to `at` as there is room.
    fn place(&mut self, at: (i32, i32), text: &str, size: i32, within: [i32; 4]) -> (i32, i32) {
        let (width, height) = (text.chars().count() as i32 * size * 52 / 100, size);
        let mut best = ([0; 4], i64::MAX);
        for ring in 0..7_i32 {
            let gap = size / 2 + ring * size * 2 / 3;
            for (index, (dx, dy)) in [
                (gap, -height / 2),
                (gap, -height - gap / 2),
                (gap, gap / 2),
                (-width / 2, -height - gap),
                (-width / 2, gap),
                (-width - gap, -height / 2),
                (-width - gap, -height - gap / 2),
                (-width - gap, gap / 2),
            ]
            .into_iter()
            .enumerate()
            {
                let (x, y) = (at.0 + dx, at.1 + dy);
                let own = [x, y, x + width, y + height];
                let overlap = |other: &[i32; 4]| {
                    let w = own[2].min(other[2]) - own[0].max(other[0]);
                    let h = own[3].min(other[3]) - own[1].max(other[1]);
                    i64::from(w.max(0)) * i64::from(h.max(0))
                };
                let outside = own[0] < within[0]
                    || own[1] < within[1]
                    || own[2] > within[2]
                    || own[3] > within[3];
                let cost = self.taken.iter().map(overlap).sum::<i64>() * 20
                    + i64::from(outside) * 1_000_000
                    + i64::from(ring) * 40
                    + index as i64;
                if cost < best.1 {
                    best = (own, cost);
                }
            }
        }
        self.taken.push(best.0);
        (best.0[0], best.0[1])
    }
}
