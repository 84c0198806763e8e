//! Floors: what touching the shadows' bounds costs, whatever is drawn there.

use anyhow::Result;

use crate::mask::blend_row;
use crate::peer::{Draw, Peer};
use crate::scene::{PixelRect, Scene};

#[derive(Clone, Copy)]
pub(crate) enum Floor {
    /// Writing the pixels.
    Memset,
    /// Copying them from another canvas.
    Memcpy,
    /// Blending a mask that is ready, in plain Rust for baseline x86-64.
    BlendMask,
}

impl Peer for Floor {
    fn name(&self) -> &'static str {
        match self {
            Self::Memset => "floor: memset",
            Self::Memcpy => "floor: memcpy",
            Self::BlendMask => "floor: blend ready A8 mask",
        }
    }

    fn draws_density(&self) -> bool {
        false
    }

    fn prepare<'a>(&self, scene: &'a Scene) -> Result<Option<Draw<'a>>> {
        let (bounds, width) = (scene.shadow_bounds(), scene.width);
        Ok(Some(match self {
            Self::Memset => Box::new(move |canvas| {
                for row in bounds.iter().flat_map(|rect| rect.byte_rows(width)) {
                    canvas[row].fill(0x7f);
                }
                Ok(())
            }),
            Self::Memcpy => {
                let source = scene.white_canvas();
                Box::new(move |canvas| {
                    for row in bounds.iter().flat_map(|rect| rect.byte_rows(width)) {
                        canvas[row.clone()].copy_from_slice(&source[row]);
                    }
                    Ok(())
                })
            }
            Self::BlendMask => {
                let ready = |rect: &PixelRect| (*rect, ready_mask(scene, rect));
                let masks: Vec<_> = bounds.iter().map(ready).collect();
                Box::new(move |canvas| {
                    for (rect, mask) in &masks {
                        let rows = mask.chunks_exact(rect.width() as usize);
                        for (row, coverage) in rect.byte_rows(width).zip(rows) {
                            blend_row(&mut canvas[row], coverage);
                        }
                    }
                    Ok(())
                })
            }
        }))
    }
}

/// The exact densities within a rectangle, as a mask.
fn ready_mask(scene: &Scene, rect: &PixelRect) -> Vec<u8> {
    let densities = rect
        .byte_rows(scene.width)
        .flat_map(|row| &scene.truth.densities[row.start / 4..row.end / 4]);
    densities.map(|d| (d * 255.0).round() as u8).collect()
}
