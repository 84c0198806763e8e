//! A scan conversion of triangles of black whose alpha is linear, as a GPU would draw them: each pixel at its centre,
//! an edge that two triangles share drawn once.

use crate::mask::blend_row;

/// Corners snap to 1/4096 pixel, so that which side of an edge a pixel is on is exact.
const SUBPIXEL: i64 = 1 << 12;

/// A corner; alpha from 0 to 255.
#[derive(Clone, Copy)]
pub(crate) struct Corner {
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) alpha: f32,
}

/// Draws triangles on canvases of one size.
pub(crate) struct Triangles {
    width: u32,
    height: u32,
    /// The coverage of the pixels of a row that a triangle holds.
    row: Vec<u8>,
}

impl Triangles {
    pub(crate) fn new(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            row: Vec::new(),
        }
    }

    /// Draws one over premultiplied RGBA8 pixels.
    pub(crate) fn fill(&mut self, corners: [Corner; 3], canvas: &mut [u8]) {
        if corners.iter().all(|corner| corner.alpha == 0.0) {
            return;
        }
        let Some(corners) = clockwise(corners) else {
            return;
        };
        let points = corners.map(snapped);
        let edges = [0, 1, 2].map(|i| Edge::new(points[i], points[(i + 1) % 3]));
        let alpha = Alpha::new(&corners);
        let ys = points.map(|point| point[1]);
        let rows = pixels_between(ys[0].min(ys[1]).min(ys[2]), ys[0].max(ys[1]).max(ys[2]));
        for y in rows.start.max(0)..rows.end.min(i64::from(self.height)) {
            let mut span = 0..i64::from(self.width);
            for edge in &edges {
                edge.cut(y, &mut span);
            }
            if !span.is_empty() {
                self.fill_span(span, y, &alpha, canvas);
            }
        }
    }

    fn fill_span(&mut self, span: core::ops::Range<i64>, y: i64, alpha: &Alpha, canvas: &mut [u8]) {
        let start = (y * i64::from(self.width) + span.start) as usize * 4;
        self.row.clear();
        self.row.extend(span.map(|x| alpha.at(x, y)));
        blend_row(&mut canvas[start..start + self.row.len() * 4], &self.row);
    }
}

/// The corners in clockwise order, y down; none where they are on one line.
fn clockwise(corners: [Corner; 3]) -> Option<[Corner; 3]> {
    let [a, b, c] = corners.map(snapped);
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    match area.signum() {
        1 => Some(corners),
        -1 => Some([corners[0], corners[2], corners[1]]),
        _ => None,
    }
}

fn snapped(corner: Corner) -> [i64; 2] {
    [corner.x, corner.y].map(|v| (v * SUBPIXEL as f32).round() as i64)
}

/// The pixels whose centres are from `low` to `high`, subpixels.
fn pixels_between(low: i64, high: i64) -> core::ops::Range<i64> {
    let half = SUBPIXEL / 2;
    -(half - low).div_euclid(SUBPIXEL)..(high - half).div_euclid(SUBPIXEL) + 1
}

/// An edge of a clockwise triangle: its inside is to the right.
struct Edge {
    dx: i64,
    dy: i64,
    /// Inside are the points with `dy` x - `dx` y <= `limit`.
    limit: i64,
}

impl Edge {
    fn new([x0, y0]: [i64; 2], [x1, y1]: [i64; 2]) -> Self {
        let (dx, dy) = (x1 - x0, y1 - y0);
        // Of two triangles that share an edge, the one below it or to its right has the pixels on it.
        let has_edge = dy < 0 || (dy == 0 && dx > 0);
        Self {
            dx,
            dy,
            limit: dy * x0 - dx * y0 - i64::from(!has_edge),
        }
    }

    /// Cuts a row's pixels to those inside.
    fn cut(&self, y: i64, span: &mut core::ops::Range<i64>) {
        let most = self.limit + self.dx * (y * SUBPIXEL + SUBPIXEL / 2);
        match self.dy.signum() {
            1 => {
                let last = most.div_euclid(self.dy);
                span.end = span.end.min(pixels_between(0, last).end);
            }
            -1 => {
                let first = -most.div_euclid(-self.dy);
                span.start = span.start.max(pixels_between(first, 0).start);
            }
            _ if most < 0 => span.end = span.start,
            _ => {}
        }
    }
}

/// Alpha as a plane over the pixels.
struct Alpha {
    origin: f32,
    dx: f32,
    dy: f32,
    least: f32,
    most: f32,
}

impl Alpha {
    fn new(&[a, b, c]: &[Corner; 3]) -> Self {
        let (bx, by, cx, cy) = (b.x - a.x, b.y - a.y, c.x - a.x, c.y - a.y);
        let area = bx * cy - by * cx;
        let (b_alpha, c_alpha) = (b.alpha - a.alpha, c.alpha - a.alpha);
        let dx = (b_alpha * cy - c_alpha * by) / area;
        let dy = (c_alpha * bx - b_alpha * cx) / area;
        Self {
            origin: a.alpha + dx * (0.5 - a.x) + dy * (0.5 - a.y),
            dx,
            dy,
            least: a.alpha.min(b.alpha).min(c.alpha),
            most: a.alpha.max(b.alpha).max(c.alpha),
        }
    }

    /// At a pixel's centre. Within the corners' range: the planes of slivers are steep.
    fn at(&self, x: i64, y: i64) -> u8 {
        let alpha = self.origin + self.dx * x as f32 + self.dy * y as f32;
        (alpha.clamp(self.least, self.most) + 0.5) as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_that_share_an_edge_cover_a_square_once() {
        let corner = |x, y| Corner { x, y, alpha: 64.0 };
        let (a, b) = (corner(1.5, 1.5), corner(9.5, 1.5));
        let (c, d) = (corner(9.5, 9.5), corner(1.5, 9.5));
        let mut canvas = vec![255; 12 * 12 * 4];
        let mut triangles = Triangles::new(12, 12);
        triangles.fill([a, b, c], &mut canvas);
        triangles.fill([a, d, c], &mut canvas);
        for (i, pixel) in canvas.as_chunks::<4>().0.iter().enumerate() {
            let inside = [i % 12, i / 12].iter().all(|v| (1..9).contains(v));
            assert_eq!(pixel[0], if inside { 255 - 64 } else { 255 }, "pixel {i}");
        }
    }
}
