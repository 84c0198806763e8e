//! What two straight borders that cross leave of the disc between them: closed form.
//!
//! Where the borders cross inside the disc it is the triangle-like part between the two ways from there to the disc's edge and
//! the arc from one end to the other. Where they do not, each border's whole chord is on one side of the other.

use core::f32::consts::FRAC_1_PI;
use core::ops::Range;

use fearless_simd::{Level, Select, Simd, SimdBase, SimdFloat, dispatch, f32x16};
use glam::{DVec2, Vec2};

use super::chords::Lane;
use crate::density::rows::{turns, whole_disc};

/// A straight border of a caster: what lies left of it hides the light, where y points up. In pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Border {
    /// A whole pixel, and a point of the border from there.
    pub(super) base: DVec2,
    pub(super) from: DVec2,
    /// Its unit vector.
    pub(super) along: DVec2,
    /// The caster's penumbra radius.
    pub(super) radius: f64,
}

impl Border {
    /// How far inside a point is, in penumbra radii.
    fn depth(&self, at: DVec2) -> f64 {
        self.along.perp_dot(at - self.base - self.from) / self.radius
    }
}

/// Two borders that cross.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wedge {
    borders: [Border; 2],
    /// Away from what each hides.
    normals: [Vec2; 2],
    /// Along each border into what the other hides, the second on the first one's left.
    ways: [Vec2; 2],
    /// By how much each border's depth moves the point where they cross.
    crossing: [Vec2; 2],
    cosine: f32,
}

/// Ends that rounding may have put in the other order are at most so far from each other, in turns: whether all of the disc's edge or
/// nothing of it lies between them is told by how much both hide at least and at most.
const SAME: f32 = 1e-5;

impl Wedge {
    /// Of borders that are not parallel.
    pub(super) fn new([a, b]: [Border; 2]) -> Self {
        let turn = a.along.perp_dot(b.along);
        let borders = if turn < 0.0 { [a, b] } else { [b, a] };
        let normals = borders.map(|border| -border.along.perp());
        let cosine = normals[0].dot(normals[1]);
        let crossing = [
            normals[0] - normals[1] * cosine,
            normals[1] - normals[0] * cosine,
        ];
        Self {
            borders,
            normals: normals.map(|v| v.as_vec2()),
            ways: [borders[0].along, -borders[1].along].map(|v| v.as_vec2()),
            crossing: crossing.map(|v| (v / (turn * turn)).as_vec2()),
            cosine: cosine as f32,
        }
    }

    /// The part of the disc that both hide from some points of a row, the first of which is there and the others a pixel apart.
    pub(super) fn shared(&self, level: Level, first: DVec2, points: Range<usize>, out: &mut Lane) {
        let mut depths: [Lane; 2] = Default::default();
        for (depths, border) in depths.iter_mut().zip(&self.borders) {
            for (depth, point) in depths.iter_mut().zip(points.clone()) {
                // Of the point itself: where others begin changes nothing.
                *depth = border.depth(first + DVec2::new(point as f64, 0.0)) as f32;
            }
        }
        let [a, b] = &depths;
        dispatch!(level, simd => simd.vectorize(#[inline(always)] || {
            let (a, b) = (f32x16::from_slice(simd, a), f32x16::from_slice(simd, b));
            self.shared_at(simd, a, b).store_slice(out);
        }));
    }

    /// Where one of the borders leaves the disc for what the other hides.
    #[inline(always)]
    fn end<S: Simd>(&self, simd: S, of: usize, depth: f32x16<S>) -> [f32x16<S>; 2] {
        let (normal, way) = (self.normals[of], self.ways[of]);
        let square = f32x16::splat(simd, 1.0) - depth * depth;
        let half = square.max(f32x16::splat(simd, 0.0)).sqrt();
        [
            depth * normal.x + half * way.x,
            depth * normal.y + half * way.y,
        ]
    }

    #[inline(always)]
    fn shared_at<S: Simd>(&self, simd: S, a: f32x16<S>, b: f32x16<S>) -> f32x16<S> {
        let splat = |v: f32| f32x16::splat(simd, v);
        let (zero, one) = (splat(0.0), splat(1.0));
        let (of_a, of_b) = (whole_disc(simd, a), whole_disc(simd, b));
        let least = (of_a + of_b - 1.0).max(zero);
        let most = of_a.min(of_b);

        let [c, d] = self.crossing;
        let (x, y) = (a * c.x + b * d.x, a * c.y + b * d.y);
        let p = self.end(simd, 0, a);
        let q = self.end(simd, 1, b);
        let arc = turns(simd, q[0], q[1]) - turns(simd, p[0], p[1]);
        let arc = arc.simd_lt(splat(-SAME)).select(arc + 1.0, arc);
        let sides = (x * (p[1] - q[1]) - y * (p[0] - q[0])) * (0.5 * FRAC_1_PI);
        let crossed = (sides + arc).max(least).min(most);

        // Whether each border's chord lies in what the other hides.
        let first_in = (a * self.cosine).simd_le(b);
        let second_in = (b * self.cosine).simd_le(a);
        let apart = first_in.select(second_in.select(least, of_a), second_in.select(of_b, zero));
        let inside = (x * x + y * y).simd_lt(one);
        inside.select(crossed, apart)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By counting points of the disc.
    fn counted(borders: &[Border; 2], at: DVec2) -> f64 {
        let (mut all, mut both) = (0.0, 0.0);
        for row in -200..200 {
            for column in -200..200 {
                let v = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5) / 200.0;
                if v.length() < 1.0 {
                    all += 1.0;
                    let is_hidden = |border: &Border| border.depth(at + v * border.radius) > 0.0;
                    both += f64::from(u8::from(borders.iter().all(is_hidden)));
                }
            }
        }
        both / all
    }

    #[test]
    fn what_both_hide_is_what_is_counted() {
        for number in 0..40 {
            let angle = |of: f64| DVec2::from_angle(of * f64::from(number + 1));
            let borders = [
                Border {
                    base: DVec2::ZERO,
                    from: DVec2::new(3.0, 1.0),
                    along: angle(2.4),
                    radius: 7.0,
                },
                Border {
                    base: DVec2::new(4.0, -3.0),
                    from: DVec2::new(-3.0, 1.0),
                    along: angle(0.71),
                    radius: 11.0,
                },
            ];
            let wedge = Wedge::new(borders);
            let first = DVec2::new(-13.5, f64::from(number % 7) - 3.5);
            for start in [0, 16] {
                let mut shared = [0.0; 16];
                wedge.shared(Level::new(), first, start..start + 16, &mut shared);
                for (point, found) in shared.into_iter().enumerate() {
                    let at = first + DVec2::new((start + point) as f64, 0.0);
                    let expected = counted(&borders, at);
                    assert!(
                        (f64::from(found) - expected).abs() < 2e-3,
                        "{number} {at}: {found}, {expected}"
                    );
                }
            }
        }
    }
}
