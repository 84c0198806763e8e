//! The JSON scene format.
//!
//! ```json
//! {
//!   "canvas": [360, 640], "background": "#fafafa", "scale": 1,
//!   "light": {"x": 180, "y": 0, "z": 600, "radius": 800}, "key": 0.19, "ambient": 0.039,
//!   "surfaces": [
//!     {"shape": "rrect", "x": 16, "y": 80, "w": 328, "h": 120, "radius": 12, "elevation": 4,
//!      "opacity": 1, "fill": "#fff", "name": "card"}
//!   ]
//! }
//! ```
//!
//! Only `canvas`, `light` and `surfaces` are required; the rest has the values shown. A surface needs `shape` and
//! `elevation`, and by its shape:
//!
//! | shape | fields |
//! |---|---|
//! | `rrect` | `x`, `y`, `w`, `h`, and `radius` or `radii`: four from the top left clockwise, each a number or a pair |
//! | `circle` | `cx`, `cy`, `r` |
//! | `ellipse` | `cx`, `cy`, `rx`, `ry` |
//! | `polygon` | `points` or `rings` of [x, y], and `fill_rule`: `nonzero` (the default) or `evenodd` |
//! | `path` | `d`, SVG path data, and `fill_rule` |
//!
//! Unknown fields, and fields of another shape, are refused.

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::value::RawValue;

use super::{Scene, Surface};
use crate::error::{Error, Result};
use crate::light::Light;
use crate::path::{FillRule, Path};
use crate::shape::{CornerRadii, Shape};
use crate::tone::{Color, Tone};

/// A scene file may not be longer than this, in bytes.
const MAX_LENGTH: usize = 1 << 28;

/// A scene may not have more surfaces than this.
const MAX_SURFACES: usize = 1 << 16;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFields<'a> {
    canvas: [f32; 2],
    background: Option<String>,
    scale: Option<f32>,
    light: LightFields,
    key: Option<f32>,
    ambient: Option<f32>,
    #[serde(borrow)]
    surfaces: Vec<&'a RawValue>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LightFields {
    x: f32,
    y: f32,
    z: f32,
    radius: f32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SurfaceFields {
    shape: ShapeName,
    elevation: f32,
    opacity: Option<f32>,
    fill: Option<String>,
    name: Option<String>,
    x: Option<f32>,
    y: Option<f32>,
    w: Option<f32>,
    h: Option<f32>,
    radius: Option<f32>,
    radii: Option<[RadiusFields; 4]>,
    cx: Option<f32>,
    cy: Option<f32>,
    r: Option<f32>,
    rx: Option<f32>,
    ry: Option<f32>,
    points: Option<Vec<[f32; 2]>>,
    rings: Option<Vec<Vec<[f32; 2]>>>,
    d: Option<String>,
    fill_rule: Option<FillRuleName>,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "lowercase")]
enum ShapeName {
    Rrect,
    Circle,
    Ellipse,
    Polygon,
    Path,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "lowercase")]
enum FillRuleName {
    NonZero,
    EvenOdd,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(untagged)]
enum RadiusFields {
    One(f32),
    Pair([f32; 2]),
}

impl Scene {
    /// Reads a scene from its JSON format, which `src/scene/json.rs` and the README describe.
    ///
    /// # Errors
    /// [`Error::Scene`] with line, column and field.
    pub fn from_json(text: &str) -> Result<Self> {
        let whole = Place { text, offset: 0 };
        if text.len() > MAX_LENGTH {
            return Err(whole.refuse(
                0,
                "scene",
                format!("{} bytes: at most {MAX_LENGTH} are read", text.len()),
            ));
        }
        let fields: SceneFields<'_> = whole.read_borrowed("scene")?;
        let count = fields.surfaces.len();
        if count > MAX_SURFACES {
            return Err(whole.refuse(
                0,
                "surfaces",
                format!("{count} surfaces: at most {MAX_SURFACES} are read"),
            ));
        }
        let at = |key: &str| text.find(&format!("\"{key}\"")).unwrap_or(0);
        let refuse = |key: &str, error: &dyn core::fmt::Display| {
            whole.refuse(at(key), key, error.to_string())
        };

        let LightFields { x, y, z, radius } = fields.light;
        let light = Light::new([x, y, z], radius).map_err(|error| refuse("light", &error))?;
        let mut scene =
            Self::new(fields.canvas, light).map_err(|error| refuse("canvas", &error))?;
        if let Some(scale) = fields.scale {
            scene = scene
                .with_scale(scale)
                .map_err(|error| refuse("scale", &error))?;
        }
        if let Some(background) = fields.background {
            let color: Color = background
                .parse()
                .map_err(|error| refuse("background", &error))?;
            scene = scene
                .with_background(color)
                .map_err(|error| refuse("background", &error))?;
        }
        let default = Tone::default();
        let tone = Tone::new(
            fields.key.unwrap_or(default.key()),
            fields.ambient.unwrap_or(default.ambient()),
        );
        scene = scene.with_tone(tone.map_err(|error| {
            refuse(
                if fields.key.is_some() {
                    "key"
                } else {
                    "ambient"
                },
                &error,
            )
        })?);
        for (index, raw) in fields.surfaces.iter().enumerate() {
            let place = Place {
                text,
                offset: raw.get().as_ptr() as usize - text.as_ptr() as usize,
            };
            let field = format!("surfaces[{index}]");
            let surface = place.read_part::<SurfaceFields>(raw.get(), &field)?;
            let surface = surface
                .build()
                .and_then(|surface| scene.push(surface).map_err(|error| error.to_string()));
            surface.map_err(|reason| place.refuse(0, &field, reason))?;
        }
        Ok(scene)
    }
}

/// Where in a file a part of it begins.
struct Place<'a> {
    text: &'a str,
    offset: usize,
}

impl<'a> Place<'a> {
    /// An error at `offset` bytes from the place.
    fn refuse(&self, offset: usize, field: &str, reason: String) -> Error {
        let before = &self.text.as_bytes()[..self.offset + offset];
        let line_start = before
            .iter()
            .rposition(|&byte| byte == b'\n')
            .map_or(0, |newline| newline + 1);
        Error::Scene {
            line: before.iter().filter(|&&byte| byte == b'\n').count() + 1,
            column: before.len() - line_start + 1,
            field: field.to_owned(),
            reason,
        }
    }

    /// Reads the whole text.
    fn read_borrowed<T: Deserialize<'a>>(&self, field: &str) -> Result<T> {
        let mut reader = serde_json::Deserializer::from_str(self.text);
        let value = serde_path_to_error::deserialize(&mut reader)
            .map_err(|error| self.misread(&error, self.text, field))?;
        reader
            .end()
            .map_err(|error| self.json_error(&error, self.text, field.to_owned()))?;
        Ok(value)
    }

    /// Reads `part`, which begins at the place.
    fn read_part<T: DeserializeOwned>(&self, part: &str, field: &str) -> Result<T> {
        let mut reader = serde_json::Deserializer::from_str(part);
        serde_path_to_error::deserialize(&mut reader)
            .map_err(|error| self.misread(&error, part, field))
    }

    fn misread(
        &self,
        error: &serde_path_to_error::Error<serde_json::Error>,
        part: &str,
        field: &str,
    ) -> Error {
        let path = error.path().to_string();
        let full = if path == "." {
            field.to_owned()
        } else {
            format!("{field}.{path}")
        };
        self.json_error(error.inner(), part, full)
    }

    fn json_error(&self, error: &serde_json::Error, part: &str, field: String) -> Error {
        // serde_json counts lines from 1 and columns in bytes, and ends its message with both.
        let line_start: usize = part
            .split_inclusive('\n')
            .take(error.line().saturating_sub(1))
            .map(str::len)
            .sum();
        let offset = (line_start + error.column().saturating_sub(1)).min(part.len());
        let message = error.to_string();
        let reason = message
            .rsplit_once(" at line ")
            .map_or(message.as_str(), |(reason, _)| reason);
        self.refuse(offset, &field, reason.to_owned())
    }
}

impl SurfaceFields {
    fn build(self) -> core::result::Result<Surface, String> {
        self.refuse_foreign_fields()?;
        let shape = self.build_shape()?;
        let mut surface = Surface::new(shape, self.elevation);
        if let Some(opacity) = self.opacity {
            surface = surface.with_opacity(opacity);
        }
        if let Some(fill) = self.fill {
            surface = surface.with_fill(fill.parse().map_err(|error| format!("fill {error}"))?);
        }
        if let Some(name) = self.name {
            surface = surface.with_name(name);
        }
        Ok(surface)
    }

    fn build_shape(&self) -> core::result::Result<Shape, String> {
        let need = |name: &str, value: Option<f32>| {
            value.ok_or_else(|| format!("this shape needs the field `{name}`"))
        };
        let rule = match self.fill_rule {
            None | Some(FillRuleName::NonZero) => FillRule::NonZero,
            Some(FillRuleName::EvenOdd) => FillRule::EvenOdd,
        };
        let shape = match self.shape {
            ShapeName::Rrect => {
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
            ShapeName::Circle => Shape::circle(
                [need("cx", self.cx)?, need("cy", self.cy)?],
                need("r", self.r)?,
            ),
            ShapeName::Ellipse => Shape::ellipse(
                [need("cx", self.cx)?, need("cy", self.cy)?],
                [need("rx", self.rx)?, need("ry", self.ry)?],
            ),
            ShapeName::Polygon => match (&self.points, &self.rings) {
                (Some(points), None) => Shape::polygon(&[points], rule),
                (None, Some(rings)) => Shape::polygon(rings, rule),
                _ => return Err("a polygon needs `points` or `rings`, one of them".to_owned()),
            },
            ShapeName::Path => {
                let data = self.d.as_deref().ok_or("a path needs the field `d`")?;
                Path::from_svg(data).and_then(|path| Shape::path(&path, rule))
            }
        };
        shape.map_err(|error| error.to_string())
    }

    /// A field that another shape has says that something was meant that will not be drawn.
    fn refuse_foreign_fields(&self) -> core::result::Result<(), String> {
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
        ];
        let own: &[&str] = match self.shape {
            ShapeName::Rrect => &["x", "y", "w", "h", "radius", "radii"],
            ShapeName::Circle => &["cx", "cy", "r"],
            ShapeName::Ellipse => &["cx", "cy", "rx", "ry"],
            ShapeName::Polygon => &["points", "rings", "fill_rule"],
            ShapeName::Path => &["d", "fill_rule"],
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

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(surface: &str) -> Result<Scene> {
        Scene::from_json(&format!(
            "{{\"canvas\":[100,80],\n\"light\":{{\"x\":50,\"y\":0,\"z\":600,\"radius\":800}},\n\"surfaces\":[\n{surface}]}}"
        ))
    }

    #[test]
    fn defaults_are_those_documented() {
        let scene = scene(r#"{"shape":"rrect","x":1,"y":2,"w":3,"h":4,"elevation":5}"#).unwrap();
        assert_eq!(scene.background(), Color::rgb(0xfa, 0xfa, 0xfa));
        assert_eq!(scene.scale(), 1.0);
        assert_eq!(scene.tone(), Tone::ANDROID);
        let surface = &scene.surfaces()[0];
        assert_eq!(
            (surface.weight(), surface.fill(), surface.name()),
            (1.0, Color::WHITE, None)
        );
        assert_eq!(*surface.shape(), Shape::rect(1.0, 2.0, 3.0, 4.0).unwrap());
    }

    #[test]
    fn every_shape_is_read() {
        for surface in [
            r#"{"shape":"rrect","x":1,"y":2,"w":30,"h":40,"radii":[1,2,[3,4],5],"elevation":5}"#,
            r#"{"shape":"circle","cx":1,"cy":2,"r":3,"elevation":0}"#,
            r##"{"shape":"ellipse","cx":1,"cy":2,"rx":3,"ry":4,"elevation":5,"opacity":0.5,"fill":"#ff000080"}"##,
            r#"{"shape":"polygon","points":[[0,0],[1,0],[0,1]],"elevation":5,"name":"tip"}"#,
            r#"{"shape":"polygon","rings":[[[0,0],[9,0],[0,9]],[[1,1],[2,1],[1,2]]],"fill_rule":"evenodd","elevation":5}"#,
            r#"{"shape":"path","d":"M0 0h5v5z","fill_rule":"nonzero","elevation":5}"#,
        ] {
            scene(surface).unwrap_or_else(|error| panic!("{surface}: {error}"));
        }
    }

    #[test]
    fn errors_name_line_column_and_field() {
        let cases = [
            (
                r#"{"shape":"rrect","x":1,"y":2,"w":3,"elevation":5}"#,
                "line 4, column 1, surfaces[0]: this shape needs the field `h`",
            ),
            (
                r#"{"shape":"rrect","x":1,"y":2,"w":3,"h":0,"elevation":5}"#,
                "line 4, column 1, surfaces[0]: height is 0: give a number above 0",
            ),
            (
                r#"{"shape":"rrect","x":1,"y":2,"w":3,"h":4,"elevation":600}"#,
                "line 4, column 1, surfaces[0]: elevation 600 is not below the light at z = 600: lower the caster or raise the light",
            ),
            (
                r#"{"shape":"path","d":"M0 0L","elevation":5}"#,
                "line 4, column 1, surfaces[0]: SVG path data, character 6: the data end inside a segment",
            ),
            (
                r#"{"shape":"circle","cx":1,"cy":2,"r":3,"w":4,"elevation":5}"#,
                "line 4, column 1, surfaces[0]: the field `w` is not one of this shape's, which are cx, cy, r",
            ),
            (
                r#"{"shape":"circle","cx":1,"cy":2,"r":3,"elevation":5,"fill":"red"}"#,
                "line 4, column 1, surfaces[0]: fill \"red\" is not a colour: write #rgb, #rrggbb or #rrggbbaa",
            ),
        ];
        for (surface, message) in cases {
            assert_eq!(scene(surface).unwrap_err().to_string(), message);
        }
        let unknown =
            scene(r#"{"shape":"circle","cx":1,"cy":2,"r":3,"elevation":5,"colour":"red"}"#)
                .unwrap_err();
        assert!(
            unknown.to_string().starts_with("line 4, column 60, "),
            "{unknown}"
        );
        assert!(
            unknown
                .to_string()
                .contains("surfaces[0].colour: unknown field `colour`"),
            "{unknown}"
        );
        let text = scene(r#"{"shape":"circle","cx":"NaN","cy":2,"r":3,"elevation":5}"#)
            .unwrap_err()
            .to_string();
        assert!(
            text.contains("surfaces[0].cx: invalid type: string"),
            "{text}"
        );
        let text = scene(r#"{"shape":"circle","cx":1e999,"cy":2,"r":3,"elevation":5}"#)
            .unwrap_err()
            .to_string();
        assert!(text.contains("surfaces"), "{text}");
        let text = scene("{").unwrap_err().to_string();
        assert!(text.starts_with("line 4"), "{text}");
        assert!(Scene::from_json("{} {}").is_err());
    }
}
