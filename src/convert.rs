//! Paths of other crates as ours. Coordinates are taken as they are, in scene units; what they may be is checked where a
//! path becomes a [`Shape`](crate::Shape).

use crate::path::Path;

#[cfg(feature = "lyon")]
impl From<&lyon::path::Path> for Path {
    fn from(source: &lyon::path::Path) -> Self {
        use lyon::path::Event;
        let mut path = Self::new();
        for event in source {
            match event {
                Event::Begin { at } => path.move_to(at.to_array()),
                Event::Line { to, .. } => path.line_to(to.to_array()),
                Event::Quadratic { ctrl, to, .. } => path.quad_to(ctrl.to_array(), to.to_array()),
                Event::Cubic {
                    ctrl1, ctrl2, to, ..
                } => path.cubic_to(ctrl1.to_array(), ctrl2.to_array(), to.to_array()),
                Event::End { close: true, .. } => path.close(),
                Event::End { close: false, .. } => &mut path,
            };
        }
        path
    }
}

#[cfg(feature = "kurbo")]
impl From<&kurbo::BezPath> for Path {
    /// Coordinates keep their double precision.
    fn from(source: &kurbo::BezPath) -> Self {
        use glam::DVec2;
        use kurbo::PathEl;

        use crate::path::Segment;
        let point = |p: kurbo::Point| DVec2::new(p.x, p.y);
        let mut path = Self::new();
        for element in source {
            match element {
                PathEl::MoveTo(to) => path.begin(point(to)),
                PathEl::LineTo(to) => path.push(Segment::Line(point(to))),
                PathEl::QuadTo(a, to) => path.push(Segment::Quad(point(a), point(to))),
                PathEl::CurveTo(a, b, to) => {
                    path.push(Segment::Cubic(point(a), point(b), point(to)));
                }
                PathEl::ClosePath => {
                    path.close();
                }
            }
        }
        path
    }
}

#[cfg(feature = "raster")]
impl From<&tiny_skia::Path> for Path {
    fn from(source: &tiny_skia::Path) -> Self {
        use tiny_skia::PathSegment;
        let point = |p: tiny_skia::Point| [p.x, p.y];
        let mut path = Self::new();
        for segment in source.segments() {
            match segment {
                PathSegment::MoveTo(to) => path.move_to(point(to)),
                PathSegment::LineTo(to) => path.line_to(point(to)),
                PathSegment::QuadTo(a, to) => path.quad_to(point(a), point(to)),
                PathSegment::CubicTo(a, b, to) => path.cubic_to(point(a), point(b), point(to)),
                PathSegment::Close => path.close(),
            };
        }
        path
    }
}

#[cfg(all(test, feature = "lyon", feature = "kurbo", feature = "raster"))]
mod tests {
    use super::*;

    #[test]
    fn one_drawing_comes_out_the_same_of_all_three() {
        let mut ours = Path::new();
        ours.move_to([0.0, 0.0])
            .line_to([8.0, 0.0])
            .quad_to([12.0, 4.0], [8.0, 8.0]);
        ours.cubic_to([6.0, 12.0], [2.0, 12.0], [0.0, 8.0]).close();
        ours.move_to([2.0, 2.0])
            .line_to([4.0, 2.0])
            .line_to([2.0, 4.0])
            .close();

        let mut lyon = lyon::path::Path::builder();
        let at = lyon::math::point;
        lyon.begin(at(0.0, 0.0));
        lyon.line_to(at(8.0, 0.0));
        lyon.quadratic_bezier_to(at(12.0, 4.0), at(8.0, 8.0));
        lyon.cubic_bezier_to(at(6.0, 12.0), at(2.0, 12.0), at(0.0, 8.0));
        lyon.end(true);
        lyon.begin(at(2.0, 2.0));
        lyon.line_to(at(4.0, 2.0));
        lyon.line_to(at(2.0, 4.0));
        lyon.end(true);
        assert_eq!(Path::from(&lyon.build()), ours);

        let mut kurbo = kurbo::BezPath::new();
        kurbo.move_to((0.0, 0.0));
        kurbo.line_to((8.0, 0.0));
        kurbo.quad_to((12.0, 4.0), (8.0, 8.0));
        kurbo.curve_to((6.0, 12.0), (2.0, 12.0), (0.0, 8.0));
        kurbo.close_path();
        kurbo.move_to((2.0, 2.0));
        kurbo.line_to((4.0, 2.0));
        kurbo.line_to((2.0, 4.0));
        kurbo.close_path();
        assert_eq!(Path::from(&kurbo), ours);

        let mut skia = tiny_skia::PathBuilder::new();
        skia.move_to(0.0, 0.0);
        skia.line_to(8.0, 0.0);
        skia.quad_to(12.0, 4.0, 8.0, 8.0);
        skia.cubic_to(6.0, 12.0, 2.0, 12.0, 0.0, 8.0);
        skia.close();
        skia.move_to(2.0, 2.0);
        skia.line_to(4.0, 2.0);
        skia.line_to(2.0, 4.0);
        skia.close();
        assert_eq!(Path::from(&skia.finish().unwrap()), ours);
    }
}
