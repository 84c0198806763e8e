//! Shadows of which nothing is drawn.

use core::fmt;
use core::ops::Range;

use crate::density::frame::Frame;
use crate::density::{PixelOptions, reach};
use crate::error::Result;
use crate::grid::Grid;
use crate::shadow::Shadow;

/// Why nothing of a shadow is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Skip {
    /// It covers nothing.
    Empty,
    /// It lies beside the grid.
    OffGrid,
    /// No pixel that it reaches is seen.
    Hidden,
    /// The paint is so weak, or the caster so small for its penumbra, that no byte changes.
    Faint,
}

/// Whether anything of a shadow is to be drawn on a grid, with paint of an `opacity` from 0 to 1 on 8-bit pixels; none where
/// weak paint counts as well, as it does where bytes are dithered.
///
/// Nothing is built for it: a box that holds the shadow decides.
///
/// # Errors
/// Options for another grid.
pub fn skip(
    shadow: &Shadow,
    grid: &Grid,
    options: &PixelOptions<'_>,
    opacity: Option<f32>,
) -> Result<Option<Skip>> {
    options.check(grid)?;
    let Some(hull) = shadow.hull() else {
        return Ok(Some(Skip::Empty));
    };
    let radius = shadow.radius() * grid.pixels_per_unit();
    let frame = Frame::new(hull, reach(radius), grid);
    let [columns, rows] = frame.pixels();
    if columns.is_empty() || rows.is_empty() {
        return Ok(Some(Skip::OffGrid));
    }
    if let Some(opacity) = opacity.filter(|_| !options.dither) {
        let size = hull.1 - hull.0;
        let disc = core::f64::consts::PI * shadow.radius() * shadow.radius();
        let most = f64::from(opacity) * (size.x * size.y / disc).min(1.0);
        if most * 255.0 < FAINTEST {
            return Ok(Some(Skip::Faint));
        }
    }
    let Some(hidden) = options.hidden else {
        return Ok(None);
    };
    let on_grid = |from: &Range<i64>, axis: usize| {
        let first = frame.first[axis];
        (from.start - first) as u32..(from.end - first) as u32
    };
    let (columns, rows) = (on_grid(&columns, 0), on_grid(&rows, 1));
    let is_seen = |row: u32| {
        let mut any = false;
        hidden.seen(row, columns.clone(), |_| any = true);
        any
    };
    Ok((!rows.into_iter().any(is_seen)).then_some(Skip::Hidden))
}

/// What changes no byte, in its steps: a half would round to one, and blending rounds a little of its own.
const FAINTEST: f64 = 0.45;

impl fmt::Display for Skip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Empty => "it covers nothing",
            Self::OffGrid => "it lies beside the picture",
            Self::Hidden => "no pixel that it reaches is seen",
            Self::Faint => "it is so faint that no byte changes",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hidden::Hidden;
    use crate::light::Light;
    use crate::paint::Paint;
    use crate::scratch::Scratch;
    use crate::shape::Shape;
    use crate::tone::Color;

    fn cast(shape: &Shape, radius: f32) -> Shadow {
        let light = Light::directional([0.0, 0.0], radius).unwrap();
        light.cast(shape, 1.0, 0.0).unwrap()
    }

    #[test]
    fn what_is_skipped_changes_no_byte() {
        let card = Shape::rounded_rect(10.0, 10.0, 20.0, 20.0, 4.0).unwrap();
        let grid = Grid::new([0.0, 0.0], [80, 60], 1.0).unwrap();
        let plain = PixelOptions::default();
        let mut scratch = Scratch::new();
        let skipped = |shadow: &Shadow, options: &PixelOptions<'_>, opacity: Option<f32>| {
            skip(shadow, &grid, options, opacity).unwrap()
        };
        assert_eq!(
            skipped(&cast(&card, 8.0), &plain, Some(0.002)),
            None,
            "half a byte may round to one"
        );
        for (radius, strength) in [(8.0, 0.0017), (90.0, 0.1), (0.0, 0.001)] {
            let shadow = cast(&card, radius);
            assert_eq!(skipped(&shadow, &plain, Some(strength)), Some(Skip::Faint));
            // Drawn without the plan, it would have left every byte as it was.
            for color in [Color::BLACK, Color::WHITE] {
                let paint = Paint::new(color, strength).unwrap();
                let before: Vec<u8> = (0..80 * 60 * 4_u32).map(|i| (i / 4 % 256) as u8).collect();
                let mut after = before.clone();
                let mut sink = plain
                    .onto_rgba8(&grid, &mut after, &paint, &scratch)
                    .unwrap();
                crate::density::draw(&shadow, &grid, &plain, &mut scratch, &mut sink);
                let opaque = |bytes: &[u8]| bytes.iter().step_by(4).copied().collect::<Vec<_>>();
                assert_eq!(opaque(&before), opaque(&after), "r {radius}, {color:?}");
            }
        }
        let shadow = cast(&card, 2.0);
        let beside = Grid::new([100.0, 0.0], [80, 60], 1.0).unwrap();
        let off = skip(&shadow, &beside, &plain, None);
        assert_eq!(off, Ok(Some(Skip::OffGrid)));
        let mut hidden = Hidden::new(&grid);
        hidden.add(&Shape::rect(5.0, 5.0, 30.0, 30.0).unwrap(), &mut scratch);
        let covered = plain.with_hidden(&hidden);
        assert_eq!(skipped(&shadow, &covered, None), Some(Skip::Hidden));
        assert_eq!(skipped(&cast(&card, 9.0), &covered, None), None);
    }
}
