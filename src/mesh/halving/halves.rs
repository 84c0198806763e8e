//! Which sides are halved, and the triangles that result.

mod many;

use fearless_simd::Simd;

use super::SIDE;
use super::finer::{Finer, Spot, spot_key};
use super::tube::{Plane, Right, Tube};

/// Sample by sample, column and row.
type Place = [usize; 2];
/// A unit step along a row, a column or both.
type Way = [isize; 2];

/// The ways to the next samples.
const WAYS: [Way; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
const SLANTED_WAYS: [Way; 4] = [[1, 1], [-1, 1], [-1, -1], [1, -1]];

/// Finds triangles within a tube, the largest that halving comes by.
#[derive(Debug, Default)]
pub(super) struct Halves {
    /// Columns and rows of samples.
    size: Place,
    /// Whether the side is halved whose middle a sample is.
    halved: Vec<bool>,
    /// Whether all samples are the same in the square whose middle one is.
    flat: Vec<bool>,
    /// The triangles, by the [spots](spot_key) at their corners.
    pub(super) triangles: Vec<[u32; 3]>,
}

/// A triangle whose longest side is level or upright: the middle of that side, the way to the right angle, and how far that is
/// and the ends are.
#[derive(Debug, Clone, Copy)]
struct Straight {
    middle: Place,
    way: Way,
    half: usize,
}

impl Straight {
    /// The ends of the longest side and the right angle, in the order in which meshes turn.
    #[inline(always)]
    fn corners(&self) -> [Place; 3] {
        let Self { middle, way, half } = *self;
        let along = [way[1], -way[0]];
        [
            moved(middle, [-along[0], -along[1]], half),
            moved(middle, along, half),
            moved(middle, way, half),
        ]
    }

    /// The triangles that it is halved into.
    #[inline(always)]
    fn halves(&self) -> [Right; 2] {
        let along = [self.way[1].abs(), self.way[0].abs()];
        let right = |ways| Right {
            corner: self.middle,
            ways,
            legs: self.half,
        };
        let [x, y] = self.way;
        [
            right([x + along[0], y + along[1]]),
            right([x - along[0], y - along[1]]),
        ]
    }

    #[inline(always)]
    fn plane(&self, tube: &Tube) -> Plane {
        let [start, end, apex] = self.corners();
        let (start, end, apex) = (tube.at(start), tube.at(end), tube.at(apex));
        let corner = (start + end) / 2.0;
        let half = self.half as f32;
        // From start to end the way goes to the left of the way to the right angle.
        let along = (end - start) / (2.0 * half);
        let across = (apex - corner) / half;
        let [x, y] = [self.way[0] as f32, self.way[1] as f32];
        Plane {
            corner,
            growth: [along * y + across * x, across * y - along * x],
        }
    }
}

impl Right {
    /// The ends of the legs along a row and along a column.
    #[inline(always)]
    fn ends(&self) -> [Place; 2] {
        [
            moved(self.corner, [self.ways[0], 0], self.legs),
            moved(self.corner, [0, self.ways[1]], self.legs),
        ]
    }

    /// The right angle and the ends of the longest side, in the order in which meshes turn.
    #[inline(always)]
    fn corners(&self) -> [Place; 3] {
        let ends = self.ends();
        if self.ways[0] == self.ways[1] {
            [self.corner, ends[0], ends[1]]
        } else {
            [self.corner, ends[1], ends[0]]
        }
    }

    /// The triangles that it is halved into, if it can be, and the middle of its longest side.
    #[inline(always)]
    fn halves(&self) -> Option<(Place, [Straight; 2])> {
        let half = self.legs / 2;
        let [x, y] = self.ways;
        let straight = |leg, way| Straight {
            middle: moved(self.corner, leg, half),
            way,
            half,
        };
        let halves = [straight([x, 0], [0, y]), straight([0, y], [x, 0])];
        (half > 0).then(|| (moved(self.corner, self.ways, half), halves))
    }

    /// The spot in the middle of the longest side, if legs have a single sample.
    fn center(&self) -> Spot {
        [0, 1].map(|axis: usize| (2 * self.corner[axis]).wrapping_add_signed(self.ways[axis]))
    }

    #[inline(always)]
    fn plane(&self, tube: &Tube) -> Plane {
        let ends = self.ends();
        let corner = tube.at(self.corner);
        let leg = self.legs as f32;
        let [x, y] = [self.ways[0] as f32 * leg, self.ways[1] as f32 * leg];
        Plane {
            corner,
            growth: [
                (tube.at(ends[0]) - corner) / x,
                (tube.at(ends[1]) - corner) / y,
            ],
        }
    }
}

impl Halves {
    /// Chooses the sides to halve, from the smallest up: those of triangles that leave the tube, and those of which a half is
    /// halved.
    #[inline(always)]
    pub(super) fn choose<S: Simd>(&mut self, simd: S, tube: &Tube, finer: &Finer) {
        self.size = tube.size();
        let [columns, rows] = self.size;
        for marks in [&mut self.halved, &mut self.flat] {
            marks.clear();
            marks.resize(columns * rows, false);
        }
        self.choose_smallest(tube, finer);
        let mut side = 4;
        while side <= SIDE {
            let half = side / 2;
            for y in (half..rows).step_by(side) {
                for x in (half..columns).step_by(side) {
                    self.find_flat([x, y], half / 2);
                }
            }
            match side {
                4 => self.choose_many_straight::<S, 2>(simd, tube),
                8 => self.choose_many_straight::<S, 4>(simd, tube),
                _ => self.choose_each_straight(tube, half),
            }
            match side {
                4 => self.choose_many_slanted::<S, 4>(simd, tube),
                _ => self.choose_each_slanted(tube, side),
            }
            side *= 2;
        }
    }

    /// Chooses for all level and upright sides of twice `half` samples.
    #[inline(always)]
    fn choose_each_straight(&mut self, tube: &Tube, half: usize) {
        let [columns, rows] = self.size;
        for y in (0..rows).step_by(2 * half) {
            for x in (half..columns).step_by(2 * half) {
                self.choose_straight(tube, [x, y], [0, 1], half);
            }
        }
        for y in (half..rows).step_by(2 * half) {
            for x in (0..columns).step_by(2 * half) {
                self.choose_straight(tube, [x, y], [1, 0], half);
            }
        }
    }

    /// Chooses for the diagonals of all squares of `side` samples.
    #[inline(always)]
    fn choose_each_slanted(&mut self, tube: &Tube, side: usize) {
        let [columns, rows] = self.size;
        for y in (side / 2..rows).step_by(side) {
            for x in (side / 2..columns).step_by(side) {
                self.choose_slanted(tube, [x, y], side);
            }
        }
    }

    /// Chooses for sides of two samples and the diagonals of their squares, row by row: the middle is all that can be off, as
    /// the squares' sides have been looked at before.
    #[inline(always)]
    fn choose_smallest(&mut self, tube: &Tube, finer: &Finer) {
        let [columns, rows] = self.size;
        for y in 0..rows {
            let halved = &mut self.halved[y * columns..][..columns];
            if y % 2 == 0 {
                let row = tube.row(y);
                let inner = halved[1..].iter_mut().zip(row.densities.windows(3));
                for (x, (halved, beside)) in inner.enumerate() {
                    let middle = 0.5 * (beside[0] + beside[2]);
                    *halved = row.is_outside(x + 1, middle);
                }
            } else {
                let (above, row, below) = (tube.row(y - 1), tube.row(y), tube.row(y + 1));
                for (x, halved) in halved.iter_mut().enumerate() {
                    let middle = 0.5 * (above.densities[x] + below.densities[x]);
                    *halved = row.is_outside(x, middle);
                }
            }
        }
        finer.mark_beside(&mut self.halved);
        for y in (1..rows).step_by(2) {
            let (above, row, below) = (tube.row(y - 1), tube.row(y), tube.row(y + 1));
            for x in (1..columns).step_by(2) {
                let [_, from, to] = in_square([x, y], 2)[0].corners();
                let middle = 0.5 * (tube.at(from) + tube.at(to));
                let halved = row.is_outside(x, middle) || self.any([x, y], &WAYS, 1);
                self.halved[y * columns + x] = halved;
                let mut flat = true;
                for row in [&above, &row, &below] {
                    for density in &row.densities[x - 1..x + 2] {
                        flat &= *density == above.densities[x - 1];
                    }
                }
                self.flat[y * columns + x] = flat;
            }
        }
    }

    /// Finds whether a square is flat, by its quarters: their middles are so far on both ways from its own.
    #[inline(always)]
    fn find_flat(&mut self, middle: Place, quarter: usize) {
        let mut flat = true;
        for way in SLANTED_WAYS {
            flat &= self.is_flat(moved(middle, way, quarter));
        }
        self.flat[middle[1] * self.size[0] + middle[0]] = flat;
    }

    #[inline(always)]
    fn is_flat(&self, middle: Place) -> bool {
        self.flat[middle[1] * self.size[0] + middle[0]]
    }

    /// Chooses for a level or upright side, by its middle and a way across.
    #[inline(always)]
    fn choose_straight(&mut self, tube: &Tube, middle: Place, way: Way, half: usize) {
        let mut halved = self.any(middle, &SLANTED_WAYS, half / 2);
        for way in [way, [-way[0], -way[1]]] {
            let triangle = Straight { middle, way, half };
            if !halved && self.holds(middle, way, half) && !self.is_flat(moved(middle, way, half)) {
                let plane = triangle.plane(tube);
                halved = tube.excess_at(plane.corner, middle) > 0.0;
                for part in triangle.halves() {
                    halved = halved || tube.excess(plane, &part) > 0.0;
                }
            }
        }
        self.halved[middle[1] * self.size[0] + middle[0]] = halved;
    }

    /// Chooses for a square's diagonal.
    #[inline(always)]
    fn choose_slanted(&mut self, tube: &Tube, middle: Place, side: usize) {
        let mut halved = self.any(middle, &WAYS, side / 2);
        for triangle in in_square(middle, side) {
            if !halved && !self.is_flat(middle) {
                let plane = triangle.plane(tube);
                let [_, start, end] = triangle.corners();
                let density = 0.5 * (tube.at(start) + tube.at(end));
                halved =
                    tube.excess_at(density, middle) > 0.0 || tube.excess(plane, &triangle) > 0.0;
            }
        }
        self.halved[middle[1] * self.size[0] + middle[0]] = halved;
    }

    /// Whether a place so far on some way is on the lattice.
    #[inline(always)]
    fn holds(&self, from: Place, way: Way, by: usize) -> bool {
        let inside = |axis: usize| match way[axis] {
            1 => from[axis] + by < self.size[axis],
            -1 => from[axis] >= by,
            _ => true,
        };
        inside(0) && inside(1)
    }

    /// Whether any side is halved whose middle lies so far on one of the ways.
    #[inline(always)]
    fn any(&self, from: Place, ways: &[Way; 4], by: usize) -> bool {
        let mut any = false;
        for &way in ways {
            any |= self.holds(from, way, by) && self.is_halved(moved(from, way, by));
        }
        any
    }

    #[inline(always)]
    fn is_halved(&self, middle: Place) -> bool {
        self.halved[middle[1] * self.size[0] + middle[0]]
    }

    /// Collects the triangles that the shadow reaches.
    #[inline(always)]
    pub(super) fn collect(&mut self, tube: &Tube, finer: &Finer) {
        self.triangles.clear();
        let [columns, rows] = self.size;
        for y in (SIDE / 2..rows).step_by(SIDE) {
            for x in (SIDE / 2..columns).step_by(SIDE) {
                for triangle in in_square([x, y], SIDE) {
                    self.collect_right(tube, finer, &triangle);
                }
            }
        }
    }

    fn collect_right(&mut self, tube: &Tube, finer: &Finer, triangle: &Right) {
        match triangle.halves() {
            Some((middle, [first, second])) if self.is_halved(middle) => {
                self.collect_straight(tube, finer, &first);
                self.collect_straight(tube, finer, &second);
            }
            None if finer.is_halved(triangle.center()) => self.collect_finer(finer, triangle),
            _ => self.push(tube, triangle.corners(), &[*triangle]),
        }
    }

    fn collect_straight(&mut self, tube: &Tube, finer: &Finer, triangle: &Straight) {
        let halves = triangle.halves();
        if self.is_halved(triangle.middle) {
            for half in &halves {
                self.collect_right(tube, finer, half);
            }
        } else {
            self.push(tube, triangle.corners(), &halves);
        }
    }

    /// Keeps the halves of a triangle with legs of one sample, and theirs.
    fn collect_finer(&mut self, finer: &Finer, triangle: &Right) {
        let center = triangle.center();
        let [corner, next, last] = triangle.corners().map(|[x, y]| [2 * x, 2 * y]);
        let between = |a: Place, b: Place| [0, 1].map(|axis: usize| a[axis].midpoint(b[axis]));
        for [from, to] in [[corner, next], [last, corner]] {
            let middle = between(from, to);
            let sides = if finer.is_halved(middle) {
                &[[from, middle], [middle, to]][..]
            } else {
                &[[from, to]]
            };
            for &[from, to] in sides {
                let corners = [from, to, center];
                self.triangles
                    .push(corners.map(|spot| spot_key(spot, self.size)));
            }
        }
    }

    /// Keeps a triangle unless all of it, in its parts, is beside the shadow.
    fn push(&mut self, tube: &Tube, corners: [Place; 3], parts: &[Right]) {
        let [a, b, c] = corners;
        let dark = tube.at(a).max(tube.at(b)).max(tube.at(c)) > 0.0;
        if dark || parts.iter().any(|part| tube.is_reached(part)) {
            self.triangles
                .push(corners.map(|[x, y]| (y * self.size[0] + x) as u32));
        }
    }
}

/// Whether a square's right angles are up and down its rising diagonal: diagonals run between every other corner of the squares of one
/// size.
#[inline(always)]
fn is_rising(middle: Place, side: usize) -> bool {
    (middle[0] / side + middle[1] / side).is_multiple_of(2)
}

/// The halves of a square, by its middle.
#[inline(always)]
fn in_square(middle: Place, side: usize) -> [Right; 2] {
    let half = side / 2;
    let way = if is_rising(middle, side) {
        [1, -1]
    } else {
        [1, 1]
    };
    let back = [-way[0], -way[1]];
    let right = |way, ways| Right {
        corner: moved(middle, way, half),
        ways,
        legs: side,
    };
    [right(way, back), right(back, way)]
}

#[inline(always)]
fn moved(from: Place, way: Way, by: usize) -> Place {
    [
        from[0].wrapping_add_signed(way[0] * by as isize),
        from[1].wrapping_add_signed(way[1] * by as isize),
    ]
}
