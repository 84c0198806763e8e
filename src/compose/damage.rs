//! Damage: where one scene looks other than another.

use glam::DVec2;

use super::Source;
use crate::apart::{around, overlapping};
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
    pub fn damage_since<'s>(&'s self, before: &'s Self) -> Result<Vec<Bounds>> {
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
            let boxed = |surface: &&'s Surface| {
                let reach = source.reach(surface).transpose()?;
                Some(reach.map(|(min, max)| (*surface, self.on_pixels(min, max))))
            };
            // Casters that are drawn as one are drawn anew together, though what changes is less than the tolerance.
            let all = self.surfaces().iter().chain(before.surfaces());
            let united = all.filter(|surface| surface.is_united());
            let mut rest: Vec<_> = united
                .filter_map(|surface| boxed(&surface))
                .collect::<Result<_>>()?;
            let mut drawn: Vec<_> = changed.iter().filter_map(boxed).collect::<Result<_>>()?;
            while let Some((surface, (min, max))) = drawn.pop() {
                boxes.push((min, max));
                if surface.is_united() {
                    drawn.extend(rest.extract_if(.., |(other, (other_min, other_max))| {
                        other.elevation() == surface.elevation()
                            && other_min.cmple(max).all()
                            && other_max.cmpge(min).all()
                    }));
                }
            }
        }
        for surface in changed {
            if let Some((min, max)) = surface.hull() {
                boxes.push(self.on_pixels(min, max));
            }
        }
        boxes.retain(|(min, max)| min.cmplt(canvas.1).all() && max.cmpgt(canvas.0).all());
        let boxes = disjoint(boxes).into_iter();
        let shown = boxes.map(|(min, max)| Bounds::outwards(min.max(canvas.0), max.min(canvas.1)));
        Ok(shown.collect())
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

/// Boxes that hold others, no two of which overlap.
fn disjoint(mut boxes: Vec<(DVec2, DVec2)>) -> Vec<(DVec2, DVec2)> {
    loop {
        let count = boxes.len();
        let boxed = boxes.into_iter().map(|(min, max)| (min, max, (min, max)));
        let groups = overlapping(boxed.collect()).into_iter();
        boxes = groups.filter_map(around).collect();
        // Boxes around groups may overlap anew.
        if boxes.len() == count {
            return boxes;
        }
    }
}
