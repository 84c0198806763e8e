//! The parts of a shadow that do not meet, each drawn by what suits it best.

use core::ops::Range;

use glam::DVec2;

use super::Shadow;
use crate::apart::{around, overlapping};
use crate::density::rounded::Rounded;
use crate::grid::Grid;
use crate::outline::{self, Edge};
use crate::shape::Shape;

/// Which loops several shapes make together, and the boxes of these shapes.
#[derive(Debug, Clone)]
pub(super) struct United {
    pub(super) loops: Range<usize>,
    pub(super) boxes: Vec<(DVec2, DVec2)>,
}

/// What parts of a shadow are made of.
enum Piece {
    Loops(Vec<Vec<Edge>>),
    Shapes(Vec<Shape>),
}

impl Shadow {
    /// Loops whose shadows are apart are drawn by what suits each best.
    pub(super) fn find_parts(&mut self) {
        self.parts.clear();
        self.measure();
        // No pixel is to see two parts: their densities would be rounded twice. A narrow penumbra is averaged over pixels.
        let reach = if self.radius < 3.0 {
            self.radius + 1.0
        } else {
            self.radius
        };
        // What several shapes are together is apart from what all of them are apart from, so that what is far away does not decide
        // how a shape is drawn: a box about all of them would.
        let mut pieces: Vec<Piece> = Vec::new();
        let mut boxed: Vec<(DVec2, DVec2, usize)> = Vec::new();
        let mut add = |boxes: &[(DVec2, DVec2)], piece: Piece| {
            let number = pieces.len();
            boxed.extend(
                boxes
                    .iter()
                    .map(|(min, max)| (*min - reach, *max + reach, number)),
            );
            pieces.push(piece);
        };
        let mut next = 0;
        for United { loops, boxes } in &self.united {
            self.add_loops(next..loops.start, &mut add);
            add(
                boxes,
                Piece::Loops(self.fixed.loops[loops.clone()].to_vec()),
            );
            next = loops.end;
        }
        self.add_loops(next..self.fixed.loops.len(), &mut add);
        for shapes in &self.curved {
            let boxes: Vec<_> = shapes.iter().filter_map(Shape::hull).collect();
            add(&boxes, Piece::Shapes(shapes.clone()));
        }
        let groups = overlapping(boxed);
        if groups.len() < 2 {
            return;
        }
        let mut pieces: Vec<Option<Piece>> = pieces.into_iter().map(Some).collect();
        self.parts = groups
            .into_iter()
            .map(|mut group| {
                let mut part = Self {
                    radius: self.radius,
                    ..Self::default()
                };
                group.sort_unstable();
                for piece in group {
                    // A piece of several boxes is there as many times.
                    match pieces[piece].take() {
                        Some(Piece::Loops(loops)) => part.fixed.loops.extend(loops),
                        Some(Piece::Shapes(shapes)) => part.curved.push(shapes),
                        None => {}
                    }
                }
                part.measure();
                part
            })
            .collect();
    }

    /// Adds loops one by one, with their boxes.
    fn add_loops(&self, loops: Range<usize>, mut add: impl FnMut(&[(DVec2, DVec2)], Piece)) {
        for edges in &self.fixed.loops[loops] {
            if let Some(bounds) = outline::bounds(edges.iter()) {
                add(&[bounds], Piece::Loops(vec![edges.clone()]));
            }
        }
    }

    /// Finds what is asked for again and again.
    fn measure(&mut self) {
        let curved = self.curved.iter().flatten().filter_map(Shape::hull);
        let hulls = self.fixed.bounds().into_iter().chain(curved);
        self.hull = around(hulls);
        self.rounded = if self.curved.is_empty() {
            Rounded::of(&self.fixed)
        } else {
            None
        };
    }

    /// Its parts that do not meet, or none where it is one.
    pub(crate) fn apart(&self) -> &[Self] {
        &self.parts
    }

    /// The shadows that this one is drawn as on pixels of which there are so many a scene unit.
    pub(crate) fn parts(&self, per_unit: f64) -> &[Self] {
        if self.parts.is_empty() || per_unit < 1.0 {
            core::slice::from_ref(self)
        } else {
            &self.parts
        }
    }

    /// Those of [`Self::parts`] that a grid may show, or one that is larger by a `margin` of so many pixels.
    pub(crate) fn parts_on(&self, grid: &Grid, margin: f64) -> impl Iterator<Item = &Self> {
        let per_unit = grid.pixels_per_unit();
        let is_shown = move |part: &&Self| {
            let reach = part.reach(per_unit);
            reach.is_some_and(|(min, max)| grid.meets((min - margin, max + margin)))
        };
        self.parts(per_unit).iter().filter(is_shown)
    }
}
