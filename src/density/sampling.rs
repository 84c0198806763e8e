//! The points that a pixel's average is taken from, where its penumbra is narrower than 3 px.

use core::f64::consts::PI;

use super::averaged_side;
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

const MOST: usize = 9;

/// Below this penumbra radius in pixels, squares averaged over the disc take fewer points than discs averaged over the
/// square.
const SQUARES: f64 = 0.26;

/// From this penumbra radius in pixels on, squares are so small beside discs that differences across them lose their digits.
const WIDE: f64 = 1.9;

/// Up to this penumbra radius in pixels tips take more points.
const TIPS: f64 = 2.4;

/// Nodes and weights of the Gauss-Legendre rules on -1 to 1, the half that is not negative (Abramowitz & Stegun 1964, table
/// 25.4).
const GAUSS: [&[(f64, f64)]; MOST] = [
    &[(0.0, 2.0)],
    &[(0.577_350_269_189_625_8, 1.0)],
    &[(0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)],
    &[
        (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_86),
    ],
    &[
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ],
    &[
        (0.238_619_186_083_196_9, 0.467_913_934_572_691_05),
        (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
        (0.932_469_514_203_152, 0.171_324_492_379_170_34),
    ],
    &[
        (0.0, 0.417_959_183_673_469_4),
        (0.405_845_151_377_397_2, 0.381_830_050_505_118_9),
        (0.741_531_185_599_394_5, 0.279_705_391_489_276_64),
        (0.949_107_912_342_758_5, 0.129_484_966_168_869_7),
    ],
    &[
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
        (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
    ],
    &[
        (0.0, 0.330_239_355_001_259_8),
        (0.324_253_423_403_808_9, 0.312_347_077_040_002_86),
        (0.613_371_432_700_590_4, 0.260_610_696_402_935_44),
        (0.836_031_107_326_635_8, 0.180_648_160_694_857_4),
        (0.968_160_239_507_626_1, 0.081_274_388_361_574_41),
    ],
];

/// The rule of `count` points on -1/2 to 1/2: offsets and weights that sum to 1.
fn gauss(count: usize) -> impl Iterator<Item = (f64, f64)> {
    GAUSS[count - 1].iter().flat_map(|&(node, weight)| {
        let mirrored = (node > 0.0).then_some((-node / 2.0, weight / 2.0));
        mirrored.into_iter().chain([(node / 2.0, weight / 2.0)])
    })
}

impl Sampling {
    /// For a penumbra radius in pixels; whether circles about as large as the disc, or halves of them, give the density tips: there few
    /// points are up to two levels off.
    pub(crate) fn new(radius: f64, has_tips: impl Fn() -> bool) -> Self {
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
            let count = match radius {
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
