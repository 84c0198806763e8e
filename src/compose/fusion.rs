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
        |cast: &&Cast| overlap == Overlap::SourceOver || matches!(cast.shadow, AnyShadow::Alpha(_));
    let (alone, together): (Vec<&Cast>, Vec<&Cast>) = casts.iter().partition(is_alone);
    let boxed = together.into_iter().filter_map(|cast| {
        let (min, max) = cast.shadow.reach(1.0)?;
        Some((min, max, cast))
    });
    let mut groups = overlapping(boxed.collect());
    for group in &mut groups {
        group.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    }
    groups.extend(alone.into_iter().map(|cast| vec![cast]));
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
    /// What the first two that hide a part of the disc hide, the second negative if there are more.
    partial: [f32; 2],
}

impl Pixel {
    fn add(&mut self, density: f32, strength: f32, opacity: f32) {
        let hides = opacity * density * (1.0 - self.met);
        self.held += strength * hides;
        self.met += hides;
        if density > 0.0 && density < 1.0 {
            match &mut self.partial {
                [first, _] if *first == 0.0 => *first = density,
                [_, second] if *second == 0.0 => *second = density,
                [_, second] => *second = -second.abs(),
            }
        }
    }

    fn mend(&mut self, by: f32) {
        self.held = (self.held + by).clamp(0.0, 1.0);
    }

    /// Whether several casts hide a part of the disc.
    fn is_shared(&self) -> bool {
        self.partial[1] != 0.0
    }

    /// What two casts hide, if no more than two hide a part of the disc.
    fn pair(&self) -> Option<[f32; 2]> {
        (self.partial[1] > 0.0).then_some(self.partial)
    }
}

/// A cast as pixels see it: its box in pixels, and what of it its chords need.
struct Member {
    min: DVec2,
    max: DVec2,
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
        for cast in group {
            let (strength, opacity) = (cast.strength as f32, cast.opacity as f32);
            let mut pass = Each {
                pixels: &mut self.pixels,
                stride: width,
                put: |pixel: &mut Pixel, density: f32| pixel.add(density, strength, opacity),
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
        for row in 0..rows.len() {
            if members.len() > 1 {
                let pixels = &mut self.pixels[row * width..][..width];
                let start = window.corner() + DVec2::new(0.0, row as f64);
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

impl Member {
    fn new(cast: &Cast, scale: f64) -> Option<Self> {
        let (min, max) = cast.shadow.reach(scale)?;
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
            min,
            max,
            strength: cast.strength as f32,
            opacity: cast.opacity as f32,
            kind,
        })
    }

    /// Whether the pixel that begins at `corner` may see it, and for how many pixels to the right that stays so.
    fn is_near(&self, corner: DVec2) -> (bool, f64) {
        match &self.kind {
            // Of casters that are drawn as one those far away are not to matter.
            Kind::Level(occluder) => {
                let reach = occluder.radius + averaged_side(occluder.radius) / 2.0;
                occluder.is_near(corner, reach)
            }
            Kind::Tilted(_) => {
                let is_near = self.min.cmplt(corner + 1.0).all() && self.max.cmpgt(corner).all();
                (is_near, 1.0)
            }
        }
    }
}

/// How far lines in place of curves may move what casters hide together, in levels.
const FLATNESS: f64 = 0.2;

/// The disc of a hard shadow, in pixels: next to the pixel's square it is a point.
const LEAST_RADIUS: f64 = 1e-3;

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

impl Default for Meet {
    fn default() -> Self {
        Self {
            level: Level::new(),
            chords: Chords::default(),
            densities: Vec::new(),
            shared: Vec::new(),
            partial: Vec::new(),
            hidden: Vec::new(),
        }
    }
}

/// Memory to follow the light where casters meet.
#[derive(Debug)]
struct Meet {
    level: Level,
    chords: Chords,
    densities: Vec<[f32; BLOCK]>,
    /// What both of two casters hide, as far as it was asked for.
    shared: Vec<([usize; 2], [f32; BLOCK])>,
    partial: Vec<usize>,
    hidden: Vec<f32>,
}

impl Meet {
    /// Mends the pixels of a row, the first of which begins at `start`, from which several members hide a part of the disc.
    fn mend(&mut self, members: &[Member], start: DVec2, pixels: &mut [Pixel]) {
        let mut index = 0;
        while let Some(next) = pixels[index..].iter().position(Pixel::is_shared) {
            index += next;
            let corner = start + DVec2::new(index as f64, 0.0);
            // As far as the same members are near, so that it does not matter where a picture begins.
            let mut near = Vec::with_capacity(members.len());
            let mut same = BLOCK as f64;
            for member in members {
                let (is_near, count) = member.is_near(corner);
                same = same.min(count);
                if is_near {
                    near.push(member);
                }
            }
            let count = pixels[index..]
                .iter()
                .take(same as usize)
                .take_while(|pixel| pixel.is_shared())
                .count()
                .max(1);
            let run = &mut pixels[index..index + count];
            if !self.mend_lines(&near, corner, run) {
                self.mend_run(&near, corner, run);
            }
            index += count;
        }
    }

    /// Mends pixels from which two members show one straight edge each, and the two are parallel: one hides what the other does,
    /// or what it does not. Tells whether they were such.
    fn mend_lines(&self, near: &[&Member], corner: DVec2, run: &mut [Pixel]) -> bool {
        let [Kind::Level(a), Kind::Level(b)] =
            near.iter().map(|member| &member.kind).collect::<Vec<_>>()[..]
        else {
            return false;
        };
        if averaged_side(a.radius.min(b.radius)) > 0.0 {
            return false;
        }
        let [Some(of_a), Some(of_b)] =
            [a, b].map(|occluder| occluder.single_line(corner + 0.5, run.len()))
        else {
            return false;
        };
        if of_a.perp_dot(of_b).abs() > PARALLEL * of_a.length() * of_b.length() {
            return false;
        }
        let is_same_way = of_a.dot(of_b) > 0.0;
        for pixel in run {
            let Some([a, b]) = pixel.pair() else {
                continue;
            };
            let shared = if is_same_way {
                a.min(b)
            } else {
                (a + b - 1.0).max(0.0)
            };
            pixel.mend(cross(near, [0, 1], &mut [a, b]) * (shared - a * b));
        }
        true
    }

    fn mend_run(&mut self, near: &[&Member], corner: DVec2, run: &mut [Pixel]) {
        let is_pair = near.len() == 2
            && near.iter().all(|member| match &member.kind {
                Kind::Level(occluder) => averaged_side(occluder.radius) == 0.0,
                Kind::Tilted(_) => false,
            });
        if is_pair {
            self.place(near, corner + 0.5);
            let mut shared = [0.0; BLOCK];
            self.chords.shared(self.level, [0, 1], 0.0, &mut shared);
            for (pixel, shared) in run.iter_mut().zip(shared) {
                let Some([a, b]) = pixel.pair() else {
                    continue;
                };
                pixel.mend(cross(near, [0, 1], &mut [a, b]) * (shared - a * b));
            }
            return;
        }
        // Of many radii each point sees a polygon of its own.
        let is_tilted = |member: &&Member| matches!(member.kind, Kind::Tilted(_));
        let most = if near.iter().any(is_tilted) { 1 } else { BLOCK };
        for (chunk, pixels) in run.chunks_mut(most).enumerate() {
            let corner = corner + DVec2::new((chunk * most) as f64, 0.0);
            let mends = self.mends(near, corner);
            for (pixel, mend) in pixels.iter_mut().zip(mends) {
                pixel.mend(mend);
            }
        }
    }

    /// By how much members hold back more than their densities alone tell, for a row of pixels whose first one begins at
    /// `corner`.
    fn mends(&mut self, members: &[&Member], corner: DVec2) -> [f32; BLOCK] {
        let radii = members.iter().filter_map(|member| match &member.kind {
            Kind::Level(occluder) => Some(occluder.radius),
            Kind::Tilted(_) => None,
        });
        let radius = radii.fold(f64::MAX, f64::min);
        let side = averaged_side(radius);
        let mut mends = [0.0; BLOCK];
        let middle = corner + 0.5;
        if side == 0.0 {
            self.place(members, middle);
            self.add(members, 0.0, 1.0, &mut mends);
            return mends;
        }
        let mut placed = f64::NAN;
        for (point, weight) in quadrature::square(radius) {
            if point.y != placed {
                placed = point.y;
                self.place(members, middle + DVec2::new(0.0, point.y * side));
            }
            self.add(members, point.x * side, weight as f32, &mut mends);
        }
        mends
    }

    /// Finds the chords of the points from `at` on.
    fn place(&mut self, members: &[&Member], at: DVec2) {
        let seen: Vec<(Cow<'_, Occluder>, DVec2)> = members
            .iter()
            .map(|member| match &member.kind {
                Kind::Level(occluder) => (Cow::Borrowed(occluder), at),
                Kind::Tilted(loops) => (Cow::Owned(Occluder::seen_from(at, loops)), DVec2::ZERO),
            })
            .collect();
        self.chords
            .place(seen.iter().map(|(occluder, at)| (occluder.as_ref(), *at)));
    }

    /// Adds what is to be mended at the points that are whole pixels and `offset` behind the first.
    fn add(&mut self, members: &[&Member], offset: f64, weight: f32, mends: &mut [f32; BLOCK]) {
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
                    let x = lane as f64 + offset;
                    let together = self.chords.held(x, |hidden| held(members, hidden));
                    *mend += weight * (together - held(members, &self.hidden));
                }
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

/// A density that is as good as 0, and as far from 1 as good as 1.
const NOTHING: f32 = 1e-4;
