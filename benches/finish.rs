//! How long rims take: their meshes, and each shading model. `fast-phong over phong` alternates the two and prints the median of
//! the ratios: what else the machine does slows both.

#![expect(
    clippy::unwrap_used,
    reason = "a bench that cannot be set up has nothing to measure"
)]

use std::hint::black_box;
use std::time::Instant;

use criterion::{Criterion, criterion_group, criterion_main};
use penumbral::finish::{Canvas, Lighting, Material, Rim, RimMesh, RimProfile, ShadingModel};
use penumbral::{CornerRadii, Grid, Light, Shape};

fn card() -> Shape {
    let radii = [[60.0; 2], [60.0; 2], [0.0; 2], [60.0; 2]];
    Shape::rounded_rect(0.0, 0.0, 240.0, 180.0, CornerRadii(radii)).unwrap()
}

fn mesh(steps: u32) -> RimMesh {
    let rim = Rim::new(24.0, 24.0, RimProfile::QuarterRound).unwrap();
    RimMesh::new(&card(), &rim.with_steps(steps).unwrap()).unwrap()
}

/// Under a small lamp, and under a disc whose highlight is smaller than it.
fn lighting(radius: f32) -> Lighting {
    let light = Light::new([60.0, -100.0, 300.0], radius).unwrap();
    Lighting::new([(light, 1.0)], 8.0, &Material::default()).unwrap()
}

fn time(canvas: &mut Canvas, mesh: &RimMesh, lighting: &Lighting, model: ShadingModel) -> f64 {
    let start = Instant::now();
    canvas.draw(mesh, lighting, model);
    black_box(canvas.pixels());
    start.elapsed().as_secs_f64()
}

fn shading(criterion: &mut Criterion) {
    criterion.bench_function("rim mesh, 24 steps", |bencher| bencher.iter(|| mesh(24)));
    let mut canvas = Canvas::new(&Grid::new([0.0, 0.0], [480, 360], 2.0).unwrap());
    let (steps, lamp) = (mesh(8), lighting(20.0));
    for &model in ShadingModel::ALL {
        criterion.bench_function(&format!("rim, {}", model.name()), |bencher| {
            bencher.iter(|| canvas.draw(&steps, &lamp, model));
        });
    }
    for (radius, what) in [(20.0, "a lamp"), (260.0, "a wide disc")] {
        for steps in [4, 8, 24] {
            let (mesh, lighting) = (mesh(steps), lighting(radius));
            let mut ratios: Vec<f64> = (0..101)
                .map(|_| {
                    let slow = time(&mut canvas, &mesh, &lighting, ShadingModel::Phong);
                    slow / time(&mut canvas, &mesh, &lighting, ShadingModel::FastPhong)
                })
                .collect();
            ratios.sort_by(f64::total_cmp);
            println!(
                "fast-phong over phong, {what}, {steps} steps: {:.2} times as fast",
                ratios[ratios.len() / 2]
            );
        }
    }
}

criterion_group!(benches, shading);
criterion_main!(benches);
