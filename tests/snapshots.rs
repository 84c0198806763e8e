//! Pictures of scenes against those stored in `tests/snapshots`.
//!
//! The renderer draws by the exact density and promises the same bits on every machine: the tolerance is 0. Where a
//! picture differs, `target/snapshots` gets the expected one, the amplified difference and the actual one side by side.
//!
//! When a change is meant, `PENUMBRAL_BLESS=1 cargo test --features scene --test snapshots` writes all snapshots
//! anew. It fails nevertheless, so that nobody blesses by accident: look at what changed, then run the tests without.

#![expect(clippy::unwrap_used, reason = "what fails in a helper is the test")]

use std::path::{Path, PathBuf};
use std::{env, fs};

use penumbral::{Renderer, Scene, Tolerance};
use tiny_skia::{Pixmap, PixmapPaint, Transform};

/// The name of each picture, the folder of its scene, and the scale at which it is drawn.
const PICTURES: [(&str, &str, f32); 10] = [
    ("card", SNAPSHOTS, 1.0),
    ("layers", SNAPSHOTS, 1.0),
    ("outlines", SNAPSHOTS, 1.0),
    ("fine", SNAPSHOTS, 1.0),
    ("hard", SNAPSHOTS, 1.0),
    // Whole user interfaces, as small as shadows can still be told.
    ("app-bar-notch", SCENES, 0.25),
    ("card-list", SCENES, 0.25),
    ("floating-button", SCENES, 0.25),
    ("menu-over-cards", SCENES, 0.25),
    ("shapes", SCENES, 0.16),
];

const SNAPSHOTS: &str = "tests/snapshots";
const SCENES: &str = "fixtures/scenes";

/// A repository keeps each version of a snapshot for ever.
const MAX_PNG_BYTES: u64 = 8 << 10;
const MAX_SVG_BYTES: u64 = 64 << 10;

/// What a report counts pixels over: how many there would be with another tolerance.
const THRESHOLDS: [u8; 5] = [0, 1, 2, 4, 8];

/// How many times a difference is larger in the picture of it: one level shows.
const AMPLIFICATION: u8 = 32;

fn path(folder: &str, file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join(folder)
        .join(file)
}

fn scene_text(folder: &str, name: &str) -> String {
    fs::read_to_string(path(folder, &format!("{name}.json"))).unwrap()
}

fn render(text: &str, scale: f32) -> Pixmap {
    let scene = Scene::from_json(text).unwrap().with_scale(scale).unwrap();
    let grid = scene.grid().unwrap();
    let mut pixmap = Pixmap::new(grid.width(), grid.height()).unwrap();
    Renderer::new().render(&scene, &mut pixmap).unwrap();
    pixmap
}

/// The stored bytes, once `actual` has taken their place if blessing is asked for.
fn stored(file: &str, actual: &[u8]) -> Result<Vec<u8>, String> {
    let path = path(SNAPSHOTS, file);
    if env::var("PENUMBRAL_BLESS").as_deref() == Ok("1") {
        fs::write(&path, actual).unwrap();
        return Err(format!("{file}: written anew"));
    }
    fs::read(&path).map_err(|error| format!("{file}: {error}"))
}

/// What is different between two pictures, or none where nothing is.
fn difference(expected: &Pixmap, actual: &Pixmap) -> Option<String> {
    let sizes = [expected, actual].map(|picture| (picture.width(), picture.height()));
    if sizes[0] != sizes[1] {
        return Some(format!("{:?} pixels instead of {:?}", sizes[1], sizes[0]));
    }
    let channels = expected.data().iter().zip(actual.data());
    let channels: Vec<u8> = channels.map(|(a, b)| a.abs_diff(*b)).collect();
    let pixels: Vec<u8> = channels
        .chunks_exact(4)
        .map(|pixel| pixel.iter().copied().fold(0, u8::max))
        .collect();
    let largest = pixels.iter().copied().fold(0, u8::max);
    let counts = THRESHOLDS.map(|threshold| {
        let count = pixels.iter().filter(|&&pixel| pixel > threshold).count();
        format!("{count} over {threshold}")
    });
    (largest > 0).then(|| {
        format!(
            "the largest difference is {largest}; of {} pixels there are {}",
            pixels.len(),
            counts.join(", ")
        )
    })
}

/// Expected, amplified difference, actual.
fn side_by_side(expected: &Pixmap, actual: &Pixmap) -> Pixmap {
    const GAP: u32 = 4;
    let mut difference = expected.clone();
    for (pixel, other) in difference
        .data_mut()
        .chunks_exact_mut(4)
        .zip(actual.data().chunks_exact(4))
    {
        for channel in 0..3 {
            pixel[channel] = pixel[channel]
                .abs_diff(other[channel])
                .saturating_mul(AMPLIFICATION);
        }
        pixel[3] = 255;
    }
    let panels = [expected, &difference, actual];
    let width = panels.map(Pixmap::width).iter().sum::<u32>() + 2 * GAP;
    let mut sheet = Pixmap::new(width, expected.height().max(actual.height())).unwrap();
    let mut x = 0;
    for panel in panels {
        let paint = PixmapPaint::default();
        sheet.draw_pixmap(x, 0, panel.as_ref(), &paint, Transform::identity(), None);
        x += (panel.width() + GAP) as i32;
    }
    sheet
}

fn check(name: &str, actual: &Pixmap) -> Result<(), String> {
    let file = format!("{name}.png");
    let expected = stored(&file, &actual.encode_png().unwrap())?;
    let expected = Pixmap::decode_png(&expected).unwrap();
    let Some(difference) = difference(&expected, actual) else {
        return Ok(());
    };
    fs::create_dir_all(path("target/snapshots", "")).unwrap();
    let sheet = path("target/snapshots", &file);
    side_by_side(&expected, actual).save_png(&sheet).unwrap();
    Err(format!("{name}: {difference}; see {}", sheet.display()))
}

#[test]
fn pictures_equal_their_snapshots() {
    let complaints: Vec<String> = PICTURES
        .into_iter()
        .filter_map(|(name, folder, scale)| {
            check(name, &render(&scene_text(folder, name), scale)).err()
        })
        .collect();
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}

#[test]
fn an_svg_equals_its_snapshot() {
    let scene = Scene::from_json(&scene_text(SNAPSHOTS, "card")).unwrap();
    // So coarse that the text stays small: what it is compared for is its form.
    let svg = scene.to_svg(Tolerance::levels(16.0).unwrap()).unwrap();
    let expected = stored("card.svg", svg.as_bytes()).unwrap();
    let expected = String::from_utf8(expected).unwrap();
    let mut lines = expected.lines().zip(svg.lines()).enumerate();
    let first = lines.find(|(_, (expected, actual))| expected != actual);
    assert_eq!(first, None, "the first line that differs, from 0");
    assert_eq!(expected, svg);
}

#[test]
fn slightly_wrong_shadows_are_told_from_the_snapshots() {
    for (name, old, new) in [
        ("card", r#""elevation": 8"#, r#""elevation": 8.5"#),
        ("card", r#""z": 600"#, r#""z": 596"#),
        ("card", r#""y": 0"#, r#""y": 4"#),
        ("card", r#""radius": 800"#, r#""radius": 790"#),
        ("card", r#""radius": 8,"#, r#""radius": 7.5,"#),
        ("card", r#""key": 0.2"#, r#""key": 0.19"#),
        ("card", r#""ambient": 0.039"#, r#""ambient": 0.03"#),
        ("layers", r#""elevation": 12"#, r#""elevation": 12.5"#),
        ("layers", r#""opacity": 0.5"#, r#""opacity": 0.52"#),
        ("outlines", "evenodd", "nonzero"),
        ("fine", r#""elevation": 6"#, r#""elevation": 6.25"#),
        ("fine", r#""radius": 60"#, r#""radius": 57"#),
        ("hard", r#""elevation": 16"#, r#""elevation": 16.1"#),
    ] {
        let text = scene_text(SNAPSHOTS, name);
        assert_eq!(text.matches(old).count(), 1, "{name}: {old}");
        let snapshot = Pixmap::load_png(path(SNAPSHOTS, &format!("{name}.png"))).unwrap();
        let wrong = render(&text.replace(old, new), 1.0);
        let difference = difference(&snapshot, &wrong);
        assert!(difference.is_some(), "{name}: {new} looks like {old}");
    }
}

#[test]
fn snapshots_are_small_and_all_in_use() {
    for entry in fs::read_dir(path(SNAPSHOTS, "")).unwrap() {
        let entry = entry.unwrap();
        let file = entry.file_name().into_string().unwrap();
        let (name, extension) = file.split_once('.').unwrap();
        assert!(
            PICTURES.iter().any(|(picture, ..)| *picture == name),
            "{file} belongs to no picture"
        );
        let most = if extension == "png" {
            MAX_PNG_BYTES
        } else {
            MAX_SVG_BYTES
        };
        let length = entry.metadata().unwrap().len();
        assert!(length <= most, "{file}: {length} bytes, at most {most}");
    }
}
