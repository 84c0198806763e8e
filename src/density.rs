//! Densities: at a point, and on a grid of pixels by one method a file.

pub(crate) mod alpha;
mod area;
pub(crate) mod blend;
mod buffer;
pub(crate) mod circle;
mod coverage;
mod cubic;
pub(crate) mod direct;
mod dither;
pub(crate) mod exact;
pub(crate) mod frame;
pub(crate) mod grid;
pub(crate) mod lanes;
pub(crate) mod nine_patch;
mod options;
pub(crate) mod quadrature;
pub(crate) mod rounded;
pub(crate) mod rows;
pub(crate) mod runs;
mod sampling;
mod sweep;
pub(crate) mod tiles;
pub(crate) mod tilted;

use core::f64::consts::FRAC_PI_2;
use core::ops::Range;

use fearless_simd::dispatch;
use glam::DVec2;

use self::frame::Frame;
use self::runs::Run;
use crate::grid::Grid;
use crate::hidden::Hidden;
use crate::plan::{self, Method};
use crate::scratch::Scratch;
use crate::shadow::Shadow;

pub(crate) use area::{at_point, half_area};
pub(crate) use buffer::clear;
pub use options::PixelOptions;

/// How far flattening may move the density of `exact`, in levels.
pub(crate) const EXACT_SHARE: f64 = 0.02;

/// Takes the densities that a method computes; those it is not given are 0. What it is given of a pixel more than once, by
/// neighbouring parts of a shadow, adds up.
pub(crate) trait Sink {
    /// One density for some columns of some rows.
    fn constant(&mut self, rows: Range<u32>, columns: Range<u32>, density: f32);

    /// The densities of some columns, the same in each of some rows, at least as many as columns: those behind them count for nothing,
    /// but where there are enough of them they save a copy.
    fn values(&mut self, rows: Range<u32>, columns: Range<u32>, densities: &[f32]);

    /// The densities of many runs, one after another.
    fn runs(&mut self, runs: &[Run], densities: &[f32]) {
        for (Run { row, columns }, densities) in runs::each(runs, densities) {
            self.values(*row..*row + 1, columns.clone(), densities);
        }
    }
}

/// Calls `put` for each pixel that is given a density.
pub(crate) struct Each<'a, T, F> {
    pub(crate) pixels: &'a mut [T],
    pub(crate) stride: usize,
    pub(crate) put: F,
}

impl<T, F: FnMut(&mut T, f32)> Sink for Each<'_, T, F> {
    #[inline(always)]
    fn constant(&mut self, rows: Range<u32>, columns: Range<u32>, density: f32) {
        for y in rows {
            let start = y as usize * self.stride;
            let (start, end) = (start + columns.start as usize, start + columns.end as usize);
            for pixel in &mut self.pixels[start..end] {
                (self.put)(pixel, density);
            }
        }
    }

    #[inline(always)]
    fn values(&mut self, rows: Range<u32>, columns: Range<u32>, densities: &[f32]) {
        for y in rows {
            let start = y as usize * self.stride;
            let (start, end) = (start + columns.start as usize, start + columns.end as usize);
            for (pixel, density) in self.pixels[start..end].iter_mut().zip(densities) {
                (self.put)(pixel, *density);
            }
        }
    }
}

/// Gives `sink` the density of every pixel of the grid that is in the shadow and not hidden.
pub(crate) fn draw(
    shadow: &Shadow,
    grid: &Grid,
    options: &PixelOptions<'_>,
    scratch: &mut Scratch,
    sink: &mut dyn Sink,
) {
    for part in shadow.parts_on(grid, 0.0) {
        draw_part(part, grid, options, scratch, sink);
    }
}

/// What draws a shadow that is one of the [`parts`](Shadow::parts_on): a method that cannot gives way to `direct`.
pub(crate) fn method_of(shadow: &Shadow, on: &Grid, options: &PixelOptions<'_>) -> Method {
    let per_unit = on.pixels_per_unit();
    let is_able = |method| match method {
        Method::NinePatch => nine_patch::suited(shadow, per_unit).is_some(),
        Method::Grid => {
            let (radius, extent) = (shadow.radius() * per_unit, shadow.extent() * per_unit);
            grid::suits(radius, options.tolerance.as_levels(), extent)
        }
        Method::Exact | Method::Direct | Method::Mesh => true,
    };
    match options.method {
        Some(method) if is_able(method) => method,
        Some(_) => Method::Direct,
        None => plan::choose(shadow, options.tolerance, plan::Target::Pixels(*on)).method,
    }
}

fn draw_part(
    shadow: &Shadow,
    on: &Grid,
    options: &PixelOptions<'_>,
    scratch: &mut Scratch,
    sink: &mut dyn Sink,
) {
    let per_unit = on.pixels_per_unit();
    let method = method_of(shadow, on, options);
    let level = scratch.level();
    match method {
        Method::Exact => exact::fill(shadow, on, options.hidden, scratch, sink),
        Method::Mesh => {
            let mesh = shadow.mesh(options.tolerance);
            mesh.scan_convert(on, options.hidden, sink);
        }
        Method::NinePatch if let Some(rounded) = nine_patch::suited(shadow, per_unit) => {
            let radius = shadow.radius() * per_unit;
            if rounded.circle().is_some() && averaged_side(radius) == 0.0 {
                let bounds = (rounded.min, rounded.max);
                dispatch!(level, simd => circle::fill(simd, bounds, radius, on, options, scratch, sink));
            } else {
                dispatch!(level, simd => {
                    nine_patch::fill(simd, &rounded, radius, on, options, scratch, sink);
                });
            }
        }
        Method::Direct | Method::Grid | Method::NinePatch => {
            let levels = options.tolerance.as_levels();
            let radius = shadow.radius() * per_unit;
            let sums = method == Method::Grid;
            // An outline that is kept is the same for both methods.
            let curves = if sums || !shadow.has_simple_curves() {
                CURVES
            } else {
                direct::curves(radius, levels)
            };
            let mut edges = scratch.take();
            shadow.arcs_into(curves * levels, 1.0 / per_unit, &mut edges);
            if sums {
                dispatch!(level, simd => grid::fill(simd, &edges, radius, on, options, scratch, sink));
            } else {
                // In scene units: whether arcs are as large as the disc is asked of them as they are.
                let in_units = shadow.radius();
                dispatch!(level, simd => direct::fill(simd, &edges, in_units, on, options, scratch, sink));
            }
            scratch.give(edges);
        }
    }
}

/// The share of the tolerance that lines in place of curves may take.
pub(crate) const CURVES: f64 = 0.25;

/// Puts the parts of a row's `columns` that are seen into `seen`, in the frame's pixels.
fn seen_columns(
    hidden: Option<&Hidden>,
    row: u32,
    frame: &Frame,
    columns: &Range<i64>,
    seen: &mut Vec<Range<i64>>,
) {
    seen.clear();
    let origin = frame.first[0];
    match hidden {
        Some(hidden) => {
            let on_grid = (columns.start - origin) as u32..(columns.end - origin) as u32;
            hidden.seen(row, on_grid, |part| {
                seen.push(origin + i64::from(part.start)..origin + i64::from(part.end));
            });
        }
        None => seen.push(columns.clone()),
    }
}

/// Sorts ranges and joins those that touch.
fn join(ranges: &mut Vec<Range<i64>>) {
    ranges.sort_unstable_by_key(|range| range.start);
    ranges.dedup_by(|next, range| {
        let touches = next.start <= range.end;
        if touches {
            range.end = range.end.max(next.end);
        }
        touches
    });
}

/// How far from a curve its chords may be to move no density by more than `levels`: a strip of that width along a disc's
/// diameter, 2 r wide, over the disc's area π r²; a strip along a pixel's side where that is less. `radius` and `pixel`,
/// the pixel's side, in the unit of the result.
pub(crate) fn flatness(levels: f64, radius: f64, pixel: f64) -> f64 {
    levels / 255.0 * pixel.max(FRAC_PI_2 * radius)
}

/// The average of `density` over the square about a pixel's centre on which it depends at that penumbra radius, in pixels.
#[cfg(feature = "lab")]
pub(crate) fn square_average(radius: f64, density: impl Fn(DVec2) -> f64) -> f64 {
    let side = averaged_side(radius);
    if side == 0.0 {
        return density(DVec2::ZERO);
    }
    quadrature::exact_square(radius, 1)
        .map(|(offset, weight)| weight * density(offset * side))
        .sum()
}

/// How far from its centre a pixel's density depends on what is there, in pixels, for a penumbra radius in pixels.
pub(crate) fn reach(radius: f64) -> f64 {
    radius + averaged_side(radius) / 2.0
}

/// The box of the pixels that see a shadow whose outline is within a box, in pixels of which there are `per_unit` a scene unit.
pub(crate) fn reached((min, max): (DVec2, DVec2), radius: f64, per_unit: f64) -> (DVec2, DVec2) {
    let reach = reach(radius * per_unit);
    (min * per_unit - reach, max * per_unit + reach)
}

/// The side of the square about its centre over which a pixel's density is averaged, in pixels, for a penumbra radius
/// in pixels: the whole pixel up to 1, nothing from 3 on. So a hard edge is antialiased, a soft one costs one sample,
/// and nothing jumps between.
pub(crate) fn averaged_side(radius: f64) -> f64 {
    ((3.0 - radius) / 2.0).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use fearless_simd::Level;

    use super::*;
    use crate::light::Light;
    use crate::mesh::{MeshBuffers, MeshOptions, MeshVertex};
    use crate::paint::Paint;
    use crate::path::{FillRule, Path};
    use crate::scratch;
    use crate::shape::Shape;
    use crate::tolerance::Tolerance;
    use crate::tone::Color;

    #[test]
    fn the_averaged_square_has_no_jump() {
        assert_eq!(averaged_side(0.0), 1.0);
        assert_eq!(averaged_side(1.0), 1.0);
        assert_eq!(averaged_side(2.0), 0.5);
        assert_eq!(averaged_side(3.0), 0.0);
        assert_eq!(averaged_side(100.0), 0.0);
    }

    fn shapes() -> Vec<Shape> {
        let mut blob = Path::new();
        blob.move_to([20.0, 60.0]);
        blob.cubic_to([20.0, 0.0], [110.0, 20.0], [100.0, 60.0]);
        blob.cubic_to([90.0, 120.0], [20.0, 110.0], [20.0, 60.0]);
        let ring = |side: f32| {
            let (a, b) = (60.0 - side, 60.0 + side);
            [[a, 60.0], [60.0, a + 3.0], [b, 60.0], [60.0, b]]
        };
        vec![
            Shape::rounded_rect(20.3, 30.6, 80.0, 50.0, [4.0, 12.0, 0.0, 20.0]).unwrap(),
            Shape::circle([60.2, 60.4], 33.0).unwrap(),
            Shape::polygon(&[ring(45.0), ring(17.0)], FillRule::EvenOdd).unwrap(),
            Shape::path(&blob, FillRule::NonZero).unwrap(),
        ]
    }

    #[test]
    fn every_simd_level_gives_the_same_bits() {
        let levels = scratch::levels();
        println!("{levels:?}");
        // Where nothing is optimised each takes a minute.
        std::thread::scope(|scope| {
            for shape in shapes() {
                let levels = &levels;
                scope.spawn(move || levels_give_the_same_bits(levels, &shape));
            }
        });
    }

    fn levels_give_the_same_bits(levels: &[Level], shape: &Shape) {
        let grid = Grid::new([0.0, 0.0], [125, 121], 1.0).unwrap();
        let paint = Paint::new(Color::rgb(30, 60, 90), 0.6).unwrap();
        let methods = [
            None,
            Some(Method::Direct),
            Some(Method::Grid),
            Some(Method::NinePatch),
        ];
        for radius in [0.0_f32, 0.2, 0.7, 1.7, 2.6, 6.0, 20.0, 45.0] {
            let light = Light::directional([0.0, 0.0], radius).unwrap();
            let shadow = light.cast(shape, 1.0, 0.0).unwrap();
            for method in methods {
                let options = PixelOptions::default()
                    .with_method(method)
                    .with_dither(true);
                let drawn = levels.iter().map(|level| {
                    let mut scratch = Scratch::at_level(*level);
                    let mut densities = vec![0.0; 125 * 121];
                    let mut mask = vec![0; 125 * 121];
                    let mut pixels = vec![180; 4 * 125 * 121];
                    shadow
                        .fill_f32(&grid, &mut densities, &options, &mut scratch)
                        .unwrap();
                    shadow
                        .fill_a8(&grid, &mut mask, &options, &mut scratch)
                        .unwrap();
                    shadow
                        .blend_rgba8(&grid, &mut pixels, &paint, &options, &mut scratch)
                        .unwrap();
                    paint
                        .blend_mask(&grid, &mask, grid.stride(), &mut pixels, &mut scratch)
                        .unwrap();
                    let bits: Vec<u32> = densities.iter().map(|d| d.to_bits()).collect();
                    (bits, mask, pixels)
                });
                let drawn: Vec<_> = drawn.collect();
                assert!(
                    drawn.windows(2).all(|pair| pair[0] == pair[1]),
                    "{method:?}, r {radius}"
                );
            }
            let options = MeshOptions::new(Tolerance::ONE_LEVEL).quick();
            let meshes = levels.iter().map(|level| {
                let mut scratch = Scratch::at_level(*level);
                let mut mesh = MeshBuffers::<u32>::new();
                shadow.mesh_into(&mut mesh, options, &mut scratch).unwrap();
                let vertex = |v: &MeshVertex| {
                    let [x, y] = v.position;
                    [x, y, v.density].map(f32::to_bits)
                };
                let vertices: Vec<_> = mesh.vertices.iter().map(vertex).collect();
                (vertices, mesh.indices)
            });
            let meshes: Vec<_> = meshes.collect();
            assert!(
                meshes.windows(2).all(|pair| pair[0] == pair[1]),
                "mesh, r {radius}"
            );
        }
    }
}
