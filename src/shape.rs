//! Shapes: what a caster looks like on its own plane.

mod clipped;
mod loops;
mod simple;
mod stroke;

pub use self::stroke::{LineCap, LineJoin, Stroke};

use core::f64::consts::{FRAC_PI_2, PI};

use glam::{DAffine2, DVec2};

use crate::apart::around_points;
use crate::error::{self, Error, MAX_SEGMENTS, Result};
use crate::path::{Contour, EllipseArc, FillRule, Path, Segment, coordinates};

/// A flat shape in scene units: a rectangle, rounded rectangle, circle, ellipse, polygon or path, under an affine map.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    pub(crate) contours: Vec<Contour>,
    pub(crate) cover: Cover,
}

/// What the contours cover.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cover {
    /// The inside of contours known neither to cross nor to touch, each a border: no fill rule is needed. All have what
    /// is covered on their left, or all on their right.
    Simple,
    /// What a fill rule says of contours of which nothing is known.
    Rule(FillRule),
}

/// The radii of a rounded rectangle's corners, in scene units: clockwise from the top left where y points down, each
/// horizontal and vertical. Converts from one radius for all, four radii, or four pairs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerRadii(pub [[f32; 2]; 4]);

impl From<f32> for CornerRadii {
    fn from(radius: f32) -> Self {
        Self([[radius; 2]; 4])
    }
}

impl From<[f32; 4]> for CornerRadii {
    fn from(radii: [f32; 4]) -> Self {
        Self(radii.map(|radius| [radius; 2]))
    }
}

impl From<[[f32; 2]; 4]> for CornerRadii {
    fn from(radii: [[f32; 2]; 4]) -> Self {
        Self(radii)
    }
}

impl Shape {
    /// A rectangle from its corner of least x and y.
    ///
    /// # Errors
    /// A number that is not finite or passes [`MAX_COORDINATE`](crate::MAX_COORDINATE), a width or height not above 0.
    pub fn rect(x: f32, y: f32, width: f32, height: f32) -> Result<Self> {
        Self::rounded_rect(x, y, width, height, 0.0)
    }

    /// A rounded rectangle from its corner of least x and y. Radii too large for the sides are all scaled down by one
    /// factor, as CSS does (CSS Backgrounds and Borders 3, section 5.5).
    ///
    /// # Errors
    /// As [`Shape::rect`], and a negative radius.
    pub fn rounded_rect(
        x: f32,
        y: f32,
        width: f32,
        height: f32,
        radii: impl Into<CornerRadii>,
    ) -> Result<Self> {
        let min = DVec2::new(
            error::coordinate("x", f64::from(x))?,
            error::coordinate("y", f64::from(y))?,
        );
        let size = DVec2::new(
            error::positive("width", f64::from(width))?,
            error::positive("height", f64::from(height))?,
        );
        let mut corners = [DVec2::ZERO; 4];
        for (corner, radii) in corners.iter_mut().zip(radii.into().0) {
            *corner = DVec2::new(
                error::length("radius", f64::from(radii[0]))?,
                error::length("radius", f64::from(radii[1]))?,
            );
            // As in CSS, a corner without extent in one direction is square.
            if corner.min_element() == 0.0 {
                *corner = DVec2::ZERO;
            }
        }
        let [tl, tr, br, bl] = corners;
        let fit = [
            (size.x, tl.x + tr.x),
            (size.x, bl.x + br.x),
            (size.y, tl.y + bl.y),
            (size.y, tr.y + br.y),
        ]
        .into_iter()
        .filter(|(side, sum)| sum > side)
        .fold(1.0, |fit: f64, (side, sum)| fit.min(side / sum));
        Ok(Self::simple(rounded_rect_contour(
            min,
            size,
            corners.map(|c| c * fit),
        )))
    }

    /// A circle.
    ///
    /// # Errors
    /// A number that is not finite or passes [`MAX_COORDINATE`](crate::MAX_COORDINATE), a radius not above 0.
    pub fn circle(center: [f32; 2], radius: f32) -> Result<Self> {
        Self::ellipse_of(center, [("radius", radius); 2])
    }

    /// An ellipse with half axes `radii` along x and y.
    ///
    /// # Errors
    /// As [`Shape::circle`].
    pub fn ellipse(center: [f32; 2], radii: [f32; 2]) -> Result<Self> {
        Self::ellipse_of(center, [("radii.x", radii[0]), ("radii.y", radii[1])])
    }

    /// An ellipse of radii with their names.
    fn ellipse_of(center: [f32; 2], radii: [(&'static str, f32); 2]) -> Result<Self> {
        let center = DVec2::new(
            error::coordinate("center.x", f64::from(center[0]))?,
            error::coordinate("center.y", f64::from(center[1]))?,
        );
        let [x, y] = radii;
        let u = DVec2::new(error::positive(x.0, f64::from(x.1))?, 0.0);
        let v = DVec2::new(0.0, error::positive(y.0, f64::from(y.1))?);
        let half = |start, to| {
            Segment::Arc(EllipseArc {
                center,
                u,
                v,
                start,
                sweep: PI,
                to,
            })
        };
        Ok(Self::simple(Contour {
            start: center - u,
            segments: vec![half(-PI, center + u), half(0.0, center - u)],
            closed: true,
        }))
    }

    /// A polygon of one or more rings, each closed by itself; `rule` says what rings inside rings or crossing each
    /// other cover.
    ///
    /// # Errors
    /// No ring with three points, a number that is not finite or passes [`MAX_COORDINATE`](crate::MAX_COORDINATE),
    /// more than [`MAX_SEGMENTS`](crate::MAX_SEGMENTS) points, no width or no height.
    pub fn polygon<R: AsRef<[[f32; 2]]>>(rings: &[R], rule: FillRule) -> Result<Self> {
        let count = rings.iter().map(|ring| ring.as_ref().len()).sum();
        if count > MAX_SEGMENTS {
            return Err(Error::TooMany {
                field: "polygon points",
                count,
                limit: MAX_SEGMENTS,
            });
        }
        if !rings.iter().any(|ring| ring.as_ref().len() >= 3) {
            return Err(Error::EmptyPath { field: "polygon" });
        }
        let mut path = Path::new();
        for ring in rings {
            if let Some((first, rest)) = ring.as_ref().split_first() {
                path.move_to(*first);
                for to in rest {
                    path.line_to(*to);
                }
            }
        }
        Self::path(&path, rule)
    }

    /// A path; `rule` says what contours inside contours or crossing each other cover.
    ///
    /// # Errors
    /// A path without segments, a number that is not finite or passes [`MAX_COORDINATE`](crate::MAX_COORDINATE), more
    /// than [`MAX_SEGMENTS`](crate::MAX_SEGMENTS) segments, no width or no height.
    pub fn path(path: &Path, rule: FillRule) -> Result<Self> {
        path.validate()?;
        let encloses = |contour: &Contour| contour.segments.len() > 1 || !contour.is_straight();
        if !path.contours.iter().any(encloses) {
            return Err(Error::EmptyPath { field: "path" });
        }
        let shape = Self {
            contours: path.contours.clone(),
            cover: Cover::Rule(rule),
        };
        let Some((min, max)) = shape.hull() else {
            return Ok(shape);
        };
        error::positive("path width", max.x - min.x)?;
        error::positive("path height", max.y - min.y)?;
        Ok(
            simple::borders(&shape.contours, rule, (min, max)).map_or(shape, |contours| Self {
                contours,
                cover: Cover::Simple,
            }),
        )
    }

    /// The shape under the affine map (a, b, c, d, e, f) of SVG and PDF: x' = a x + c y + e, y' = b x + d y + f.
    ///
    /// # Errors
    /// A number that is not finite or passes [`MAX_COORDINATE`](crate::MAX_COORDINATE), a map that leaves no area, a
    /// shape that passes [`MAX_COORDINATE`](crate::MAX_COORDINATE) under it.
    pub fn transformed(&self, affine: [f32; 6]) -> Result<Self> {
        let mut columns = [0.0; 6];
        for (to, from) in columns.iter_mut().zip(affine) {
            *to = error::coordinate("affine", f64::from(from))?;
        }
        let affine = DAffine2::from_cols_array(&columns);
        let area_factor = affine.matrix2.determinant().abs();
        if area_factor == 0.0 {
            return Err(Error::NotPositive {
                field: "affine area factor",
                value: area_factor,
            });
        }
        let shape = self.mapped(&affine);
        if let Some((min, max)) = shape.hull() {
            coordinates("transformed shape", min)?;
            coordinates("transformed shape", max)?;
        }
        Ok(shape)
    }

    /// The shape moved by `offset` (x, y; scene units).
    ///
    /// # Errors
    /// As [`Shape::transformed`].
    pub fn translated(&self, offset: [f32; 2]) -> Result<Self> {
        self.transformed([1.0, 0.0, 0.0, 1.0, offset[0], offset[1]])
    }

    /// Whether it has no curves.
    pub(crate) fn is_straight(&self) -> bool {
        self.contours.iter().all(Contour::is_straight)
    }

    /// How many lines, curves and arcs it is made of.
    pub(crate) fn vertices(&self) -> usize {
        self.contours
            .iter()
            .map(|contour| contour.segments.len())
            .sum()
    }

    pub(crate) fn mapped(&self, affine: &DAffine2) -> Self {
        Self {
            contours: self
                .contours
                .iter()
                .map(|contour| contour.transformed(affine))
                .collect(),
            cover: self.cover,
        }
    }

    /// A box that holds the shape: its curves' control points, so not always the smallest.
    pub(crate) fn hull(&self) -> Option<(DVec2, DVec2)> {
        let points = self
            .contours
            .iter()
            .filter(|c| !c.segments.is_empty())
            .flat_map(|contour| {
                let of_segments = contour.walk().flat_map(|(from, segment)| match *segment {
                    Segment::Line(to) => [to; 3],
                    Segment::Quad(a, to) => [a, to, to],
                    Segment::Cubic(a, b, to) => [a, b, to],
                    Segment::Arc(arc) => {
                        let [a, b] = arc.hull(from);
                        [a, b, arc.to]
                    }
                });
                core::iter::once(contour.start).chain(of_segments)
            });
        around_points(points)
    }

    /// The larger side of that box.
    pub(crate) fn extent(&self) -> f64 {
        self.hull()
            .map_or(0.0, |(min, max)| (max - min).max_element())
    }

    /// A rectangle with round corners that fit, none of whose numbers is rounded.
    pub(crate) fn of_box(min: DVec2, size: DVec2, radii: [f64; 4]) -> Self {
        Self::simple(rounded_rect_contour(min, size, radii.map(DVec2::splat)))
    }

    fn simple(contour: Contour) -> Self {
        Self {
            contours: vec![contour],
            cover: Cover::Simple,
        }
    }
}

/// Along the top edge and round by growing angles; square corners have no arc, sides without length no line.
fn rounded_rect_contour(min: DVec2, size: DVec2, [tl, tr, br, bl]: [DVec2; 4]) -> Contour {
    let max = min + size;
    let start = DVec2::new(min.x + tl.x, min.y);
    let mut segments = Vec::with_capacity(8);
    let mut from = start;
    let corners = [
        (
            DVec2::new(max.x, min.y),
            DVec2::new(-tr.x, tr.y),
            -FRAC_PI_2,
        ),
        (max, -br, 0.0),
        (DVec2::new(min.x, max.y), DVec2::new(bl.x, -bl.y), FRAC_PI_2),
        (min, tl, PI),
    ];
    for (index, (corner, inwards, angle)) in corners.into_iter().enumerate() {
        let along_x = DVec2::new(corner.x + inwards.x, corner.y);
        let along_y = DVec2::new(corner.x, corner.y + inwards.y);
        let (before, after) = if index % 2 == 0 {
            (along_x, along_y)
        } else {
            (along_y, along_x)
        };
        if before != from {
            segments.push(Segment::Line(before));
        }
        if before != after {
            segments.push(Segment::Arc(EllipseArc {
                center: corner + inwards,
                u: DVec2::new(inwards.x.abs(), 0.0),
                v: DVec2::new(0.0, inwards.y.abs()),
                start: angle,
                sweep: FRAC_PI_2,
                to: after,
            }));
        }
        from = after;
    }
    Contour {
        start,
        segments,
        closed: true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_radii_scale_down_together() {
        let pill = Shape::rounded_rect(0.0, 0.0, 100.0, 20.0, 50.0).unwrap();
        let capped = Shape::rounded_rect(0.0, 0.0, 100.0, 20.0, 10.0).unwrap();
        assert_eq!(pill, capped);
        assert_eq!(pill.contours[0].segments.len(), 6);
        // One factor for all corners, not one a corner.
        let mixed = Shape::rounded_rect(0.0, 0.0, 100.0, 100.0, [100.0, 100.0, 0.0, 50.0]).unwrap();
        let halved = Shape::rounded_rect(0.0, 0.0, 100.0, 100.0, [50.0, 50.0, 0.0, 25.0]).unwrap();
        assert_eq!(mixed, halved);
    }

    #[test]
    fn what_has_no_area_is_refused() {
        assert!(matches!(
            Shape::rect(0.0, 0.0, 0.0, 5.0),
            Err(Error::NotPositive { field: "width", .. })
        ));
        assert!(matches!(
            Shape::rect(0.0, 0.0, 5.0, -1.0),
            Err(Error::NotPositive {
                field: "height",
                ..
            })
        ));
        assert!(matches!(
            Shape::circle([0.0, 0.0], 0.0),
            Err(Error::NotPositive { .. })
        ));
        assert!(matches!(
            Shape::rounded_rect(0.0, 0.0, 5.0, 5.0, -1.0),
            Err(Error::OutOfRange {
                field: "radius",
                ..
            })
        ));
        assert!(matches!(
            Shape::path(&Path::new(), FillRule::NonZero),
            Err(Error::EmptyPath { .. })
        ));
        assert!(matches!(
            Shape::polygon(&[[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]], FillRule::NonZero),
            Err(Error::NotPositive {
                field: "path height",
                ..
            })
        ));
        let none: [[[f32; 2]; 3]; 0] = [];
        assert!(matches!(
            Shape::polygon(&none, FillRule::NonZero),
            Err(Error::EmptyPath { .. })
        ));
        let square = Shape::rect(0.0, 0.0, 1.0, 1.0).unwrap();
        assert!(square.transformed([1.0, 2.0, 2.0, 4.0, 0.0, 0.0]).is_err());
    }
}
