//! The report: one HTML page with charts, shadows, error maps, and a slider between any two methods. It asks for nothing from
//! elsewhere.

use std::io::Cursor;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgb};
use penumbral::Scratch;
use penumbral::lab::Technique;
use serde_json::json;

use super::measure::{Drawing, Part, Row, draw};
use crate::Failure;

/// Shadows of more pixels are left out of the report, and so many of those that are left are shown.
const LARGEST: usize = 200_000;
const SHOWN: usize = 8;

/// Charts, and each technique's shadow and errors on some scenes.
pub(crate) fn page(
    charts: &[(String, String)],
    drawings: &[Drawing],
    techniques: &[Box<dyn Technique>],
    rows: &[Row],
    beaten: &[String],
) -> Result<String, Failure> {
    let mut scenes = Vec::new();
    let shown = drawings.iter().filter(|drawing| {
        drawing.is_base_size() && drawing.parts.iter().all(|p| p.exact.len() <= LARGEST)
    });
    for drawing in shown.take(SHOWN) {
        let Some(part) = drawing.parts.first() else {
            continue;
        };
        let mut methods = Vec::new();
        for technique in techniques {
            methods.push(method(technique.as_ref(), part)?);
        }
        scenes.push(json!({
            "name": drawing.name,
            "width": part.grid.width(),
            "height": part.grid.height(),
            "radius": (drawing.radius() * 100.0).round() / 100.0,
            "methods": methods,
        }));
    }
    let tabs: String = charts
        .iter()
        .map(|(title, svg)| format!("<figure><figcaption>{title}</figcaption>{svg}</figure>\n"))
        .collect();
    let data = json!({ "scenes": scenes, "rows": rows });
    // Nothing in it can end the script early.
    let data = data.to_string().replace("</", "<\\/");
    Ok(include_str!("report.html")
        .replace("<!--charts-->", &tabs)
        .replace("<!--beaten-->", &list(beaten))
        .replace("/*data*/", &data))
}

/// Lines as a list's items. Peers' names come from a file.
fn list(lines: &[String]) -> String {
    let safe = |line: &String| line.replace('&', "&amp;").replace('<', "&lt;");
    let item = |line: &String| format!("<li>{}</li>\n", safe(line));
    lines.iter().map(item).collect()
}

fn method(technique: &dyn Technique, part: &Part) -> Result<serde_json::Value, Failure> {
    let mut densities = vec![0.0; part.exact.len()];
    draw(technique, part, &mut densities, &mut Scratch::new())?;
    let errors = penumbral::lab::Errors::between(&densities, &part.exact);
    let size = [part.grid.width(), part.grid.height()];
    let levels: Vec<f32> = densities
        .iter()
        .zip(&part.exact)
        .map(|(got, exact)| (got - exact) * 255.0)
        .collect();
    Ok(json!({
        "name": super::named(technique),
        "max": errors.max_levels,
        "rms": errors.rms_levels,
        "shadow": uri(&grey_png(&densities, size)?),
        "errors": uri(&heat_png(&levels, size)?),
    }))
}

/// Bytes of a PNG as a link that holds them.
pub(crate) fn uri(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png))
}

/// Densities as 8-bit grey: white where all light arrives.
pub(crate) fn grey_png(densities: &[f32], size: [u32; 2]) -> Result<Vec<u8>, Failure> {
    let grey = |density: &f32| 255 - (density * 255.0).round() as u8;
    let pixels = densities.iter().map(grey).collect();
    let picture: ImageBuffer<Luma<u8>, Vec<u8>> =
        ImageBuffer::from_raw(size[0], size[1], pixels).ok_or("a map does not fill its picture")?;
    png(&picture.into())
}

/// Errors as colours: white for none, to red where the shadow is too dark, to blue where it is too light; full at 32 levels.
fn heat_png(levels: &[f32], size: [u32; 2]) -> Result<Vec<u8>, Failure> {
    let heat = |levels: &f32| {
        // Square roots, so that one level is seen beside thirty.
        let share = (levels.abs() / 32.0).min(1.0).sqrt();
        let rest = (255.0 * (1.0 - share)).round() as u8;
        if *levels > 0.0 {
            [255, rest, rest]
        } else {
            [rest, rest, 255]
        }
    };
    let pixels = levels.iter().flat_map(heat).collect();
    let picture: ImageBuffer<Rgb<u8>, Vec<u8>> =
        ImageBuffer::from_raw(size[0], size[1], pixels).ok_or("a map does not fill its picture")?;
    png(&picture.into())
}

fn png(picture: &DynamicImage) -> Result<Vec<u8>, Failure> {
    let mut png = Cursor::new(Vec::new());
    picture
        .write_to(&mut png, ImageFormat::Png)
        .map_err(|error| error.to_string())?;
    Ok(png.into_inner())
}
