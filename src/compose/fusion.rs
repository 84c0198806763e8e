//! Occluder fusion: what casters of several elevations hold back of the light together.
//!
//! Each caster's density is drawn by itself. Where at most one of them is neither 0 nor 1, that is all there is to know. Where
//! more are, what they hide of the disc may overlap much or not at all: there the light is followed along chords of the disc
//! ([`chords`]), and what they say of the casters together against each by itself mends the pixel. It is within a level of
//! the union's exact area, however many casters meet.

mod chords;

use core::ops::Range;
use std::borrow::Cow;

use fearless_simd::Level;
use glam::DVec2;

use self::chords::{BLOCK, Chords, Occluder};
use super::caster::{AnyShadow, Cast};
use crate::apart::overlapping;
use crate::density::{Each, PixelOptions, Sink, averaged_side, flatness, quadrature};
use crate::grid::Grid;
use crate::scratch::Scratch;
use crate::tilted::Circle;

/// What to do where casters of several elevations hide the light from one point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Overlap {
    /// They hide the union of what each hides of the light's disc: no part of the light is taken away twice.
    #[default]
    Union,
    /// Each darkens what the others left, as toolkits do that draw shadow over shadow: stacked cards are too dark.
    SourceOver,
}

/// Casts whose shadows may overlap, from the strongest to the weakest; alone if there is but one. What is drawn over the others
/// whatever it hides is alone, too: an image's rays are stopped here and there.
pub(super) fn groups(casts: &[Cast], overlap: Overlap) -> Vec<Vec<&Cast>> {
    let is_alone =
        |cast: &Cast| overlap == Overlap::SourceOver || matches!(cast.shadow, AnyShadow::Alpha(_));
    let boxed = casts.iter().enumerate().filter_map(|(index, cast)| {
        let (min, max) = cast.shadow.reach(1.0)?;
        (!is_alone(cast)).then_some((min, max, (index, cast)))
    });
    let mut groups: Vec<Vec<&Cast>> = overlapping(boxed.collect())
        .into_iter()
        .map(|mut group| {
            // An order of their own, so that what is far away does not change it.
            group.sort_by(|(first, a), (second, b)| {
                b.strength.total_cmp(&a.strength).then(first.cmp(second))
            });
            group.into_iter().map(|(_, cast)| cast).collect()
        })
        .collect();
    groups.extend(
        casts
            .iter()
            .filter(|cast| is_alone(cast))
            .map(|cast| vec![cast]),
    );
    groups
}

/// Memory to draw casts together with. It holds no results.
#[derive(Debug, Default)]
pub(crate) struct Fusion {
    pixels: Vec<Pixel>,
    row: Vec<f32>,
    meet: Meet,
}

/// What is known of a pixel after some of the casts: at first nothing.
#[derive(Debug, Clone, Copy, Default)]
struct Pixel {
    /// What they hold back of the light, and what of it has met any of them.
    held: f32,
    met: f32,
    /// What the first two that hide a part of the disc hide.
    densities: [f32; 2],
    /// The casts that hide a part of the disc, and those that hide all of it, a bit each: the last bit stands for all from there on.
    partial: u16,
    full: u16,
}

/// Densities within this of 0 and 1 are these.
const ROUNDING: f32 = 1e-6;

/// The first cast that has no bit for itself.
const REST: usize = 15;

impl Pixel {
    fn add(&mut self, density: f32, cast: &Cast, bit: u16) {
        // What rounding leaves beyond a shadow's ends would make a partial cast of none.
        let density = match density {
            ..ROUNDING => return,
            density if density > 1.0 - ROUNDING => 1.0,
            density => density,
        };
        let hides = cast.opacity as f32 * density * (1.0 - self.met);
        self.held += cast.strength as f32 * hides;
        self.met += hides;
        if density >= 1.0 {
            self.full |= bit;
        } else {
            if let Some(to) = self.densities.get_mut(self.partial.count_ones() as usize) {
                *to = density;
            }
            self.partial |= bit;
        }
    }

    fn mend(&mut self, by: f32) {
        self.held = (self.held + by).clamp(0.0, 1.0);
    }

    /// Whether several casts hide a part of the disc.
    fn is_shared(&self) -> bool {
        self.partial & (self.partial.wrapping_sub(1) | 1 << REST) != 0
    }
}

/// A cast, and what of it its chords need.
struct Member {
    strength: f32,
    opacity: f32,
    kind: Kind,
}

enum Kind {
    /// Of one radius.
    Level(Occluder),
    /// Of many radii.
    Tilted(Vec<Vec<Circle>>),
}

/// Gives `sink` what a group of casts hold back of the light at each pixel of the grid that is not hidden.
pub(crate) fn draw(
    group: &[&Cast],
    grid: &Grid,
    options: &PixelOptions<'_>,
    scratch: &mut Scratch,
    sink: &mut dyn Sink,
) {
    let mut fusion = core::mem::take(&mut scratch.fusion);
    fusion.draw(group, grid, options, scratch, sink);
    scratch.fusion = fusion;
}

impl Fusion {
    fn draw(
        &mut self,
        group: &[&Cast],
        grid: &Grid,
        options: &PixelOptions<'_>,
        scratch: &mut Scratch,
        sink: &mut dyn Sink,
    ) {
        let scale = grid.pixels_per_unit();
        let Some([columns, rows]) = seen_pixels(group, grid) else {
            return;
        };
        let width = columns.len();
        self.pixels.clear();
        self.pixels.resize(width * rows.len(), Pixel::default());
        let first = [columns.start, rows.start];
        let window = grid.window(first, [columns.end, rows.end]);
        let hidden = options.hidden.map(|hidden| hidden.window(&window, first));
        let options = PixelOptions {
            hidden: hidden.as_ref(),
            ..*options
        };
        for (index, cast) in group.iter().enumerate() {
            let bit = 1 << index.min(REST);
            let mut pass = Each {
                pixels: &mut self.pixels,
                stride: width,
                put: |pixel: &mut Pixel, density: f32| pixel.add(density, cast, bit),
            };
            cast.shadow.draw(&window, &options, scratch, &mut pass);
        }
        let members = match group {
            [_] => Vec::new(),
            several => several
                .iter()
                .filter_map(|cast| Member::new(cast, scale))
                .collect(),
        };
        let [shared_columns, shared_rows] = shared_pixels(group, &window);
        for row in 0..rows.len() {
            if members.len() > 1 && shared_rows.contains(&row) {
                let pixels = &mut self.pixels[row * width..][shared_columns.clone()];
                let start = window.corner() + DVec2::new(shared_columns.start as f64, row as f64);
                self.meet.mend(&members, start, pixels);
            }
            let pixels = &self.pixels[row * width..][..width];
            self.row.clear();
            self.row.extend(pixels.iter().map(|pixel| pixel.held));
            let is_held = |held: &f32| *held != 0.0;
            let (Some(first), Some(last)) = (
                self.row.iter().position(is_held),
                self.row.iter().rposition(is_held),
            ) else {
                continue;
            };
            let on_grid = columns.start + first as u32..columns.start + last as u32 + 1;
            sink.values(rows.start + row as u32, on_grid, &self.row[first..=last]);
        }
    }
}

/// The columns and rows of the grid that any of the casts may reach.
fn seen_pixels(group: &[&Cast], grid: &Grid) -> Option<[Range<u32>; 2]> {
    let scale = grid.pixels_per_unit();
    let boxes = group.iter().filter_map(|cast| cast.shadow.reach(scale));
    let (min, max) = boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
    let seen = [0, 1].map(|axis| {
        let end = f64::from([grid.width(), grid.height()][axis]);
        let on_grid = |v: f64| (v - grid.corner()[axis]).clamp(0.0, end) as u32;
        on_grid(min[axis].floor())..on_grid(max[axis].ceil() + 1.0)
    });
    (!seen.iter().any(Range::is_empty)).then_some(seen)
}

/// The columns and rows of the window that two of the casts may reach.
fn shared_pixels(group: &[&Cast], window: &Grid) -> [Range<usize>; 2] {
    let scale = window.pixels_per_unit();
    let boxes: Vec<(DVec2, DVec2)> = group
        .iter()
        .filter_map(|cast| cast.shadow.reach(scale))
        .collect();
    [0, 1].map(|axis| {
        // Beyond the second lowest beginning and the second highest end there is one at most.
        let mut starts: Vec<f64> = boxes.iter().map(|(min, _)| min[axis]).collect();
        let mut ends: Vec<f64> = boxes.iter().map(|(_, max)| max[axis]).collect();
        starts.sort_by(f64::total_cmp);
        ends.sort_by(|a, b| b.total_cmp(a));
        let (Some(start), Some(end)) = (starts.get(1), ends.get(1)) else {
            return 0..0;
        };
        let count = f64::from([window.width(), window.height()][axis]);
        let on_window = |v: f64| (v - window.corner()[axis]).clamp(0.0, count) as usize;
        on_window(start.floor())..on_window(end.ceil() + 1.0)
    })
}

impl Member {
    fn new(cast: &Cast, scale: f64) -> Option<Self> {
        cast.shadow.reach(scale)?;
        let kind = match &cast.shadow {
            AnyShadow::Level(shadow) => {
                let radius = shadow.radius();
                let flat = flatness(FLATNESS, radius, 1.0 / scale);
                let polygons = shadow.outline(flat).polygons(flat);
                let radius = (radius * scale).max(LEAST_RADIUS);
                Kind::Level(Occluder::new(&polygons, scale, radius))
            }
            AnyShadow::Tilted(shadow) => {
                let place = |circle: &Circle| circle.placed(scale, DVec2::ZERO);
                let loops = shadow.loops.iter();
                Kind::Tilted(
                    loops
                        .map(|circles| circles.iter().map(place).collect())
                        .collect(),
                )
            }
            AnyShadow::Alpha(_) => return None,
        };
        Some(Self {
            strength: cast.strength as f32,
            opacity: cast.opacity as f32,
            kind,
        })
    }

    /// The side of the square about its centre that a pixel sees it through, in pixels.
    fn averaged_side(&self) -> f64 {
        match &self.kind {
            Kind::Level(occluder) => averaged_side(occluder.radius),
            Kind::Tilted(_) => 0.0,
        }
    }

    /// Whether points of a row see it along the same chords, each as it is at the point.
    fn is_plain(&self) -> bool {
        matches!(self.kind, Kind::Level(_)) && self.averaged_side() == 0.0
    }
}

/// How far lines in place of curves may move what casters hide together, in levels.
const FLATNESS: f64 = 0.2;

/// The disc of a hard shadow, in pixels: next to the pixel's square it is a point.
const LEAST_RADIUS: f64 = 1e-3;

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
struct Meet {
    level: Level,
    chords: Chords,
    /// For each member the lines that discs about the row's points may meet.
    lines: Vec<Vec<[DVec2; 2]>>,
    densities: Vec<[f32; BLOCK]>,
    /// What both of two casters hide, as far as it was asked for.
    shared: Vec<([usize; 2], [f32; BLOCK])>,
    hidden: Vec<f32>,
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
        }
    }
}

/// The members that pixels of a run see, from the strongest to the weakest.
struct Company<'a> {
    members: Vec<&'a Member>,
    /// Which of them hide a part of the disc, as far as is known; all others hide all of it.
    partial: Vec<usize>,
}

impl<'a> Company<'a> {
    fn of(pixel: &Pixel, members: &'a [Member]) -> Self {
        let mut company = Self {
            members: Vec::new(),
            partial: Vec::new(),
        };
        let has = |bits: u16, index: usize| bits >> index.min(REST) & 1 == 1;
        for (index, member) in members.iter().enumerate() {
            let is_partial = has(pixel.partial, index) || index >= REST && has(pixel.full, index);
            if is_partial {
                company.partial.push(company.members.len());
            }
            if is_partial || has(pixel.full, index) {
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
}

impl Meet {
    /// Mends the pixels of a row, the first of which begins at `start`, from which several members hide a part of the disc.
    fn mend(&mut self, members: &[Member], start: DVec2, pixels: &mut [Pixel]) {
        let mut index = 0;
        self.lines.iter_mut().for_each(Vec::clear);
        self.lines.resize_with(members.len(), Vec::new);
        let mut is_row_known = false;
        while let Some(next) = pixels[index..].iter().position(Pixel::is_shared) {
            if !is_row_known {
                is_row_known = true;
                for (member, lines) in members.iter().zip(&mut self.lines) {
                    if let Kind::Level(occluder) = &member.kind {
                        occluder.lines_near(start.y + 0.5, lines);
                    }
                }
            }
            index += next;
            let first = pixels[index];
            let count = pixels[index..]
                .iter()
                .take(BLOCK)
                .take_while(|pixel| (pixel.partial, pixel.full) == (first.partial, first.full))
                .count();
            let company = Company::of(&first, members);
            let corner = start + DVec2::new(index as f64, 0.0);
            let run = &mut pixels[index..index + count];
            match *company.partial {
                [a, b] if first.partial >> REST == 0 && company.partial().all(Member::is_plain) => {
                    let lowest = first.partial.trailing_zeros() as usize;
                    let highest = REST - first.partial.leading_zeros() as usize;
                    self.mend_pair(&company, [a, b], [lowest, highest], corner, run);
                }
                _ => self.mend_all(&company, corner, run),
            }
            index += count;
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
        run: &mut [Pixel],
    ) {
        let mut hidden = company.full();
        let cross = cross(&company.members, pair, &mut hidden);
        if cross == 0.0 {
            return;
        }
        let mut shared = None;
        let (mut parallel, mut until) = (None, f64::MIN);
        for lane in 0..run.len() {
            let [a, b] = run[lane].densities;
            let at = corner + DVec2::new(lane as f64 + 0.5, 0.5);
            if at.x >= until {
                (parallel, until) = self.parallel(company, pair, indices, at);
            }
            let together = match parallel {
                // One hides what the other does, or what it does not.
                Some(true) => a.min(b),
                Some(false) => (a + b - 1.0).max(0.0),
                None => {
                    let shared = shared.get_or_insert_with(|| {
                        let mut shared = [0.0; BLOCK];
                        place(&mut self.chords, company, corner + 0.5);
                        self.chords.shared(self.level, [0, 1], 0.0, &mut shared);
                        shared
                    });
                    shared[lane]
                }
            };
            run[lane].mend(cross * (together - a * b));
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

    fn mend_all(&mut self, company: &Company<'_>, corner: DVec2, run: &mut [Pixel]) {
        // Of many radii each point sees a polygon of its own.
        let is_tilted = |member: &Member| matches!(member.kind, Kind::Tilted(_));
        let most = if company.partial().any(is_tilted) {
            1
        } else {
            BLOCK
        };
        for (chunk, pixels) in run.chunks_mut(most).enumerate() {
            let corner = corner + DVec2::new((chunk * most) as f64, 0.0);
            let mends = self.mends(company, corner, pixels.len());
            for (pixel, mend) in pixels.iter_mut().zip(mends) {
                pixel.mend(mend);
            }
        }
    }

    /// By how much members hold back more than their densities alone tell, for a row of `count` pixels whose first one begins at
    /// `corner`.
    fn mends(&mut self, company: &Company<'_>, corner: DVec2, count: usize) -> [f32; BLOCK] {
        let side = company
            .partial()
            .map(Member::averaged_side)
            .fold(0.0, f64::max);
        let mut mends = [0.0; BLOCK];
        let middle = corner + 0.5;
        if side == 0.0 {
            place(&mut self.chords, company, middle);
            self.add(company, 0.0, 1.0, &mut mends[..count]);
            return mends;
        }
        // Next to what each hides what both do is a small thing: few points tell it.
        let radius = if side < 1.0 { 2.0 } else { 1.0 };
        let mut placed = f64::NAN;
        for (point, weight) in quadrature::square(radius) {
            if point.y != placed {
                placed = point.y;
                place(
                    &mut self.chords,
                    company,
                    middle + DVec2::new(0.0, point.y * side),
                );
            }
            self.add(company, point.x * side, weight as f32, &mut mends[..count]);
        }
        mends
    }

    /// Adds what is to be mended at the points that are whole pixels and `offset` behind the first.
    fn add(&mut self, company: &Company<'_>, offset: f64, weight: f32, mends: &mut [f32]) {
        let members = &company.members;
        self.densities.resize(company.partial.len(), [0.0; BLOCK]);
        for (index, densities) in self.densities.iter_mut().enumerate() {
            self.chords.density(self.level, index, offset, densities);
        }
        self.shared.clear();
        let full = company.full();
        for (lane, mend) in mends.iter_mut().enumerate() {
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
                let together = self.shared([a, b], offset)[lane];
                let pair = [company.partial[a], company.partial[b]];
                *mend += weight * (together - apart) * cross(members, pair, &mut self.hidden);
            } else {
                let apart = held(members, &self.hidden);
                let hidden = &mut self.hidden;
                let together = self.chords.held(lane as f64 + offset, |inside| {
                    for (&index, &inside) in company.partial.iter().zip(inside) {
                        hidden[index] = inside;
                    }
                    held(members, hidden)
                });
                *mend += weight * (together - apart);
            }
        }
    }

    fn shared(&mut self, pair: [usize; 2], offset: f64) -> &[f32; BLOCK] {
        let known = self.shared.iter().position(|(of, _)| *of == pair);
        let index = known.unwrap_or_else(|| {
            let mut shared = [0.0; BLOCK];
            self.chords.shared(self.level, pair, offset, &mut shared);
            self.shared.push((pair, shared));
            self.shared.len() - 1
        });
        &self.shared[index].1
    }
}

/// Finds the chords of the points from `at` on for the members that hide a part of the disc.
fn place(chords: &mut Chords, company: &Company<'_>, at: DVec2) {
    let seen: Vec<(Cow<'_, Occluder>, DVec2)> = company
        .partial()
        .map(|member| match &member.kind {
            Kind::Level(occluder) => (Cow::Borrowed(occluder), at),
            Kind::Tilted(loops) => (Cow::Owned(Occluder::seen_from(at, loops)), DVec2::ZERO),
        })
        .collect();
    chords.place(seen.iter().map(|(occluder, at)| (occluder.as_ref(), *at)));
}
