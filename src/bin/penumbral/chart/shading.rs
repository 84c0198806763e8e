//! Shading models by the steps of their meshes: time against error. The truth is Phong's illumination of the surface's own normals.

use std::hint::black_box;
use std::time::Instant;

use penumbral::finish::{
    Canvas, Intensity, Lighting, Material, Rim, RimMesh, RimProfile, RimSurface, ShadingModel,
};
use penumbral::{Grid, Light, Shape};

use super::measure::{BUDGET, Row};
use super::picture::Picture;
use crate::Failure;

/// The steps of the meshes.
const STEPS: [u32; 5] = [3, 6, 12, 24, 48];

/// The picture's side, pixels; a card fills most of it.
const SIDE: u32 = 480;

/// Every model at every number of steps, on one card.
pub(crate) fn rows() -> Result<Vec<Row>, Failure> {
    measure().map_err(|error| error.to_string())
}

/// The models as a chart of their own.
pub(crate) fn picture(rows: &[Row]) -> Picture {
    Picture::of_rows("Time against error: shading of a rim", rows.iter())
}

fn measure() -> penumbral::Result<Vec<Row>> {
    let card = Shape::rounded_rect(40.0, 40.0, 400.0, 400.0, 90.0)?;
    let rim = Rim::new(60.0, 60.0, RimProfile::QuarterRound)?;
    let light = Light::new([60.0, -100.0, 500.0], 20.0)?;
    let lighting = Lighting::new([(light, 1.0)], 8.0, &Material::default())?;
    let grid = Grid::new([0.0, 0.0], [SIDE, SIDE], 1.0)?;
    let truth = truth(&RimSurface::new(&card, &rim), &lighting);
    let mut canvas = Canvas::new(&grid);
    let mut rows = Vec::new();
    for &model in ShadingModel::ALL {
        for steps in STEPS {
            let mesh = RimMesh::new(&card, &rim.with_steps(steps)?)?;
            let (mut least, mut spent) = (f64::INFINITY, 0.0);
            while spent < BUDGET.as_secs_f64() {
                let start = Instant::now();
                canvas.draw(&mesh, &lighting, model);
                black_box(canvas.pixels());
                let time = start.elapsed().as_secs_f64();
                least = least.min(time);
                spent += time;
            }
            let (mut max, mut squares, mut pixels) = (0.0_f64, 0.0, 0.0);
            for (found, exact) in canvas.pixels().iter().zip(&truth) {
                if let Some(found) = found {
                    let miss = (level(*found) - exact).abs();
                    max = max.max(miss);
                    squares += miss * miss;
                    pixels += 1.0;
                }
            }
            rows.push(Row {
                method: model.name().to_owned(),
                setting: format!("{steps} steps"),
                scene: "rim".to_owned(),
                radius: 0.0,
                ms_per_mp: least * 1e9 / f64::max(pixels, 1.0),
                max_levels: max,
                rms_levels: (squares / f64::max(pixels, 1.0)).sqrt(),
                family: None,
                refused: false,
            });
        }
    }
    Ok(rows)
}

fn level(of: Intensity) -> f64 {
    255.0 * f64::from(of.body + of.gloss)
}

fn truth(surface: &RimSurface, lighting: &Lighting) -> Vec<f64> {
    (0..SIDE * SIDE)
        .map(|index| {
            let at = [index % SIDE, index / SIDE].map(|v| f64::from(v) + 0.5);
            level(lighting.at([at[0], at[1], surface.rise_at(at)], surface.normal_at(at)))
        })
        .collect()
}
