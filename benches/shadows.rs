//! The way from a shape to a picture, step by step: cast, exact, mesh, raster, render.
//!
//! Run all with `cargo bench --features scene`, one step with `cargo bench --features scene -- exact`.

#![expect(
    clippy::unwrap_used,
    reason = "a fixture that cannot be read ends the run"
)]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use penumbral::{FillRule, Grid, Light, Path, Renderer, Scene, Scratch, Shadow, Shape, Tolerance};
use tiny_skia::Pixmap;

/// The picture that shadows are drawn on, in pixels.
const SIDE: u32 = 400;

fn shapes() -> [(&'static str, Shape); 3] {
    let heart = "M180 280C60 200 40 130 70 95C105 55 160 70 180 115C200 70 255 55 290 95C320 130 300 200 180 280Z";
    let heart = Path::from_svg(heart).unwrap();
    let star: Vec<[f32; 2]> = (0_u8..10)
        .map(|i| {
            let (sin, cos) = (f32::from(i) * core::f32::consts::PI / 5.0).sin_cos();
            let radius = if i % 2 == 0 { 120.0 } else { 48.0 };
            [200.0 + radius * sin, 200.0 - radius * cos]
        })
        .collect();
    [
        (
            "card",
            Shape::rounded_rect(60.0, 120.0, 280.0, 160.0, 12.0).unwrap(),
        ),
        ("star", Shape::polygon(&[star], FillRule::NonZero).unwrap()),
        ("heart", Shape::path(&heart, FillRule::NonZero).unwrap()),
    ]
}

fn shadow(shape: &Shape, radius: f32) -> Shadow {
    Light::directional([0.0, 0.0], radius)
        .unwrap()
        .cast(shape, 1.0, 0.0)
        .unwrap()
}

fn cast(c: &mut Criterion) {
    let light = Light::android(400.0).unwrap();
    let mut group = c.benchmark_group("cast");
    for (name, shape) in shapes() {
        group.bench_function(name, |b| {
            b.iter(|| light.cast(black_box(&shape), 8.0, 0.0).unwrap());
        });
    }
    group.finish();
}

fn exact(c: &mut Criterion) {
    let grid = Grid::new([0.0, 0.0], [SIDE, SIDE], 1.0).unwrap();
    let mut group = c.benchmark_group("exact");
    group.throughput(Throughput::Elements(u64::from(SIDE * SIDE)));
    group.sample_size(10);
    let mut mask = vec![0; (SIDE * SIDE) as usize];
    let mut scratch = Scratch::new();
    for (name, shape) in shapes() {
        for radius in [0.0, 0.5, 2.0, 8.0, 32.0] {
            let shadow = shadow(&shape, radius);
            group.bench_function(BenchmarkId::new(name, radius), |b| {
                b.iter(|| {
                    black_box(&shadow)
                        .fill_a8(&grid, &mut mask, &mut scratch)
                        .unwrap();
                });
            });
        }
    }
    group.finish();
}

fn mesh(c: &mut Criterion) {
    let mut group = c.benchmark_group("mesh");
    group.sample_size(10);
    for (name, shape) in shapes() {
        let shadow = shadow(&shape, 10.0);
        for levels in [1.0, 4.0] {
            let tolerance = Tolerance::levels(levels).unwrap();
            group.bench_function(BenchmarkId::new(name, levels), |b| {
                b.iter(|| black_box(&shadow).mesh(tolerance));
            });
        }
    }
    group.finish();
}

fn raster(c: &mut Criterion) {
    let grid = Grid::new([0.0, 0.0], [SIDE, SIDE], 1.0).unwrap();
    let mut group = c.benchmark_group("raster");
    group.throughput(Throughput::Elements(u64::from(SIDE * SIDE)));
    let mut densities = vec![0.0; (SIDE * SIDE) as usize];
    for (name, shape) in shapes() {
        let mesh = shadow(&shape, 10.0).mesh(Tolerance::ONE_LEVEL);
        group.bench_function(name, |b| {
            b.iter(|| black_box(&mesh).rasterize(&grid, &mut densities).unwrap());
        });
    }
    group.finish();
}

fn render(c: &mut Criterion) {
    let mut group = c.benchmark_group("render");
    group.sample_size(10);
    for name in ["card-list", "dialog-over-list", "landing-page"] {
        let path = format!("{}/fixtures/scenes/{name}.json", env!("CARGO_MANIFEST_DIR"));
        let scene = Scene::from_json(&std::fs::read_to_string(path).unwrap()).unwrap();
        let grid = scene.grid().unwrap();
        let mut pixmap = Pixmap::new(grid.width(), grid.height()).unwrap();
        let mut renderer = Renderer::new();
        group.bench_function(name, |b| {
            b.iter(|| renderer.render(black_box(&scene), &mut pixmap).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, cast, exact, mesh, raster, render);
criterion_main!(benches);
