//! The shadows of all casters together on the ground.

use std::collections::BTreeSet;

use super::caster::{AnyShadow, Cast};
use super::fusion::{self, groups};
use super::{Receiver, Stage};
use crate::density::{Each, PixelOptions, method_of};
use crate::error::Result;
use crate::grid::Grid;
use crate::hidden::Hidden;
use crate::paint::Paint;
use crate::scene::Scene;
use crate::scratch::Scratch;
use crate::shape::Shape;
use crate::tone::Color;

/// Densities on a picture's pixels, row by row, 0 to 1.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DensityMap {
    width: u32,
    height: u32,
    densities: Vec<f32>,
}

impl DensityMap {
    /// Columns.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The densities, row by row.
    #[must_use]
    pub fn densities(&self) -> &[f32] {
        &self.densities
    }

    /// The densities as 16-bit grey, row by row: 65535 is density 1.
    #[must_use]
    pub fn to_grey16(&self) -> Vec<u16> {
        let grey = |density: &f32| (f64::from(*density) * 65535.0 + 0.5) as u16;
        self.densities.iter().map(grey).collect()
    }
}

/// The shadows that a scene's surfaces cast on its ground under its first light, projected and ready to be drawn.
#[derive(Debug)]
pub struct GroundShadows<'a> {
    scene: &'a Scene,
    grid: Grid,
    casts: Vec<Cast>,
}

impl Scene {
    /// Projects the casters on the ground, as far as the canvas shows it.
    ///
    /// # Errors
    /// None that the scene's constructors let pass.
    pub fn ground_shadows(&self) -> Result<GroundShadows<'_>> {
        let stage = Stage::of_first_light(self)?;
        let casts = stage.casts(&Receiver::ground(self))?;
        Ok(GroundShadows {
            scene: self,
            grid: self.grid()?,
            casts: casts.into_iter().flat_map(|(_, casts)| casts).collect(),
        })
    }
}

impl GroundShadows<'_> {
    /// The picture's pixels.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The names of what draws them, each once: of methods, and `tilted` and `image` for casters that have one way each, whatever
    /// the options say.
    #[must_use]
    pub fn drawn_by(&self, options: &PixelOptions<'_>) -> BTreeSet<&'static str> {
        let mut names = BTreeSet::new();
        for cast in &self.casts {
            match &cast.shadow {
                AnyShadow::Level(shadow) => {
                    let parts = shadow.parts_on(&self.grid, 0.0);
                    names.extend(parts.map(|part| method_of(part, &self.grid, options).name()));
                }
                AnyShadow::Tilted(_) => _ = names.insert("tilted"),
                AnyShadow::Alpha(_) => _ = names.insert("image"),
            }
        }
        names
    }

    /// Hides the pixels under the scene's opaque surfaces but the tilted ones.
    pub fn hide_covered(&self, hidden: &mut Hidden, scratch: &mut Scratch) {
        let opaque = self
            .scene
            .surfaces()
            .iter()
            .filter(|surface| surface.is_united());
        hidden.reset(&self.grid);
        hidden.add_all(opaque.map(|surface| -> &Shape { surface.shape() }), scratch);
    }

    /// Draws what all casters hide of the light into `map`, whose memory is used again; hidden pixels are 0.
    ///
    /// # Errors
    /// Options for another grid.
    pub fn draw(
        &self,
        map: &mut DensityMap,
        options: &PixelOptions<'_>,
        scratch: &mut Scratch,
    ) -> Result<()> {
        options.check(&self.grid)?;
        let (width, height) = (self.grid.width(), self.grid.height());
        (map.width, map.height) = (width, height);
        map.densities.clear();
        map.densities.resize(width as usize * height as usize, 0.0);
        let mut sink = Each {
            pixels: &mut map.densities,
            stride: width as usize,
            put: |pixel: &mut f32, held: f32| *pixel += (1.0 - *pixel) * held,
        };
        for group in groups(
            &self.casts,
            self.scene.overlap(),
            self.grid.pixels_per_unit(),
        ) {
            fusion::draw(&group, &self.grid, options, scratch, &mut sink);
        }
        Ok(())
    }

    /// Blends the shadows in the scene's tone onto premultiplied RGBA8 pixels, row by row.
    ///
    /// # Errors
    /// [`Error::BufferSize`](crate::Error::BufferSize) when `pixels` are fewer than the grid's.
    pub fn blend_rgba8(
        &self,
        pixels: &mut [u8],
        options: &PixelOptions<'_>,
        scratch: &mut Scratch,
    ) -> Result<()> {
        let tone = self.scene.tone();
        for group in groups(
            &self.casts,
            self.scene.overlap(),
            self.grid.pixels_per_unit(),
        ) {
            // Alone, a cast needs no density between its method and the pixels.
            let weight = match group.as_slice() {
                [alone] => alone.weight() as f32,
                _ => 1.0,
            };
            let paint = Paint::new(opaque(tone.color()), tone.key() * weight)?;
            let mut sink = options.onto_rgba8(&self.grid, pixels, &paint, scratch)?;
            match group.as_slice() {
                [alone] => alone.shadow.draw(&self.grid, options, scratch, &mut sink),
                _ => fusion::draw(&group, &self.grid, options, scratch, &mut sink),
            }
        }
        Ok(())
    }
}

fn opaque(color: Color) -> Color {
    Color::rgb(color.r, color.g, color.b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use crate::path::{FillRule, Path};
    use crate::scene::Surface;
    use crate::scratch;

    /// Two cards whose sides cross in one disc, a path that three casters meet on, and one seen through.
    #[test]
    fn every_simd_level_gives_the_same_bits_where_casters_meet() {
        let light = Light::new([60.0, 10.0, 300.0], 200.0).unwrap();
        let mut scene = Scene::new([130.0, 120.0], light).unwrap();
        let mut bird = Path::new();
        bird.move_to([30.0, 20.0]);
        bird.cubic_to([90.0, 10.0], [110.0, 60.0], [60.0, 100.0]);
        bird.cubic_to([20.0, 90.0], [10.0, 40.0], [30.0, 20.0]);
        let shapes = [
            (Shape::rect(20.3, 30.1, 60.0, 40.0).unwrap(), 6.0),
            (
                Shape::rounded_rect(50.2, 20.4, 50.0, 60.0, 9.0).unwrap(),
                11.0,
            ),
            (Shape::path(&bird, FillRule::NonZero).unwrap(), 17.0),
            (Shape::circle([40.0, 70.0], 22.0).unwrap(), 24.0),
        ];
        for (shape, elevation) in shapes {
            scene.push(Surface::new(shape, elevation)).unwrap();
        }
        let shadows = scene.ground_shadows().unwrap();
        let drawn = scratch::levels().into_iter().map(|level| {
            let mut map = DensityMap::default();
            let options = PixelOptions::default();
            shadows
                .draw(&mut map, &options, &mut Scratch::at_level(level))
                .unwrap();
            map.densities
                .iter()
                .map(|d| d.to_bits())
                .collect::<Vec<_>>()
        });
        let drawn: Vec<_> = drawn.collect();
        assert!(drawn.windows(2).all(|pair| pair[0] == pair[1]));
    }
}
