//! Strokes: a pen's way along a path as a shape.

use core::f64::consts::PI;

use glam::DVec2;
use lyon::math::{Point, point};
use lyon::path::traits::PathBuilder;
use lyon::tessellation::{
    BuffersBuilder, LineCap as LyonCap, LineJoin as LyonJoin, StrokeOptions, StrokeTessellator,
    StrokeVertex, VertexBuffers,
};

use super::Shape;
use crate::error::{self, Error, Result};
use crate::limits::at_most;
use crate::outline::{Winding, resolve_loops};
use crate::path::{FillRule, Path, Segment, arc_steps, lines};

/// How far from a curve of a stroke its lines may be, in scene units.
const FLATNESS: f64 = 5e-4;

/// The least and the most that is over the stroke's extent: strokes are computed in `f32`, and a scene unit may be anything.
const RELATIVE_FLATNESS: [f64; 2] = [1e-6, 4e-6];

/// A stroke may not have more lines than this before it is united: where a wide one overlaps itself they cross in as many places as the
/// square of their number.
const MAX_LINES: usize = 1 << 18;

/// How a stroke ends where its path is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LineCap {
    /// At the path's own end.
    #[default]
    Butt,
    /// Half a width on.
    Square,
    /// With a half circle.
    Round,
}

/// How a stroke turns where its path has a corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LineJoin {
    /// With a point, or as `Bevel` where that would be longer than the limit allows.
    #[default]
    Miter,
    /// With an arc.
    Round,
    /// Cut off.
    Bevel,
}

/// A pen: its width in scene units, and what it does at ends and corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    width: f32,
    cap: LineCap,
    join: LineJoin,
    miter_limit: f32,
}

impl Stroke {
    /// A pen of a width (scene units) with butt ends and mitred corners up to four times the width, as in SVG.
    ///
    /// # Errors
    /// A width that is not finite, not above 0 or passes [`MAX_COORDINATE`](crate::MAX_COORDINATE).
    pub fn new(width: f32) -> Result<Self> {
        error::positive("stroke width", f64::from(width))?;
        Ok(Self {
            width,
            cap: LineCap::default(),
            join: LineJoin::default(),
            miter_limit: 4.0,
        })
    }

    /// The same with other ends.
    #[must_use]
    pub fn with_cap(mut self, cap: LineCap) -> Self {
        self.cap = cap;
        self
    }

    /// The same with other corners.
    #[must_use]
    pub fn with_join(mut self, join: LineJoin) -> Self {
        self.join = join;
        self
    }

    /// The same with corners as long as `limit` times the width.
    ///
    /// # Errors
    /// A limit not from 1 to 1000.
    pub fn with_miter_limit(mut self, limit: f32) -> Result<Self> {
        error::within("miter limit", f64::from(limit), 1.0, 1000.0)?;
        self.miter_limit = limit;
        Ok(self)
    }
}

impl Shape {
    /// What a pen draws along a path, open contours as well as closed ones. Curves become lines within 0.0005 scene units, but no
    /// finer than a millionth of the larger side of the path's box and the width together, and no coarser than four of them.
    ///
    /// # Errors
    /// A path without segments or that draws nothing, a number that is not finite or passes
    /// [`MAX_COORDINATE`](crate::MAX_COORDINATE), more than [`MAX_SEGMENTS`](crate::MAX_SEGMENTS) segments, or more than 2^18
    /// lines along the path and round its ends and corners.
    ///
    /// ```
    /// use penumbral::{LineCap, Path, Shape, Stroke};
    ///
    /// let mut tick = Path::new();
    /// tick.move_to([4.0, 12.0]).line_to([10.0, 18.0]).line_to([20.0, 6.0]);
    /// let shape = Shape::stroke(&tick, &Stroke::new(2.0)?.with_cap(LineCap::Round))?;
    /// # Ok::<(), penumbral::Error>(())
    /// ```
    pub fn stroke(path: &Path, stroke: &Stroke) -> Result<Self> {
        path.validate()?;
        let origin = path.contours[0].start;
        let extent = Self {
            contours: path.contours.clone(),
            cover: super::Cover::Rule(FillRule::NonZero),
        }
        .extent();
        let width = f64::from(stroke.width);
        let [least, most] = RELATIVE_FLATNESS.map(|share| share * (extent + width));
        let flatness = FLATNESS.clamp(least, most);
        let is_round = stroke.cap == LineCap::Round || stroke.join == LineJoin::Round;
        let at_end = if is_round {
            arc_steps(width / 2.0, PI, flatness) as usize
        } else {
            1
        };
        let ends: usize = path.contours.iter().map(|c| c.segments.len() + 1).sum();
        let along = lines(&path.contours, flatness);
        at_most(
            "lines of a stroke",
            along.saturating_add(ends.saturating_mul(at_end)),
            MAX_LINES,
        )?;
        let options = StrokeOptions::tolerance(flatness as f32)
            .with_line_width(stroke.width)
            .with_line_cap(stroke.cap.into())
            .with_line_join(stroke.join.into())
            .with_miter_limit(stroke.miter_limit);
        let mut buffers: VertexBuffers<Point, u32> = VertexBuffers::new();
        let mut output = BuffersBuilder::new(&mut buffers, |vertex: StrokeVertex<'_, '_>| {
            vertex.position()
        });
        let mut tessellator = StrokeTessellator::new();
        let mut builder = tessellator.builder(&options, &mut output);
        trace(path, origin, flatness, &mut builder);
        builder.build().map_err(|error| Error::Stroke {
            reason: error.to_string(),
        })?;
        let corner = |index: u32| {
            let p = buffers.vertices[index as usize];
            origin + DVec2::new(f64::from(p.x), f64::from(p.y))
        };
        let triangles: Vec<Vec<DVec2>> = buffers
            .indices
            .chunks_exact(3)
            .map(|triangle| {
                let [a, b, c] = [
                    corner(triangle[0]),
                    corner(triangle[1]),
                    corner(triangle[2]),
                ];
                if (b - a).perp_dot(c - a) < 0.0 {
                    vec![a, c, b]
                } else {
                    vec![a, b, c]
                }
            })
            .collect();
        let loops = resolve_loops(&triangles, Winding::Rule(FillRule::NonZero), false);
        Self::of_loops(&loops)?.ok_or(Error::EmptyPath { field: "stroke" })
    }
}

/// Walks a path, seen from `origin`.
fn trace(path: &Path, origin: DVec2, flatness: f64, builder: &mut impl PathBuilder) {
    let at = |p: DVec2| {
        let p = p - origin;
        point(p.x as f32, p.y as f32)
    };
    for contour in &path.contours {
        if contour.segments.is_empty() {
            continue;
        }
        builder.begin(at(contour.start), &[]);
        let mut from = contour.start;
        for segment in &contour.segments {
            match *segment {
                Segment::Line(to) => {
                    builder.line_to(at(to), &[]);
                }
                Segment::Quad(a, to) => {
                    builder.quadratic_bezier_to(at(a), at(to), &[]);
                }
                Segment::Cubic(a, b, to) => {
                    builder.cubic_bezier_to(at(a), at(b), at(to), &[]);
                }
                Segment::Arc(_) => {
                    let mut points = Vec::new();
                    segment.flatten(from, flatness, &mut points);
                    for to in points {
                        builder.line_to(at(to), &[]);
                    }
                }
            }
            from = segment.end();
        }
        builder.end(contour.closed);
    }
}

impl From<LineCap> for LyonCap {
    fn from(cap: LineCap) -> Self {
        match cap {
            LineCap::Butt => Self::Butt,
            LineCap::Square => Self::Square,
            LineCap::Round => Self::Round,
        }
    }
}

impl From<LineJoin> for LyonJoin {
    fn from(join: LineJoin) -> Self {
        match join {
            LineJoin::Miter => Self::Miter,
            LineJoin::Round => Self::Round,
            LineJoin::Bevel => Self::Bevel,
        }
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use super::*;
    use crate::outline::Outline;

    fn area(path: &Path, stroke: &Stroke) -> f64 {
        Outline::of_flattened(&Shape::stroke(path, stroke).unwrap(), 1e-4).area()
    }

    #[test]
    fn areas_of_strokes_are_those_of_pens() {
        let mut line = Path::new();
        line.move_to([1000.0, 20.0]).line_to([1030.0, 60.0]);
        let pen = Stroke::new(4.0).unwrap();
        assert!((area(&line, &pen) - 200.0).abs() < 1e-2);
        assert!((area(&line, &pen.with_cap(LineCap::Square)) - 216.0).abs() < 1e-2);
        let round = 200.0 + 4.0 * PI;
        assert!((area(&line, &pen.with_cap(LineCap::Round)) - round).abs() < 2e-2);

        // An open corner and a closed one: the second has two corners more and one side.
        let mut corner = Path::new();
        corner
            .move_to([0.0, 0.0])
            .line_to([40.0, 0.0])
            .line_to([40.0, 30.0]);
        assert!((area(&corner, &pen) - (4.0 * 70.0)).abs() < 1e-2);
        corner.close();
        // A mitred ring about the triangle 40, 30, 50 is its length times the width and the corners' points less their dents.
        let grown = area(&corner, &pen);
        let (inside, semi) = (600.0, 60.0);
        let inset = |d: f64| inside * (1.0 - d * semi / inside).powi(2);
        assert!((grown - (inset(-2.0) - inset(2.0))).abs() < 1e-1, "{grown}");
    }

    #[test]
    fn strokes_are_as_round_in_any_unit() {
        let pen = |unit: f32| Stroke::new(4.0 * unit).unwrap().with_cap(LineCap::Round);
        for unit in [1e-3, 1.0, 1e4] {
            let mut line = Path::new();
            line.move_to([0.0, 0.0]).line_to([3.0 * unit, 4.0 * unit]);
            let flatness = 1e-6 * f64::from(unit);
            let shape = Shape::stroke(&line, &pen(unit)).unwrap();
            let area = Outline::of_flattened(&shape, flatness).area() / f64::from(unit).powi(2);
            let error = area - (20.0 + 4.0 * PI);
            assert!(error.abs() < 1e-3, "a unit of {unit}: {error}");
        }
    }

    #[test]
    fn strokes_of_too_many_lines_are_refused() {
        let mut zigzag = Path::new();
        zigzag.move_to([0.0, 0.0]);
        for i in 1..1000_u16 {
            zigzag.line_to([10.0 * f32::from(i), f32::from(i % 2 * 17)]);
        }
        let pen = Stroke::new(2e4).unwrap();
        assert!(Shape::stroke(&zigzag, &pen.with_join(LineJoin::Bevel)).is_ok());
        assert!(matches!(
            Shape::stroke(&zigzag, &pen.with_join(LineJoin::Round)),
            Err(Error::TooMany { .. })
        ));
    }

    #[test]
    fn what_draws_nothing_is_refused() {
        let mut dot = Path::new();
        dot.move_to([5.0, 5.0]).line_to([5.0, 5.0]);
        assert!(Shape::stroke(&dot, &Stroke::new(1.0).unwrap()).is_err());
        assert!(Stroke::new(0.0).is_err());
        assert!(Stroke::new(1.0).unwrap().with_miter_limit(0.5).is_err());
    }
}
