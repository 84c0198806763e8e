//! What several tests share: random cases that are the same everywhere, drawing them, and the worst of what is found.

#![expect(
    clippy::unwrap_used,
    unreachable_pub,
    reason = "a case that is refused fails the test; every test has this module for itself"
)]

pub mod drawn;

use std::collections::BTreeMap;
use std::ops::Range;

use drawn::Drawn;
use penumbral::plan::Method;
use penumbral::{
    FillRule, Grid, Light, LineCap, LineJoin, Path, PixelOptions, Scratch, Shadow, Shape, Stroke,
};

/// `SplitMix64` (Steele, Lea & Flood 2014): the same cases on every machine.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0xd134_2543_de82_ef95))
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    pub fn chance(&mut self, share: f32) -> bool {
        self.between(0.0, 1.0) < share
    }

    /// On steps of 2^-20 of the way.
    pub fn between(&mut self, least: f32, most: f32) -> f32 {
        least + (most - least) * ((self.next() >> 44) as f32 / 1_048_576.0)
    }

    pub fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len())]
    }
}

/// Casters, light and pixels.
pub struct Case {
    pub name: &'static str,
    pub shapes: Vec<Shape>,
    /// The penumbra radius in pixels.
    pub radius: f32,
    pub light: Light,
    pub shadow: Shadow,
    pub grid: Grid,
}

impl Case {
    /// For a penumbra radius and a square of so many pixels.
    fn new(
        name: &'static str,
        shapes: Vec<Shape>,
        light: Light,
        radius: f32,
        side: f32,
        per_unit: f32,
    ) -> Self {
        let shadow = light.cast_all(&shapes, 1.0, 0.0).unwrap();
        let grid = Grid::new([0.0, 0.0], [side as u32; 2], per_unit).unwrap();
        Self {
            name,
            shapes,
            radius,
            light,
            shadow,
            grid,
        }
    }

    pub fn label(&self, index: usize) -> String {
        let (r, per_unit) = (self.radius, self.grid.pixels_per_unit());
        format!(
            "case {index}, {} at r {r} px, {per_unit} px a unit",
            self.name
        )
    }
}

/// Of what kinds shapes are, and lengths of theirs at which something special happens to a penumbra of that radius.
pub fn shapes(random: &mut Random, side: f32) -> (&'static str, Vec<Shape>, Vec<f32>) {
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
        let (sin, cos) = libm::sincosf(random.between(0.0, 3.2));
        let moved = shape.translated(center.map(|v| -v)).unwrap();
        let turned = moved.transformed([cos, sin, -sin, cos, 0.0, 0.0]).unwrap();
        turned.translated(center).unwrap()
    };
    let polar = |angle: f32, radius: f32| {
        [
            center[0] + radius * libm::cosf(angle),
            center[1] + radius * libm::sinf(angle),
        ]
    };
    match random.below(19) {
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
            let thin = if random.chance(0.3) {
                1.0
            } else {
                random.between(0.02, 2.5)
            };
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
                    polar(a + arm, from / libm::cosf(arm)),
                    polar(b - arm, to / libm::cosf(arm)),
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
                    gap.abs() / 1.85,
                    gap.abs(),
                    corner,
                    pitch[1] / 2.0,
                ],
            )
        }
        15 => {
            let radii = [0; 4].map(|_| {
                let radius = |random: &mut Random, side: f32| match random.below(4) {
                    0 => 0.0,
                    1 => 0.5 * side,
                    _ => random.between(0.0, 0.7) * side,
                };
                [radius(random, w), radius(random, h)]
            });
            (
                "elliptical corners",
                vec![Shape::rounded_rect(x, y, w, h, radii).unwrap()],
                vec![w / 2.0, radii[0][0], radii[0][1]],
            )
        }
        kind @ (16 | 17) => {
            let curved = kind == 16;
            let drawn = loop {
                if let Some(shape) = Drawn::random(random, side, curved).shape() {
                    break shape;
                }
            };
            let name = if curved {
                "path of every kind"
            } else {
                "polygons of every kind"
            };
            (name, vec![drawn], vec![side / 8.0, side / 4.0])
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
pub fn radius(random: &mut Random, lengths: &[f32]) -> f32 {
    const SPECIAL: [f32; 20] = [
        0.0, 0.0, 0.01, 0.1, 0.3, 0.499, 0.5, 0.7, 0.9999, 1.0, 1.1, 1.5, 2.0, 2.5, 2.999, 3.0,
        3.0, 3.001, 100.0, 200.0,
    ];
    match random.below(10) {
        0..4 => random.pick(&SPECIAL),
        4..6 => random.pick(lengths).min(200.0),
        6 => (random.pick(lengths) * random.between(0.97, 1.03)).min(200.0),
        7 => random.between(0.0, 3.0),
        _ => 3.0 * libm::exp2f(random.between(0.0, 6.06)),
    }
}

pub fn case(index: usize) -> Case {
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
    Case::new(name, shapes, light, radius, side, per_unit)
}

/// Casters drawn on whole and half pixels, under a penumbra radius of as many: discs touch corners and vertices, and pixels' middles lie
/// on lines between them.
pub fn snapped(index: usize) -> Case {
    const SIDE: f32 = 72.0;
    let mut random = Random::new(!(index as u64));
    let random = &mut random;
    let halves = |random: &mut Random, least: usize, most: usize| {
        (least + random.below(most - least + 1)) as f32 / 2.0
    };
    let point = |random: &mut Random| [halves(random, 16, 128), halves(random, 16, 128)];
    let corner = |random: &mut Random| halves(random, 0, 40);
    let card = |random: &mut Random, most: usize| {
        let [w, h] = [halves(random, 2, most), halves(random, 2, most)];
        let [x, y] = [w, h].map(|size| halves(random, 8, 8 + (112 - (2.0 * size) as usize)));
        let radii = if random.chance(0.5) {
            [corner(random); 4]
        } else {
            [0; 4].map(|_| corner(random))
        };
        Shape::rounded_rect(x, y, w, h, radii).unwrap()
    };
    let (name, shapes) = match random.below(7) {
        0 => ("snapped card", vec![card(random, 104)]),
        1 => (
            "snapped cards",
            (0..2 + random.below(4)).map(|_| card(random, 40)).collect(),
        ),
        2 => {
            let circle = |random: &mut Random| Shape::circle(point(random), halves(random, 1, 40));
            let circles = (0..1 + random.below(3)).map(|_| circle(random).unwrap());
            ("snapped circles", circles.collect())
        }
        3 => {
            let center = point(random);
            let mut path = Path::new();
            for radius in [halves(random, 20, 60), halves(random, 1, 19)] {
                let [left, right] = [center[0] - radius, center[0] + radius];
                let radii = [radius; 2];
                path.move_to([left, center[1]])
                    .arc_to(radii, 0.0, false, true, [right, center[1]])
                    .arc_to(radii, 0.0, false, true, [left, center[1]])
                    .close();
            }
            (
                "snapped ring",
                vec![Shape::path(&path, FillRule::EvenOdd).unwrap()],
            )
        }
        4 => {
            let ring: Vec<_> = (0..3 + random.below(6)).map(|_| point(random)).collect();
            let rule = random.pick(&[FillRule::EvenOdd, FillRule::NonZero]);
            (
                "snapped polygon",
                Vec::from_iter(Shape::polygon(&[ring], rule)),
            )
        }
        5 => {
            let mut path = Path::new();
            path.move_to(point(random));
            for _ in 0..2 + random.below(5) {
                match random.below(4) {
                    0 => path.line_to(point(random)),
                    1 => path.quad_to(point(random), point(random)),
                    2 => path.cubic_to(point(random), point(random), point(random)),
                    _ => {
                        let radii = [halves(random, 1, 40); 2];
                        let [large, sweep] = [random.chance(0.5), random.chance(0.5)];
                        path.arc_to(radii, 0.0, large, sweep, point(random))
                    }
                };
            }
            path.close();
            let rule = random.pick(&[FillRule::EvenOdd, FillRule::NonZero]);
            ("snapped path", Vec::from_iter(Shape::path(&path, rule)))
        }
        _ => {
            let mut path = Path::new();
            path.move_to(point(random));
            for _ in 0..1 + random.below(4) {
                path.line_to(point(random));
            }
            let stroke = Stroke::new(halves(random, 1, 24)).unwrap();
            let stroke = stroke
                .with_cap(random.pick(&[LineCap::Butt, LineCap::Round, LineCap::Square]))
                .with_join(random.pick(&[LineJoin::Miter, LineJoin::Round, LineJoin::Bevel]));
            (
                "snapped stroke",
                Vec::from_iter(Shape::stroke(&path, &stroke)),
            )
        }
    };
    let radius = halves(random, 6, 24) * random.pick(&[1.0, 1.0, 1.0, 0.25, 2.0]);
    let light = Light::directional([0.0, 0.0], radius).unwrap();
    Case::new(name, shapes, light, radius, SIDE, 1.0)
}

pub fn densities(
    shadow: &Shadow,
    grid: &Grid,
    options: &PixelOptions<'_>,
    scratch: &mut Scratch,
) -> Vec<f32> {
    let mut densities = vec![-1.0; (grid.width() * grid.height()) as usize];
    shadow
        .fill_f32(grid, &mut densities, options, scratch)
        .unwrap();
    densities
}

/// The worst of cases by what they are.
#[derive(Default)]
pub struct Summary {
    worst: BTreeMap<String, (f32, f32, String)>,
    failures: Vec<String>,
}

impl Summary {
    pub fn add(&mut self, what: String, error: f32, allowed: f32, label: &str) {
        let is_kept = error <= allowed;
        if !is_kept {
            self.failures.push(format!(
                "{what}: {error:.3} levels, {allowed} allowed: {label}"
            ));
        }
        let worst = self.worst.entry(what).or_default();
        if error / allowed >= worst.0 {
            *worst = (error / allowed, error, label.to_owned());
        }
    }

    pub fn finish(self) {
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

/// The worst of errors in levels: what is no number is as wrong as can be, where `max` would leave it out.
pub fn worst(errors: impl IntoIterator<Item = f64>) -> f64 {
    errors.into_iter().fold(0.0, |worst: f64, error| {
        worst.max(if error.is_nan() { 255.0 } else { error })
    })
}

/// How far densities are from others, as many, in levels.
pub fn worst_of(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    let errors = a.iter().zip(b).map(|(a, b)| (a - b).abs() * 255.0);
    worst(errors.map(f64::from)) as f32
}

/// A number from the environment.
pub fn setting(name: &str, default: usize) -> usize {
    std::env::var(name).map_or(default, |text| text.parse().unwrap())
}

/// The seeds of a test's cases: `count` of them, or as many as `PENUMBRAL_CASES` says, from `PENUMBRAL_SEED` on.
pub fn seeds(what: &str, count: usize) -> Range<usize> {
    let first = setting("PENUMBRAL_SEED", 0);
    let count = setting("PENUMBRAL_CASES", count);
    println!("{what}: {count} cases from seed {first} on");
    first..first + count
}

pub fn by(method: Option<Method>) -> PixelOptions<'static> {
    PixelOptions::default().with_method(method)
}

pub fn bits(densities: &[f32]) -> Vec<u32> {
    densities.iter().map(|density| density.to_bits()).collect()
}
