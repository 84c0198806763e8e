//! The upright sides of a rounded rectangle, strip by strip.

use core::ops::Range;

use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16};

use crate::density::lanes::{LANES, lanes};

/// Gauss's two nodes on 0 to 1: where in a strip its side is looked up.
const NODES: [f32; 2] = [0.211_324_87, 0.788_675_1];

/// A rectangle's corners on one of its sides, all in pixels from the first strip's top.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corners {
    /// Where the rectangle begins and ends.
    pub(super) top: f32,
    pub(super) bottom: f32,
    /// The upper corner's radius and the lower one's.
    pub(super) radii: [f32; 2],
}

/// Strips of one height, one after another: how far the two sides are drawn in, in pixels, and how much is covered.
#[derive(Debug, Default)]
pub(super) struct Strips {
    /// By side; at the first node, at the second, and on average.
    insets: [[Vec<f32>; 3]; 2],
    /// What is between the rectangle's top and bottom, as heights of the lowest strips.
    covers: Vec<f32>,
    steep: [i64; 2],
    /// Where each side's insets are: where both sides are alike, the first one's serve both.
    places: [usize; 2],
}

impl Strips {
    /// Computes `count` strips of the height of `high` lowest ones, which are `pitch` pixels high, from the `first` of
    /// those on.
    #[inline(always)]
    pub(super) fn set<S: Simd>(
        &mut self,
        simd: S,
        count: usize,
        [first, high]: [usize; 2],
        pitch: f32,
        sides: &[Corners; 2],
    ) {
        let count = count.next_multiple_of(LANES);
        let height = pitch * high as f32;
        let Self {
            insets,
            covers,
            places,
            ..
        } = self;
        *places = if sides[0] == sides[1] { [0, 0] } else { [0, 1] };
        for list in insets.iter_mut().flatten().chain([&mut *covers]) {
            list.resize(count, 0.0);
        }
        let splat = |v: f32| f32x16::splat(simd, v);
        let (zero, top, bottom) = (splat(0.0), splat(sides[0].top), splat(sides[0].bottom));
        let lanes = lanes(simd);
        for (block, covers) in covers.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
            let strip = lanes * high as f32 + (first + block * LANES * high) as f32;
            let start = (strip * pitch).max(top);
            let covered = ((strip * pitch + height).min(bottom) - start).max(zero);
            (covered * (1.0 / pitch)).store_slice(covers);
            for (insets, side) in insets.iter_mut().zip(sides).take(1 + places[1]) {
                let mut sum = zero;
                let place = block * LANES..(block + 1) * LANES;
                for node in 0..2 {
                    let y = start + covered * NODES[node];
                    let mut inset = zero;
                    let [upper, lower] = side.radii;
                    for (radius, depth) in [(upper, y - top), (lower, bottom - y)] {
                        // How far above the corner's middle.
                        let rise = (splat(radius) - depth).max(zero);
                        inset +=
                            splat(radius) - (splat(radius * radius) - rise * rise).max(zero).sqrt();
                    }
                    inset.store_slice(&mut insets[node][place.clone()]);
                    sum += inset;
                }
                (sum * 0.5).store_slice(&mut insets[2][place]);
            }
        }
    }

    /// Says up to which strip and from which on the sides are not nearly upright.
    pub(super) fn set_steep(&mut self, [upper, lower]: [i64; 2]) {
        let count = self.count();
        let upper = upper.clamp(0, count);
        self.steep = [upper, lower.clamp(upper, count)];
    }

    /// Where parts of the strips end, and where in each of its strips a side is to be looked up.
    #[inline(always)]
    pub(super) fn parts(&self) -> [(i64, &'static [Node]); 3] {
        let [upper, lower] = self.steep;
        [
            (upper, &[Node::Upper, Node::Lower]),
            (lower, &[Node::Average]),
            (self.count(), &[Node::Upper, Node::Lower]),
        ]
    }

    pub(super) fn count(&self) -> i64 {
        self.covers.len() as i64
    }

    /// The insets of a side and the covers of some strips.
    #[inline(always)]
    pub(super) fn of(&self, side: usize, node: Node, strips: Range<i64>) -> (&[f32], &[f32]) {
        let strips = strips.start as usize..strips.end as usize;
        let insets = &self.insets[self.places[side]][node as usize];
        (&insets[strips.clone()], &self.covers[strips])
    }
}

/// Where in a strip a side is looked up: at two nodes, or half-way between.
#[derive(Debug, Clone, Copy)]
pub(super) enum Node {
    Upper,
    Lower,
    Average,
}
