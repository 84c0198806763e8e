//! penumbral itself: the casters projected beforehand, as the peers get them.

use anyhow::Result;
use penumbral::{Hidden, PixelOptions, Scratch};

use crate::peer::{Draw, Peer};
use crate::scene::Scene;

/// The row that all others are divided by.
pub(crate) const NAME: &str = "penumbral";

#[derive(Clone, Copy)]
pub(crate) enum Penumbral {
    /// All of the shadows, as the peers draw them.
    Whole,
    /// What opaque casters leave to be seen; what they hide is found anew in every drawing.
    Opaque,
}

impl Peer for Penumbral {
    fn name(&self) -> &'static str {
        match self {
            Self::Whole => NAME,
            Self::Opaque => "penumbral, opaque casters",
        }
    }

    fn draws_density(&self) -> bool {
        matches!(self, Self::Whole)
    }

    fn prepare<'a>(&self, scene: &'a Scene) -> Result<Option<Draw<'a>>> {
        let shadows = scene.ours.ground_shadows()?;
        let mut scratch = Scratch::new();
        Ok(Some(match self {
            Self::Whole => Box::new(move |canvas| {
                Ok(shadows.blend_rgba8(canvas, &PixelOptions::default(), &mut scratch)?)
            }),
            Self::Opaque => {
                let mut hidden = Hidden::new(shadows.grid());
                Box::new(move |canvas| {
                    shadows.hide_covered(&mut hidden, &mut scratch);
                    let options = PixelOptions::default().with_hidden(&hidden);
                    Ok(shadows.blend_rgba8(canvas, &options, &mut scratch)?)
                })
            }
        }))
    }
}
