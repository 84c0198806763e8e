//! Damage: where one scene looks other than another.

use glam::DVec2;

use super::Source;
use crate::apart::overlapping;
use crate::error::Result;
use crate::scene::{Scene, Surface};
use crate::shadow::Bounds;

impl Scene {
    /// Boxes outside of which this scene's picture and that of an earlier one are the same, bit for bit: around surfaces that
    /// were added, removed or changed and all shadows of theirs, then and now. No two of them overlap. They are what
    /// [`Renderer::render_within`](crate::Renderer::render_within) has to draw again.
    ///
    /// # Errors
    /// None that the constructors let pass.
    pub fn damage_since(&self, before: &Self) -> Result<Vec<Bounds>> {
        let canvas = (DVec2::ZERO, DVec2::from(self.canvas().map(f64::from)));
        if !self.is_lit_as(before) {
            return Ok(vec![Bounds::outwards(canvas.0, canvas.1)]);
        }
        let (now, then) = (self.surfaces(), before.surfaces());
        let pairs = || now.iter().zip(then);
        let head = pairs().take_while(|(a, b)| a == b).count();
        let most = now.len().min(then.len()) - head;
        let tail = now.iter().rev().zip(then.iter().rev()).take(most);
        let tail = tail.take_while(|(a, b)| a == b).count();
        let (now, then) = (&now[head..now.len() - tail], &then[head..then.len() - tail]);
        // In a list of one length only some may have changed.
        let changed: Vec<&Surface> = if now.len() == then.len() {
            now.iter()
                .zip(then)
                .filter(|(a, b)| a != b)
                .flat_map(|(a, b)| [a, b])
                .collect()
        } else {
            now.iter().chain(then).collect()
        };
        let mut boxes = Vec::new();
        for (source, _) in Source::of(self) {
            let reach = |surface: &Surface| -> Result<Option<(DVec2, DVec2)>> {
                let reach = source.reach(surface)?;
                Ok(reach.map(|(min, max)| self.on_pixels(min, max)))
            };
            // Casters that are drawn as one are drawn anew together, though what changes is less than the tolerance.
            let mut drawn = changed.clone();
            let mut rest: Vec<&Surface> = self.surfaces().iter().chain(before.surfaces()).collect();
            rest.retain(|surface| surface.is_united());
            while let Some(surface) = drawn.pop() {
                let Some((min, max)) = reach(surface)? else {
                    continue;
                };
                boxes.push((min, max));
                if !surface.is_united() {
                    continue;
                }
                let mut kept = Vec::with_capacity(rest.len());
                for other in rest {
                    let meets = other.elevation() == surface.elevation()
                        && reach(other)?.is_some_and(|(other_min, other_max)| {
                            other_min.cmple(max).all() && other_max.cmpge(min).all()
                        });
                    if meets {
                        drawn.push(other);
                    } else {
                        kept.push(other);
                    }
                }
                rest = kept;
            }
        }
        for surface in changed {
            if let Some((min, max)) = surface.hull() {
                boxes.push(self.on_pixels(min, max));
            }
        }
        let boxed = boxes
            .into_iter()
            .filter(|(min, max)| min.cmplt(canvas.1).all() && max.cmpgt(canvas.0).all())
            .map(|(min, max)| (min, max, (min, max)));
        let whole = |group: Vec<(DVec2, DVec2)>| {
            let grown = group
                .into_iter()
                .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
            Some(Bounds::outwards(
                grown.0.max(canvas.0),
                grown.1.min(canvas.1),
            ))
        };
        Ok(overlapping(boxed.collect())
            .into_iter()
            .filter_map(whole)
            .collect())
    }

    /// A box grown to whole pixels, and by one: a pixel may see beyond its own square.
    fn on_pixels(&self, min: DVec2, max: DVec2) -> (DVec2, DVec2) {
        let scale = f64::from(self.scale());
        (
            ((min * scale).floor() - 1.0) / scale,
            ((max * scale).ceil() + 1.0) / scale,
        )
    }
}
