//! Paths: contours of lines, quadratics, cubics and elliptical arcs.

mod arc;
mod flatten;
mod parts;

use core::mem;

use glam::{DAffine2, DVec2};

pub(crate) use arc::{EllipseArc, arc_steps};
pub(crate) use flatten::lines;
pub(crate) use parts::{Curve, Part};

use crate::error::{self, Error, MAX_SEGMENTS, Result};

/// Which parts of the plane a path with several or self-crossing contours covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum FillRule {
    /// Where the contours wind round a point a number of times that is not 0 in sum.
    #[default]
    NonZero,
    /// Where the contours wind round a point an odd number of times.
    EvenOdd,
}

/// Contours of lines, quadratics, cubics and elliptical arcs. An open contour is closed by a line, as in every fill.
///
/// ```
/// use penumbral::{FillRule, Path, Shape};
///
/// let mut bubble = Path::new();
/// bubble.move_to([0.0, 0.0]).line_to([80.0, 0.0]);
/// bubble.arc_to([8.0, 8.0], 0.0, false, true, [88.0, 8.0]);
/// bubble.line_to([88.0, 40.0]).quad_to([40.0, 40.0], [30.0, 60.0]).close();
/// let shape = Shape::path(&bubble, FillRule::NonZero)?;
/// # Ok::<(), penumbral::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Path {
    pub(crate) contours: Vec<Contour>,
    /// Where a segment without a `move_to` of its own begins.
    next: Option<DVec2>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Contour {
    pub(crate) start: DVec2,
    pub(crate) segments: Vec<Segment>,
    /// Whether it was closed by word: a fill closes it anyway, a stroke does not.
    pub(crate) closed: bool,
}

/// A piece of a contour, from where the last one ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Segment {
    Line(DVec2),
    Quad(DVec2, DVec2),
    Cubic(DVec2, DVec2, DVec2),
    Arc(EllipseArc),
}

impl Path {
    /// A path without contours.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Begins a contour at `to`.
    pub fn move_to(&mut self, to: [f32; 2]) -> &mut Self {
        self.begin(point(to));
        self
    }

    /// A straight line to `to`.
    pub fn line_to(&mut self, to: [f32; 2]) -> &mut Self {
        self.push(Segment::Line(point(to)));
        self
    }

    /// A quadratic Bézier curve to `to`.
    pub fn quad_to(&mut self, control: [f32; 2], to: [f32; 2]) -> &mut Self {
        self.push(Segment::Quad(point(control), point(to)));
        self
    }

    /// A cubic Bézier curve to `to`.
    pub fn cubic_to(&mut self, control1: [f32; 2], control2: [f32; 2], to: [f32; 2]) -> &mut Self {
        self.push(Segment::Cubic(point(control1), point(control2), point(to)));
        self
    }

    /// An elliptical arc to `to`, as in SVG: half axes `radii`, the first of them turned by `rotation` (radians), the
    /// longer way round when `large`, with growing angles (clockwise where y points down) when `positive`. Radii too
    /// small to reach are scaled up and a zero radius makes a line, both as SVG has it.
    pub fn arc_to(
        &mut self,
        radii: [f32; 2],
        rotation: f32,
        large: bool,
        positive: bool,
        to: [f32; 2],
    ) -> &mut Self {
        self.arc(
            point(radii),
            f64::from(rotation),
            large,
            positive,
            point(to),
        );
        self
    }

    /// Closes the contour by a line to its start, where the next one begins unless `move_to` says otherwise.
    pub fn close(&mut self) -> &mut Self {
        if let Some(contour) = self.contours.last_mut() {
            contour.closed = true;
            self.next = Some(contour.start);
        }
        self
    }

    pub(crate) fn begin(&mut self, start: DVec2) {
        self.contours.push(Contour {
            start,
            segments: Vec::new(),
            closed: false,
        });
        self.next = None;
    }

    pub(crate) fn push(&mut self, segment: Segment) {
        if let Some(start) = self.next {
            self.begin(start);
        }
        if self.contours.is_empty() {
            self.begin(DVec2::ZERO);
        }
        if let Some(contour) = self.contours.last_mut() {
            contour.segments.push(segment);
        }
    }

    /// Where the next segment begins.
    pub(crate) fn current(&self) -> DVec2 {
        self.next
            .or_else(|| self.contours.last().map(Contour::end))
            .unwrap_or(DVec2::ZERO)
    }

    pub(crate) fn arc(
        &mut self,
        radii: DVec2,
        rotation: f64,
        large: bool,
        positive: bool,
        to: DVec2,
    ) {
        let from = self.current();
        let segment = EllipseArc::through(from, radii, rotation, large, positive, to)
            .map_or(Segment::Line(to), Segment::Arc);
        self.push(segment);
    }

    /// Checks every number and the number of segments.
    pub(crate) fn validate(&self) -> Result<()> {
        let count = self
            .contours
            .iter()
            .map(|contour| contour.segments.len())
            .sum();
        if count == 0 {
            return Err(Error::EmptyPath { field: "path" });
        }
        if count > MAX_SEGMENTS {
            return Err(Error::TooMany {
                field: "path segments",
                count,
                limit: MAX_SEGMENTS,
            });
        }
        for contour in &self.contours {
            coordinates("path", contour.start)?;
            for segment in &contour.segments {
                match *segment {
                    Segment::Line(to) => coordinates("path", to)?,
                    Segment::Quad(a, to) => {
                        coordinates("path", a)?;
                        coordinates("path", to)?;
                    }
                    Segment::Cubic(a, b, to) => {
                        coordinates("path", a)?;
                        coordinates("path", b)?;
                        coordinates("path", to)?;
                    }
                    Segment::Arc(arc) => {
                        for v in [arc.center, arc.u, arc.v, arc.to] {
                            coordinates("path arc", v)?;
                        }
                        error::coordinate("path arc rotation", arc.start)?;
                        error::coordinate("path arc rotation", arc.sweep)?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Checks both coordinates of a point.
pub(crate) fn coordinates(field: &'static str, v: DVec2) -> Result<()> {
    error::coordinate(field, v.x)?;
    error::coordinate(field, v.y)?;
    Ok(())
}

fn point(p: [f32; 2]) -> DVec2 {
    DVec2::new(f64::from(p[0]), f64::from(p[1]))
}

impl Contour {
    pub(crate) fn end(&self) -> DVec2 {
        self.segments.last().map_or(self.start, Segment::end)
    }

    /// Its segments, each with where it begins.
    pub(crate) fn walk(&self) -> impl Iterator<Item = (DVec2, &Segment)> {
        self.segments.iter().scan(self.start, |end, segment| {
            Some((mem::replace(end, segment.end()), segment))
        })
    }

    pub(crate) fn is_straight(&self) -> bool {
        self.segments
            .iter()
            .all(|segment| matches!(segment, Segment::Line(_)))
    }

    /// Whether it is made of lines and circular arcs alone.
    pub(crate) fn is_of_circles(&self) -> bool {
        self.segments.iter().all(|segment| match segment {
            Segment::Line(_) => true,
            Segment::Arc(arc) => arc.is_circular(),
            Segment::Quad(..) | Segment::Cubic(..) => false,
        })
    }

    pub(crate) fn transformed(&self, affine: &DAffine2) -> Self {
        let map = |p| affine.transform_point2(p);
        let segments = self
            .segments
            .iter()
            .map(|segment| match *segment {
                Segment::Line(to) => Segment::Line(map(to)),
                Segment::Quad(a, to) => Segment::Quad(map(a), map(to)),
                Segment::Cubic(a, b, to) => Segment::Cubic(map(a), map(b), map(to)),
                Segment::Arc(arc) => Segment::Arc(EllipseArc {
                    center: map(arc.center),
                    u: affine.transform_vector2(arc.u),
                    v: affine.transform_vector2(arc.v),
                    to: map(arc.to),
                    ..arc
                }),
            })
            .collect();
        Self {
            start: map(self.start),
            segments,
            closed: self.closed,
        }
    }
}

impl Segment {
    pub(crate) fn end(&self) -> DVec2 {
        match *self {
            Self::Line(to) | Self::Quad(_, to) | Self::Cubic(_, _, to) => to,
            Self::Arc(arc) => arc.to,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_after_close_begin_a_contour() {
        let mut path = Path::new();
        path.move_to([1.0, 1.0])
            .line_to([2.0, 1.0])
            .line_to([2.0, 2.0])
            .close();
        path.line_to([5.0, 5.0]);
        assert_eq!(path.contours.len(), 2);
        assert_eq!(path.contours[1].start, DVec2::ONE);
    }
}
