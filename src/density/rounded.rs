//! Rounded rectangles among outlines.

use glam::DVec2;

use crate::outline::{self, Edge, Outline};

/// The largest rectangle, in pixels, that is told from one whose sides are not quite level: rectangles are found within 1e-9 of their
/// size.
pub(crate) const LARGEST: f64 = 1e5;

/// A rectangle along the axes with circular corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rounded {
    pub(crate) min: DVec2,
    pub(crate) max: DVec2,
    /// The corners' radii: at the least x and y, and on round by growing angles.
    pub(crate) radii: [f64; 4],
}

impl Rounded {
    /// The outline as a rounded rectangle, if it is one.
    pub(crate) fn of(outline: &Outline) -> Option<Self> {
        match outline.loops.as_slice() {
            [edges] => Self::of_loop(edges),
            _ => None,
        }
    }

    /// The loop as a rounded rectangle, if it is one.
    pub(crate) fn of_loop(edges: &[Edge]) -> Option<Self> {
        if edges.len() > 8 {
            return None;
        }
        let (min, max) = outline::bounds(edges.iter())?;
        // What rounding may move an edge by.
        let slack = (max - min).max_element() * 1e-9;
        let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
        let mut radii = [0.0; 4];
        for edge in edges {
            match edge {
                Edge::Line(line) => {
                    let along = (line.to - line.from).abs();
                    let on_side = |axis: usize| {
                        along[axis] <= slack
                            && ((line.from[axis] - min[axis]).abs() <= slack
                                || (line.from[axis] - max[axis]).abs() <= slack)
                    };
                    if !on_side(0) && !on_side(1) {
                        return None;
                    }
                }
                Edge::Arc(arc) if arc.sweep > 0.0 => {
                    for (corner, radius) in corners.into_iter().zip(&mut radii) {
                        let inwards = arc.center - corner;
                        let fits = (inwards.abs() - arc.radius).abs().max_element() <= slack;
                        // An arc may round more than one corner: of those it begins or ends beside, or passes.
                        if fits && arc.has(-inwards) {
                            *radius = arc.radius;
                        }
                    }
                }
                Edge::Arc(_) | Edge::Border(_) => return None,
            }
        }
        let rounded = Self { min, max, radii };
        let area = outline::area(edges.iter());
        ((rounded.area() - area).abs() <= 1e-6 * area).then_some(rounded)
    }

    fn area(&self) -> f64 {
        let cut: f64 = self.radii.iter().map(|radius| radius * radius).sum();
        let size = self.max - self.min;
        size.x * size.y - cut * (1.0 - core::f64::consts::FRAC_PI_4)
    }

    /// Whether no corner is rounded.
    pub(crate) fn is_sharp(&self) -> bool {
        self.radii.iter().all(|&radius| radius == 0.0)
    }

    /// The radius, if it is a circle.
    pub(crate) fn circle(&self) -> Option<f64> {
        let size = self.max - self.min;
        let radius = size.x / 2.0;
        let slack = radius * 1e-7;
        let all = self.radii.iter().all(|r| (r - radius).abs() <= slack);
        (all && (size.y / 2.0 - radius).abs() <= slack).then_some(radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::FillRule;
    use crate::shape::Shape;

    fn of(shape: &Shape) -> Option<Rounded> {
        Rounded::of(&Outline::of_simple(shape).unwrap())
    }

    #[test]
    fn cards_pills_and_circles_are_found_and_nothing_else() {
        let card = of(&Shape::rounded_rect(1.0, 2.0, 30.0, 20.0, [1.0, 2.0, 0.0, 4.0]).unwrap());
        assert_eq!(card.unwrap().radii, [1.0, 2.0, 0.0, 4.0]);
        let pill = of(&Shape::rounded_rect(0.0, 0.0, 30.0, 20.0, 10.0).unwrap()).unwrap();
        assert_eq!(pill.radii, [10.0; 4]);
        assert_eq!(pill.circle(), None);
        let circle = of(&Shape::circle([3.0, 4.0], 5.0).unwrap()).unwrap();
        assert_eq!(circle.circle(), Some(5.0));
        assert_eq!(
            of(&Shape::rect(0.0, 0.0, 3.0, 4.0).unwrap()).unwrap().radii,
            [0.0; 4]
        );
        let ell = [
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 1.0],
            [1.0, 1.0],
            [1.0, 4.0],
            [0.0, 4.0],
        ];
        assert!(of(&Shape::polygon(&[ell], FillRule::NonZero).unwrap()).is_none());
        let turned = Shape::rect(0.0, 0.0, 3.0, 4.0).unwrap();
        let turned = turned.transformed([0.8, 0.6, -0.6, 0.8, 0.0, 0.0]).unwrap();
        assert!(of(&turned).is_none());
    }
}
