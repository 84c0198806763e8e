//! An outline as a grid's pixels see it: polygons in pixels from the grid's first corner on.

use glam::DVec2;

use crate::error::Result;
use crate::grid::Grid;
use crate::outline::{Edge, Line, clip_to_box, sides, winding};
use crate::shadow::Shadow;

/// Oriented polygons that do not cross, in pixels, and the penumbra radius.
pub(super) struct View {
    pub(super) polygons: Vec<Vec<DVec2>>,
    pub(super) radius: f64,
}

/// The side of a tile of pixels that share the edges within their reach.
const TILE: u32 = 16;

impl View {
    /// The shadow's outline with curves cut so finely that no density moves by more than `levels`.
    pub(super) fn new(shadow: &Shadow, grid: &Grid, levels: f64) -> Self {
        let scale = grid.pixels_per_unit();
        let place = |p: DVec2| p * scale - grid.corner();
        let polygons = shadow.polygons_within(levels, 1.0 / scale);
        Self {
            polygons: polygons
                .into_iter()
                .map(|points| points.into_iter().map(place).collect())
                .collect(),
            radius: shadow.radius() * scale,
        }
    }

    pub(super) fn lines(&self) -> impl Iterator<Item = (DVec2, DVec2)> {
        self.polygons.iter().flat_map(|points| sides(points))
    }

    /// Calls `tile` for the pixels from `first` to before `end`, with the polygons' lines cut to the box that is within
    /// `reach` of them, or with none where the box is wholly inside or outside.
    fn tiles(
        &self,
        grid: &Grid,
        reach: f64,
        mut tile: impl FnMut([u32; 2], [u32; 2], &[(DVec2, DVec2)], bool),
    ) {
        let edges: Vec<Edge> = self
            .lines()
            .map(|(from, to)| Edge::Line(Line { from, to }))
            .collect();
        let (mut spare, mut row, mut cut, mut lines) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for top in (0..grid.height()).step_by(TILE as usize) {
            let bottom = (top + TILE).min(grid.height());
            let min = DVec2::new(-reach, f64::from(top) - reach);
            let max = DVec2::new(f64::from(grid.width()) + reach, f64::from(bottom) + reach);
            row.clear();
            clip_to_box(&edges, min, max, &mut spare, &mut row);
            for left in (0..grid.width()).step_by(TILE as usize) {
                let right = (left + TILE).min(grid.width());
                let min = DVec2::new(f64::from(left) - reach, min.y);
                let max = DVec2::new(f64::from(right) + reach, max.y);
                cut.clear();
                let met = clip_to_box(&row, min, max, &mut spare, &mut cut);
                lines.clear();
                lines.extend(cut.iter().map(|edge| (edge.from(), edge.to())));
                tile([left, top], [right, bottom], &lines, met);
            }
        }
    }

    /// Writes the density of each pixel: 1 and 0 where no edge is within `reach` of it, else what `pixel` gives for its
    /// centre, its place in the picture and the edges that may be within reach.
    pub(super) fn draw(
        &self,
        grid: &Grid,
        reach: f64,
        densities: &mut [f32],
        mut pixel: impl FnMut(DVec2, u64, &[(DVec2, DVec2)]) -> f64,
    ) -> Result<()> {
        grid.check_buffer(densities.len())?;
        self.tiles(grid, reach, |first, end, lines, met| {
            let middle = DVec2::new(f64::from(first[0]) + 0.5, f64::from(first[1]) + 0.5);
            let plain = (!met).then(|| f32::from(u8::from(holds(lines, middle))));
            for y in first[1]..end[1] {
                for x in first[0]..end[0] {
                    let place = y as usize * grid.stride() + x as usize;
                    densities[place] = plain.unwrap_or_else(|| {
                        let center = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                        pixel(center, place as u64, lines) as f32
                    });
                }
            }
        });
        Ok(())
    }
}

/// Whether oriented lines wind round a point.
pub(super) fn holds(lines: &[(DVec2, DVec2)], point: DVec2) -> bool {
    winding(lines.iter().copied(), point) != 0
}
