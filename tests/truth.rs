//! Every method against maps of an independent closed form, and coverage against plain counting.

#![expect(
    clippy::unwrap_used,
    reason = "a fixture that cannot be read fails the test"
)]

#[expect(dead_code, reason = "other tests take more of it")]
mod common;

use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};

use common::{worst, worst_of};
use penumbral::plan::{Method, Target, choose};
use penumbral::{
    DensityMap, FillRule, Grid, Light, PixelOptions, Scene, Scratch, Shape, Tolerance,
};

fn truth_scenes(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut scenes: Vec<PathBuf> = entries
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    scenes.sort();
    scenes
}

/// A map's densities, from 16-bit grey.
fn read_map(path: &Path) -> Vec<f64> {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap()))
        .read_info()
        .unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!(
        (info.color_type, info.bit_depth),
        (png::ColorType::Grayscale, png::BitDepth::Sixteen)
    );
    let grey = |pair: &[u8]| f64::from(u16::from_be_bytes([pair[0], pair[1]])) / 65535.0;
    bytes.chunks_exact(2).map(grey).collect()
}

/// How far `exact` may be from a map, in levels.
fn allowed(name: &str, least_radius: f64) -> f64 {
    match name {
        // Where two casters meet, what they hide together is found along chords of the disc.
        "two-heights" => 0.25,
        // The map's pixels are averages of 8 x 8 or 16 x 16 densities.
        _ if least_radius < 3.0 => 1.0,
        // Both round to 16 bits and flatten curves.
        _ => 0.1,
    }
}

#[test]
fn maps_of_an_independent_closed_form_agree() {
    let scenes = truth_scenes("fixtures/truth");
    assert_eq!(scenes.len(), 20);
    let (mut map, mut scratch) = (DensityMap::default(), Scratch::new());
    for path in scenes {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let scene = Scene::from_json(&fs::read_to_string(&path).unwrap()).unwrap();
        let truth = read_map(&path.with_extension("png"));
        let cast = |surface: &penumbral::Surface| {
            scene
                .light()
                .cast(surface.shape(), surface.elevation(), 0.0)
                .unwrap()
                .radius()
        };
        let least = scene.surfaces().iter().map(cast).fold(f64::MAX, f64::min);
        for method in [
            Some(Method::Exact),
            None,
            Some(Method::Direct),
            Some(Method::Grid),
            Some(Method::NinePatch),
        ] {
            let options = PixelOptions::default().with_method(method);
            let shadows = scene.ground_shadows().unwrap();
            shadows.draw(&mut map, &options, &mut scratch).unwrap();
            assert_eq!(map.densities().len(), truth.len(), "{name}");
            let error = |(got, truth): (&f32, &f64)| (f64::from(*got) - truth).abs() * 255.0;
            let errors: Vec<f64> = map.densities().iter().zip(&truth).map(error).collect();
            let worst = worst(errors.iter().copied());
            let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
            let label = method.map_or("auto".to_owned(), |method| method.to_string());
            println!(
                "{name:18} {label:10} r {least:7.2} px: worst {worst:.4}, rms {rms:.4} levels"
            );
            let allowed = match method {
                Some(Method::Exact) => allowed(&name, least),
                // The tolerance, for each of the two casters' heights.
                _ if name == "two-heights" => allowed(&name, least) + 1.0,
                _ => 1.0,
            };
            assert!(worst <= allowed, "{name}, {label}: {worst} levels");
        }
    }
}

#[test]
fn pairs_hide_what_a_polygon_boolean_says() {
    let scenes = truth_scenes("fixtures/truth/pairs");
    assert_eq!(scenes.len(), 24);
    let (mut map, mut scratch) = (DensityMap::default(), Scratch::new());
    for path in scenes {
        let scene = Scene::from_json(&fs::read_to_string(&path).unwrap()).unwrap();
        let truth = read_map(&path.with_extension("png"));
        for method in [Some(Method::Exact), None] {
            let options = PixelOptions::default().with_method(method);
            let shadows = scene.ground_shadows().unwrap();
            shadows.draw(&mut map, &options, &mut scratch).unwrap();
            assert_eq!(map.densities().len(), truth.len());
            let error = |(got, truth): (&f32, &f64)| (f64::from(*got) - truth).abs() * 255.0;
            let worst = worst(map.densities().iter().zip(&truth).map(error));
            println!("{:?} {method:?}: {worst:.3} levels", path.file_stem());
            assert!(
                worst <= 1.0,
                "{}, {method:?}: {worst} levels",
                path.display()
            );
        }
    }
}

/// The part of a pixel inside a disc, by counting.
fn counted(x: u32, y: u32, center: [f64; 2], radius: f64) -> f64 {
    const SIDE: u32 = 256;
    let inside = |i: u32| {
        let (column, row) = (i % SIDE, i / SIDE);
        let at =
            |pixel: u32, step: u32| f64::from(pixel) + (f64::from(step) + 0.5) / f64::from(SIDE);
        let (dx, dy) = (at(x, column) - center[0], at(y, row) - center[1]);
        dx * dx + dy * dy <= radius * radius
    };
    f64::from((0..SIDE * SIDE).filter(|&i| inside(i)).count() as u32) / f64::from(SIDE * SIDE)
}

#[test]
fn hard_and_nearly_hard_edges_are_coverage() {
    let (center, radius) = ([12.3, 11.6], 8.7);
    let circle = Shape::circle(center.map(|v| v as f32), radius as f32).unwrap();
    let grid = Grid::new([0.0, 0.0], [24, 24], 1.0).unwrap();
    for penumbra in [0.0, 0.02] {
        let light = Light::directional([0.0, 0.0], penumbra).unwrap();
        let shadow = light.cast(&circle, 1.0, 0.0).unwrap();
        assert!((shadow.radius() - f64::from(penumbra)).abs() < 1e-12);
        let mut mask = vec![0; 24 * 24];
        shadow
            .fill_a8(
                &grid,
                &mut mask,
                &PixelOptions::default(),
                &mut Scratch::new(),
            )
            .unwrap();
        for y in 0..24 {
            for x in 0..24 {
                let got = f64::from(mask[(y * 24 + x) as usize]);
                let error = (got - counted(x, y, center, radius) * 255.0).abs();
                // Half a level from rounding, a fifth from counting, and what a penumbra carries over a pixel's side: the
                // profile's mass beyond its edge, 0.106 of the radius.
                let allowed = 0.7 + 0.11 * f64::from(penumbra) * 255.0;
                assert!(
                    error < allowed,
                    "pixel {x}, {y} at r {penumbra}: {error} levels"
                );
            }
        }
    }
}

#[test]
fn moved_by_whole_pixels_a_picture_keeps_its_bits() {
    let light = Light::directional([0.0, 1.0], 1.5).unwrap();
    let draw = |dx: f32, dy: f32, origin: [f32; 2]| {
        let card =
            Shape::rounded_rect(10.25 + dx, 9.5 + dy, 20.0, 14.0, [3.0, 5.0, 0.0, 7.0]).unwrap();
        let grid = Grid::new(origin, [40, 40], 1.0).unwrap();
        let mut mask = vec![0; 1600];
        light
            .cast(&card, 3.0, 0.0)
            .unwrap()
            .fill_a8(
                &grid,
                &mut mask,
                &PixelOptions::default(),
                &mut Scratch::new(),
            )
            .unwrap();
        mask
    };
    let still = draw(0.0, 0.0, [0.0, 0.0]);
    assert!(still.contains(&255));
    assert_eq!(still, draw(128.0, 1024.0, [128.0, 1024.0]));
    assert_ne!(still, draw(0.5, 0.0, [0.0, 0.0]));
}

#[test]
fn rows_beyond_the_grid_are_left_alone() {
    let light = Light::flutter();
    let shadow = light
        .cast(&Shape::rect(-50.0, -50.0, 200.0, 200.0).unwrap(), 1.0, 0.0)
        .unwrap();
    let grid = Grid::new([0.0, 0.0], [4, 3], 1.0)
        .unwrap()
        .with_stride(6)
        .unwrap();
    let mut mask = vec![7; 18];
    shadow
        .fill_a8(
            &grid,
            &mut mask,
            &PixelOptions::default(),
            &mut Scratch::new(),
        )
        .unwrap();
    assert_eq!(mask, [[255, 255, 255, 255, 7, 7]; 3].concat());
    assert!(
        shadow
            .fill_a8(
                &grid,
                &mut mask[..15],
                &PixelOptions::default(),
                &mut Scratch::new()
            )
            .is_err()
    );
}

#[test]
fn pixels_per_unit_only_change_the_resolution() {
    // The same picture at twice the scale of a scene half as large.
    let draw = |factor: f32| {
        let light = Light::new([20.0 / factor, 0.0, 600.0 / factor], 800.0 / factor).unwrap();
        let card = Shape::rounded_rect(
            10.0 / factor,
            12.0 / factor,
            20.0 / factor,
            14.0 / factor,
            4.0 / factor,
        )
        .unwrap();
        let shadow = light.cast(&card, 4.0 / factor, 0.0).unwrap();
        let mut mask = vec![0; 1600];
        let grid = Grid::new([0.0, 0.0], [40, 40], factor).unwrap();
        shadow
            .fill_a8(
                &grid,
                &mut mask,
                &PixelOptions::default(),
                &mut Scratch::new(),
            )
            .unwrap();
        mask
    };
    assert_eq!(draw(1.0), draw(2.0));
}

/// Numbers of chance, the same in every run (Steele, Lea & Flood 2014, `SplitMix`).
struct Chance(u64);

impl Chance {
    fn between(&mut self, low: f32, high: f32) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        low + (high - low) * ((bits >> 40) as f32 / (1_u64 << 24) as f32)
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        let index = self.between(0.0, all.len() as f32) as usize;
        all[index.min(all.len() - 1)]
    }

    /// A card, a circle, a star or a blob of curves, some 60 units wide.
    fn shape(&mut self) -> Shape {
        let (x, y) = (self.between(5.0, 20.0), self.between(5.0, 20.0));
        let (w, h) = (self.between(2.0, 70.0), self.between(2.0, 60.0));
        let kind = self.one_of(&[0, 1, 2, 3]);
        match kind {
            0 => Shape::rounded_rect(x, y, w, h, [0; 4].map(|_| self.between(0.0, 20.0))).unwrap(),
            1 => {
                Shape::ellipse([x + 25.0, y + 25.0], [w / 2.0, self.one_of(&[w, h]) / 2.0]).unwrap()
            }
            2 => {
                let points = self.between(3.0, 40.0) as u16;
                let vertex = |i: u16, radius: f32| {
                    let angle = f32::from(i) * std::f32::consts::PI / f32::from(points);
                    [40.0 + radius * angle.cos(), 40.0 + radius * angle.sin()]
                };
                let ring: Vec<[f32; 2]> = (0..2 * points)
                    .map(|i| vertex(i, self.between(10.0, 35.0)))
                    .collect();
                Shape::polygon(&[ring], FillRule::EvenOdd).unwrap()
            }
            _ => {
                let mut blob = penumbral::Path::new();
                blob.move_to([x, y]);
                for _ in 0..3 {
                    let mut point = || [self.between(5.0, 75.0), self.between(5.0, 75.0)];
                    let (a, b, c) = (point(), point(), point());
                    blob.cubic_to(a, b, c);
                }
                Shape::path(&blob, FillRule::NonZero).unwrap()
            }
        }
    }
}

/// As many scenes of chance as `PENUMBRAL_SCENES` says, or 120:
/// `PENUMBRAL_SCENES=1000 cargo test --release --all-features --test truth random -- --nocapture`.
#[test]
fn the_plans_choice_keeps_the_tolerance_on_random_shadows() {
    let scenes = std::env::var("PENUMBRAL_SCENES").map_or(120, |count| count.parse().unwrap());
    let mut chance = Chance(2026);
    let grid = Grid::new([0.0, 0.0], [80, 80], 1.0).unwrap();
    let (mut scratch, mut exact, mut got) = (Scratch::new(), vec![0.0; 6400], vec![0.0; 6400]);
    let (mut closest, mut where_) = (0.0_f64, String::new());
    for scene in 0..scenes {
        let shape = chance.shape();
        let radius =
            chance.one_of(&[0.02, 0.1, 0.3, 1.0, 3.0, 10.0, 40.0]) * chance.between(0.5, 2.0);
        let levels = chance.one_of(&[0.5_f32, 1.0, 2.0, 4.0]);
        let light = Light::directional([0.0, 0.0], radius).unwrap();
        let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
        let mut draw = |method, densities: &mut [f32]| {
            let options = PixelOptions::new(Tolerance::levels(levels).unwrap()).with_method(method);
            shadow
                .fill_f32(&grid, densities, &options, &mut scratch)
                .unwrap();
        };
        draw(Some(Method::Exact), &mut exact);
        draw(None, &mut got);
        let worst = f64::from(worst_of(&got, &exact));
        let target = Target::Pixels(grid);
        let chosen = choose(&shadow, Tolerance::levels(levels).unwrap(), target).method;
        let words = format!("scene {scene}: {chosen}, r {radius}, {worst} of {levels} levels");
        assert!(worst <= f64::from(levels), "{words}");
        if worst / f64::from(levels) > closest {
            (closest, where_) = (worst / f64::from(levels), words);
        }
    }
    println!("{scenes} scenes; nearest to its tolerance: {where_}");
}
