//! Occluder fusion: what casters of several elevations hold back of the light together.
//!
//! Each caster's density is drawn by itself. Where at most one of them is neither 0 nor 1, that is all there is to know. Where
//! more are, what they hide of the disc may overlap much or not at all: there the light is followed along chords of the disc
//! ([`chords`]), and what they say of the casters together against each by itself mends the pixel. It is within a level of
//! the union's exact area, however many casters meet.

mod chords;
mod company;
mod hard;
mod meet;
mod member;
mod occluder;
mod pixel;
mod wedge;

use core::ops::Range;

use fearless_simd::Level;
use glam::DVec2;

use self::meet::{Companies, Meet};
use self::member::Member;
use self::pixel::{By, Pixels};
use super::caster::{AnyShadow, Cast};
use crate::apart::overlapping;
use crate::density::lanes::LANES;
use crate::density::{PixelOptions, Sink};
use crate::grid::Grid;
use crate::scratch::Scratch;

/// What to do where casters of several elevations hide the light from one point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Overlap {
    /// They hide the union of what each hides of the light's disc: no part of the light is taken away twice.
    #[default]
    Union,
    /// Each darkens what the others left, as toolkits do that draw shadow over shadow: stacked cards are too dark.
    SourceOver,
}

/// Casts whose shadows may overlap on pixels of which there are `per_unit` a scene unit, from the strongest to the weakest; alone
/// if there is but one. What is drawn over the others whatever it hides is alone, too: an image's rays are stopped here and there.
pub(super) fn groups(casts: &[Cast], overlap: Overlap, per_unit: f64) -> Vec<Vec<&Cast>> {
    let is_alone =
        |cast: &Cast| overlap == Overlap::SourceOver || matches!(cast.shadow, AnyShadow::Alpha(_));
    let boxed = casts.iter().enumerate().filter_map(|(index, cast)| {
        let (min, max) = cast.shadow.reach(per_unit)?;
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
    pixels: Pixels,
    row: Vec<f32>,
    meet: Meet,
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
        let [columns, rows] = shared_pixels(group, grid);
        let width = columns.len();
        self.pixels.reset(width * rows.len());
        for (index, cast) in group.iter().enumerate() {
            let mut pass = Pass {
                by: By::new(cast, index),
                columns: columns.clone(),
                rows: rows.clone(),
                level: scratch.level(),
                pixels: &mut self.pixels,
                row: &mut self.row,
                sink,
            };
            cast.shadow.draw(grid, options, scratch, &mut pass);
        }
        if self.pixels.is_empty() {
            return;
        }
        let members: Vec<Member> = if self.pixels.are_shared() {
            let members = group.iter().filter_map(|cast| Member::new(cast, grid));
            members.collect()
        } else {
            Vec::new()
        };
        let mut companies = Companies::new();
        self.meet.begin();
        for (row, y) in rows.enumerate() {
            let start = grid.corner() + DVec2::new(f64::from(columns.start), f64::from(y));
            let at = row * width..(row + 1) * width;
            self.meet.mend(
                scratch.level(),
                &members,
                &mut companies,
                start,
                &mut self.pixels,
                at.clone(),
            );
            let held = self.pixels.held(at);
            if let Some(part) = held_back(held) {
                let [first, end] = [part.start, part.end].map(|at| columns.start + at as u32);
                sink.values(y..y + 1, first..end, &held[part.start..]);
            }
        }
    }
}

/// Where anything is held back, to whole blocks.
fn held_back(held: &[f32]) -> Option<Range<usize>> {
    // A block at once: pixel by pixel it would take as long as all that meets there.
    let is_held = |block: &[f32]| block.iter().fold(false, |any, held| any | (*held != 0.0));
    let blocks = held.chunks(LANES);
    let first = blocks.clone().position(is_held)?;
    let last = blocks.clone().rposition(is_held)?;
    Some(first * LANES..((last + 1) * LANES).min(held.len()))
}

/// One cast on its way to the pixels: those that others may reach too are kept until all are known, all others are told
/// at once.
struct Pass<'a> {
    by: By,
    level: Level,
    /// The shared pixels.
    columns: Range<u32>,
    rows: Range<u32>,
    pixels: &'a mut Pixels,
    row: &'a mut Vec<f32>,
    sink: &'a mut dyn Sink,
}

/// The parts of a range before another, in it and behind it.
fn split(all: &Range<u32>, by: &Range<u32>) -> [Range<u32>; 3] {
    let [start, end] = [by.start, by.end].map(|end| end.clamp(all.start, all.end));
    [all.start..start, start..end, end..all.end]
}

impl Pass<'_> {
    /// Rows and columns that are shared, and those that are not, in parts of which some may be empty.
    fn parts(
        &self,
        rows: &Range<u32>,
        columns: &Range<u32>,
    ) -> ([Range<u32>; 2], [[Range<u32>; 2]; 4]) {
        let [above, among, below] = split(rows, &self.rows);
        let [left, shared, right] = split(columns, &self.columns);
        let alone = [
            [above, columns.clone()],
            [among.clone(), left],
            [among.clone(), right],
            [below, columns.clone()],
        ];
        ([among, shared], alone)
    }

    /// Where among the shared pixels some columns are.
    fn shared(&self, y: u32, columns: &Range<u32>) -> Range<usize> {
        let start = (y - self.rows.start) as usize * self.columns.len();
        let [from, to] = [columns.start, columns.end].map(|x| (x - self.columns.start) as usize);
        start + from..start + to
    }
}

impl Sink for Pass<'_> {
    fn constant(&mut self, rows: Range<u32>, columns: Range<u32>, density: f32) {
        let ([among, shared], alone) = self.parts(&rows, &columns);
        if !shared.is_empty() {
            for y in among {
                let at = self.shared(y, &shared);
                self.pixels.add_constant(self.level, at, density, self.by);
            }
        }
        let held = self.by.alone(density);
        for [rows, columns] in alone {
            if !rows.is_empty() && !columns.is_empty() && held != 0.0 {
                self.sink.constant(rows, columns, held);
            }
        }
    }

    fn values(&mut self, rows: Range<u32>, columns: Range<u32>, densities: &[f32]) {
        let ([among, shared], alone) = self.parts(&rows, &columns);
        let first = columns.start;
        let of = |part: &Range<u32>| {
            &densities[(part.start - first) as usize..(part.end - first) as usize]
        };
        if !shared.is_empty() {
            for y in among {
                let at = self.shared(y, &shared);
                self.pixels.add_values(self.level, at, of(&shared), self.by);
            }
        }
        for [rows, columns] in alone {
            if !rows.is_empty() && !columns.is_empty() {
                let held = of(&columns).iter().map(|&density| self.by.alone(density));
                self.row.clear();
                self.row.extend(held);
                // Behind them so many that the last ones are read as a whole block.
                self.row.resize(columns.len() + LANES, 0.0);
                self.sink.values(rows, columns, self.row);
            }
        }
    }
}

/// The columns and rows of the grid that two of the casts may reach.
fn shared_pixels(group: &[&Cast], grid: &Grid) -> [Range<u32>; 2] {
    let scale = grid.pixels_per_unit();
    let boxes: Vec<(DVec2, DVec2)> = group
        .iter()
        .filter_map(|cast| cast.shadow.reach(scale))
        .collect();
    let shared = [0, 1].map(|axis| {
        // Beyond the second lowest beginning and the second highest end there is one at most.
        let mut starts: Vec<f64> = boxes.iter().map(|(min, _)| min[axis]).collect();
        let mut ends: Vec<f64> = boxes.iter().map(|(_, max)| max[axis]).collect();
        starts.sort_by(f64::total_cmp);
        ends.sort_by(|a, b| b.total_cmp(a));
        let (Some(start), Some(end)) = (starts.get(1), ends.get(1)) else {
            return 0..0;
        };
        let count = f64::from([grid.width(), grid.height()][axis]);
        let on_grid = |v: f64| (v - grid.corner()[axis]).clamp(0.0, count) as u32;
        on_grid(start.floor())..on_grid(end.ceil() + 1.0)
    });
    if shared.iter().any(Range::is_empty) {
        return [0..0, 0..0];
    }
    shared
}
