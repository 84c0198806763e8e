//! Where casters meet: by how much more they hold back together than their densities tell one by one.

use core::ops::Range;
use std::borrow::Cow;

use fearless_simd::Level;
use glam::DVec2;

use super::chords::{BLOCK, Chords, Occluder, block_of};
use super::member::{Kind, Member};
use super::pixel::{Pixels, REST, Seen, bit};
use crate::density::quadrature;

/// What members hold back together where they hide these parts of the light one by one, and these are independent.
fn held(members: &[&Member], hidden: &[f32]) -> f32 {
    let (mut held, mut met) = (0.0, 0.0);
    for (member, hidden) in members.iter().zip(hidden) {
        let hides = member.opacity * hidden * (1.0 - met);
        held += member.strength * hides;
        met += hides;
    }
    held
}

/// By how much more members hold back for each unit of the disc that both of a pair hide beyond chance; what the others hide is
/// as given.
fn cross(members: &[&Member], [a, b]: [usize; 2], hidden: &mut [f32]) -> f32 {
    let mut at = |of_a: f32, of_b: f32| {
        (hidden[a], hidden[b]) = (of_a, of_b);
        held(members, hidden)
    };
    at(1.0, 1.0) - at(1.0, 0.0) - at(0.0, 1.0) + at(0.0, 0.0)
}

/// The sine of the largest angle between parallel lines.
const PARALLEL: f64 = 1e-6;

/// A density that is as good as 0, and as far from 1 as good as 1.
const NOTHING: f32 = 1e-4;

/// Memory to follow the light where casters meet.
#[derive(Debug)]
pub(super) struct Meet {
    level: Level,
    chords: Chords,
    /// For each member the lines that discs about the row's points may meet.
    lines: Vec<Vec<[DVec2; 2]>>,
    densities: Vec<[f32; BLOCK]>,
    /// What both of two casters hide, as far as it was asked for.
    shared: Vec<([usize; 2], [f32; BLOCK])>,
    hidden: Vec<f32>,
    /// Whose chords are known, and at what y.
    placed: Option<(Seen, f64)>,
}

impl Default for Meet {
    fn default() -> Self {
        Self {
            level: Level::new(),
            chords: Chords::default(),
            lines: Vec::new(),
            densities: Vec::new(),
            shared: Vec::new(),
            hidden: Vec::new(),
            placed: None,
        }
    }
}

/// The members that pixels of a run see, from the strongest to the weakest.
struct Company<'a> {
    members: Vec<&'a Member>,
    /// Which of them hide a part of the disc, as far as is known; all others hide all of it.
    partial: Vec<usize>,
    /// As the pixels know them.
    seen: Seen,
}

impl<'a> Company<'a> {
    fn of(seen: Seen, members: &'a [Member]) -> Self {
        let mut company = Self {
            members: Vec::new(),
            partial: Vec::new(),
            seen,
        };
        let has = |bits: u32, index: usize| bits & bit(index) != 0;
        for (index, member) in members.iter().enumerate() {
            let is_partial = has(seen.partial(), index) || index >= REST && has(seen.full(), index);
            if is_partial {
                company.partial.push(company.members.len());
            }
            if is_partial || has(seen.full(), index) {
                company.members.push(member);
            }
        }
        company
    }

    /// What the members hide, if those that hide a part hide nothing.
    fn full(&self) -> Vec<f32> {
        let mut hidden = vec![1.0; self.members.len()];
        for &index in &self.partial {
            hidden[index] = 0.0;
        }
        hidden
    }

    fn partial(&self) -> impl ExactSizeIterator<Item = &'a Member> + Clone {
        self.partial.iter().map(|&index| self.members[index])
    }

    /// A whole pixel that does not depend on what of them is seen, if all that hide a part of the disc are of one radius each.
    fn origin(&self) -> Option<DVec2> {
        let mut origins = self.partial().map(|member| match &member.kind {
            Kind::Level(occluder) => Some(occluder.origin()),
            Kind::Tilted(_) => None,
        });
        let first = origins.next().flatten();
        first.filter(|_| origins.all(|origin| origin.is_some()))
    }
}

impl Meet {
    /// Mends the pixels of a row, the first of which begins at `start`, from which several members hide a part of the disc.
    pub(super) fn mend(
        &mut self,
        members: &[Member],
        start: DVec2,
        pixels: &mut Pixels,
        row: Range<usize>,
    ) {
        self.placed = None;
        self.lines.iter_mut().for_each(Vec::clear);
        self.lines.resize_with(members.len(), Vec::new);
        let mut is_row_known = false;
        let mut rest = row.clone();
        while let Some((seen, run)) = pixels.next_shared(rest.clone()) {
            if !is_row_known {
                is_row_known = true;
                for (member, lines) in members.iter().zip(&mut self.lines) {
                    if let Kind::Level(occluder) = &member.kind {
                        occluder.lines_near(start.y + 0.5, lines);
                    }
                }
            }
            rest.start = run.end;
            let company = Company::of(seen, members);
            let corner = start + DVec2::new((run.start - row.start) as f64, 0.0);
            match *company.partial {
                [a, b]
                    if seen.partial() >> REST == 0 && company.partial().all(Member::is_plain) =>
                {
                    let lowest = seen.partial().trailing_zeros() as usize;
                    let highest = seen.partial().ilog2() as usize;
                    self.mend_pair(&company, [a, b], [lowest, highest], corner, pixels, run);
                }
                _ => self.mend_all(&company, corner, pixels, run),
            }
        }
    }

    /// Mends pixels from which two members hide a part of the disc, of which the densities are known: `pair` among the company's,
    /// `indices` among all.
    fn mend_pair(
        &mut self,
        company: &Company<'_>,
        pair: [usize; 2],
        indices: [usize; 2],
        corner: DVec2,
        pixels: &mut Pixels,
        run: Range<usize>,
    ) {
        let mut hidden = company.full();
        let cross = cross(&company.members, pair, &mut hidden);
        if cross == 0.0 {
            return;
        }
        let mut shared = (f64::NAN, [0.0; BLOCK]);
        let mut placed = None;
        let (mut parallel, mut until) = (None, f64::MIN);
        for (lane, pixel) in run.enumerate() {
            let [a, b] = pixels.densities(pixel);
            let at = corner + DVec2::new(lane as f64 + 0.5, 0.5);
            if at.x >= until {
                (parallel, until) = self.parallel(company, pair, indices, at);
            }
            let together = match parallel {
                // One hides what the other does, or what it does not.
                Some(true) => a.min(b),
                Some(false) => (a + b - 1.0).max(0.0),
                None => {
                    let offset = *placed.get_or_insert_with(|| self.place(company, corner + 0.5));
                    let (block, lane) = block_of(offset + lane as f64);
                    if block != shared.0 {
                        shared.0 = block;
                        let both = &mut shared.1;
                        self.chords.shared(self.level, [0, 1], block, both);
                    }
                    shared.1[lane]
                }
            };
            pixels.mend(pixel, cross * (together - a * b));
        }
    }

    /// Whether the disc about a point shows a single line of each of a pair, and these are parallel: then, whether they face one
    /// way. And up to which x to the right of the point that stays so.
    fn parallel(
        &self,
        company: &Company<'_>,
        pair: [usize; 2],
        indices: [usize; 2],
        at: DVec2,
    ) -> (Option<bool>, f64) {
        let [(a, until_a), (b, until_b)] = [0, 1].map(|of| match &company.members[pair[of]].kind {
            Kind::Level(occluder) => occluder.single_line(&self.lines[indices[of]], at),
            Kind::Tilted(_) => (None, f64::MAX),
        });
        let parallel = a.zip(b).and_then(|(a, b)| {
            let is_parallel = a.perp_dot(b).abs() <= PARALLEL * a.length() * b.length();
            is_parallel.then_some(a.dot(b) > 0.0)
        });
        (parallel, until_a.min(until_b))
    }

    fn mend_all(
        &mut self,
        company: &Company<'_>,
        corner: DVec2,
        pixels: &mut Pixels,
        run: Range<usize>,
    ) {
        let mut at = run.start;
        while at < run.end {
            let middle = corner + DVec2::new((at - run.start) as f64, 0.0) + 0.5;
            // Of many radii each point sees a polygon of its own.
            let most = company.origin().map_or(1, |origin| {
                let (_, lane) = block_of(middle.x - origin.x);
                BLOCK - lane
            });
            let count = most.min(run.end - at);
            let mends = self.mends(company, middle, count);
            for (pixel, mend) in (at..at + count).zip(mends) {
                pixels.mend(pixel, mend);
            }
            at += count;
        }
    }

    /// By how much members hold back more than their densities alone tell, for a row of `count` pixels of one block whose first
    /// one's middle is given.
    fn mends(&mut self, company: &Company<'_>, middle: DVec2, count: usize) -> [f32; BLOCK] {
        let side = company
            .partial()
            .map(Member::averaged_side)
            .fold(0.0, f64::max);
        let mut mends = [0.0; BLOCK];
        if side == 0.0 {
            let offset = self.place(company, middle);
            self.add(company, offset, 1.0, &mut mends[..count]);
            return mends;
        }
        // Next to what each hides what both do is a small thing: few points tell it.
        let radius = if side < 1.0 { 2.0 } else { 1.0 };
        for (point, weight) in quadrature::square(radius) {
            let offset = self.place(company, middle + point * side);
            self.add(company, offset, weight as f32, &mut mends[..count]);
        }
        mends
    }

    /// Adds what is to be mended at the points that are whole pixels and `offset` behind the chords' origin.
    fn add(&mut self, company: &Company<'_>, offset: f64, weight: f32, mends: &mut [f32]) {
        let members = &company.members;
        let (block, first) = block_of(offset);
        self.densities.resize(company.partial.len(), [0.0; BLOCK]);
        for (index, densities) in self.densities.iter_mut().enumerate() {
            self.chords.density(self.level, index, block, densities);
        }
        self.shared.clear();
        let full = company.full();
        for (lane, mend) in (first..).zip(mends) {
            let is_partial = |density: f32| density > NOTHING && density < 1.0 - NOTHING;
            let partial = self
                .densities
                .iter()
                .enumerate()
                .filter(|(_, of)| is_partial(of[lane]));
            let mut partial = partial.map(|(index, _)| index);
            let (Some(a), Some(b)) = (partial.next(), partial.next()) else {
                continue;
            };
            let is_pair = partial.next().is_none();
            self.hidden.clear();
            self.hidden.extend(&full);
            for (&index, of) in company.partial.iter().zip(&self.densities) {
                self.hidden[index] = of[lane];
            }
            if is_pair {
                let apart = self.densities[a][lane] * self.densities[b][lane];
                let together = self.shared([a, b], block)[lane];
                let pair = [company.partial[a], company.partial[b]];
                *mend += weight * (together - apart) * cross(members, pair, &mut self.hidden);
            } else {
                let apart = held(members, &self.hidden);
                let hidden = &mut self.hidden;
                let together = self.chords.held(lane as f64 + block, |inside| {
                    for (&index, &inside) in company.partial.iter().zip(inside) {
                        hidden[index] = inside;
                    }
                    held(members, hidden)
                });
                *mend += weight * (together - apart);
            }
        }
    }

    fn shared(&mut self, pair: [usize; 2], block: f64) -> &[f32; BLOCK] {
        let known = self.shared.iter().position(|(of, _)| *of == pair);
        let index = known.unwrap_or_else(|| {
            let mut shared = [0.0; BLOCK];
            self.chords.shared(self.level, pair, block, &mut shared);
            self.shared.push((pair, shared));
            self.shared.len() - 1
        });
        &self.shared[index].1
    }

    /// Finds the chords at the height of a point for the members that hide a part of the disc; how far behind the chords' origin
    /// the point is.
    fn place(&mut self, company: &Company<'_>, at: DVec2) -> f64 {
        let Some(origin) = company.origin() else {
            self.placed = None;
            let seen: Vec<(Cow<'_, Occluder>, DVec2)> = company
                .partial()
                .map(|member| match &member.kind {
                    Kind::Level(occluder) => (Cow::Borrowed(occluder), at),
                    Kind::Tilted(loops) => {
                        (Cow::Owned(Occluder::seen_from(at, loops)), DVec2::ZERO)
                    }
                })
                .collect();
            let seen = seen.iter().map(|(occluder, at)| (occluder.as_ref(), *at));
            self.chords.place(seen);
            return 0.0;
        };
        if self.placed != Some((company.seen, at.y)) {
            self.placed = Some((company.seen, at.y));
            let seen: Vec<(&Occluder, DVec2)> = company
                .partial()
                .filter_map(|member| match &member.kind {
                    Kind::Level(occluder) => Some((occluder, DVec2::new(origin.x, at.y))),
                    Kind::Tilted(_) => None,
                })
                .collect();
            self.chords.place(seen.iter().copied());
        }
        at.x - origin.x
    }
}
