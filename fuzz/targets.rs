//! What is fuzzed: each takes any bytes and panics where a promise is broken. `tests/fuzz.rs` calls them too.

#![expect(clippy::expect_used, reason = "a target fails by a panic")]

use penumbral::plan::Method;
use penumbral::{
    Bounds, Color, FillRule, Grid, Hidden, Light, Limits, MeshOptions, NinePatch, Paint, Path,
    PixelOptions, Renderer, Scene, Scratch, Shadow, Shape, Surface, Tolerance,
};
use tiny_skia::Pixmap;

/// A target and its name.
pub(crate) type Target = (&'static str, fn(&[u8]));

pub(crate) const TARGETS: [Target; 9] = [
    ("scene_json", scene_json),
    ("svg_path", svg_path),
    ("outline", outline),
    ("cast", cast),
    ("mesh", mesh),
    ("direct", direct),
    ("grid", grid),
    ("nine_patch", nine_patch),
    ("compose", compose),
];

/// Takes values from bytes, zeros after their end.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else {
            return 0;
        };
        self.0 = rest;
        *first
    }

    fn word(&mut self) -> u32 {
        u32::from_le_bytes([0; 4].map(|_| self.byte()))
    }

    fn flag(&mut self) -> bool {
        self.byte() & 1 == 0
    }

    fn below(&mut self, count: u8) -> u8 {
        self.byte() % count
    }

    /// Any float at all, and often one that is special.
    fn any(&mut self) -> f32 {
        match self.below(8) {
            0 => f32::from_bits(self.word()),
            1 => {
                const SPECIAL: [f32; 12] = [
                    0.0,
                    -0.0,
                    1.0,
                    -1.0,
                    f32::NAN,
                    f32::INFINITY,
                    f32::MIN_POSITIVE,
                    f32::MAX,
                    1e-40,
                    16_777_216.0,
                    -16_777_216.0,
                    16_777_215.0,
                ];
                SPECIAL[usize::from(self.below(12))]
            }
            2 => (self.word() as i32) as f32 / 65_536.0,
            3 => f32::from(self.byte()) / 16.0,
            _ => f32::from(self.byte() as i8),
        }
    }

    /// From 0 to 64, on quarters or finer.
    fn place(&mut self) -> f32 {
        let whole = f32::from(self.byte()) / 4.0;
        if whole < 48.0 {
            whole
        } else {
            whole - 32.0 + f32::from(self.byte()) / 1024.0
        }
    }

    fn point(&mut self) -> [f32; 2] {
        [self.place(), self.place()]
    }

    fn rule(&mut self) -> FillRule {
        if self.flag() {
            FillRule::NonZero
        } else {
            FillRule::EvenOdd
        }
    }

    /// A shape of some kind in a square of 64 units.
    fn shape(&mut self) -> Option<Shape> {
        match self.below(6) {
            0 => Shape::rect(self.place(), self.place(), self.place(), self.place()).ok(),
            1 => {
                let radii = [0; 4].map(|_| [self.place(), self.place()]);
                Shape::rounded_rect(
                    self.place(),
                    self.place(),
                    self.place(),
                    self.place(),
                    radii,
                )
                .ok()
            }
            2 => Shape::rounded_rect(
                self.place(),
                self.place(),
                self.place(),
                self.place(),
                self.place(),
            )
            .ok(),
            3 => Shape::ellipse(self.point(), self.point()).ok(),
            4 => {
                let ring: Vec<_> = (0..3 + self.below(12)).map(|_| self.point()).collect();
                Shape::polygon(&[ring], self.rule()).ok()
            }
            _ => self.path(),
        }
    }

    fn path(&mut self) -> Option<Shape> {
        let mut path = Path::new();
        for _ in 0..1 + self.below(12) {
            match self.below(7) {
                0 => path.move_to(self.point()),
                1 | 2 => path.line_to(self.point()),
                3 => path.quad_to(self.point(), self.point()),
                4 => path.cubic_to(self.point(), self.point(), self.point()),
                5 => {
                    let (large, positive) = (self.flag(), self.flag());
                    path.arc_to(self.point(), self.place(), large, positive, self.point())
                }
                _ => path.close(),
            };
        }
        Shape::path(&path, self.rule()).ok()
    }

    /// A penumbra radius, most often a small one.
    fn radius(&mut self) -> f32 {
        const SPECIAL: [f32; 8] = [0.0, 0.25, 0.5, 1.0, 2.0, 3.0, 22.5, 40.0];
        match self.below(4) {
            0 => SPECIAL[usize::from(self.below(8))],
            1 => f32::from(self.byte()) / 256.0,
            2 => f32::from(self.byte()) / 64.0,
            _ => self.place(),
        }
    }
}

fn shadow(shapes: &[Shape], radius: f32) -> Option<Shadow> {
    Light::directional([0.0, 0.0], radius)
        .ok()?
        .cast_all(shapes, 1.0, 0.0)
        .ok()
}

fn assert_density(density: f64) {
    assert!((0.0..=1.0).contains(&density), "{density}");
}

/// Some pixels of a shape's shadow by a method, and by `exact`.
fn compare(bytes: &mut Bytes<'_>, method: Option<Method>) {
    let mut shapes = Vec::new();
    for _ in 0..1 + bytes.below(3) {
        shapes.extend(bytes.shape());
    }
    let radius = bytes.radius();
    let Some(shadow) = shadow(&shapes, radius) else {
        return;
    };
    let size = if radius < 3.0 { [8, 2] } else { [40, 3] };
    let Ok(grid) = Grid::new(bytes.point(), size, 1.0) else {
        return;
    };
    let mut scratch = Scratch::new();
    let mut draw = |method| {
        let options = PixelOptions::default().with_method(method);
        let mut densities = vec![0.0; (size[0] * size[1]) as usize];
        assert!(
            shadow
                .fill_f32(&grid, &mut densities, &options, &mut scratch)
                .is_ok()
        );
        densities
    };
    let (drawn, exact) = (draw(method), draw(Some(Method::Exact)));
    // Below 3 px averages over pixels may be wrong by 0.8, and `exact` by 0.12.
    let allowed = if radius < 3.0 { 1.12 } else { 1.0 };
    for (drawn, exact) in drawn.iter().zip(&exact) {
        assert_density(f64::from(*drawn));
        let error = (drawn - exact).abs() * 255.0;
        assert!(error <= allowed, "{error} levels at r {radius}: {shapes:?}");
    }
}

pub(crate) fn direct(data: &[u8]) {
    compare(&mut Bytes(data), Some(Method::Direct));
}

pub(crate) fn grid(data: &[u8]) {
    let mut bytes = Bytes(data);
    let method = if bytes.below(4) == 0 {
        None
    } else {
        Some(Method::Grid)
    };
    compare(&mut bytes, method);
}

pub(crate) fn nine_patch(data: &[u8]) {
    let mut bytes = Bytes(data);
    compare(&mut bytes, Some(Method::NinePatch));
    let Some(shadow) = bytes
        .shape()
        .and_then(|shape| shadow(&[shape], bytes.radius()))
    else {
        return;
    };
    let Some((key, place)) = shadow.key(1.0, Tolerance::ONE_LEVEL) else {
        return;
    };
    let mut scratch = Scratch::new();
    let patch = NinePatch::draw(&key, &mut scratch).expect("a key is of a mask that can be drawn");
    let [width, height] = patch.size();
    assert_eq!(patch.mask().len(), (width * height) as usize);
    let (Ok(grid), Ok(paint)) = (
        Grid::new([0.0, 0.0], [48, 4], 1.0),
        Paint::new(Color::BLACK, 1.0),
    ) else {
        return;
    };
    let mut pixels = vec![0; 4 * 48 * 4];
    assert!(
        patch
            .blend_rgba8(place, &grid, &mut pixels, &paint, &mut scratch)
            .is_ok()
    );
    let mut exact = vec![0.0; 48 * 4];
    let options = PixelOptions::default().with_method(Method::Exact);
    assert!(
        shadow
            .fill_f32(&grid, &mut exact, &options, &mut scratch)
            .is_ok()
    );
    for (pixel, exact) in pixels.chunks(4).zip(exact) {
        let error = (f32::from(pixel[3]) - exact * 255.0).abs();
        // A level, what `exact` may be wrong by, and the rounding.
        assert!(error <= 1.63, "{error} levels");
    }
}

/// A path of raw floats, whatever they are.
pub(crate) fn outline(data: &[u8]) {
    let mut bytes = Bytes(data);
    let rings = 1 + bytes.below(3);
    let rings: Vec<Vec<[f32; 2]>> = (0..rings)
        .map(|_| {
            (0..bytes.below(16))
                .map(|_| [bytes.any(), bytes.any()])
                .collect()
        })
        .collect();
    let rule = bytes.rule();
    let Ok(shape) = Shape::polygon(&rings, rule) else {
        return;
    };
    let reversed: Vec<Vec<[f32; 2]>> = rings
        .iter()
        .map(|ring| ring.iter().rev().copied().collect())
        .collect();
    let reversed = Shape::polygon(&reversed, rule).expect("as its reverse");
    let (radius, point) = (bytes.any(), [bytes.any(), bytes.any()]);
    let (Some(here), Some(there)) = (shadow(&[shape], radius), shadow(&[reversed], radius)) else {
        return;
    };
    let density = here.density_at(point);
    assert_density(density);
    assert_eq!(density.to_bits(), there.density_at(point).to_bits());
    assert!(here.bounds().is_none_or(|bounds| {
        (0..2).all(|axis| bounds.min[axis].is_finite() && bounds.min[axis] <= bounds.max[axis])
    }));
    let mut densities = [0.0; 16];
    if let Ok(grid) = Grid::new(point, [8, 2], 1.0) {
        let drawn = here.fill_f32(
            &grid,
            &mut densities,
            &PixelOptions::default(),
            &mut Scratch::new(),
        );
        assert!(drawn.is_ok());
        for density in densities {
            assert_density(f64::from(density));
        }
    }
}

pub(crate) fn svg_path(data: &[u8]) {
    let Ok(text) = core::str::from_utf8(data) else {
        return;
    };
    let Ok(path) = Path::from_svg(text) else {
        return;
    };
    for rule in [FillRule::NonZero, FillRule::EvenOdd] {
        if let Ok(shape) = Shape::path(&path, rule) {
            for radius in [0.5, 4.0] {
                if let Some(shadow) = shadow(core::slice::from_ref(&shape), radius) {
                    assert_density(shadow.density_at([10.0, 12.0]));
                }
            }
        }
    }
}

/// Any light, elevations and map.
pub(crate) fn cast(data: &[u8]) {
    let mut bytes = Bytes(data);
    let Some(shape) = bytes.shape() else {
        return;
    };
    let light = match bytes.below(3) {
        0 => Light::directional([bytes.any(), bytes.any()], bytes.any()),
        1 => Light::android(bytes.any()),
        _ => Light::new([bytes.any(), bytes.any(), bytes.any()], bytes.any()),
    };
    let affine = [0; 6].map(|_| bytes.any());
    let shape = if bytes.flag() {
        shape.transformed(affine).unwrap_or(shape)
    } else {
        shape
    };
    let Ok(shadow) = light.and_then(|light| light.cast(&shape, bytes.any(), bytes.any())) else {
        return;
    };
    assert!(shadow.radius() >= 0.0 && shadow.radius().is_finite());
    for _ in 0..3 {
        assert_density(shadow.density_at([bytes.any(), bytes.any()]));
    }
    let Ok(grid) = Grid::new([bytes.any(), bytes.any()], [9, 2], bytes.any()) else {
        return;
    };
    let (mut scratch, mut hidden) = (Scratch::new(), Hidden::new(&grid));
    if bytes.flag() {
        hidden.add(&shape, &mut scratch);
    }
    let options = PixelOptions::default()
        .with_hidden(&hidden)
        .with_dither(bytes.flag());
    let mut mask = [0; 18];
    assert!(
        shadow
            .fill_a8(&grid, &mut mask, &options, &mut scratch)
            .is_ok()
    );
}

pub(crate) fn mesh(data: &[u8]) {
    let mut bytes = Bytes(data);
    let Some(shape) = bytes.shape() else {
        return;
    };
    let Some(shadow) = shadow(core::slice::from_ref(&shape), bytes.radius()) else {
        return;
    };
    let levels = f32::from(4 + bytes.below(28));
    let tolerance = Tolerance::levels(levels).expect("within its range");
    let few = MeshOptions::new(tolerance).with_max_vertices(2000);
    for options in [few, few.quick()] {
        check_mesh(&shape, &shadow, options, levels);
    }
}

fn check_mesh(shape: &Shape, shadow: &Shadow, options: MeshOptions, levels: f32) {
    let mesh = shadow.mesh(options);
    if mesh.is_complete() {
        assert!(mesh.error_levels() <= f64::from(levels));
    }
    let count = mesh.vertices().len();
    assert!(
        mesh.indices().len().is_multiple_of(3)
            && mesh.indices().iter().all(|index| (*index as usize) < count)
    );
    for vertex in mesh.vertices() {
        assert!(vertex.position.iter().all(|v| v.is_finite()));
        assert_density(f64::from(vertex.density));
    }
    // A hard shadow's mesh may reach beyond it by what chords are off arcs, 1e-5 of its extent, and its vertices off what they
    // stand for. So far off there is something of a shadow that is softer by twice that.
    let soft = (shadow.radius() == 0.0).then(|| {
        let reach = 2e-5 * shadow.bounds().map_or(0.0, extent) + 1e-5;
        self::shadow(core::slice::from_ref(shape), reach as f32).expect("as the hard one")
    });
    for corners in mesh.triangles().take(50) {
        let middle = [0, 1].map(|axis| {
            corners
                .iter()
                .map(|corner| corner.position[axis])
                .sum::<f32>()
                / 3.0
        });
        let density = corners
            .iter()
            .map(|corner| f64::from(corner.density))
            .sum::<f64>()
            / 3.0;
        if let Some(soft) = &soft {
            assert!(
                density > 0.999 && soft.density_at(middle) > 1e-12,
                "{density} at {middle:?}"
            );
        } else if mesh.is_complete() {
            let error = (shadow.density_at(middle) - density).abs() * 255.0;
            // Triangles are sampled, and their vertices rounded.
            assert!(
                error <= 1.1 * f64::from(levels) + 0.5,
                "{error} levels of {levels}"
            );
        }
    }
}

/// The larger side of a box.
fn extent(bounds: Bounds) -> f64 {
    let side = |axis: usize| f64::from(bounds.max[axis] - bounds.min[axis]);
    side(0).max(side(1))
}

fn draw(scene: &Scene) -> Pixmap {
    let grid = scene.grid().expect("a scene has a grid");
    let mut pixmap = Pixmap::new(grid.width(), grid.height()).expect("a small picture");
    assert!(Renderer::new().render(scene, &mut pixmap).is_ok());
    assert!(pixmap.data().chunks(4).all(|pixel| pixel[3] == 255));
    pixmap
}

pub(crate) fn scene_json(data: &[u8]) {
    let Ok(text) = core::str::from_utf8(data) else {
        return;
    };
    let limits = Limits::default()
        .with_pixels(1 << 15)
        .with_vertices(200)
        .with_surfaces(6);
    let Ok(scene) = Scene::from_json_with_limits(text, &limits, &mut |_| Err(String::new())) else {
        return;
    };
    draw(&scene);
    assert!(scene.ground_shadows().is_ok());
}

/// Surfaces that shade each other.
pub(crate) fn compose(data: &[u8]) {
    let mut bytes = Bytes(data);
    let light = Light::new([bytes.place(), bytes.place(), 600.0], 800.0).expect("a light");
    let Ok(mut scene) = Scene::new(
        [8.0 + bytes.place() / 2.0, 8.0 + bytes.place() / 2.0],
        light,
    ) else {
        return;
    };
    for _ in 0..1 + bytes.below(5) {
        let Some(shape) = bytes.shape() else {
            continue;
        };
        let elevation = f32::from(bytes.below(32)) / 2.0;
        let opacity = f32::from(bytes.byte().saturating_mul(2)) / 255.0;
        let fill = Color::rgb(bytes.byte(), bytes.byte(), bytes.byte());
        let surface = Surface::new(shape, elevation)
            .with_fill(fill)
            .with_opacity(opacity);
        assert!(scene.push(surface).is_ok());
    }
    let whole = draw(&scene);
    assert!(draw(&scene) == whole);
}
