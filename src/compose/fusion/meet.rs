//! Where casters meet: by how much more they hold back together than their densities tell one by one.

use core::ops::Range;
use std::collections::BTreeMap;

use fearless_simd::Level;
use glam::DVec2;

use super::chords::{Chords, Lane, Part};
use super::company::{Company, Together};
use super::hard::Hard;
use super::member::{Kind, Member};
use super::occluder::{NearRows, Occluder};
use super::pixel::{Pixels, Seen};
use super::wedge::Wedge;
use crate::density::lanes::LANES;

/// The sine of the largest angle between parallel lines.
const PARALLEL: f64 = 1e-6;

/// A density that is as good as 0, and as far from 1 as good as 1.
const NOTHING: f32 = 1e-4;

/// What is near is found for so many rows at once.
const ROWS: f64 = 8.0;

/// Chords are placed for so many times the pixels that are worked on together, where each of these is one point.
const BLOCKS: i64 = 4;

/// How the only two lines that a disc meets run.
#[derive(Debug, Clone, Copy)]
enum Lines {
    /// Parallel: one caster hides what the other does, or what it does not.
    FaceOneWay,
    FaceEachOther,
    Cross(Wedge),
}

/// The companies of a group's members that pixels have shown so far.
pub(super) type Companies<'a> = BTreeMap<Seen, Company<'a>>;

/// Memory to follow the light where casters meet.
#[derive(Debug, Default)]
pub(super) struct Meet {
    chords: Chords,
    /// For each member what discs about points of some rows may meet, and where these rows are.
    near: Vec<NearRows>,
    near_rows: Range<f64>,
    /// Of the pixels that are worked on together: what their companies hold back together or what both of a pair hide, and what
    /// each that hides a part of the disc hides, altogether and in one row of points.
    together: Lane,
    densities: Vec<Lane>,
    of_row: Vec<Lane>,
    hidden: Vec<f32>,
    /// What both of a pair hide from some pixels that see one line of each.
    shared: Lane,
    hard: Hard,
}

impl Meet {
    /// Mends the pixels of a row, the first of which begins at `start`, from which several members hide a part of the disc.
    pub(super) fn mend<'a>(
        &mut self,
        level: Level,
        members: &'a [Member],
        companies: &mut Companies<'a>,
        start: DVec2,
        pixels: &mut Pixels,
        row: Range<usize>,
    ) {
        let mut rest = row.clone();
        while let Some((seen, run)) = pixels.next_shared(rest.clone()) {
            rest.start = run.end;
            let company = companies
                .entry(seen)
                .or_insert_with(|| Company::of(pixels.casts(seen), members));
            if matches!(company.together, Together::Alone) {
                continue;
            }
            let middle = start + DVec2::new((run.start - row.start) as f64, 0.0) + 0.5;
            if company.is_hard {
                self.mend_hard(company, middle, pixels, run);
                continue;
            }
            if !self.near_rows.contains(&start.y) {
                self.find_near(members, start.y);
            }
            self.mend_run(level, company, middle, pixels, run);
        }
    }

    /// Forgets the members of other pixels.
    pub(super) fn begin(&mut self) {
        self.near_rows = 0.0..0.0;
    }

    /// Finds what of the members is near some rows, the first of which begins at height `y`.
    fn find_near(&mut self, members: &[Member], y: f64) {
        self.near_rows = y..y + ROWS;
        self.near.iter_mut().for_each(NearRows::clear);
        if self.near.len() < members.len() {
            self.near.resize_with(members.len(), NearRows::default);
        }
        for (member, near) in members.iter().zip(&mut self.near) {
            if let Kind::Level(occluder) = &member.kind {
                occluder.near_rows(y..y + ROWS, near);
            }
        }
    }

    /// Mends pixels that see hard borders alone, the first of which has its middle there.
    fn mend_hard(
        &mut self,
        company: &Company<'_>,
        middle: DVec2,
        pixels: &mut Pixels,
        run: Range<usize>,
    ) {
        for (index, pixel) in run.enumerate() {
            let at = middle + DVec2::new(index as f64, 0.0);
            self.hard.find(&company.partial, at);
            let Hard { alone, united, .. } = &self.hard;
            let more = match &company.together {
                Together::Pair { cross, is_known } => {
                    let [a, b] = if *is_known {
                        pixels.densities(pixel)
                    } else {
                        [alone[0] as f32, alone[1] as f32]
                    };
                    let shared = alone[0] + alone[1] - united[1];
                    cross * (shared as f32 - a * b)
                }
                Together::Opaque { weights, always } => {
                    let united = united.iter().map(|&united| united as f32);
                    let counted = united.zip(weights).map(|(united, weight)| united * weight);
                    let together = always + counted.sum::<f32>();
                    let apart = alone.iter().map(|&alone| alone as f32);
                    together - company.held(apart, &mut self.hidden)
                }
                Together::Alone | Together::Any => 0.0,
            };
            pixels.mend(pixel, more);
        }
    }

    /// Mends pixels of one company, the first of which has its middle there.
    fn mend_run(
        &mut self,
        level: Level,
        company: &Company<'_>,
        middle: DVec2,
        pixels: &mut Pixels,
        run: Range<usize>,
    ) {
        let square = &company.square;
        let lanes = square.pixels as i64;
        let blocks = if square.is_wide() { BLOCKS } else { 1 };
        // Which pixels are worked on together does not depend on what is asked for, nor on what is far away: nor do the bits of what
        // is found.
        let (mut origin, mut origin_until) = (middle.floor(), f64::MIN);
        let (mut known, mut placed) = (None, None);
        let (mut lines, mut until) = (None, f64::MIN);
        let mut crossed = 0..0;
        let count = run.len();
        for (index, pixel) in run.enumerate() {
            let at = middle + DVec2::new(index as f64, 0.0);
            if at.x >= until {
                (lines, until) = self.lines(company, at);
                crossed = 0..0;
            }
            let pair = match company.together {
                Together::Pair { cross, is_known } if is_known => Some(cross),
                _ => None,
            };
            let [a, b] = pixels.densities(pixel);
            if let (Some(cross), Some(lines)) = (pair, lines) {
                let shared = match lines {
                    Lines::FaceOneWay => a.min(b),
                    Lines::FaceEachOther => (a + b - 1.0).max(0.0),
                    Lines::Cross(wedge) => {
                        if !crossed.contains(&index) {
                            crossed = index..(index + LANES).min(count);
                            wedge.shared(level, middle, crossed.clone(), &mut self.shared);
                        }
                        self.shared[index - crossed.start]
                    }
                };
                pixels.mend(pixel, cross * (shared - a * b));
                continue;
            }
            if at.x >= origin_until {
                (origin, origin_until) = self.origin(company, at);
                (known, placed) = (None, None);
            }
            let number = (at.x - origin.x).floor() as i64;
            let lane = number.rem_euclid(lanes);
            let first = number - lane;
            if known != Some(first) {
                known = Some(first);
                let asked = lane as usize..lanes.min(lane + (count - index) as i64) as usize;
                let behind = first.rem_euclid(blocks * lanes);
                let start = at - DVec2::new((behind + lane) as f64, 0.0);
                if blocks > 1 && placed != Some(first - behind) {
                    placed = Some(first - behind);
                    self.place(company, start, 0.0, (blocks * lanes) as usize);
                }
                self.follow(level, company, start, behind as f32, asked);
            }
            let lanes = lane as usize * square.per_pixel..(lane as usize + 1) * square.per_pixel;
            let weights = &square.weights[lanes.clone()];
            let average = |of: &Lane| -> f32 {
                let of = of[lanes.clone()].iter().zip(weights);
                of.map(|(value, weight)| value * weight).sum()
            };
            let together = average(&self.together);
            let more = match company.together {
                Together::Pair { cross, is_known } => {
                    let [a, b] = if is_known {
                        [a, b]
                    } else {
                        [0, 1].map(|of| average(&self.densities[of]))
                    };
                    cross * (together - a * b)
                }
                _ => {
                    let apart = self.densities.iter().map(average);
                    together - company.held(apart, &mut self.hidden)
                }
            };
            pixels.mend(pixel, more);
        }
    }

    /// A whole pixel from which those are counted that are worked on together, and up to which x to the right of a point it is that.
    fn origin(&self, company: &Company<'_>, at: DVec2) -> (DVec2, f64) {
        let (origin, until) = match company
            .partial
            .first()
            .map(|of| (of.index, &of.member.kind))
        {
            Some((index, Kind::Level(occluder))) => occluder.origin(&self.near[index], at),
            // Of tilted casters each pixel is alone.
            _ => (None, f64::MAX),
        };
        (origin.unwrap_or(at.floor()), until)
    }

    /// How the lines run, where the disc about a point shows a single one of each of a pair; and up to which x to the right of the
    /// point that stays so.
    fn lines(&self, company: &Company<'_>, at: DVec2) -> (Option<Lines>, f64) {
        let [a, b] = *company.partial else {
            return (None, f64::MAX);
        };
        if company.square.per_pixel > 1 {
            return (None, f64::MAX);
        }
        let [(a, until_a), (b, until_b)] = [a, b].map(|of| match &of.member.kind {
            Kind::Level(occluder) => occluder.single_line(&self.near[of.index], at),
            Kind::Tilted(_) => (None, f64::MAX),
        });
        let lines = a.zip(b).map(|(a, b)| {
            if a.along.perp_dot(b.along).abs() > PARALLEL {
                Lines::Cross(Wedge::new([a, b]))
            } else if a.along.dot(b.along) > 0.0 {
                Lines::FaceOneWay
            } else {
                Lines::FaceEachOther
            }
        });
        (lines, until_a.min(until_b))
    }

    /// Follows the light to the pixels that are worked on together, the first of which is so many pixels `behind` one that has its
    /// middle there. Only of some of them it is asked what they see.
    fn follow(
        &mut self,
        level: Level,
        company: &Company<'_>,
        middle: DVec2,
        behind: f32,
        asked: Range<usize>,
    ) {
        let square = &company.square;
        let mut points = square.points;
        points.pixels.iter_mut().for_each(|pixel| *pixel += behind);
        let count = company.partial.len();
        self.together = [0.0; LANES];
        for densities in [&mut self.densities, &mut self.of_row] {
            densities.clear();
            densities.resize(count, [0.0; LANES]);
        }
        let mut together = [0.0; LANES];
        for &(height, weight) in &square.rows {
            let add = |sum: &mut Lane, of_row: &Lane| {
                for (sum, of_row) in sum.iter_mut().zip(of_row) {
                    *sum += weight * of_row;
                }
            };
            if !square.is_wide() {
                self.place(company, middle, height, square.pixels);
            }
            let is_known = matches!(company.together, Together::Pair { is_known, .. } if is_known);
            if !is_known {
                let densities = self.densities.iter_mut().zip(&mut self.of_row);
                for (caster, (densities, of_row)) in densities.enumerate() {
                    self.chords.density(level, caster, &points, of_row);
                    add(densities, of_row);
                }
            }
            match &company.together {
                Together::Alone => {}
                Together::Pair { .. } => {
                    let chords = &self.chords;
                    chords.shared(level, [0, 1], &points, &mut together);
                }
                Together::Opaque { weights, always } => {
                    let chords = &mut self.chords;
                    chords.united(level, weights, &points, &mut together);
                    together.iter_mut().for_each(|held| *held += always);
                }
                Together::Any => {
                    let hidden = &mut self.hidden;
                    for lane in asked.start * square.per_pixel..asked.end * square.per_pixel {
                        let densities = self.of_row.iter().map(|of| of[lane]);
                        let is_partial =
                            |density: &f32| *density > NOTHING && *density < 1.0 - NOTHING;
                        together[lane] = if densities.clone().filter(is_partial).count() < 2 {
                            company.held(densities, hidden)
                        } else {
                            self.chords.held(&points, lane, |inside| {
                                company.held(inside.iter().copied(), hidden)
                            })
                        };
                    }
                }
            }
            add(&mut self.together, &together);
        }
    }

    /// Finds the chords of a row of points: of so many pixels the first of which has its middle there, at that height in their
    /// squares.
    fn place(&mut self, company: &Company<'_>, middle: DVec2, height: f64, pixels: usize) {
        let width = (pixels - 1) as f64;
        let mut parts = Vec::new();
        let mut seen: Vec<(usize, Occluder)> = Vec::new();
        for (caster, of) in company.partial.iter().enumerate() {
            let side = of.member.averaged_side();
            let up = DVec2::new(0.0, height * side);
            match &of.member.kind {
                Kind::Level(occluder) => {
                    let loops = self.near[of.index].loops().iter();
                    let all = loops.map(|of_loop| Part {
                        caster,
                        of_loop,
                        radius: occluder.radius,
                        side,
                        at: middle + up - of_loop.base,
                        width,
                    });
                    parts.extend(all.filter(Part::is_near));
                }
                Kind::Tilted(loops) => seen.push((caster, Occluder::seen_from(middle, loops))),
            }
        }
        // Seen from a point, on its unit disc: it sees them through no square.
        for (caster, seen) in &seen {
            parts.extend(seen.loops().iter().map(|of_loop| Part {
                caster: *caster,
                of_loop,
                radius: seen.radius,
                side: 0.0,
                at: -of_loop.base,
                width,
            }));
        }
        self.chords.place(company.partial.len(), &parts);
    }
}
