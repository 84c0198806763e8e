//! Meshes: their promises as structures, and their error against the exact density.

#![expect(
    clippy::unwrap_used,
    reason = "a fixture that cannot be read fails the test"
)]

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use penumbral::{
    FillRule, Grid, Light, MeshOptions, Profile, Scene, Shadow, ShadowMesh, Shape, Tolerance,
};

/// Weights of a triangle's corners, none of them where refinement looks.
const SAMPLES: [[f64; 3]; 9] = [
    [0.25, 0.25, 0.5],
    [0.25, 0.5, 0.25],
    [0.5, 0.25, 0.25],
    [0.75, 0.25, 0.0],
    [0.0, 0.75, 0.25],
    [0.25, 0.0, 0.75],
    [0.1, 0.3, 0.6],
    [0.6, 0.1, 0.3],
    [0.3, 0.6, 0.1],
];

fn levels(levels: f32) -> Tolerance {
    Tolerance::levels(levels).unwrap()
}

/// The largest and the root mean square error by sampling inside the triangles, in levels.
fn sampled_error(shadow: &Shadow, mesh: &ShadowMesh) -> (f64, f64) {
    let (mut worst, mut sum, mut area_sum) = (0.0_f64, 0.0, 0.0);
    for [a, b, c] in mesh.triangles() {
        let area = double_area(a.position, b.position, c.position);
        for weights in SAMPLES {
            let mix = |values: [f32; 3]| {
                values
                    .iter()
                    .zip(weights)
                    .map(|(v, w)| f64::from(*v) * w)
                    .sum::<f64>()
            };
            let x = mix([a.position[0], b.position[0], c.position[0]]);
            let y = mix([a.position[1], b.position[1], c.position[1]]);
            let density = mix([a.density, b.density, c.density]);
            let error = (density - shadow.density_at([x as f32, y as f32])) * 255.0;
            worst = worst.max(error.abs());
            sum += error * error * area;
            area_sum += area;
        }
    }
    (
        worst,
        if area_sum > 0.0 {
            (sum / area_sum).sqrt()
        } else {
            0.0
        },
    )
}

fn double_area(a: [f32; 2], b: [f32; 2], c: [f32; 2]) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| p.map(f64::from));
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Checks that triangles turn one way, have area, and meet edge to edge, and that what bounds them has density 0.
fn sanity_check(mesh: &ShadowMesh) {
    let mut edges: HashMap<(u32, u32), u32> = HashMap::new();
    for corners in mesh.indices().chunks_exact(3) {
        let at = |i: usize| mesh.vertices()[corners[i] as usize].position;
        assert!(double_area(at(0), at(1), at(2)) > 0.0);
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            let count = edges.entry((corners[from], corners[to])).or_default();
            *count += 1;
            assert_eq!(*count, 1, "two triangles on the same side of an edge");
        }
    }
    for &(from, to) in edges.keys() {
        if !edges.contains_key(&(to, from)) {
            for end in [from, to] {
                assert_eq!(
                    mesh.vertices()[end as usize].density,
                    0.0,
                    "an open edge inside of the penumbra"
                );
            }
        }
    }
    for vertex in mesh.vertices() {
        assert!((0.0..=1.0).contains(&vertex.density));
    }
}

/// The mesh's volume, its densities summed over its area.
fn mass(mesh: &ShadowMesh) -> f64 {
    mesh.triangles()
        .map(|[a, b, c]| {
            let mean = f64::from(a.density + b.density + c.density) / 3.0;
            double_area(a.position, b.position, c.position) / 2.0 * mean
        })
        .sum()
}

fn area(mesh: &ShadowMesh) -> f64 {
    mesh.triangles()
        .map(|[a, b, c]| double_area(a.position, b.position, c.position) / 2.0)
        .sum()
}

/// Each shadow on the ground of the fixtures' scenes, once, with the scene's name.
fn fixture_shadows() -> Vec<(String, Shadow)> {
    let mut shadows = Vec::new();
    for folder in ["scenes", "truth"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("fixtures")
            .join(folder);
        let entries = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path());
        let mut paths: Vec<_> = entries
            .filter(|path| path.extension().is_some_and(|e| e == "json"))
            .collect();
        paths.sort();
        for path in paths {
            let scene = Scene::from_json(&fs::read_to_string(&path).unwrap()).unwrap();
            let name = path.file_stem().unwrap().to_str().unwrap();
            // Many surfaces of a scene are of one kind: the bounds of each kind's shadow differ, its sizes do not.
            let mut kinds = Vec::new();
            for surface in scene.surfaces() {
                let shadow = scene
                    .light()
                    .cast(surface.shape(), surface.elevation(), 0.0)
                    .unwrap();
                let Some(bounds) = shadow.bounds() else {
                    continue;
                };
                let size = [0, 1].map(|axis| (bounds.max[axis] - bounds.min[axis]).round());
                let kind = (size, surface.elevation());
                if !kinds.contains(&kind) {
                    kinds.push(kind);
                    shadows.push((name.to_owned(), shadow));
                }
            }
        }
    }
    shadows
}

#[test]
fn every_fixture_keeps_its_tolerance() {
    let shadows = fixture_shadows();
    assert!(shadows.len() > 100, "{}", shadows.len());
    for tolerance in [1.0, 4.0] {
        let mut scenes: Vec<(String, f64, f64, usize)> = Vec::new();
        for (name, shadow) in &shadows {
            let mesh = shadow.mesh(levels(tolerance));
            sanity_check(&mesh);
            assert!(
                mesh.is_complete(),
                "{name} {:?} r {} err {}",
                shadow.bounds(),
                shadow.radius(),
                mesh.error_levels()
            );
            let (worst, rms) = sampled_error(shadow, &mesh);
            assert!(worst <= f64::from(tolerance), "{name}: {worst} levels");
            assert!(
                mesh.error_levels() <= f64::from(tolerance),
                "{name}: {}",
                mesh.error_levels()
            );
            match scenes.last_mut().filter(|last| last.0 == *name) {
                Some(last) => {
                    *last = (
                        name.clone(),
                        last.1.max(worst),
                        last.2.max(rms),
                        last.3 + mesh.indices().len() / 3,
                    );
                }
                None => scenes.push((name.clone(), worst, rms, mesh.indices().len() / 3)),
            }
        }
        for (name, worst, rms, triangles) in scenes {
            println!(
                "tolerance {tolerance}: {name:18} worst {worst:.2}, rms {rms:.2} levels (Skia's mesh: 40), {triangles} triangles"
            );
        }
    }
}

fn half_plane() -> Shadow {
    // One edge at x = 500 with nothing else near.
    let shape = Shape::rect(500.0, -2000.0, 2000.0, 4000.0).unwrap();
    Light::directional([0.0, 0.0], 10.0)
        .unwrap()
        .cast(&shape, 1.0, 0.0)
        .unwrap()
}

/// The largest error of densities along y = 0.025 from x = 485 on, twenty a unit, in levels.
fn worst_on_row(shadow: &Shadow, densities: &[f32]) -> f64 {
    let error = |(i, density): (usize, &f32)| {
        let x = 485.0 + (i as f32 + 0.5) / 20.0;
        (f64::from(*density) - shadow.density_at([x, 0.025])).abs() * 255.0
    };
    densities.iter().enumerate().map(error).fold(0.0, f64::max)
}

#[test]
fn a_straight_edge_takes_five_pieces_for_one_level_and_a_tenth() {
    let shadow = half_plane();
    let mesh = shadow.mesh(levels(1.2));
    let grid = Grid::new([485.0, 0.0], [600, 1], 20.0).unwrap();
    let mut densities = vec![0.0; 600];
    mesh.rasterize(&grid, &mut densities).unwrap();
    let worst = worst_on_row(&shadow, &densities);
    assert!(worst <= 1.1, "{worst} levels");
    // Five pieces and no fewer: those of three, 2.5 levels, would be over the tolerance.
    let coarse = shadow.mesh(levels(3.0));
    coarse.rasterize(&grid, &mut densities).unwrap();
    assert!(worst_on_row(&shadow, &densities) > 2.4);
}

#[test]
fn skias_profile_is_forty_levels_wrong_on_every_straight_edge() {
    let shadow = half_plane();
    let mesh = shadow.mesh(MeshOptions::new(levels(1.0)).with_profile(Profile::Skia));
    let grid = Grid::new([485.0, 0.0], [600, 1], 20.0).unwrap();
    let mut densities = vec![0.0; 600];
    mesh.rasterize(&grid, &mut densities).unwrap();
    let worst = worst_on_row(&shadow, &densities);
    println!("Skia's profile: {worst:.1} levels");
    assert!((38.0..42.0).contains(&worst), "{worst}");
    assert!(mesh.error_levels() > 38.0);
}

/// The hard cases: no umbra, holes, crossings, needles.
fn stress_shapes() -> Vec<(&'static str, Shape)> {
    let polygon = |points: &[[f32; 2]]| Shape::polygon(&[points], FillRule::NonZero).unwrap();
    let square = |at: f32, side: f32| {
        vec![
            [at, at],
            [at + side, at],
            [at + side, at + side],
            [at, at + side],
        ]
    };
    let mut inner = square(130.0, 40.0);
    let even_odd =
        Shape::polygon(&[square(100.0, 100.0), inner.clone()], FillRule::EvenOdd).unwrap();
    inner.reverse();
    let winding = Shape::polygon(&[square(100.0, 100.0), inner], FillRule::NonZero).unwrap();
    let star: Vec<[f32; 2]> = (0_u8..10)
        .map(|i| {
            let (sin, cos) = (f32::from(i) * core::f32::consts::PI / 5.0).sin_cos();
            let radius = if i % 2 == 0 { 60.0 } else { 23.0 };
            [160.0 + radius * sin, 150.0 - radius * cos]
        })
        .collect();
    vec![
        (
            "card",
            Shape::rounded_rect(30.0, 100.0, 300.0, 200.0, 12.0).unwrap(),
        ),
        ("circle", Shape::circle([150.0, 150.0], 40.0).unwrap()),
        (
            "ellipse",
            Shape::ellipse([150.0, 150.0], [60.0, 20.0]).unwrap(),
        ),
        ("bar", Shape::rect(100.0, 100.0, 200.0, 4.0).unwrap()),
        (
            "chip",
            Shape::rounded_rect(100.0, 100.0, 24.0, 24.0, 4.0).unwrap(),
        ),
        ("sliver", Shape::rect(30.0, 100.3, 300.0, 1.5).unwrap()),
        (
            "bow-tie",
            polygon(&[
                [100.0, 100.0],
                [200.0, 180.0],
                [200.0, 100.0],
                [100.0, 180.0],
            ]),
        ),
        (
            "needle",
            polygon(&[[50.0, 100.0], [300.0, 98.0], [300.0, 102.3]]),
        ),
        (
            "ell",
            polygon(&[
                [60.0, 60.0],
                [130.0, 60.0],
                [130.0, 190.0],
                [250.0, 190.0],
                [250.0, 260.0],
                [60.0, 260.0],
            ]),
        ),
        ("star", polygon(&star)),
        ("even-odd donut", even_odd),
        ("winding donut", winding),
    ]
}

#[test]
fn hard_cases_keep_their_tolerance_and_their_mass() {
    let light = Light::new([180.0, 150.0, 500.0], 800.0).unwrap();
    for (name, shape) in stress_shapes() {
        for elevation in [0.05, 1.0, 8.0, 24.0, 80.0] {
            let shadow = light.cast(&shape, elevation, 0.0).unwrap();
            let mesh = shadow.mesh(levels(2.0));
            sanity_check(&mesh);
            let (worst, _) = sampled_error(&shadow, &mesh);
            assert!(
                mesh.is_complete(),
                "{name} at {elevation}: {}",
                mesh.error_levels()
            );
            // Where the penumbra is a tenth of a unit, `f32` moves its vertices and these samples by a thousandth of it: two steps of 2^-16 at coordinates up to 512, down the steepest slope, 2 / π over the radius.
            let rounding = 2.0 * 255.0 * (2.0 / core::f64::consts::PI) / 65536.0 / shadow.radius();
            assert!(
                worst <= 2.0 + rounding,
                "{name} at {elevation}: {worst} levels"
            );
            // A nearly hard shadow has the outline's area as its mass, and so has every other.
            let scale = 500.0 / (500.0 - f64::from(elevation));
            let hard = mass(&light.cast(&shape, 0.05, 0.0).unwrap().mesh(levels(1.0)));
            let expected = hard * (scale / (500.0 / 499.95)).powi(2);
            let slack = 2.0 / 255.0 * area(&mesh);
            assert!(
                (mass(&mesh) - expected).abs() <= slack,
                "{name} at {elevation}: {} {expected}",
                mass(&mesh)
            );
        }
    }
}

#[test]
fn casters_too_small_for_an_umbra_peak_where_the_closed_form_does() {
    let light = Light::new([180.0, 150.0, 500.0], 800.0).unwrap();
    let bar = Shape::rect(80.0, 148.0, 200.0, 4.0).unwrap();
    let chip = Shape::rounded_rect(168.0, 138.0, 24.0, 24.0, 4.0).unwrap();
    for (shape, elevation, peak) in [(bar, 8.0, 0.198), (chip, 24.0, 0.121)] {
        let shadow = light.cast(&shape, elevation, 0.0).unwrap();
        assert!(shadow.umbra_bounds().is_none());
        assert!((shadow.density_at([180.0, 150.0]) - peak).abs() < 5e-4);
        let mesh = shadow.mesh(levels(0.5));
        let top = mesh
            .vertices()
            .iter()
            .map(|vertex| f64::from(vertex.density))
            .fold(0.0, f64::max);
        assert!((top - peak).abs() < 3e-3, "{top}");
    }
}

#[test]
fn a_point_light_leaves_the_umbra_alone() {
    let light = Light::new([0.0, 0.0, 100.0], 0.0).unwrap();
    let shape = Shape::rounded_rect(-20.0, -10.0, 40.0, 20.0, 5.0).unwrap();
    let mesh = light
        .cast(&shape, 50.0, 0.0)
        .unwrap()
        .mesh(Tolerance::ONE_LEVEL);
    assert!(mesh.vertices().iter().all(|vertex| vertex.density == 1.0));
    let expected = 4.0 * (800.0 - (4.0 - core::f64::consts::PI) * 25.0);
    assert!(
        (area(&mesh) - expected).abs() < 0.05,
        "{} {expected}",
        area(&mesh)
    );
}

#[test]
fn a_limit_on_vertices_is_reported() {
    let light = Light::android(400.0).unwrap();
    let card = Shape::rounded_rect(30.0, 100.0, 300.0, 200.0, 12.0).unwrap();
    let shadow = light.cast(&card, 8.0, 0.0).unwrap();
    let mesh = shadow.mesh(MeshOptions::new(levels(0.5)).with_max_vertices(300));
    assert!(!mesh.is_complete());
    assert!(mesh.error_levels() > 0.5);
    sanity_check(&mesh);
}

#[test]
fn one_shadow_has_one_mesh() {
    let light = Light::android(400.0).unwrap();
    for (name, shape) in stress_shapes() {
        let mesh = || light.cast(&shape, 8.0, 0.0).unwrap().mesh(levels(4.0));
        assert_eq!(mesh(), mesh(), "{name}");
    }
}

#[test]
fn next_to_no_penumbra_takes_no_more_than_the_limit() {
    let light = Light::new([0.0, 0.0, 600.0], 800.0).unwrap();
    let disc = Shape::circle([0.0, 0.0], 500.0).unwrap();
    for elevation in [1e-6, 1e-3, 0.02] {
        let shadow = light.cast(&disc, elevation, 0.0).unwrap();
        let mesh = shadow.mesh(levels(4.0));
        assert!(
            mesh.vertices().len() <= 1 << 16,
            "{}",
            mesh.vertices().len()
        );
        // A penumbra that `f32` has no room for is reported, not drawn.
        assert_eq!(
            mesh.is_complete(),
            mesh.error_levels() <= 4.0,
            "{}",
            mesh.error_levels()
        );
        sanity_check_where_soft(&mesh);
        let umbra = shadow.umbra_bounds().unwrap();
        assert!((umbra.max[0] - 500.0).abs() < 0.05, "{umbra:?}");
    }
    let hard = Light::new([0.0, 0.0, 600.0], 0.0)
        .unwrap()
        .cast(&disc, 300.0, 0.0)
        .unwrap();
    assert_eq!(hard.umbra_bounds(), hard.bounds());
}

/// [`sanity_check`], for meshes that have a penumbra.
fn sanity_check_where_soft(mesh: &ShadowMesh) {
    if mesh.vertices().iter().any(|vertex| vertex.density == 0.0) {
        sanity_check(mesh);
    }
}

/// Found by `penumbral atlas`: so far from the origin `f32` steps are as wide as the penumbra's rings, and the mesh is a hard edge.
#[test]
fn a_penumbra_too_narrow_for_its_coordinates_states_what_corners_lose() {
    let light = Light::directional([0.0, 0.0], 9.0).unwrap();
    let card = Shape::rounded_rect(4e6, -4e6, 60.0, 40.0, 8.0).unwrap();
    let shadow = light.cast(&card, 1.0, 0.0).unwrap();
    let mesh = shadow.mesh(levels(1.0));
    let grid = Grid::new([4e6 - 9.0, -4e6 - 9.0], [80, 60], 1.0).unwrap();
    let mut densities = vec![0.0; 80 * 60];
    mesh.rasterize(&grid, &mut densities).unwrap();
    let error = |(i, density): (usize, &f32)| {
        let (x, y) = ((i % 80) as f32, (i / 80) as f32);
        let exact = shadow.density_at([4e6 - 8.5 + x, -4e6 - 8.5 + y]);
        (f64::from(*density) - exact).abs() * 255.0
    };
    let worst = densities.iter().enumerate().map(error).fold(0.0, f64::max);
    println!("{worst} levels, stated {}", mesh.error_levels());
    assert!(!mesh.is_complete());
    assert!(worst <= mesh.error_levels(), "{worst}");
}
