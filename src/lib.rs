//! penumbral: shadows for UI toolkits that state how wrong they may be, and keep to it.
//!
//! An application describes flat surfaces at elevations (cards, dialogs, buttons, any path) and one circular light. It
//! gets their shadows back as triangles for a GPU, as densities on a grid of pixels, or as a composited picture.
//!
//! # The model
//!
//! A uniform disc of radius R at height H lights everything. A caster at height h is seen on a receiver at height g as its
//! **outline**, larger by (H - g) / (H - h) about the light's centre, and the light is seen through each of its points
//! as a disc of the **penumbra radius** r = R (h - g) / (H - h). The **density** of the shadow at a point is the fraction
//! of the disc about it that the outline covers:
//!
//! ```text
//! density(p) = area(outline ∩ disc(p, r)) / (π r²)
//! ```
//!
//! It is 1 in the **umbra**, between 0 and 1 in the penumbra, and exact for a disc parallel to the surfaces (Soler &
//! Sillion 1998). The area is closed form for lines and circular arcs, so there is no case for shadows without umbra,
//! concave shapes or holes. Errors are in **levels**, 1/255 of density; lengths are in scene units, of which a grid has
//! so many pixels each.
//!
//! # Quick start
//!
//! ```
//! use penumbral::{Grid, Light, PixelOptions, Scratch, Shape, Tolerance};
//!
//! let light = Light::android(360.0)?;
//! let card = Shape::rounded_rect(24.0, 40.0, 312.0, 160.0, 12.0)?;
//! let shadow = light.cast(&card, 8.0, 0.0)?;
//!
//! // Pixels: coverage into a buffer of yours, colour is yours to apply.
//! let grid = Grid::new([0.0, 0.0], [360, 240], 1.0)?;
//! let mut mask = vec![0; 360 * 240];
//! shadow.fill_a8(&grid, &mut mask, &PixelOptions::default(), &mut Scratch::new())?;
//!
//! // Triangles: position and density at each vertex, to be interpolated linearly.
//! let mesh = shadow.mesh(Tolerance::levels(4.0)?);
//! assert!(mesh.error_levels() <= 4.0);
//!
//! // A point.
//! assert!(shadow.density_at([180.0, 120.0]) > 0.999);
//! # Ok::<(), penumbral::Error>(())
//! ```
//!
//! # The house
//!
//! Data flows one way. [`Shadow`] is the door between geometry and numbers: everything before it is about planes and
//! shapes, everything after it about an outline and a radius.
//!
//! | file | what it holds |
//! |---|---|
//! | `light.rs` | [`Light`]: the projection of one plane on another |
//! | `shape.rs`, `path.rs`, `svg_path.rs`, `convert.rs` | [`Shape`], [`Path`]: what casters look like, and where they come from |
//! | `outline.rs`, `outline/` | loops of lines and arcs that never cross; fill rules; cutting to a box |
//! | `shadow.rs` | [`Shadow`]: bounds, density at a point, coverage |
//! | `image.rs` | [`Image`]: casters with alpha |
//! | `pose.rs`, `tilted.rs` | [`Pose`], [`TiltedShadow`]: casters that are not parallel to the light |
//! | `density.rs`, `density/` | densities: the closed form at points, and on pixels by a method a file; bytes |
//! | `mesh.rs`, `mesh/` | [`ShadowMesh`]: strips; halved squares; tangents, triangulation, refinement, thinning; Gouraud rasterisation; [`MeshSink`]: where triangles go; [`CompactMesh`]: one quad for a shader; [`MeshCache`]: meshes to be kept |
//! | `plan.rs`, `plan/` | [`plan::choose`]: the cheapest method within a tolerance |
//! | `scene.rs`, `scene/` | [`Scene`], [`Surface`], [`Group`], and their JSON format |
//! | `tolerance.rs` | [`Tolerance`]: how wrong a shadow may be |
//! | `tone.rs` | [`Tone`], [`Color`]: how density becomes paint |
//! | `compose.rs`, `compose/` | who casts on whom; pictures and SVG |
//! | `svg.rs` | writing SVG |
//! | `grid.rs`, `hidden.rs`, `paint.rs` | [`Grid`], [`Hidden`], [`Paint`]: the pixels, those that nobody sees, what they take |
//! | `nine_patch.rs`, `nine_patch/key.rs` | [`NinePatch`], [`ShadowKey`]: masks that stretch, to be kept |
//! | `parallel.rs` | bands of rows on several threads |
//! | `scratch.rs`, `error.rs`, `limits.rs` | [`Scratch`], [`Error`], [`Limits`] |
//! | `lab.rs`, `lab/` | `lab`: other ways to draw a shadow, to be measured against, one a file |
//! | `finish.rs`, `finish/` | `finish`: rims and their shading, a model a file; detail on what is flat |
//! | `apart.rs` | boxes that overlap, in groups apart from each other |
//! | `scan.rs` | the pixels of a triangle, row by row |
//! | `squares.rs` | how much of something is in one place |
//! | `bin/penumbral` | the command line |
//!
//! # Features
//!
//! | feature | what it adds | dependencies |
//! |---|---|---|
//! | `raster` (default) | [`Renderer`]: pictures on tiny-skia pixmaps; paths from tiny-skia | tiny-skia |
//! | `svg-path` | [`Path::from_svg`] | svgtypes |
//! | `scene` | [`Scene::from_json`] | serde, `serde_json`, `serde_path_to_error`, `svg-path` |
//! | `cli` | the command line `penumbral` | clap, image, indicatif, `raster`, `scene` |
//! | `lyon`, `kurbo` | paths from these crates, meshes into lyon's buffers | kurbo |
//! | `lab` | `lab`: the laboratory, and the commands `chart` and `atlas`; no toolkit needs it | base64, plotters and a font |
//! | `finish` | `finish`: rims that catch the light, with `raster` in pictures, with `scene` in scenes; nothing is computed where no surface has one | |
//! | `rayon` | [`Shadow::blend_rgba8_in_bands`](crate::Shadow), [`Shadow::fill_a8_in_bands`](crate::Shadow): drawing on several threads | rayon |
//!
//! # Stability guarantees
//!
//! The same input gives the same bits on every machine. A patch release may change densities by no more than the stated
//! error of their method, and meshes in any way that keeps their tolerance: compare pictures, not vertices.

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod apart;
mod compose;
#[cfg(any(feature = "lyon", feature = "kurbo", feature = "raster"))]
mod convert;
mod density;
mod error;
#[cfg(feature = "finish")]
pub mod finish;
mod grid;
mod hidden;
mod image;
#[cfg(feature = "lab")]
pub mod lab;
mod light;
mod limits;
mod mesh;
mod nine_patch;
mod outline;
mod paint;
#[cfg(feature = "rayon")]
mod parallel;
mod path;
pub mod plan;
mod pose;
mod scan;
mod scene;
mod scratch;
mod shadow;
mod shape;
mod squares;
mod svg;
#[cfg(feature = "svg-path")]
mod svg_path;
mod tilted;
mod tolerance;
mod tone;

#[cfg(feature = "raster")]
pub use compose::Renderer;
pub use compose::{DensityMap, GroundShadows, Overlap};
pub use density::PixelOptions;
pub use error::{Error, MAX_COORDINATE, MAX_PIXELS, MAX_SCENE_LENGTH, MAX_SEGMENTS, Result};
pub use grid::Grid;
pub use hidden::Hidden;
pub use image::Image;
pub use light::Light;
pub use limits::Limits;
#[cfg(feature = "lyon")]
pub use mesh::LyonBuffers;
pub use mesh::{
    CachedMesh, CompactMesh, CompactVertex, Incomplete, MeshBuffers, MeshCache, MeshIndex,
    MeshOptions, MeshQuality, MeshSink, MeshSlices, MeshVertex, Profile, ShadowMesh, meshes_to_svg,
};
pub use nine_patch::{NinePatch, PatchPlace, ShadowKey};
pub use paint::Paint;
pub use path::{FillRule, Path};
pub use pose::Pose;
pub use scene::{Group, Scene, Surface};
pub use scratch::Scratch;
pub use shadow::{Bounds, Shadow};
pub use shape::{CornerRadii, LineCap, LineJoin, Shape, Stroke};
pub use tilted::TiltedShadow;
pub use tolerance::Tolerance;
pub use tone::{Blending, Color, ParseColorError, Tone};

/// The README's code, compiled with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeExamples;
