//! The part of penumbral's scene format that the truth scenes use, and the projection of what it says.
//!
//! A second reader beside the crate's own, so that a peer gets its shapes as shapes and not by way of penumbral's outlines.

use anyhow::{Context, Result, ensure};
use serde::Deserialize;
use tiny_skia::FillRule;
use vello_cpu::kurbo::{
    Affine, BezPath, Circle, Ellipse, Point, RoundedRect, RoundedRectRadii, Shape as _,
};

use crate::scene::{Caster, skia_path};

/// How far the cubics that stand for arcs may be from them, in pixels.
const FLATNESS: f64 = 1e-3;

#[derive(Deserialize)]
pub(crate) struct SceneFields {
    pub(crate) canvas: [u32; 2],
    #[serde(default = "one")]
    scale: f64,
    light: LightFields,
    surfaces: Vec<SurfaceFields>,
}

#[derive(Deserialize)]
struct LightFields {
    x: f64,
    y: f64,
    z: f64,
    radius: f64,
}

#[derive(Deserialize)]
struct SurfaceFields {
    elevation: f64,
    #[serde(default = "one")]
    opacity: f64,
    #[serde(default)]
    fill_rule: RuleFields,
    #[serde(flatten)]
    shape: ShapeFields,
}

#[derive(Deserialize, Default, Clone, Copy)]
#[serde(rename_all = "lowercase")]
enum RuleFields {
    #[default]
    NonZero,
    EvenOdd,
}

/// Radii that are pairs, which no peer has, and fills, which no truth scene has, are left out.
#[derive(Deserialize)]
#[serde(tag = "shape", rename_all = "lowercase")]
enum ShapeFields {
    Rrect {
        x: f64,
        y: f64,
        w: f64,
        h: f64,
        #[serde(default)]
        radius: f64,
        radii: Option<[f64; 4]>,
    },
    Circle {
        cx: f64,
        cy: f64,
        r: f64,
    },
    Ellipse {
        cx: f64,
        cy: f64,
        rx: f64,
        ry: f64,
    },
    Polygon {
        #[serde(default)]
        points: Vec<[f64; 2]>,
        #[serde(default)]
        rings: Vec<Vec<[f64; 2]>>,
    },
    Path {
        d: String,
    },
}

/// A shape before its projection; circles are rounded rectangles too.
enum Outline {
    Rounded(RoundedRect),
    Path(BezPath),
}

fn one() -> f64 {
    1.0
}

/// What light does to a plane: scaled about the light's centre, then blurred by a disc.
struct Projection {
    scale: f64,
    light: Point,
    radius: f64,
}

impl SceneFields {
    /// The casters as seen on the ground.
    pub(crate) fn casters(&self) -> Result<Vec<Caster>> {
        ensure!(
            self.scale == 1.0,
            "the peers draw at one pixel a scene unit"
        );
        let casting = self.surfaces.iter().filter(|s| s.elevation > 0.0);
        casting.map(|surface| surface.cast(&self.light)).collect()
    }
}

impl LightFields {
    fn projection(&self, elevation: f64) -> Result<Projection> {
        let below_light = self.z - elevation;
        ensure!(below_light > 0.0, "a caster is not below the light");
        Ok(Projection {
            scale: self.z / below_light,
            light: Point::new(self.x, self.y),
            radius: self.radius * elevation / below_light,
        })
    }
}

impl SurfaceFields {
    fn cast(&self, light: &LightFields) -> Result<Caster> {
        let projection = light.projection(self.elevation)?;
        let to_ground = Affine::scale_about(projection.scale, projection.light);
        let (path, rounded) = match self.shape.outline()? {
            Outline::Rounded(rounded) => {
                let rounded = scaled(rounded, to_ground, projection.scale);
                (rounded.to_path(FLATNESS), Some(rounded))
            }
            Outline::Path(path) => (to_ground * path, None),
        };
        Ok(Caster {
            skia: skia_path(&path).context("a shape has no extent")?,
            path,
            rule: match self.fill_rule {
                RuleFields::NonZero => FillRule::Winding,
                RuleFields::EvenOdd => FillRule::EvenOdd,
            },
            rounded,
            opacity: self.opacity as f32,
            radius: projection.radius,
        })
    }
}

fn scaled(rounded: RoundedRect, to_ground: Affine, scale: f64) -> RoundedRect {
    let radii = rounded.radii();
    let radii = RoundedRectRadii::new(
        radii.top_left * scale,
        radii.top_right * scale,
        radii.bottom_right * scale,
        radii.bottom_left * scale,
    );
    RoundedRect::from_rect(to_ground.transform_rect_bbox(rounded.rect()), radii)
}

impl ShapeFields {
    fn outline(&self) -> Result<Outline> {
        Ok(match self {
            &Self::Rrect {
                x,
                y,
                w,
                h,
                radius,
                radii,
            } => {
                let [top_left, top_right, bottom_right, bottom_left] = radii.unwrap_or([radius; 4]);
                let radii = RoundedRectRadii::new(top_left, top_right, bottom_right, bottom_left);
                Outline::Rounded(RoundedRect::new(x, y, x + w, y + h, radii))
            }
            &Self::Circle { cx, cy, r } => {
                let square = Circle::new((cx, cy), r).bounding_box();
                Outline::Rounded(RoundedRect::from_rect(square, r))
            }
            &Self::Ellipse { cx, cy, rx, ry } => {
                Outline::Path(Ellipse::new((cx, cy), (rx, ry), 0.0).to_path(FLATNESS))
            }
            Self::Polygon { points, rings } => {
                let mut path = BezPath::new();
                for ring in rings.iter().chain([points]) {
                    add_ring(&mut path, ring);
                }
                Outline::Path(path)
            }
            Self::Path { d } => Outline::Path(BezPath::from_svg(d)?),
        })
    }
}

fn add_ring(path: &mut BezPath, ring: &[[f64; 2]]) {
    let mut points = ring.iter().map(|&[x, y]| Point::new(x, y));
    let Some(first) = points.next() else { return };
    path.move_to(first);
    points.for_each(|point| path.line_to(point));
    path.close_path();
}
