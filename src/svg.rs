//! Writing SVG: numbers with fixed decimals, paths, and triangles with the one gradient that equals their interpolation.

use core::fmt::Write;

use glam::DVec2;

use crate::mesh::{MeshVertex, ShadowMesh};
use crate::tone::Color;

/// Vertices of triangles lie on multiples of this many pixels: Skia's rasteriser rounds to 64ths, and where the text
/// gives it anything else it may count a pixel centre that is within a 64th of an edge twice or not at all.
const GRID: f64 = 1.0 / 64.0;

/// An SVG document in two parts: definitions, and what is drawn with them.
#[derive(Debug)]
pub(crate) struct Svg {
    /// Pixels a scene unit.
    scale: f64,
    /// Decimals of coordinates: a thousandth of a pixel.
    decimals: usize,
    defs: String,
    body: String,
    gradients: usize,
}

/// A number with `decimals` decimals at most, without trailing zeros: the shortest text that is the same everywhere.
pub(crate) fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

fn opacity(value: f64) -> String {
    number(value, 4)
}

/// An attribute for a colour, none for black, which is what SVG takes without.
fn painted(attribute: &str, color: Color) -> String {
    match color.opaque() {
        Color::BLACK => String::new(),
        color => format!(" {attribute}=\"{color}\""),
    }
}

impl Svg {
    /// An empty document that will be seen at `scale` pixels a scene unit.
    pub(crate) fn new(scale: f64) -> Self {
        let decimals = 3 + [1.0, 10.0, 100.0, 1000.0]
            .iter()
            .filter(|&&least| scale > least)
            .count();
        Self {
            scale,
            decimals,
            defs: String::new(),
            body: String::new(),
            gradients: 0,
        }
    }

    /// A coordinate in scene units.
    fn coordinate(&self, value: f64) -> String {
        number(value, self.decimals)
    }

    /// Attributes of a rectangle.
    pub(crate) fn rectangle(&self, min: DVec2, size: DVec2) -> String {
        let [x, y, width, height] = [min.x, min.y, size.x, size.y].map(|v| self.coordinate(v));
        format!("x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
    }

    /// Path data of closed polygons.
    pub(crate) fn path_data(&self, polygons: &[Vec<DVec2>]) -> String {
        let mut data = String::new();
        for polygon in polygons {
            for (index, vertex) in polygon.iter().enumerate() {
                data.push(if index == 0 { 'M' } else { 'L' });
                data.push_str(&self.coordinate(vertex.x));
                data.push(' ');
                data.push_str(&self.coordinate(vertex.y));
            }
            data.push('Z');
        }
        data
    }

    /// A document for a part of this one: its names go on from here.
    pub(crate) fn part(&self) -> Self {
        Self {
            gradients: self.gradients,
            ..Self::new(self.scale)
        }
    }

    /// Makes a part, with all that it defines and draws, a definition of this document.
    pub(crate) fn define_part(&mut self, part: Self) {
        self.defs.push_str(&part.defs);
        self.defs.push_str(&part.body);
        self.gradients = part.gradients;
    }

    /// Appends a line to what is drawn.
    pub(crate) fn draw(&mut self, line: &str) {
        self.body.push_str(line);
        self.body.push('\n');
    }

    /// Appends a line to the definitions.
    pub(crate) fn define(&mut self, line: &str) {
        self.defs.push_str(line);
        self.defs.push('\n');
    }

    /// Draws the triangles of a mesh in one colour, densities times `weight` as opacity. They are to be in a group without
    /// antialiasing: each pixel centre is then in one triangle and there are no seams.
    pub(crate) fn draw_mesh(&mut self, mesh: &ShadowMesh, weight: f64, color: Color) {
        for triangle in mesh.triangles() {
            self.draw_triangle(triangle, weight, color);
        }
    }

    fn draw_triangle(&mut self, triangle: [MeshVertex; 3], weight: f64, color: Color) {
        let step = GRID / self.scale;
        let at = triangle.map(|vertex| (vertex.at() / step).round() * step);
        let density = triangle.map(|vertex| f64::from(vertex.density) * weight);
        if (at[1] - at[0]).perp_dot(at[2] - at[0]) == 0.0 {
            return;
        }
        let corner = |p: DVec2| {
            format!(
                "{} {}",
                number(p.x, self.decimals + 3),
                number(p.y, self.decimals + 3)
            )
        };
        let data = format!("M{}L{}L{}Z", corner(at[0]), corner(at[1]), corner(at[2]));
        let (low, high) = density
            .iter()
            .fold((f64::MAX, f64::MIN), |(low, high), &d| {
                (low.min(d), high.max(d))
            });
        if opacity(high) == "0" {
            return;
        }
        // The gradient of the plane through the three densities.
        let (ab, ac) = (at[1] - at[0], at[2] - at[0]);
        let (db, dc) = (density[1] - density[0], density[2] - density[0]);
        let slope = (ac.perp() * -db + ab.perp() * dc) / ab.perp_dot(ac);
        if opacity(low) == opacity(high) || !slope.is_finite() {
            self.draw(&format!(
                "<path{} fill-opacity=\"{}\" d=\"{data}\"/>",
                painted("fill", color),
                opacity(f64::midpoint(low, high))
            ));
            return;
        }
        let lowest = (0..3)
            .min_by(|&a, &b| density[a].total_cmp(&density[b]))
            .unwrap_or(0);
        let start = at[lowest];
        let end = start + slope * ((high - low) / slope.length_squared());
        let id = self.gradients;
        self.gradients += 1;
        let paint = painted("stop-color", color);
        self.define(&format!(
            "<linearGradient id=\"g{id}\" gradientUnits=\"userSpaceOnUse\" x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\">\
             <stop{paint} stop-opacity=\"{}\"/><stop{paint} offset=\"1\" stop-opacity=\"{}\"/></linearGradient>",
            self.coordinate(start.x),
            self.coordinate(start.y),
            self.coordinate(end.x),
            self.coordinate(end.y),
            opacity(low),
            opacity(high),
        ));
        self.draw(&format!("<path fill=\"url(#g{id})\" d=\"{data}\"/>"));
    }

    /// The document, `size` pixels large, that shows the box at `origin` of `extent` scene units.
    pub(crate) fn finish(self, size: [f64; 2], origin: DVec2, extent: DVec2) -> String {
        let mut text = String::with_capacity(self.defs.len() + self.body.len() + 256);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" viewBox=\"{} {} {} {}\">",
            number(size[0], 3),
            number(size[1], 3),
            self.coordinate(origin.x),
            self.coordinate(origin.y),
            self.coordinate(extent.x),
            self.coordinate(extent.y),
        );
        if !self.defs.is_empty() {
            let _ = write!(text, "<defs>\n{}</defs>\n", self.defs);
        }
        text.push_str(&self.body);
        text.push_str("</svg>\n");
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_stable() {
        for (value, text) in [
            (1.0, "1"),
            (-0.0001, "0"),
            (1.25, "1.25"),
            (1234.5678, "1234.568"),
            (0.1 + 0.2, "0.3"),
        ] {
            assert_eq!(number(value, 3), text);
        }
        assert_eq!(number(100.0, 0), "100");
    }

    #[test]
    fn a_gradient_equals_the_interpolation() {
        let vertex = |x: f32, y: f32, density: f32| MeshVertex {
            position: [x, y],
            density,
        };
        let mut svg = Svg::new(1.0);
        svg.draw_triangle(
            [
                vertex(0.0, 0.0, 0.25),
                vertex(10.0, 0.0, 0.75),
                vertex(3.0, 8.0, 0.25),
            ],
            1.0,
            Color::BLACK,
        );
        let text = svg.finish([10.0, 10.0], DVec2::ZERO, DVec2::splat(10.0));
        // Density is constant along (3, 8), so the gradient runs across it: from (0, 0) to the foot of (10, 0).
        let across = DVec2::new(8.0, -3.0) / 73.0_f64.sqrt();
        let end = across * (10.0 * across.x);
        assert!(
            text.contains(&format!(
                "x2=\"{}\" y2=\"{}\"",
                number(end.x, 3),
                number(end.y, 3)
            )),
            "{text}"
        );
        assert!(text.contains("stop-opacity=\"0.25\"") && text.contains("stop-opacity=\"0.75\""));
    }
}
