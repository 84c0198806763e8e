//! Reading the JSON scene format.

#[cfg(feature = "finish")]
mod finish;
mod light;
mod members;
mod optional;
mod part;
mod surface;

use serde::Deserialize;
use serde_json::value::RawValue;

use self::light::LightFields;
use self::members::Members;
use self::optional::some;
use self::part::Part;
use super::{Overlap, Scene};
use crate::error::{self, Result};
use crate::image::Image;
use crate::limits::{Limits, at_most};
use crate::tone::{Blending, Color, Tone};

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
    #[serde(borrow, default, deserialize_with = "some")]
    lights: Option<Vec<&'a RawValue>>,
    #[serde(borrow, default, deserialize_with = "some")]
    shadow_color: Option<&'a RawValue>,
    #[serde(borrow, default, deserialize_with = "some")]
    blending: Option<&'a RawValue>,
    #[serde(borrow, default, deserialize_with = "some")]
    overlap: Option<&'a RawValue>,
    surfaces: Vec<&'a RawValue>,
}

/// Reads an image that a scene names.
type Images<'a> = dyn FnMut(&str) -> core::result::Result<Image, String> + 'a;

impl Scene {
    /// Reads a scene from its JSON format:
    ///
    /// ```json
    /// {
    ///   "canvas": [360, 640], "background": "#fafafa", "scale": 1,
    ///   "light": {"x": 180, "y": 0, "z": 600, "radius": 800}, "key": 0.19, "ambient": 0.039,
    ///   "surfaces": [
    ///     {"shape": "rrect", "x": 16, "y": 80, "w": 328, "h": 120, "radius": 12, "elevation": 4,
    ///      "opacity": 1, "fill": "#fff", "casts": true, "name": "card"}
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
    /// | `path` | `d`, SVG path data, and `fill_rule`; or `stroke`: `width`, `cap` (`butt`, `square`, `round`), `join` (`miter`, `round`, `bevel`), `miter_limit` |
    ///
    /// A surface is tilted by `tilt`: `pivot` [x, y], `axis` [x, y] and `degrees` ([`Pose::turned`](crate::Pose::turned)); an
    /// `rrect` also by `corners` in place of `elevation`, the elevations of its four corners from the top left clockwise. An
    /// `rrect` with an `image`, the name of a file, is that image ([`Scene::from_json_with_images`]).
    ///
    /// In place of a surface there may be a group: `group`, a list of surfaces and groups; `elevation`, which is added to theirs;
    /// and `clip`, a shape's fields, outside of which nothing of them is left.
    ///
    /// A light may be directional: `offset` [x, y] and `spread` in place of `x`, `y`, `z` and `radius`
    /// ([`Light::directional`](crate::Light::directional)). `lights` is a list of further lights, each with its own `key`. Of
    /// the tone there are `shadow_color` and `blending`, `srgb` (the default) or `linear`. `overlap` is `union` (the default) or
    /// `source-over`.
    ///
    /// With the feature `finish` a surface may have a `finish` of any of
    ///
    /// | field | fields of its own |
    /// |---|---|
    /// | `rim` | `width`, `height`, `profile` (`quarter-round`, the default, `bevel`, `cosine`), `steps` |
    /// | `shading` | a name: `curvature` (the default), `flat`, `gouraud`, `phong`, `fast-phong` |
    /// | `material` | `ambient`, `diffuse`, `specular`, `shininess`, `attenuation` [a0, a1, a2] |
    /// | `texture` | `image` and `tile`, the width and height of each of its copies, from the scene's origin on |
    /// | `bump` | `image`, `tile`, `depth` |
    /// | `frame` | `image`, `tile`, `depth`, `degrees`, `twist` (degrees) |
    /// | `environment` | `image`, `tile`, `height`, `strength` |
    ///
    /// Unknown fields, and fields of another shape, are refused.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) with line, column and field.
    pub fn from_json(text: &str) -> Result<Self> {
        Self::from_json_with_images(text, &mut |name| {
            Err(format!(
                "the image {name:?} is not read here: see Scene::from_json_with_images"
            ))
        })
    }

    /// As [`Scene::from_json`], with images that `images` reads by their names.
    ///
    /// # Errors
    /// As [`Scene::from_json`], and what `images` says of an image.
    pub fn from_json_with_images(
        text: &str,
        images: &mut dyn FnMut(&str) -> core::result::Result<Image, String>,
    ) -> Result<Self> {
        Self::from_json_with_limits(text, &Limits::default(), images)
    }

    /// As [`Scene::from_json_with_images`], with other limits.
    ///
    /// # Errors
    /// As [`Scene::from_json_with_images`].
    pub fn from_json_with_limits(
        text: &str,
        limits: &Limits,
        images: &mut dyn FnMut(&str) -> core::result::Result<Image, String>,
    ) -> Result<Self> {
        // Some editors begin a file with a byte order mark.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let whole = Part::whole(text);
        at_most("bytes", text.len(), limits.scene_length)
            .map_err(|error| whole.refuse("scene", &error))?;
        let fields: SceneFields<'_> = whole.read_object("scene")?;
        let part = |raw| whole.within(raw);

        let light = part(fields.light);
        let of_light: LightFields = light.read_object("light")?;
        if of_light.key.is_some() {
            return Err(light.refuse("light", &"the first light's `key` is the scene's"));
        }
        let light = of_light
            .build()
            .map_err(|reason| light.refuse("light", &reason))?;
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
        if let Some(color) = fields.shadow_color.map(part) {
            let value: String = color.read("shadow_color")?;
            let parsed: Color = value
                .parse()
                .map_err(|error| color.refuse("shadow_color", &error))?;
            error::opaque("shadow_color", parsed.a)
                .map_err(|error| color.refuse("shadow_color", &error))?;
            tone = tone.with_color(parsed);
        }
        if let Some(blending) = fields.blending.map(part) {
            let names = [("srgb", Blending::Srgb), ("linear", Blending::Linear)];
            tone = tone.with_blending(blending.read_name("blending", &names)?);
        }
        if let Some(overlap) = fields.overlap.map(part) {
            let names = [
                ("union", Overlap::Union),
                ("source-over", Overlap::SourceOver),
            ];
            scene = scene.with_overlap(overlap.read_name("overlap", &names)?);
        }
        scene = scene.with_tone(tone);
        for (index, raw) in fields.lights.into_iter().flatten().enumerate() {
            let field = format!("lights[{index}]");
            let light = part(raw);
            let of_light: LightFields = light.read_object(&field)?;
            let key = of_light
                .key
                .ok_or_else(|| light.refuse(&field, &"missing field `key`"))?;
            let built = of_light
                .build()
                .map_err(|reason| light.refuse(&field, &reason))?;
            scene
                .push_light(built, key)
                .map_err(|error| light.refuse(&field, &error))?;
        }
        limits
            .check(&scene)
            .and_then(|()| at_most("surfaces", fields.surfaces.len(), limits.surfaces))
            .map_err(|error| whole.refuse("scene", &error))?;
        let mut members = Members::new(&mut scene, limits, images);
        for (index, raw) in fields.surfaces.into_iter().enumerate() {
            members.read(part(raw), &format!("surfaces[{index}]"), None)?;
        }
        Ok(scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use crate::shape::Shape;

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
                "line 4, column 1, surfaces[0]: h is 0: give a number above 0",
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
        let text = Scene::from_json("{} {}").unwrap_err().to_string();
        assert!(text.ends_with("missing field `canvas`"), "{text}");
        let whole = r#"{"canvas":[9,9],"light":{"offset":[0,1],"spread":0.5},"surfaces":[]}"#;
        let text = Scene::from_json(&format!("{whole} x")).unwrap_err();
        assert!(text.to_string().ends_with("scene: more follows: remove it"));
        assert!(Scene::from_json(&format!("\u{feff}{whole}")).is_ok());
    }

    #[test]
    fn columns_count_characters() {
        let column = |surface: &str| match scene(surface) {
            Err(Error::Scene { column, .. }) => column,
            other => panic!("{surface}: {other:?}"),
        };
        let of_name = |name: &str| column(&format!(r#"{{"name":"{name}","cx":true}}"#));
        assert_eq!(of_name("the"), of_name("thé"));
        assert_eq!(of_name("the"), of_name("th\u{1f375}"));
        // What is wrong with an escape is told by the byte, here the first of two.
        assert_eq!(column(r#"{"name":"é\u00é0"}"#), 15);
    }

    #[test]
    fn members_of_groups_are_refused_where_they_are() {
        let group = |elevation: f32, members: &str| {
            format!(
                r#"{{"group":[{members}],"elevation":{elevation},"clip":{{"shape":"circle","cx":5,"cy":5,"r":9}}}}"#
            )
        };
        let card = r#"{"shape":"rrect","x":1,"y":2,"w":3,"h":4,"elevation":"#;
        let cases = [
            (
                group(10.0, &format!("{card}580}},\n{card}590}}")),
                "line 5, column 1, surfaces[0].group[1]: elevation 600 is not below the light at z = 600: lower the caster or raise the light; its groups raise it by 10",
            ),
            (
                group(-2.0, &group(-3.0, &format!("\n {card}4}}"))),
                "line 5, column 2, surfaces[0].group[0].group[0]: elevation -1 is below the receiver at 0: a caster must be at or above what it shades; its groups raise it by -5",
            ),
            (
                group(10.0, &format!("\n{card}5,\"opacity\":2}}")),
                "line 5, column 1, surfaces[0].group[0]: opacity is 2: give a number from 0 to 1",
            ),
            (
                group(
                    10.0,
                    &format!(r#"{card}5,"tilt":{{"pivot":[1,2],"axis":[1,0],"degrees":9}}}}"#),
                ),
                "line 4, column 11, surfaces[0].group[0]: a tilted surface and an image are not clipped: put them outside of the clipped group",
            ),
        ];
        for (members, message) in cases {
            assert_eq!(scene(&members).unwrap_err().to_string(), message);
        }
        let nested = |depth| (0..depth).fold(format!("{card}5}}"), |inner, _| group(0.5, &inner));
        assert_eq!(scene(&nested(64)).unwrap().surfaces()[0].elevation(), 37.0);
        let text = scene(&nested(65)).unwrap_err().to_string();
        assert!(
            text.ends_with(
                ": 65 groups within groups, over the limit of 64: simplify or split what has them"
            ),
            "{text}"
        );
    }
}
