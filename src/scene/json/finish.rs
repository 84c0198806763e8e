//! A surface's finish.

use std::sync::Arc;

use serde::Deserialize;

use super::Images;
use super::optional::{object, some};
use super::surface::{Outcome, text};
use crate::error::{self, Error};
use crate::finish::detail::MOST_TURN;
use crate::finish::{
    Bump, Environment, Finish, Frame, Material, Rim, RimProfile, ShadingModel, Tile,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FinishFields {
    #[serde(default, deserialize_with = "object")]
    rim: Option<RimFields>,
    #[serde(default, deserialize_with = "some")]
    shading: Option<String>,
    #[serde(default, deserialize_with = "object")]
    material: Option<MaterialFields>,
    #[serde(default, deserialize_with = "object")]
    texture: Option<TextureFields>,
    #[serde(default, deserialize_with = "object")]
    bump: Option<BumpFields>,
    #[serde(default, deserialize_with = "object")]
    frame: Option<FrameFields>,
    #[serde(default, deserialize_with = "object")]
    environment: Option<EnvironmentFields>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RimFields {
    width: f32,
    height: f32,
    #[serde(default, deserialize_with = "some")]
    profile: Option<String>,
    #[serde(default, deserialize_with = "some")]
    steps: Option<u32>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MaterialFields {
    ambient: f32,
    diffuse: f32,
    specular: f32,
    shininess: f32,
    #[serde(default, deserialize_with = "some")]
    attenuation: Option<[f32; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TextureFields {
    image: String,
    tile: [f32; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BumpFields {
    image: String,
    tile: [f32; 2],
    depth: f32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FrameFields {
    image: String,
    tile: [f32; 2],
    depth: f32,
    degrees: f32,
    twist: f32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EnvironmentFields {
    image: String,
    tile: [f32; 2],
    height: f32,
    strength: f32,
}

impl FinishFields {
    /// The finish, its images read by `images`.
    pub(super) fn build(self, images: &mut Images<'_>) -> Outcome<Finish> {
        if self.shading.is_some() && self.rim.is_none() {
            return Err("finish.shading is of a rim: give `rim` or leave it out".to_owned());
        }
        let mut finish = Finish::new();
        if let Some(rim) = self.rim {
            finish = finish.with_rim(rim.build()?);
        }
        if let Some(name) = self.shading {
            finish = finish.with_shading(shading(&name)?);
        }
        if let Some(material) = self.material {
            finish = finish.with_material(material.build()?);
        }
        let mut tile = |name: &str, size: [f32; 2], [width, height]: [&'static str; 2]| {
            Tile::new(Arc::new(images(name)?), size).map_err(|error| {
                text(error.renamed(&[["tile.width", width], ["tile.height", height]]))
            })
        };
        if let Some(of) = self.texture {
            let sides = ["finish.texture.tile[0]", "finish.texture.tile[1]"];
            finish = finish.with_texture(tile(&of.image, of.tile, sides)?);
        }
        if let Some(of) = self.bump {
            let sides = ["finish.bump.tile[0]", "finish.bump.tile[1]"];
            let bump = Bump::new(tile(&of.image, of.tile, sides)?, of.depth);
            finish = finish.with_bump(bump.map_err(named)?);
        }
        if let Some(of) = self.frame {
            let turn = |field, degrees: f32| {
                let most = MOST_TURN.to_degrees().floor();
                error::within(field, f64::from(degrees), -most, most).map_err(text)?;
                Ok::<_, String>(degrees.to_radians())
            };
            let angle = turn("finish.frame.degrees", of.degrees)?;
            let twist = turn("finish.frame.twist", of.twist)?;
            let sides = ["finish.frame.tile[0]", "finish.frame.tile[1]"];
            let image = tile(&of.image, of.tile, sides)?;
            let frame = Frame::new(image, of.depth, angle, twist);
            finish = finish.with_frame(frame.map_err(named)?);
        }
        if let Some(of) = self.environment {
            let sides = ["finish.environment.tile[0]", "finish.environment.tile[1]"];
            let image = tile(&of.image, of.tile, sides)?;
            let environment = Environment::new(image, of.height, of.strength);
            finish = finish.with_environment(environment.map_err(named)?);
        }
        Ok(finish)
    }
}

/// What is wrong, by the names that fields have in scenes.
fn named(error: Error) -> String {
    text(error.renamed(&[
        ["rim.width", "finish.rim.width"],
        ["rim.height", "finish.rim.height"],
        ["rim.steps", "finish.rim.steps"],
        ["finish.ambient", "finish.material.ambient"],
        ["finish.diffuse", "finish.material.diffuse"],
        ["finish.specular", "finish.material.specular"],
        ["finish.shininess", "finish.material.shininess"],
        ["finish.attenuation", "sum of finish.material.attenuation"],
        ["a0", "finish.material.attenuation[0]"],
        ["a1", "finish.material.attenuation[1]"],
        ["a2", "finish.material.attenuation[2]"],
        ["bump.depth", "finish.bump.depth"],
        ["frame.depth", "finish.frame.depth"],
        ["environment.height", "finish.environment.height"],
        ["environment.strength", "finish.environment.strength"],
    ]))
}

fn shading(name: &str) -> Outcome<ShadingModel> {
    let all = ShadingModel::ALL;
    all.iter()
        .copied()
        .find(|model| model.name() == name)
        .ok_or_else(|| {
            let names: Vec<&str> = all.iter().map(|model| model.name()).collect();
            format!(
                "finish.shading {name:?} is unknown: give {}",
                names.join(", ")
            )
        })
}

impl RimFields {
    fn build(&self) -> Outcome<Rim> {
        let profile = match self.profile.as_deref() {
            None | Some("quarter-round") => RimProfile::QuarterRound,
            Some("bevel") => RimProfile::Bevel,
            Some("cosine") => RimProfile::Cosine,
            Some(other) => {
                return Err(format!(
                    "finish.rim.profile {other:?} is unknown: give bevel, quarter-round or cosine"
                ));
            }
        };
        let rim = Rim::new(self.width, self.height, profile);
        let rim = rim.and_then(|rim| match self.steps {
            Some(steps) => rim.with_steps(steps),
            None => Ok(rim),
        });
        rim.map_err(named)
    }
}

impl MaterialFields {
    fn build(&self) -> Outcome<Material> {
        let material = Material::default()
            .with_strengths(self.ambient, self.diffuse, self.specular)
            .and_then(|material| material.with_shininess(self.shininess))
            .and_then(|material| match self.attenuation {
                Some(attenuation) => material.with_attenuation(attenuation),
                None => Ok(material),
            });
        material.map_err(named)
    }
}
