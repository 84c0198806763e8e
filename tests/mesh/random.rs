//! Random outlines: stars, crossings, holes, combs, needles, slivers and curves, from a tenth of the penumbra radius to
//! twenty times as large.

use core::f32::consts::TAU;
use core::ops::Range;

use penumbral::{FillRule, Light, MeshOptions, Path, Shadow, Shape};

use crate::checks::*;
use crate::common::{snapped, worst};

/// The penumbra radius of all of them.
const RADIUS: f32 = 10.0;

#[test]
fn random_outlines_keep_their_tolerance() {
    random_outlines(0..16);
    // A needle along which density has tops near to each other.
    random_outlines(5_196..5_197);
}

/// By `cargo test --release --all-features --test mesh thousand -- --ignored --nocapture`; `PENUMBRAL_OUTLINES=460..470` takes
/// ten of them.
#[test]
#[ignore = "minutes"]
fn a_thousand_random_outlines_keep_their_tolerance() {
    random_outlines(range_or(0..1_000));
}

/// The outlines that `PENUMBRAL_OUTLINES` names.
fn range_or(all: Range<u32>) -> Range<u32> {
    std::env::var("PENUMBRAL_OUTLINES").map_or(all, |range| {
        let (first, end) = range.split_once("..").unwrap();
        first.parse().unwrap()..end.parse().unwrap()
    })
}

fn random_outlines(range: Range<u32>) {
    let mut lots = Lots(11);
    let mut worst = [0.0_f64; TOLERANCES.len()];
    for index in 0..range.end {
        let (name, shape) = outline(index % 8, &mut lots);
        if index < range.start {
            continue;
        }
        let name = format!("{name}, number {index}");
        let place = (index as usize + index as usize / 8) % TOLERANCES.len();
        let shadow = cast(&shape);
        let error = error_of(&name, &[shape], &shadow, TOLERANCES[place]);
        worst[place] = worst[place].max(error);
    }
    println!("Random outlines {range:?}: at most {worst:.3?} of {TOLERANCES:?} levels");
}

#[test]
fn snapped_outlines_keep_their_tolerance() {
    snapped_outlines(0..4);
}

/// By `cargo test --release --all-features --test mesh hundred_snapped -- --ignored --nocapture`; `PENUMBRAL_OUTLINES` as above.
#[test]
#[ignore = "minutes"]
fn two_hundred_snapped_outlines_keep_their_tolerance() {
    snapped_outlines(range_or(0..200));
}

fn snapped_outlines(range: Range<u32>) {
    let mut worst = 0.0_f64;
    for index in range.clone() {
        let case = snapped(index as usize);
        if case.shadow.bounds().is_some() {
            let tolerance = TOLERANCES[index as usize % TOLERANCES.len()];
            let name = case.label(index as usize);
            worst = worst.max(error_of(&name, &case.shapes, &case.shadow, tolerance));
        }
    }
    println!("Snapped outlines {range:?}: at most {worst:.3} of the tolerance");
}

/// The largest error over the tolerance of the three kinds of meshes, whose promises are asserted.
fn error_of(name: &str, shapes: &[Shape], shadow: &Shadow, tolerance: f32) -> f64 {
    // A nearly hard shadow has the outline's area as its mass, and so has every other.
    let hard = Light::directional([0.0, 0.0], 0.02).unwrap();
    let hard = mass(&hard.cast_all(shapes, 1.0, 0.0).unwrap().mesh(levels(4.0)));
    let options = MeshOptions::new(levels(tolerance));
    let tolerance = f64::from(tolerance);
    let ways = [
        ("usual", options),
        ("quick", options.quick()),
        ("few", options.few()),
    ];
    let errors = ways.map(|(way, options)| {
        let name = format!("{name}, {way}");
        let mesh = shadow.mesh(options);
        sanity_check(&mesh);
        let said = mesh.error_levels();
        assert!(
            mesh.is_complete() && said <= tolerance,
            "{name} within {tolerance}: {said}"
        );
        let error = dense_error(shadow, &mesh, 8);
        assert!(
            error <= tolerance,
            "{name} within {tolerance}: {error}, said to be {said}"
        );
        let slack = tolerance / 255.0 * area(&mesh) + 1e-3 * hard;
        let missing = mass(&mesh) - hard;
        assert!(missing.abs() <= slack, "{name}: mass off by {missing}");
        error / tolerance
    });
    worst(errors)
}

fn cast(shape: &Shape) -> Shadow {
    let light = Light::directional([0.0, 0.0], RADIUS).unwrap();
    light.cast(shape, 1.0, 0.0).unwrap()
}

/// An outline of one of eight kinds.
fn outline(kind: u32, lots: &mut Lots) -> (&'static str, Shape) {
    // As often small as large.
    let size = RADIUS * 0.1 * 200.0_f32.powf(lots.next());
    let polygon = |rings: &[Vec<[f32; 2]>], rule: FillRule| Shape::polygon(rings, rule).unwrap();
    match kind {
        0 => ("star", polygon(&[star(size, lots)], FillRule::NonZero)),
        1 => {
            let count = 4 + (lots.next() * 5.0) as usize;
            let ring = (0..count).map(|_| [lots.next() * size, lots.next() * size]);
            let ring: Vec<_> = ring.collect();
            let rule = match lots.next() < 0.5 {
                true => FillRule::NonZero,
                false => FillRule::EvenOdd,
            };
            ("crossings", polygon(&[ring], rule))
        }
        2 => {
            let outer = star(size, lots);
            let share = 0.2 + 0.7 * lots.next();
            let inner = outer.iter().map(|p| p.map(|v| v * share)).collect();
            ("hole", polygon(&[outer, inner], FillRule::EvenOdd))
        }
        3 => ("comb", polygon(&[comb(size, lots)], FillRule::NonZero)),
        4 => {
            // A tip of about one degree.
            let width = size * 3.0 * (0.012 + 0.01 * lots.next());
            let ring = vec![[0.0, 0.0], [size * 3.0, -width], [size * 3.0, width * 0.5]];
            ("needle", polygon(&[ring], FillRule::NonZero))
        }
        5 => {
            let thin = RADIUS * (0.01 + 0.2 * lots.next());
            let ring = vec![
                [0.0, 0.0],
                [size * 3.0, size * 0.7],
                [size * 3.0, size * 0.7 + thin],
            ];
            ("sliver", polygon(&[ring], FillRule::NonZero))
        }
        6 => (
            "curves",
            Shape::path(&curves(size, lots), FillRule::NonZero).unwrap(),
        ),
        _ => {
            let radii = [size, size * (0.05 + 0.9 * lots.next())];
            ("ellipse", Shape::ellipse([0.0, 0.0], radii).unwrap())
        }
    }
}

/// Corners at growing angles and any distances.
fn star(size: f32, lots: &mut Lots) -> Vec<[f32; 2]> {
    let count = 3 + (lots.next() * 9.0) as usize;
    let corner = |i: usize| {
        let (sin, cos) = (i as f32 * TAU / count as f32).sin_cos();
        let distance = size * (0.25 + 0.75 * lots.next());
        [distance * cos, distance * sin]
    };
    (0..count).map(corner).collect()
}

/// A comb of up to eight teeth, its gaps narrower than the penumbra radius.
fn comb(size: f32, lots: &mut Lots) -> Vec<[f32; 2]> {
    let teeth = 2 + (lots.next() * 7.0) as usize;
    let gap = RADIUS * (0.1 + 0.8 * lots.next());
    let tooth = size * (0.1 + 0.2 * lots.next());
    let mut ring = vec![[0.0, -size * 0.3]];
    for i in 0..teeth {
        let x = i as f32 * (gap + tooth);
        ring.extend([[x, size], [x + tooth, size]]);
        if i + 1 < teeth {
            ring.extend([[x + tooth, 0.0], [x + tooth + gap, 0.0]]);
        }
    }
    ring.push([(teeth - 1) as f32 * (gap + tooth) + tooth, -size * 0.3]);
    ring
}

/// A closed path of cubic curves.
fn curves(size: f32, lots: &mut Lots) -> Path {
    let mut path = Path::new();
    let count = 2 + (lots.next() * 4.0) as usize;
    let mut point = || [0, 1].map(|_| size * (lots.next() - 0.5));
    path.move_to(point());
    for _ in 0..count {
        path.cubic_to(point(), point(), point());
    }
    path.close();
    path
}
