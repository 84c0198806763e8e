//! The shadow of an image: its alpha, texel by texel, averaged over the light's disc.
//!
//! Sums of alpha make a chord's share of a row of texels two look-ups. The chords are those of Gauss points between the
//! edges of the rows, which are where alpha jumps: for texels of one alpha the rest is smooth.

use std::sync::Arc;

use glam::DVec2;
use libm::{asin, sin};

use super::{Sink, averaged_side, quadrature, reached};
use crate::grid::Grid;
use crate::hidden::Hidden;
use crate::image::{Image, Place};
use crate::light::Projection;

/// Into so many equal angles the disc's height is cut, besides at rows of texels.
const PIECES: u32 = 24;

/// The shadow of an image on one receiver.
#[derive(Debug, Clone)]
pub(crate) struct AlphaShadow {
    image: Arc<Image>,
    place: Place,
    radius: f64,
}

impl AlphaShadow {
    pub(crate) fn project(image: &Arc<Image>, place: &Place, projection: &Projection) -> Self {
        Self {
            image: Arc::clone(image),
            place: Place {
                min: place.min * projection.scale + projection.offset,
                size: place.size * projection.scale,
            },
            radius: projection.radius,
        }
    }

    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }

    /// The image's own box on the receiver.
    pub(crate) fn hull(&self) -> (DVec2, DVec2) {
        (self.place.min, self.place.min + self.place.size)
    }

    /// From texel to texel, scene units.
    fn texel(&self) -> DVec2 {
        self.place.size / DVec2::from(self.image.size().map(f64::from))
    }

    /// Gives `sink` the density of every pixel of the grid that is in the shadow and not hidden.
    pub(crate) fn fill(&self, grid: &Grid, hidden: Option<&Hidden>, sink: &mut dyn Sink) {
        let scale = grid.pixels_per_unit();
        let side = averaged_side(self.radius * scale);
        let (min, max) = reached(self.hull(), self.radius, scale);
        let (min, max) = (min - grid.corner(), max - grid.corner());
        let [columns, rows] = [0, 1].map(|axis| {
            let end = f64::from([grid.width(), grid.height()][axis]);
            let on_grid = |v: f64| v.clamp(0.0, end) as u32;
            on_grid(min[axis].floor())..on_grid(max[axis].ceil())
        });
        let mut chords = Chords::default();
        let mut densities = vec![0.0; columns.len()];
        for row in rows {
            let middle = |column: u32| {
                (grid.corner() + DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5)) / scale
            };
            densities.fill(0.0);
            if self.radius * scale < quadrature::COVERAGE_RADIUS {
                for (column, density) in columns.clone().zip(&mut densities) {
                    let middle = middle(column);
                    let average = quadrature::disc().map(|(light, weight)| {
                        weight * self.coverage(middle + light * self.radius, 1.0 / scale)
                    });
                    *density = average.sum();
                }
            } else if side == 0.0 {
                self.find_chords(middle(0).y, &mut chords);
                self.add(
                    middle(columns.start).x,
                    1.0 / scale,
                    1.0,
                    &chords,
                    &mut densities,
                );
            } else {
                let mut placed = f64::NAN;
                for (offset, weight) in quadrature::square(self.radius * scale) {
                    let offset = offset * side / scale;
                    if offset.y != placed {
                        placed = offset.y;
                        self.find_chords(middle(0).y + offset.y, &mut chords);
                    }
                    let first = middle(columns.start).x + offset.x;
                    self.add(first, 1.0 / scale, weight, &chords, &mut densities);
                }
            }
            for (column, density) in columns.clone().zip(&densities) {
                if *density > 0.0 && hidden.is_none_or(|hidden| !hidden.hides(column, row)) {
                    sink.values(row..row + 1, column..column + 1, &[density.min(1.0) as f32]);
                }
            }
        }
    }

    fn find_chords(&self, y: f64, chords: &mut Chords) {
        let texel = self.texel().y;
        let row_at = |y: f64| (y - self.place.min.y) / texel;
        let angles = &mut chords.angles;
        angles.clear();
        angles.extend((0..=PIECES).map(|piece| quadrature::angle(piece, PIECES)));
        let last = f64::from(self.image.size()[1]);
        let first_row = row_at(y - self.radius).ceil().clamp(0.0, last) as usize;
        let last_row = row_at(y + self.radius).floor().clamp(0.0, last) as usize;
        for row in first_row..=last_row {
            let height = (self.place.min.y + row as f64 * texel - y) / self.radius;
            if height.abs() < 1.0 {
                angles.push(asin(height));
            }
        }
        angles.sort_by(f64::total_cmp);
        chords.chords.clear();
        for piece in angles.windows(2) {
            let half = (piece[1] - piece[0]) / 2.0;
            let middle = piece[0] + half;
            let row = row_at(y + self.radius * sin(middle)).floor();
            if half < 1e-9 || row < 0.0 || row >= last {
                continue;
            }
            let between = quadrature::chords_between(piece[0], piece[1]);
            chords.chords.extend(between.map(|chord| Chord {
                row: row as usize,
                half: self.radius * chord.half,
                weight: chord.weight / self.radius,
            }));
        }
    }

    /// Adds so much of the densities at points that are `step` from one to the next, the first of them at `x`.
    fn add(&self, x: f64, step: f64, weight: f64, chords: &Chords, densities: &mut [f64]) {
        let texel = self.texel().x;
        let (x, step) = ((x - self.place.min.x) / texel, step / texel);
        let sums = self.image.row_sums();
        for chord in &chords.chords {
            let row = sums.row(chord.row);
            let (half, weight) = (chord.half / texel, weight * chord.weight * texel);
            for (column, density) in densities.iter_mut().enumerate() {
                let x = x + column as f64 * step;
                *density += weight * (row.up_to(x + half) - row.up_to(x - half));
            }
        }
    }

    /// The mean alpha over a square about a point.
    fn coverage(&self, middle: DVec2, side: f64) -> f64 {
        let (sums, texel) = (self.image.area_sums(), self.texel());
        let [low, high] = [-0.5, 0.5].map(|way| (middle + way * side - self.place.min) / texel);
        let sum =
            sums.up_to(high.x, high.y) - sums.up_to(low.x, high.y) - sums.up_to(high.x, low.y)
                + sums.up_to(low.x, low.y);
        sum * texel.x * texel.y / (side * side)
    }
}

/// Chords of the disc about points of one height.
#[derive(Debug, Default)]
struct Chords {
    angles: Vec<f64>,
    chords: Vec<Chord>,
}

#[derive(Debug, Clone, Copy)]
struct Chord {
    /// The row of texels that it lies in.
    row: usize,
    /// Half its length, scene units, and what a unit of it is of the disc's area.
    half: f64,
    weight: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::Each;
    use crate::light::Light;
    use crate::scratch::Scratch;
    use crate::shape::Shape;

    /// An image of one alpha is a rectangle of that weight.
    #[test]
    fn an_opaque_image_casts_as_its_box() {
        let grid = Grid::new([0.0, 0.0], [90, 80], 1.0).unwrap();
        for (radius, allowed) in [
            (0.0, 0.01),
            (0.3, 0.2),
            (0.8, 0.2),
            (2.0, 0.2),
            (6.0, 0.1),
            (25.0, 0.1),
        ] {
            let light = Light::directional([0.0, 0.0], radius).unwrap();
            let rect = [20.3, 15.6, 40.0, 30.0];
            let image = Arc::new(Image::from_rgba8([7, 5], vec![255; 4 * 35]).unwrap());
            let projection = light.projection(1.0, 0.0).unwrap();
            let shadow = AlphaShadow::project(&image, &Place::new(rect).unwrap(), &projection);
            let mut ours = vec![0.0; 90 * 80];
            let mut sink = Each {
                pixels: &mut ours,
                stride: 90,
                put: |pixel: &mut f32, density: f32| *pixel = density,
            };
            shadow.fill(&grid, None, &mut sink);
            let shape = Shape::rect(rect[0], rect[1], rect[2], rect[3]).unwrap();
            let options = crate::PixelOptions::default().with_method(crate::plan::Method::Exact);
            let mut expected = vec![0.0; 90 * 80];
            light
                .cast(&shape, 1.0, 0.0)
                .unwrap()
                .fill_f32(&grid, &mut expected, &options, &mut Scratch::new())
                .unwrap();
            let errors = ours
                .iter()
                .zip(&expected)
                .map(|(a, b)| (a - b).abs() * 255.0);
            let worst = errors.fold(0.0, f32::max);
            println!("r {radius}: {worst} levels");
            assert!(worst < allowed, "r {radius}: {worst} levels");
        }
    }

    /// Each texel is a rectangle of its own: their densities add up.
    #[test]
    fn texels_weigh_by_their_alpha() {
        let alphas = [0_u8, 255, 90, 200, 0, 33];
        let pixels: Vec<u8> = alphas
            .iter()
            .flat_map(|&alpha| [10, 20, 30, alpha])
            .collect();
        let image = Arc::new(Image::from_rgba8([3, 2], pixels).unwrap());
        let light = Light::directional([0.0, 0.0], 7.0).unwrap();
        let grid = Grid::new([0.0, 0.0], [60, 50], 1.0).unwrap();
        let projection = light.projection(1.0, 0.0).unwrap();
        let place = Place::new([15.0, 12.0, 30.0, 26.0]).unwrap();
        let shadow = AlphaShadow::project(&image, &place, &projection);
        let mut ours = vec![0.0; 60 * 50];
        let mut sink = Each {
            pixels: &mut ours,
            stride: 60,
            put: |pixel: &mut f32, density: f32| *pixel = density,
        };
        shadow.fill(&grid, None, &mut sink);
        for (index, density) in ours.iter().enumerate() {
            let point = [(index % 60) as f32 + 0.5, (index / 60) as f32 + 0.5];
            let expected: f64 = alphas
                .iter()
                .enumerate()
                .map(|(texel, &alpha)| {
                    let (column, row) = ((texel % 3) as f32, (texel / 3) as f32);
                    let shape =
                        Shape::rect(15.0 + 10.0 * column, 12.0 + 13.0 * row, 10.0, 13.0).unwrap();
                    let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
                    shadow.density_at(point) * f64::from(alpha) / 255.0
                })
                .sum();
            let error = (f64::from(*density) - expected).abs() * 255.0;
            assert!(error < 0.1, "{point:?}: {error} levels");
        }
    }
}
