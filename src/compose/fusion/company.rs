//! Who meets at a pixel, and what that means for the light.

use super::chords::Points;
use super::hard;
use super::member::{Kind, Member};
use super::pixel::Casts;
use crate::density::lanes::LANES;
use crate::density::quadrature;

/// The members that pixels see, from the strongest to the weakest, but those that find no light left: behind an opaque one that
/// hides all of the disc.
pub(super) struct Company<'a> {
    members: Vec<&'a Member>,
    /// Those that hide a part of the disc, as far as is known; all others hide all of it.
    pub(super) partial: Vec<Partial<'a>>,
    /// What the members hide, if those that hide a part hide nothing.
    full: Vec<f32>,
    pub(super) square: Square,
    pub(super) together: Together,
    /// Whether what those that hide a part of the disc hold back together is told by polygons in a pixel's square.
    pub(super) is_hard: bool,
}

#[derive(Clone, Copy)]
pub(super) struct Partial<'a> {
    pub(super) member: &'a Member,
    /// Its number among the company's members, and in its group.
    at: usize,
    pub(super) index: usize,
}

/// How what the members that hide a part of the disc hold back together is found.
pub(super) enum Together {
    /// Less than two meet: each counts by itself.
    Alone,
    /// Two: for each unit of the disc that both hide beyond chance so much more is held back. Whether the pixels know their
    /// densities.
    Pair { cross: f32, is_known: bool },
    /// All are opaque: what each and those before it hide counts by a weight; so much is held back whatever they hide.
    Opaque { weights: Vec<f32>, always: f32 },
    /// Ray by ray.
    Any,
}

/// The points at which pixels are averaged, a row at a time.
pub(super) struct Square {
    /// How many pixels of a row are worked on together, and the points of each.
    pub(super) pixels: usize,
    pub(super) per_pixel: usize,
    /// Rows of points by their heights over the pixels' middles, for a square of side 1, and weights.
    pub(super) rows: Vec<(f64, f32)>,
    /// A row's points, and their weights.
    pub(super) points: Points,
    pub(super) weights: [f32; LANES],
}

impl<'a> Company<'a> {
    pub(super) fn of(casts: &Casts, members: &'a [Member]) -> Self {
        let mut company = Self {
            members: Vec::new(),
            partial: Vec::new(),
            full: Vec::new(),
            square: Square::new(0.0, false),
            together: Together::Alone,
            is_hard: false,
        };
        let is_opaque = |cast: &&usize| members[**cast].opacity >= 1.0;
        let last = casts.full.iter().find(is_opaque).copied();
        let is_lit = |cast: usize| {
            last.is_none_or(|last| cast == last || members[cast].strength > members[last].strength)
        };
        let partial = casts.partial.iter().map(|&cast| (cast, true));
        let full = casts.full.iter().map(|&cast| (cast, false));
        let mut seen: Vec<(usize, bool)> = partial.chain(full).collect();
        seen.sort_unstable();
        for (index, is_partial) in seen {
            if !is_lit(index) {
                continue;
            }
            let member = &members[index];
            if is_partial {
                company.partial.push(Partial {
                    member,
                    at: company.members.len(),
                    index,
                });
            }
            company.full.push(if is_partial { 0.0 } else { 1.0 });
            company.members.push(member);
        }
        let sides = company.partial.iter().map(|of| of.member.averaged_side());
        let is_tilted = company
            .partial
            .iter()
            .any(|of| matches!(of.member.kind, Kind::Tilted(_)));
        company.square = Square::new(sides.fold(0.0, f64::max), is_tilted);
        company.together = company.find_together(casts.partial.len());
        company.is_hard = !matches!(company.together, Together::Any)
            && company.partial.iter().all(|of| hard::is_hard(of.member));
        company
    }

    /// How it is found; `partial` members, lit or not, hide a part of the disc.
    fn find_together(&self, partial: usize) -> Together {
        match *self.partial {
            [] | [_] => Together::Alone,
            [a, b] => {
                let at = |of_a: f32, of_b: f32| {
                    let mut hidden = self.full.clone();
                    (hidden[a.at], hidden[b.at]) = (of_a, of_b);
                    self.held_by_all(&hidden)
                };
                // Of a hard border few points tell no more than of what it hides together with another.
                let is_known = partial == 2 && hard::is_hard(a.member) == hard::is_hard(b.member);
                match at(1.0, 1.0) - at(1.0, 0.0) - at(0.0, 1.0) + at(0.0, 0.0) {
                    0.0 => Together::Alone,
                    cross => Together::Pair { cross, is_known },
                }
            }
            _ if self.partial.iter().all(|of| of.member.opacity >= 1.0) => {
                // A ray is held back by the first of them that it meets.
                let met_by = |at: usize| {
                    let mut hidden = self.full.clone();
                    hidden[at] = 1.0;
                    self.held_by_all(&hidden)
                };
                let always = self.held_by_all(&self.full);
                let mut held: Vec<f32> = self.partial.iter().map(|of| met_by(of.at)).collect();
                held.push(always);
                Together::Opaque {
                    weights: held.windows(2).map(|of| of[0] - of[1]).collect(),
                    always,
                }
            }
            _ => Together::Any,
        }
    }

    /// What is held back where those that hide a part of the disc hide these parts one by one, and these are independent.
    /// `memory` is used for the sum.
    pub(super) fn held(&self, hidden: impl Iterator<Item = f32>, memory: &mut Vec<f32>) -> f32 {
        memory.clear();
        memory.extend_from_slice(&self.full);
        for (of, hidden) in self.partial.iter().zip(hidden) {
            memory[of.at] = hidden;
        }
        self.held_by_all(memory)
    }

    fn held_by_all(&self, hidden: &[f32]) -> f32 {
        let (mut held, mut met) = (0.0, 0.0);
        for (member, hidden) in self.members.iter().zip(hidden) {
            let hides = member.opacity * hidden * (1.0 - met);
            held += member.strength * hides;
            met += hides;
        }
        held
    }
}

impl Square {
    /// Of the largest side of any caster's, in pixels. Of tilted casters each pixel sees polygons of its own: it is alone.
    fn new(side: f64, is_tilted: bool) -> Self {
        let steps: Vec<(f64, f32)> = if side == 0.0 {
            vec![(0.0, 1.0)]
        } else {
            // Next to what each hides what both do is a small thing: few points tell it.
            quadrature::side(if side < 1.0 { 2.0 } else { 1.0 })
                .map(|(step, weight)| (step, weight as f32))
                .collect()
        };
        let per_pixel = steps.len();
        let mut square = Self {
            pixels: if is_tilted { 1 } else { LANES / per_pixel },
            per_pixel,
            points: Points::default(),
            weights: [0.0; LANES],
            rows: steps,
        };
        for lane in 0..square.pixels * per_pixel {
            let (offset, weight) = square.rows[lane % per_pixel];
            square.points.pixels[lane] = (lane / per_pixel) as f32;
            square.points.offsets[lane] = offset as f32;
            square.weights[lane] = weight;
        }
        square
    }

    /// Whether each pixel is one point, and as many as can be are worked on together.
    pub(super) fn is_wide(&self) -> bool {
        self.pixels == LANES
    }
}
