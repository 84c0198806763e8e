//! Real icons as casters: within the tolerance at every elevation, none refused.
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

use common::{Summary, by, densities, worst_of};
use penumbral::plan::Method;
use penumbral::{FillRule, Grid, Light, Path, Scratch, Shape};

/// In scene units: penumbra radii of 0.7, 4, 10.8 and 33 under Android's light.
const ELEVATIONS: [f32; 4] = [0.5, 3.0, 8.0, 24.0];

/// The side that icons are drawn at, in scene units.
const SIDE: f32 = 48.0;

/// An icon's paths, each with its fill rule.
struct Icon {
    name: String,
    paths: Vec<(String, FillRule)>,
    /// The side of its own square.
    side: f32,
}

impl Icon {
    fn shapes(&self) -> Vec<Shape> {
        let scale = SIDE / self.side;
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
            let shapes = icon.shapes();
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
        times.sort_by(|a, b| a.0.total_cmp(&b.0));
        let at = |share: f64| times[(share * (times.len() - 1) as f64) as usize].0;
        println!(
            "elevation {elevation}: {} icons, cast and drawn in {:.0} us (median), {:.0} (95 %), {:.0} (99 %), {:.0} ({})",
            icons.len(),
            at(0.5),
            at(0.95),
            at(0.99),
            at(1.0),
            times[times.len() - 1].1
        );
    }
    summary.finish();
}

#[test]
fn fifty_icons_keep_their_tolerance() {
    let lines = include_str!("../fixtures/icons.tsv").lines();
    let icons: Vec<Icon> = lines
        .map(|line| {
            let (name, data) = line.split_once('\t').unwrap();
            Icon {
                name: name.to_owned(),
                paths: vec![(data.to_owned(), FillRule::NonZero)],
                side: 24.0,
            }
        })
        .collect();
    assert_eq!(icons.len(), 50);
    draw_all(&icons, 16);
}

#[test]
#[ignore = "takes a folder of SVG files, see tests/icons.sh"]
fn all_icons_of_a_folder_keep_their_tolerance() {
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
    draw_all(&icons, 4);
}
