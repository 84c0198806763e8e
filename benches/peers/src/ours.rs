//! penumbral itself: the casters projected beforehand, as the peers get them.

use anyhow::Result;
use penumbral::{PixelOptions, Scratch};

use crate::peer::{Draw, Peer};
use crate::scene::Scene;

/// The row that all others are divided by.
pub(crate) const NAME: &str = "penumbral";

pub(crate) struct Penumbral;

impl Peer for Penumbral {
    fn name(&self) -> &'static str {
        NAME
    }

    fn prepare<'a>(&self, scene: &'a Scene) -> Result<Option<Draw<'a>>> {
        let shadows = scene.ours.ground_shadows()?;
        let mut scratch = Scratch::new();
        Ok(Some(Box::new(move |canvas| {
            Ok(shadows.blend_rgba8(canvas, &PixelOptions::default(), &mut scratch)?)
        })))
    }
}
