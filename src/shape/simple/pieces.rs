//! Contours cut into pieces, and whether these are apart.
//!
//! Each piece has a bound on how far it may be from its chord and on where it may head. Two
//! pieces are apart when their chords are farther from each other than they may be from these, and pieces of one contour
//! also when no piece from the one to the other heads back: what moves within a half plane of directions never meets
//! itself. That settles neighbours, whose chords touch.

use core::ops::Range;

use glam::DVec2;

use crate::apart::around_points;
use crate::outline::winding;
use crate::path::{Contour, Curve, Part, Segment};

/// More pieces than this are not looked through.
const MOST_PIECES: usize = 1 << 17;

/// How often pieces are compared at most, and contours and their pieces looked through for how they wind: some hundredths of a second each.
const MOST_COMPARISONS: usize = 1 << 24;

/// A curve's fewest pieces.
const FEWEST: u32 = 4;

/// The pieces from one to another that are looked through for whether they head back.
const LONGEST_CHAIN: usize = 8;

/// What rounding may hide, over the largest coordinate.
const ROUNDING: f64 = 1e-12;

/// The pieces of all contours, one contour after the other.
pub(super) struct Pieces {
    pieces: Vec<Piece>,
    /// Which pieces are a contour's, and a box that holds their chords.
    contours: Vec<(Range<usize>, DVec2, DVec2)>,
    /// What rounding may hide.
    tiny: f64,
    /// Along which they are sorted: the longer one.
    axis: usize,
}

/// A piece of a contour.
struct Piece {
    contour: usize,
    from: DVec2,
    to: DVec2,
    /// How far it may be from its chord.
    reach: f64,
    headings: Headings,
    /// A box that holds it.
    min: DVec2,
    max: DVec2,
}

/// A piece that the sweep has come to: its box, as far as the sweep asks for it.
#[derive(Clone, Copy)]
struct Open {
    index: usize,
    /// Where it ends along the sweep, and what it takes across.
    end: f64,
    least: f64,
    most: f64,
}

impl Open {
    fn new(index: usize, piece: &Piece, axis: usize) -> Self {
        Self {
            index,
            end: piece.max[axis],
            least: piece.min[1 - axis],
            most: piece.max[1 - axis],
        }
    }

    /// Whether its box meets another's, which the sweep has come to as well.
    fn meets(&self, other: &Self) -> bool {
        self.least <= other.most && other.least <= self.most
    }
}

/// The directions from one counter-clockwise to another, less than half a turn further on.
#[derive(Clone, Copy)]
struct Headings {
    first: DVec2,
    last: DVec2,
}

impl Headings {
    /// Of given directions, or none if there are none or they take half a turn or nearly so.
    fn of(directions: impl IntoIterator<Item = DVec2>) -> Option<Self> {
        let mut directions = directions.into_iter();
        let first = directions.next()?;
        let one = Self { first, last: first };
        directions.try_fold(one, Self::with)
    }

    fn with(self, direction: DVec2) -> Option<Self> {
        let Self { first, last } = self;
        let after_first = first.perp_dot(direction);
        let before_last = direction.perp_dot(last);
        let ahead = first.dot(direction) > 0.0 || last.dot(direction) > 0.0;
        if after_first >= 0.0 && before_last >= 0.0 {
            ahead.then_some(self)
        } else if before_last < 0.0 {
            is_left(first, direction).then_some(Self {
                first,
                last: direction,
            })
        } else {
            is_left(direction, last).then_some(Self {
                first: direction,
                last,
            })
        }
    }
}

/// Whether the way from one direction to another counter-clockwise is less than half a turn, and not nearly that.
fn is_left(from: DVec2, to: DVec2) -> bool {
    let (across, along) = (from.perp_dot(to), from.dot(to));
    across > 0.0 && (along > 0.0 || across > -1e-6 * along)
}

impl Piece {
    fn of_line(contour: usize, from: DVec2, to: DVec2, tiny: f64) -> Option<Self> {
        Self::new(contour, [from, to], [to - from], 0.0, tiny)
    }

    fn of_part(contour: usize, part: &Part, tiny: f64) -> Option<Self> {
        // A hundredth more than a cubic needs is enough for the arc that it may stand for.
        const ARC: f64 = 1.01;
        let [first, middle, last] = part.legs();
        let bend = (middle - first).length().max((last - middle).length());
        let ends = [part.from, part.to];
        Self::new(contour, ends, part.legs(), 0.75 * ARC * bend, tiny)
    }

    /// None if it may head back.
    fn new<const N: usize>(
        contour: usize,
        [from, to]: [DVec2; 2],
        legs: [DVec2; N],
        reach: f64,
        tiny: f64,
    ) -> Option<Self> {
        Some(Self {
            contour,
            from,
            to,
            reach,
            min: from.min(to) - reach - tiny,
            max: from.max(to) + reach + tiny,
            headings: Headings::of(legs.into_iter().filter(|leg| leg.length() > tiny))?,
        })
    }
}

impl Pieces {
    /// Pieces within `reach` times the extent of their chords, or none if there are too many or one may head back.
    pub(super) fn new(
        contours: &[Contour],
        (min, max): (DVec2, DVec2),
        reach: f64,
    ) -> Option<Self> {
        let size = max - min;
        let mut pieces = Self {
            pieces: Vec::new(),
            contours: Vec::with_capacity(contours.len()),
            tiny: ROUNDING * min.abs().max(max.abs()).max_element(),
            axis: usize::from(size.y > size.x),
        };
        for contour in contours {
            pieces.push(contour, reach * size.max_element())?;
        }
        Some(pieces)
    }

    fn push(&mut self, contour: &Contour, reach: f64) -> Option<()> {
        let (first, index) = (self.pieces.len(), self.contours.len());
        let closing = Segment::Line(contour.start);
        let mut from = contour.start;
        for segment in contour.segments.iter().chain([&closing]) {
            if let Some(curve) = Curve::new(from, segment) {
                let count = (curve.sagitta() / reach).sqrt().ceil();
                let count = count.max(f64::from(FEWEST.max(curve.fewest_parts())));
                if count + self.pieces.len() as f64 > MOST_PIECES as f64 {
                    return None;
                }
                for part in curve.parts(count as u32) {
                    self.pieces.push(Piece::of_part(index, &part, self.tiny)?);
                }
            } else if (segment.end() - from).length() > self.tiny {
                let line = Piece::of_line(index, from, segment.end(), self.tiny)?;
                self.pieces.push(line);
            } else {
                // The next piece begins where this one does, so that the chords stay closed.
                continue;
            }
            from = segment.end();
        }
        let own = self.pieces.get_mut(first..)?;
        own.last_mut()?.to = contour.start;
        let (min, max) = around_points(own.iter().map(|piece| piece.to))?;
        self.contours.push((first..self.pieces.len(), min, max));
        (self.pieces.len() <= MOST_PIECES).then_some(())
    }

    /// Whether no two pieces meet but where the contour goes on from one to the other.
    pub(super) fn are_apart(&self) -> bool {
        let axis = self.axis;
        let mut order: Vec<usize> = (0..self.pieces.len()).collect();
        let low = |index: usize| self.pieces[index].min[axis];
        order.sort_unstable_by(|&a, &b| low(a).total_cmp(&low(b)));
        let mut left = MOST_COMPARISONS;
        // The pieces that the sweep has come to and not left yet.
        let mut open: Vec<Open> = Vec::new();
        for index in order {
            let start = low(index);
            open.retain(|other| other.end >= start);
            let next = Open::new(index, &self.pieces[index], axis);
            let meets = |other: &Open| other.meets(&next) && self.may_meet(other.index, index);
            if open.len() > left || open.iter().any(meets) {
                return false;
            }
            left -= open.len();
            open.push(next);
        }
        true
    }

    /// Whether two pieces whose boxes meet may do so.
    fn may_meet(&self, a: usize, b: usize) -> bool {
        let (one, other) = (&self.pieces[a], &self.pieces[b]);
        let goes_on = || one.contour == other.contour && self.goes_on(a.min(b), a.max(b));
        !(one.is_apart_from(other, self.tiny) || goes_on())
    }

    /// Whether no piece on one of the two ways between two pieces of a contour heads back.
    fn goes_on(&self, a: usize, b: usize) -> bool {
        let contour = &self.contours[self.pieces[a].contour].0;
        let ways = [(a..b + 1, 0..0), (b..contour.end, contour.start..a + 1)];
        ways.into_iter().any(|(first, second)| {
            first.len() + second.len() <= LONGEST_CHAIN && {
                let mut chain = first.chain(second).map(|index| self.pieces[index].headings);
                chain.next().is_some_and(|one| {
                    chain
                        .try_fold(one, |all, next| all.with(next.first)?.with(next.last))
                        .is_some()
                })
            }
        })
    }

    fn of(&self, contour: usize) -> &[Piece] {
        &self.pieces[self.contours[contour].0.clone()]
    }

    /// 1 if a contour turns left as a whole, -1 if it turns right.
    pub(super) fn turn(&self, contour: usize) -> i32 {
        let pieces = self.of(contour);
        let origin = pieces[0].from;
        let double_area: f64 = pieces
            .iter()
            .map(|piece| (piece.from - origin).perp_dot(piece.to - origin))
            .sum();
        if double_area < 0.0 { -1 } else { 1 }
    }

    /// How often all other contours wind round each contour, or none where that would be too much to look through: as often round one of
    /// its points as round any other, and as their chords do, since it is nowhere between these and the contours.
    pub(super) fn windings(&self) -> Option<Vec<i32>> {
        let pairs = self.contours.len().checked_pow(2)?;
        let mut left = MOST_COMPARISONS.checked_sub(pairs)?;
        let all = 0..self.contours.len();
        let round = all.map(|contour| {
            let point = self.of(contour)[0].from;
            let others = self.contours.iter().enumerate();
            let about = others.filter(|&(other, (_, min, max))| {
                other != contour && point.cmpge(*min).all() && point.cmple(*max).all()
            });
            about
                .map(|(other, _)| {
                    let chords = self.of(other).iter();
                    left = left.checked_sub(chords.len())?;
                    Some(winding(chords.map(|piece| (piece.from, piece.to)), point))
                })
                .sum()
        });
        round.collect()
    }
}

impl Piece {
    fn is_apart_from(&self, other: &Self, tiny: f64) -> bool {
        let most = self.reach + other.reach + tiny;
        !self.crosses(other)
            && self.distance_squared(other.from) > most * most
            && self.distance_squared(other.to) > most * most
            && other.distance_squared(self.from) > most * most
            && other.distance_squared(self.to) > most * most
    }

    fn crosses(&self, other: &Self) -> bool {
        let side = |piece: &Self, p: DVec2| (piece.to - piece.from).perp_dot(p - piece.from) > 0.0;
        side(self, other.from) != side(self, other.to)
            && side(other, self.from) != side(other, self.to)
    }

    /// The square of the distance from its chord.
    fn distance_squared(&self, p: DVec2) -> f64 {
        let (chord, from) = (self.to - self.from, p - self.from);
        let along = (from.dot(chord) / chord.length_squared()).clamp(0.0, 1.0);
        (from - chord * along).length_squared()
    }
}
