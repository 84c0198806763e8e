//! The points at which averages over a square and over a disc are taken.

use core::f64::consts::{FRAC_1_PI, FRAC_PI_2, TAU};

use glam::DVec2;
use libm::{cos, sin, sqrt};

/// Below this penumbra radius in pixels the coverage of pixels is averaged over the disc, from there on the density over
/// the pixel: each the smoother function of the two, as the disc or the pixel is the larger.
pub(crate) const COVERAGE_RADIUS: f64 = 0.5;

/// The positive node of the Gauss-Legendre rule with 2 points on -1 to 1, whose weights are 1.
const GAUSS_2: f64 = 0.577_350_269_189_625_8;

/// Nodes and weights of the Gauss-Legendre rules with 4, 8, 12 and 16 points on -1 to 1, the positive half (Abramowitz &
/// Stegun 1964, table 25.4).
const GAUSS_4: [(f64, f64); 2] = [
    (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_86),
];
const GAUSS_8: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
];
const GAUSS_12: [(f64, f64); 6] = [
    (0.125_233_408_511_468_9, 0.249_147_045_813_402_77),
    (0.367_831_498_998_180_2, 0.233_492_536_538_354_8),
    (0.587_317_954_286_617_5, 0.203_167_426_723_065_92),
    (0.769_902_674_194_304_7, 0.160_078_328_543_346_23),
    (0.904_117_256_370_474_9, 0.106_939_325_995_318_43),
    (0.981_560_634_246_719_2, 0.047_175_336_386_511_83),
];

const GAUSS_16: [(f64, f64); 8] = [
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_58),
    (0.458_016_777_657_227_4, 0.169_156_519_395_002_54),
    (0.617_876_244_402_643_8, 0.149_595_988_816_576_74),
    (0.755_404_408_355_003, 0.124_628_971_255_533_88),
    (0.865_631_202_387_831_8, 0.095_158_511_682_492_79),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_894),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_096),
];

/// The nodes and weights on the interval from -1/2 to 1/2; the weights sum to 1.
fn gauss(half: &'static [(f64, f64)]) -> impl Iterator<Item = (f64, f64)> + Clone {
    half.iter()
        .flat_map(|(node, weight)| [(-node / 2.0, weight / 2.0), (node / 2.0, weight / 2.0)])
}

/// The same with the interval cut into so many parts.
fn in_parts(half: &'static [(f64, f64)], parts: u32) -> impl Iterator<Item = (f64, f64)> + Clone {
    let part = 1.0 / f64::from(parts);
    (0..parts).flat_map(move |index| {
        let middle = (f64::from(index) + 0.5) * part - 0.5;
        gauss(half).map(move |(node, weight)| (middle + node * part, weight * part))
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
        &GAUSS_4
    } else if radius >= 1.0 {
        &GAUSS_8
    } else {
        &GAUSS_12
    })
}

/// The same for `exact`: 4 x 4, 12 x 12 or 16 x 16 in each of so many `parts` along both sides.
pub(crate) fn exact_square(radius: f64, parts: u32) -> impl Iterator<Item = (DVec2, f64)> {
    on_square(in_parts(exact_side(radius), parts))
}

fn exact_side(radius: f64) -> &'static [(f64, f64)] {
    if radius >= 2.0 {
        &GAUSS_4
    } else if radius >= 1.0 {
        &GAUSS_12
    } else {
        &GAUSS_16
    }
}

/// How many parts the square takes where a pixel sees so many periods of a grating across it: each has six points.
pub(crate) fn parts(radius: f64, periods: f64) -> u32 {
    let points = 2.0 * exact_side(radius).len() as f64;
    (6.0 * periods / points).ceil().clamp(1.0, MOST_PARTS) as u32
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
    on_disc(gauss(&GAUSS_8), 24)
}

/// The same for `exact`: 12 x 36, so many times as many each way.
pub(crate) fn exact_disc(parts: u32) -> impl Iterator<Item = (DVec2, f64)> {
    on_disc(in_parts(&GAUSS_12, parts), 36 * parts)
}

fn on_disc(
    rings: impl Iterator<Item = (f64, f64)>,
    turn: u32,
) -> impl Iterator<Item = (DVec2, f64)> {
    rings.flat_map(move |(node, weight)| {
        let distance = sqrt(node + 0.5);
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
    [-GAUSS_2, GAUSS_2].map(|node| {
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
