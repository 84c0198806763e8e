//! The truth scenes: as penumbral reads them, and for the peers as casters already projected on the ground.

use std::fs;
use std::path::Path as FilePath;

use anyhow::{Context, Result, ensure};
use tiny_skia::{FillRule, Path, PathBuilder};
use vello_cpu::kurbo::{BezPath, PathEl, Point, RoundedRect, Shape as _};

use crate::scene_file::SceneFields;
use crate::truth::Truth;

/// A scene with its exact densities.
pub(crate) struct Scene {
    pub(crate) name: String,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) casters: Vec<Caster>,
    pub(crate) ours: penumbral::Scene,
    pub(crate) truth: Truth,
}

impl Scene {
    /// Reads `NAME.json` and the `NAME.png` beside it.
    pub(crate) fn read(json: &FilePath) -> Result<Self> {
        let text = fs::read_to_string(json)?;
        let fields: SceneFields = serde_json::from_str(&text)?;
        let truth = Truth::read(&json.with_extension("png"))?;
        let [width, height] = fields.canvas;
        ensure!(
            [truth.width, truth.height] == [width, height],
            "its exact map is of another size"
        );
        // The peers draw black as dense as the shadow is.
        let full = penumbral::Tone::new(1.0, 0.0)?;
        let name = json.file_stem().context("a file without a name")?;
        Ok(Self {
            name: name.to_string_lossy().into_owned(),
            width,
            height,
            casters: fields.casters()?,
            ours: penumbral::Scene::from_json(&text)?.with_tone(full),
            truth,
        })
    }

    /// The largest penumbra radius, in pixels.
    pub(crate) fn radius(&self) -> f64 {
        self.casters.iter().map(|c| c.radius).fold(0.0, f64::max)
    }

    /// The pixels of the canvas that each caster's shadow reaches, for those that reach any.
    pub(crate) fn shadow_bounds(&self) -> Vec<PixelRect> {
        let bounds = |caster: &Caster| self.pixels_within(caster, caster.radius, 0);
        self.casters.iter().filter_map(bounds).collect()
    }

    /// The pixels of all shadows' bounds, in millions; where bounds overlap, a pixel counts for each.
    pub(crate) fn megapixels(&self) -> f64 {
        let pixels: usize = self.shadow_bounds().iter().map(PixelRect::area).sum();
        pixels as f64 / 1e6
    }

    /// The pixels within `reach` of a caster and at most `margin` off the canvas, if there are any.
    pub(crate) fn pixels_within(
        &self,
        caster: &Caster,
        reach: f64,
        margin: i32,
    ) -> Option<PixelRect> {
        let reached = caster.path.bounding_box().inflate(reach, reach);
        let rect = PixelRect {
            x0: (reached.x0.floor() as i32).max(-margin),
            y0: (reached.y0.floor() as i32).max(-margin),
            x1: (reached.x1.ceil() as i32).min(self.width as i32 + margin),
            y1: (reached.y1.ceil() as i32).min(self.height as i32 + margin),
        };
        (rect.x0 < rect.x1 && rect.y0 < rect.y1).then_some(rect)
    }

    /// A canvas of white, premultiplied RGBA8.
    pub(crate) fn white_canvas(&self) -> Vec<u8> {
        vec![255; self.width as usize * self.height as usize * 4]
    }
}

/// A caster's outline as seen on the ground, in pixels: what is left to do is to blur it.
pub(crate) struct Caster {
    pub(crate) path: BezPath,
    /// The same for tiny-skia.
    pub(crate) skia: Path,
    pub(crate) rule: FillRule,
    /// Rounded rectangles and circles: some peers draw nothing else.
    pub(crate) rounded: Option<RoundedRect>,
    pub(crate) opacity: f32,
    /// The penumbra radius.
    pub(crate) radius: f64,
}

impl Caster {
    /// The Gaussian that has the disc's variance along an axis: peers blur with no disc.
    pub(crate) fn sigma(&self) -> f64 {
        self.radius / 2.0
    }
}

/// Pixels from (x0, y0) to before (x1, y1).
#[derive(Clone, Copy)]
pub(crate) struct PixelRect {
    pub(crate) x0: i32,
    pub(crate) y0: i32,
    pub(crate) x1: i32,
    pub(crate) y1: i32,
}

impl PixelRect {
    pub(crate) fn width(&self) -> u32 {
        self.x1.abs_diff(self.x0)
    }

    pub(crate) fn height(&self) -> u32 {
        self.y1.abs_diff(self.y0)
    }

    pub(crate) fn area(&self) -> usize {
        self.width() as usize * self.height() as usize
    }

    pub(crate) fn union(self, other: Self) -> Self {
        Self {
            x0: self.x0.min(other.x0),
            y0: self.y0.min(other.y0),
            x1: self.x1.max(other.x1),
            y1: self.y1.max(other.y1),
        }
    }

    /// Where the rectangle's rows are among RGBA8 pixels `width` wide; all of it has to be on that canvas.
    pub(crate) fn byte_rows(self, width: u32) -> impl Iterator<Item = core::ops::Range<usize>> {
        (self.y0..self.y1).map(move |y| {
            let start = (y as usize * width as usize + self.x0 as usize) * 4;
            start..start + self.width() as usize * 4
        })
    }
}

/// A path for tiny-skia; none where it has no extent.
pub(crate) fn skia_path(path: &BezPath) -> Option<Path> {
    let at = |point: Point| (point.x as f32, point.y as f32);
    let mut builder = PathBuilder::new();
    for element in path {
        match element {
            PathEl::MoveTo(to) => {
                let (x, y) = at(to);
                builder.move_to(x, y);
            }
            PathEl::LineTo(to) => {
                let (x, y) = at(to);
                builder.line_to(x, y);
            }
            PathEl::QuadTo(control, to) => {
                let ((cx, cy), (x, y)) = (at(control), at(to));
                builder.quad_to(cx, cy, x, y);
            }
            PathEl::CurveTo(first, second, to) => {
                let ((ax, ay), (bx, by), (x, y)) = (at(first), at(second), at(to));
                builder.cubic_to(ax, ay, bx, by, x, y);
            }
            PathEl::ClosePath => builder.close(),
        }
    }
    builder.finish()
}
