//! `penumbral`: pictures, densities, meshes and explanations of scene files.

#[cfg(feature = "lab")]
mod atlas;
#[cfg(feature = "lab")]
mod chart;
mod density;
mod explain;
mod mesh;
mod output;
mod render;
#[cfg(feature = "lab")]
mod tilt;

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use image::{ImageFormat, ImageReader, Limits};
use penumbral::plan::Method;
use penumbral::{Image, MAX_PIXELS, MAX_SCENE_LENGTH, MeshOptions, Scene, Tolerance};

/// Shadows of material-style layered surfaces that state how wrong they may be, and keep to it.
#[derive(Parser)]
#[command(name = "penumbral", version, about, args_override_self = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Draw a scene as a picture.
    Render {
        /// The scene file, JSON.
        scene: PathBuf,
        /// The picture: .png or .svg.
        #[arg(short, long)]
        output: PathBuf,
        /// The largest error of shadows in an SVG, in levels of 255: 1 if not given. Those in a PNG keep one level.
        #[arg(long, value_parser = tolerance, allow_negative_numbers = true)]
        tolerance: Option<Tolerance>,
    },
    /// Draw the density of all casters on the ground under the first light as 16-bit grey, white = 1, and time how long their
    /// shadows take to be blended onto a picture. Prints the methods that drew.
    Density {
        /// The scene file, JSON.
        scene: PathBuf,
        /// The map: .png.
        #[arg(short, long)]
        output: PathBuf,
        /// The method: auto, exact, direct, grid, nine-patch or mesh. Where grid and nine-patch cannot draw a shadow, direct does.
        #[arg(long, default_value = "auto", value_parser = method)]
        method: MethodChoice,
        /// The largest error, in levels of 255: 1 if not given. The method exact takes none.
        #[arg(long, value_parser = tolerance, allow_negative_numbers = true)]
        tolerance: Option<Tolerance>,
        /// Leave out what opaque casters cover.
        #[arg(long)]
        opaque: bool,
        /// Blend so many times and print the median time.
        #[arg(long, default_value = "1", value_parser = clap::value_parser!(u32).range(1..=100_000), allow_negative_numbers = true)]
        repeat: u32,
    },
    /// Write the shadow of each surface on the ground as triangles, under each light; those of images have none.
    Mesh {
        /// The scene file, JSON.
        scene: PathBuf,
        /// The meshes: .json, .obj or .svg.
        #[arg(short, long)]
        output: PathBuf,
        /// The largest error, in levels of 255.
        #[arg(long, default_value = "1", value_parser = tolerance, allow_negative_numbers = true)]
        tolerance: Tolerance,
        /// Make them as soon as may be, of more triangles.
        #[arg(long)]
        quick: bool,
        /// Make them of as few triangles as are found, however long that takes.
        #[arg(long, conflicts_with = "quick")]
        few: bool,
    },
    /// Tell of each surface's shadow on the ground how it is projected and drawn.
    Explain {
        /// The scene file, JSON.
        scene: PathBuf,
    },
    /// Find where each method fails, and by how much: pictures and tables.
    #[cfg(feature = "lab")]
    Atlas {
        /// The folder that all of it is written to.
        #[arg(short, long)]
        output: PathBuf,
    },
    /// Measure every method's time and error, and chart one against the other: pictures, tables and a page.
    #[cfg(feature = "lab")]
    Chart {
        /// The folder that all of it is written to.
        #[arg(short, long)]
        output: PathBuf,
        /// A folder of scenes.
        #[arg(long, default_value = "fixtures/truth")]
        scenes: PathBuf,
        /// What `benches/peers --json` wrote; else `peers.json` of the output folder, if there is one.
        #[arg(long)]
        peers: Option<PathBuf>,
        /// Every method at one setting, on a few scenes: under a minute.
        #[arg(long)]
        quick: bool,
    },
}

/// A method, or none where the plan is to choose.
#[derive(Clone, Copy)]
struct MethodChoice(Option<Method>);

fn method(text: &str) -> Result<MethodChoice, String> {
    if text == "auto" {
        return Ok(MethodChoice(None));
    }
    let method = text
        .parse()
        .map_err(|_| "give auto, exact, direct, grid, nine-patch or mesh".to_owned())?;
    Ok(MethodChoice(Some(method)))
}

fn tolerance(text: &str) -> Result<Tolerance, String> {
    let levels: f32 = text
        .parse()
        .map_err(|_| "give a number of levels".to_owned())?;
    Tolerance::levels(levels).map_err(|error| error.to_string())
}

/// What went wrong, in one line.
type Failure = String;

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Render {
            scene,
            output,
            tolerance,
        } => render::run(&scene, &output, tolerance),
        Command::Density {
            scene,
            output,
            method,
            tolerance,
            opaque,
            repeat,
        } => density::run(&scene, &output, method.0, tolerance, opaque, repeat),
        Command::Mesh {
            scene,
            output,
            tolerance,
            quick,
            few,
        } => {
            let options = MeshOptions::new(tolerance);
            let options = match (quick, few) {
                (true, _) => options.quick(),
                (_, true) => options.few(),
                _ => options,
            };
            mesh::run(&scene, &output, options)
        }
        Command::Explain { scene } => explain::run(&scene),
        #[cfg(feature = "lab")]
        Command::Atlas { output } => atlas::run(&output),
        #[cfg(feature = "lab")]
        Command::Chart {
            output,
            scenes,
            peers,
            quick,
        } => chart::run(&chart::Options {
            folder: &output,
            scenes: &scenes,
            peers: peers.as_deref(),
            quick,
        }),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            output::complain(&failure);
            ExitCode::from(1)
        }
    }
}

fn read_scene(path: &Path) -> Result<Scene, Failure> {
    // One byte more than is read tells a file that is too long, however long it is.
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| {
            file.take(MAX_SCENE_LENGTH as u64 + 1)
                .read_to_end(&mut bytes)
        })
        .map_err(|error| format!("{}: {error}", path.display()))?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        format!(
            "{}: not UTF-8 text from byte {at} on: give a JSON file",
            path.display()
        )
    })?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut images = |name: &str| read_image(&folder.join(name));
    Scene::from_json_with_images(&text, &mut images)
        .map_err(|error| format!("{}: {error}", path.display()))
}

/// Reads an image that a scene names, no larger than a picture may be.
fn read_image(path: &Path) -> Result<Image, Failure> {
    let describe = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let file = File::open(path).map_err(|error| describe(&error))?;
    let mut reader = ImageReader::new(BufReader::new(file))
        .with_guessed_format()
        .map_err(|error| describe(&error))?;
    if reader.format() != Some(ImageFormat::Png) {
        return Err(describe(&"not a PNG image: give one"));
    }
    let mut limits = Limits::default();
    limits.max_alloc = Some(8 * MAX_PIXELS);
    reader.limits(limits);
    let pixels = reader
        .decode()
        .map_err(|error| describe(&error))?
        .into_rgba8();
    Image::from_rgba8([pixels.width(), pixels.height()], pixels.into_raw())
        .map_err(|error| describe(&error))
}

/// Which of the known extensions an output file has, in whatever case: it says what is to be written.
fn extension<'a>(path: &Path, known: &[&'a str]) -> Result<&'a str, Failure> {
    let has = |known: &&&str| {
        let extension = path.extension();
        extension.is_some_and(|extension| extension.eq_ignore_ascii_case(known))
    };
    known.iter().find(has).copied().ok_or_else(|| {
        format!(
            "{}: give an output that ends in .{}",
            path.display(),
            known.join(" or .")
        )
    })
}
