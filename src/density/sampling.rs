//! The points that a pixel's average is taken from, where its penumbra is narrower than 3 px.

use core::f64::consts::PI;

use super::averaged_side;
use super::quadrature::gauss;
use super::rows::{Line, Points, Wide, Window};

/// Points of one pixel, for discs or for squares. On edges, corners, arcs, slivers and dots their average is within 0.8 level
/// of the exact one. The worst are slivers along the axes, and of these hairlines as wide as a pixel: where squares are
/// averaged, the more of them there are the sharper is the peak of its coverage.
#[derive(Debug, Clone)]
pub(crate) struct Sampling {
    pub(crate) window: Window,
    /// The window's unit in pixels.
    pub(crate) unit: f64,
    lines: [Line; MOST],
    columns: [(f32, f32); MOST],
    counts: [usize; 2],
    /// What the points stand for, if there are several.
    wide: Option<Wide>,
}

const MOST: usize = 12;

/// Below this penumbra radius in pixels, squares averaged over the disc take fewer points than discs averaged over the
/// square.
const SQUARES: f64 = 0.26;

/// From this penumbra radius in pixels on, squares are so small beside discs that differences across them lose their digits.
const WIDE: f64 = 1.9;

/// Up to this penumbra radius in pixels tips take more points.
const TIPS: f64 = 2.4;

impl Sampling {
    /// For a penumbra radius in pixels; whether circles about as large as the disc, or halves of them, give the density tips: there few
    /// points are up to two levels off. The same where a pixel sees a crowd of ends of edges, such as a fine grating's: what each leaves
    /// adds up.
    pub(crate) fn new(
        radius: f64,
        has_tips: impl Fn() -> bool,
        is_crowded: impl FnOnce() -> bool,
    ) -> Self {
        let mut sampling = Self {
            window: Window::Disc,
            unit: radius,
            lines: [Points::CENTER.lines[0]; MOST],
            columns: [Points::CENTER.columns[0]; MOST],
            counts: [1, 1],
            wide: None,
        };
        if radius == 0.0 {
            (sampling.window, sampling.unit) = (Window::Square, 1.0);
        } else if radius < SQUARES {
            (sampling.window, sampling.unit) = (Window::Square, 1.0);
            let count = match radius {
                ..0.08 => 4,
                0.08..0.16 => 6,
                _ => 8,
            };
            sampling.over_disc(radius, count);
        } else if radius < 3.0 {
            let crowded = radius < WIDE && is_crowded();
            let count = match radius {
                ..0.8 if crowded => 12,
                ..1.1 if crowded => 8,
                ..WIDE if crowded => 6,
                ..0.32 => 9,
                0.32..0.4 => 8,
                0.4..0.52 => 7,
                0.52..0.78 => 6,
                0.78..1.14 if has_tips() => 6,
                0.78..1.14 => 5,
                1.14..1.4 => 4,
                1.4..TIPS if has_tips() => 4,
                1.4..1.75 => 3,
                _ => 2,
            };
            sampling.over_square(averaged_side(radius), count);
        }
        if 0.0 < radius && radius < WIDE {
            sampling.wide = Some(Wide {
                half: averaged_side(radius) / 2.0 / sampling.unit,
                radius: radius / sampling.unit,
            });
        }
        sampling
    }

    /// By Gauss's rule both ways.
    fn over_square(&mut self, side: f64, count: usize) {
        for (index, (offset, weight)) in gauss(count).enumerate() {
            self.lines[index] = Line {
                offset: offset * side / self.unit,
                weight,
                spread: 1.0,
            };
            self.columns[index] = ((offset * side) as f32, weight as f32);
        }
        self.counts = [count; 2];
    }

    /// By Gauss's rule along chords, of which Chebyshev's second rule says where they are: it is exact for the disc's
    /// widths.
    fn over_disc(&mut self, radius: f64, count: usize) {
        for index in 0..count {
            let angle = PI * (index + 1) as f64 / (count + 1) as f64;
            let sin = libm::sin(angle);
            self.lines[index] = Line {
                offset: radius * libm::cos(angle),
                weight: 2.0 / (count + 1) as f64 * sin * sin,
                spread: sin,
            };
        }
        for (index, (offset, weight)) in gauss(count).enumerate() {
            self.columns[index] = ((2.0 * offset * radius) as f32, weight as f32);
        }
        self.counts = [count; 2];
    }

    pub(crate) fn points(&self) -> Points<'_> {
        Points {
            lines: &self.lines[..self.counts[0]],
            columns: &self.columns[..self.counts[1]],
            wide: self.wide,
        }
    }
}
