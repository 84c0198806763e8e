//! Occluder fusion: what casters of several elevations hold back of the light together.
//!
//! Each caster's density is drawn by itself. Where at most one of them is neither 0 nor 1, that is all there is to know. Where
//! more are, what they hide of the disc may overlap much or not at all: there the light is followed along chords of the disc
//! ([`chords`]), and what they say of the casters together against each by itself mends the pixel. It is within a level of
//! the union's exact area, however many casters meet.

mod chords;
mod meet;
mod member;
mod pixel;

use core::ops::Range;

use glam::DVec2;

use self::meet::Meet;
use self::member::Member;
use self::pixel::{Pixel, bit};
use super::caster::{AnyShadow, Cast};
use crate::apart::overlapping;
use crate::density::{Each, PixelOptions, Sink};
use crate::grid::Grid;
use crate::scratch::Scratch;

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
            let bit = bit(index);
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
