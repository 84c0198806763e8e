//! A surface's fields, and the shape that they describe.

use std::sync::Arc;

use serde::Deserialize;
#[cfg(not(feature = "finish"))]
use serde::de::IgnoredAny;

use super::Images;
#[cfg(feature = "finish")]
use super::finish::FinishFields;
use super::optional::{object, some};
use crate::error::Error;
use crate::path::{FillRule, Path};
use crate::pose::Pose;
use crate::scene::Surface;
use crate::shape::{CornerRadii, LineCap, LineJoin, Shape, Stroke};

/// A value, or what is wrong with the fields.
pub(super) type Outcome<T> = Result<T, String>;

pub(super) fn text(error: Error) -> String {
    error.to_string()
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SurfaceFields {
    shape: String,
    #[serde(default, deserialize_with = "some")]
    elevation: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    opacity: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    fill: Option<String>,
    #[serde(default, deserialize_with = "some")]
    casts: Option<bool>,
    #[serde(default, deserialize_with = "some")]
    name: Option<String>,
    #[serde(default, deserialize_with = "some")]
    x: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    y: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    w: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    h: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    radius: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    radii: Option<[RadiusFields; 4]>,
    #[serde(default, deserialize_with = "some")]
    cx: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    cy: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    r: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    rx: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    ry: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    points: Option<Vec<[f32; 2]>>,
    #[serde(default, deserialize_with = "some")]
    rings: Option<Vec<Vec<[f32; 2]>>>,
    #[serde(default, deserialize_with = "some")]
    d: Option<String>,
    #[serde(default, deserialize_with = "some")]
    fill_rule: Option<String>,
    #[serde(default, deserialize_with = "object")]
    stroke: Option<StrokeFields>,
    #[serde(default, deserialize_with = "object")]
    tilt: Option<TiltFields>,
    #[serde(default, deserialize_with = "some")]
    corners: Option<[f32; 4]>,
    #[serde(default, deserialize_with = "some")]
    image: Option<String>,
    #[cfg(feature = "finish")]
    #[serde(default, deserialize_with = "object")]
    finish: Option<FinishFields>,
    #[cfg(not(feature = "finish"))]
    finish: Option<IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StrokeFields {
    width: f32,
    #[serde(default, deserialize_with = "some")]
    cap: Option<String>,
    #[serde(default, deserialize_with = "some")]
    join: Option<String>,
    #[serde(default, deserialize_with = "some")]
    miter_limit: Option<f32>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TiltFields {
    pivot: [f32; 2],
    axis: [f32; 2],
    degrees: f32,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(untagged, expecting = "expected a number or a pair of them")]
enum RadiusFields {
    One(f32),
    Pair([f32; 2]),
}

impl SurfaceFields {
    /// The surface, its image read by `images`.
    pub(super) fn build(self, images: &mut Images<'_>) -> Outcome<Surface> {
        self.refuse_foreign_fields()?;
        #[cfg(not(feature = "finish"))]
        if self.finish.is_some() {
            return Err("built without finishes: build with the feature `finish`".to_owned());
        }
        if self.image.is_some() && (self.tilt.is_some() || self.corners.is_some()) {
            return Err("an image is not tilted: leave out `tilt` and `corners`".to_owned());
        }
        let mut surface = match (self.elevation, &self.corners, &self.tilt) {
            (Some(elevation), None, None) => match &self.image {
                Some(name) => {
                    let rect = self.image_rect()?;
                    let image = images(name)?;
                    Surface::image(Arc::new(image), rect, elevation)
                        .map_err(|error| self.named(error))?
                }
                None => Surface::new(self.build_shape()?, elevation),
            },
            (Some(elevation), None, Some(tilt)) => {
                let angle = tilt.degrees.to_radians();
                let pose = Pose::turned(elevation, tilt.pivot, tilt.axis, angle);
                let pose = pose.map_err(|error| self.named(error))?;
                Surface::posed(self.build_shape()?, &pose)
            }
            (None, Some(corners), None) => {
                let pose = Pose::of_corners(self.rect()?, *corners);
                let pose = pose.map_err(|error| self.named(error))?;
                Surface::posed(self.build_shape()?, &pose)
            }
            (None, None, _) => return Err("missing field `elevation`".to_owned()),
            (_, Some(_), _) => {
                return Err(
                    "`corners` are elevations: give neither `elevation` nor `tilt`".to_owned(),
                );
            }
        };
        if let Some(opacity) = self.opacity {
            surface = surface.with_opacity(opacity);
        }
        if let Some(fill) = self.fill {
            surface = surface.with_fill(fill.parse().map_err(|error| format!("fill {error}"))?);
        }
        if self.casts == Some(false) {
            surface = surface.without_shadow();
        }
        if let Some(name) = self.name {
            surface = surface.with_name(name);
        }
        #[cfg(feature = "finish")]
        if let Some(finish) = self.finish {
            surface = surface.with_finish(finish.build(images)?);
        }
        Ok(surface)
    }

    /// The shape alone, of what has no other field.
    pub(super) fn build_clip(self) -> Outcome<Shape> {
        self.refuse_foreign_fields()?;
        let others = [
            ("elevation", self.elevation.is_some()),
            ("opacity", self.opacity.is_some()),
            ("fill", self.fill.is_some()),
            ("casts", self.casts.is_some()),
            ("name", self.name.is_some()),
            ("tilt", self.tilt.is_some()),
            ("corners", self.corners.is_some()),
            ("image", self.image.is_some()),
            ("finish", self.finish.is_some()),
        ];
        match others.iter().find(|(_, given)| *given) {
            Some((name, _)) => Err(format!(
                "the field `{name}` is not one of a clip's, which is a shape"
            )),
            None => self.build_shape(),
        }
    }

    fn need(name: &str, value: Option<f32>) -> Outcome<f32> {
        value.ok_or_else(|| format!("this shape needs the field `{name}`"))
    }

    fn rect(&self) -> Outcome<[f32; 4]> {
        if self.shape != "rrect" {
            return Err("`corners` and `image` are for the shape rrect".to_owned());
        }
        Ok([
            Self::need("x", self.x)?,
            Self::need("y", self.y)?,
            Self::need("w", self.w)?,
            Self::need("h", self.h)?,
        ])
    }

    fn image_rect(&self) -> Outcome<[f32; 4]> {
        if self.radius.is_some() || self.radii.is_some() {
            return Err("an image has no round corners but its own: leave out `radius`".to_owned());
        }
        if self.fill.is_some() {
            return Err("an image has colours of its own: leave out `fill`".to_owned());
        }
        self.rect()
    }

    fn build_shape(&self) -> Outcome<Shape> {
        let need = Self::need;
        let rule = match self.fill_rule.as_deref() {
            None | Some("nonzero") => FillRule::NonZero,
            Some("evenodd") => FillRule::EvenOdd,
            Some(other) => {
                return Err(format!(
                    "fill_rule {other:?} is unknown: give \"nonzero\" or \"evenodd\""
                ));
            }
        };
        let shape = match self.shape.as_str() {
            "rrect" => {
                let radii = match (self.radius, self.radii) {
                    (Some(_), Some(_)) => {
                        return Err("`radius` and `radii` exclude each other: give one".to_owned());
                    }
                    (radius, None) => CornerRadii::from(radius.unwrap_or(0.0)),
                    (None, Some(radii)) => CornerRadii(radii.map(|radius| match radius {
                        RadiusFields::One(radius) => [radius; 2],
                        RadiusFields::Pair(pair) => pair,
                    })),
                };
                let (x, y) = (need("x", self.x)?, need("y", self.y)?);
                Shape::rounded_rect(x, y, need("w", self.w)?, need("h", self.h)?, radii)
            }
            "circle" => Shape::circle(
                [need("cx", self.cx)?, need("cy", self.cy)?],
                need("r", self.r)?,
            ),
            "ellipse" => Shape::ellipse(
                [need("cx", self.cx)?, need("cy", self.cy)?],
                [need("rx", self.rx)?, need("ry", self.ry)?],
            ),
            "polygon" => match (&self.points, &self.rings) {
                (Some(points), None) => Shape::polygon(&[points], rule),
                (None, Some(rings)) => Shape::polygon(rings, rule),
                _ => return Err("a polygon needs `points` or `rings`, one of them".to_owned()),
            },
            "path" => {
                let data = self.d.as_deref().ok_or("a path needs the field `d`")?;
                let path = Path::from_svg(data).map_err(text)?;
                match &self.stroke {
                    Some(_) if self.fill_rule.is_some() => {
                        return Err("a stroke has no inside: leave out `fill_rule`".to_owned());
                    }
                    Some(stroke) => Shape::stroke(&path, &stroke.build()?),
                    None => Shape::path(&path, rule),
                }
            }
            _ => return Err(self.unknown_shape()),
        };
        shape.map_err(|error| self.named(error))
    }

    /// What is wrong, by the names that fields have in scenes.
    fn named(&self, error: Error) -> String {
        let radius = match self.shape.as_str() {
            "circle" => "r",
            _ if self.radii.is_some() => "radii",
            _ => "radius",
        };
        let [coordinate, width, height] = match (&self.points, &self.rings) {
            (Some(_), _) => [
                "coordinate of points",
                "width of points",
                "height of points",
            ],
            (None, Some(_)) => ["coordinate of rings", "width of rings", "height of rings"],
            (None, None) => ["coordinate of d", "width of d", "height of d"],
        };
        text(error.renamed(&[
            ["width", "w"],
            ["height", "h"],
            ["radius", radius],
            ["center.x", "cx"],
            ["center.y", "cy"],
            ["radii.x", "rx"],
            ["radii.y", "ry"],
            ["path", coordinate],
            ["path width", width],
            ["path height", height],
            ["path arc", "arc of d"],
            ["path arc rotation", "rotation of an arc of d"],
            [
                "elevation",
                if self.corners.is_some() {
                    "corners"
                } else {
                    "elevation"
                },
            ],
            ["pose.pivot", "tilt.pivot"],
            ["pose.axis", "tilt.axis"],
            ["length of pose.axis", "length of tilt.axis"],
            ["pose.angle", "tilt.degrees"],
        ]))
    }

    fn unknown_shape(&self) -> String {
        format!(
            "shape {:?} is unknown: give rrect, circle, ellipse, polygon or path",
            self.shape
        )
    }

    /// A field that another shape has says that something was meant that will not be drawn.
    fn refuse_foreign_fields(&self) -> Outcome<()> {
        let given = [
            ("x", self.x.is_some()),
            ("y", self.y.is_some()),
            ("w", self.w.is_some()),
            ("h", self.h.is_some()),
            ("radius", self.radius.is_some()),
            ("radii", self.radii.is_some()),
            ("cx", self.cx.is_some()),
            ("cy", self.cy.is_some()),
            ("r", self.r.is_some()),
            ("rx", self.rx.is_some()),
            ("ry", self.ry.is_some()),
            ("points", self.points.is_some()),
            ("rings", self.rings.is_some()),
            ("d", self.d.is_some()),
            ("fill_rule", self.fill_rule.is_some()),
            ("stroke", self.stroke.is_some()),
        ];
        let own: &[&str] = match self.shape.as_str() {
            "rrect" => &["x", "y", "w", "h", "radius", "radii"],
            "circle" => &["cx", "cy", "r"],
            "ellipse" => &["cx", "cy", "rx", "ry"],
            "polygon" => &["points", "rings", "fill_rule"],
            "path" => &["d", "fill_rule", "stroke"],
            _ => return Err(self.unknown_shape()),
        };
        match given
            .iter()
            .find(|(name, given)| *given && !own.contains(name))
        {
            Some((name, _)) => Err(format!(
                "the field `{name}` is not one of this shape's, which are {}",
                own.join(", ")
            )),
            None => Ok(()),
        }
    }
}

impl StrokeFields {
    fn build(&self) -> Outcome<Stroke> {
        let cap = match self.cap.as_deref() {
            None | Some("butt") => LineCap::Butt,
            Some("square") => LineCap::Square,
            Some("round") => LineCap::Round,
            Some(other) => {
                return Err(format!(
                    "stroke.cap {other:?} is unknown: give butt, square or round"
                ));
            }
        };
        let join = match self.join.as_deref() {
            None | Some("miter") => LineJoin::Miter,
            Some("round") => LineJoin::Round,
            Some("bevel") => LineJoin::Bevel,
            Some(other) => {
                return Err(format!(
                    "stroke.join {other:?} is unknown: give miter, round or bevel"
                ));
            }
        };
        if self.miter_limit.is_some() && join != LineJoin::Miter {
            return Err("stroke.miter_limit is of the join miter: leave it out".to_owned());
        }
        let stroke = Stroke::new(self.width).and_then(|stroke| match self.miter_limit {
            Some(limit) => stroke.with_miter_limit(limit),
            None => Ok(stroke),
        });
        let stroke = stroke.map_err(|error| {
            text(error.renamed(&[
                ["stroke width", "stroke.width"],
                ["miter limit", "stroke.miter_limit"],
            ]))
        })?;
        Ok(stroke.with_cap(cap).with_join(join))
    }
}
