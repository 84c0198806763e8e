//! The lanes of vectors.

use fearless_simd::{Simd, SimdBase, SimdCombine, f32x4, f32x16};

/// Numbers that a kernel takes at once. It is the same on every machine, so that all round alike.
pub(crate) const LANES: usize = 16;

/// Each lane's own number, in a list: `from_fn` with a closure is not always inlined.
pub(crate) const NUMBERS: [f32; LANES] = {
    let mut numbers = [0.0; LANES];
    let mut lane = 0;
    while lane < LANES {
        numbers[lane] = lane as f32;
        lane += 1;
    }
    numbers
};

/// 0 to 15.
#[inline(always)]
pub(crate) fn lanes<S: Simd>(simd: S) -> f32x16<S> {
    f32x16::from_slice(simd, &NUMBERS)
}

/// A number for each row of a tile of four by four, at all of the row.
#[inline(always)]
pub(crate) fn spread<S: Simd>(simd: S, [a, b, c, d]: [f32; 4]) -> f32x16<S> {
    let row = |number: f32| f32x4::splat(simd, number);
    let (first, last) = (row(a).combine(row(b)), row(c).combine(row(d)));
    first.combine(last)
}

/// The last `count` of a list's first `end` values and what is behind them, or else 0, as one block.
#[inline(always)]
pub(crate) fn last_block<const SIZE: usize>(
    values: &[f32],
    end: usize,
    count: usize,
) -> [f32; SIZE] {
    let last = &values[end - count..];
    if let Some(block) = last.first_chunk() {
        return *block;
    }
    let mut block = [0.0; SIZE];
    block[..count].copy_from_slice(&last[..count]);
    block
}

/// Changes the first `count` bytes of `rest` as a block, of which `change` leaves all behind them as they are: in their place, or as a
/// copy where the block does not fit.
#[inline(always)]
pub(crate) fn change_block<const SIZE: usize>(
    rest: &mut [u8],
    count: usize,
    change: impl FnOnce(&mut [u8; SIZE]),
) {
    if let Some(block) = rest.first_chunk_mut() {
        change(block);
        return;
    }
    let (mut block, rest) = ([0; SIZE], &mut rest[..count]);
    block[..count].copy_from_slice(rest);
    change(&mut block);
    rest.copy_from_slice(&block[..count]);
}
