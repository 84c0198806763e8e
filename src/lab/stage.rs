//! A stage: flat casters in space, cut into triangles, over a receiver at height 0 under a disc of light; and what a point of
//! that light sees of it, texel by texel.

use glam::{DVec2, DVec3};

use super::rays::stratified;
use crate::error::{self, Result};
use crate::grid::Grid;
use crate::shadow::Shadow;
use crate::tolerance::Tolerance;

/// Triangles in space under one disc of light.
#[derive(Debug, Clone)]
pub struct Stage {
    light: DVec3,
    radius: f64,
    pub(super) triangles: Vec<[DVec3; 3]>,
}

impl Stage {
    /// A light of `radius` about `light` over triangles, all in one unit.
    ///
    /// # Errors
    /// Numbers that are not finite or too large, and a light that is not above every triangle.
    pub fn new(light: [f64; 3], radius: f64, triangles: &[[[f64; 3]; 3]]) -> Result<Self> {
        error::length("light.radius", radius)?;
        let light = DVec3::from_array(light);
        let triangles: Vec<[DVec3; 3]> = triangles
            .iter()
            .map(|corners| corners.map(DVec3::from_array))
            .collect();
        for corner in triangles.iter().flatten() {
            error::coordinate("triangle", corner.abs().max_element())?;
            error::positive("the light's height over a triangle", light.z - corner.z)?;
        }
        Ok(Self {
            light,
            radius,
            triangles,
        })
    }

    /// A caster halfway between receiver and light that has this shadow, in the grid's pixels: through a point halfway the
    /// light's disc is seen as large as it is.
    pub(super) fn of_shadow(shadow: &Shadow, grid: &Grid) -> Self {
        let scale = grid.pixels_per_unit();
        let mesh = shadow.with_radius(0.0).mesh(Tolerance::ONE_LEVEL);
        let place = |position: [f32; 2]| {
            DVec2::new(f64::from(position[0]), f64::from(position[1])) * scale - grid.corner()
        };
        let size = DVec2::new(f64::from(grid.width()), f64::from(grid.height()));
        // High enough that directions to all of the light are much alike, as under a ceiling.
        let light = (size / 2.0).extend(4.0 * size.max_element());
        Self {
            light,
            radius: shadow.radius() * scale,
            triangles: mesh
                .triangles()
                .map(|corners| corners.map(|c| (place(c.position).extend(0.0) + light) / 2.0))
                .collect(),
        }
    }

    /// Points of the light, as many as `count` cells of equal area at most.
    pub(super) fn lights(&self, count: u32) -> Vec<DVec3> {
        let at = |place: DVec2| self.light + (place * self.radius).extend(0.0);
        if self.radius == 0.0 {
            return vec![self.light];
        }
        stratified(count).into_iter().map(at).collect()
    }

    /// The light's centre.
    #[must_use]
    pub fn light(&self) -> [f64; 3] {
        self.light.to_array()
    }
}

/// The square texels through which a point of the light sees the receiver.
///
/// A point in space is seen on the receiver's plane where the ray through it ends. Its depth is -1 over the part of the ray's
/// length at which it lies, so that it grows away from the light, is -1 on the receiver, and is linear in the texels along
/// every flat surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Texels {
    pub(super) light: DVec3,
    pub(super) origin: DVec2,
    /// Texels a unit.
    pub(super) scale: f64,
    pub(super) width: usize,
    pub(super) height: usize,
}

/// A triangle as it is seen: its depth is `at_origin + gradient . texel`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    corners: [DVec2; 3],
    pub(super) gradient: DVec2,
    pub(super) at_origin: f64,
}

impl Texels {
    /// What the light's centre sees of a stage through the receiver's square from `origin` on, by `size` (columns, rows) of
    /// texels, `scale` a unit.
    pub(super) fn of(stage: &Stage, origin: [f64; 2], size: [usize; 2], scale: f64) -> Self {
        Self {
            light: DVec3::from_array(stage.light()),
            origin: origin.into(),
            scale,
            width: size[0],
            height: size[1],
        }
    }

    /// Texels over all of the grid, in its pixels, and two more on every side.
    pub(super) fn over(grid: &Grid, light: DVec3, scale: f64) -> Self {
        let side = |pixels: u32| (f64::from(pixels) * scale).ceil() as usize + 4;
        Self {
            light,
            origin: DVec2::splat(-2.0 / scale),
            scale,
            width: side(grid.width()),
            height: side(grid.height()),
        }
    }

    /// Where a point is seen, in texels, and its depth.
    pub(super) fn see(&self, point: DVec3) -> (DVec2, f64) {
        let share = (self.light.z - point.z) / self.light.z;
        let ground = self.light + (point - self.light) / share;
        ((ground.truncate() - self.origin) * self.scale, -1.0 / share)
    }

    /// The texel that a place lies in, or none beyond the edge.
    pub(super) fn texel(&self, place: DVec2) -> Option<usize> {
        let inside = place.cmpge(DVec2::ZERO).all()
            && place.x < self.width as f64
            && place.y < self.height as f64;
        inside.then(|| place.y as usize * self.width + place.x as usize)
    }

    /// A triangle as it is seen, or none for one that is seen edge on.
    pub(super) fn triangle(&self, corners: &[DVec3; 3]) -> Option<Seen> {
        let [(a, za), (b, zb), (c, zc)] = corners.map(|corner| self.see(corner));
        let (u, v) = (b - a, c - a);
        let area = u.perp_dot(v);
        let gradient =
            (DVec2::new(v.y, -v.x) * (zb - za) + DVec2::new(-u.y, u.x) * (zc - za)) / area;
        gradient.is_finite().then(|| Seen {
            corners: if area > 0.0 { [a, b, c] } else { [a, c, b] },
            gradient,
            at_origin: za - gradient.dot(a),
        })
    }

    /// Gives `put` each texel whose centre the triangle covers, with the triangle's depth there.
    pub(super) fn scan(&self, seen: &Seen, mut put: impl FnMut(usize, f64)) {
        let [a, b, c] = seen.corners;
        let (top, bottom) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
        let first = (top - 0.5).ceil().max(0.0) as usize;
        for row in first..self.height {
            let y = row as f64 + 0.5;
            if y > bottom {
                break;
            }
            let (mut left, mut right) = (f64::NEG_INFINITY, f64::INFINITY);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                if (from.y <= y) == (to.y <= y) {
                    continue;
                }
                let x = from.x + (to.x - from.x) * (y - from.y) / (to.y - from.y);
                // With the inside on the left of each side, those that go down the rows are its right end.
                if from.y < to.y {
                    right = right.min(x);
                } else {
                    left = left.max(x);
                }
            }
            if !(left.is_finite() && right.is_finite()) {
                continue;
            }
            let first = (left - 0.5).ceil().max(0.0) as usize;
            for column in first..self.width {
                let x = column as f64 + 0.5;
                if x >= right {
                    break;
                }
                let depth = seen.at_origin + seen.gradient.dot(DVec2::new(x, y));
                put(row * self.width + column, depth);
            }
        }
    }
}

/// The mean over the light's points of whether each hides a pixel of the receiver, by what `view` makes of the point.
pub(super) fn hard_shadows<V: Fn(DVec3) -> bool>(
    stage: &Stage,
    grid: &Grid,
    samples: u32,
    densities: &mut [f32],
    view: impl Fn(DVec3) -> V,
) -> Result<()> {
    grid.check_buffer(densities.len())?;
    for y in 0..grid.height() as usize {
        densities[y * grid.stride()..][..grid.width() as usize].fill(0.0);
    }
    let lights = stage.lights(samples);
    let part = 1.0 / lights.len() as f32;
    for light in lights {
        let hides = view(light);
        for y in 0..grid.height() {
            for x in 0..grid.width() {
                let pixel = DVec3::new(f64::from(x) + 0.5, f64::from(y) + 0.5, 0.0);
                if hides(pixel) {
                    densities[y as usize * grid.stride() + x as usize] += part;
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_is_linear_along_a_tilted_triangle() {
        let texels = Texels {
            light: DVec3::new(3.0, 4.0, 50.0),
            origin: DVec2::new(-20.0, -20.0),
            scale: 2.0,
            width: 80,
            height: 80,
        };
        let corners = [
            DVec3::new(-8.0, -5.0, 2.0),
            DVec3::new(9.0, -6.0, 20.0),
            DVec3::new(0.0, 9.0, 11.0),
        ];
        let seen = texels.triangle(&corners).unwrap();
        let inside = (corners[0] + corners[1] * 2.0 + corners[2]) / 4.0;
        let (at, depth) = texels.see(inside);
        assert!((seen.at_origin + seen.gradient.dot(at) - depth).abs() < 1e-12);
        let mut found = 0;
        texels.scan(&seen, |_, _| found += 1);
        let [a, b, c] = seen.corners;
        let area = (b - a).perp_dot(c - a) / 2.0;
        assert!(
            (f64::from(found) - area).abs() < 0.03 * area,
            "{found} {area}"
        );
    }
}
