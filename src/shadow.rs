//! Shadow: the door between geometry and numbers.
//!
//! Before it all is about planes and shapes, after it all is about loops of projection circles. Circles of one radius,
//! as every caster parallel to its receiver has them, are kept as an outline and that radius.

use core::borrow::Borrow;
use core::ops::Range;
use std::borrow::Cow;
use std::sync::OnceLock;

use glam::{DAffine2, DVec2};

use crate::apart::{around, overlapping};
use crate::density::rounded::Rounded;
use crate::density::{self, PixelOptions};
use crate::error::Result;
use crate::grid::Grid;
use crate::light::Projection;
use crate::outline::{self, Edge, Fineness, Outline, Winding, resolve};
use crate::paint::Paint;
use crate::path::{Contour, Segment};
use crate::plan;
use crate::scratch::Scratch;
use crate::shape::{Cover, Shape};

/// The shadow of one or more shapes of one elevation on one receiver: everything that a mesh, a picture or a point
/// query is made from.
#[derive(Debug, Clone, Default)]
pub struct Shadow {
    radius: f64,
    /// The loops of the shapes made of lines and circular arcs.
    fixed: Outline,
    /// Those that several shapes make together.
    united: Vec<United>,
    /// The shapes that need flattening, projected; those that may overlap together.
    curved: Vec<Vec<Shape>>,
    /// A box that holds its outline.
    hull: Option<(DVec2, DVec2)>,
    /// The outline as exact as `density_at` promises, made when it is first needed.
    exact: OnceLock<Outline>,
    /// The outline for pixels as it was first asked for, and how far its lines are from their curves.
    drawn: OnceLock<(f64, Outline)>,
    /// The outline as a rounded rectangle, if it is one.
    rounded: Option<Rounded>,
    /// Shadows of one radius that are this one together and do not meet; none if it is a single one.
    parts: Vec<Shadow>,
}

/// Which loops several shapes make together, and the boxes of these shapes.
#[derive(Debug, Clone)]
struct United {
    loops: Range<usize>,
    boxes: Vec<(DVec2, DVec2)>,
}

/// What parts of a shadow are made of.
enum Piece {
    Loops(Vec<Vec<Edge>>),
    Shapes(Vec<Shape>),
}

/// How many edges an outline is drawn as, how long they are together and how large its box, in scene units.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Census {
    pub(crate) lines: f64,
    pub(crate) line_length: f64,
    pub(crate) arcs: f64,
    pub(crate) arc_length: f64,
    /// Curves that are drawn as arcs, and from end to end.
    pub(crate) curves: f64,
    pub(crate) curve_length: f64,
    /// Lines, arcs and curves as they were given.
    pub(crate) pieces: f64,
    pub(crate) size: DVec2,
}

impl Census {
    pub(crate) fn add(&mut self, edge: &Edge) {
        match edge {
            Edge::Arc(arc) => {
                self.arcs += 1.0;
                self.arc_length += arc.sweep.abs() * arc.radius;
            }
            Edge::Line(line) | Edge::Border(line) => {
                self.lines += 1.0;
                self.line_length += (line.to - line.from).length();
            }
        }
    }
}

/// A box from its least to its largest x and y, in scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The least x and y.
    pub min: [f32; 2],
    /// The largest x and y.
    pub max: [f32; 2],
}

impl Bounds {
    /// The smallest box of `f32` that holds both points.
    pub(crate) fn outwards(min: DVec2, max: DVec2) -> Self {
        let down = |v: f64| {
            let near = v as f32;
            if f64::from(near) > v {
                near.next_down()
            } else {
                near
            }
        };
        let up = |v: f64| {
            let near = v as f32;
            if f64::from(near) < v {
                near.next_up()
            } else {
                near
            }
        };
        Self {
            min: [down(min.x), down(min.y)],
            max: [up(max.x), up(max.y)],
        }
    }
}

impl Shadow {
    /// The shadow that is nowhere.
    pub(crate) fn empty() -> Self {
        Self::default()
    }

    pub(crate) fn project<S: Borrow<Shape>>(shapes: &[S], projection: &Projection) -> Self {
        let affine = projection.affine();
        let mut shadow = Self {
            radius: projection.radius,
            ..Self::default()
        };
        let boxed = shapes.iter().filter_map(|shape| {
            let shape = shape.borrow().mapped(&affine);
            shape.hull().map(|(min, max)| (min, max, shape))
        });
        for group in overlapping(boxed.collect()) {
            let outlines: Option<Vec<Outline>> = group.iter().map(Outline::of_simple).collect();
            match outlines {
                Some(mut outlines) if outlines.len() == 1 => {
                    shadow.fixed.append(outlines.remove(0));
                }
                // Of arcs a union makes lines, as fine as the use asks for.
                Some(outlines) if group.iter().all(Shape::is_straight) => {
                    let first = shadow.fixed.loops.len();
                    shadow.fixed.append(unite(&outlines, 1.0));
                    shadow.united.push(United {
                        loops: first..shadow.fixed.loops.len(),
                        boxes: group.iter().filter_map(Shape::hull).collect(),
                    });
                }
                _ => shadow.curved.push(group),
            }
        }
        shadow.find_parts();
        shadow
    }

    /// The hard shadow of an outline on its own plane.
    pub(crate) fn of_outline(fixed: Outline) -> Self {
        let mut shadow = Self {
            fixed,
            ..Self::default()
        };
        shadow.find_parts();
        shadow
    }

    /// Loops whose shadows are apart are drawn by what suits each best.
    fn find_parts(&mut self) {
        self.parts.clear();
        self.measure();
        // No pixel is to see two parts: their densities would be rounded twice. A narrow penumbra is averaged over pixels.
        let reach = if self.radius < 3.0 {
            self.radius + 1.0
        } else {
            self.radius
        };
        // What several shapes are together is apart from what all of them are apart from, so that what is far away does not decide
        // how a shape is drawn: a box about all of them would.
        let mut pieces: Vec<Piece> = Vec::new();
        let mut boxed: Vec<(DVec2, DVec2, usize)> = Vec::new();
        let mut add = |boxes: &[(DVec2, DVec2)], piece: Piece| {
            let number = pieces.len();
            boxed.extend(
                boxes
                    .iter()
                    .map(|(min, max)| (*min - reach, *max + reach, number)),
            );
            pieces.push(piece);
        };
        let mut next = 0;
        for United { loops, boxes } in &self.united {
            self.add_loops(next..loops.start, &mut add);
            add(
                boxes,
                Piece::Loops(self.fixed.loops[loops.clone()].to_vec()),
            );
            next = loops.end;
        }
        self.add_loops(next..self.fixed.loops.len(), &mut add);
        for shapes in &self.curved {
            let boxes: Vec<_> = shapes.iter().filter_map(Shape::hull).collect();
            add(&boxes, Piece::Shapes(shapes.clone()));
        }
        let groups = overlapping(boxed);
        if groups.len() < 2 {
            return;
        }
        let mut pieces: Vec<Option<Piece>> = pieces.into_iter().map(Some).collect();
        self.parts = groups
            .into_iter()
            .map(|mut group| {
                let mut part = Self {
                    radius: self.radius,
                    ..Self::default()
                };
                group.sort_unstable();
                for piece in group {
                    // A piece of several boxes is there as many times.
                    match pieces[piece].take() {
                        Some(Piece::Loops(loops)) => part.fixed.loops.extend(loops),
                        Some(Piece::Shapes(shapes)) => part.curved.push(shapes),
                        None => {}
                    }
                }
                part.measure();
                part
            })
            .collect();
    }

    /// Adds loops one by one, with their boxes.
    fn add_loops(&self, loops: Range<usize>, mut add: impl FnMut(&[(DVec2, DVec2)], Piece)) {
        for edges in &self.fixed.loops[loops] {
            if let Some(bounds) = outline::bounds(edges.iter()) {
                add(&[bounds], Piece::Loops(vec![edges.clone()]));
            }
        }
    }

    /// Finds what is asked for again and again.
    fn measure(&mut self) {
        let curved = self.curved.iter().flatten().filter_map(Shape::hull);
        let hulls = self.fixed.bounds().into_iter().chain(curved);
        self.hull = around(hulls);
        self.rounded = if self.curved.is_empty() {
            Rounded::of(&self.fixed)
        } else {
            None
        };
    }

    /// The shadows that this one is drawn as on pixels of which there are so many a scene unit.
    pub(crate) fn parts(&self, per_unit: f64) -> &[Self] {
        if self.parts.is_empty() || per_unit < 1.0 {
            core::slice::from_ref(self)
        } else {
            &self.parts
        }
    }

    /// Those of [`Self::parts`] that a grid may show, or one that is larger by a `margin` of so many pixels.
    pub(crate) fn parts_on(&self, grid: &Grid, margin: f64) -> impl Iterator<Item = &Self> {
        let per_unit = grid.pixels_per_unit();
        let is_shown = move |part: &&Self| {
            let reach = part.reach(per_unit);
            reach.is_some_and(|(min, max)| grid.meets((min - margin, max + margin)))
        };
        self.parts(per_unit).iter().filter(is_shown)
    }

    /// The same outline seen through another penumbra radius.
    pub(crate) fn with_radius(&self, radius: f64) -> Self {
        let mut shadow = Self {
            radius,
            fixed: self.fixed.clone(),
            united: self.united.clone(),
            curved: self.curved.clone(),
            ..Self::default()
        };
        shadow.find_parts();
        shadow
    }

    /// The same shadow moved by `offset`.
    pub(crate) fn moved(&self, offset: DVec2) -> Self {
        let affine = DAffine2::from_translation(offset);
        let moved = |group: &Vec<Shape>| group.iter().map(|shape| shape.mapped(&affine)).collect();
        let united = |United { loops, boxes }: &United| {
            let boxes = boxes
                .iter()
                .map(|(min, max)| (*min + offset, *max + offset));
            United {
                loops: loops.clone(),
                boxes: boxes.collect(),
            }
        };
        let mut shadow = Self {
            radius: self.radius,
            fixed: self.fixed.moved(offset),
            united: self.united.iter().map(united).collect(),
            curved: self.curved.iter().map(moved).collect(),
            ..Self::default()
        };
        shadow.find_parts();
        shadow
    }

    /// The loops of the shapes made of lines and circular arcs.
    pub(crate) fn fixed(&self) -> &Outline {
        &self.fixed
    }

    /// The shapes that need flattening, those that may overlap together.
    pub(crate) fn curved(&self) -> &[Vec<Shape>] {
        &self.curved
    }

    /// The larger side of a box that holds the outline, in scene units.
    pub(crate) fn extent(&self) -> f64 {
        self.hull()
            .map_or(0.0, |(min, max)| (max - min).max_element())
    }

    /// A box that holds the outline, in scene units.
    pub(crate) fn hull(&self) -> Option<(DVec2, DVec2)> {
        self.hull
    }

    /// The box of the pixels that see it, in pixels of which there are so many a scene unit.
    pub(crate) fn reach(&self, per_unit: f64) -> Option<(DVec2, DVec2)> {
        let hull = self.hull?;
        Some(density::reached(hull, self.radius, per_unit))
    }

    /// The penumbra radius r, in scene units: how far from the outline the penumbra reaches, both ways.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Whether there is no shadow at all: the caster touches its receiver or covers no area.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.exact_outline().is_empty()
    }

    /// The outline with curves cut into lines within `flatness` (scene units) of them.
    pub(crate) fn outline(&self, flatness: f64) -> Cow<'_, Outline> {
        if self.curved.is_empty() {
            return Cow::Borrowed(&self.fixed);
        }
        let mut outline = self.fixed.clone();
        for group in &self.curved {
            let extent = group
                .iter()
                .filter_map(Shape::hull)
                .map(|(min, max)| (max - min).max_element())
                .fold(0.0, f64::max);
            // For a nearly hard shadow the rule would ask for chords without end.
            let flatness = flatness.max(extent * FINEST);
            let outlines: Vec<Outline> = group
                .iter()
                .map(|shape| Outline::of_flattened(shape, flatness))
                .collect();
            outline.append(unite(&outlines, flatness));
        }
        Cow::Owned(outline)
    }

    /// Whether the outline is exact: no curve of it is cut into lines.
    pub(crate) fn is_fixed(&self) -> bool {
        self.curved.is_empty()
    }

    /// The outline for questions that no pixel is in the way of.
    pub(crate) fn exact_outline(&self) -> &Outline {
        if self.curved.is_empty() {
            return &self.fixed;
        }
        self.exact.get_or_init(|| {
            self.outline(density::flatness(density::EXACT_SHARE, self.radius, 0.0))
                .into_owned()
        })
    }

    /// What there is to draw.
    pub(crate) fn census(&self) -> Census {
        // What is left when fills are resolved is drawn as about so many lines a curve.
        const LINES: f64 = 40.0;
        let mut census = Census::default();
        for edge in self.fixed.edges() {
            census.pieces += 1.0;
            census.add(edge);
        }
        let simple = self.has_simple_curves();
        for contour in self
            .curved
            .iter()
            .flatten()
            .flat_map(|shape| &shape.contours)
        {
            let mut from = contour.start;
            for segment in &contour.segments {
                census.pieces += 1.0;
                let length = (segment.end() - from).length();
                if !simple {
                    census.lines += LINES;
                    census.line_length += length;
                } else if matches!(segment, Segment::Line(_)) {
                    census.lines += 1.0;
                    census.line_length += length;
                } else {
                    census.curves += 1.0;
                    census.curve_length += length;
                }
                from = segment.end();
            }
        }
        census.size = self.hull().map_or(DVec2::ZERO, |(min, max)| max - min);
        census
    }

    /// Whether its curves need no fill rule.
    pub(crate) fn has_simple_curves(&self) -> bool {
        let simple =
            |group: &Vec<Shape>| matches!(group.as_slice(), [only] if only.cover == Cover::Simple);
        self.curved.iter().all(simple)
    }

    /// Pushes the outline's edges as lines and circular arcs, loop after loop: on pixels of side `pixel` (scene units)
    /// no density moves by more than `levels`.
    ///
    /// Curves known to be simple take few lines and no memory of their own.
    pub(crate) fn edges_into(&self, levels: f64, pixel: f64, out: &mut Vec<Edge>) {
        self.fit(levels, pixel, Contour::chords, out);
    }

    /// The same with arcs in place of curves known to be simple.
    pub(crate) fn arcs_into(&self, levels: f64, pixel: f64, out: &mut Vec<Edge>) {
        self.fit(levels, pixel, Contour::arcs, out);
    }

    fn fit(
        &self,
        levels: f64,
        pixel: f64,
        push: impl Fn(&Contour, &Fineness, &mut Vec<Edge>),
        out: &mut Vec<Edge>,
    ) {
        if !self.has_simple_curves() {
            out.extend(self.drawn_outline(levels, pixel).edges());
            return;
        }
        out.extend(self.fixed.edges());
        let fineness = Fineness::new(levels, self.radius, pixel);
        for shape in self.curved.iter().flatten() {
            let first = out.len();
            for contour in &shape.contours {
                push(contour, &fineness, out);
            }
            turn_left(&mut out[first..]);
        }
    }

    /// The outline for pixels of side `pixel`, with lines that move no density by more than `levels`, kept for one size of pixels; the
    /// exact one where there are none.
    pub(crate) fn drawn_outline(&self, levels: f64, pixel: f64) -> Cow<'_, Outline> {
        if self.curved.is_empty() || pixel == 0.0 {
            return Cow::Borrowed(self.exact_outline());
        }
        let needed = density::flatness(levels, self.radius, pixel);
        let make = || self.outline(needed).into_owned();
        let (kept, outline) = self.drawn.get_or_init(|| (needed, make()));
        if *kept == needed {
            Cow::Borrowed(outline)
        } else {
            Cow::Owned(make())
        }
    }

    /// The outline as a rounded rectangle, if it is one.
    pub(crate) fn rounded(&self) -> Option<Rounded> {
        self.rounded
    }

    /// The smallest box outside of which the density is 0, or none for an empty shadow. No density is computed for it.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        let (min, max) = self.exact_outline().bounds()?;
        Some(Bounds::outwards(
            min - DVec2::splat(self.radius),
            max + DVec2::splat(self.radius),
        ))
    }

    /// The density at a point (x, y) of the receiver, in closed form: the fraction of the light's disc that the caster
    /// hides from it, from 0 to 1. Lines and circular arcs are exact to 1e-9; other curves within 0.02 level.
    ///
    /// A point that is not finite is nowhere in the shadow: its density is 0.
    #[must_use]
    pub fn density_at(&self, point: [f32; 2]) -> f64 {
        let point = DVec2::new(f64::from(point[0]), f64::from(point[1]));
        if !point.is_finite() {
            return 0.0;
        }
        density::at_point(self.exact_outline().edges(), point, self.radius)
    }

    /// Writes the densities on a grid of pixels as 8-bit coverage, 255 where the light's disc is wholly hidden and 0
    /// outside of the shadow: every pixel of the grid is written, nothing else of the buffer is. Within one level, and half
    /// of one for the rounding.
    ///
    /// # Errors
    /// [`Error::BufferSize`](crate::Error::BufferSize) when `mask` is shorter than the grid needs.
    pub fn fill_a8(&self, grid: &Grid, mask: &mut [u8], scratch: &mut Scratch) -> Result<()> {
        self.fill_a8_with(grid, mask, &PixelOptions::default(), scratch)
    }

    /// As [`Shadow::fill_a8`], with options; hidden pixels are 0.
    ///
    /// # Errors
    /// As [`Shadow::fill_a8`], and options for another grid.
    pub fn fill_a8_with(
        &self,
        grid: &Grid,
        mask: &mut [u8],
        options: &PixelOptions<'_>,
        scratch: &mut Scratch,
    ) -> Result<()> {
        let mut sink = options.onto_mask(grid, mask, scratch.level())?;
        if plan::skip(self, grid, options, Some(1.0)).is_none() {
            density::draw(self, grid, options, scratch, &mut sink);
        }
        Ok(())
    }

    /// Writes the densities on a grid of pixels, from 0 to 1: every pixel of the grid is written, nothing else of the buffer
    /// is. Hidden pixels are 0.
    ///
    /// # Errors
    /// [`Error::BufferSize`](crate::Error::BufferSize) when `densities` is shorter than the grid needs, and options for
    /// another grid.
    pub fn fill_f32(
        &self,
        grid: &Grid,
        densities: &mut [f32],
        options: &PixelOptions<'_>,
        scratch: &mut Scratch,
    ) -> Result<()> {
        let mut sink = options.onto_densities(grid, densities)?;
        if plan::skip(self, grid, options, None).is_none() {
            density::draw(self, grid, options, scratch, &mut sink);
        }
        Ok(())
    }

    /// Blends the shadow onto premultiplied RGBA8 pixels, source over, in one pass: no mask is made. The grid's stride
    /// counts pixels, 4 bytes each; pixels outside of the shadow, hidden ones and the rest of the buffer stay as they are.
    ///
    /// # Errors
    /// [`Error::BufferSize`](crate::Error::BufferSize) when `pixels` is shorter than the grid needs, and options for another
    /// grid.
    pub fn blend_rgba8(
        &self,
        grid: &Grid,
        pixels: &mut [u8],
        paint: &Paint,
        options: &PixelOptions<'_>,
        scratch: &mut Scratch,
    ) -> Result<()> {
        let mut sink = options.onto_rgba8(grid, pixels, paint, scratch)?;
        if plan::skip(self, grid, options, Some(paint.opacity())).is_none() {
            density::draw(self, grid, options, scratch, &mut sink);
        }
        Ok(())
    }
}

/// The finest flattening over a shape's extent, 2^-30: some 30,000 chords a curve.
const FINEST: f64 = 1.0 / 1_073_741_824.0;

impl Shape {
    fn is_straight(&self) -> bool {
        self.contours.iter().all(Contour::is_straight)
    }
}

/// Turns the edges of loops round if what they enclose lies on their right.
pub(crate) fn turn_left(edges: &mut [Edge]) {
    // Far from the origin the areas would cancel.
    let origin = edges.first().map_or(DVec2::ZERO, Edge::from);
    if edges
        .iter()
        .map(|edge| edge.double_area(origin))
        .sum::<f64>()
        < 0.0
    {
        edges.reverse();
        for edge in edges {
            *edge = edge.reversed();
        }
    }
}

/// The outline of what outlines cover together.
fn unite(outlines: &[Outline], flatness: f64) -> Outline {
    match outlines {
        [only] => only.clone(),
        several => {
            let polygons: Vec<Vec<DVec2>> = several
                .iter()
                .flat_map(|outline| outline.polygons(flatness))
                .collect();
            resolve(&polygons, Winding::Rule(crate::path::FillRule::NonZero))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use crate::path::{FillRule, Path};

    #[test]
    fn abutting_rectangles_are_one_outline() {
        let light = Light::directional([0.0, 1.0], 1.0).unwrap();
        let left = Shape::rect(0.0, 0.0, 10.0, 10.0).unwrap();
        let right = Shape::rect(10.0, 0.0, 10.0, 10.0).unwrap();
        let joined = Shape::rect(0.0, 0.0, 20.0, 10.0).unwrap();
        let two = light.cast_all(&[&left, &right], 4.0, 0.0).unwrap();
        let one = light.cast(&joined, 4.0, 0.0).unwrap();
        assert_eq!(two.exact_outline(), one.exact_outline());
        assert_eq!(two.density_at([10.0, 9.0]), one.density_at([10.0, 9.0]));
    }

    #[test]
    fn shapes_apart_keep_their_arcs() {
        let light = Light::directional([0.0, 1.0], 1.0).unwrap();
        let cards: Vec<Shape> = (0_u8..9)
            .map(|i| {
                Shape::rounded_rect(
                    f32::from(i % 3) * 30.0,
                    f32::from(i / 3) * 30.0,
                    20.0,
                    20.0,
                    4.0,
                )
                .unwrap()
            })
            .collect();
        let shadow = light
            .cast_all(&cards.iter().collect::<Vec<_>>(), 4.0, 0.0)
            .unwrap();
        assert_eq!(shadow.exact_outline().loops.len(), 9);
        assert_eq!(shadow.exact_outline().edges().count(), 72);
    }

    #[test]
    fn overlapping_curves_count_once() {
        let light = Light::directional([0.0, 1.0], 1.0).unwrap();
        let a = Shape::circle([0.0, 0.0], 5.0).unwrap();
        let b = Shape::circle([1.0, 0.0], 2.0).unwrap();
        let shadow = light.cast_all(&[&a, &b], 0.1, 0.0).unwrap();
        let alone = light.cast(&a, 0.1, 0.0).unwrap();
        assert!((shadow.exact_outline().area() - alone.exact_outline().area()).abs() < 1e-3);
        assert!((shadow.density_at([1.0, 0.0]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn bounds_hold_the_penumbra_and_no_more() {
        let light = Light::new([0.0, 0.0, 100.0], 10.0).unwrap();
        let shadow = light
            .cast(&Shape::rect(-10.0, -20.0, 20.0, 40.0).unwrap(), 50.0, 0.0)
            .unwrap();
        assert_eq!(
            shadow.bounds(),
            Some(Bounds {
                min: [-30.0, -50.0],
                max: [30.0, 50.0]
            })
        );
        assert!(
            light
                .cast(&Shape::rect(0.0, 0.0, 1.0, 1.0).unwrap(), 5.0, 5.0)
                .unwrap()
                .bounds()
                .is_none()
        );
    }

    #[test]
    fn a_polygon_that_cancels_itself_casts_nothing() {
        let light = Light::flutter();
        let ring = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let twice = Shape::polygon(&[ring, ring], FillRule::EvenOdd).unwrap();
        let shadow = light.cast(&twice, 2.0, 0.0).unwrap();
        assert!(shadow.is_empty());
        assert_eq!(shadow.density_at([2.0, 4.0]), 0.0);
    }

    /// Cubics one after another, from the first point on.
    fn cubics(from: [f32; 2], curves: &[[f32; 6]]) -> Shape {
        let mut path = Path::new();
        path.move_to(from);
        for &[a, b, c, d, x, y] in curves {
            path.cubic_to([a, b], [c, d], [x, y]);
        }
        Shape::path(&path, FillRule::NonZero).unwrap()
    }

    fn heart() -> Shape {
        cubics(
            [180.0, 280.0],
            &[
                [60.0, 200.0, 40.0, 130.0, 70.0, 95.0],
                [105.0, 55.0, 160.0, 70.0, 180.0, 115.0],
                [200.0, 70.0, 255.0, 55.0, 290.0, 95.0],
                [320.0, 130.0, 300.0, 200.0, 180.0, 280.0],
            ],
        )
    }

    /// A letter S with strokes of about 12.
    fn letter() -> Shape {
        cubics(
            [72.0, 26.0],
            &[
                [66.0, 12.0, 50.0, 6.0, 36.0, 8.0],
                [18.0, 10.0, 8.0, 22.0, 10.0, 36.0],
                [12.0, 50.0, 26.0, 54.0, 40.0, 58.0],
                [54.0, 62.0, 64.0, 64.0, 64.0, 76.0],
                [64.0, 86.0, 52.0, 92.0, 40.0, 91.0],
                [26.0, 90.0, 18.0, 82.0, 14.0, 72.0],
                [11.0, 74.0, 7.0, 76.0, 4.0, 78.0],
                [10.0, 94.0, 24.0, 102.0, 40.0, 102.0],
                [60.0, 102.0, 76.0, 92.0, 76.0, 75.0],
                [76.0, 56.0, 58.0, 52.0, 44.0, 48.0],
                [30.0, 44.0, 22.0, 42.0, 22.0, 34.0],
                [22.0, 24.0, 30.0, 18.0, 40.0, 18.0],
                [50.0, 18.0, 58.0, 24.0, 62.0, 32.0],
            ],
        )
    }

    fn drawn(shadow: &Shadow, levels: f64) -> Vec<Edge> {
        let mut edges = Vec::new();
        shadow.edges_into(levels, 1.0, &mut edges);
        edges
    }

    fn area(edges: &[Edge]) -> f64 {
        let origin = edges[0].from();
        edges
            .iter()
            .map(|edge| edge.double_area(origin))
            .sum::<f64>()
            / 2.0
    }

    #[test]
    fn few_lines_draw_the_same_densities() {
        const SIDE: u32 = 20;
        for (name, shape) in [("heart", heart()), ("letter", letter())] {
            assert_eq!(shape.cover, Cover::Simple);
            for radius in [0.5_f32, 2.0, 8.0, 22.0, 60.0] {
                let light = Light::directional([0.0, 0.0], radius).unwrap();
                let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
                let edges = drawn(&shadow, 0.1);
                let exact = shadow.exact_outline();
                let (min, max) = exact.bounds().unwrap();
                let radius = f64::from(radius);
                let mut worst: f64 = 0.0;
                for index in 0..SIDE * SIDE {
                    let share = DVec2::new(f64::from(index % SIDE), f64::from(index / SIDE));
                    let share = (share + 0.5) / f64::from(SIDE);
                    let point = min - radius + (max - min + 2.0 * radius) * share;
                    let density = density::at_point(edges.iter(), point, radius);
                    let error = density - density::at_point(exact.edges(), point, radius);
                    worst = worst.max(error.abs() * 255.0);
                }
                let (lines, before) = (edges.len(), exact.edges().count());
                println!("{name}, r {radius}: {lines} for {before} lines, {worst:.3} levels");
                assert!(worst < 0.1, "{name}, r {radius}: {worst} levels");
                assert!(lines < before);
                let fine = shadow.outline(1e-3).area();
                assert!((area(&edges) / fine - 1.0).abs() < 2e-5);
            }
        }
    }

    #[test]
    fn drawn_edges_are_oriented_and_take_no_more_memory() {
        let light = Light::flutter();
        let mirrored = heart()
            .transformed([-1.0, 0.0, 0.0, 1.0, 0.0, 0.0])
            .unwrap();
        let areas = [heart(), mirrored].map(|shape| {
            let shadow = light.cast(&shape, 6.0, 0.0).unwrap();
            let mut edges = drawn(&shadow, 0.5);
            let (before, capacity) = (edges.clone(), edges.capacity());
            edges.clear();
            shadow.edges_into(0.5, 1.0, &mut edges);
            assert_eq!((&edges, edges.capacity()), (&before, capacity));
            area(&edges)
        });
        assert!(areas[0] > 0.0 && (areas[0] - areas[1]).abs() < 1e-6);
    }

    #[test]
    fn what_is_not_simple_is_drawn_by_its_outline() {
        let light = Light::flutter();
        let both = light.cast_all(&[heart(), letter()], 6.0, 0.0).unwrap();
        let edges = drawn(&both, 0.1);
        // As fine as its pixels need.
        let outline = both.outline(density::flatness(0.1, both.radius(), 1.0));
        assert_eq!(edges.len(), outline.edges().count());
        assert!(edges.len() < both.exact_outline().edges().count());
        // A hard edge's outline is as fine as pixels need.
        let hard = Light::directional([0.0, 0.0], 0.0).unwrap();
        let hard = hard.cast_all(&[heart(), letter()], 6.0, 0.0).unwrap();
        assert!(drawn(&hard, 0.1).len() < 10_000);
        // Shapes apart from each other are all drawn by few lines, those that are fixed among them.
        let card = Shape::rect(400.0, 0.0, 50.0, 50.0).unwrap();
        let apart = light.cast_all(&[heart(), card], 6.0, 0.0).unwrap();
        let alone = light.cast(&heart(), 6.0, 0.0).unwrap();
        assert_eq!(drawn(&apart, 0.1).len(), drawn(&alone, 0.1).len() + 4);
    }
}
