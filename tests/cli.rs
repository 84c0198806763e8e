//! The command line as its users meet it: the built program on files, and what it writes, says and returns.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "what fails in a helper is the test"
)]

use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;
use std::{env, fs, io, process, thread};

use image::{DynamicImage, ImageBuffer, Luma, RgbaImage};
use penumbral::{Light, MAX_SCENE_LENGTH, MAX_SEGMENTS, Pose, Shape, Tolerance};
use serde_json::Value;

/// One card of 40 x 20 in the middle of the canvas, right below the light.
const CARD: &str = r##"{"canvas": [60, 40], "background": "#eeeeee", "scale": 1, "key": 0.2, "ambient": 0.05,
 "light": {"x": 30, "y": 20, "z": 600, "radius": 800},
 "surfaces": [
  {"shape": "rrect", "x": 10, "y": 10, "w": 40, "h": 20, "radius": 4, "elevation": 8, "opacity": 1, "fill": "#ff0000"}
 ]}"##;

/// Left to right in the file's order, but neither by elevation nor all with a shadow.
const ROW: &str = r#"{"canvas": [200, 60], "light": {"x": 100, "y": 0, "z": 600, "radius": 800}, "surfaces": [
  {"shape": "circle", "cx": 30, "cy": 30, "r": 12, "elevation": 6, "name": "round button"},
  {"shape": "rrect", "x": 60, "y": 10, "w": 30, "h": 40, "radius": 6, "elevation": 0, "name": "print"},
  {"shape": "polygon", "points": [[110, 10], [140, 50], [110, 50]], "elevation": 12, "opacity": 0.5},
  {"shape": "path", "d": "M160 15H190V45H175V30H160Z", "elevation": 2, "name": "L"}]}"#;

/// Every command with every kind of output.
const COMMANDS: [&str; 7] = [
    "render scene.json -o out.png",
    "render scene.json -o out.svg",
    "density scene.json -o out.png",
    "mesh scene.json -o out.json",
    "mesh scene.json -o out.obj",
    "mesh scene.json -o out.svg",
    "explain scene.json",
];

/// A folder of one test, where the program runs: gone when the test is.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = env::temp_dir().join(format!("penumbral-cli-{}-{count}", process::id()));
        fs::create_dir(&path).unwrap();
        Self(path)
    }

    /// With a file `scene.json`.
    fn with_scene(text: impl AsRef<[u8]>) -> Self {
        let folder = Self::new();
        fs::write(folder.file("scene.json"), text).unwrap();
        folder
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.file(name)).unwrap()
    }

    fn picture(&self, name: &str) -> DynamicImage {
        image::open(self.file(name)).unwrap()
    }

    /// What is in the folder: every name, and what the files hold.
    fn contents(&self) -> Vec<(PathBuf, Option<Vec<u8>>)> {
        let mut contents: Vec<_> = fs::read_dir(&self.0)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .map(|path| (path.clone(), fs::read(path).ok()))
            .collect();
        contents.sort();
        contents
    }

    fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_penumbral"));
        command
            .current_dir(&self.0)
            // Where the program panics, its message is enough.
            .env("RUST_BACKTRACE", "0")
            .args(arguments.split_whitespace());
        command
    }

    fn run(&self, arguments: &str) -> Run {
        let output = self.command(arguments).output().unwrap();
        Run {
            status: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// The standard output of a run that has nothing to complain about.
    fn succeed(&self, arguments: &str) -> String {
        let run = self.run(arguments);
        assert_eq!(
            (run.status, run.stderr.as_str()),
            (Some(0), ""),
            "{arguments}"
        );
        run.stdout
    }

    /// The one line of JSON that `density` prints.
    fn density(&self, arguments: &str) -> Value {
        let line = self.succeed(&format!("density scene.json {arguments}"));
        assert_eq!(line.lines().count(), 1, "{line}");
        serde_json::from_str(&line).unwrap()
    }

    /// Runs what must be refused: with one line that holds `part`, and without touching a file.
    fn refuse(&self, arguments: &str, part: &str) -> Result<(), String> {
        let before = self.contents();
        let run = self.run(arguments);
        let is_line = run.stderr.starts_with("penumbral: ")
            && run.stderr.ends_with('\n')
            && run.stderr.lines().count() == 1;
        let complaint = if run.status != Some(1) {
            "the exit status is not 1"
        } else if !is_line {
            "the message is not one line that begins with the program's name"
        } else if !run.stderr.contains(part) {
            "the message lacks its part"
        } else if !run.stdout.is_empty() {
            "something is on standard output"
        } else if self.contents() != before {
            "files are not as they were"
        } else {
            return Ok(());
        };
        Err(format!(
            "{complaint}: `{arguments}`, {part:?} expected, {run:?}"
        ))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A leftover in the temporary folder is no reason to fail.
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[derive(Debug)]
struct Run {
    status: Option<i32>,
    stdout: String,
    stderr: String,
}

/// Fails with every complaint, so that one broken case does not hide the next.
fn assert_all(results: impl IntoIterator<Item = Result<(), String>>) {
    let complaints: Vec<String> = results.into_iter().filter_map(Result::err).collect();
    assert!(
        complaints.is_empty(),
        "{} cases:\n{}",
        complaints.len(),
        complaints.join("\n")
    );
}

/// [`CARD`] with one part of it replaced.
fn card_with(old: &str, new: &str) -> String {
    assert_eq!(CARD.matches(old).count(), 1, "{old}");
    CARD.replace(old, new)
}

/// [`CARD`] with another surface for its only one.
fn card_of(surface: &str) -> String {
    let start = CARD.find(r#"{"shape""#).unwrap();
    format!("{}{surface}]}}", &CARD[..start])
}

/// A folder with a tilted card and an image under two lights.
fn with_tilted_and_image() -> Folder {
    let folder = Folder::with_scene(
        r#"{"canvas": [200, 200], "light": {"x": 80, "y": 30, "z": 300, "radius": 120},
            "lights": [{"x": 180, "y": 30, "z": 300, "radius": 120, "key": 0.1}], "surfaces": [
            {"shape": "rrect", "x": 50, "y": 60, "w": 60, "h": 40, "elevation": 40,
             "tilt": {"pivot": [80, 80], "axis": [0, 1], "degrees": 28.647889756541161}},
            {"shape": "rrect", "x": 120, "y": 20, "w": 30, "h": 30, "elevation": 8, "image": "window.png"}]}"#,
    );
    RgbaImage::new(2, 2)
        .save(folder.file("window.png"))
        .unwrap();
    folder
}

fn grey16(picture: &DynamicImage) -> &ImageBuffer<Luma<u16>, Vec<u16>> {
    match picture {
        DynamicImage::ImageLuma16(grey) => grey,
        other => panic!("{:?} is not 16-bit grey", other.color()),
    }
}

/// The number of an attribute of an SVG's first element.
fn svg_number(svg: &str, name: &str) -> f64 {
    let (_, rest) = svg.split_once(&format!(" {name}=\"")).unwrap();
    rest.split_once('"').unwrap().0.parse().unwrap()
}

mod render {
    use super::*;

    #[test]
    fn pictures_have_the_size_of_the_canvas_times_the_scale() {
        for (canvas, scale, size) in [
            ("[60, 40]", "1", (60, 40)),
            ("[60, 40]", "2", (120, 80)),
            ("[61, 41]", "1.5", (92, 62)),
            ("[60, 40]", "0.01", (1, 1)),
        ] {
            let scene = card_with("[60, 40]", canvas)
                .replace(r#""scale": 1"#, &format!(r#""scale": {scale}"#));
            let folder = Folder::with_scene(scene);
            assert_eq!(folder.succeed("render scene.json -o out.png"), "");
            assert_eq!(folder.succeed("render scene.json -o out.svg"), "");
            let picture = folder.picture("out.png");
            assert_eq!((picture.width(), picture.height()), size);
            let svg = folder.text("out.svg");
            let sides = [size.0, size.1].map(f64::from);
            assert_eq!(
                [svg_number(&svg, "width"), svg_number(&svg, "height")],
                sides
            );
        }
    }

    #[test]
    fn extensions_are_of_any_case() {
        let folder = Folder::with_scene(CARD);
        for name in ["OUT.PNG", "out.Svg"] {
            folder.succeed(&format!("render scene.json -o {name}"));
        }
        assert!(folder.text("out.Svg").starts_with("<svg "));
        let png = fs::read(folder.file("OUT.PNG")).unwrap();
        assert!(png.starts_with(b"\x89PNG"));
    }

    #[test]
    fn pictures_show_ground_shadow_and_surface() {
        let folder = Folder::with_scene(card_with("[60, 40]", "[60, 80]"));
        folder.succeed("render scene.json -o out.png");
        let picture: RgbaImage = folder.picture("out.png").into_rgba8();
        let pixel = |x, y| picture.get_pixel(x, y).0;
        assert_eq!(pixel(30, 20), [255, 0, 0, 255]);
        assert_eq!(pixel(30, 79), [0xee, 0xee, 0xee, 255]);
        let [r, g, b, a] = pixel(30, 32);
        assert!(
            r == g && g == b && r < 0xee && a == 255,
            "{:?}",
            pixel(30, 32)
        );
    }

    #[test]
    fn pictures_are_the_same_each_time() {
        let folder = Folder::with_scene(ROW);
        for name in ["out.png", "out.svg"] {
            let draw = || {
                folder.succeed(&format!("render scene.json -o {name}"));
                fs::read(folder.file(name)).unwrap()
            };
            assert_eq!(draw(), draw());
        }
    }

    #[test]
    fn the_tolerance_is_that_of_shadows_in_svg() {
        let folder = Folder::with_scene(CARD);
        let length = |tolerance| {
            folder.succeed(&format!(
                "render scene.json -o out.svg --tolerance {tolerance}"
            ));
            folder.text("out.svg").len()
        };
        assert!(length("0.5") > length("4"));
        assert!(length("4") > length("32"));
    }
}

mod density {
    use super::*;

    /// Pixels of another method than the exact, of a 16-bit map: a level of tolerance, and the rounding of both.
    const LEVEL: u16 = 65535 / 255 + 1;

    #[test]
    fn one_line_of_json_and_a_map_of_16_bit_grey() {
        let folder = Folder::with_scene(card_with(r#""scale": 1"#, r#""scale": 2"#));
        let line = folder.density("-o out.png");
        let keys: Vec<&String> = line.as_object().unwrap().keys().collect();
        assert_eq!(keys, ["max_density", "median_ns", "method", "pixels"]);
        assert_eq!(line["method"], "nine-patch");
        assert_eq!(line["pixels"], 120 * 80);
        assert!(line["median_ns"].as_u64().unwrap() > 0);
        let picture = folder.picture("out.png");
        let map = grey16(&picture);
        assert_eq!(map.dimensions(), (120, 80));
        let max = f64::from(*map.iter().max().unwrap()) / 65535.0;
        // Half a step of 16-bit rounding.
        assert!(
            (max - line["max_density"].as_f64().unwrap()).abs() < 0.6 / 65535.0,
            "{max}"
        );
    }

    #[test]
    fn peaks_without_umbra_are_the_true_ones() {
        // The light is above the casters' centres, which are pixel centres.
        for (surface, peak) in [
            (
                r#"{"shape": "rrect", "x": 20.5, "y": 28.5, "w": 200, "h": 4, "elevation": 8}"#,
                0.198,
            ),
            (
                r#"{"shape": "rrect", "x": 108.5, "y": 18.5, "w": 24, "h": 24, "radius": 4, "elevation": 24}"#,
                0.121,
            ),
        ] {
            let folder = Folder::with_scene(format!(
                r#"{{"canvas": [241, 61], "light": {{"x": 120.5, "y": 30.5, "z": 500, "radius": 800}}, "surfaces": [{surface}]}}"#
            ));
            for (method, used) in [("auto", "nine-patch"), ("exact", "exact"), ("mesh", "mesh")] {
                let line = folder.density(&format!("-o out.png --method {method}"));
                assert_eq!(line["method"], used);
                // The peaks are given to three digits.
                let max = line["max_density"].as_f64().unwrap();
                assert!((max - peak).abs() < 0.002, "{method}: {max}, not {peak}");
            }
        }
    }

    /// Cards are for any method; a polygon is none for `nine-patch`, and a penumbra of 0.8 px is too narrow for `grid`.
    #[test]
    fn the_methods_that_drew_are_told() {
        let scene = |surfaces: &str| {
            Folder::with_scene(format!(
                r#"{{"canvas": [100, 60], "light": {{"x": 50, "y": 0, "z": 600, "radius": 800}}, "surfaces": [{surfaces}]}}"#
            ))
        };
        let card = |elevation: f32| {
            format!(
                r#"{{"shape": "rrect", "x": 10, "y": 10, "w": 30, "h": 30, "elevation": {elevation}}}"#
            )
        };
        let star =
            r#"{"shape": "polygon", "points": [[60, 10], [90, 20], [60, 50]], "elevation": 8}"#;
        let both = scene(&format!("{}, {star}", card(6.0)));
        let used = |folder: &Folder, method: &str| {
            let line = folder.density(&format!("-o out.png --method {method}"));
            line["method"].as_str().unwrap().to_owned()
        };
        assert_eq!(used(&both, "nine-patch"), "direct+nine-patch");
        assert_eq!(used(&both, "direct"), "direct");
        assert_eq!(used(&scene(&card(16.0)), "grid"), "grid");
        assert_eq!(used(&scene(&card(0.6)), "grid"), "direct");
        assert_eq!(used(&scene(&card(0.0)), "mesh"), "none");
        assert_eq!(used(&with_tilted_and_image(), "mesh"), "image+tilted");
    }

    #[test]
    fn methods_agree_within_the_tolerance() {
        let folder = Folder::with_scene(ROW.replace(r#""elevation": 2,"#, r#""elevation": 4,"#));
        folder.density("-o exact.png --method exact");
        folder.density("-o mesh.png --method mesh --tolerance 1");
        let (exact, mesh) = (folder.picture("exact.png"), folder.picture("mesh.png"));
        let pixels = grey16(&exact).iter().zip(grey16(&mesh).iter());
        let worst = pixels.map(|(a, b)| a.abs_diff(*b)).max().unwrap();
        assert!(worst <= LEVEL, "{worst} of 65535");
    }

    #[test]
    fn opaque_blanks_what_opaque_casters_cover() {
        let folder = Folder::with_scene(
            r#"{"canvas": [120, 40], "light": {"x": 60, "y": 20, "z": 600, "radius": 800}, "surfaces": [
                {"shape": "rrect", "x": 10, "y": 10, "w": 40, "h": 20, "elevation": 4},
                {"shape": "rrect", "x": 70, "y": 10, "w": 40, "h": 20, "elevation": 4, "opacity": 0.5}]}"#,
        );
        let whole = folder.density("-o whole.png");
        let open = folder.density("-o open.png --opaque");
        assert!(whole["max_density"].as_f64() > open["max_density"].as_f64());
        let (whole, open) = (folder.picture("whole.png"), folder.picture("open.png"));
        let (whole, open) = (grey16(&whole), grey16(&open));
        for (x, y, &Luma([density])) in whole.enumerate_pixels() {
            let is_covered = (10..50).contains(&x) && (10..30).contains(&y);
            assert!(!is_covered || density > 0);
            let expected = if is_covered { 0 } else { density };
            assert_eq!(open.get_pixel(x, y).0, [expected], "at {x}, {y}");
        }
    }

    #[test]
    fn a_caster_of_many_more_pixels_than_the_picture_covers_it() {
        // Its shadow is 1.6e10 pixels long, more than an `i32` counts.
        let folder = Folder::with_scene(
            r#"{"canvas": [0.05, 0.05], "scale": 1024, "light": {"x": 0, "y": 0, "z": 600, "radius": 800}, "surfaces": [
                {"shape": "rrect", "x": -1000, "y": -1000, "w": 1.6e7, "h": 1.6e7, "elevation": 1}]}"#,
        );
        assert_eq!(folder.density("-o out.png")["max_density"], 1.0);
        folder.succeed("render scene.json -o out.png");
    }

    #[test]
    fn repeating_draws_the_same() {
        let folder = Folder::with_scene(CARD);
        let once = folder.density("-o once.png");
        let often = folder.density("-o often.png --repeat 5");
        assert_eq!(once["max_density"], often["max_density"]);
        assert_eq!(
            fs::read(folder.file("once.png")).unwrap(),
            fs::read(folder.file("often.png")).unwrap()
        );
    }
}

mod mesh {
    use super::*;

    fn shadows(folder: &Folder, tolerance: &str) -> Vec<Value> {
        folder.succeed(&format!(
            "mesh scene.json -o out.json --tolerance {tolerance}"
        ));
        let value: Value = serde_json::from_str(&folder.text("out.json")).unwrap();
        assert_eq!(value.as_object().unwrap().len(), 1);
        value["shadows"].as_array().unwrap().clone()
    }

    fn numbers(value: &Value) -> Vec<f64> {
        let values = value.as_array().unwrap();
        values.iter().map(|v| v.as_f64().unwrap()).collect()
    }

    fn length(value: &Value) -> usize {
        value.as_array().unwrap().len()
    }

    #[test]
    fn quick_meshes_keep_the_tolerance_with_more_triangles_and_few_have_fewer() {
        let folder = Folder::with_scene(ROW);
        let [few, usual, quick] = ["4 --few", "4", "4 --quick"].map(|how| {
            let shadows = shadows(&folder, how);
            assert!(
                shadows
                    .iter()
                    .all(|shadow| shadow["error_levels"].as_f64().unwrap() <= 4.0)
            );
            let counts = shadows.iter().map(|shadow| length(&shadow["indices"]));
            counts.sum::<usize>()
        });
        assert!(few < usual && usual < quick, "{few}, {usual}, {quick}");
    }

    #[test]
    fn json_holds_one_mesh_a_surface_in_the_order_of_the_file() {
        let folder = Folder::with_scene(ROW);
        for tolerance in [0.5, 4.0, 64.0] {
            let shadows = shadows(&folder, &tolerance.to_string());
            assert_eq!(shadows.len(), 4);
            for shadow in &shadows {
                let keys: Vec<&String> = shadow.as_object().unwrap().keys().collect();
                let named = [
                    "densities",
                    "error_levels",
                    "indices",
                    "light",
                    "positions",
                    "surface",
                ];
                assert_eq!(keys, named);
                let error = shadow["error_levels"].as_f64().unwrap();
                assert!((0.0..=tolerance).contains(&error), "{error} of {tolerance}");
                let densities = numbers(&shadow["densities"]);
                assert!(
                    densities
                        .iter()
                        .all(|density| (0.0..=1.0).contains(density))
                );
                assert_eq!(length(&shadow["positions"]), densities.len());
                let indices = numbers(&shadow["indices"]);
                assert_eq!(indices.len() % 3, 0);
                assert!(indices.iter().all(|&index| index < densities.len() as f64));
            }
            // At elevation 0 there is no shadow.
            assert_eq!(length(&shadows[1]["indices"]), 0);
            let middles: Vec<f64> = [0, 2, 3]
                .into_iter()
                .map(|surface: usize| {
                    let positions = shadows[surface]["positions"].as_array().unwrap();
                    let xs: Vec<f64> = positions.iter().map(|place| numbers(place)[0]).collect();
                    xs.iter().sum::<f64>() / xs.len() as f64
                })
                .collect();
            assert!(middles.is_sorted(), "{middles:?}");
        }
    }

    #[test]
    fn what_keeps_a_mesh_from_its_tolerance_is_told() {
        let folder = Folder::with_scene(
            r#"{"canvas": [200, 200], "light": {"x": 80, "y": 30, "z": 300, "radius": 120}, "surfaces": [
                {"shape": "rrect", "x": 50, "y": 60, "w": 60, "h": 40, "elevation": 20,
                 "tilt": {"pivot": [80, 80], "axis": [0, 1], "degrees": 90}}]}"#,
        );
        let run = folder.run("mesh scene.json -o out.json --tolerance 4");
        assert_eq!(run.status, Some(0));
        let complaint =
            "penumbral: surfaces[0]: the mesh is not complete: its penumbra is too narrow";
        assert!(run.stderr.starts_with(complaint), "{}", run.stderr);
    }

    #[test]
    fn tilted_surfaces_have_their_own_under_each_light_and_images_none() {
        let folder = with_tilted_and_image();
        let run = folder.run("mesh scene.json -o out.json");
        assert_eq!(run.status, Some(0));
        let complaint = "penumbral: surfaces[1]: the shadow of an image has no triangles";
        assert!(run.stderr.starts_with(complaint), "{}", run.stderr);
        let value: Value = serde_json::from_str(&folder.text("out.json")).unwrap();
        let shadows = value["shadows"].as_array().unwrap();
        let numbered: Vec<_> = shadows
            .iter()
            .map(|shadow| (shadow["surface"].as_str(), shadow["light"].as_u64()))
            .collect();
        let of_light = |light| (Some("surfaces[0]"), Some(light));
        assert_eq!(numbered, [of_light(0), of_light(1)]);
        let pose = Pose::turned(40.0, [80.0, 80.0], [0.0, 1.0], 0.5).unwrap();
        let card = Shape::rect(50.0, 60.0, 60.0, 40.0).unwrap();
        for (shadow, x) in shadows.iter().zip([80.0, 180.0]) {
            let light = Light::new([x, 30.0, 300.0], 120.0).unwrap();
            let mesh = light
                .cast_posed(&card, &pose, 0.0)
                .unwrap()
                .mesh(Tolerance::ONE_LEVEL);
            let indices: Vec<f64> = mesh.indices().iter().map(|&i| i.into()).collect();
            assert_eq!(numbers(&shadow["indices"]), indices);
            let places = shadow["positions"].as_array().unwrap();
            let densities = numbers(&shadow["densities"]);
            assert_eq!(places.len(), mesh.vertices().len());
            for ((place, density), vertex) in places.iter().zip(densities).zip(mesh.vertices()) {
                let place: Vec<f32> = numbers(place).into_iter().map(|at| at as f32).collect();
                assert_eq!(place, vertex.position);
                assert_eq!(density as f32, vertex.density);
            }
        }
    }

    #[test]
    fn obj_holds_the_same_triangles() {
        let folder = Folder::with_scene(ROW);
        let shadows = shadows(&folder, "4");
        folder.succeed("mesh scene.json -o out.obj --tolerance 4");
        let text = folder.text("out.obj");
        let lines = |kind: &str| -> Vec<Vec<&str>> {
            text.lines()
                .map(|line| line.split(' ').collect::<Vec<_>>())
                .filter(|words| words[0] == kind)
                .collect()
        };
        let (names, vertices, faces) = (lines("o"), lines("v"), lines("f"));
        assert_eq!(
            names.len() + vertices.len() + faces.len(),
            text.lines().count()
        );
        let names: Vec<&str> = names.iter().map(|words| words[1]).collect();
        assert_eq!(names, ["round_button", "print", "surfaces[2]", "L"]);
        let count =
            |key: &str| -> usize { shadows.iter().map(|shadow| length(&shadow[key])).sum() };
        assert_eq!(vertices.len(), count("positions"));
        assert_eq!(faces.len() * 3, count("indices"));
        for face in &faces {
            assert_eq!(face.len(), 4);
            for corner in &face[1..] {
                assert!((1..=vertices.len()).contains(&corner.parse().unwrap()));
            }
        }
    }

    #[test]
    fn svg_holds_a_group_a_surface_and_all_that_casts() {
        let folder = Folder::with_scene(ROW);
        folder.succeed("mesh scene.json -o out.svg --tolerance 4");
        let text = folder.text("out.svg");
        assert!(text.starts_with("<svg ") && text.ends_with("</svg>\n"));
        assert_eq!(text.matches("<g ").count(), 4);
        assert!(text.matches("<path ").count() > 100);
        // From the round button's shadow at 100 - 82 * 600/594 - 800 * 6/594 to the L's at 100 + 90 * 600/598 + 800 * 2/598,
        // in whole units.
        assert_eq!(svg_number(&text, "width"), 193.0 - 9.0);
    }
}

mod explain {
    use super::*;

    #[test]
    fn surfaces_are_those_of_the_file_as_in_meshes() {
        // The first member is outside of the clip.
        let folder = Folder::with_scene(
            r#"{"canvas": [100, 100], "light": {"x": 50, "y": 0, "z": 600, "radius": 800}, "surfaces": [
                {"group": [
                    {"shape": "circle", "cx": 10, "cy": 10, "r": 5, "elevation": 4},
                    {"shape": "circle", "cx": 50, "cy": 50, "r": 5, "elevation": 4},
                    {"group": [{"shape": "circle", "cx": 70, "cy": 50, "r": 5, "elevation": 1}], "elevation": 2}
                ], "elevation": 2, "clip": {"shape": "rrect", "x": 30, "y": 30, "w": 60, "h": 60}},
                {"shape": "circle", "cx": 10, "cy": 10, "r": 5, "elevation": 6, "name": "last"}]}"#,
        );
        let text = folder.succeed("explain scene.json");
        let heads: Vec<&str> = text.lines().filter(|line| !line.starts_with(' ')).collect();
        let expected = [
            "surfaces[0].group[1], elevation 6",
            "surfaces[0].group[2].group[0], elevation 5",
            r#"surfaces[1] "last", elevation 6"#,
        ];
        assert_eq!(heads, expected);
        folder.succeed("mesh scene.json -o out.json");
        let value: Value = serde_json::from_str(&folder.text("out.json")).unwrap();
        let shadows = value["shadows"].as_array().unwrap();
        let fields: Vec<_> = shadows.iter().map(|shadow| &shadow["surface"]).collect();
        let expected = [
            "surfaces[0].group[1]",
            "surfaces[0].group[2].group[0]",
            "surfaces[1]",
        ];
        assert_eq!(fields, expected);
        folder.succeed("mesh scene.json -o out.obj");
        let text = folder.text("out.obj");
        let names: Vec<&str> = text
            .lines()
            .filter_map(|line| line.strip_prefix("o "))
            .collect();
        assert_eq!(names, [expected[0], expected[1], "last"]);
    }

    #[test]
    fn tilted_surfaces_and_images_are_told_apart_under_each_light() {
        let text = with_tilted_and_image().succeed("explain scene.json");
        let lines: Vec<&str> = text.lines().collect();
        let heads = [0, 3, 6, 8].map(|line: usize| lines[line]);
        let expected = [
            "surfaces[0], elevation 40, light 0",
            "surfaces[0], elevation 40, light 1",
            "surfaces[1], elevation 8, light 0",
            "surfaces[1], elevation 8, light 1",
        ];
        assert_eq!((heads, lines.len()), (expected, 10), "{text}");
        assert!(lines[1].starts_with("  bounds  x ") && lines[1] != lines[4]);
        assert_eq!(
            lines[7],
            "  method  by the alpha of an image of 2 x 2 pixels"
        );
    }

    #[test]
    fn each_surface_has_its_numbers() {
        let folder = Folder::with_scene(
            r#"{"canvas": [300, 200], "scale": 2, "light": {"x": 150, "y": 100, "z": 500, "radius": 200}, "surfaces": [
                {"shape": "rrect", "x": 50, "y": 50, "w": 200, "h": 100, "elevation": 100, "name": "card"},
                {"shape": "circle", "cx": 150, "cy": 100, "r": 10, "elevation": 100},
                {"shape": "circle", "cx": 50, "cy": 50, "r": 10, "elevation": 0}]}"#,
        );
        // Seen from 500, a caster at 100 is larger by 5/4, through discs of 200 * 100/400.
        let expected = [
            r#"surfaces[0] "card", elevation 100"#,
            "  scale   1.2500",
            "  radius  50.000 units, 100.000 px",
            "  umbra   x 75.00 to 225.00, y 87.50 to 112.50",
            "  bounds  x -25.00 to 325.00, y -12.50 to 212.50",
            "  method  nine-patch: ",
            "  instead   exact: ",
            "  instead   direct: ",
            "  instead   grid: ",
            "  takes     nine-patch: ",
            "  mesh      about ",
            "surfaces[1], elevation 100",
            "  scale   1.2500",
            "  radius  50.000 units, 100.000 px",
            "  umbra   none",
            "  bounds  x 87.50 to 212.50, y 37.50 to 162.50",
            "  method  nine-patch: ",
            "  instead   exact: ",
            "  instead   direct: ",
            "  instead   grid: ",
            "  takes     nine-patch: ",
            "  mesh      about ",
            "surfaces[2], elevation 0",
            "  no shadow on the ground",
        ];
        let text = folder.succeed("explain scene.json");
        assert_eq!(text.lines().count(), expected.len(), "{text}");
        for (line, expected) in text.lines().zip(expected) {
            // Why a method was chosen, and what it would cost, is not the test's to word.
            assert!(
                line == expected || expected.ends_with(' ') && line.starts_with(expected),
                "{line:?}, not {expected:?}"
            );
        }
    }
}

mod failures {
    use super::*;

    #[test]
    fn wrong_usage_is_status_2() {
        let folder = Folder::with_scene(CARD);
        let before = folder.contents();
        for arguments in [
            "",
            "draw scene.json",
            "render",
            "render scene.json",
            "render -o out.png",
            "density scene.json",
            "mesh scene.json",
            "explain",
            "explain scene.json -o out.txt",
            "render scene.json -o out.png --sharp",
            "render scene.json scene.json -o out.png",
            "render scene.json -o out.svg --tolerance",
            "render scene.json -o out.svg --tolerance 0",
            "render scene.json -o out.svg --tolerance=-1",
            "density scene.json -o out.png --repeat -1",
            "render scene.json -o out.svg --tolerance abc",
            "render scene.json -o out.svg --tolerance NaN",
            "mesh scene.json -o out.json --tolerance 65",
            "density scene.json -o out.png --tolerance inf",
            "density scene.json -o out.png --method gouraud",
            "density scene.json -o out.png --repeat 0",
            "density scene.json -o out.png --repeat 1.5",
        ] {
            let run = folder.run(arguments);
            assert_eq!(run.status, Some(2), "`{arguments}`: {run:?}");
            assert!(run.stdout.is_empty() && !run.stderr.is_empty());
        }
        assert_eq!(folder.contents(), before);
    }

    #[test]
    fn negative_numbers_are_taken_for_numbers() {
        let folder = Folder::with_scene(CARD);
        let run = folder.run("mesh scene.json -o out.svg --tolerance -1");
        assert_eq!(run.status, Some(2));
        assert!(run.stderr.contains("tolerance is -1"), "{}", run.stderr);
    }

    #[test]
    fn a_tolerance_that_nothing_takes_is_refused() {
        let folder = Folder::with_scene(CARD);
        assert_all([
            folder.refuse(
                "render scene.json -o out.png --tolerance 64",
                "--tolerance is for an SVG",
            ),
            folder.refuse(
                "density scene.json -o out.png --method exact --tolerance 1",
                "--tolerance is for other methods than exact",
            ),
        ]);
    }

    #[test]
    fn images_that_are_no_png_are_refused() {
        let surface = r#"{"shape": "rrect", "x": 1, "y": 2, "w": 3, "h": 4, "elevation": 8, "image": "image.png"}"#;
        let folder = Folder::with_scene(card_of(surface));
        for contents in ["no image", "\u{0}", "GIF89a and so on", ""] {
            fs::write(folder.file("image.png"), contents).unwrap();
            let refused = folder.refuse("explain scene.json", "image.png: not a PNG image");
            assert_all([refused]);
        }
    }

    #[test]
    fn help_and_version_are_no_failures() {
        let folder = Folder::new();
        for arguments in ["--help", "help", "render --help", "--version"] {
            assert!(!folder.succeed(arguments).is_empty());
        }
    }

    #[test]
    fn scenes_with_a_wrong_value_are_refused() {
        // What is replaced in the card's file, by what, and what the message must say of it.
        #[rustfmt::skip]
        let cases = [
            (r#""scale": 1"#, r#""scael": 1"#, "unknown field `scael`"),
            (r#""z": 600"#, r#""z": 600, "height": 2"#, "unknown field `height`"),
            (r#""opacity": 1"#, r#""alpha": 1"#, "unknown field `alpha`"),
            (r#""opacity": 1"#, r#""al\npha": 1"#, "unknown field `al"),
            (r#""opacity": 1"#, r#""cx": 1"#, "field `cx` is not one of this shape's"),
            (r#""opacity": 1"#, r#""opacity": 1, "x": 11"#, "duplicate field `x`"),
            (r#""scale": 1"#, r#""scale": 1, "canvas": [60, 40]"#, "duplicate field `canvas`"),
            (r#""z": 600"#, r#""z": 600, "x": 1"#, "duplicate field `x`"),
            (r#""x": 10"#, r#""x": "10""#, r#"surfaces[0].x: invalid type: string "10""#),
            (r#""x": 10"#, r#""x": "NaN""#, r#"surfaces[0].x: invalid type: string "NaN""#),
            (r#""x": 10"#, r#""x": NaN"#, "surfaces[0]: expected value"),
            (r#""x": 10"#, r#""x": [10]"#, "surfaces[0].x: invalid type"),
            (r#""x": 10"#, r#""x": 1e999"#, "surfaces[0].x: number out of range"),
            (r#""x": 10"#, r#""x": -1e39"#, "x is -inf: give a finite number, no larger than an f32 holds"),
            (r#""x": 10"#, r#""x": 1e9"#, "x is 1e9"),
            (r#""x": 10, "#, "", "needs the field `x`"),
            (r#""w": 40"#, r#""w": 0"#, ": w is 0"),
            (r#""h": 20"#, r#""h": -20"#, ": h is -20"),
            (r#""radius": 4"#, r#""radius": -4"#, "radius is -4"),
            (r#""radius": 4"#, r#""radii": [1, 2, 3]"#, "surfaces[0].radii: invalid length 3"),
            (r#""radius": 4"#, r#""radius": 4, "radii": [1, 2, 3, 4]"#, "`radius` and `radii` exclude each other"),
            (r#""elevation": 8"#, r#""elevation": 600"#, "elevation 600 is not below the light at z = 600"),
            (r#""elevation": 8"#, r#""elevation": 700"#, "elevation 700 is not below the light at z = 600"),
            (r#""elevation": 8"#, r#""elevation": -1"#, "elevation -1 is below"),
            (r#""elevation": 8, "#, "", "missing field `elevation`"),
            (r#""opacity": 1"#, r#""opacity": 2"#, "opacity is 2"),
            (r##""#ff0000""##, r#""red""#, r#"fill "red" is not a colour"#),
            (r##""#ff0000""##, r##""#ff000""##, r##"fill "#ff000" is not a colour"##),
            (r##""#ff0000""##, "255", "surfaces[0].fill: invalid type: integer `255`"),
            (r##""#eeeeee""##, r##""#eeeeeg""##, r##"background: "#eeeeeg" is not a colour"##),
            (r##""#eeeeee""##, r##""#eeeeee80""##, "background has the alpha 128"),
            (r#""key": 0.2"#, r##""key": 0.2, "shadow_color": "#ff000080""##, "shadow_color: shadow_color has the alpha 128"),
            (r#""rrect""#, r#""square""#, "shape \"square\" is unknown"),
            (r#""rrect""#, r#""squ\nare""#, "shape \"squ"),
            ("[60, 40]", "[60]", "canvas: invalid length 1"),
            ("[60, 40]", "[60, 0]", "canvas height is 0"),
            ("[60, 40]", "[-60, 40]", "canvas width is -60"),
            ("[60, 40]", "[1000000, 1000000]", "1000000 x 1000000 pixels"),
            (r#""scale": 1"#, r#""scale": 0"#, "scale is 0"),
            (r#""scale": 1"#, r#""scale": 1000"#, "60000 x 40000 pixels"),
            (r#""scale": 1"#, r#""scale": 2000"#, "scale is 2000"),
            (r#""key": 0.2"#, r#""key": 1.5"#, "key: key is 1.5"),
            (r#""ambient": 0.05"#, r#""ambient": -1"#, "ambient: ambient is -1"),
            (r#""z": 600"#, r#""z": 0"#, "light: z is 0"),
            (r#""x": 30, "y": 20, "z": 600, "radius": 800"#, r#""offset": [0, 2000], "spread": 0.5"#, "light: offset[1] is 2000"),
            (r#""x": 30, "y": 20, "z": 600, "radius": 800"#, r#""offset": [0, 1], "spread": -1"#, "light: spread is -1"),
            (r#""key": 0.2"#, r#""key": 0.2, "lights": [{"x": 1e9, "y": 0, "z": 9, "radius": 1, "key": 0.1}]"#, "lights[0]: x is 1e9"),
            (r#""radius": 800"#, r#""radius": -800"#, "light: radius is -800"),
            (r#", "radius": 800"#, "", "light: a light needs `x`, `y`, `z` and `radius`"),
            (r#""surfaces": ["#, r#""surfaces": [8, "#, "surfaces[0]: invalid type: integer `8`"),
        ];
        assert_all(cases.into_iter().flat_map(|(old, new, part)| {
            let folder = Folder::with_scene(card_with(old, new));
            COMMANDS.map(|command| folder.refuse(command, part))
        }));
    }

    #[test]
    fn lists_of_values_without_their_fields_are_refused() {
        // Their meaning would hang on the order in which the program declares its fields.
        let light = card_with(
            r#"{"x": 30, "y": 20, "z": 600, "radius": 800}"#,
            "[30, 20, 600, 800]",
        );
        let surface = card_of(&format!(
            r#"["circle", 8, 1, null, null{}, 9, 9, 5{}]"#,
            ", null".repeat(6),
            ", null".repeat(6)
        ));
        let cases = [(light, "light"), (surface, "surfaces[0]")];
        assert_all(cases.into_iter().flat_map(|(scene, part)| {
            let folder = Folder::with_scene(scene);
            COMMANDS.map(|command| folder.refuse(command, part))
        }));
    }

    #[test]
    fn surfaces_that_are_no_shape_are_refused() {
        #[rustfmt::skip]
        let cases = [
            (r#"{"shape": "circle", "cx": 9, "cy": 9, "r": 0, "elevation": 8}"#, ": r is 0"),
            (r#"{"shape": "circle", "cx": 1e9, "cy": 9, "r": 5, "elevation": 8}"#, ": cx is 1e9"),
            (r#"{"shape": "circle", "cx": 9, "cy": 9, "r": 5, "rx": 5, "elevation": 8}"#, "field `rx` is not one of this shape's"),
            (r#"{"shape": "ellipse", "cx": 9, "cy": 9, "rx": 5, "ry": -5, "elevation": 8}"#, ": ry is -5"),
            (r#"{"shape": "rrect", "x": 1, "y": 2, "w": -3, "h": 4, "elevation": 8}"#, ": w is -3"),
            (r#"{"shape": "path", "d": "M 0 0 L 9 0 L 0 9", "stroke": {"width": 2}, "fill_rule": "evenodd", "elevation": 8}"#, "leave out `fill_rule`"),
            (r#"{"shape": "path", "d": "M 0 0 L 9 0 L 0 9", "stroke": 2, "elevation": 8}"#, "surfaces[0].stroke: invalid type: integer `2`, expected an object"),
            (r#"{"shape": "rrect", "x": 1, "y": 2, "w": 3, "h": 4, "radii": [1, -2, 3, 4], "elevation": 8}"#, ": radii is -2"),
            (r#"{"shape": "rrect", "x": 1, "y": 2, "w": 3, "h": 4, "radii": ["a", 2, 3, 4], "elevation": 8}"#, "expected a number or a pair of them"),
            (r#"{"shape": "rrect", "x": 1, "y": 2, "w": 0, "h": 4, "corners": [1, 2, 3, 4]}"#, ": w is 0"),
            (r#"{"shape": "rrect", "x": 1, "y": 2, "w": 3, "h": 4, "elevation": 8, "tilt": {"pivot": [1e9, 2], "axis": [1, 0], "degrees": 9}}"#, ": tilt.pivot is 1e9"),
            (r#"{"shape": "rrect", "x": 1, "y": 2, "w": 3, "h": 4, "elevation": 8, "struct beam": 1}"#, "unknown field `struct beam`"),
            (r#"{"shape": "rrect", "x": 1, "y": 2, "w": 3, "h": 4, "elevation": 8, "image": "none.png", "tilt": {"pivot": [1, 2], "axis": [1, 0], "degrees": 9}}"#, "an image is not tilted"),
            (r#"{"shape": "path", "d": "M 0 0 L 9 0", "stroke": [2], "elevation": 8}"#, "surfaces[0].stroke: invalid type: sequence, expected an object"),
            (r#"{"shape": "path", "d": "M 0 0 L 9 0", "stroke": {"width": -2}, "elevation": 8}"#, ": stroke.width is -2"),
            (r#"{"shape": "path", "d": "M 0 0 L 9 0", "stroke": {"width": 2, "miter_limit": 0.5}, "elevation": 8}"#, ": stroke.miter_limit is 0.5"),
            (r#"{"shape": "path", "d": "M 0 0 L 9 0", "stroke": {"width": 2, "miter_limit": 2, "join": "round"}, "elevation": 8}"#, "stroke.miter_limit is of the join miter"),
            #[cfg(feature = "finish")]
            (r#"{"shape": "circle", "cx": 9, "cy": 9, "r": 5, "elevation": 8, "finish": {"shading": "phong"}}"#, "finish.shading is of a rim"),
            (r#"{"shape": "path", "d": "M 0 0 L 9 0", "stroke": {"width": 2, "cap": "flat"}, "elevation": 8}"#, ": stroke.cap \"flat\" is unknown"),
            (r#"{"shape": "path", "d": "M 0 0 L 9 1e9", "stroke": {"width": 2}, "elevation": 8}"#, ": coordinate of d is 1e9"),
            (r#"{"shape": "circle", "cx": "9", "cy": 9, "r": 5, "elevation": 8}"#, "expected a number"),
            (r#"{"shape": "polygon", "elevation": 8}"#, "a polygon needs `points` or `rings`"),
            (r#"{"shape": "polygon", "points": [], "elevation": 8}"#, "polygon encloses nothing"),
            (r#"{"shape": "polygon", "points": [[0, 0], [9, 9]], "elevation": 8}"#, "polygon encloses nothing"),
            (r#"{"shape": "polygon", "points": [[0, 0], [9, 9], [9]], "elevation": 8}"#, "surfaces[0].points[2]: invalid length 1"),
            (r#"{"shape": "polygon", "points": [[0, 0], [5, 5], [9, 9], [0, 1e9]], "elevation": 8}"#, ": coordinate of points is 1e9"),
            (r#"{"shape": "polygon", "points": [[0, 5], [5, 5], [9, 5]], "elevation": 8}"#, ": height of points is 0"),
            (r#"{"shape": "polygon", "rings": [[[5, 0], [5, 5], [5, 9]]], "elevation": 8}"#, ": width of rings is 0"),
            (r#"{"shape": "polygon", "rings": [[[0, 0], [5, 5], [-1e9, 9]]], "elevation": 8}"#, ": coordinate of rings is -1e9"),
            (r#"{"group": [], "elevation": 1e9}"#, "surfaces[0]: elevation is 1e9"),
            (r#"{"shape": "polygon", "rings": [], "elevation": 8}"#, "polygon encloses nothing"),
            (r#"{"shape": "polygon", "points": [[0, 0], [9, 0], [0, 9]], "fill_rule": "odd", "elevation": 8}"#, "fill_rule \"odd\" is unknown"),
            (r#"{"shape": "path", "elevation": 8}"#, "needs the field `d`"),
            (r#"{"shape": "path", "d": "", "elevation": 8}"#, "path encloses nothing"),
            (r#"{"shape": "path", "d": "M 5 5", "elevation": 8}"#, "path encloses nothing"),
            (r#"{"shape": "path", "d": "M 0 0 L 9 0 L", "elevation": 8}"#, "SVG path data, character 14"),
            (r#"{"shape": "path", "d": "M 0 0 L 9 0 X 9 9", "elevation": 8}"#, "SVG path data, character 13"),
            (r#"{"shape": "path", "d": "L 9 0 L 0 9", "elevation": 8}"#, "SVG path data, character 1"),
            (r#"{"shape": "path", "d": "M 0 0 L 1e9 0 L 0 9", "elevation": 8}"#, ": coordinate of d is 1e9"),
            (r#"{"shape": "path", "d": "M 0 0 H 9 H 5 Z", "elevation": 8}"#, ": height of d is 0"),
            (r#"{"shape": "path", "d": "M 0 0 A 1e9 1e9 0 0 0 9 9", "elevation": 8}"#, ": arc of d is "),
            (r#"{"shape": "path", "d": ["M 0 0"], "elevation": 8}"#, "surfaces[0].d: invalid type"),
        ];
        assert_all(cases.into_iter().flat_map(|(surface, part)| {
            let folder = Folder::with_scene(card_of(surface));
            COMMANDS.map(|command| folder.refuse(command, part))
        }));
    }

    #[test]
    fn files_that_are_no_scene_are_refused() {
        let brackets = "[".repeat(100_000);
        #[rustfmt::skip]
        let cases: [(Vec<u8>, &str); 10] = [
            ("".into(), "the text ends within"),
            ("\n\n \n".into(), "the text ends within"),
            (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".into(), "not UTF-8 text from byte 0 on"),
            (CARD.as_bytes()[..CARD.len() / 2].into(), "the text ends within"),
            (CARD.as_bytes()[..CARD.len() - 1].into(), "the text ends within"),
            (format!("{CARD} {{}}").into(), "more follows: remove it"),
            (brackets.clone().into(), "line 1"),
            (format!(r#"{{"surfaces": [{brackets}"#).into(), "surfaces[0]"),
            (card_of(&format!("{brackets}{}", brackets.replace('[', "]"))).into(), "surfaces[0]"),
            (card_of(&vec!["8"; 100_000].join(",")).into(), "100000 surfaces"),
        ];
        assert_all(cases.into_iter().flat_map(|(contents, part)| {
            let folder = Folder::with_scene(contents);
            COMMANDS.map(|command| folder.refuse(command, part))
        }));
    }

    #[test]
    fn what_cannot_be_read_is_refused() {
        let missing = Folder::new();
        assert_all(COMMANDS.map(|command| missing.refuse(command, "scene.json: ")));
        let folder = Folder::new();
        fs::create_dir(folder.file("scene.json")).unwrap();
        assert_all(COMMANDS.map(|command| folder.refuse(command, "scene.json: ")));
    }

    #[test]
    fn what_cannot_be_written_is_refused() {
        let folder = Folder::with_scene(CARD);
        fs::create_dir(folder.file("taken.png")).unwrap();
        // Folders without permission to write are no hindrance to the superuser, as whom tests may run.
        #[rustfmt::skip]
        let cases = [
            ("render scene.json -o missing/out.png", "missing/out.png: "),
            ("render scene.json -o scene.json/out.svg", "scene.json/out.svg: "),
            ("render scene.json -o taken.png", "taken.png: "),
            ("density scene.json -o missing/out.png", "missing/out.png: "),
            ("mesh scene.json -o missing/out.obj", "missing/out.obj: "),
            ("render scene.json -o out.gif", "out.gif: give an output that ends in .png or .svg"),
            ("render scene.json -o out", "out: give an output that ends in"),
            ("render scene.json -o .png", ".png: give an output that ends in"),
            ("render scene.json -o ..", "..: give an output that ends in"),
            ("density scene.json -o out.svg", "out.svg: give an output that ends in .png"),
            ("mesh scene.json -o out.png", "out.png: give an output that ends in .svg or .json or .obj"),
        ];
        assert_all(cases.map(|(arguments, part)| folder.refuse(arguments, part)));
    }

    #[test]
    fn an_earlier_output_gives_way_to_a_whole_one_only() {
        let folder = Folder::with_scene("{");
        fs::write(folder.file("out.svg"), "earlier").unwrap();
        assert_all([folder.refuse("render scene.json -o out.svg", "the text ends within")]);
        assert_eq!(folder.text("out.svg"), "earlier");
        fs::write(folder.file("scene.json"), CARD).unwrap();
        folder.succeed("render scene.json -o out.svg");
        assert!(folder.text("out.svg").starts_with("<svg "));
        assert_eq!(
            folder.contents().len(),
            2,
            "the scene and the picture alone"
        );
    }

    /// Whoever reads the old file goes on reading it: the new one is another, with its name.
    #[cfg(unix)]
    #[test]
    fn an_earlier_output_is_never_written_over() {
        let folder = Folder::with_scene(CARD);
        for (arguments, name) in [
            ("render scene.json -o out.png", "out.png"),
            ("mesh scene.json -o out.obj", "out.obj"),
            ("density scene.json -o out.png", "out.png"),
        ] {
            fs::write(folder.file(name), "earlier").unwrap();
            let earlier = fs::File::open(folder.file(name)).unwrap();
            folder.succeed(arguments);
            assert_eq!(io::read_to_string(earlier).unwrap(), "earlier");
            assert_ne!(fs::read(folder.file(name)).unwrap(), b"earlier");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_stay() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = Folder::with_scene(CARD);
        fs::create_dir(folder.file("pictures")).unwrap();
        for (link, target) in [
            ("link.svg", "pictures/out.svg"),
            ("second.svg", "link.svg"),
            ("round.svg", "round.svg"),
        ] {
            symlink(target, folder.file(link)).unwrap();
        }
        let is_link = |name| {
            fs::symlink_metadata(folder.file(name))
                .unwrap()
                .is_symlink()
        };
        // First there is nothing where the links lead to.
        for link in ["link.svg", "second.svg"] {
            folder.succeed(&format!("render scene.json -o {link}"));
            assert!(is_link("link.svg") && is_link("second.svg"));
            assert!(!is_link("pictures/out.svg"));
            assert!(folder.text("pictures/out.svg").starts_with("<svg "));
            fs::write(folder.file("pictures/out.svg"), "earlier").unwrap();
            let permissions = fs::Permissions::from_mode(0o640);
            fs::set_permissions(folder.file("pictures/out.svg"), permissions).unwrap();
        }
        folder.succeed("render scene.json -o link.svg");
        assert!(folder.text("link.svg").starts_with("<svg "));
        let mode = fs::metadata(folder.file("link.svg")).unwrap().permissions();
        assert_eq!(mode.mode() & 0o777, 0o640);
        assert_eq!(fs::read_dir(folder.file("pictures")).unwrap().count(), 1);
        assert_all([folder.refuse("render scene.json -o round.svg", "round.svg: ")]);
        // A device takes it as it is, and stays one.
        symlink("/dev/null", folder.file("null.svg")).unwrap();
        folder.succeed("render scene.json -o null.svg");
        assert!(is_link("null.svg") && folder.text("null.svg").is_empty());
    }

    #[test]
    fn who_kills_it_finds_the_old_file_or_the_new_one() {
        let folder = Folder::with_scene(card_with("[60, 40]", "[700, 500]"));
        let arguments = "density scene.json -o out.png";
        let start = Instant::now();
        folder.succeed(arguments);
        let (whole, time) = (fs::read(folder.file("out.png")).unwrap(), start.elapsed());
        let (mut killed, mut finished) = (0, 0);
        for part in 0..24 {
            fs::write(folder.file("out.png"), "earlier").unwrap();
            let mut child = folder
                .command(arguments)
                .stdout(Stdio::null())
                .spawn()
                .unwrap();
            thread::sleep(time.mul_f64(f64::from(part) / 20.0));
            // It may have ended by itself.
            let _ = child.kill();
            child.wait().unwrap();
            let found = fs::read(folder.file("out.png")).unwrap();
            assert!(
                found == b"earlier" || found == whole,
                "{} bytes",
                found.len()
            );
            killed += u32::from(found == b"earlier");
            finished += u32::from(found == whole);
        }
        println!("{killed} times the old file, {finished} times the new one");
        assert!(killed > 0);
    }

    #[test]
    fn files_without_an_end_are_refused() {
        // Longer than may be read, but of no blocks.
        let folder = Folder::new();
        let file = fs::File::create(folder.file("scene.json")).unwrap();
        file.set_len(MAX_SCENE_LENGTH as u64 + 1).unwrap();
        assert_all([folder.refuse(
            "explain scene.json",
            "67108865 bytes, over the limit of 67108864",
        )]);
        let points = vec!["[0, 0]"; MAX_SEGMENTS + 1].join(",");
        let surface = |points: &str| {
            card_of(&format!(
                r#"{{"shape": "polygon", "points": [{points}], "elevation": 8}}"#
            ))
        };
        let wide = Folder::with_scene(surface(&points));
        assert_all([wide.refuse(
            "explain scene.json",
            "1048577 polygon points, over the limit",
        )]);
        // Each within its own limit, but not all together.
        let spike = "[0, 0], [9, 0], [9, 9],".repeat(200_000);
        let many = vec![surface(&format!("{spike}[0, 9]")); 2];
        let (first, second) = (&many[0], &many[1]);
        let (head, _) = first.split_at(first.len() - 2);
        let (_, tail) = second.split_once(r#""surfaces": ["#).unwrap();
        let wide = Folder::with_scene(format!("{head},{tail}"));
        assert_all([wide.refuse(
            "explain scene.json",
            "1200000 vertices, over the limit of 1048576",
        )]);
    }

    #[test]
    fn a_caster_just_below_the_light_is_refused() {
        // The next f32 below 600: its shadow would reach 8e9 units.
        let folder =
            Folder::with_scene(card_with(r#""elevation": 8"#, r#""elevation": 599.99994"#));
        assert_all(COMMANDS.map(|command| folder.refuse(command, "elevation 599.9999")));
    }

    #[test]
    fn an_output_that_nobody_reads_is_no_panic() {
        let folder = Folder::with_scene(CARD);
        for arguments in ["explain scene.json", "density scene.json -o out.png"] {
            let (reader, writer) = io::pipe().unwrap();
            drop(reader);
            let output = folder
                .command(arguments)
                .stdout(writer)
                .stderr(Stdio::piped())
                .output()
                .unwrap();
            let message = String::from_utf8(output.stderr).unwrap();
            assert!(
                !message.contains("panicked"),
                "{arguments}: {}, {message}",
                output.status
            );
        }
    }
}
