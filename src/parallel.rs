//! Drawing on several threads: a band of rows each. The bits are those of one thread.

use crate::density::PixelOptions;
use crate::error::{Error, Result};
use crate::grid::Grid;
use crate::paint::Paint;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

impl Shadow {
    /// As [`Shadow::fill_a8`], in as many bands of rows as there are scratches, on rayon's threads.
    ///
    /// # Errors
    /// As [`Shadow::fill_a8`], and no scratch at all.
    pub fn fill_a8_in_bands(
        &self,
        grid: &Grid,
        mask: &mut [u8],
        options: &PixelOptions<'_>,
        scratches: &mut [Scratch],
    ) -> Result<()> {
        in_bands(
            grid,
            mask,
            1,
            options,
            scratches,
            |band, mask, options, scratch| self.fill_a8(band, mask, options, scratch),
        )
    }

    /// As [`Shadow::blend_rgba8`], in as many bands of rows as there are scratches, on rayon's threads.
    ///
    /// # Errors
    /// As [`Shadow::blend_rgba8`], and no scratch at all.
    pub fn blend_rgba8_in_bands(
        &self,
        grid: &Grid,
        pixels: &mut [u8],
        paint: &Paint,
        options: &PixelOptions<'_>,
        scratches: &mut [Scratch],
    ) -> Result<()> {
        in_bands(
            grid,
            pixels,
            4,
            options,
            scratches,
            |band, pixels, options, scratch| {
                self.blend_rgba8(band, pixels, paint, options, scratch)
            },
        )
    }
}

fn in_bands(
    grid: &Grid,
    buffer: &mut [u8],
    channels: usize,
    options: &PixelOptions<'_>,
    scratches: &mut [Scratch],
    draw: impl Fn(&Grid, &mut [u8], &PixelOptions<'_>, &mut Scratch) -> Result<()> + Sync,
) -> Result<()> {
    grid.check_buffer(buffer.len() / channels)?;
    options.check(grid)?;
    if scratches.is_empty() {
        return Err(Error::OutOfRange {
            field: "scratches",
            value: 0.0,
            min: 1.0,
            max: f64::from(u32::MAX),
        });
    }
    let height = grid.height() as usize;
    let rows = height.div_ceil(scratches.len());
    let mut results = vec![Ok(()); scratches.len()];
    rayon::scope(|scope| {
        let draw = &draw;
        let mut rest = buffer;
        for (index, (scratch, result)) in scratches.iter_mut().zip(&mut results).enumerate() {
            let (first, end) = (index * rows, ((index + 1) * rows).min(height));
            if first >= end {
                break;
            }
            let length = (rows * grid.stride() * channels).min(rest.len());
            let (part, after) = core::mem::take(&mut rest).split_at_mut(length);
            rest = after;
            scope.spawn(move |_| {
                let band = grid.band(first as u32, end as u32);
                let hidden = options
                    .hidden
                    .map(|hidden| hidden.window(&band, [0, first as u32]));
                let options = options.with_hidden(hidden.as_ref());
                *result = draw(&band, part, &options, scratch);
            });
        }
    });
    results.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hidden::Hidden;
    use crate::light::Light;
    use crate::shape::Shape;
    use crate::tone::Color;

    #[test]
    fn one_two_and_seven_threads_draw_the_same_bits() {
        let grid = Grid::new([0.0, 0.0], [150, 131], 1.0).unwrap();
        let grid = grid.with_stride(157).unwrap();
        let card = Shape::rounded_rect(30.2, 25.7, 90.0, 80.0, 12.0).unwrap();
        let star: Vec<[f32; 2]> = (0_u8..10)
            .map(|i| {
                let (sin, cos) = (f32::from(i) * core::f32::consts::PI / 5.0).sin_cos();
                let radius = if i % 2 == 0 { 60.0 } else { 24.0 };
                [75.0 + radius * sin, 65.0 - radius * cos]
            })
            .collect();
        let star = Shape::polygon(&[star], crate::path::FillRule::NonZero).unwrap();
        let paint = Paint::new(Color::rgb(20, 40, 60), 0.7).unwrap();
        for shape in [&card, &star] {
            for radius in [0.0_f32, 1.5, 8.0, 40.0] {
                let light = Light::directional([0.0, 0.0], radius).unwrap();
                let shadow = light.cast(shape, 1.0, 0.0).unwrap();
                let mut scratch = Scratch::new();
                let mut hidden = Hidden::new(&grid);
                hidden.add(&card, &mut scratch);
                for hidden in [None, Some(&hidden)] {
                    let options = PixelOptions::default()
                        .with_hidden(hidden)
                        .with_dither(true);
                    let mut alone = vec![200; 4 * (157 * 130 + 150)];
                    shadow
                        .blend_rgba8(&grid, &mut alone, &paint, &options, &mut scratch)
                        .unwrap();
                    let mut mask_alone = vec![200; 157 * 130 + 150];
                    shadow
                        .fill_a8(&grid, &mut mask_alone, &options, &mut scratch)
                        .unwrap();
                    for threads in [1, 2, 7] {
                        let mut scratches: Vec<Scratch> =
                            (0..threads).map(|_| Scratch::new()).collect();
                        let mut together = vec![200; 4 * (157 * 130 + 150)];
                        shadow
                            .blend_rgba8_in_bands(
                                &grid,
                                &mut together,
                                &paint,
                                &options,
                                &mut scratches,
                            )
                            .unwrap();
                        assert!(alone == together, "{threads} threads, r {radius}");
                        let mut mask = vec![200; 157 * 130 + 150];
                        shadow
                            .fill_a8_in_bands(&grid, &mut mask, &options, &mut scratches)
                            .unwrap();
                        assert!(mask_alone == mask, "{threads} threads, r {radius}, mask");
                    }
                }
            }
        }
    }
}
