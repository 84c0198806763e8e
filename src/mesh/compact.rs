//! A compact form for GPUs with a shader: one quad, and the density in closed form at each of its pixels.
//!
//! A quarter plane's share of the disc is elementary: with F the profile and x, y the signed distances inside of its two
//! sides in penumbra radii, it is (F(x) + F(y)) / 2 - 1/4 + x y / π where the disc holds the corner. A rectangle is a sum of
//! four quarter planes; of each rounded corner the disc's share of what rounding cuts off is taken away, by Green's theorem
//! along its two lines and its arc.

use core::f64::consts::FRAC_2_PI;

use super::Shadow;

/// A vertex of a [`CompactMesh`]: 16 bytes, as a GPU takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct CompactVertex {
    /// x and y in scene units.
    pub position: [f32; 2],
    /// The signed distances from the shadow's two middle lines, in penumbra radii. Interpolated, they tell a pixel its
    /// distances from all four sides.
    pub place: [f32; 2],
}

/// The shadow of a rounded rectangle as one quad, for a shader that computes densities.
///
/// The distances from the sides are `half_size + place` and `half_size - place`. On straight edges the density is the disc's
/// profile `F(t) = 1/2 + (t sqrt(1 - t²) + asin t) / π`; corners, sharp or rounded, and shadows without an umbra are in closed form
/// too. In WGSL, with alpha blending and premultiplied colours:
///
/// ```wgsl
#[doc = include_str!("compact.wgsl")]
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CompactMesh {
    vertices: [CompactVertex; 4],
    half_size: [f32; 2],
    corner_radii: [f32; 4],
    error_levels: f64,
}

impl CompactMesh {
    /// The quad's corners in the order of [`ShadowMesh::indices`](super::ShadowMesh::indices), from the least x and y.
    #[must_use]
    pub fn vertices(&self) -> &[CompactVertex; 4] {
        &self.vertices
    }

    /// The quad's two triangles.
    #[must_use]
    pub fn indices(&self) -> [u16; 6] {
        [0, 1, 2, 0, 2, 3]
    }

    /// Half of the outline's width and height, in penumbra radii: a uniform of the shader.
    #[must_use]
    pub fn half_size(&self) -> [f32; 2] {
        self.half_size
    }

    /// The outline's corner radii in penumbra radii, from the least x and y on round as the vertices: a uniform of the shader.
    #[must_use]
    pub fn corner_radii(&self) -> [f32; 4] {
        self.corner_radii
    }

    /// How far the shader's densities may be from the exact ones, in levels: what 32-bit numbers round, where `asin`, `atan2`
    /// and `cos` are right to their last digits. The least that WGSL asks of a GPU's allows a few hundredths more.
    #[must_use]
    pub fn error_levels(&self) -> f64 {
        self.error_levels
    }
}

impl Shadow {
    /// The shadow as one quad for a shader; none where it is not that of a rectangle along the axes with circular corners or
    /// none, has no penumbra, or is so large or so far from the origin for its penumbra that 32-bit numbers would be wrong
    /// by more than a level.
    ///
    /// ```
    /// use penumbral::{Light, Shape};
    ///
    /// let card = Shape::rounded_rect(16.0, 100.0, 300.0, 200.0, 12.0)?;
    /// let shadow = Light::android(400.0)?.cast(&card, 8.0, 0.0)?;
    /// let compact = shadow.compact_mesh().unwrap();
    /// assert!(compact.error_levels() < 0.1);
    /// # Ok::<(), penumbral::Error>(())
    /// ```
    #[must_use]
    pub fn compact_mesh(&self) -> Option<CompactMesh> {
        let radius = self.radius();
        let rounded = self.rounded().filter(|_| radius > 0.0)?;
        let half = (rounded.max - rounded.min) / 2.0;
        let half_size = half / radius;
        let farthest = rounded.min.abs().max(rounded.max.abs()).max_element() / radius;
        // Density changes by at most 2 / π over the radius. Each distance is a few sums of rounded numbers.
        let distance =
            f64::from(f32::EPSILON) * (DISTANCE_STEPS * half_size.max_element() + farthest);
        let error_levels = FORMULA_LEVELS + 255.0 * FRAC_2_PI * distance;
        if error_levels > 1.0 {
            return None;
        }
        let center = rounded.min.midpoint(rounded.max);
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let vertices = corners.map(|side| {
            let place = (half_size + 1.0) * glam::DVec2::from(side);
            CompactVertex {
                position: (center + place * radius).as_vec2().to_array(),
                place: place.as_vec2().to_array(),
            }
        });
        Some(CompactMesh {
            vertices,
            half_size: half_size.as_vec2().to_array(),
            corner_radii: rounded.radii.map(|corner| (corner / radius) as f32),
            error_levels,
        })
    }
}

/// What rounding adds in the formulas, whatever the size, in levels: tests measure it.
const FORMULA_LEVELS: f64 = 0.01;

/// By how many roundings of numbers as large as the half size a distance may be off.
const DISTANCE_STEPS: f64 = 4.0;

#[cfg(test)]
mod tests {
    use core::f32::consts::{FRAC_PI_4, PI, TAU};

    use glam::Vec2;

    use super::*;
    use crate::light::Light;
    use crate::shape::Shape;

    // The functions of compact.wgsl, line by line.

    fn profile(t: f32) -> f32 {
        let t = t.clamp(-1.0, 1.0);
        0.5 + (t * ((1.0 - t) * (1.0 + t)).sqrt() + t.asin()) / PI
    }

    fn quarter(p: Vec2) -> f32 {
        let f = Vec2::new(profile(p.x), profile(p.y));
        if p.dot(p) < 1.0 {
            return (f.x + f.y) / 2.0 - 0.25 + p.x * p.y / PI;
        }
        if p.x > 0.0 && p.y > 0.0 {
            return f.x + f.y - 1.0;
        }
        if p.x > 0.0 || p.y > 0.0 {
            f.x.min(f.y)
        } else {
            0.0
        }
    }

    fn turn(a: Vec2, b: Vec2) -> f32 {
        let (y, x) = (a.perp_dot(b), a.dot(b));
        if y == 0.0 && x >= 0.0 {
            0.0
        } else {
            y.atan2(x)
        }
    }

    fn line(a: Vec2, b: Vec2) -> f32 {
        if a == b {
            return 0.0;
        }
        let way = (b - a).normalize();
        let away = a.perp_dot(way);
        let half = (1.0 - away * away).max(0.0).sqrt();
        let (start, end) = (a.dot(way), b.dot(way));
        let clamp = |v: f32| v.max(start).min(end);
        let (near, far) = (clamp(-half), clamp(half));
        let foot = a - way * start;
        let select = |turn: f32, none: bool| if none { 0.0 } else { turn };
        let before = select(turn(a, foot + way * near), near == start);
        let behind = select(turn(foot + way * far, b), far == end);
        before + away * (far - near) + behind
    }

    fn bulge(angle: f32) -> f32 {
        let s = angle * angle;
        let tail = 1.0 - s / 42.0 * (1.0 - s / 72.0 * (1.0 - s / 110.0));
        angle * s / 6.0 * (1.0 - s / 20.0 * tail)
    }

    fn arc(m: Vec2, radius: f32) -> f32 {
        let d = m.length();
        let excess = d - radius;
        let sine = ((1.0 - excess * excess) / (4.0 * d * radius).max(1e-12)).clamp(0.0, 1.0);
        let w = 2.0 * sine.sqrt().asin();
        let mut middle = turn(Vec2::X, -m) + 3.0 * FRAC_PI_4;
        middle -= TAU * (middle / TAU).round();
        let mut sum = 0.0;
        for part in 0..5 {
            let outside = part > 2;
            let first = if outside { middle + w } else { middle - w };
            let length = if outside { TAU - 2.0 * w } else { 2.0 * w };
            let lap = TAU * (if outside { part - 4 } else { part - 1 }) as f32;
            let from = (first + lap).max(-FRAC_PI_4);
            let to = (first + length + lap).min(FRAC_PI_4);
            if to <= from {
                continue;
            }
            let at = |angle: f32| {
                let turned = angle - 3.0 * FRAC_PI_4;
                m + radius * Vec2::new(turned.cos(), turned.sin())
            };
            let (a, b) = (at(from), at(to));
            if outside {
                sum += turn(a, b);
            } else {
                sum += a.perp_dot(b) + radius * radius * bulge(to - from);
            }
        }
        sum
    }

    fn cut(p: Vec2, radius: f32) -> f32 {
        if radius == 0.0 || p.max_element() >= radius + 1.0 || p.min_element() <= -1.0 {
            return 0.0;
        }
        let corner = -p;
        let along_x = corner + Vec2::new(radius, 0.0);
        let along_y = corner + Vec2::new(0.0, radius);
        let round = arc(corner + radius, radius);
        (line(along_y, corner) + line(corner, along_x) - round) / (2.0 * PI)
    }

    fn density(place: Vec2, half_size: Vec2, radii: [f32; 4]) -> f32 {
        let low = half_size + place;
        let high = half_size - place;
        let all =
            quarter(low) - quarter(Vec2::new(-high.x, low.y)) - quarter(Vec2::new(low.x, -high.y))
                + quarter(-high);
        let near = cut(low, radii[0]) + cut(Vec2::new(high.x, low.y), radii[1]);
        let far = cut(high, radii[2]) + cut(Vec2::new(low.x, high.y), radii[3]);
        (all - near - far).clamp(0.0, 1.0)
    }

    /// The largest error of the shader's densities on a lattice over the quad, in levels.
    fn worst(shadow: &Shadow, mesh: &CompactMesh, parts: u16) -> f64 {
        let [least, _, most, _] = *mesh.vertices();
        let mix = |a: [f32; 2], b: [f32; 2], share: [f64; 2]| {
            [0, 1].map(|i: usize| f64::from(a[i]) + (f64::from(b[i]) - f64::from(a[i])) * share[i])
        };
        let mut worst = 0.0_f64;
        for i in 0..=parts {
            for j in 0..=parts {
                let share = [i, j].map(|part| f64::from(part) / f64::from(parts));
                let position = mix(least.position, most.position, share);
                let place = mix(least.place, most.place, share).map(|v| v as f32);
                let found = density(place.into(), mesh.half_size().into(), mesh.corner_radii());
                let exact = crate::density::at_point(
                    shadow.exact_outline().edges(),
                    position.into(),
                    shadow.radius(),
                );
                worst = worst.max((f64::from(found) - exact).abs() * 255.0);
            }
        }
        worst
    }

    fn shadow(size: [f32; 2], corners: [f32; 4], radius: f32) -> Shadow {
        let card = Shape::rounded_rect(-5.0, 3.0, size[0], size[1], corners).unwrap();
        let light = Light::directional([0.0, 0.0], radius).unwrap();
        light.cast(&card, 1.0, 0.0).unwrap()
    }

    #[test]
    fn sharp_rounded_and_narrow_shadows_are_exact() {
        let corners = [
            [0.0; 4],
            [1.0; 4],
            [4.0; 4],
            [12.0; 4],
            [20.0; 4],
            [0.0, 2.0, 10.0, 25.0],
        ];
        for corners in corners {
            for size in [[70.0, 40.0], [40.0, 40.0], [400.0, 3.0], [12.0, 90.0]] {
                for radius in [0.7, 3.0, 10.8, 45.0] {
                    let shadow = shadow(size, corners, radius);
                    let mesh = shadow.compact_mesh().unwrap();
                    let worst = worst(&shadow, &mesh, 60);
                    assert!(
                        worst <= mesh.error_levels(),
                        "{size:?} {corners:?} {radius}: {worst} of {}",
                        mesh.error_levels()
                    );
                }
            }
        }
    }

    /// Where arcs meet sides, a disc about a pixel has an end of both in its middle, or next to it.
    #[test]
    fn ends_of_arcs_are_exact() {
        for (index, radius) in (1_u8..160).map(|index| (index, 0.53 * f32::from(index))) {
            for size in [[300.0, 80.0], [40.0; 2], [56.0, 24.0], [41.0, 33.0]] {
                for corner in [2.0, 4.0, 8.0, 100.0, 3e-8 * radius] {
                    let shadow = shadow(size, [corner; 4], radius);
                    let mesh = shadow.compact_mesh().unwrap();
                    let (half, corners) = (Vec2::from(mesh.half_size()), mesh.corner_radii());
                    let ends = [Vec2::new(corners[0], 0.0), Vec2::new(0.0, corners[0])];
                    for (end, nudge) in ends.into_iter().zip([Vec2::Y, Vec2::X]) {
                        for by in [0.0, f32::EPSILON, -f32::EPSILON] {
                            let place = end - half + by * nudge;
                            let found = density(place, half, corners);
                            let middle = [-5.0, 3.0];
                            let at = [0, 1].map(|axis: usize| {
                                let middle = middle[axis] + f64::from(size[axis]) / 2.0;
                                middle + f64::from(place[axis]) * shadow.radius()
                            });
                            let outline = shadow.exact_outline();
                            let exact = crate::density::at_point(
                                outline.edges(),
                                at.into(),
                                shadow.radius(),
                            );
                            let error = (f64::from(found) - exact).abs() * 255.0;
                            assert!(
                                error <= mesh.error_levels(),
                                "{index}: {size:?} {corner} {place}: {error}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn corners_and_their_centers_are_exact() {
        let shadow = shadow([70.0, 40.0], [8.0; 4], 10.0);
        let mesh = shadow.compact_mesh().unwrap();
        let half_size = Vec2::from(mesh.half_size());
        for inwards in [0.0, 0.8] {
            let place = Vec2::splat(inwards) - half_size;
            let found = density(place, half_size, mesh.corner_radii());
            let exact = shadow.density_at([-5.0 + 10.0 * inwards, 3.0 + 10.0 * inwards]);
            let error = (f64::from(found) - exact).abs() * 255.0;
            assert!(error <= mesh.error_levels(), "{inwards}: {error}");
        }
    }

    #[test]
    fn what_rounding_does_to_large_shadows_is_stated() {
        for (size, corner, radius) in [(4000.0, 500.0, 1.0), (900.0, 450.0, 0.2)] {
            let shadow = shadow([size; 2], [corner; 4], radius);
            let mesh = shadow.compact_mesh().unwrap();
            let worst = worst(&shadow, &mesh, 300);
            assert!(worst <= mesh.error_levels(), "{worst}");
        }
        assert_eq!(shadow([9e5; 2], [0.0; 4], 1.0).compact_mesh(), None);
        assert_eq!(shadow([9.0; 2], [0.0; 4], 0.0).compact_mesh(), None);
        let light = Light::flutter();
        let ellipse = Shape::ellipse([0.0, 0.0], [3.0, 2.0]).unwrap();
        let ellipse = light.cast(&ellipse, 2.0, 0.0).unwrap();
        assert_eq!(ellipse.compact_mesh(), None);
    }

    #[test]
    fn the_quad_ends_where_the_shadow_does() {
        let shadow = shadow([70.0, 40.0], [8.0; 4], 10.0);
        let mesh = shadow.compact_mesh().unwrap();
        let bounds = shadow.bounds().unwrap();
        assert_eq!(mesh.vertices()[0].position, bounds.min);
        assert_eq!(mesh.vertices()[2].position, bounds.max);
        for vertex in mesh.vertices() {
            let edge = density(vertex.place.into(), mesh.half_size().into(), [0.0; 4]);
            assert_eq!(edge, 0.0);
        }
        assert_eq!(size_of::<CompactVertex>(), 16);
    }
}
