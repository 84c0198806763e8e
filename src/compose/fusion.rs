//! Occluder fusion: what casters of several elevations hold back of the light together.
//!
//! Each caster's density is drawn by itself. Where at most one of them is neither 0 nor 1, that is all there is to know. Where
//! more are, what they hide of the disc may overlap much or not at all: there the light is followed along chords of the disc
//! ([`chords`]), and what they say of the casters together against each by itself mends the pixel. It is within a level of
//! the union's exact area, however many casters meet.

mod chords;

use core::ops::Range;

use glam::DVec2;

use self::chords::{BLOCK, Chords, Occluder};
use crate::apart::overlapping;
use crate::density::{self, Each, PixelOptions, Sink, averaged_side, flatness, quadrature};
use crate::grid::Grid;
use crate::scratch::Scratch;
use crate::shadow::Shadow;

/// One shadow on one receiver, and what of the light is held back where its casters hide it: `strength` by those that are
/// opaque, and of the rest a part, their `opacity`.
#[derive(Debug)]
pub(crate) struct Cast {
    pub(crate) shadow: Shadow,
    pub(crate) strength: f64,
    pub(crate) opacity: f64,
}

impl Cast {
    /// What is held back where the shadow is densest.
    pub(crate) fn weight(&self) -> f64 {
        self.strength * self.opacity
    }
}

/// Casts whose shadows may overlap, from the strongest to the weakest; alone if there is but one.
pub(crate) fn groups(casts: &[Cast]) -> Vec<Vec<&Cast>> {
    let boxed = casts.iter().filter_map(|cast| {
        let (min, max) = cast.shadow.hull()?;
        let reach = cast.shadow.radius();
        Some((min - reach, max + reach, cast))
    });
    let mut groups = overlapping(boxed.collect());
    for group in &mut groups {
        group.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    }
    groups
}

/// Memory to draw casts together with. It holds no results.
#[derive(Debug, Default)]
pub(crate) struct Fusion {
    pixels: Vec<Pixel>,
    row: Vec<f32>,
    meet: Meet,
}

/// What is known of a pixel after some of the casts.
#[derive(Debug, Clone, Copy)]
struct Pixel {
    /// What they hold back of the light, and what of it has met none of them.
    held: f32,
    free: f32,
    /// How many of them hide a part of the disc.
    partial: u16,
}

impl Pixel {
    const LIT: Self = Self {
        held: 0.0,
        free: 1.0,
        partial: 0,
    };
}

/// A cast as pixels see it, from the casts' common origin on.
struct Member {
    occluder: Occluder,
    min: DVec2,
    max: DVec2,
    strength: f32,
    opacity: f32,
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
        let Some(frame) = Frame::new(group, grid) else {
            return;
        };
        let [columns, rows] = frame.seen.clone();
        let width = columns.len();
        self.pixels.clear();
        self.pixels.resize(width * rows.len(), Pixel::LIT);
        let window = grid.window([columns.start, rows.start], [columns.end, rows.end]);
        let hidden = options
            .hidden
            .map(|hidden| hidden.window(&window, [columns.start, rows.start]));
        let options = PixelOptions {
            hidden: hidden.as_ref(),
            ..*options
        };
        for cast in group {
            let (strength, opacity) = (cast.strength as f32, cast.opacity as f32);
            let mut pass = Each {
                pixels: &mut self.pixels,
                stride: width,
                put: |pixel: &mut Pixel, density: f32| {
                    let hides = opacity * density * pixel.free;
                    pixel.held += strength * hides;
                    pixel.free -= hides;
                    if density > 0.0 && density < 1.0 {
                        pixel.partial += 1;
                    }
                },
            };
            density::draw(&cast.shadow, &window, &options, scratch, &mut pass);
        }
        let members = frame.members(group);
        for row in 0..rows.len() {
            self.mend(&frame, &members, row);
            let pixels = &self.pixels[row * width..][..width];
            self.row.clear();
            self.row.extend(pixels.iter().map(|pixel| pixel.held));
            let mut start = 0;
            for run in pixels.chunk_by(|a, b| (a.held == 0.0) == (b.held == 0.0)) {
                let end = start + run.len();
                if run[0].held != 0.0 {
                    let on_grid = columns.start + start as u32..columns.start + end as u32;
                    sink.values(rows.start + row as u32, on_grid, &self.row[start..end]);
                }
                start = end;
            }
        }
    }

    /// Mends the pixels of a row that several casts hide a part of the disc from.
    fn mend(&mut self, frame: &Frame, members: &[Member], row: usize) {
        let width = frame.seen[0].len();
        let pixels = &mut self.pixels[row * width..][..width];
        let mut start = 0;
        while let Some(next) = pixels[start..].iter().position(|pixel| pixel.partial > 1) {
            let column = frame.first[0] + (start + next) as i64;
            let block = column.div_euclid(BLOCK as i64) * BLOCK as i64;
            let [first, end] = [block, block + BLOCK as i64]
                .map(|edge| (edge - frame.first[0]).clamp(0, width as i64) as usize);
            let corner =
                DVec2::new(block as f64, (frame.first[1] + row as i64) as f64) + frame.phase;
            let near = members.iter().filter(|member| {
                member
                    .min
                    .cmplt(corner + DVec2::new(BLOCK as f64, 1.0))
                    .all()
                    && member.max.cmpgt(corner).all()
            });
            let near: Vec<&Member> = near.collect();
            let mends = self.meet.mends(&near, corner);
            for (index, pixel) in pixels[first..end].iter_mut().enumerate() {
                if pixel.partial > 1 {
                    let lane = frame.first[0] + (first + index) as i64 - block;
                    pixel.held = (pixel.held + mends[lane as usize]).clamp(0.0, 1.0);
                }
            }
            start = end;
        }
    }
}

/// Where the casts of a group lie among the pixels of a grid.
struct Frame {
    /// Pixels from the scene's origin to the casts' own.
    base: DVec2,
    scale: f64,
    /// The grid's columns and rows that any of the casts may reach.
    seen: [Range<u32>; 2],
    /// The first of them in the casts' own pixels, and where in one of these it begins.
    first: [i64; 2],
    phase: DVec2,
}

impl Frame {
    fn new(group: &[&Cast], grid: &Grid) -> Option<Self> {
        let scale = grid.pixels_per_unit();
        let boxes = group.iter().filter_map(|cast| reach(&cast.shadow, scale));
        let (min, max) = boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
        let base = min.floor();
        let seen = [0, 1].map(|axis| {
            let end = [grid.width(), grid.height()][axis];
            let on_grid = |v: f64| (v - grid.corner()[axis]).clamp(0.0, f64::from(end)) as u32;
            on_grid(min[axis].floor())..on_grid(max[axis].ceil() + 1.0)
        });
        if seen.iter().any(Range::is_empty) {
            return None;
        }
        let corner = grid.corner() - base;
        let whole = corner.floor();
        Some(Self {
            base,
            scale,
            first: [0, 1].map(|axis| whole[axis] as i64 + i64::from(seen[axis].start)),
            seen,
            phase: corner - whole,
        })
    }

    fn members(&self, group: &[&Cast]) -> Vec<Member> {
        let place = |p: DVec2| p * self.scale - self.base;
        let member = |cast: &&Cast| {
            let (min, max) = reach(&cast.shadow, self.scale)?;
            let radius = cast.shadow.radius();
            let flat = flatness(FLATNESS, radius, 1.0 / self.scale);
            let mut polygons = cast.shadow.outline(flat).polygons(flat);
            for point in polygons.iter_mut().flatten() {
                *point = place(*point);
            }
            Some(Member {
                occluder: Occluder::new(&polygons, (radius * self.scale).max(LEAST_RADIUS)),
                min: min - self.base,
                max: max - self.base,
                strength: cast.strength as f32,
                opacity: cast.opacity as f32,
            })
        };
        group.iter().filter_map(member).collect()
    }
}

/// How far lines in place of curves may move what casters hide together, in levels.
const FLATNESS: f64 = 0.05;

/// The disc of a hard shadow, in pixels: next to the pixel's square it is a point.
const LEAST_RADIUS: f64 = 1e-3;

/// The box of the pixels that see a shadow, in pixels.
fn reach(shadow: &Shadow, scale: f64) -> Option<(DVec2, DVec2)> {
    let (min, max) = shadow.hull()?;
    let radius = shadow.radius() * scale;
    let reach = radius + averaged_side(radius) / 2.0;
    Some((min * scale - reach, max * scale + reach))
}

/// What members hold back together where they hide these parts of the light one by one, and these are independent.
fn held<'a>(members: impl IntoIterator<Item = &'a &'a Member>, hidden: &[f32]) -> f32 {
    let (mut held, mut free) = (0.0, 1.0);
    for (member, hidden) in members.into_iter().zip(hidden) {
        let hides = member.opacity * hidden * free;
        held += member.strength * hides;
        free -= hides;
    }
    held
}

/// Memory to follow the light where casters meet.
#[derive(Debug, Default)]
struct Meet {
    chords: Chords,
    densities: Vec<[f32; BLOCK]>,
    /// What both of two casters hide, as far as it was asked for.
    shared: Vec<([usize; 2], [f32; BLOCK])>,
    partial: Vec<usize>,
    hidden: Vec<f32>,
}

impl Meet {
    /// By how much members hold back more than their densities alone tell, for the pixels of a block of a row whose first one
    /// begins at `corner`.
    fn mends(&mut self, members: &[&Member], corner: DVec2) -> [f32; BLOCK] {
        let radius = members
            .iter()
            .map(|member| member.occluder.radius)
            .fold(f64::MAX, f64::min);
        let side = averaged_side(radius);
        let mut mends = [0.0; BLOCK];
        let middle = corner + 0.5;
        if side == 0.0 {
            self.place(members, corner.x, middle.y);
            self.add(members, 0.5, 1.0, &mut mends);
            return mends;
        }
        let mut placed = f64::NAN;
        for (point, weight) in quadrature::square(radius) {
            if point.y != placed {
                placed = point.y;
                self.place(members, corner.x, middle.y + point.y * side);
            }
            self.add(
                members,
                (0.5 + point.x * side) as f32,
                weight as f32,
                &mut mends,
            );
        }
        mends
    }

    fn place(&mut self, members: &[&Member], x: f64, y: f64) {
        let occluders = members.iter().map(|member| &member.occluder);
        self.chords.place(occluders, x, y);
    }

    /// Adds what is to be mended at the block's points `offset` behind whole pixels.
    fn add(&mut self, members: &[&Member], offset: f32, weight: f32, mends: &mut [f32; BLOCK]) {
        self.densities.resize(members.len(), [0.0; BLOCK]);
        for (index, densities) in self.densities.iter_mut().enumerate() {
            self.chords.density(index, offset, densities);
        }
        self.shared.clear();
        for (lane, mend) in mends.iter_mut().enumerate() {
            self.partial.clear();
            let partial = |index: &usize| {
                let density = self.densities[*index][lane];
                density > NOTHING && density < 1.0 - NOTHING
            };
            self.partial.extend((0..members.len()).filter(partial));
            self.hidden.clear();
            self.hidden.extend(self.densities.iter().map(|of| of[lane]));
            match *self.partial {
                [] | [_] => {}
                [a, b] => {
                    let covariance =
                        self.shared([a, b], offset)[lane] - self.hidden[a] * self.hidden[b];
                    let mut corner = |of_a: f32, of_b: f32| {
                        (self.hidden[a], self.hidden[b]) = (of_a, of_b);
                        held(members, &self.hidden)
                    };
                    let cross =
                        corner(1.0, 1.0) - corner(1.0, 0.0) - corner(0.0, 1.0) + corner(0.0, 0.0);
                    *mend += weight * cross * covariance;
                }
                _ => {
                    let x = lane as f32 + offset;
                    let together = self.chords.held(x, |hidden| held(members, hidden));
                    *mend += weight * (together - held(members, &self.hidden));
                }
            }
        }
    }

    fn shared(&mut self, pair: [usize; 2], offset: f32) -> &[f32; BLOCK] {
        let known = self.shared.iter().position(|(of, _)| *of == pair);
        let index = known.unwrap_or_else(|| {
            let mut shared = [0.0; BLOCK];
            self.chords.shared(pair, offset, &mut shared);
            self.shared.push((pair, shared));
            self.shared.len() - 1
        });
        &self.shared[index].1
    }
}

/// A density that is as good as 0, and as far from 1 as good as 1.
const NOTHING: f32 = 1e-4;
