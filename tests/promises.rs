//! What holds of every shadow, over random cases: how wrong densities may be, their range and sum, the symmetries of outlines,
//! and that nothing jumps.
//!
//! Each test takes as many cases as `PENUMBRAL_CASES` says from seed `PENUMBRAL_SEED` on. A million in all:
//!
//!     PENUMBRAL_SEED=1000000 PENUMBRAL_CASES=125000 cargo test --release --all-features --test promises -- --nocapture

#![expect(clippy::unwrap_used, reason = "a case that is refused fails the test")]

#[expect(dead_code, reason = "other tests take more of it")]
mod common;

use common::drawn::Drawn;
use common::{Case, Random, Summary, bits, by, case, densities, radius, shapes};
use penumbral::plan::Method;
use penumbral::{Grid, Light, Scratch, Shadow, Shape};

/// The plan's choice, and each method by force.
const METHODS: [Option<Method>; 4] = [
    None,
    Some(Method::Direct),
    Some(Method::Grid),
    Some(Method::NinePatch),
];

/// How wrong `exact` may be, over 255: curves are lines to it.
const CURVED: f64 = 0.02 / 255.0;

/// The seeds of a test's cases, each with a source of its own for what is asked of the case.
fn seeds(what: &str, count: usize) -> impl Iterator<Item = (usize, Random)> {
    common::seeds(what, count).map(|seed| (seed, Random::new(!(seed as u64))))
}

/// A part of a case's pixels, and the centre of the first of them.
fn window(case: &Case, size: [u32; 2], random: &mut Random) -> (Grid, [f32; 2]) {
    let all = [case.grid.width(), case.grid.height()];
    let per_unit = case.grid.pixels_per_unit() as f32;
    let first = all.map(|count| random.below(count as usize) as f32 / per_unit);
    let grid = Grid::new(first, size, per_unit).unwrap();
    (grid, first.map(|v| v + 0.5 / per_unit))
}

/// A point on 64ths of a unit.
fn point(random: &mut Random, side: f32) -> [f32; 2] {
    [0; 2].map(|_| (64.0 * random.between(-0.2, 1.2) * side).round() / 64.0)
}

fn cast(light: Light, shapes: &[Shape]) -> Shadow {
    light.cast_all(shapes, 1.0, 0.0).unwrap()
}

fn directional(radius: f32) -> Light {
    Light::directional([0.0, 0.0], radius).unwrap()
}

/// Whether an outline has nothing but lines.
fn is_straight(name: &str) -> bool {
    name.contains("polygon") || name == "star"
}

#[test]
fn densities_are_fractions_and_as_right_as_they_are_to_be() {
    let (mut scratch, mut summary) = (Scratch::new(), Summary::default());
    for (seed, mut random) in seeds("error and range", 250) {
        let case = case(seed);
        let label = case.label(seed);
        let averaged = case.radius < 3.0;
        let (grid, center) = window(&case, if averaged { [6, 2] } else { [20, 3] }, &mut random);
        let exact = densities(&case.shadow, &grid, &by(Some(Method::Exact)), &mut scratch);
        for method in METHODS {
            let drawn = densities(&case.shadow, &grid, &by(method), &mut scratch);
            assert!(
                drawn.iter().all(|density| (0.0..=1.0).contains(density)),
                "{method:?}: {label}"
            );
            let name = method.map_or("auto".to_owned(), |method| method.to_string());
            let allowed = if averaged { 1.12 } else { 1.0 };
            summary.add(name, common::worst_of(&drawn, &exact), allowed, &label);
        }
        if !averaged {
            let error = (case.shadow.density_at(center) - f64::from(exact[0])).abs() * 255.0;
            summary.add("at a point".to_owned(), error as f32, 0.05, &label);
        }
    }
    summary.finish();
}

/// The sum of densities is the outline's area, whatever the penumbra.
///
/// Where pixels are samples, the sum over one lattice is off by what an edge's profile has at the lattice's frequency, up to
/// 0.25 level about r = 2 px: it is taken over four lattices half a pixel apart, which leave no more than `exact` may be wrong.
#[test]
fn mass_is_the_area_of_the_outline() {
    let (mut scratch, mut summary) = (Scratch::new(), Summary::default());
    for (seed, mut random) in seeds("mass", 60) {
        let (name, shapes, lengths) = shapes(&mut random, 64.0);
        let radius = radius(&mut random, &lengths).min(24.0);
        // Arcs lead far out of the square that their ends are in: only the bounds hold all of them.
        let Some(bounds) = cast(directional(radius), &shapes).bounds() else {
            continue;
        };
        let first = bounds.min.map(|v| v.floor() - 1.0);
        let size = [0, 1].map(|axis: usize| (bounds.max[axis] - first[axis]).ceil() as u32 + 1);
        let mut sum = |radius: f32, method| {
            let shadow = cast(directional(radius), &shapes);
            let lattices = [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5], [0.5, 0.5]];
            let drawn: Vec<f32> = lattices
                .iter()
                .flat_map(|phase| {
                    let first = [0, 1].map(|axis| first[axis] + phase[axis]);
                    let grid = Grid::new(first, size, 1.0).unwrap();
                    densities(&shadow, &grid, &by(method), &mut scratch)
                })
                .collect();
            let shaded = drawn.iter().filter(|density| **density > 0.0).count();
            let mass: f64 = drawn.iter().copied().map(f64::from).sum();
            (mass, shaded)
        };
        let (area, _) = sum(0.0, Some(Method::Exact));
        let label = format!("seed {seed}, {name} at r {radius} px");
        for (what, method, allowed) in [("auto", None, 1.0), ("exact", Some(Method::Exact), 0.12)] {
            let (mass, shaded) = sum(radius, method);
            let error = (mass - area).abs() * 255.0 / (shaded.max(1) as f64);
            summary.add(format!("mass, {what}"), error as f32, allowed, &label);
        }
    }
    summary.finish();
}

/// A contour has neither a beginning nor a direction: the same bits at points and on pixels by every method where it has lines
/// alone, all but the last digits where it has curves.
#[test]
fn direction_and_start_of_a_path_do_not_matter() {
    let mut scratch = Scratch::new();
    for (seed, mut random) in seeds("direction and start", 120) {
        is_the_same_any_way(seed, &mut random, &mut scratch);
    }
}

/// A curve out and back on a line once left slivers, other ones from its end, and one of them a vertex on a side that it crosses:
/// the two parts of the side were drawn otherwise than the whole.
#[test]
fn a_curve_that_comes_back_on_itself_leaves_nothing() {
    let seed = 6_003_605;
    is_the_same_any_way(seed, &mut Random::new(!(seed as u64)), &mut Scratch::new());
}

fn is_the_same_any_way(seed: usize, random: &mut Random, scratch: &mut Scratch) {
    let straight = random.chance(0.5);
    let drawn = Drawn::random(random, 24.0, !straight);
    let Some(shape) = drawn.shape() else {
        return;
    };
    let radius = radius(random, &[1.0, 6.0, 12.0]).min(30.0);
    let shadow = cast(directional(radius), &[shape]);
    let point = point(random, 24.0);
    let method = METHODS[random.below(4)];
    let grid = Grid::new([-3.0, random.below(24) as f32], [30, 2], 1.0).unwrap();
    let pixels = densities(&shadow, &grid, &by(method), scratch);
    let start = 1 + random.below(7);
    for other in [
        drawn.reversed(),
        drawn.started_at(start),
        drawn.reversed().started_at(start),
    ] {
        let other = cast(directional(radius), &[other.shape().unwrap()]);
        let label = format!("seed {seed}, {method:?}, r {radius}: {drawn:?}");
        let (here, there) = (shadow.density_at(point), other.density_at(point));
        let others = densities(&other, &grid, &by(method), scratch);
        let worst = common::worst_of(&pixels, &others);
        if straight {
            assert_eq!(here.to_bits(), there.to_bits(), "{here} {there}: {label}");
            assert!(bits(&pixels) == bits(&others), "{worst} levels: {label}");
        } else {
            // The points of a curve are computed from where it begins.
            assert!((here - there).abs() < 1e-12, "{here} {there}: {label}");
            assert!(worst < 2e-3, "{worst} levels: {label}");
        }
    }
}

#[test]
fn mirrored_turned_and_moved_shadows_are_the_same() {
    for (seed, mut random) in seeds("mirror, quarter turn, fractions", 1500) {
        let (name, shapes, lengths) = shapes(&mut random, 64.0);
        let radius = radius(&mut random, &lengths);
        let light = directional(radius);
        let point = point(&mut random, 64.0);
        let density = cast(light, &shapes).density_at(point);
        let fraction = [0; 2].map(|_| random.below(64) as f32 / 64.0);
        for affine in [
            [-1.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            [0.0, 1.0, -1.0, 0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0, 1.0, fraction[0], fraction[1]],
        ] {
            let [a, b, c, d, e, f] = affine;
            let mapped = shapes
                .iter()
                .map(|shape| shape.transformed(affine).unwrap());
            let mapped: Vec<Shape> = mapped.collect();
            let [x, y] = point;
            let there = cast(light, &mapped).density_at([a * x + c * y + e, b * x + d * y + f]);
            let allowed = if is_straight(name) { 1e-9 } else { CURVED };
            assert!(
                (there - density).abs() <= allowed,
                "{there} {density}: seed {seed}, {name} at r {radius} px, {affine:?}, {point:?}"
            );
        }
    }
}

/// The next numbers change next to nothing, at radii where something special happens too: nothing jumps.
#[test]
fn nothing_jumps() {
    let mut scratch = Scratch::new();
    let mut worst: f32 = 0.0;
    for (seed, mut random) in seeds("continuity", 700) {
        let (name, shapes, lengths) = shapes(&mut random, 64.0);
        let radius = radius(&mut random, &lengths).max(0.01);
        let (z, elevation) = (600.0, random.pick(&[8.0, 3.5, 24.0]));
        // A light with that penumbra radius on the ground.
        let size = radius * (z - elevation) / elevation;
        let light = [32.0, -10.0, z];
        let seen = |light: [f32; 3], size: f32, elevation: f32, shapes: &[Shape]| {
            let light = Light::new(light, size).unwrap();
            light.cast_all(shapes, elevation, 0.0).unwrap()
        };
        let larger: Vec<Shape> = shapes
            .iter()
            .map(|shape| {
                let more = 1.0_f32.next_up();
                shape.transformed([more, 0.0, 0.0, more, 0.0, 0.0]).unwrap()
            })
            .collect();
        let here = seen(light, size, elevation, &shapes);
        let others = [
            seen(light, size.next_up(), elevation, &shapes),
            seen(light, size, elevation.next_up(), &shapes),
            seen(
                [light[0].next_up(), light[1], light[2]],
                size,
                elevation,
                &shapes,
            ),
            seen(
                [light[0], light[1], light[2].next_up()],
                size,
                elevation,
                &shapes,
            ),
            seen(light, size, elevation, &larger),
        ];
        let label = format!("seed {seed}, {name} at r {radius} px");
        let point = point(&mut random, 64.0);
        let density = here.density_at(point);
        let first = [random.below(64) as f32, random.below(64) as f32];
        let size = if radius < 3.0 { [3, 2] } else { [16, 2] };
        let grid = Grid::new(first, size, 1.0).unwrap();
        let pixels = densities(&here, &grid, &by(None), &mut scratch);
        // One part in 2^23 of 64 px moves an edge by 1e-5 px, and 8 edges within reach by that share of the radius.
        let moved = 1e-4 / f64::from(radius).min(64.0);
        for (index, other) in others.iter().enumerate() {
            let change = (other.density_at(point) - density).abs();
            let allowed = moved + if is_straight(name) { 0.0 } else { 2.0 * CURVED };
            assert!(
                change <= allowed,
                "{change} > {allowed}, {index}: {label}, {point:?}"
            );
            let others = densities(other, &grid, &by(None), &mut scratch);
            let change = common::worst_of(&pixels, &others);
            worst = worst.max(change);
            // Each may be a level wrong.
            let allowed = 2.0 + 255.0 * allowed as f32;
            assert!(
                change <= allowed,
                "pixels, {change} levels, {index}: {label}"
            );
        }
    }
    println!("continuity: pixels change by {worst} levels at most");
}

/// One outline drawn in several ways, with corners that turn by nothing, a spike, two halves or a slit.
#[test]
fn convex_and_concave_paths_of_one_outline_are_the_same() {
    let (mut scratch, mut summary) = (Scratch::new(), Summary::default());
    for (seed, mut random) in seeds("paths of one outline", 250) {
        let quarter = |random: &mut Random, most: usize| (1 + random.below(most)) as f32 / 4.0;
        let (x, y) = (quarter(&mut random, 40), quarter(&mut random, 40));
        let (w, h) = (
            0.5 + quarter(&mut random, 160),
            0.5 + quarter(&mut random, 160),
        );
        let (mx, my) = (x + (w * 2.0).floor() / 4.0, y + (h * 2.0).floor() / 4.0);
        let (right, bottom) = (x + w, y + h);
        let polygon =
            |ring: &[[f32; 2]]| Shape::polygon(&[ring], penumbral::FillRule::NonZero).unwrap();
        let half = |left: f32, right: f32| {
            polygon(&[[left, y], [right, y], [right, bottom], [left, bottom]])
        };
        let corners = [[x, y], [right, y], [right, bottom], [x, bottom]];
        let ways = [
            vec![polygon(&corners)],
            vec![polygon(&[
                corners[0],
                [mx, y],
                corners[1],
                [right, my],
                corners[2],
                corners[2],
                corners[3],
            ])],
            // A spike inwards and one outwards.
            vec![polygon(&[
                corners[0],
                [mx, y],
                [mx, my],
                [mx, y],
                corners[1],
                corners[2],
                [mx, bottom],
                [mx, bottom + 3.0],
                [mx, bottom],
                corners[3],
            ])],
            vec![half(x, mx), half(mx, right)],
            // Two halves joined by a slit of no width.
            vec![polygon(&[
                corners[0],
                [mx, y],
                [mx, my],
                [mx, bottom],
                corners[3],
                corners[0],
                [mx, y],
                corners[1],
                corners[2],
                [mx, bottom],
                [mx, y],
            ])],
        ];
        let radius = radius(&mut random, &[w / 2.0, h / 2.0, w, 2.0]).min(60.0);
        let plain = cast(directional(radius), &[Shape::rect(x, y, w, h).unwrap()]);
        let point = point(&mut random, 50.0);
        let density = plain.density_at(point);
        let first = [random.below(50) as f32, random.below(50) as f32];
        let size = if radius < 3.0 { [4, 1] } else { [20, 2] };
        let grid = Grid::new(first, size, 1.0).unwrap();
        let exact = densities(&plain, &grid, &by(Some(Method::Exact)), &mut scratch);
        for (way, shapes) in ways.iter().enumerate() {
            let label = format!("seed {seed}, way {way}, [{x}, {y}, {w}, {h}] at r {radius} px");
            let shadow = cast(directional(radius), shapes);
            let there = shadow.density_at(point);
            assert!(
                (there - density).abs() <= 1e-9,
                "{there} {density}: {label}, {point:?}"
            );
            let drawn = densities(&shadow, &grid, &by(None), &mut scratch);
            let allowed = if radius < 3.0 { 1.12 } else { 1.0 };
            let error = common::worst_of(&drawn, &exact);
            summary.add(format!("way {way}"), error, allowed, &label);
        }
    }
    summary.finish();
}
