//! Shapes cut to other shapes.

use glam::DVec2;

use super::Shape;
use crate::density::rounded::Rounded;
use crate::error::{MAX_SEGMENTS, Result};
use crate::limits::at_most;
use crate::outline::{Outline, intersect_loops};
use crate::path::lines;

/// How far from a curve of a cut shape its lines may be, in scene units, and over the larger side of the smaller shape's box.
const FLATNESS: f64 = 2e-4;
const RELATIVE_FLATNESS: f64 = 1e-6;

/// The finest, over the larger side of the larger one's.
const FINEST: f64 = 1e-10;

impl Shape {
    /// The part of the shape inside another one, or none. Where something is cut away, curves are right within 0.0002
    /// scene units and a millionth of the smaller one's extent, but no finer than 10^-10 of the larger one's.
    ///
    /// # Errors
    /// More than [`MAX_SEGMENTS`](crate::MAX_SEGMENTS) lines.
    ///
    /// ```
    /// use penumbral::Shape;
    ///
    /// let list = Shape::rect(0.0, 56.0, 360.0, 584.0)?;
    /// let card = Shape::rect(16.0, 20.0, 328.0, 80.0)?;
    /// assert_eq!(card.clipped(&list)?, Some(Shape::rect(16.0, 56.0, 328.0, 44.0)?));
    /// # Ok::<(), penumbral::Error>(())
    /// ```
    pub fn clipped(&self, by: &Self) -> Result<Option<Self>> {
        let (Some((min, max)), Some((clip_min, clip_max))) = (self.hull(), by.hull()) else {
            return Ok(None);
        };
        let (low, high) = (min.max(clip_min), max.min(clip_max));
        if low.cmpge(high).any() {
            return Ok(None);
        }
        if by.is_box() {
            if (low, high) == (min, max) {
                return Ok(Some(self.clone()));
            }
            if self.is_box() {
                return Ok(Some(Self::of_box(low, high - low, [0.0; 4])));
            }
        }
        let extent = |min: DVec2, max: DVec2| (max - min).max_element();
        let extents = [extent(min, max), extent(clip_min, clip_max)];
        let [smaller, larger] = [extents[0].min(extents[1]), extents[0].max(extents[1])];
        let flatness = FLATNESS
            .min(RELATIVE_FLATNESS * smaller)
            .max(FINEST * larger);
        // Half of it is left to the curves in place of lines.
        let within = flatness / 2.0;
        let count = |shape: &Self| lines(&shape.contours, within);
        at_most(
            "lines of a clip",
            count(self).saturating_add(count(by)),
            MAX_SEGMENTS,
        )?;
        let of = |shape: &Self| Outline::of_flattened(shape, within).polygons(within);
        let is_straight = self.is_straight() && by.is_straight();
        let loops = intersect_loops(&of(self), &of(by));
        Self::of_loops(&loops, (!is_straight).then_some(within))
    }

    /// Whether it is a rectangle along the axes.
    fn is_box(&self) -> bool {
        Outline::of_simple(self)
            .and_then(|outline| Rounded::of(&outline))
            .is_some_and(|rounded| rounded.is_sharp())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use crate::path::{FillRule, Path};

    fn area(shape: &Shape) -> f64 {
        Outline::of_flattened(shape, 1e-4).area()
    }

    #[test]
    fn areas_of_cut_shapes_are_those_expected() {
        let list = Shape::rect(0.0, 0.0, 100.0, 50.0).unwrap();
        let circle = Shape::circle([50.0, 50.0], 20.0).unwrap();
        let half = circle.clipped(&list).unwrap().unwrap();
        assert!((area(&half) - 200.0 * core::f64::consts::PI).abs() < 0.02);
        // What is inside keeps its curves; what is outside is nothing.
        let inside = Shape::circle([50.0, 25.0], 20.0).unwrap();
        assert_eq!(inside.clipped(&list).unwrap(), Some(inside));
        let outside = Shape::circle([50.0, 75.0], 20.0).unwrap();
        assert_eq!(outside.clipped(&list).unwrap(), None);
        // A rectangle in a rounded clip loses its corners: (4 - π) r² of four.
        let rounded = Shape::rounded_rect(0.0, 0.0, 100.0, 50.0, 10.0).unwrap();
        let cut = list.clipped(&rounded).unwrap().unwrap();
        let corners = (4.0 - core::f64::consts::PI) * 100.0;
        assert!((area(&cut) - (5000.0 - corners)).abs() < 0.02);
    }

    #[test]
    fn shapes_are_as_round_in_any_unit() {
        for unit in [1e-3, 1.0, 1e4, 1e6] {
            let list = Shape::rect(0.0, 0.0, 4.0 * unit, 2.0 * unit).unwrap();
            let circle = Shape::circle([2.0 * unit, 2.0 * unit], unit).unwrap();
            let half = circle.clipped(&list).unwrap().unwrap();
            let flatness = 1e-7 * f64::from(unit);
            let area = Outline::of_flattened(&half, flatness).area() / f64::from(unit).powi(2);
            let error = area - core::f64::consts::FRAC_PI_2;
            assert!(error.abs() < 1e-5, "a unit of {unit}: {error}");
        }
    }

    #[test]
    fn what_would_be_too_many_lines_is_refused() {
        let mut path = Path::new();
        path.move_to([0.0, 0.0]);
        for _ in 0..100 {
            path.cubic_to([1.6e7, 0.0], [0.0, 1.6e7], [1.6e7, 1.6e7]);
            path.cubic_to([0.0, 1.6e7], [1.6e7, 0.0], [0.0, 0.0]);
        }
        let shape = Shape::path(&path, FillRule::NonZero).unwrap();
        let clip = Shape::rect(0.0, 0.0, 100.0, 100.0).unwrap();
        assert!(matches!(shape.clipped(&clip), Err(Error::TooMany { .. })));
    }

    #[test]
    fn boxes_stay_where_they_are() {
        let card = Shape::rect(9000.0, 0.0, 10.0, 10.0).unwrap();
        let card = card.transformed([1.0, 0.0, 0.0, 1.0, 0.1, 0.0]).unwrap();
        let list = Shape::rect(8990.0, 5.0, 30.0, 30.0).unwrap();
        let cut = card.clipped(&list).unwrap().unwrap();
        let ((min, max), (cut_min, cut_max)) = (card.hull().unwrap(), cut.hull().unwrap());
        assert!((cut_min.x - min.x).abs() < 1e-11 && (cut_max.x - max.x).abs() < 1e-11);
        assert!((cut_min.y, cut_max.y) == (5.0, max.y));
    }
}
