//! Quick meshes: of an icon, of a flag with long sides, of a ring, and of a card and an L whose sides are folded away.

use penumbral::{FillRule, Grid, Light, MeshOptions, MeshVertex, Path, ShadowMesh, Shape};

use crate::checks::*;

const BELL: &str = "M12 22A2 2 0 0 0 14 20H10A2 2 0 0 0 12 22M18 16V11C18 7.93 16.36 5.36 13.5 4.68V4A1.5 1.5 0 0 0 10.5 4\
    V4.68C7.63 5.36 6 7.92 6 11V16L4 18V19H20V18Z";

fn shapes() -> [(&'static str, Shape); 5] {
    let shape = |data: &str, rule| Shape::path(&Path::from_svg(data).unwrap(), rule).unwrap();
    [
        ("bell", shape(BELL, FillRule::NonZero)),
        (
            "card",
            Shape::rounded_rect(-3.0, 1.0, 150.0, 90.0, [3.0, 0.0, 6.0, 9.0]).unwrap(),
        ),
        ("L", shape("M0 0H90V12H20V60H0Z", FillRule::NonZero)),
        ("flag", shape("M0 0H40L24 9L40 18H0Z", FillRule::NonZero)),
        (
            "ring",
            shape(
                "M0 12A12 12 0 0 0 24 12A12 12 0 0 0 0 12M5 12A7 7 0 0 0 19 12A7 7 0 0 0 5 12",
                FillRule::EvenOdd,
            ),
        ),
    ]
}

fn quick(tolerance: f32) -> MeshOptions {
    MeshOptions::new(levels(tolerance)).quick()
}

#[test]
fn every_point_of_the_penumbra_lies_in_one_triangle() {
    let mut lots = Lots(5);
    for (name, shape) in shapes() {
        for radius in [1.6, 6.0, 30.0] {
            let light = Light::directional([0.0, 0.0], radius).unwrap();
            let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
            let mesh = shadow.mesh(quick(1.0));
            sanity_check(&mesh);
            for _ in 0..1_000 {
                let point = [44.0, 24.0].map(|side| lots.next() * (side + 2.0 * radius) - radius);
                let depths: Vec<f64> = mesh.triangles().map(|t| depth(t, point)).collect();
                // On an edge, as far as rounding goes, it lies in both triangles or in neither.
                let on_edge = depths.iter().any(|depth| depth.abs() < 1e-5);
                // Where one is refined, chords along the penumbra's round ends leave out next to nothing.
                if on_edge || shadow.density_at(point) < 0.2 / 255.0 {
                    continue;
                }
                let count = depths.iter().filter(|&&depth| depth > 0.0).count();
                assert_eq!(count, 1, "{name} at r {radius}, {point:?}");
            }
        }
    }
}

/// Twice the least area between a point and a triangle's sides; less than 0 where it lies outside.
fn depth([a, b, c]: [MeshVertex; 3], point: [f32; 2]) -> f64 {
    let sides = [(a, b), (b, c), (c, a)];
    let areas = sides.map(|(a, b)| double_area(a.position, b.position, point));
    areas.into_iter().fold(f64::INFINITY, f64::min)
}

#[test]
fn pictures_move_no_faster_than_the_exact_ones() {
    // From next to nothing to where nothing of an umbra is left, in both kinds of meshes and from one to the other.
    let light = Light::new([12.0, 0.0, 600.0], 800.0).unwrap();
    let grid = Grid::new([-60.0, -60.0], [48, 48], 0.33).unwrap();
    let center = |i: u16| f32::from(i) / 0.33 + 0.5 / 0.33 - 60.0;
    for (name, shape) in shapes() {
        for way in [MeshOptions::new(levels(2.0)), quick(2.0)] {
            let mut last: Option<(Vec<f32>, Vec<f64>)> = None;
            for step in 0_u8..41 {
                let elevation = 0.1 * 1.19_f32.powi(i32::from(step));
                let shadow = light.cast(&shape, elevation, 0.0).unwrap();
                let mesh = shadow.mesh(way);
                assert!(mesh.is_complete(), "{name} at {elevation}");
                let mut picture = vec![0.0; 48 * 48];
                mesh.rasterize(&grid, &mut picture).unwrap();
                let exact: Vec<f64> = (0_u16..48 * 48)
                    .map(|i| shadow.density_at([i % 48, i / 48].map(center)))
                    .collect();
                if let Some((before, exact_before)) = last {
                    for i in 0..48 * 48 {
                        let moved = f64::from((picture[i] - before[i]).abs());
                        let may = (exact[i] - exact_before[i]).abs();
                        assert!(moved <= may + 4.0 / 255.0, "{name} at {elevation}");
                    }
                }
                last = Some((picture, exact));
            }
        }
    }
}

#[test]
fn finer_tolerances_take_more_triangles_and_coarser_ones_are_off_by_more() {
    let light = Light::android(24.0).unwrap();
    for (name, shape) in shapes() {
        let shadow = light.cast(&shape, 8.0, 0.0).unwrap();
        let mut last: Option<(f64, usize)> = None;
        for tolerance in TOLERANCES {
            let mesh: ShadowMesh = shadow.mesh(quick(tolerance));
            let error = dense_error(&shadow, &mesh, 6);
            assert!(
                error <= f64::from(tolerance),
                "{name}: {error} within {tolerance}"
            );
            let count = mesh.triangles().count();
            if let Some((finer, more)) = last {
                assert!(
                    count < more,
                    "{name} within {tolerance}: {count} after {more}"
                );
                assert!(
                    error > finer,
                    "{name} within {tolerance}: {error} after {finer}"
                );
            }
            last = Some((error, count));
        }
    }
}

#[test]
fn what_does_not_suit_halving_is_refined() {
    // A circle as large as the disc: its middle is a tip between samples, wherever they are.
    let mut ring = Path::new();
    ring.move_to([10.0, 0.0]);
    for i in 1_u8..=64 {
        let (sin, cos) = (f32::from(i) * core::f32::consts::PI / 32.0).sin_cos();
        ring.line_to([10.0 * cos, 10.0 * sin]);
    }
    let shape = Shape::path(ring.close(), FillRule::NonZero).unwrap();
    let light = Light::directional([0.0, 0.0], 10.0).unwrap();
    let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
    let mesh = shadow.mesh(quick(1.0));
    assert!(mesh.is_complete());
    assert!(dense_error(&shadow, &mesh, 8) <= 1.0);
    // Far away `f32` has no room for samples: refinement states what is lost.
    let far = Shape::rect(8_000_000.0, 0.0, 2.0, 30.0).unwrap();
    let shadow = light.cast(&far, 1.0, 0.0).unwrap();
    let mesh = shadow.mesh(quick(1.0));
    assert_eq!(mesh.is_complete(), mesh.error_levels() <= 1.0);
}
