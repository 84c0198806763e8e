//! Meshes against the exact density.
use penumbral::*;

fn report(name: &str, shadow: &Shadow, levels: f32) {
    let t = std::time::Instant::now();
    let mesh = shadow.mesh(Tolerance::levels(levels).unwrap());
    println!(
        "{name} tol {levels}: r {:.2} v {} t {} err {:.3} complete {} {:?}",
        shadow.radius(),
        mesh.vertices().len(),
        mesh.indices().len() / 3,
        mesh.error_levels(),
        mesh.is_complete(),
        t.elapsed()
    );
}

#[test]
fn probe() {
    let light = Light::new([180.0, 0.0, 600.0], 800.0).unwrap();
    let card = Shape::rounded_rect(30.0, 100.0, 300.0, 200.0, 12.0).unwrap();
    let chip = Shape::rounded_rect(30.0, 100.0, 24.0, 24.0, 4.0).unwrap();
    let bar = Shape::rect(30.0, 100.0, 200.0, 4.0).unwrap();
    let ell = Shape::polygon(
        &[[
            [60.0f32, 60.0],
            [130.0, 60.0],
            [130.0, 190.0],
            [250.0, 190.0],
            [250.0, 260.0],
            [60.0, 260.0],
        ]],
        FillRule::NonZero,
    )
    .unwrap();
    for tol in [0.5, 1.0, 2.0, 4.0, 8.0] {
        report("card 8", &light.cast(&card, 8.0, 0.0).unwrap(), tol);
        report("chip 24", &light.cast(&chip, 24.0, 0.0).unwrap(), tol);
        report("bar 8", &light.cast(&bar, 8.0, 0.0).unwrap(), tol);
        report("ell 10", &light.cast(&ell, 10.0, 0.0).unwrap(), tol);
    }
}
