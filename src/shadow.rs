//! Shadow: the door between geometry and numbers.
//!
//! Before it all is about planes and shapes, after it all is about loops of projection circles. Circles of one radius,
//! as every caster parallel to its receiver has them, are kept as an outline and that radius.

use core::borrow::Borrow;
use std::borrow::Cow;
use std::sync::OnceLock;

use glam::DVec2;

use crate::density::{self, DensitySink};
use crate::error::Result;
use crate::grid::Grid;
use crate::light::Projection;
use crate::outline::{Outline, Winding, resolve};
use crate::scratch::Scratch;
use crate::shape::Shape;

/// The shadow of one or more shapes of one elevation on one receiver: everything that a mesh, a picture or a point
/// query is made from.
#[derive(Debug, Clone, Default)]
pub struct Shadow {
    radius: f64,
    /// The loops of the shapes made of lines and circular arcs.
    fixed: Outline,
    /// The shapes that need flattening, projected; those that may overlap together.
    curved: Vec<Vec<Shape>>,
    /// The outline as exact as `density_at` promises, made when it is first needed.
    exact: OnceLock<Outline>,
}

/// A box from its least to its largest x and y, in scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The least x and y.
    pub min: [f32; 2],
    /// The largest x and y.
    pub max: [f32; 2],
}

impl Bounds {
    /// The smallest box of `f32` that holds both points.
    pub(crate) fn outwards(min: DVec2, max: DVec2) -> Self {
        let down = |v: f64| {
            let near = v as f32;
            if f64::from(near) > v {
                near.next_down()
            } else {
                near
            }
        };
        let up = |v: f64| {
            let near = v as f32;
            if f64::from(near) < v {
                near.next_up()
            } else {
                near
            }
        };
        Self {
            min: [down(min.x), down(min.y)],
            max: [up(max.x), up(max.y)],
        }
    }
}

impl Shadow {
    /// The shadow that is nowhere.
    pub(crate) fn empty() -> Self {
        Self::default()
    }

    pub(crate) fn project<S: Borrow<Shape>>(shapes: &[S], projection: &Projection) -> Self {
        let affine = projection.affine();
        let mut shadow = Self {
            radius: projection.radius,
            ..Self::default()
        };
        for group in overlapping(
            shapes
                .iter()
                .map(|shape| shape.borrow().mapped(&affine))
                .collect(),
        ) {
            let outlines: Option<Vec<Outline>> = group.iter().map(Outline::of_simple).collect();
            match outlines {
                Some(mut outlines) if outlines.len() == 1 => {
                    shadow.fixed.append(outlines.remove(0));
                }
                // Of arcs a union makes lines, as fine as the use asks for.
                Some(outlines) if group.iter().all(Shape::is_straight) => {
                    shadow.fixed.append(unite(&outlines, 1.0));
                }
                _ => shadow.curved.push(group),
            }
        }
        shadow
    }

    /// The same outline seen through another penumbra radius.
    pub(crate) fn with_radius(&self, radius: f64) -> Self {
        Self {
            radius,
            fixed: self.fixed.clone(),
            curved: self.curved.clone(),
            exact: OnceLock::new(),
        }
    }

    /// The larger side of a box that holds the outline, in scene units.
    pub(crate) fn extent(&self) -> f64 {
        let curved = self.curved.iter().flatten().filter_map(Shape::hull);
        let hulls = self.fixed.bounds().into_iter().chain(curved);
        hulls
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
            .map_or(0.0, |(min, max)| (max - min).max_element())
    }

    /// The penumbra radius r, in scene units: how far from the outline the penumbra reaches, both ways.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Whether there is no shadow at all: the caster touches its receiver or covers no area.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.exact_outline().is_empty()
    }

    /// The outline with curves cut into lines within `flatness` (scene units) of them.
    pub(crate) fn outline(&self, flatness: f64) -> Cow<'_, Outline> {
        if self.curved.is_empty() {
            return Cow::Borrowed(&self.fixed);
        }
        let mut outline = self.fixed.clone();
        for group in &self.curved {
            let extent = group
                .iter()
                .filter_map(Shape::hull)
                .map(|(min, max)| (max - min).max_element())
                .fold(0.0, f64::max);
            // For a nearly hard shadow the rule would ask for chords without end.
            let flatness = flatness.max(extent * FINEST);
            let outlines: Vec<Outline> = group
                .iter()
                .map(|shape| Outline::of_flattened(shape, flatness))
                .collect();
            outline.append(unite(&outlines, flatness));
        }
        Cow::Owned(outline)
    }

    /// The outline for questions that no pixel is in the way of.
    pub(crate) fn exact_outline(&self) -> &Outline {
        if self.curved.is_empty() {
            return &self.fixed;
        }
        self.exact.get_or_init(|| {
            self.outline(density::flatness(density::EXACT_SHARE, self.radius, 0.0))
                .into_owned()
        })
    }

    /// The smallest box outside of which the density is 0, or none for an empty shadow. No density is computed for it.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        let (min, max) = self.exact_outline().bounds()?;
        Some(Bounds::outwards(
            min - DVec2::splat(self.radius),
            max + DVec2::splat(self.radius),
        ))
    }

    /// The density at a point (x, y) of the receiver, in closed form: the fraction of the light's disc that the caster
    /// hides from it, from 0 to 1. Lines and circular arcs are exact to 1e-9; other curves within 0.02 level.
    ///
    /// A point that is not finite is nowhere in the shadow: its density is 0.
    #[must_use]
    pub fn density_at(&self, point: [f32; 2]) -> f64 {
        let point = DVec2::new(f64::from(point[0]), f64::from(point[1]));
        if !point.is_finite() {
            return 0.0;
        }
        density::at_point(self.exact_outline().edges(), point, self.radius)
    }

    /// Writes the densities on a grid of pixels as 8-bit coverage, 255 where the light's disc is wholly hidden and 0
    /// outside of the shadow: every pixel of the grid is written, nothing else of the buffer is.
    ///
    /// # Errors
    /// [`Error::BufferSize`](crate::Error::BufferSize) when `mask` is shorter than the grid needs.
    pub fn fill_a8(&self, grid: &Grid, mask: &mut [u8], scratch: &mut Scratch) -> Result<()> {
        grid.check_buffer(mask.len())?;
        for row in 0..grid.height() {
            let start = row as usize * grid.stride();
            mask[start..start + grid.width() as usize].fill(0);
        }
        let mut sink = MaskSink {
            mask,
            stride: grid.stride(),
        };
        density::exact::fill(self, grid, scratch, &mut sink);
        Ok(())
    }
}

/// The finest flattening over a shape's extent, 2^-30: some 30,000 chords a curve.
const FINEST: f64 = 1.0 / 1_073_741_824.0;

struct MaskSink<'a> {
    mask: &'a mut [u8],
    stride: usize,
}

impl DensitySink for MaskSink<'_> {
    fn put(&mut self, x: u32, y: u32, density: f32) {
        self.mask[y as usize * self.stride + x as usize] = (density * 255.0 + 0.5) as u8;
    }
}

impl Shape {
    fn is_straight(&self) -> bool {
        self.contours.iter().all(crate::path::Contour::is_straight)
    }
}

/// The outline of what outlines cover together.
fn unite(outlines: &[Outline], flatness: f64) -> Outline {
    match outlines {
        [only] => only.clone(),
        several => {
            let polygons: Vec<Vec<DVec2>> = several
                .iter()
                .flat_map(|outline| outline.polygons(flatness))
                .collect();
            resolve(&polygons, Winding::Rule(crate::path::FillRule::NonZero))
        }
    }
}

/// Sorts shapes into groups, each apart from all others: a group's hulls overlap or touch in a chain.
fn overlapping(shapes: Vec<Shape>) -> Vec<Vec<Shape>> {
    let mut open: Vec<(DVec2, DVec2, Vec<Shape>)> = Vec::new();
    let mut hulled: Vec<(DVec2, DVec2, Shape)> = shapes
        .into_iter()
        .filter_map(|shape| shape.hull().map(|(min, max)| (min, max, shape)))
        .collect();
    hulled.sort_by(|a, b| {
        let key = |s: &(DVec2, DVec2, Shape)| (s.0.x, s.0.y);
        key(a)
            .partial_cmp(&key(b))
            .unwrap_or(core::cmp::Ordering::Equal)
    });
    let mut groups = Vec::new();
    for (min, max, shape) in hulled {
        let (mut min, mut max, mut group) = (min, max, vec![shape]);
        let mut index = 0;
        while index < open.len() {
            if open[index].1.x < min.x {
                groups.push(open.swap_remove(index).2);
            } else if open[index].0.y <= max.y && open[index].1.y >= min.y {
                let (other_min, other_max, members) = open.swap_remove(index);
                // The grown box may meet groups that were passed over.
                (min, max, index) = (min.min(other_min), max.max(other_max), 0);
                group.splice(0..0, members);
            } else {
                index += 1;
            }
        }
        open.push((min, max, group));
    }
    groups.extend(open.into_iter().map(|(_, _, group)| group));
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use crate::path::FillRule;

    #[test]
    fn abutting_rectangles_are_one_outline() {
        let light = Light::directional([0.0, 1.0], 1.0).unwrap();
        let left = Shape::rect(0.0, 0.0, 10.0, 10.0).unwrap();
        let right = Shape::rect(10.0, 0.0, 10.0, 10.0).unwrap();
        let joined = Shape::rect(0.0, 0.0, 20.0, 10.0).unwrap();
        let two = light.cast_all(&[&left, &right], 4.0, 0.0).unwrap();
        let one = light.cast(&joined, 4.0, 0.0).unwrap();
        assert_eq!(two.exact_outline(), one.exact_outline());
        assert_eq!(two.density_at([10.0, 9.0]), one.density_at([10.0, 9.0]));
    }

    #[test]
    fn shapes_apart_keep_their_arcs() {
        let light = Light::directional([0.0, 1.0], 1.0).unwrap();
        let cards: Vec<Shape> = (0_u8..9)
            .map(|i| {
                Shape::rounded_rect(
                    f32::from(i % 3) * 30.0,
                    f32::from(i / 3) * 30.0,
                    20.0,
                    20.0,
                    4.0,
                )
                .unwrap()
            })
            .collect();
        let shadow = light
            .cast_all(&cards.iter().collect::<Vec<_>>(), 4.0, 0.0)
            .unwrap();
        assert_eq!(shadow.exact_outline().loops.len(), 9);
        assert_eq!(shadow.exact_outline().edges().count(), 72);
    }

    #[test]
    fn overlapping_curves_count_once() {
        let light = Light::directional([0.0, 1.0], 1.0).unwrap();
        let a = Shape::circle([0.0, 0.0], 5.0).unwrap();
        let b = Shape::circle([1.0, 0.0], 2.0).unwrap();
        let shadow = light.cast_all(&[&a, &b], 0.1, 0.0).unwrap();
        let alone = light.cast(&a, 0.1, 0.0).unwrap();
        assert!((shadow.exact_outline().area() - alone.exact_outline().area()).abs() < 1e-3);
        assert!((shadow.density_at([1.0, 0.0]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn bounds_hold_the_penumbra_and_no_more() {
        let light = Light::new([0.0, 0.0, 100.0], 10.0).unwrap();
        let shadow = light
            .cast(&Shape::rect(-10.0, -20.0, 20.0, 40.0).unwrap(), 50.0, 0.0)
            .unwrap();
        assert_eq!(
            shadow.bounds(),
            Some(Bounds {
                min: [-30.0, -50.0],
                max: [30.0, 50.0]
            })
        );
        assert!(
            light
                .cast(&Shape::rect(0.0, 0.0, 1.0, 1.0).unwrap(), 5.0, 5.0)
                .unwrap()
                .bounds()
                .is_none()
        );
    }

    #[test]
    fn a_polygon_that_cancels_itself_casts_nothing() {
        let light = Light::flutter();
        let ring = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let twice = Shape::polygon(&[ring, ring], FillRule::EvenOdd).unwrap();
        let shadow = light.cast(&twice, 2.0, 0.0).unwrap();
        assert!(shadow.is_empty());
        assert_eq!(shadow.density_at([2.0, 4.0]), 0.0);
    }
}
