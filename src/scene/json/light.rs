//! A light's fields.

use serde::Deserialize;

use super::optional::some;
use crate::light::Light;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LightFields {
    #[serde(default, deserialize_with = "some")]
    x: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    y: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    z: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    radius: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    offset: Option<[f32; 2]>,
    #[serde(default, deserialize_with = "some")]
    spread: Option<f32>,
    #[serde(default, deserialize_with = "some")]
    pub(super) key: Option<f32>,
}

impl LightFields {
    pub(super) fn build(&self) -> Result<Light, String> {
        let light = match (
            self.x,
            self.y,
            self.z,
            self.radius,
            self.offset,
            self.spread,
        ) {
            (Some(x), Some(y), Some(z), Some(radius), None, None) => Light::new([x, y, z], radius),
            (None, None, None, None, Some(offset), Some(spread)) => {
                Light::directional(offset, spread)
            }
            _ => {
                return Err(
                    "a light needs `x`, `y`, `z` and `radius`, or `offset` and `spread`".to_owned(),
                );
            }
        };
        light.map_err(|error| {
            let names = [
                ["light.x", "x"],
                ["light.y", "y"],
                ["light.z", "z"],
                ["light.radius", "radius"],
                ["light.offset.x", "offset[0]"],
                ["light.offset.y", "offset[1]"],
                ["light.spread", "spread"],
            ];
            error.renamed(&names).to_string()
        })
    }
}
