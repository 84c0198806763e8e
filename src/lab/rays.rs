//! Samples of the light's disc that are the same on every machine.

use core::f64::consts::FRAC_PI_4;

use glam::DVec2;
use libm::{cos, sin};

/// A number from 0 to before 1 that only its two indices decide (Steele, Lea & Flood 2014, `SplitMix`).
pub(super) fn number(stream: u64, index: u64) -> f64 {
    let mut bits = stream
        .wrapping_mul(0xd134_2543_de82_ef95)
        .wrapping_add(index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// A point of the unit square as a point of the unit disc: equal areas stay equal (Shirley & Chiu 1997).
pub(super) fn on_disc(square: DVec2) -> DVec2 {
    let p = square * 2.0 - 1.0;
    if p == DVec2::ZERO {
        return p;
    }
    let (distance, angle) = if p.x.abs() > p.y.abs() {
        (p.x, FRAC_PI_4 * (p.y / p.x))
    } else {
        (p.y, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (p.x / p.y))
    };
    DVec2::new(cos(angle), sin(angle)) * distance
}

/// As many points of the unit disc as fit into a square number of at most `count` equal cells, each at a place of its own
/// in its cell.
pub(super) fn stratified(count: u32) -> Vec<DVec2> {
    let side = count.isqrt().max(1);
    (0..side * side)
        .map(|cell| {
            let corner = DVec2::new(f64::from(cell % side), f64::from(cell / side));
            let within = DVec2::new(number(1, u64::from(cell)), number(2, u64::from(cell)));
            on_disc((corner + within) / f64::from(side))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_fill_the_disc_evenly() {
        let points = stratified(4096);
        assert_eq!(points.len(), 4096);
        let mean = points.iter().sum::<DVec2>() / 4096.0;
        assert!(mean.length() < 0.01, "{mean}");
        // A uniform disc's mean square distance is 1/2.
        let square = points.iter().map(|p| p.length_squared()).sum::<f64>() / 4096.0;
        assert!((square - 0.5).abs() < 0.01, "{square}");
        assert!(points.iter().all(|p| p.length() <= 1.0));
    }
}
