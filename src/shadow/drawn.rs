//! A shadow's outline as lines and arcs, as fine as its use needs.

use std::borrow::Cow;

use glam::DVec2;

use super::crowding::{crowding, push_arcs, push_curves};
use super::{Shadow, unite};
use crate::density;
use crate::outline::{self, Edge, Fineness, Outline};
use crate::path::Contour;
use crate::shape::{Cover, Shape};

/// The finest flattening over a shape's extent, 2^-30: some 30,000 chords a curve.
const FINEST: f64 = 1.0 / 1_073_741_824.0;

impl Shadow {
    /// The outline with curves cut into lines that move no density by more than `levels`, averaged over pixels of side `pixel` (scene
    /// units) where the penumbra is narrow.
    pub(crate) fn outline_within(&self, levels: f64, pixel: f64) -> Cow<'_, Outline> {
        if self.curved.is_empty() {
            return Cow::Borrowed(&self.fixed);
        }
        let crowding = self.crowding(pixel, false);
        self.outline(density::flatness(levels, self.radius, pixel) / crowding)
    }

    /// The same as polygons: arcs are cut as well.
    pub(crate) fn polygons_within(&self, levels: f64, pixel: f64) -> Vec<Vec<DVec2>> {
        let flatness = density::flatness(levels, self.radius, pixel) / self.crowding(pixel, true);
        let outline = match pixel {
            0.0 => self.outline_within(levels, pixel),
            _ => self.drawn_outline(levels, pixel),
        };
        outline.polygons(flatness)
    }

    /// How much nearer to curves lines have to be because many of these are seen at once; with `arcs`, all that are cut into lines.
    pub(crate) fn crowding(&self, pixel: f64, arcs: bool) -> f64 {
        // What a density is about, a disc or a pixel.
        let seen = self.radius.max(pixel / 2.0);
        // Of what is so hard that chords are as short as they may be, nothing sees many; and of a convex curve a disc sees no more than its
        // own circumference.
        let is_hard = seen <= self.extent() * FINEST;
        let is_convex = self.rounded().is_some();
        let Some((corner, _)) = self.hull().filter(|_| !is_hard && !is_convex) else {
            return 1.0;
        };
        let mut chords = Vec::new();
        push_curves(self.curved.iter().flatten(), seen, &mut chords);
        if arcs {
            push_arcs(self.fixed.edges(), seen, &mut chords);
        }
        crowding(&chords, seen, corner)
    }

    /// The outline with curves cut into lines within `flatness` (scene units) of them.
    pub(crate) fn outline(&self, flatness: f64) -> Cow<'_, Outline> {
        if self.curved.is_empty() {
            return Cow::Borrowed(&self.fixed);
        }
        let mut outline = self.fixed.clone();
        for group in &self.curved {
            let extent = group.iter().map(Shape::extent).fold(0.0, f64::max);
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

    /// The outline for questions that no pixel is in the way of.
    pub(crate) fn exact_outline(&self) -> &Outline {
        if self.curved.is_empty() {
            return &self.fixed;
        }
        self.exact
            .get_or_init(|| self.outline_within(density::EXACT_SHARE, 0.0).into_owned())
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
        // All that it depends on.
        let needed = [
            density::flatness(levels, self.radius, pixel),
            self.radius.max(pixel / 2.0),
        ];
        let make = || self.outline_within(levels, pixel).into_owned();
        let (kept, outline) = self.drawn.get_or_init(|| (needed, make()));
        if *kept == needed {
            Cow::Borrowed(outline)
        } else {
            Cow::Owned(make())
        }
    }
}

/// Turns the edges of loops round if what they enclose lies on their right.
fn turn_left(edges: &mut [Edge]) {
    if outline::area(edges.iter()) < 0.0 {
        outline::reverse(edges);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::light::Light;
    use crate::path::{FillRule, Path};

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
                assert!((outline::area(edges.iter()) / fine - 1.0).abs() < 2e-5);
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
            outline::area(edges.iter())
        });
        assert!(areas[0] > 0.0 && (areas[0] - areas[1]).abs() < 1e-6);
    }

    #[test]
    fn what_is_not_simple_is_drawn_by_its_outline() {
        let light = Light::flutter();
        let both = light.cast_all(&[heart(), letter()], 6.0, 0.0).unwrap();
        let edges = drawn(&both, 0.1);
        // As fine as its pixels need.
        let outline = both.outline_within(0.1, 1.0);
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
