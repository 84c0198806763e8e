//! Gouraud rasterisation: densities interpolated along the edges of a triangle, and between them along each scan line
//! (Gouraud 1971).

use glam::DVec2;

use super::{MeshVertex, ShadowMesh};
use crate::density::{Each, Sink, clear};
use crate::error::Result;
use crate::grid::Grid;
use crate::hidden::Hidden;
use crate::scan::{Corner, scan_convert};

impl ShadowMesh {
    /// Draws the mesh on a grid: `densities` gets the interpolated density of each pixel's centre, 0 outside of the mesh.
    /// A pixel centre on an edge belongs to the triangle right of it or below, so none is drawn twice and none left out.
    ///
    /// # Errors
    /// [`Error::BufferSize`](crate::Error::BufferSize) when `densities` is shorter than the grid needs.
    pub fn rasterize(&self, grid: &Grid, densities: &mut [f32]) -> Result<()> {
        clear(grid, densities, 0.0)?;
        let mut sink = Each {
            pixels: densities,
            stride: grid.stride(),
            put: |pixel: &mut f32, density| *pixel = density,
        };
        self.scan_convert(grid, None, &mut sink);
        Ok(())
    }

    pub(crate) fn scan_convert(&self, grid: &Grid, hidden: Option<&Hidden>, sink: &mut dyn Sink) {
        let mut put = |column: u32, row: u32, density: f32| {
            if hidden.is_none_or(|hidden| !hidden.hides(column, row)) {
                sink.values(row..row + 1, column..column + 1, &[density]);
            }
        };
        for triangle in self.triangles() {
            draw(triangle, grid, &mut put);
        }
    }
}

fn draw(triangle: [MeshVertex; 3], grid: &Grid, put: &mut impl FnMut(u32, u32, f32)) {
    let corners = triangle.map(|vertex| {
        let position = DVec2::new(f64::from(vertex.position[0]), f64::from(vertex.position[1]));
        Corner {
            at: position * grid.pixels_per_unit() - grid.corner(),
            value: f64::from(vertex.density),
        }
    });
    let (columns, rows) = (0..i64::from(grid.width()), 0..i64::from(grid.height()));
    scan_convert(corners, &columns, &rows, |run| {
        let mut density = run.first;
        for column in run.columns {
            // Steps add up to some 1e-16 beyond either end.
            put(
                column as u32,
                run.row as u32,
                density.clamp(0.0, 1.0) as f32,
            );
            density += run.step;
        }
    });
}

#[cfg(test)]
mod tests {
    use core::ops::Range;

    use super::*;

    /// Counts how often each pixel is given.
    struct Count {
        width: u32,
        hits: Vec<u32>,
        densities: Vec<f32>,
    }

    impl Sink for Count {
        fn constant(&mut self, rows: Range<u32>, columns: Range<u32>, density: f32) {
            for x in columns {
                self.values(rows.clone(), x..x + 1, &[density]);
            }
        }

        fn values(&mut self, rows: Range<u32>, columns: Range<u32>, densities: &[f32]) {
            for y in rows {
                for (x, density) in columns.clone().zip(densities) {
                    let index = (y * self.width + x) as usize;
                    self.hits[index] += 1;
                    self.densities[index] = *density;
                }
            }
        }
    }

    #[test]
    fn a_fan_covers_every_pixel_once_and_a_plane_comes_out_flat() {
        // Vertices on pixel centres and corners, where the rule matters; density is a plane.
        let plane = |x: f32, y: f32| 0.1 + 0.02 * x + 0.01 * y;
        let vertex = |x: f32, y: f32| MeshVertex {
            position: [x, y],
            density: plane(x, y),
        };
        let rim = [
            vertex(0.0, 0.0),
            vertex(7.5, 0.0),
            vertex(16.0, 0.0),
            vertex(16.0, 10.5),
            vertex(16.0, 16.0),
            vertex(3.25, 16.0),
            vertex(0.0, 16.0),
            vertex(0.0, 8.5),
        ];
        let mut vertices = vec![vertex(8.5, 8.5)];
        vertices.extend(rim);
        let indices = (1..=8).flat_map(|i| [0, i, i % 8 + 1]).collect();
        let mesh = ShadowMesh {
            vertices,
            indices,
            ..ShadowMesh::empty()
        };
        let grid = Grid::new([0.0, 0.0], [16, 16], 1.0).unwrap();
        let mut count = Count {
            width: 16,
            hits: vec![0; 256],
            densities: vec![0.0; 256],
        };
        mesh.scan_convert(&grid, None, &mut count);
        assert!(count.hits.iter().all(|&hits| hits == 1), "{:?}", count.hits);
        for (index, density) in count.densities.iter().enumerate() {
            let (x, y) = ((index % 16) as f32 + 0.5, (index / 16) as f32 + 0.5);
            assert!((density - plane(x, y)).abs() < 1e-6);
        }
    }
}
