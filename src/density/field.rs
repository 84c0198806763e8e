//! Densities at many points of one shadow.

use std::collections::HashMap;

use glam::DVec2;

use super::{area, lines, tilted};
use crate::outline::{Edge, Outline, clip_to_box};
use crate::tilted::Circle;

/// The density at points in any order.
pub(crate) struct Field {
    /// The penumbra radius, or the least that counts.
    radius: f64,
    source: Source,
}

enum Source {
    Level(Cells),
    Tilted(Vec<Vec<Circle>>),
}

/// The plane is cut into square cells, and the first point in a cell leaves it with the edges that a disc about any of its
/// points can meet.
struct Cells {
    edges: Vec<Edge>,
    side: f64,
    cells: HashMap<[i64; 2], Vec<Edge>>,
    spare: Vec<Edge>,
}

impl Field {
    pub(crate) fn new(outline: &Outline, radius: f64) -> Self {
        // Cells much smaller than the disc would all hold the same edges, much larger ones too many.
        const CELLS: f64 = 64.0;
        let extent = outline
            .bounds()
            .map_or(0.0, |(min, max)| (max - min).max_element());
        Self {
            radius,
            source: Source::Level(Cells {
                edges: outline.edges().copied().collect(),
                side: radius.max(extent / CELLS),
                cells: HashMap::new(),
                spare: Vec::new(),
            }),
        }
    }

    /// Of a caster of many radii; the smallest ones that count are `radius`.
    pub(crate) fn of_tilted(loops: Vec<Vec<Circle>>, radius: f64) -> Self {
        Self {
            radius,
            source: Source::Tilted(loops),
        }
    }

    /// The penumbra radius, in the outline's unit.
    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }

    pub(crate) fn at(&mut self, point: DVec2) -> f64 {
        match &mut self.source {
            Source::Level(cells) => cells.at(point, self.radius),
            Source::Tilted(loops) => tilted::at_point(loops, point),
        }
    }
}

impl Cells {
    fn at(&mut self, point: DVec2, radius: f64) -> f64 {
        // Clipping costs about as much as it saves where there are few edges.
        const FEW: usize = 12;
        if self.edges.len() <= FEW || self.side == 0.0 {
            return at_point(&self.edges, point, radius);
        }
        let index = (point / self.side).floor();
        let key = [index.x as i64, index.y as i64];
        let cell = self.cells.entry(key).or_insert_with(|| {
            let min = index * self.side - radius;
            let max = min + self.side + 2.0 * radius;
            let mut clipped = Vec::new();
            clip_to_box(&self.edges, min, max, &mut self.spare, &mut clipped);
            clipped
        });
        at_point(cell, point, radius)
    }
}

/// To 0.001 level: lines by a polynomial, arcs in closed form.
fn at_point(edges: &[Edge], point: DVec2, radius: f64) -> f64 {
    let fast = if radius > 0.0 {
        lines::at_point(edges, point, radius)
    } else {
        None
    };
    fast.unwrap_or_else(|| area::at_point(edges.iter(), point, radius))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::FillRule;
    use crate::shape::Shape;

    #[test]
    fn cells_change_nothing() {
        let ring: Vec<[f32; 2]> = (0_u8..60)
            .map(|i| {
                let angle = f32::from(i) * core::f32::consts::TAU / 60.0;
                let radius = if i % 2 == 0 { 50.0 } else { 30.0 };
                [radius * angle.cos(), radius * angle.sin()]
            })
            .collect();
        let outline =
            Outline::of_simple(&Shape::polygon(&[ring], FillRule::NonZero).unwrap()).unwrap();
        let mut field = Field::new(&outline, 3.0);
        for i in 0..40 {
            for j in 0..40 {
                let point = DVec2::new(f64::from(i), f64::from(j)) * 2.7 - 54.0;
                let direct = area::at_point(outline.edges(), point, 3.0);
                assert!((field.at(point) - direct).abs() < 1e-7, "{point}");
            }
        }
    }
}
