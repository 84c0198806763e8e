//! Meshes: their promises as structures, and their error against the exact density.

#![expect(
    clippy::unwrap_used,
    reason = "a fixture that cannot be read fails the test"
)]

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use penumbral::{
    CornerRadii, Error, FillRule, Grid, Light, MeshBuffers, MeshOptions, MeshSlices, MeshVertex,
    Profile, Scene, Scratch, Shadow, ShadowMesh, Shape, Tolerance,
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
fn a_straight_edge_keeps_its_tolerance_and_takes_no_more_pieces() {
    let shadow = half_plane();
    let mesh = shadow.mesh(levels(1.2));
    let grid = Grid::new([485.0, 0.0], [600, 1], 20.0).unwrap();
    let mut densities = vec![0.0; 600];
    mesh.rasterize(&grid, &mut densities).unwrap();
    let worst = worst_on_row(&shadow, &densities);
    assert!(worst <= 1.1, "{worst} levels");
    // A mesh of fewer pieces is over the tolerance.
    let coarse = shadow.mesh(levels(4.0));
    coarse.rasterize(&grid, &mut densities).unwrap();
    assert!(worst_on_row(&shadow, &densities) > 1.2);
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

/// The largest error on a lattice of `parts` parts a side in each triangle, in levels.
fn lattice_error(shadow: &Shadow, mesh: &ShadowMesh, parts: u32) -> f64 {
    let mut worst: f64 = 0.0;
    for corners in mesh.triangles() {
        for i in 0..=parts {
            for j in 0..=parts - i {
                let [a, b] = [i, j].map(|part| f64::from(part) / f64::from(parts));
                let weights = [a, b, 1.0 - a - b];
                let mix = |value: fn(&MeshVertex) -> f32| {
                    let values = corners.iter().map(|corner| f64::from(value(corner)));
                    values.zip(weights).map(|(v, w)| v * w).sum::<f64>()
                };
                let (x, y) = (mix(|v| v.position[0]), mix(|v| v.position[1]));
                let exact = shadow.density_at([x as f32, y as f32]);
                worst = worst.max((mix(|v| v.density) - exact).abs() * 255.0);
            }
        }
    }
    worst
}

fn android_card(elevation: f32) -> Shadow {
    let card = Shape::rounded_rect(0.0, 0.0, 300.0, 200.0, 12.0).unwrap();
    let light = Light::new([150.0, 100.0, 600.0], 800.0).unwrap();
    light.cast(&card, elevation, 0.0).unwrap()
}

#[test]
fn a_card_takes_few_triangles() {
    let shadow = android_card(8.0);
    for (tolerance, most) in [(0.5, 1_400), (1.0, 700), (2.0, 350), (4.0, 200), (8.0, 110)] {
        let mesh = shadow.mesh(levels(tolerance));
        sanity_check(&mesh);
        let (triangles, worst) = (mesh.triangles().count(), lattice_error(&shadow, &mesh, 8));
        println!(
            "{tolerance}: {triangles} triangles, {worst:.3} of {:.3} levels",
            mesh.error_levels()
        );
        assert!(triangles <= most, "{tolerance}: {triangles} triangles");
        assert!(worst <= f64::from(tolerance), "{tolerance}: {worst} levels");
    }
}

/// Numbers in no order, the same on every machine.
struct Lots(u64);

impl Lots {
    /// The next one, from 0 to 1.
    fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 40) as f32 / (1_u64 << 24) as f32
    }
}

/// Rounded rectangles of all kinds: a thousand of them by `MESHES=1000 cargo test --release --all-features --test mesh`.
#[test]
fn rounded_rectangles_keep_their_tolerance() {
    let count = std::env::var("MESHES")
        .ok()
        .and_then(|count| count.parse().ok());
    let count: u32 = count.unwrap_or(60);
    let mut lots = Lots(7);
    let (mut worst, mut scratch) = (0.0_f64, Scratch::new());
    for index in 0..count {
        let radius = 10.0_f32;
        let mut size = || radius * 0.1 * 300.0_f32.powf(lots.next());
        let (width, height) = (size(), size());
        let mut round = || lots.next() * width.min(height) / 2.0;
        let radii = match index % 4 {
            0 => CornerRadii::from(0.0),
            1 => CornerRadii::from(width.min(height) / 2.0),
            2 => CornerRadii::from(round()),
            _ => CornerRadii::from([round(), round(), round(), round()]),
        };
        let shape = Shape::rounded_rect(-40.0, 30.0, width, height, radii).unwrap();
        let light = Light::directional([0.0, 0.0], radius).unwrap();
        let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
        let tolerance = [0.5, 1.0, 2.0, 4.0, 8.0][index as usize % 5];
        let mesh = shadow.mesh(levels(tolerance));
        sanity_check(&mesh);
        let error = lattice_error(&shadow, &mesh, 5) / f64::from(tolerance);
        let name = format!("{width} x {height}, {radii:?} within {tolerance}");
        assert!(
            mesh.is_complete() && error <= 1.0,
            "{name}: {error} of the tolerance"
        );
        assert!(mesh.error_levels() <= f64::from(tolerance), "{name}");
        let slack = f64::from(tolerance) / 255.0 * area(&mesh);
        let cut: f64 = match index % 4 {
            0 => 0.0,
            1 => (4.0 - core::f64::consts::PI) * f64::from(width.min(height) / 2.0).powi(2),
            _ => f64::NAN,
        };
        let missing = mass(&mesh) - (f64::from(width) * f64::from(height) - cut);
        assert!(
            cut.is_nan() || missing.abs() <= slack,
            "{name}: mass off by {missing}"
        );
        worst = worst.max(error);
        // A scratch changes nothing, whatever it was used for.
        let mut buffers = MeshBuffers::<u32>::new();
        shadow
            .mesh_into(&mut buffers, levels(tolerance), &mut scratch)
            .unwrap();
        assert_eq!(
            (buffers.vertices.as_slice(), buffers.indices.as_slice()),
            (mesh.vertices(), mesh.indices())
        );
    }
    println!("{count} rounded rectangles: at most {worst:.3} of the tolerance");
}

#[test]
fn every_point_of_the_penumbra_lies_in_one_triangle() {
    let light = Light::directional([0.0, 0.0], 10.0).unwrap();
    let mut lots = Lots(3);
    for (width, height, round) in [
        (60.0, 40.0, 12.0),
        (60.0, 40.0, 0.0),
        (30.0, 12.0, 6.0),
        (8.0, 8.0, 4.0),
    ] {
        let shape = Shape::rounded_rect(0.0, 0.0, width, height, round).unwrap();
        let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
        let mesh = shadow.mesh(levels(2.0));
        for _ in 0..2_000 {
            let point = [
                lots.next() * (width + 20.0) - 10.0,
                lots.next() * (height + 20.0) - 10.0,
            ];
            let within = |[a, b, c]: [MeshVertex; 3]| {
                let sides = [(a, b), (b, c), (c, a)];
                let least = sides.map(|(a, b)| double_area(a.position, b.position, point));
                least.into_iter().fold(f64::INFINITY, f64::min)
            };
            let depths: Vec<f64> = mesh.triangles().map(within).collect();
            // On an edge, as far as rounding goes, it lies in both triangles or in neither.
            if depths.iter().any(|depth| depth.abs() < 1e-4) || shadow.density_at(point) < 1e-9 {
                continue;
            }
            let count = depths.iter().filter(|&&depth| depth > 0.0).count();
            assert_eq!(count, 1, "{width} x {height}, {round} at {point:?}");
        }
    }
}

#[test]
fn one_interval_fewer_is_too_coarse() {
    // On a straight edge a card at one level takes so many pieces; the next mesh with fewer is off by more.
    let shadow = android_card(8.0);
    let rings = |mesh: &ShadowMesh| {
        let mut densities: Vec<f32> = mesh
            .vertices()
            .iter()
            .map(|vertex| vertex.density)
            .collect();
        densities.sort_by(f32::total_cmp);
        densities.len()
    };
    let fine = shadow.mesh(levels(1.0));
    let mut coarser = 1.0;
    let coarse = loop {
        coarser += 0.1;
        let mesh = shadow.mesh(levels(coarser));
        if rings(&mesh) < rings(&fine) {
            break mesh;
        }
    };
    assert!(lattice_error(&shadow, &coarse, 6) > 1.0);
}

#[test]
fn pictures_move_no_faster_than_the_exact_ones() {
    // Through corners as round as the penumbra, and umbrae that vanish.
    let light = Light::new([40.0, 30.0, 600.0], 800.0).unwrap();
    let grid = Grid::new([-60.0, -60.0], [40, 40], 0.2).unwrap();
    for (width, height, round) in [(60.0, 40.0, 12.0), (40.0, 40.0, 20.0), (90.0, 16.0, 2.0)] {
        let shape = Shape::rounded_rect(10.0, 10.0, width, height, round).unwrap();
        let mut last: Option<(Vec<f32>, Vec<f64>)> = None;
        for step in 0_u8..40 {
            let elevation = 0.1 * 1.19_f32.powi(i32::from(step));
            let shadow = light.cast(&shape, elevation, 0.0).unwrap();
            let mesh = shadow.mesh(levels(2.0));
            let mut picture = vec![0.0; 1_600];
            mesh.rasterize(&grid, &mut picture).unwrap();
            let exact: Vec<f64> = (0_u16..1_600)
                .map(|i| shadow.density_at([i % 40, i / 40].map(|v| f32::from(v) * 5.0 - 57.5)))
                .collect();
            if let Some((before, exact_before)) = last {
                for i in 0..1_600 {
                    let moved = f64::from((picture[i] - before[i]).abs());
                    let may = (exact[i] - exact_before[i]).abs();
                    assert!(
                        moved <= may + 4.0 / 255.0,
                        "{width} x {height} at {elevation}"
                    );
                }
            }
            last = Some((picture, exact));
        }
    }
}

#[test]
fn sinks_take_what_they_have_room_for() {
    assert_eq!(size_of::<MeshVertex>(), 12);
    let shadow = android_card(8.0);
    let (mesh, mut scratch) = (shadow.mesh(levels(4.0)), Scratch::new());
    let count = [mesh.vertices().len(), mesh.indices().len()];
    let mut into = |sink: &mut MeshBuffers<u16>| shadow.mesh_into(sink, levels(4.0), &mut scratch);
    let mut buffers = MeshBuffers::new();
    let quality = into(&mut buffers).unwrap();
    assert_eq!(
        (quality.error_levels, quality.complete),
        (mesh.error_levels(), true)
    );
    // The second one counts on from the first.
    into(&mut buffers).unwrap();
    assert_eq!(
        [buffers.vertices.len(), buffers.indices.len()],
        count.map(|n| 2 * n)
    );
    let (first, second) = buffers.indices.split_at(count[1]);
    assert!(
        first
            .iter()
            .zip(second)
            .all(|(a, b)| usize::from(*b) == usize::from(*a) + count[0])
    );
    // Sixteen bits are enough for so many, and nothing is written of one too many.
    while buffers.vertices.len() + count[0] <= usize::from(u16::MAX) {
        into(&mut buffers).unwrap();
    }
    let before = buffers.clone().vertices;
    assert!(matches!(into(&mut buffers), Err(Error::TooMany { .. })));
    assert_eq!(buffers.vertices, before);

    let mut vertices = vec![before[0]; count[0]];
    let mut indices = vec![0_u32; count[1] - 1];
    let mut slices = MeshSlices::new(&mut vertices, &mut indices);
    let refused = shadow.mesh_into(&mut slices, levels(4.0), &mut scratch);
    assert!(matches!(refused, Err(Error::BufferSize { .. })));
    assert_eq!(slices.filled(), [0, 0]);
    indices.push(0);
    let mut slices = MeshSlices::new(&mut vertices, &mut indices);
    shadow
        .mesh_into(&mut slices, levels(4.0), &mut scratch)
        .unwrap();
    assert_eq!(slices.filled(), count);
    assert_eq!(
        (vertices.as_slice(), indices.as_slice()),
        (mesh.vertices(), mesh.indices())
    );
}

#[cfg(feature = "lyon")]
#[test]
fn lyons_buffers_take_meshes() {
    use penumbral::LyonBuffers;
    let shadow = android_card(8.0);
    let mut buffers = lyon::tessellation::VertexBuffers::<MeshVertex, u16>::new();
    let mut sink = LyonBuffers::new(&mut buffers);
    shadow
        .mesh_into(&mut sink, levels(4.0), &mut Scratch::new())
        .unwrap();
    assert_eq!(buffers.vertices, shadow.mesh(levels(4.0)).vertices());
}
