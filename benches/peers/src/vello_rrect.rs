//! `vello_cpu`: `fill_blurred_rounded_rect`, for rounded rectangles of one radius and circles.
//!
//! It draws each with one formula, without a blur. One thread; it finds the processor's instructions at run time.

use core::f64::consts::SQRT_2;

use anyhow::{Context, Result};
use vello_cpu::color::{AlphaColor, Srgb};
use vello_cpu::kurbo::{Affine, Rect};
use vello_cpu::{
    PixmapMut, RasterizerSettings, RenderContext, RenderSettings, Resources, TargetInit,
};

use crate::peer::{Draw, Peer};
use crate::scene::{Caster, PixelRect, Scene};

/// How far it draws, in its own `std_dev`.
const REACH: f64 = 2.5;

pub(crate) struct BlurredRect;

impl Peer for BlurredRect {
    fn name(&self) -> &'static str {
        "vello_cpu blurred rounded rect"
    }

    fn prepare<'a>(&self, scene: &'a Scene) -> Result<Option<Draw<'a>>> {
        let Some(rects) = blurred_rects(scene) else {
            return Ok(None);
        };
        let Some(bounds) = bounds(scene) else {
            return Ok(None);
        };
        let offset = (u16::try_from(bounds.x0)?, u16::try_from(bounds.y0)?);
        let (width, height) = (u16::try_from(scene.width)?, u16::try_from(scene.height)?);
        let mut context = RenderContext::new_with(
            u16::try_from(bounds.width())?,
            u16::try_from(bounds.height())?,
            RenderSettings {
                num_threads: 0,
                ..RenderSettings::default()
            },
        );
        let mut resources = Resources::new();
        let settings = RasterizerSettings {
            target_init: TargetInit::SrcOver,
            offset,
            ..RasterizerSettings::default()
        };
        let to_context = Affine::translate((-f64::from(bounds.x0), -f64::from(bounds.y0)));
        Ok(Some(Box::new(move |canvas| {
            context.reset();
            context.set_transform(to_context);
            for blurred in &rects {
                blurred.fill(&mut context);
            }
            context.flush();
            let target = PixmapMut::new(width, height, canvas).context("a canvas too small")?;
            context.render_with(target, &mut resources, settings);
            Ok(())
        })))
    }
}

struct BlurredFill {
    rect: Rect,
    radius: f32,
    std_dev: f32,
    opacity: f32,
}

impl BlurredFill {
    fn fill(&self, context: &mut RenderContext) {
        context.set_paint(AlphaColor::<Srgb>::new([0.0, 0.0, 0.0, self.opacity]));
        context.fill_blurred_rounded_rect(&self.rect, self.radius, self.std_dev, false);
    }
}

/// What to fill, if every caster is something that it fills.
fn blurred_rects(scene: &Scene) -> Option<Vec<BlurredFill>> {
    let fill = |caster: &Caster| {
        let rounded = caster.rounded?;
        Some(BlurredFill {
            rect: rounded.rect(),
            radius: rounded.radii().as_single_radius()? as f32,
            std_dev: std_dev(caster.sigma()) as f32,
            opacity: caster.opacity,
        })
    };
    scene.casters.iter().map(fill).collect()
}

/// Version 0.3 evaluates erf(x / `std_dev`), where a Gaussian has erf(x / (√2 σ)).
fn std_dev(sigma: f64) -> f64 {
    SQRT_2 * sigma
}

/// The pixels that are drawn at all: a context as large as the canvas would cost more.
fn bounds(scene: &Scene) -> Option<PixelRect> {
    let reached =
        |caster: &Caster| scene.pixels_within(caster, REACH * std_dev(caster.sigma()) + 1.0, 0);
    let rects = scene.casters.iter().filter_map(reached);
    rects.reduce(PixelRect::union)
}
