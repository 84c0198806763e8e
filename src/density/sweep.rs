//! What is met on the way down.

/// Which of many spans, sorted by where they begin, meet a stretch that only ever moves on.
#[derive(Debug, Default)]
pub(super) struct Sweep {
    /// How many have been reached, and those of them that have not been left behind.
    reached: usize,
    active: Vec<u32>,
}

impl Sweep {
    /// Back to where it began.
    pub(super) fn rewind(&mut self) {
        self.reached = 0;
        self.active.clear();
    }

    /// Moves on to what lies between two heights; `span` tells where each of `all` begins and ends.
    #[inline(always)]
    pub(super) fn go_to<T>(
        &mut self,
        all: &[T],
        [low, high]: [f64; 2],
        span: impl Fn(&T) -> [f64; 2],
    ) {
        while let Some([begin, end]) = all.get(self.reached).map(&span)
            && begin < high
        {
            if end > low {
                self.active.push(self.reached as u32);
            }
            self.reached += 1;
        }
        self.active
            .retain(|&index| span(&all[index as usize])[1] > low);
    }

    /// The numbers of those that are met.
    #[inline(always)]
    pub(super) fn active(&self) -> &[u32] {
        &self.active
    }

    /// The first that has not been reached.
    #[inline(always)]
    pub(super) fn ahead<'a, T>(&self, all: &'a [T]) -> Option<&'a T> {
        all.get(self.reached)
    }
}
