//! What casters hide together whose penumbrae are next to nothing beside a pixel: polygons in its square. A few points of a step
//! function would not tell it.

use glam::DVec2;

use super::company::Partial;
use super::member::{Kind, Member};
use super::occluder::{Loop, Occluder};
use crate::density::quadrature;
use crate::outline::{self, Edge, Line, Winding, clip_to_box, resolve_loops};

/// The largest penumbra radius, in pixels, of borders that are hard.
const NARROW: f64 = 0.3;

/// Up to this one the light is a point.
const POINT: f64 = 0.02;

/// What is found of a pixel, and memory.
#[derive(Debug, Default)]
pub(super) struct Hard {
    /// What each caster hides of the light, on average over the pixel, and what each or one before it does.
    pub(super) alone: Vec<f64>,
    pub(super) united: Vec<f64>,
    edges: Vec<Edge>,
    clipped: Vec<Edge>,
    spare: Vec<Edge>,
}

/// Whether a caster's border is hard.
pub(super) fn is_hard(member: &Member) -> bool {
    matches!(&member.kind, Kind::Level(occluder) if occluder.radius <= NARROW)
}

impl Hard {
    /// Finds what hard casters hide of the pixel with its middle there.
    pub(super) fn find(&mut self, casters: &[Partial<'_>], middle: DVec2) {
        for shares in [&mut self.alone, &mut self.united] {
            shares.clear();
            shares.resize(casters.len(), 0.0);
        }
        let occluders = || {
            casters.iter().filter_map(|of| match &of.member.kind {
                Kind::Level(occluder) => Some(occluder),
                Kind::Tilted(_) => None,
            })
        };
        let is_point = occluders().all(|occluder| occluder.radius <= POINT);
        let point = is_point.then_some((DVec2::ZERO, 1.0));
        let disc = quadrature::small_disc().filter(|_| !is_point);
        let mut loops = Vec::new();
        for (light, weight) in point.into_iter().chain(disc) {
            loops.clear();
            let mut united = 0.0;
            for (caster, occluder) in occluders().enumerate() {
                let before = loops.len();
                let alone = self.add_loops(occluder, middle, light, &mut loops);
                if before == 0 {
                    united = alone;
                } else if loops.len() > before {
                    united = area(&resolve_loops(&loops, Winding::Positive, false));
                }
                self.alone[caster] += weight * alone;
                self.united[caster] += weight * united;
            }
        }
    }

    /// Adds what of a caster is seen in the pixel from a point of the light's unit disc, about the pixel's middle; its area.
    fn add_loops(
        &mut self,
        occluder: &Occluder,
        middle: DVec2,
        light: DVec2,
        loops: &mut Vec<Vec<DVec2>>,
    ) -> f64 {
        let half = DVec2::splat(0.5);
        let mut sum = 0.0;
        for of_loop in occluder.loops() {
            let Loop { base, min, max, .. } = of_loop;
            let moved = *base - middle - occluder.radius * light;
            if (moved + *min).cmpgt(half).any() || (moved + *max).cmplt(-half).any() {
                continue;
            }
            self.edges.clear();
            self.edges.extend(of_loop.lines.iter().map(|[from, to]| {
                Edge::Line(Line {
                    from: *from + moved,
                    to: *to + moved,
                })
            }));
            clip_to_box(&self.edges, -half, half, &mut self.spare, &mut self.clipped);
            sum += outline::area(self.clipped.iter());
            let ends = self.clipped.iter().filter_map(|edge| match edge {
                Edge::Line(line) | Edge::Border(line) => Some(line.from),
                Edge::Arc(_) => None,
            });
            loops.push(ends.collect());
        }
        sum
    }
}

fn area(loops: &[Vec<DVec2>]) -> f64 {
    let edges = loops.iter().map(|points| outline::closed_lines(points));
    edges.map(|edges| outline::area(edges.iter())).sum()
}
