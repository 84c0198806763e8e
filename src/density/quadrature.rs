//! The points at which averages over a square and over a disc are taken.

use core::f64::consts::{FRAC_1_PI, FRAC_PI_2, TAU};

use glam::DVec2;
use libm::{cos, sin};

/// Below this penumbra radius in pixels the coverage of pixels is averaged over the disc, from there on the density over
/// the pixel: each the smoother function of the two, as the disc or the pixel is the larger.
pub(crate) const COVERAGE_RADIUS: f64 = 0.5;

/// The Gauss-Legendre rule of so many points, up to 9, 12 or 16: nodes and weights on -1 to 1, the half that is not negative (Abramowitz &
/// Stegun 1964, table 25.4).
const fn rule(count: usize) -> &'static [(f64, f64)] {
    match count {
        1 => &[(0.0, 2.0)],
        2 => &[(0.577_350_269_189_625_8, 1.0)],
        3 => &[(0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)],
        4 => &[
            (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
            (0.861_136_311_594_052_6, 0.347_854_845_137_453_86),
        ],
        5 => &[
            (0.0, 0.568_888_888_888_888_9),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        ],
        6 => &[
            (0.238_619_186_083_196_9, 0.467_913_934_572_691_05),
            (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
            (0.932_469_514_203_152, 0.171_324_492_379_170_34),
        ],
        7 => &[
            (0.0, 0.417_959_183_673_469_4),
            (0.405_845_151_377_397_2, 0.381_830_050_505_118_9),
            (0.741_531_185_599_394_5, 0.279_705_391_489_276_64),
            (0.949_107_912_342_758_5, 0.129_484_966_168_869_7),
        ],
        8 => &[
            (0.183_434_642_495_649_8, 0.362_683_783_378_362),
            (0.525_532_409_916_329, 0.313_706_645_877_887_3),
            (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
            (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
        ],
        9 => &[
            (0.0, 0.330_239_355_001_259_8),
            (0.324_253_423_403_808_9, 0.312_347_077_040_002_86),
            (0.613_371_432_700_590_4, 0.260_610_696_402_935_44),
            (0.836_031_107_326_635_8, 0.180_648_160_694_857_4),
            (0.968_160_239_507_626_1, 0.081_274_388_361_574_41),
        ],
        12 => &[
            (0.125_233_408_511_468_9, 0.249_147_045_813_402_77),
            (0.367_831_498_998_180_2, 0.233_492_536_538_354_8),
            (0.587_317_954_286_617_5, 0.203_167_426_723_065_92),
            (0.769_902_674_194_304_7, 0.160_078_328_543_346_23),
            (0.904_117_256_370_474_9, 0.106_939_325_995_318_43),
            (0.981_560_634_246_719_2, 0.047_175_336_386_511_83),
        ],
        _ => &[
            (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
            (0.281_603_550_779_258_9, 0.182_603_415_044_923_58),
            (0.458_016_777_657_227_4, 0.169_156_519_395_002_54),
            (0.617_876_244_402_643_8, 0.149_595_988_816_576_74),
            (0.755_404_408_355_003, 0.124_628_971_255_533_88),
            (0.865_631_202_387_831_8, 0.095_158_511_682_492_79),
            (0.944_575_023_073_232_6, 0.062_253_523_938_647_894),
            (0.989_400_934_991_649_9, 0.027_152_459_411_754_096),
        ],
    }
}

/// The positive node of the rule of 2 points, whose weights are 1.
const NODE_OF_2: f64 = rule(2)[0].0;

/// The rule of `count` points on the interval from -1/2 to 1/2: nodes and weights that sum to 1.
pub(super) fn gauss(count: usize) -> impl Iterator<Item = (f64, f64)> + Clone {
    rule(count).iter().flat_map(|&(node, weight)| {
        let mirrored = (node > 0.0).then_some((-node / 2.0, weight / 2.0));
        mirrored.into_iter().chain([(node / 2.0, weight / 2.0)])
    })
}

/// The same with the interval cut into so many parts.
fn in_parts(count: usize, parts: u32) -> impl Iterator<Item = (f64, f64)> + Clone {
    let part = 1.0 / f64::from(parts);
    (0..parts).flat_map(move |index| {
        let middle = (f64::from(index) + 0.5) * part - 0.5;
        gauss(count).map(move |(node, weight)| (middle + node * part, weight * part))
    })
}

/// Points and weights for an average over the square of side 1 about the origin: 4 x 4, 8 x 8 or 12 x 12, the more the
/// smaller the penumbra radius in pixels. On edges, corners, slivers and dots they are within 0.04, 0.11 and 0.12 level
/// of finer rules, on gratings finer than pixels within 0.3.
pub(crate) fn square(radius: f64) -> impl Iterator<Item = (DVec2, f64)> {
    on_square(side(radius))
}

/// The points and weights of [`square`] along one of its sides.
pub(crate) fn side(radius: f64) -> impl Iterator<Item = (f64, f64)> + Clone {
    gauss(if radius >= 2.0 {
        4
    } else if radius >= 1.0 {
        8
    } else {
        12
    })
}

/// The same for `exact`: 4 x 4, 12 x 12 or 16 x 16 in each of so many `parts` along both sides.
pub(crate) fn exact_square(radius: f64, parts: u32) -> impl Iterator<Item = (DVec2, f64)> {
    on_square(in_parts(exact_side(radius), parts))
}

fn exact_side(radius: f64) -> usize {
    if radius >= 2.0 {
        4
    } else if radius >= 1.0 {
        12
    } else {
        16
    }
}

/// How many parts the square takes where a pixel sees so many periods of a grating across it: each has six points.
pub(crate) fn parts(radius: f64, periods: f64) -> u32 {
    (6.0 * periods / exact_side(radius) as f64)
        .ceil()
        .clamp(1.0, MOST_PARTS) as u32
}

/// The most parts: finer gratings are even for a disc.
const MOST_PARTS: f64 = 6.0;

fn on_square(side: impl Iterator<Item = (f64, f64)> + Clone) -> impl Iterator<Item = (DVec2, f64)> {
    let row = side.clone();
    side.flat_map(move |(y, wy)| row.clone().map(move |(x, wx)| (DVec2::new(x, y), wx * wy)))
}

/// 8 x 24 points and weights for an average over the disc of radius 1 about the origin: Gauss points in the square of the
/// distance, so that equal steps have equal areas, by equal angles.
pub(crate) fn disc() -> impl Iterator<Item = (DVec2, f64)> {
    on_disc(gauss(8), 24)
}

/// The same where the disc is smaller than a pixel whose hard borders are seen from each of its points: 2 x 8.
pub(crate) fn small_disc() -> impl Iterator<Item = (DVec2, f64)> {
    on_disc(gauss(2), 8)
}

/// The same for `exact`: 12 x 36, so many times as many each way.
pub(crate) fn exact_disc(parts: u32) -> impl Iterator<Item = (DVec2, f64)> {
    on_disc(in_parts(12, parts), 36 * parts)
}

fn on_disc(
    rings: impl Iterator<Item = (f64, f64)>,
    turn: u32,
) -> impl Iterator<Item = (DVec2, f64)> {
    rings.flat_map(move |(node, weight)| {
        let distance = (node + 0.5).sqrt();
        (0..turn).map(move |step| {
            let angle = TAU * (f64::from(step) + 0.5) / f64::from(turn);
            (
                DVec2::new(cos(angle), sin(angle)) * distance,
                weight / f64::from(turn),
            )
        })
    })
}

/// A chord of the unit disc: its height from the middle, half its length, and what a unit of it stands for of the disc's area.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Chord {
    pub(crate) height: f64,
    pub(crate) half: f64,
    pub(crate) weight: f64,
}

/// Where one of `count` equal pieces of the disc's height, as an angle from the middle, begins.
pub(crate) fn angle(piece: u32, count: u32) -> f64 {
    FRAC_PI_2 * (2.0 * f64::from(piece) / f64::from(count) - 1.0)
}

/// The two chords that stand for the disc between two heights, given as angles: by angle chords of the disc are smooth to
/// its very ends.
pub(crate) fn chords_between(from: f64, to: f64) -> [Chord; 2] {
    let half = (to - from) / 2.0;
    [-NODE_OF_2, NODE_OF_2].map(|node| {
        let angle = from + half + node * half;
        let half_length = cos(angle);
        Chord {
            height: sin(angle),
            half: half_length,
            weight: half * half_length * FRAC_1_PI,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_averaged_exactly() {
        for radius in [0.5, 1.0, 2.0] {
            let squares: [Vec<(DVec2, f64)>; 3] = [
                square(radius).collect(),
                exact_square(radius, 1).collect(),
                exact_square(radius, 3).collect(),
            ];
            for points in squares {
                let average =
                    |f: fn(DVec2) -> f64| points.iter().map(|&(p, w)| w * f(p)).sum::<f64>();
                assert!((average(|_| 1.0) - 1.0).abs() < 1e-14);
                let expected = 1.0 / 80.0 / 12.0;
                assert!((average(|p| p.x.powi(4) * p.y.powi(2)) - expected).abs() < 1e-14);
            }
        }
        for points in [
            disc().collect::<Vec<_>>(),
            exact_disc(1).collect(),
            exact_disc(2).collect(),
        ] {
            let average = |f: fn(DVec2) -> f64| points.iter().map(|&(p, w)| w * f(p)).sum::<f64>();
            assert!((average(|_| 1.0) - 1.0).abs() < 1e-14);
            assert!((average(|p| p.x * p.x) - 0.25).abs() < 1e-14);
            assert!(average(|p| p.x * p.y).abs() < 1e-14);
        }
    }
}
