//! Reading SVG path data.

use glam::DVec2;
use svgtypes::{PathParser, PathSegment};

use crate::error::{Error, MAX_SEGMENTS, Result};
use crate::path::{Path, Segment};

impl Path {
    /// Reads SVG path data (SVG 1.1, section 8.3), all commands, in scene units. Arcs stay arcs.
    ///
    /// # Errors
    /// [`Error::PathData`] with the place where reading stopped, [`Error::TooMany`] segments.
    ///
    /// ```
    /// use penumbral::{FillRule, Path, Shape};
    /// let ring = Path::from_svg("M0 50a50 50 0 1 1 100 0a50 50 0 1 1-100 0zM25 50a25 25 0 1 1 50 0a25 25 0 1 1-50 0z")?;
    /// let shape = Shape::path(&ring, FillRule::EvenOdd)?;
    /// # Ok::<(), penumbral::Error>(())
    /// ```
    pub fn from_svg(data: &str) -> Result<Self> {
        let mut path = Self::new();
        let mut last = Control::None;
        for (count, segment) in PathParser::from(data).enumerate() {
            if count >= MAX_SEGMENTS {
                return Err(Error::TooMany {
                    field: "path segments",
                    count: count + 1,
                    limit: MAX_SEGMENTS,
                });
            }
            let segment = segment.map_err(|error| unreadable(data, &error))?;
            last = path.append(segment, last);
        }
        Ok(path)
    }

    fn append(&mut self, segment: PathSegment, last: Control) -> Control {
        let from = self.current();
        let place =
            |abs: bool, x: f64, y: f64| DVec2::new(x, y) + if abs { DVec2::ZERO } else { from };
        match segment {
            PathSegment::MoveTo { abs, x, y } => self.begin(place(abs, x, y)),
            PathSegment::LineTo { abs, x, y } => self.push(Segment::Line(place(abs, x, y))),
            PathSegment::HorizontalLineTo { abs, x } => {
                let x = if abs { x } else { from.x + x };
                self.push(Segment::Line(DVec2::new(x, from.y)));
            }
            PathSegment::VerticalLineTo { abs, y } => {
                let y = if abs { y } else { from.y + y };
                self.push(Segment::Line(DVec2::new(from.x, y)));
            }
            PathSegment::CurveTo {
                abs,
                x1,
                y1,
                x2,
                y2,
                x,
                y,
            } => {
                let second = place(abs, x2, y2);
                self.push(Segment::Cubic(place(abs, x1, y1), second, place(abs, x, y)));
                return Control::Cubic(second);
            }
            PathSegment::SmoothCurveTo { abs, x2, y2, x, y } => {
                let first = if let Control::Cubic(c) = last {
                    2.0 * from - c
                } else {
                    from
                };
                let second = place(abs, x2, y2);
                self.push(Segment::Cubic(first, second, place(abs, x, y)));
                return Control::Cubic(second);
            }
            PathSegment::Quadratic { abs, x1, y1, x, y } => {
                let control = place(abs, x1, y1);
                self.push(Segment::Quad(control, place(abs, x, y)));
                return Control::Quad(control);
            }
            PathSegment::SmoothQuadratic { abs, x, y } => {
                let control = if let Control::Quad(c) = last {
                    2.0 * from - c
                } else {
                    from
                };
                self.push(Segment::Quad(control, place(abs, x, y)));
                return Control::Quad(control);
            }
            PathSegment::EllipticalArc {
                abs,
                rx,
                ry,
                x_axis_rotation,
                large_arc,
                sweep,
                x,
                y,
            } => self.arc(
                DVec2::new(rx, ry),
                x_axis_rotation.to_radians(),
                large_arc,
                sweep,
                place(abs, x, y),
            ),
            PathSegment::ClosePath { .. } => {
                self.close();
            }
        }
        Control::None
    }
}

/// The control point that a smooth curve reflects: SVG asks that the segment before was of its own kind.
#[derive(Clone, Copy)]
enum Control {
    None,
    Quad(DVec2),
    Cubic(DVec2),
}

fn unreadable(data: &str, error: &svgtypes::Error) -> Error {
    use svgtypes::Error as E;
    let (position, reason) = match error {
        E::UnexpectedData(at) => (*at, "this belongs to no command".to_owned()),
        E::InvalidNumber(at) => (*at, "this is not a number".to_owned()),
        E::InvalidChar(_, at) | E::InvalidString(_, at) => {
            (*at, "this does not belong here".to_owned())
        }
        E::UnexpectedEndOfStream => (
            data.chars().count() + 1,
            "the data end inside a segment".to_owned(),
        ),
        other => (1, other.to_string()),
    };
    Error::PathData { position, reason }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertices(data: &str) -> Vec<DVec2> {
        Path::from_svg(data).unwrap().contours[0].flatten(1e-3)
    }

    #[test]
    fn relative_absolute_and_short_forms_agree() {
        let long = vertices("M 10 10 L 30 10 L 30 40 L 10 40 Z");
        assert_eq!(long, vertices("M10,10H30V40H10z"));
        assert_eq!(long, vertices("m10 10 20 0 0 30-20 0z"));
        assert_eq!(long, vertices("M10 10h20v30h-20z"));
        let smooth = vertices("M0 0C0 10 10 20 20 20S40 10 40 0");
        assert_eq!(smooth, vertices("M0 0C0 10 10 20 20 20C30 20 40 10 40 0"));
        assert_eq!(
            vertices("M0 0Q10 10 20 0T40 0"),
            vertices("M0 0Q10 10 20 0Q30-10 40 0")
        );
        assert_eq!(
            vertices("M0 0a5 5 0 0110 0z"),
            vertices("M0,0 a5,5 0 0,1 10,0 z")
        );
    }

    #[test]
    fn broken_data_are_refused_with_the_place() {
        for (data, at) in [
            ("M 10 10 L 30", 13),
            ("M 0 0 X 3 3", 7),
            ("L 1 1 foo", 1),
            ("M 0 0 L 1 q", 11),
        ] {
            match Path::from_svg(data) {
                Err(Error::PathData { position, .. }) => assert_eq!(position, at, "{data}"),
                other => panic!("{data}: {other:?}"),
            }
        }
    }
}
