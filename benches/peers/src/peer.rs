//! What a peer is: something that draws all shadows of a scene onto a canvas.

use anyhow::Result;

use crate::scene::Scene;
use crate::{epaint_mesh, floors, image_blur, libblur_masks, ours, resvg_filter, vello_rrect};

/// Draws all shadows of one scene, black, over premultiplied RGBA8 pixels of the canvas's size, row by row.
pub(crate) type Draw<'a> = Box<dyn FnMut(&mut [u8]) -> Result<()> + 'a>;

/// A way to draw shadows.
pub(crate) trait Peer {
    /// The crate, and which of its ways.
    fn name(&self) -> &'static str;

    /// Whether what it draws is meant to be the scene's density on every pixel: floors only move memory, and where opaque
    /// casters hide the ground nothing is drawn.
    fn draws_density(&self) -> bool {
        true
    }

    /// Gets everything ready that an application would keep from frame to frame; none where the peer has no such shape.
    fn prepare<'a>(&self, scene: &'a Scene) -> Result<Option<Draw<'a>>>;
}

/// All of them, penumbral first.
pub(crate) fn all() -> Vec<Box<dyn Peer>> {
    vec![
        Box::new(ours::Penumbral::Whole),
        Box::new(ours::Penumbral::Opaque),
        Box::new(vello_rrect::BlurredRect),
        Box::new(resvg_filter::GaussianFilter),
        Box::new(libblur_masks::StackBlur),
        Box::new(libblur_masks::GaussianBlur),
        Box::new(image_blur::GaussianBlur),
        Box::new(image_blur::FastBlur),
        Box::new(epaint_mesh::ShadowMesh),
        Box::new(floors::Floor::Memset),
        Box::new(floors::Floor::Memcpy),
        Box::new(floors::Floor::BlendMask),
    ]
}
