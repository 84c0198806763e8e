//! What the methods for pixels promise: how wrong they may be, and what may not change a bit.

#![expect(clippy::unwrap_used, reason = "a case that is refused fails the test")]

use std::collections::BTreeMap;

use penumbral::plan::{self, Method, Target};
use penumbral::{
    Color, FillRule, Grid, Hidden, Light, Paint, Path, PixelOptions, Scratch, Shadow, Shape,
    Tolerance,
};

/// `SplitMix64` (Steele, Lea & Flood 2014): the same cases on every machine.
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0xd134_2543_de82_ef95))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    fn chance(&mut self, share: f32) -> bool {
        self.between(0.0, 1.0) < share
    }

    /// On steps of 2^-20 of the way.
    fn between(&mut self, least: f32, most: f32) -> f32 {
        least + (most - least) * ((self.next() >> 44) as f32 / 1_048_576.0)
    }

    fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len())]
    }
}

/// Casters, light and pixels.
struct Case {
    name: &'static str,
    /// The penumbra radius in pixels.
    radius: f32,
    shadow: Shadow,
    grid: Grid,
}

impl Case {
    fn label(&self, index: usize) -> String {
        let (r, per_unit) = (self.radius, self.grid.pixels_per_unit());
        format!(
            "case {index}, {} at r {r} px, {per_unit} px a unit",
            self.name
        )
    }
}

/// Of what kinds shapes are, and lengths of theirs at which something special happens to a penumbra of that radius.
fn shapes(random: &mut Random, side: f32) -> (&'static str, Vec<Shape>, Vec<f32>) {
    let phase = |random: &mut Random| match random.below(4) {
        0 => 0.0,
        1 => 0.5,
        _ => random.between(0.0, 1.0),
    };
    let size = |random: &mut Random| {
        let size = side * random.between(0.08, 0.8);
        if random.chance(0.4) {
            size.round()
        } else {
            size
        }
    };
    let [w, h] = [size(random), size(random)];
    let [x, y] =
        [w, h].map(|v| ((side - v) / 2.0 * random.between(0.4, 1.6)).floor() + phase(random));
    let center = [x + w / 2.0, y + h / 2.0];
    let half = w.min(h) / 2.0;
    let turned = |shape: Shape, random: &mut Random| {
        let (sin, cos) = random.between(0.0, 3.2).sin_cos();
        let moved = shape.translated(center.map(|v| -v)).unwrap();
        let turned = moved.transformed([cos, sin, -sin, cos, 0.0, 0.0]).unwrap();
        turned.translated(center).unwrap()
    };
    let polar = |angle: f32, radius: f32| {
        [
            center[0] + radius * angle.cos(),
            center[1] + radius * angle.sin(),
        ]
    };
    match random.below(16) {
        0 => {
            let radii = [0; 4].map(|_| {
                if random.chance(0.2) {
                    0.0
                } else {
                    random.between(0.0, half)
                }
            });
            (
                "corners of four radii",
                vec![Shape::rounded_rect(x, y, w, h, radii).unwrap()],
                vec![w / 2.0, radii[0], radii[2]],
            )
        }
        1 | 2 => {
            let corner = random.between(0.0, half);
            (
                "rounded rectangle",
                vec![Shape::rounded_rect(x, y, w, h, corner).unwrap()],
                vec![w / 2.0, h / 2.0, corner],
            )
        }
        3 => (
            "circle",
            vec![Shape::circle(center, half).unwrap()],
            vec![half, 2.0 * half],
        ),
        4 => (
            "pill",
            vec![Shape::rounded_rect(x, y, w, h, 1e3).unwrap()],
            vec![half, w / 2.0],
        ),
        5 => {
            let thin = random.between(0.02, 2.5);
            let flat = random.chance(0.5);
            let [w, h] = if flat { [w, thin] } else { [thin, h] };
            let corner = if random.chance(0.5) { 0.0 } else { thin };
            let sliver = Shape::rounded_rect(x, y, w, h, corner).unwrap();
            let sliver = if random.chance(0.4) {
                turned(sliver, random)
            } else {
                sliver
            };
            ("sliver", vec![sliver], vec![thin / 2.0, w.max(h) / 2.0])
        }
        6 | 7 => {
            let tips = 2 * (3 + random.below(7));
            let inner = half * random.between(0.15, 0.9);
            let start = random.between(0.0, 3.0);
            let wild = random.chance(0.5);
            let ring: Vec<[f32; 2]> = (0..tips)
                .map(|i| {
                    let angle = start + i as f32 * core::f32::consts::TAU / tips as f32;
                    let radius = if i % 2 == 0 { half } else { inner };
                    let radius = if wild {
                        radius * random.between(0.3, 1.0)
                    } else {
                        radius
                    };
                    polar(angle, radius)
                })
                .collect();
            (
                if wild { "concave polygon" } else { "star" },
                vec![Shape::polygon(&[ring], FillRule::NonZero).unwrap()],
                vec![half, inner],
            )
        }
        8 => {
            let ring = |radius: f32, count: usize, start: f32| -> Vec<[f32; 2]> {
                (0..count)
                    .map(|i| {
                        polar(
                            start + i as f32 * core::f32::consts::TAU / count as f32,
                            radius,
                        )
                    })
                    .collect()
            };
            let hole = half * random.between(0.2, 0.95);
            let count = random.pick(&[3, 4, 6, 24]);
            let outer = ring(half, random.pick(&[4, 5, 12, 24]), random.between(0.0, 1.0));
            let rings = [outer, ring(hole, count, random.between(0.0, 1.0))];
            (
                "polygon with hole",
                vec![Shape::polygon(&rings, FillRule::EvenOdd).unwrap()],
                vec![half, hole, (half - hole) / 2.0],
            )
        }
        9 => {
            let ring: Vec<[f32; 2]> = (0..5 + random.below(6))
                .map(|_| [x + random.between(0.0, w), y + random.between(0.0, h)])
                .collect();
            let rule = random.pick(&[FillRule::EvenOdd, FillRule::NonZero]);
            (
                "self-crossing polygon",
                vec![Shape::polygon(&[ring], rule).unwrap()],
                vec![half],
            )
        }
        10 => {
            let count = 3 + random.below(5);
            let step = core::f32::consts::TAU / count as f32;
            let radii: Vec<f32> = (0..count)
                .map(|_| half * random.between(0.4, 1.0))
                .collect();
            let arm = random.between(0.2, 0.45) * step;
            let mut path = Path::new();
            path.move_to(polar(0.0, radii[0]));
            for i in 0..count {
                let (from, to) = (radii[i], radii[(i + 1) % count]);
                let (a, b) = (i as f32 * step, (i + 1) as f32 * step);
                path.cubic_to(
                    polar(a + arm, from / arm.cos()),
                    polar(b - arm, to / arm.cos()),
                    polar(b, to),
                );
            }
            (
                "blob",
                vec![Shape::path(path.close(), FillRule::NonZero).unwrap()],
                vec![half, radii[0]],
            )
        }
        11 => {
            let at = |u: f32, v: f32| [x + u * w, y + v * h];
            let mut path = Path::new();
            path.move_to(at(0.5, 1.0))
                .cubic_to(at(0.0, 0.65), at(-0.1, 0.3), at(0.06, 0.14))
                .cubic_to(at(0.2, -0.04), at(0.42, 0.02), at(0.5, 0.22))
                .cubic_to(at(0.58, 0.02), at(0.8, -0.04), at(0.94, 0.14))
                .cubic_to(at(1.1, 0.3), at(1.0, 0.65), at(0.5, 1.0));
            (
                "heart",
                vec![Shape::path(&path, FillRule::NonZero).unwrap()],
                vec![half, half / 2.0],
            )
        }
        12 => {
            let corner = if random.chance(0.5) {
                0.0
            } else {
                random.between(0.0, half)
            };
            let card = Shape::rounded_rect(x, y, w, h, corner).unwrap();
            (
                "tilted rectangle",
                vec![turned(card, random)],
                vec![half, corner],
            )
        }
        13 => (
            "ellipse",
            vec![Shape::ellipse(center, [w / 2.0, h / 2.0]).unwrap()],
            vec![w / 2.0, h / 2.0],
        ),
        14 => {
            // Cards in columns and rows: apart, abutting or overlapping.
            let (columns, rows) = (1 + random.below(4), 2 + random.below(4));
            let pitch = [side / (columns as f32 + 0.5), side / (rows as f32 + 0.5)].map(f32::floor);
            let gap = random.pick(&[0.0, 0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 9.0, -1.0, -3.0]);
            let corner = random.pick(&[0.0, 0.0, 2.0, 4.0, 7.5]);
            let offset = [phase(random), phase(random)];
            let card = |i: usize| {
                let [x, y] = [
                    (i % columns) as f32 * pitch[0] + 3.0 + offset[0],
                    (i / columns) as f32 * pitch[1] + 3.0 + offset[1],
                ];
                Shape::rounded_rect(x, y, pitch[0] - gap, pitch[1] - gap, corner).unwrap()
            };
            let name = match gap {
                ..0.0 => "overlapping cards",
                0.0 => "abutting cards",
                _ => "cards apart",
            };
            (
                name,
                (0..columns * rows).map(card).collect(),
                vec![
                    gap.abs() / 2.0,
                    gap.abs() / 1.7,
                    gap.abs(),
                    corner,
                    pitch[1] / 2.0,
                ],
            )
        }
        _ => {
            let mut several = Vec::new();
            for _ in 0..2 + random.below(4) {
                let at = [
                    random.between(0.1, 0.9) * side,
                    random.between(0.1, 0.9) * side,
                ];
                let size = side * random.between(0.03, 0.2);
                several.push(match random.below(3) {
                    0 => Shape::circle(at, size).unwrap(),
                    1 => Shape::rect(at[0], at[1], size, size).unwrap(),
                    _ => Shape::polygon(
                        &[[at, [at[0] + size, at[1] + 1.0], [at[0] + 2.0, at[1] + size]]],
                        FillRule::NonZero,
                    )
                    .unwrap(),
                });
            }
            ("several shapes", several, vec![side / 20.0])
        }
    }
}

/// The penumbra radius in pixels, special ones first.
fn radius(random: &mut Random, lengths: &[f32]) -> f32 {
    const SPECIAL: [f32; 20] = [
        0.0, 0.0, 0.01, 0.1, 0.3, 0.499, 0.5, 0.7, 0.9999, 1.0, 1.1, 1.5, 2.0, 2.5, 2.999, 3.0,
        3.0, 3.001, 100.0, 200.0,
    ];
    match random.below(10) {
        0..4 => random.pick(&SPECIAL),
        4..6 => random.pick(lengths).min(200.0),
        6 => (random.pick(lengths) * random.between(0.97, 1.03)).min(200.0),
        7 => random.between(0.0, 3.0),
        _ => 3.0 * random.between(0.0, 6.06).exp2(),
    }
}

fn case(index: usize) -> Case {
    let mut random = Random::new(index as u64);
    let mut side = 64.0 + (random.below(13) * 8) as f32;
    let (name, mut shapes, lengths) = shapes(&mut random, side);
    let radius = radius(&mut random, &lengths);
    if radius < 3.0 {
        // Here averages make `exact` slow.
        side = side.min(96.0);
    }
    let per_unit = random.pick(&[1.0, 1.0, 1.0, 1.0, 2.0, 0.5]);
    if per_unit != 1.0 {
        for shape in &mut shapes {
            *shape = shape
                .transformed([1.0 / per_unit, 0.0, 0.0, 1.0 / per_unit, 0.0, 0.0])
                .unwrap();
        }
    }
    let offset = random.pick(&[[0.0, 0.0], [3.25, -2.5], [0.3, 0.7]]);
    let light = Light::directional(offset, radius / per_unit).unwrap();
    let shadow = light.cast_all(&shapes, 1.0, 0.0).unwrap();
    let grid = Grid::new([0.0, 0.0], [side as u32, side as u32], per_unit).unwrap();
    Case {
        name,
        radius,
        shadow,
        grid,
    }
}

fn densities(case: &Case, options: &PixelOptions<'_>, scratch: &mut Scratch) -> Vec<f32> {
    let mut densities = vec![-1.0; (case.grid.width() * case.grid.height()) as usize];
    case.shadow
        .fill_f32(&case.grid, &mut densities, options, scratch)
        .unwrap();
    densities
}

/// The worst of cases by what they are.
#[derive(Default)]
struct Summary {
    worst: BTreeMap<String, (f32, f32, String)>,
    failures: Vec<String>,
}

impl Summary {
    fn add(&mut self, what: String, error: f32, allowed: f32, label: &str) {
        if error > allowed {
            self.failures.push(format!(
                "{what}: {error:.3} levels, {allowed} allowed: {label}"
            ));
        }
        let worst = self.worst.entry(what).or_default();
        if error / allowed >= worst.0 {
            *worst = (error / allowed, error, label.to_owned());
        }
    }

    fn finish(self) {
        for (what, (_, error, label)) in &self.worst {
            println!("{what:32} {error:.3} levels, {label}");
        }
        assert!(
            self.failures.is_empty(),
            "{} failures:\n{}",
            self.failures.len(),
            self.failures.join("\n")
        );
    }
}

fn worst_of(a: &[f32], b: &[f32]) -> f32 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs() * 255.0)
        .fold(0.0, f32::max)
}

/// The least error below r = 3 px that is promised of averages.
const AVERAGED: f32 = 0.8;

#[test]
fn every_method_keeps_its_tolerance() {
    let (mut scratch, mut summary) = (Scratch::new(), Summary::default());
    for index in 0..1000 {
        let case = case(index);
        let label = case.label(index);
        let mut draw = |method, tolerance| {
            let options = PixelOptions {
                method,
                tolerance,
                ..PixelOptions::default()
            };
            densities(&case, &options, &mut scratch)
        };
        let exact = draw(Some(Method::Exact), Tolerance::ONE_LEVEL);
        assert!(exact.iter().all(|density| (0.0..=1.0).contains(density)));
        let forced = [Method::Direct, Method::Grid, Method::NinePatch];
        let mut tolerances = vec![1.0];
        if index % 4 == 0 {
            tolerances.push([0.5, 2.0, 4.0][index / 4 % 3]);
        }
        for levels in tolerances {
            let tolerance = Tolerance::levels(levels).unwrap();
            // What `exact` itself may be wrong by.
            let (exactly, averaged) = if case.radius < 3.0 {
                (0.12, AVERAGED)
            } else {
                (0.0, 0.0)
            };
            let target = Target::Pixels {
                per_unit: case.grid.pixels_per_unit(),
            };
            let chosen = plan::choose(&case.shadow, tolerance, target).method;
            let error = worst_of(&draw(None, tolerance), &exact);
            summary.add(
                format!("auto ({chosen}), tolerance {levels}"),
                error,
                levels + exactly,
                &label,
            );
            let method = forced[index % 3];
            let error = worst_of(&draw(Some(method), tolerance), &exact);
            let allowed = levels.max(averaged) + exactly;
            summary.add(
                format!("{method}, tolerance {levels}"),
                error,
                allowed,
                &label,
            );
        }
    }
    summary.finish();
}

/// The 8-bit and the RGBA8 pictures of a case, over a canvas of one grey.
fn bytes(case: &Case, options: &PixelOptions<'_>, scratch: &mut Scratch) -> (Vec<u8>, Vec<u8>) {
    let count = (case.grid.width() * case.grid.height()) as usize;
    let (mut mask, mut pixels) = (vec![0; count], vec![200; 4 * count]);
    let paint = Paint::new(Color::rgb(10, 80, 160), 0.7).unwrap();
    case.shadow
        .fill_a8_with(&case.grid, &mut mask, options, scratch)
        .unwrap();
    case.shadow
        .blend_rgba8(&case.grid, &mut pixels, &paint, options, scratch)
        .unwrap();
    (mask, pixels)
}

#[test]
fn bytes_are_densities_rounded_once() {
    let mut scratch = Scratch::new();
    for index in 0..200 {
        let case = case(index);
        for dither in [false, true] {
            let options = PixelOptions {
                dither,
                ..PixelOptions::default()
            };
            let densities = densities(&case, &options, &mut scratch);
            let (mask, pixels) = bytes(&case, &options, &mut scratch);
            // Half a step, or one where it is dithered; 16-bit products cut off 2/256 more; parts that meet round twice.
            let most = if dither { 1.02 } else { 0.52 };
            for (index, density) in densities.iter().enumerate() {
                let coverage = (f32::from(mask[index]) - density * 255.0).abs();
                assert!(coverage <= 2.0 * most, "{}: {coverage}", case.label(index));
                let opacity = density * 0.7;
                for (channel, paint) in [10.0, 80.0, 160.0, 255.0].into_iter().enumerate() {
                    let expected = 200.0 + (paint - 200.0) * opacity;
                    let error = (f32::from(pixels[4 * index + channel]) - expected).abs();
                    assert!(error <= most + 0.1, "{}: {error}", case.label(index));
                }
            }
        }
    }
}

#[test]
fn windows_hidden_pixels_and_what_was_drawn_before_change_no_bit() {
    let mut used = Scratch::new();
    for index in 0..300 {
        let case = case(index);
        let options = PixelOptions::default();
        let fresh = densities(&case, &options, &mut Scratch::new());
        assert!(
            fresh == densities(&case, &options, &mut used),
            "{}",
            case.label(index)
        );

        // The part from column 11 and row 7 on, less its last 5 columns and 9 rows.
        let [width, height] = [case.grid.width(), case.grid.height()];
        let per_unit = case.grid.pixels_per_unit() as f32;
        let size = [width - 16, height - 16];
        let part = Grid::new([11.0 / per_unit, 7.0 / per_unit], size, per_unit).unwrap();
        let mut window = vec![0.0; (size[0] * size[1]) as usize];
        case.shadow
            .fill_f32(&part, &mut window, &options, &mut used)
            .unwrap();
        for (row, drawn) in window.chunks_exact(size[0] as usize).enumerate() {
            let start = (row + 7) * width as usize + 11;
            assert!(
                drawn == &fresh[start..start + drawn.len()],
                "{}, row {row}",
                case.label(index)
            );
        }

        let mut hidden = Hidden::new(&case.grid);
        let side = width as f32 / per_unit;
        let card = Shape::rounded_rect(side * 0.3, side * 0.2, side * 0.41, side * 0.5, side * 0.1);
        hidden.add(&card.unwrap(), &mut used);
        let options = PixelOptions {
            hidden: Some(&hidden),
            ..options
        };
        let seen = densities(&case, &options, &mut used);
        let changed = seen
            .iter()
            .zip(&fresh)
            .filter(|(seen, fresh)| seen != fresh);
        for (seen, _) in changed {
            assert_eq!(*seen, 0.0, "{}", case.label(index));
        }
    }
}

#[test]
fn moved_by_whole_pixels_every_method_keeps_its_bits() {
    let mut scratch = Scratch::new();
    for radius in [0.0_f32, 0.25, 1.5, 7.0, 30.0] {
        let light = Light::directional([0.0, 0.0], radius).unwrap();
        let mut draw = |offset: [f32; 2], shape: &Shape, method| {
            let moved = shape.translated(offset).unwrap();
            let shadow = light.cast(&moved, 1.0, 0.0).unwrap();
            let grid = Grid::new(offset, [90, 80], 1.0).unwrap();
            let mut densities = vec![0.0; 90 * 80];
            let options = PixelOptions {
                method,
                ..PixelOptions::default()
            };
            shadow
                .fill_f32(&grid, &mut densities, &options, &mut scratch)
                .unwrap();
            densities
        };
        let star = [
            [40.25, 10.5],
            [50.0, 60.75],
            [15.5, 30.0],
            [70.0, 28.5],
            [24.0, 64.25],
        ];
        let shapes = [
            Shape::rounded_rect(20.25, 18.5, 50.0, 40.0, [3.0, 5.0, 0.0, 16.0]).unwrap(),
            Shape::circle([44.5, 40.25], 21.0).unwrap(),
            Shape::polygon(&[star], FillRule::NonZero).unwrap(),
        ];
        for shape in &shapes {
            for method in [
                None,
                Some(Method::Direct),
                Some(Method::Grid),
                Some(Method::NinePatch),
            ] {
                let here = draw([0.0, 0.0], shape, method);
                assert!(here.iter().any(|density| *density > 0.0));
                assert!(
                    here == draw([128.0, 1024.0], shape, method),
                    "{method:?} at r {radius}"
                );
            }
        }
    }
}

#[test]
fn a_wide_faint_penumbra_shows_no_bands_when_dithered() {
    let light = Light::directional([0.0, 0.0], 100.0).unwrap();
    let shadow = light
        .cast(
            &Shape::rect(-400.0, -400.0, 520.0, 900.0).unwrap(),
            1.0,
            0.0,
        )
        .unwrap();
    let grid = Grid::new([0.0, 0.0], [240, 64], 1.0).unwrap();
    let paint = Paint::new(Color::BLACK, 0.04).unwrap();
    let longest_run = |dither| {
        let mut pixels = vec![255; 4 * 240 * 64];
        let options = PixelOptions {
            dither,
            ..PixelOptions::default()
        };
        shadow
            .blend_rgba8(&grid, &mut pixels, &paint, &options, &mut Scratch::new())
            .unwrap();
        let row: Vec<u8> = pixels[4 * 240 * 30..][..4 * 240]
            .iter()
            .step_by(4)
            .copied()
            .collect();
        // Where the density falls from 0.9 to 0.1.
        let runs = row[60..180].chunk_by(|a, b| a == b);
        runs.map(<[u8]>::len).max().unwrap()
    };
    let (banded, dithered) = (longest_run(false), longest_run(true));
    println!("longest run of one value: {banded}, dithered {dithered}");
    assert!(banded > 12 && dithered <= 10);
}

#[test]
fn what_does_not_fit_is_refused() {
    let light = Light::flutter();
    let shadow = light
        .cast(&Shape::rect(0.0, 0.0, 9.0, 9.0).unwrap(), 2.0, 0.0)
        .unwrap();
    let grid = Grid::new([0.0, 0.0], [8, 8], 1.0).unwrap();
    let other = Grid::new([1.0, 0.0], [8, 8], 1.0).unwrap();
    let hidden = Hidden::new(&other);
    let options = PixelOptions {
        hidden: Some(&hidden),
        ..PixelOptions::default()
    };
    let mut scratch = Scratch::new();
    let refused = shadow.fill_f32(&grid, &mut [0.0; 64], &options, &mut scratch);
    assert!(matches!(refused, Err(penumbral::Error::OtherGrid { .. })));
    let options = PixelOptions::default();
    assert!(
        shadow
            .fill_f32(&grid, &mut [0.0; 63], &options, &mut scratch)
            .is_err()
    );
    let paint = Paint::new(Color::BLACK, 0.5).unwrap();
    assert!(
        shadow
            .blend_rgba8(&grid, &mut [0; 255], &paint, &options, &mut scratch)
            .is_err()
    );
    for strength in [-0.1, 1.1, f32::NAN] {
        assert!(Paint::new(Color::BLACK, strength).is_err());
    }
}
