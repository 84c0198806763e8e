//! Shadow: the door between geometry and numbers.
//!
//! Before it all is about planes and shapes, after it all is about loops of projection circles. Circles of one radius,
//! as every caster parallel to its receiver has them, are kept as an outline and that radius.

mod census;
mod crowding;
mod drawn;
mod parts;

use core::borrow::Borrow;
use std::sync::OnceLock;

use glam::{DAffine2, DVec2};

use self::parts::United;
use crate::apart::overlapping;
use crate::density::rounded::Rounded;
use crate::density::{self, PixelOptions};
use crate::error::Result;
use crate::grid::Grid;
use crate::light::Projection;
use crate::outline::{Outline, Winding, resolve};
use crate::paint::Paint;
use crate::plan;
use crate::scratch::Scratch;
use crate::shape::Shape;

/// The shadow of one or more shapes of one elevation on one receiver: everything that a mesh, a picture or a point
/// query is made from.
#[derive(Debug, Clone, Default)]
pub struct Shadow {
    radius: f64,
    /// The loops of the shapes made of lines and circular arcs.
    fixed: Outline,
    /// Those that several shapes make together.
    united: Vec<United>,
    /// The shapes that need flattening, projected; those that may overlap together.
    curved: Vec<Vec<Shape>>,
    /// A box that holds its outline.
    hull: Option<(DVec2, DVec2)>,
    /// The outline as exact as `density_at` promises, made when it is first needed.
    exact: OnceLock<Outline>,
    /// The outline for pixels as it was first asked for: how near to curves its lines are, and for discs or pixels of which radius.
    drawn: OnceLock<([f64; 2], Outline)>,
    /// The outline as a rounded rectangle, if it is one.
    rounded: Option<Rounded>,
    /// Shadows of one radius that are this one together and do not meet; none if it is a single one.
    parts: Vec<Shadow>,
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
        let boxed = shapes.iter().filter_map(|shape| {
            let shape = shape.borrow().mapped(&affine);
            shape.hull().map(|(min, max)| (min, max, shape))
        });
        for group in overlapping(boxed.collect()) {
            let outlines: Option<Vec<Outline>> = group.iter().map(Outline::of_simple).collect();
            match outlines {
                Some(mut outlines) if outlines.len() == 1 => {
                    shadow.fixed.append(outlines.remove(0));
                }
                // Of arcs a union makes lines, as fine as the use asks for.
                Some(outlines) if group.iter().all(Shape::is_straight) => {
                    let first = shadow.fixed.loops.len();
                    shadow.fixed.append(unite(&outlines, 1.0));
                    shadow.united.push(United {
                        loops: first..shadow.fixed.loops.len(),
                        boxes: group.iter().filter_map(Shape::hull).collect(),
                    });
                }
                _ => shadow.curved.push(group),
            }
        }
        shadow.find_parts();
        shadow
    }

    /// The hard shadow of an outline on its own plane.
    pub(crate) fn of_outline(fixed: Outline) -> Self {
        let mut shadow = Self {
            fixed,
            ..Self::default()
        };
        shadow.find_parts();
        shadow
    }

    /// The same outline seen through another penumbra radius.
    pub(crate) fn with_radius(&self, radius: f64) -> Self {
        let mut shadow = Self {
            radius,
            fixed: self.fixed.clone(),
            united: self.united.clone(),
            curved: self.curved.clone(),
            ..Self::default()
        };
        shadow.find_parts();
        shadow
    }

    /// The same shadow moved by `offset`.
    pub(crate) fn moved(&self, offset: DVec2) -> Self {
        let affine = DAffine2::from_translation(offset);
        let moved = |group: &Vec<Shape>| group.iter().map(|shape| shape.mapped(&affine)).collect();
        let united = |United { loops, boxes }: &United| {
            let boxes = boxes
                .iter()
                .map(|(min, max)| (*min + offset, *max + offset));
            United {
                loops: loops.clone(),
                boxes: boxes.collect(),
            }
        };
        let mut shadow = Self {
            radius: self.radius,
            fixed: self.fixed.moved(offset),
            united: self.united.iter().map(united).collect(),
            curved: self.curved.iter().map(moved).collect(),
            ..Self::default()
        };
        shadow.find_parts();
        shadow
    }

    /// The loops of the shapes made of lines and circular arcs.
    pub(crate) fn fixed(&self) -> &Outline {
        &self.fixed
    }

    /// The shapes that need flattening, those that may overlap together.
    pub(crate) fn curved(&self) -> &[Vec<Shape>] {
        &self.curved
    }

    /// The larger side of a box that holds the outline, in scene units.
    pub(crate) fn extent(&self) -> f64 {
        self.hull()
            .map_or(0.0, |(min, max)| (max - min).max_element())
    }

    /// A box that holds the outline, in scene units.
    pub(crate) fn hull(&self) -> Option<(DVec2, DVec2)> {
        self.hull
    }

    /// The box of the pixels that see it, in pixels of which there are so many a scene unit.
    pub(crate) fn reach(&self, per_unit: f64) -> Option<(DVec2, DVec2)> {
        let hull = self.hull?;
        Some(density::reached(hull, self.radius, per_unit))
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

    /// Whether the outline is exact: no curve of it is cut into lines.
    pub(crate) fn is_fixed(&self) -> bool {
        self.curved.is_empty()
    }

    /// The outline as a rounded rectangle, if it is one.
    pub(crate) fn rounded(&self) -> Option<Rounded> {
        self.rounded
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
    /// outside of the shadow: every pixel of the grid is written, nothing else of the buffer is. Within the tolerance, and
    /// half a level for the rounding. Hidden pixels are 0.
    ///
    /// # Errors
    /// [`Error::BufferSize`](crate::Error::BufferSize) when `mask` is shorter than the grid needs, and options for another grid.
    pub fn fill_a8(
        &self,
        grid: &Grid,
        mask: &mut [u8],
        options: &PixelOptions<'_>,
        scratch: &mut Scratch,
    ) -> Result<()> {
        let mut sink = options.onto_mask(grid, mask, scratch.level())?;
        if plan::skip(self, grid, options, Some(1.0))?.is_none() {
            density::draw(self, grid, options, scratch, &mut sink);
        }
        Ok(())
    }

    /// Writes the densities on a grid of pixels, from 0 to 1: every pixel of the grid is written, nothing else of the buffer
    /// is. Hidden pixels are 0.
    ///
    /// # Errors
    /// [`Error::BufferSize`](crate::Error::BufferSize) when `densities` is shorter than the grid needs, and options for
    /// another grid.
    pub fn fill_f32(
        &self,
        grid: &Grid,
        densities: &mut [f32],
        options: &PixelOptions<'_>,
        scratch: &mut Scratch,
    ) -> Result<()> {
        let mut sink = options.onto_densities(grid, densities)?;
        if plan::skip(self, grid, options, None)?.is_none() {
            density::draw(self, grid, options, scratch, &mut sink);
        }
        Ok(())
    }

    /// Blends the shadow onto premultiplied RGBA8 pixels, source over, in one pass: no mask is made. The grid's stride
    /// counts pixels, 4 bytes each; pixels outside of the shadow, hidden ones and the rest of the buffer stay as they are.
    ///
    /// # Errors
    /// [`Error::BufferSize`](crate::Error::BufferSize) when `pixels` is shorter than the grid needs, and options for another
    /// grid.
    pub fn blend_rgba8(
        &self,
        grid: &Grid,
        pixels: &mut [u8],
        paint: &Paint,
        options: &PixelOptions<'_>,
        scratch: &mut Scratch,
    ) -> Result<()> {
        let mut sink = options.onto_rgba8(grid, pixels, paint, scratch)?;
        if plan::skip(self, grid, options, Some(paint.opacity()))?.is_none() {
            density::draw(self, grid, options, scratch, &mut sink);
        }
        Ok(())
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
