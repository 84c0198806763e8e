//! How many triangles meshes have, next to the fewest that a long search finds.
//!
//! The search knows nothing of how meshes are made: it has densities on a fine lattice, begins with triangles of several kinds and
//! takes away what it can. What it finds is within the tolerance as meshes have to be.

mod field;
mod search;

use std::time::Instant;

use field::{Corner, Field};
use glam::DVec2;
use penumbral::{FillRule, Light, MeshOptions, MeshVertex, Path, Shadow, Shape};
use search::Search;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::checks::*;

/// The part of the tolerance that the search uses up: between its samples errors are a little larger.
const SAMPLED: f64 = 0.96;

/// The part of the tolerance within which the meshes are that it begins with.
const FINER: f32 = 0.9;

/// From which tolerance on it begins with a lattice as well, of so many sides a penumbra radius.
const COARSE: f32 = 4.0;
const PARTS: f64 = 5.0;

/// How far the frame is outside of the lattice, in samples.
const FRAME: f64 = 64.0;

fn shapes() -> Vec<(&'static str, Shape, [f32; 2])> {
    let path = |data: &str, rule| Shape::path(&Path::from_svg(data).unwrap(), rule).unwrap();
    let star: Vec<[f32; 2]> = (0_u8..10)
        .map(|i| {
            let (sin, cos) = (f32::from(i) * core::f32::consts::PI / 5.0).sin_cos();
            let radius = if i % 2 == 0 { 6.0 } else { 2.4 };
            [radius * sin, -radius * cos]
        })
        .collect();
    let nonzero = FillRule::NonZero;
    let ring = "M0 5A5 5 0 0 0 10 5A5 5 0 0 0 0 5M2 5A3 3 0 0 0 8 5A3 3 0 0 0 2 5";
    let heart =
        "M5 9.2C.2 6 -.6 3.2 .6 1.8C2 .2 4.2 .8 5 2.6C5.8 .8 8 .2 9.4 1.8C10.6 3.2 9.8 6 5 9.2Z";
    let check = "M.4 5A1 1 0 0 1 1.8 3.6L4.5 6.3L10.2 .6A1 1 0 0 1 11.6 2L4.5 9.1Z";
    vec![
        ("triangle", path("M0 0H10L4 8Z", nonzero), [1.2, 4.0]),
        ("L", path("M0 0H10V3H3V10H0Z", nonzero), [0.8, 3.0]),
        (
            "star",
            Shape::polygon(&[star], nonzero).unwrap(),
            [1.0, 4.0],
        ),
        ("heart", path(heart, nonzero), [1.2, 5.0]),
        (
            "circle",
            Shape::circle([3.0, 3.0], 3.0).unwrap(),
            [3.6, 8.0],
        ),
        ("ring", path(ring, FillRule::EvenOdd), [0.6, 2.5]),
        ("check", path(check, nonzero), [0.6, 2.5]),
    ]
}

fn few(tolerance: f32) -> MeshOptions {
    MeshOptions::new(levels(tolerance)).few()
}

fn cast(shape: &Shape, radius: f32) -> Shadow {
    let light = Light::directional([0.0, 0.0], radius).unwrap();
    light.cast(shape, 1.0, 0.0).unwrap()
}

/// Triangles of the whole plane: points by Delaunay's rule with sides that are there, within a frame.
fn begin<'a>(field: &'a Field, limit: f64, points: &[Corner], sides: &[[usize; 2]]) -> Search<'a> {
    let end = field.end() + FRAME;
    let frame = [
        [-FRAME, -FRAME],
        [end.x, -FRAME],
        [end.x, end.y],
        [-FRAME, end.y],
    ];
    let frame = frame.map(|at| (DVec2::from(at), 0.0));
    let mut faces = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut corners: Vec<Corner> = Vec::new();
    let handles: Vec<_> = frame
        .iter()
        .chain(points)
        .map(|&(at, density)| {
            let handle = faces.insert(Point2::new(at.x, at.y)).unwrap();
            if handle.index() == corners.len() {
                corners.push((at, density));
            }
            handle
        })
        .collect();
    for side in sides {
        let [from, to] = side.map(|i| handles[i + frame.len()]);
        if from != to {
            faces.try_add_constraint(from, to);
        }
    }
    let triangles: Vec<[usize; 3]> = faces
        .inner_faces()
        .map(|face| face.vertices().map(|v| v.fix().index()))
        .collect();
    Search::new(field, limit, &corners, frame.len(), &triangles)
}

/// A mesh that is made with some options.
fn begin_with_mesh<'a>(
    field: &'a Field,
    limit: f64,
    shadow: &Shadow,
    options: MeshOptions,
) -> Search<'a> {
    let mesh = shadow.mesh(options);
    let corner = |v: &MeshVertex| {
        let at = DVec2::from(v.position.map(f64::from));
        (field.to_samples(at), f64::from(v.density))
    };
    let points: Vec<Corner> = mesh.vertices().iter().map(corner).collect();
    let sides: Vec<[usize; 2]> = mesh
        .indices()
        .chunks(3)
        .map(|c| [0, 1, 2].map(|i: usize| c[i] as usize))
        .flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]])
        .collect();
    begin(field, limit, &points, &sides)
}

/// Equilateral triangles.
fn begin_with_lattice(field: &Field, limit: f64) -> Search<'_> {
    let side = field::STEP / PARTS;
    let height = side * 0.75_f64.sqrt();
    let end = field.end();
    let mut points = Vec::new();
    let mut row = 0;
    while f64::from(row) * height <= end.y {
        let y = f64::from(row) * height;
        let mut x = if row % 2 == 0 { 0.0 } else { side / 2.0 };
        while x <= end.x {
            let density = field.at(DVec2::new(x, y)).clamp(0.0, 1.0);
            let outside = density < 0.3 * limit;
            points.push((DVec2::new(x, y), if outside { 0.0 } else { density }));
            x += side;
        }
        row += 1;
    }
    begin(field, limit, &points, &[])
}

/// The largest error of what the search found, in levels.
fn error_of(search: &Search<'_>, field: &Field, shadow: &Shadow) -> f64 {
    let vertex = |(at, density): Corner| MeshVertex {
        position: field.to_scene(at).as_vec2().to_array(),
        density: density as f32,
    };
    dense_error_of(shadow, search.drawn().map(|corners| corners.map(vertex)), 8)
}

/// The fewest triangles that the search finds within the tolerance, from all it begins with.
fn fewest(shadow: &Shadow, tolerance: f32, rounds: usize) -> usize {
    let field = Field::new(shadow);
    let limit = SAMPLED * f64::from(tolerance) / 255.0;
    let few = few(FINER * tolerance);
    let mut starts = vec![
        begin_with_mesh(&field, limit, shadow, few),
        begin_with_mesh(&field, limit, shadow, few.quick()),
    ];
    // At finer tolerances a lattice has so many triangles that thinning it takes minutes: it came out no better.
    if tolerance >= COARSE {
        starts.push(begin_with_lattice(&field, limit));
    }
    let mut lots = Lots(3);
    let mut best = usize::MAX;
    for mut search in starts {
        let first = search.count();
        search.thin(&mut lots);
        let thinned = search.count();
        search.improve(rounds, &mut lots);
        let (count, error) = (search.count(), error_of(&search, &field, shadow));
        println!("    {first} thinned to {thinned}, improved to {count}, {error:.3} levels off");
        if error <= f64::from(tolerance) {
            best = best.min(count);
        }
    }
    best
}

/// The fewest triangles that searches have found so far, within a tolerance in levels.
const FOUND: [(&str, f32, f32, usize); 10] = [
    ("triangle", 1.2, 1.0, 328),
    ("L", 0.8, 1.0, 646),
    ("star", 1.0, 1.0, 997),
    ("heart", 1.2, 1.0, 871),
    ("heart", 5.0, 1.0, 293),
    ("circle", 3.6, 1.0, 270),
    ("circle", 8.0, 1.0, 84),
    ("ring", 0.6, 1.0, 2062),
    ("ring", 2.5, 1.0, 668),
    ("ring", 0.6, 4.0, 485),
];

/// How many times as many meshes may have.
const TIMES: f64 = 1.5;

/// So many of these first, which are left to refinement, keep that without being asked for few.
const USUAL: usize = 3;

#[test]
fn meshes_have_at_most_so_many_times_the_fewest_triangles() {
    let shapes = shapes();
    for (name, radius, tolerance, found) in FOUND {
        let (_, shape, _) = shapes.iter().find(|(other, ..)| *other == name).unwrap();
        let shadow = cast(shape, radius);
        let mesh = shadow.mesh(few(tolerance));
        sanity_check(&mesh);
        assert!(
            dense_error(&shadow, &mesh, 6) <= f64::from(tolerance),
            "{name} at r {radius}"
        );
        let times = mesh.triangles().count() as f64 / found as f64;
        println!("{name} at r {radius} within {tolerance}: {times:.2} times the {found} found");
        assert!(times <= TIMES, "{name}: {times}");
    }
    for (name, radius, tolerance, found) in &FOUND[..USUAL] {
        let (_, shape, _) = shapes.iter().find(|(other, ..)| other == name).unwrap();
        let mesh = cast(shape, *radius).mesh(levels(*tolerance));
        let times = mesh.triangles().count() as f64 / *found as f64;
        println!("{name} at r {radius}, as usual: {times:.2} times");
        assert!(times <= TIMES, "{name}: {times}");
    }
}

/// By `cargo test --release --all-features --test mesh fewest -- --ignored --nocapture`; `PENUMBRAL_SHAPE=L` takes one shape,
/// `PENUMBRAL_ROUNDS` sets for how long each is improved.
#[test]
#[ignore = "an hour"]
fn a_search_finds_meshes_of_fewer_triangles() {
    let variable = |name: &str| std::env::var(name).ok();
    let rounds = variable("PENUMBRAL_ROUNDS").map_or(20, |rounds| rounds.parse().unwrap());
    let only = variable("PENUMBRAL_SHAPE");
    for (name, shape, radii) in shapes() {
        if only.as_ref().is_some_and(|only| only != name) {
            continue;
        }
        for radius in radii {
            let shadow = cast(&shape, radius);
            for tolerance in [4.0_f32, 1.0] {
                let start = Instant::now();
                let ours = shadow.mesh(few(tolerance)).triangles().count();
                let best = fewest(&shadow, tolerance, rounds);
                println!(
                    "{name} at r {radius} within {tolerance}: {ours} triangles, {best} found in {:.0} s, {:.2} times as many",
                    start.elapsed().as_secs_f64(),
                    ours as f64 / best as f64
                );
                assert!(best <= ours, "the search went astray");
            }
        }
    }
}
