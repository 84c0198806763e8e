//! resvg: `feGaussianBlur` on paths, the tree parsed beforehand.

use std::fmt::Write as _;

use anyhow::{Context, Result};
use resvg::usvg::{Options, Tree};
use tiny_skia::{FillRule, PixmapMut, Transform};

use crate::peer::{Draw, Peer};
use crate::scene::{Caster, Scene};

pub(crate) struct GaussianFilter;

impl Peer for GaussianFilter {
    fn name(&self) -> &'static str {
        "resvg feGaussianBlur"
    }

    fn prepare<'a>(&self, scene: &'a Scene) -> Result<Option<Draw<'a>>> {
        let tree = Tree::from_str(&document(scene)?, &Options::default())?;
        Ok(Some(Box::new(move |canvas| {
            let mut pixmap = PixmapMut::from_bytes(canvas, scene.width, scene.height)
                .context("a canvas too small")?;
            resvg::render(&tree, Transform::identity(), &mut pixmap);
            Ok(())
        })))
    }
}

fn document(scene: &Scene) -> Result<String> {
    let (width, height) = (scene.width, scene.height);
    let mut svg =
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">"#);
    for (index, caster) in scene.casters.iter().enumerate() {
        write_caster(&mut svg, scene, index, caster)?;
    }
    svg.push_str("</svg>");
    Ok(svg)
}

/// A caster and its filter, whose region is what the blur reaches of the canvas, and whose colours need no conversion.
fn write_caster(svg: &mut String, scene: &Scene, index: usize, caster: &Caster) -> Result<()> {
    let sigma = caster.sigma();
    let reach = (3.0 * sigma).ceil() + 1.0;
    let Some(region) = scene.pixels_within(caster, reach, reach as i32) else {
        return Ok(());
    };
    write!(
        svg,
        r#"<filter id="f{index}" filterUnits="userSpaceOnUse" x="{}" y="{}" width="{}" height="{}" color-interpolation-filters="sRGB">"#,
        region.x0,
        region.y0,
        region.width(),
        region.height(),
    )?;
    write!(svg, r#"<feGaussianBlur stdDeviation="{sigma}"/></filter>"#)?;
    let rule = match caster.rule {
        FillRule::Winding => "nonzero",
        FillRule::EvenOdd => "evenodd",
    };
    write!(
        svg,
        r#"<path filter="url(#f{index})" d="{}" fill-rule="{rule}" fill-opacity="{}"/>"#,
        caster.path.to_svg(),
        caster.opacity,
    )?;
    Ok(())
}
