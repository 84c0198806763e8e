//! Real icons as casters, on pixels and as meshes: within the tolerance at every elevation, none refused.
//!
//! Fifty of them are in the fixtures; `tests/icons.sh` takes all of a package.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a case that is refused fails the test"
)]

#[expect(dead_code, reason = "other tests take more of it")]
mod common;

use std::time::Instant;
use std::{env, fs};

use common::{Summary, by, densities, worst, worst_of};
use penumbral::plan::Method;
use penumbral::{
    FillRule, Grid, Light, MeshBuffers, MeshOptions, MeshVertex, Path, Scratch, Shadow, Shape,
    Tolerance,
};

/// In scene units: penumbra radii of 0.7, 4, 10.8 and 33 under Android's light.
const ELEVATIONS: [f32; 4] = [0.5, 3.0, 8.0, 24.0];

/// The side that icons are drawn at, in scene units.
const SIDE: f32 = 48.0;

/// The same for meshes: as large as icons are made.
const MESH_SIDE: f32 = 24.0;

/// An icon's paths, each with its fill rule.
struct Icon {
    name: String,
    paths: Vec<(String, FillRule)>,
    /// The side of its own square.
    side: f32,
}

impl Icon {
    /// Drawn so many scene units large.
    fn shapes(&self, side: f32) -> Vec<Shape> {
        let scale = side / self.side;
        let shape = |(data, rule): &(String, FillRule)| {
            let path =
                Path::from_svg(data).unwrap_or_else(|error| panic!("{}: {error}", self.name));
            let shape =
                Shape::path(&path, *rule).unwrap_or_else(|error| panic!("{}: {error}", self.name));
            shape
                .transformed([scale, 0.0, 0.0, scale, 0.0, 0.0])
                .unwrap()
        };
        self.paths.iter().map(shape).collect()
    }

    /// The paths of a simple SVG file.
    fn of_svg(name: String, svg: &str) -> Self {
        let attribute = |element: &str, name: &str| {
            let (_, rest) = element.split_once(&format!(" {name}=\""))?;
            Some(rest.split_once('"')?.0.to_owned())
        };
        let view = attribute(svg, "viewBox").unwrap();
        let side = view.split(' ').next_back().unwrap().parse().unwrap();
        let paths = svg.split("<path").skip(1).map(|element| {
            let element = element.split('>').next().unwrap();
            let rule = match attribute(element, "fill-rule").as_deref() {
                Some("evenodd") => FillRule::EvenOdd,
                _ => FillRule::NonZero,
            };
            (attribute(element, "d").unwrap(), rule)
        });
        Self {
            name,
            paths: paths.collect(),
            side,
        }
    }
}

/// Draws all icons at all elevations and compares some rows of each with `exact`.
fn draw_all(icons: &[Icon], each: u32) {
    let light = Light::android(SIDE).unwrap();
    let (mut scratch, mut summary) = (Scratch::new(), Summary::default());
    for elevation in ELEVATIONS {
        let mut times = Vec::new();
        for icon in icons {
            let shapes = icon.shapes(SIDE);
            let reach = (1.4 * elevation).ceil() + 4.0;
            let side = (SIDE + 2.0 * reach) as u32;
            let grid = Grid::new([-reach, -reach], [side, side], 1.0).unwrap();
            let start = Instant::now();
            let shadow = light.cast_all(&shapes, elevation, 0.0).unwrap();
            let drawn = densities(&shadow, &grid, &by(None), &mut scratch);
            times.push((start.elapsed().as_secs_f64() * 1e6, &icon.name));
            let rows = drawn.chunks(side as usize).zip(0_u32..);
            for (row, number) in rows.skip(each as usize / 2).step_by(each as usize) {
                let place = number as f32 - reach;
                let window = Grid::new([-reach, place], [side, 1], 1.0).unwrap();
                let exact = densities(&shadow, &window, &by(Some(Method::Exact)), &mut scratch);
                let label = format!("{}, row {place}", icon.name);
                let what = format!("elevation {elevation}");
                summary.add(what, worst_of(row, &exact), 1.12, &label);
            }
        }
        print_times(
            &format!("elevation {elevation}: cast and drawn"),
            &mut times,
        );
    }
    summary.finish();
}

/// Makes meshes of all icons at all elevations and compares them with `exact` at some points of every `each`th triangle.
fn mesh_all(icons: &[Icon], options: MeshOptions, levels: f64, each: usize) {
    let light = Light::android(MESH_SIDE).unwrap();
    let (mut scratch, mut buffers) = (Scratch::new(), MeshBuffers::<u32>::new());
    let mut worst = (0.0, String::new());
    for elevation in ELEVATIONS {
        let (mut times, mut triangles) = (Vec::new(), 0);
        for icon in icons {
            let shapes = icon.shapes(MESH_SIDE);
            let shadow = light.cast_all(&shapes, elevation, 0.0).unwrap();
            let mut mesh = || {
                buffers.clear();
                shadow.mesh_into(&mut buffers, options, &mut scratch)
            };
            // Once to be warm: quick meshes are not kept.
            mesh().unwrap();
            let start = Instant::now();
            let quality = mesh().unwrap();
            times.push((start.elapsed().as_secs_f64() * 1e6, &icon.name));
            assert!(
                quality.is_complete() && quality.error_levels <= levels,
                "{} at {elevation}",
                icon.name
            );
            triangles += buffers.indices.len() / 3;
            for corners in buffers.indices.chunks(3).step_by(each) {
                let corners = [0, 1, 2].map(|i: usize| buffers.vertices[corners[i] as usize]);
                let error = error_of(&shadow, corners);
                if error > worst.0 {
                    worst = (error, format!("{} at {elevation}", icon.name));
                }
            }
        }
        print_times(&format!("elevation {elevation}: meshed, warm"), &mut times);
        println!("    {} triangles on average", triangles / icons.len());
    }
    println!("meshes: at most {:.3} levels off ({})", worst.0, worst.1);
    assert!(worst.0 <= levels, "{worst:?}");
}

/// How far a triangle is off at its middle and those of its sides and its thirds, in levels.
fn error_of(shadow: &Shadow, corners: [MeshVertex; 3]) -> f64 {
    let weights = [
        [1.0, 1.0, 1.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 1.0],
        [1.0, 0.0, 1.0],
        [4.0, 1.0, 1.0],
        [1.0, 4.0, 1.0],
        [1.0, 1.0, 4.0],
    ];
    let error = |weights: [f32; 3]| {
        let mix = |value: fn(&MeshVertex) -> f32| {
            let sum: f32 = corners.iter().zip(weights).map(|(v, w)| value(v) * w).sum();
            sum / weights.iter().sum::<f32>()
        };
        let place = [mix(|v| v.position[0]), mix(|v| v.position[1])];
        (f64::from(mix(|v| v.density)) - shadow.density_at(place)).abs() * 255.0
    };
    worst(weights.map(error))
}

fn print_times(what: &str, times: &mut [(f64, &String)]) {
    times.sort_by(|a, b| a.0.total_cmp(&b.0));
    let at = |share: f64| times[(share * (times.len() - 1) as f64) as usize].0;
    println!(
        "{what}, {} icons, in {:.0} us (median; quartiles {:.0}, {:.0}), {:.0} (95 %), {:.0} (99 %), {:.0} ({})",
        times.len(),
        at(0.5),
        at(0.25),
        at(0.75),
        at(0.95),
        at(0.99),
        at(1.0),
        times[times.len() - 1].1
    );
}

#[test]
fn fifty_icons_keep_their_tolerance() {
    let icons = icons_of(include_str!("../fixtures/icons.tsv"));
    assert_eq!(icons.len(), 50);
    draw_all(&icons, 16);
    let quick = MeshOptions::new(Tolerance::ONE_LEVEL).quick();
    mesh_all(&icons, quick, 1.0, 16);
}

/// Where ends of penumbrae bend density to both sides, samples of a mesh may show nothing of what is between them.
#[test]
fn nothing_hides_between_samples() {
    let icons = icons_of(include_str!("../fixtures/icons-bent.tsv"));
    let quick = MeshOptions::new(Tolerance::ONE_LEVEL).quick();
    mesh_all(&icons, quick, 1.0, 1);
}

/// Icons of lines with a name and path data.
fn icons_of(lines: &str) -> Vec<Icon> {
    let icon = |line: &str| {
        let (name, data) = line.split_once('\t').unwrap();
        Icon {
            name: name.to_owned(),
            paths: vec![(data.to_owned(), FillRule::NonZero)],
            side: 24.0,
        }
    };
    lines.lines().map(icon).collect()
}

#[test]
#[ignore = "takes a folder of SVG files, see tests/icons.sh"]
fn all_icons_of_a_folder_keep_their_tolerance() {
    let icons = icons_of_folder();
    draw_all(&icons, 4);
    let quick = MeshOptions::new(Tolerance::ONE_LEVEL).quick();
    mesh_all(&icons, quick, 1.0, 4);
}

#[test]
#[ignore = "takes a folder of SVG files, see tests/icons.sh"]
fn icons_of_a_folder_taken_by_chance_have_meshes_of_both_kinds() {
    let mut icons = icons_of_folder();
    let mut lots: u64 = 300;
    while icons.len() > BY_CHANCE {
        lots = lots.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        icons.swap_remove((lots >> 33) as usize % icons.len());
    }
    for levels in [1.0_f32, 4.0] {
        let options = MeshOptions::new(Tolerance::levels(levels).unwrap());
        for (kind, options) in [("few", options), ("quick", options.quick())] {
            println!("{kind}, within {levels}");
            mesh_all(&icons, options, levels.into(), 4);
        }
    }
}

/// How many icons have meshes of both kinds.
const BY_CHANCE: usize = 300;

/// All of them, by name.
fn icons_of_folder() -> Vec<Icon> {
    let folder = env::var("PENUMBRAL_ICONS").unwrap();
    let mut icons: Vec<Icon> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "svg"))
        .map(|path| {
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            Icon::of_svg(name, &fs::read_to_string(&path).unwrap())
        })
        .filter(|icon| !icon.paths.is_empty())
        .collect();
    icons.sort_by(|a, b| a.name.cmp(&b.name));
    icons
}
