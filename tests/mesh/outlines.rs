//! Outlines of every kind: those of the fixtures' scenes, hard ones, and random ones.

use std::fs;
use std::path::Path;

use penumbral::{
    FillRule, Grid, Image, Incomplete, Light, MeshOptions, Scene, Shadow, Shape, Tolerance,
};

use crate::checks::*;
use crate::common::worst;

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
            let text = fs::read_to_string(&path).unwrap();
            // An image is as large as its box, whatever is on it.
            let mut images = |_: &str| {
                Image::from_rgba8([1, 1], vec![255; 4]).map_err(|error| error.to_string())
            };
            let scene = Scene::from_json_with_images(&text, &mut images).unwrap();
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

/// Every third of them at one tolerance: all at all take minutes.
#[test]
fn fixtures_keep_their_tolerance() {
    let shadows = fixture_shadows();
    assert!(shadows.len() > 100, "{}", shadows.len());
    for (index, (name, shadow)) in shadows.iter().step_by(3).enumerate() {
        keeps(name, shadow, TOLERANCES[index % TOLERANCES.len()]);
    }
}

/// By `cargo test --release --all-features --test mesh every_tolerance -- --ignored --nocapture`.
#[test]
#[ignore = "minutes"]
fn every_fixture_keeps_every_tolerance() {
    let mut last = String::new();
    let mut sums = [(0.0_f64, 0); TOLERANCES.len()];
    for (name, shadow) in fixture_shadows() {
        if name != last {
            println!("{last}: worst levels and triangles {sums:.2?} within {TOLERANCES:?}");
            (last, sums) = (name.clone(), Default::default());
        }
        for (sum, tolerance) in sums.iter_mut().zip(TOLERANCES) {
            let (error, triangles) = keeps(&name, &shadow, tolerance);
            *sum = (sum.0.max(error), sum.1 + triangles);
        }
    }
    println!("{last}: worst levels and triangles {sums:.2?} within {TOLERANCES:?}");
}

/// Checks a shadow's two meshes; their largest error, in levels, and the number of triangles where these are to be few.
fn keeps(name: &str, shadow: &Shadow, tolerance: f32) -> (f64, usize) {
    let usual = MeshOptions::new(levels(tolerance));
    let (error, _) = keeps_with(&format!("{name}, quick"), shadow, usual.quick(), tolerance);
    let (worst, count) = keeps_with(name, shadow, usual, tolerance);
    (worst.max(error), count)
}

fn keeps_with(name: &str, shadow: &Shadow, options: MeshOptions, tolerance: f32) -> (f64, usize) {
    let mesh = shadow.mesh(options);
    sanity_check(&mesh);
    let name = format!("{name} {:?} within {tolerance}", shadow.bounds());
    let stated = mesh.error_levels();
    assert!(
        mesh.is_complete() && stated <= f64::from(tolerance),
        "{name}: {stated}"
    );
    let error = dense_error(shadow, &mesh, 4);
    assert!(
        error <= f64::from(tolerance),
        "{name}: {error}, stated {stated}"
    );
    (error, mesh.triangles().count())
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
            .map(|vertex| f64::from(vertex.density));
        let top = worst(top);
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
    assert_eq!(mesh.incomplete(), Some(Incomplete::Vertices));
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

#[test]
fn slivers_along_a_ring_do_not_use_up_the_rounds() {
    // Seven teeth and no umbra: along its back density goes up and down by some levels beside a long straight ring.
    let (tooth, pitch) = (3.7546444, 10.921373);
    let mut ring = vec![[0.0, -3.870_196]];
    for i in 0_u8..7 {
        let x = f32::from(i) * pitch;
        ring.extend([[x, 12.900653], [x + tooth, 12.900653]]);
        if i < 6 {
            ring.extend([[x + tooth, 0.0], [x + pitch, 0.0]]);
        }
    }
    ring.push([6.0 * pitch + tooth, -3.870_196]);
    let comb = Shape::polygon(&[ring], FillRule::NonZero).unwrap();
    let light = Light::directional([0.0, 0.0], 10.0).unwrap();
    keeps("comb", &light.cast(&comb, 1.0, 0.0).unwrap(), 2.0);
}

/// The error's crest runs along triangles between two teeth, eight penumbra radii long and a fifth of one wide, from row to row of the
/// samples that are taken there.
#[test]
fn crests_along_a_triangle_are_seen_between_samples() {
    let (tooth, pitch) = (17.20951, 22.808_008);
    let mut ring = vec![[0.0, -31.228783]];
    for i in 0_u8..6 {
        let x = f32::from(i) * pitch;
        ring.extend([[x, 104.09594], [x + tooth, 104.09594]]);
        if i < 5 {
            ring.extend([[x + tooth, 0.0], [x + pitch, 0.0]]);
        }
    }
    ring.push([5.0 * pitch + tooth, -31.228783]);
    let comb = Shape::polygon(&[ring], FillRule::NonZero).unwrap();
    let light = Light::directional([0.0, 0.0], 10.0).unwrap();
    keeps("comb", &light.cast(&comb, 1.0, 0.0).unwrap(), 0.5);
}

/// The same along a bar that is narrower than the penumbra.
#[test]
fn crests_along_a_bar_are_seen_between_samples() {
    let all = fixture_shadows();
    let (name, shadow) = all.iter().find(|(name, _)| name == "sliver-h").unwrap();
    for tolerance in TOLERANCES {
        keeps(name, shadow, tolerance);
    }
}

/// The club of a pack of cards, as an outline drawn along: it touches itself, where a vertex comes twice, a rounding error apart.
const CLUB: &str = "M8 1a3.25 3.25 0 0 0-3.25 3.25c0 .186 0 .29.016.41.014.12.045.27.12.527l.19.665-.692-.028a3.25 3.25 0 1 0 2.357 5.334.5.5 0 0 1 .844.518l\
    -.003.005-.006.015-.024.055a22 22 0 0 1-.438.92 22 22 0 0 1-1.266 2.197c-.013.018-.02.05.001.09q.016.029.03.036A.04.04 0 0 0 5.9 15h\
    4.2q.014 0 .022-.006a.1.1 0 0 0 .029-.035c.02-.04.014-.073.001-.091a23 23 0 0 1-1.704-3.117l-.024-.054-.006-.015-.002-.004a\
    .5.5 0 0 1 .838-.524c.601.7 1.516 1.168 2.496 1.168a3.25 3.25 0 1 0-.139-6.498l-.699.03.199-.671c.14-.47.14-.745.139-.927V4.25A3.25 3.25 0 0 0 8 1m2.207 12.024c\
    .225.405.487.848.78 1.294C11.437 15 10.975 16 10.1 16H5.9c-.876 0-1.338-1-.887-1.683.291-.442.552-.88.776-1.283a\
    4.25 4.25 0 1 1-2.007-8.187l-.009-.064c-.023-.187-.023-.348-.023-.52V4.25a4.25 4.25 0 0 1 8.5 0c0 .14 0 .333-.04.596a\
    4.25 4.25 0 0 1-.46 8.476 4.2 4.2 0 0 1-1.543-.298";

#[test]
fn a_vertex_that_comes_twice_is_one() {
    let path = penumbral::Path::from_svg(CLUB).unwrap();
    let club = Shape::path(&path, FillRule::NonZero)
        .unwrap()
        .transformed([1.5, 0.0, 0.0, 1.5, 0.0, 0.0])
        .unwrap();
    let light = Light::android(24.0).unwrap();
    for elevation in [0.5, 0.8] {
        let shadow = light.cast(&club, elevation, 0.0).unwrap();
        keeps("club", &shadow, 4.0);
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
    let worst = worst(densities.iter().enumerate().map(error));
    println!("{worst} levels, stated {}", mesh.error_levels());
    assert_eq!(mesh.incomplete(), Some(Incomplete::Narrow));
    assert!(worst <= mesh.error_levels(), "{worst}");
}

/// Cut into lines, its points miss the line by rounding errors: slivers of no area that a point could be in.
/// Rounding takes its part of the tolerance, and all that remains is kept; where nothing does the mesh says so, and how wrong it is.
#[test]
fn outlines_far_from_the_origin_keep_what_rounding_leaves() {
    let mut random = Lots(5);
    let [mut complete, mut narrow] = [0; 2];
    for _ in 0..150 {
        let far = 10_f32.powf(2.0 + 5.0 * random.next());
        let radius = 10_f32.powf(-1.0 + 3.0 * random.next());
        let tolerance = TOLERANCES[(random.next() * 4.99) as usize];
        let count = 3 + (random.next() * 5.0) as u8;
        let corner = |i: u8| {
            let angle = f32::from(i) * core::f32::consts::TAU / f32::from(count);
            [angle.cos(), angle.sin()].map(|v| v * (20.0 + 50.0 * random.next()))
        };
        let ring: Vec<[f32; 2]> = (0..count).map(corner).collect();
        let shape = Shape::polygon(&[ring], FillRule::NonZero).unwrap();
        let shape = shape.translated([far * random.next(), far]).unwrap();
        let light = Light::directional([0.0, 0.0], radius).unwrap();
        let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
        let mesh = shadow.mesh(levels(tolerance));
        match mesh.incomplete() {
            None => {
                complete += 1;
                sanity_check(&mesh);
                assert!(mesh.error_levels() <= f64::from(tolerance));
            }
            Some(reason) => {
                narrow += 1;
                assert_eq!(reason, Incomplete::Narrow, "{far}, r {radius}, {tolerance}");
            }
        }
        if mesh.error_levels() < 255.0 {
            let worst = sampled_error(&shadow, &mesh).0;
            // Of the samples' own places too.
            let rounding = f64::from(far * f32::EPSILON / radius) * 255.0;
            assert!(
                worst <= mesh.error_levels() + rounding,
                "{far}, r {radius}, {tolerance}: {worst} levels"
            );
        }
    }
    println!("{complete} complete, {narrow} not");
    assert!(complete > 50 && narrow > 20);
}

#[test]
fn a_curve_along_a_line_is_filled_with_nothing() {
    let mut path = penumbral::Path::new();
    path.move_to([14.0, 8.75]);
    path.cubic_to([0.0, 0.0], [0.0, 0.0], [0.0, 0.0]).close();
    let shape = Shape::path(&path, FillRule::NonZero).unwrap();
    let light = Light::directional([0.0, 0.0], 0.0).unwrap();
    let mesh = light.cast(&shape, 1.0, 0.0).unwrap().mesh(levels(4.0));
    assert!(mesh.is_complete());
    assert!(mass(&mesh).abs() < 1e-4, "{}", mass(&mesh));
}

/// What chords cut off of many arcs in one disc adds up in what meshes are measured against as well.
#[test]
fn crowds_of_dots_keep_their_tolerance() {
    let dots: Vec<Shape> = (0..100_u16)
        .map(|i| [3.0 * f32::from(i % 10), 3.0 * f32::from(i / 10)])
        .map(|center| Shape::circle(center, 1.0).unwrap())
        .collect();
    let light = Light::directional([0.0, 0.0], 12.0).unwrap();
    let shadow = light.cast_all(&dots, 1.0, 0.0).unwrap();
    let within = |tolerance: f32| MeshOptions::new(levels(tolerance));
    for (tolerance, options) in [
        (1.0, within(1.0)),
        (4.0, within(4.0)),
        (4.0, within(4.0).few()),
    ] {
        let mesh = shadow.mesh(options);
        assert!(mesh.is_complete());
        let error = dense_error(&shadow, &mesh, 8);
        println!("100 dots, {options:?}: {error:.3} levels");
        assert!(error <= tolerance, "{error} of {tolerance}");
    }
}

/// Strips along gentle convex curves: ellipses in every direction, superellipses and others whose curvature changes at once.
#[test]
fn gentle_convex_curves_keep_their_tolerance() {
    let mut lots = Lots(23);
    let mut worst: f64 = 0.0;
    for case in 0..60 {
        let [a, b] = [60.0 + 80.0 * lots.next(), 40.0 + 60.0 * lots.next()];
        let shape = match case % 3 {
            0 => Shape::ellipse([100.0, 90.0], [a, b]).unwrap(),
            1 => {
                // Each quarter one cubic, from a circle's to a card's.
                let k = 0.5 + 0.35 * lots.next();
                let mut path = penumbral::Path::new();
                path.move_to([a, 0.0])
                    .cubic_to([a, k * b], [k * a, b], [0.0, b])
                    .cubic_to([-k * a, b], [-a, k * b], [-a, 0.0])
                    .cubic_to([-a, -k * b], [-k * a, -b], [0.0, -b])
                    .cubic_to([k * a, -b], [a, -k * b], [a, 0.0])
                    .close();
                Shape::path(&path, FillRule::NonZero).unwrap()
            }
            _ => {
                // A bar with ends of two circles.
                let [r, s] = [30.0 + 20.0 * lots.next(), 30.0 + 20.0 * lots.next()];
                let mut path = penumbral::Path::new();
                path.move_to([-a, -r])
                    .arc_to([r; 2], 0.0, false, false, [-a, r])
                    .cubic_to([-a / 3.0, r], [a / 3.0, s], [a, s])
                    .arc_to([s; 2], 0.0, false, false, [a, -s])
                    .cubic_to([a / 3.0, -s], [-a / 3.0, -r], [-a, -r])
                    .close();
                Shape::path(&path, FillRule::NonZero).unwrap()
            }
        };
        let (sin, cos) = (6.3 * lots.next()).sin_cos();
        let shape = shape.transformed([cos, sin, -sin, cos, 0.0, 0.0]).unwrap();
        let light = Light::directional([0.0, 0.0], 2.0 + 14.0 * lots.next()).unwrap();
        let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
        let tolerance = TOLERANCES[case / 3 % TOLERANCES.len()];
        let mesh = shadow.mesh(levels(tolerance));
        sanity_check(&mesh);
        let said = mesh.error_levels();
        assert!(mesh.is_complete() && said <= f64::from(tolerance), "{case}");
        let error = dense_error(&shadow, &mesh, 8);
        assert!(
            error <= f64::from(tolerance),
            "{case}: {error} of {tolerance}"
        );
        worst = worst.max(error / f64::from(tolerance));
    }
    println!("60 gentle curves: at most {worst:.3} of the tolerance");
}

#[test]
fn strips_along_an_ellipse_have_about_as_few_triangles_as_are_found() {
    let ellipse = Shape::ellipse([100.0, 100.0], [80.0, 50.0]).unwrap();
    for (radius, most) in [(3.0, 2_250), (10.8, 1_400)] {
        let light = Light::directional([0.0, 0.0], radius).unwrap();
        let shadow = light.cast(&ellipse, 1.0, 0.0).unwrap();
        let count = |options: MeshOptions| shadow.mesh(options).indices().len() / 3;
        let options = MeshOptions::new(levels(1.0));
        let (usual, few) = (count(options), count(options.few()));
        println!("ellipse, r {radius}: {usual} triangles, {few} where few are asked for");
        assert!(usual <= most && few <= usual && 10 * usual <= 11 * few);
    }
}
