//! Reading the JSON scene format.

use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;

use super::{Scene, Surface};
use crate::error::{Error, MAX_SCENE_LENGTH, Result};
use crate::light::Light;
use crate::path::{FillRule, Path};
use crate::shape::{CornerRadii, Shape};
use crate::tone::{Color, Tone};

/// A scene may not have more surfaces than this.
const MAX_SURFACES: usize = 1 << 16;

/// A field that is there has a value: `null` would be a silent default.
fn some<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    reader: D,
) -> core::result::Result<Option<T>, D::Error> {
    T::deserialize(reader).map(Some)
}

/// Each field as the piece of text that it is, so that what is wrong with one can be said with its place.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFields<'a> {
    #[serde(borrow)]
    canvas: &'a RawValue,
    #[serde(borrow, default, deserialize_with = "some")]
    background: Option<&'a RawValue>,
    #[serde(borrow, default, deserialize_with = "some")]
    scale: Option<&'a RawValue>,
    light: &'a RawValue,
    #[serde(borrow, default, deserialize_with = "some")]
    key: Option<&'a RawValue>,
    #[serde(borrow, default, deserialize_with = "some")]
    ambient: Option<&'a RawValue>,
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
    shape: String,
    elevation: f32,
    #[serde(default, deserialize_with = "some")]
    opacity: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    fill: Option<String>,
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
}

#[derive(Deserialize, Clone, Copy)]
#[serde(untagged)]
enum RadiusFields {
    One(f32),
    Pair([f32; 2]),
}

impl Scene {
    /// Reads a scene from its JSON format:
    ///
    /// ```json
    /// {
    ///   "canvas": [360, 640], "background": "#fafafa", "scale": 1,
    ///   "light": {"x": 180, "y": 0, "z": 600, "radius": 800}, "key": 0.19, "ambient": 0.039,
    ///   "surfaces": [
    ///     {"shape": "rrect", "x": 16, "y": 80, "w": 328, "h": 120, "radius": 12, "elevation": 4,
    ///      "opacity": 1, "fill": "#fff", "name": "card"}
    ///   ]
    /// }
    /// ```
    ///
    /// Only `canvas`, `light` and `surfaces` are required; the rest has the values shown. A surface needs `shape` and
    /// `elevation`, and by its shape:
    ///
    /// | shape | fields |
    /// |---|---|
    /// | `rrect` | `x`, `y`, `w`, `h`, and `radius` or `radii`: four from the top left clockwise, each a number or a pair |
    /// | `circle` | `cx`, `cy`, `r` |
    /// | `ellipse` | `cx`, `cy`, `rx`, `ry` |
    /// | `polygon` | `points` or `rings` of [x, y], and `fill_rule`: `nonzero` (the default) or `evenodd` |
    /// | `path` | `d`, SVG path data, and `fill_rule` |
    ///
    /// Unknown fields, and fields of another shape, are refused.
    ///
    /// # Errors
    /// [`Error::Scene`] with line, column and field.
    pub fn from_json(text: &str) -> Result<Self> {
        let whole = Part { text, part: text };
        if text.len() > MAX_SCENE_LENGTH {
            let reason = format!("{} bytes: at most {MAX_SCENE_LENGTH} are read", text.len());
            return Err(whole.refuse("scene", &reason));
        }
        let fields: SceneFields<'_> = whole.read_object("scene")?;
        let part = |raw: &'_ RawValue| Part {
            text,
            part: part_of(text, raw),
        };

        let light = part(fields.light);
        let LightFields { x, y, z, radius } = light.read_object("light")?;
        let light = Light::new([x, y, z], radius).map_err(|error| light.refuse("light", &error))?;
        let canvas = part(fields.canvas);
        let size = canvas.read("canvas")?;
        let mut scene = Self::new(size, light).map_err(|error| canvas.refuse("canvas", &error))?;
        if let Some(scale) = fields.scale.map(part) {
            let value = scale.read("scale")?;
            scene = scene
                .with_scale(value)
                .map_err(|error| scale.refuse("scale", &error))?;
        }
        if let Some(background) = fields.background.map(part) {
            let value: String = background.read("background")?;
            let color: Color = value
                .parse()
                .map_err(|error| background.refuse("background", &error))?;
            scene = scene
                .with_background(color)
                .map_err(|error| background.refuse("background", &error))?;
        }
        let mut tone = Tone::default();
        if let Some(key) = fields.key.map(part) {
            let value = key.read("key")?;
            tone = Tone::new(value, tone.ambient()).map_err(|error| key.refuse("key", &error))?;
        }
        if let Some(ambient) = fields.ambient.map(part) {
            let value = ambient.read("ambient")?;
            tone =
                Tone::new(tone.key(), value).map_err(|error| ambient.refuse("ambient", &error))?;
        }
        scene = scene.with_tone(tone);
        let count = fields.surfaces.len();
        if count > MAX_SURFACES {
            let reason = format!("{count} surfaces: at most {MAX_SURFACES} are read");
            return Err(whole.refuse("surfaces", &reason));
        }
        for (index, raw) in fields.surfaces.into_iter().enumerate() {
            let field = format!("surfaces[{index}]");
            let surface = part(raw);
            let built = surface.read_object::<SurfaceFields>(&field)?.build();
            built
                .and_then(|built| scene.push(built).map_err(|error| error.to_string()))
                .map_err(|reason| surface.refuse(&field, &reason))?;
        }
        Ok(scene)
    }
}

/// A piece of a file's text.
#[derive(Clone, Copy)]
struct Part<'a> {
    text: &'a str,
    part: &'a str,
}

/// The piece of `text` that a raw value was read from.
fn part_of<'a>(text: &'a str, raw: &RawValue) -> &'a str {
    let offset = raw.get().as_ptr() as usize - text.as_ptr() as usize;
    &text[offset..offset + raw.get().len()]
}

impl<'a> Part<'a> {
    /// An error at the part's beginning.
    fn refuse(&self, field: &str, reason: &dyn core::fmt::Display) -> Error {
        self.refuse_at(0, field.to_owned(), reason.to_string())
    }

    fn refuse_at(&self, offset: usize, field: String, reason: String) -> Error {
        let place = self.part.as_ptr() as usize - self.text.as_ptr() as usize + offset;
        let before = &self.text.as_bytes()[..place];
        let line_start = before
            .iter()
            .rposition(|&byte| byte == b'\n')
            .map_or(0, |newline| newline + 1);
        Error::Scene {
            line: before.iter().filter(|&&byte| byte == b'\n').count() + 1,
            column: before.len() - line_start + 1,
            field,
            reason,
        }
    }

    /// Reads an object: a list of values without their names would be taken for one.
    fn read_object<T: Deserialize<'a>>(&self, field: &str) -> Result<T> {
        if self.part.trim_start().starts_with('[') {
            return Err(self.refuse(field, &"give an object with named fields, not a list"));
        }
        self.read(field)
    }

    fn read<T: Deserialize<'a>>(&self, field: &str) -> Result<T> {
        let mut reader = serde_json::Deserializer::from_str(self.part);
        let value = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
            let path = error.path().to_string();
            let field = if path == "." {
                field.to_owned()
            } else {
                format!("{field}.{path}")
            };
            self.json_error(error.inner(), field)
        })?;
        reader
            .end()
            .map_err(|error| self.json_error(&error, field.to_owned()))?;
        Ok(value)
    }

    fn json_error(&self, error: &serde_json::Error, field: String) -> Error {
        // serde_json counts lines from 1 and columns in bytes, and ends its message with both.
        let lines = self.part.split_inclusive('\n');
        let line_start: usize = lines
            .take(error.line().saturating_sub(1))
            .map(str::len)
            .sum();
        let offset = (line_start + error.column().saturating_sub(1)).min(self.part.len());
        let message = error.to_string();
        let reason = message
            .rsplit_once(" at line ")
            .map_or(message.as_str(), |(reason, _)| reason);
        self.refuse_at(
            offset,
            field,
            reason.replace("struct SurfaceFields", "an object"),
        )
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
                Path::from_svg(data).and_then(|path| Shape::path(&path, rule))
            }
            _ => return Err(self.unknown_shape()),
        };
        shape.map_err(|error| error.to_string())
    }

    fn unknown_shape(&self) -> String {
        format!(
            "shape {:?} is unknown: give rrect, circle, ellipse, polygon or path",
            self.shape
        )
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
        let own: &[&str] = match self.shape.as_str() {
            "rrect" => &["x", "y", "w", "h", "radius", "radii"],
            "circle" => &["cx", "cy", "r"],
            "ellipse" => &["cx", "cy", "rx", "ry"],
            "polygon" => &["points", "rings", "fill_rule"],
            "path" => &["d", "fill_rule"],
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
        let text = scene(r#"{"shape":"circle","cx":1,"cy":2,"r":3,"elevation":5,"opacity":null}"#)
            .unwrap_err()
            .to_string();
        assert!(
            text.contains("surfaces[0].opacity: invalid type: null"),
            "{text}"
        );
        let text = scene("{").unwrap_err().to_string();
        assert!(text.starts_with("line 4"), "{text}");
        assert!(Scene::from_json("{} {}").is_err());
    }
}
