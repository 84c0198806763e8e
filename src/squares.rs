//! How many ends of an outline's edges are near each other.

use glam::DVec2;

/// Memory for the squares that ends are counted by.
#[derive(Debug, Default)]
pub(crate) struct Crowd {
    /// Each square's ends where its name says or behind that, and none where there is room.
    squares: Vec<Square>,
}

#[derive(Debug, Default, Clone, Copy)]
struct Square {
    name: u64,
    ends: u32,
}

/// Places for each square, so that few are looked at for one.
const ROOM: usize = 2;

impl Crowd {
    /// No fewer than the most ends that a square of that side, along the axes, holds about one of them. They are counted from a corner of
    /// what they are the ends of: where it is changes nothing.
    pub(crate) fn most(&mut self, ends: impl Iterator<Item = DVec2> + Clone, side: f64) -> u32 {
        let count = ends.clone().count();
        self.squares.clear();
        self.squares
            .resize((ROOM * count).next_power_of_two(), Square::default());
        let square = |end: DVec2| (end * (2.0 / side)).floor().to_array().map(|v| v as i64);
        for end in ends.clone() {
            let found = self.find(square(end));
            found.ends += 1;
        }
        let mut about = |end: DVec2| {
            let [x, y] = square(end);
            let near = (-1..=1).flat_map(|down| (-1..=1).map(move |right| [x + right, y + down]));
            near.map(|square| self.find(square).ends).sum()
        };
        ends.map(&mut about).max().unwrap_or(0)
    }

    /// The place of a square.
    fn find(&mut self, [x, y]: [i64; 2]) -> &mut Square {
        // Squares 2^32 apart are one, which counts too many.
        let name = (x as u64) << 32 | (y as u64 & 0xffff_ffff);
        let last = self.squares.len() - 1;
        let mut at = (name.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & last;
        while self.squares[at].ends > 0 && self.squares[at].name != name {
            at = (at + 1) & last;
        }
        let square = &mut self.squares[at];
        square.name = name;
        square
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_square_about_an_end_holds_more() {
        let mut crowd = Crowd::default();
        let ends: Vec<DVec2> = (0..400_u32)
            .map(|i| {
                let [x, y] = [7919, 104_729].map(|step| f64::from(i * step % 1000) / 50.0);
                DVec2::new(x, y * y / 20.0)
            })
            .collect();
        let mut last = 0;
        for side in [0.1, 0.7, 2.3, 9.0] {
            let most = crowd.most(ends.iter().copied(), side);
            let held = |at: &DVec2| {
                let near = ends
                    .iter()
                    .filter(|end| (**end - *at).abs().max_element() <= side / 2.0);
                near.count() as u32
            };
            let truth = ends.iter().map(held).max().unwrap();
            assert!(most >= truth, "{side}: {most} of {truth}");
            assert!(most >= last);
            last = truth;
        }
        // Far from each other they are no crowd, however many there are.
        let apart = (0..400_u32).map(|i| DVec2::new(f64::from(i % 20), f64::from(i / 20)) * 10.0);
        assert!(crowd.most(apart, 1.0) < 8);
        assert_eq!(crowd.most(core::iter::empty(), 1.0), 0);
    }
}
