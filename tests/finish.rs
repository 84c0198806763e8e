//! What a finish promises: normals, shading, detail, and nothing where there is none.

#![expect(clippy::unwrap_used, reason = "what fails in a helper is the test")]

use penumbral::finish::{Profile, Rim, RimMesh, RimSurface, ShadingModel, normals};
use penumbral::{Grid, Shape};

/// A card with three round corners and a sharp one, at the right below, whose rim is a quarter round.
fn card() -> (Shape, Rim) {
    let radii = [[60.0; 2], [60.0; 2], [0.0; 2], [60.0; 2]];
    let card = Shape::rounded_rect(0.0, 0.0, 240.0, 180.0, penumbral::CornerRadii(radii)).unwrap();
    (card, Rim::new(24.0, 24.0, Profile::QuarterRound).unwrap())
}

/// The largest angle, degrees, between a model's normals and the surface's own on smooth parts, and beside the crease, which
/// is all that is nearer to it than `beside` pixels: from the sharp corner to the inset's.
fn misses(model: ShadingModel, beside: f64) -> [f64; 2] {
    let (card, rim) = card();
    let surface = RimSurface::new(&card, &rim);
    let mesh = RimMesh::new(&card, &rim).unwrap();
    let grid = Grid::new([0.0, 0.0], [240, 180], 1.0).unwrap();
    let mut largest = [0.0_f64; 2];
    let found = normals(&grid, &mesh, model);
    for (index, normal) in found.iter().enumerate() {
        let Some(normal) = normal else { continue };
        let [x, y] = [(index % 240) as f64 + 0.5, (index / 240) as f64 + 0.5];
        let expected = surface.normal_at([x, y]);
        let cosine: f64 = normal.iter().zip(expected).map(|(a, b)| a * b).sum();
        let miss = cosine.clamp(-1.0, 1.0).acos().to_degrees();
        let across = ((240.0 - x) - (180.0 - y)).abs() / 2.0_f64.sqrt();
        let is_beside = x > 240.0 - 24.0 && y > 180.0 - 24.0 && across < beside;
        if is_beside {
            // On the crease itself either side is right.
            if across > 0.0 {
                largest[1] = largest[1].max(miss);
            }
        } else {
            if miss > largest[0] + 0.3 && model == ShadingModel::CurvatureDriven {
                println!("{x} {y} {miss}");
            }
            largest[0] = largest[0].max(miss);
        }
    }
    largest
}

#[test]
fn curvature_driven_normals_are_round_where_it_is_round_and_sharp_where_it_is_sharp() {
    for (model, name) in [
        (ShadingModel::Flat, "faces'"),
        (ShadingModel::Phong, "vertices'"),
        (ShadingModel::CurvatureDriven, "curvature-driven"),
    ] {
        let [smooth, beside] = misses(model, 8.0);
        println!(
            "{name} normals: {smooth:.2} degrees on smooth parts, {beside:.2} beside the crease"
        );
    }
}
