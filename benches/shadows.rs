//! The way from a shape to a picture, step by step, and what pixels cost by each method. A group a step:
//!
//! | group | what is timed | names |
//! |---|---|---|
//! | `cast` | projecting a shape | shape |
//! | `exact`, `direct`, `grid`, `nine-patch` | blending a shadow by that method | shape / pixels a unit / r |
//! | `auto` | the same by the method that the plan chooses | shape / pixels a unit / r |
//! | `outputs` | one card blended plainly, dithered, with itself over it; as coverage, as densities; hiding it | output |
//! | `tile` | a shadow kept as a [`NinePatch`] blended elsewhere; finding it by its key; blending a ready mask of its bounds | part / shape |
//! | `area` | a card of so many pixels' side at r = 8 | side |
//! | `radius` | concave paths and a card on their way from narrow to wide penumbrae | shape / r |
//! | `cards` | 100 cards on 1920 x 1080: projecting them, blending all, blending what opaque cards leave to be seen | part |
//! | `mesh` | a shadow's triangles, as usual, few or quick, at a tolerance in levels | shape / usual, few or quick / levels |
//! | `raster` | the densities of triangles on pixels | shape |
//! | `mesh-into` | the same into buffers of the caller's, again (warm), for a shadow not seen before (new), for other sizes of known corners (size) and other radii of them (rise) | shape / way / levels |
//! | `render` | whole pictures of scenes | scene |
//! | `layers` | pictures of 3840 x 2160 with so many cards, side by side or piled up at random | order / cards |
//!
//! The penumbra radius r is in pixels, whatever the scale. Throughputs count the pixels of the shadow's bounds; those of `layers`
//! for each pixel that is seen the casters of whose light it sees a part hidden.
//!
//!     cargo bench --features scene -- --quick             # all, roughly, in minutes
//!     cargo bench --features scene -- ^direct/            # one group
//!     cargo bench --features scene -- --quick direct/card # one shape of it
//!     cargo bench --features scene -- --test              # that all of it runs

#![expect(
    clippy::unwrap_used,
    reason = "a fixture that cannot be read ends the run"
)]

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::measurement::WallTime;
use criterion::{
    BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main,
};
use penumbral::plan::Method;
use penumbral::{
    Color, FillRule, Grid, Hidden, Light, MeshBuffers, MeshOptions, NinePatch, Paint, Path,
    PixelOptions, Renderer, Scene, Scratch, Shadow, Shape, Surface, Tolerance, Tone,
};
use tiny_skia::Pixmap;

const HEART: &str = "M180 280C60 200 40 130 70 95C105 55 160 70 180 115C200 70 255 55 290 95C320 130 300 200 180 280Z";
const STAR: &str = "M180 55L208.2 136.2 294.1 137.9 225.7 189.8 250.5 272.1 180 223 109.5 272.1 134.3 189.8 65.9 137.9 151.8 136.2Z";
const RING: &str = "M170 50A115 115 0 1 1 169.99 50ZM170 120A45 45 0 1 0 170.01 120Z";
const LETTER_L: &str = "M60 60H130V190H250V260H60Z";

/// The penumbra radii of the methods' groups, in pixels.
const RADII: [f32; 6] = [0.0, 0.5, 2.0, 8.0, 32.0, 128.0];
/// The pixels a scene unit of the methods' groups.
const SCALES: [f32; 2] = [1.0, 3.0];

fn path(data: &str) -> Shape {
    Shape::path(&Path::from_svg(data).unwrap(), FillRule::NonZero).unwrap()
}

fn rounded(width: f32, height: f32, radius: f32) -> Shape {
    Shape::rounded_rect(60.0, 60.0, width, height, radius).unwrap()
}

fn card() -> Shape {
    rounded(280.0, 160.0, 12.0)
}

/// Rounded rectangles and circles: what the nine-patch draws.
fn rounded_shapes() -> [(&'static str, Shape); 4] {
    [
        ("card", card()),
        ("pill", rounded(300.0, 64.0, 32.0)),
        ("circle", Shape::circle([88.0, 88.0], 28.0).unwrap()),
        ("button", rounded(56.0, 56.0, 16.0)),
    ]
}

fn shapes() -> Vec<(&'static str, Shape)> {
    let mut shapes = rounded_shapes().to_vec();
    shapes.extend([("star", STAR), ("heart", HEART), ("ring", RING)].map(|(n, d)| (n, path(d))));
    shapes
}

/// A shape's shadow right below it, `radius` in scene units.
fn shadow(shape: &Shape, radius: f32) -> Shadow {
    let light = Light::directional([0.0, 0.0], radius).unwrap();
    light.cast(shape, 1.0, 0.0).unwrap()
}

fn pixels(grid: &Grid) -> usize {
    grid.width() as usize * grid.height() as usize
}

/// A shadow with the pixels of its bounds.
struct Picture {
    shadow: Shadow,
    grid: Grid,
    scratch: Scratch,
}

impl Picture {
    /// At so many pixels a scene unit; `radius` in pixels.
    fn new(shape: &Shape, radius: f32, scale: f32) -> Self {
        let shadow = shadow(shape, radius / scale);
        let bounds = shadow.bounds().unwrap();
        let first = bounds.min.map(|v| (v * scale).floor());
        let end = bounds.max.map(|v| (v * scale).ceil());
        let size = [0, 1].map(|axis| (end[axis] - first[axis]) as u32);
        Self {
            shadow,
            grid: Grid::new(first.map(|v| v / scale), size, scale).unwrap(),
            scratch: Scratch::new(),
        }
    }

    /// Times its blending onto RGBA8 pixels.
    fn blend(
        &mut self,
        group: &mut BenchmarkGroup<'_, WallTime>,
        id: BenchmarkId,
        options: &PixelOptions<'_>,
    ) {
        let mut canvas = vec![255; 4 * pixels(&self.grid)];
        let paint = Paint::new(Color::BLACK, 0.19).unwrap();
        group.throughput(Throughput::Elements(pixels(&self.grid) as u64));
        group.bench_function(id, |b| {
            b.iter(|| {
                black_box(&self.shadow)
                    .blend_rgba8(&self.grid, &mut canvas, &paint, options, &mut self.scratch)
                    .unwrap();
            });
        });
    }
}

fn cast(c: &mut Criterion) {
    let light = Light::android(400.0).unwrap();
    let mut group = c.benchmark_group("cast");
    for (name, shape) in shapes() {
        group.bench_function(name, |b| {
            b.iter(|| light.cast(black_box(&shape), 8.0, 0.0).unwrap());
        });
    }
    group.finish();
}

fn methods(c: &mut Criterion) {
    blend_by(c, Some(Method::Exact), &shapes());
    blend_by(c, Some(Method::Direct), &shapes());
    blend_by(c, Some(Method::Grid), &shapes());
    blend_by(c, Some(Method::NinePatch), &rounded_shapes());
    blend_by(c, None, &shapes());
}

/// One method over shapes, sizes and radii, as far as it is one of its own there and not too slow.
fn blend_by(c: &mut Criterion, method: Option<Method>, shapes: &[(&str, Shape)]) {
    let name = method.map_or("auto".to_owned(), |method| method.to_string());
    let options = PixelOptions::default().with_method(method);
    let mut group = c.benchmark_group(name);
    if method == Some(Method::Exact) {
        group.sample_size(10);
    }
    for (name, shape) in shapes {
        for scale in SCALES {
            for radius in RADII {
                // Narrower penumbrae are averaged over pixels: by the exact method slowly, by two others not at all.
                let wide = radius >= 3.0;
                let drawn = match method {
                    Some(Method::Exact) => wide || scale == 1.0,
                    Some(Method::Grid | Method::NinePatch) => wide,
                    _ => true,
                };
                if drawn {
                    let id = BenchmarkId::new(format!("{name}/{scale}x"), radius);
                    Picture::new(shape, radius, scale).blend(&mut group, id, &options);
                }
            }
        }
    }
    group.finish();
}

fn outputs(c: &mut Criterion) {
    let mut group = c.benchmark_group("outputs");
    let card = card();
    let mut picture = Picture::new(&card, 8.0, 1.0);
    let mut hidden = Hidden::new(&picture.grid);
    hidden.add(&card, &mut picture.scratch);
    let options = PixelOptions::default();
    for (name, options) in [
        ("plain", options),
        ("dithered", options.with_dither(true)),
        ("hidden", options.with_hidden(&hidden)),
    ] {
        let id = BenchmarkId::new("rgba8", name);
        picture.blend(&mut group, id, &options);
    }
    let (grid, scratch) = (picture.grid, &mut picture.scratch);
    let (mut mask, mut densities) = (vec![0; pixels(&grid)], vec![0.0; pixels(&grid)]);
    let shadow = black_box(&picture.shadow);
    group.bench_function("a8", |b| {
        b.iter(|| {
            shadow.fill_a8(&grid, &mut mask, &options, scratch).unwrap();
        });
    });
    group.bench_function("f32", |b| {
        b.iter(|| {
            shadow
                .fill_f32(&grid, &mut densities, &options, scratch)
                .unwrap();
        });
    });
    group.bench_function("hide-card", |b| {
        b.iter(|| {
            hidden.reset(&grid);
            hidden.add(black_box(&card), scratch);
        });
    });
    group.finish();
}

fn tile(c: &mut Criterion) {
    let mut group = c.benchmark_group("tile");
    let paint = Paint::new(Color::BLACK, 0.19).unwrap();
    let mut scratch = Scratch::new();
    for (name, shape) in [
        ("card", rounded(300.0, 200.0, 12.0)),
        ("button", rounded(56.0, 56.0, 16.0)),
        ("bar", rounded(1000.0, 48.0, 8.0)),
    ] {
        let shadow = shadow(&shape, 10.8);
        let (key, place) = shadow.key(1.0, Tolerance::ONE_LEVEL).unwrap();
        let patch = NinePatch::draw(&key, &mut scratch).unwrap();
        let size = [0, 1].map(|axis| (place.max[axis] - place.min[axis]) as u32);
        let grid = Grid::new(place.min.map(|v| v as f32), size, 1.0).unwrap();
        let mut mask = vec![0; pixels(&grid)];
        shadow
            .fill_a8(&grid, &mut mask, &PixelOptions::default(), &mut scratch)
            .unwrap();
        let mut canvas = vec![255; 4 * pixels(&grid)];
        group.throughput(Throughput::Elements(pixels(&grid) as u64));
        group.bench_function(BenchmarkId::new("blend", name), |b| {
            b.iter(|| {
                black_box(&patch)
                    .blend_rgba8(place, &grid, &mut canvas, &paint, &mut scratch)
                    .unwrap();
            });
        });
        group.bench_function(BenchmarkId::new("ready-mask", name), |b| {
            b.iter(|| {
                paint
                    .blend_mask(
                        &grid,
                        black_box(&mask),
                        grid.stride(),
                        &mut canvas,
                        &mut scratch,
                    )
                    .unwrap();
            });
        });
        group.bench_function(BenchmarkId::new("key", name), |b| {
            b.iter(|| black_box(&shadow).key(1.0, Tolerance::ONE_LEVEL));
        });
    }
    group.finish();
}

fn area(c: &mut Criterion) {
    let mut group = c.benchmark_group("area");
    for side in [100.0, 200.0, 400.0, 800.0] {
        let mut picture = Picture::new(&rounded(side, side, 12.0), 8.0, 1.0);
        let id = BenchmarkId::from_parameter(side);
        picture.blend(&mut group, id, &PixelOptions::default());
    }
    group.finish();
}

fn radius(c: &mut Criterion) {
    let mut group = c.benchmark_group("radius");
    for (name, shape) in [
        ("heart", path(HEART)),
        ("l", path(LETTER_L)),
        ("card", card()),
    ] {
        for radius in [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0] {
            let mut picture = Picture::new(&shape, radius, 1.0);
            let id = BenchmarkId::new(name, radius);
            picture.blend(&mut group, id, &PixelOptions::default());
        }
    }
    group.finish();
}

fn fixture(name: &str) -> Scene {
    let path = format!("{}/fixtures/{name}.json", env!("CARGO_MANIFEST_DIR"));
    Scene::from_json(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn cards(c: &mut Criterion) {
    let mut group = c.benchmark_group("cards");
    let scene = fixture("truth/cards-100-1080p");
    let grid = scene.grid().unwrap();
    let (mut hidden, mut scratch) = (Hidden::new(&grid), Scratch::new());
    let mut canvas = vec![255; 4 * pixels(&grid)];
    group.bench_function("project", |b| {
        b.iter(|| black_box(&scene).ground_shadows().unwrap());
    });
    let shadows = scene.ground_shadows().unwrap();
    group.bench_function("transparent", |b| {
        b.iter(|| {
            black_box(&shadows)
                .blend_rgba8(&mut canvas, &PixelOptions::default(), &mut scratch)
                .unwrap();
        });
    });
    group.bench_function("opaque", |b| {
        b.iter(|| {
            black_box(&shadows).hide_covered(&mut hidden, &mut scratch);
            let options = PixelOptions::default().with_hidden(&hidden);
            shadows
                .blend_rgba8(&mut canvas, &options, &mut scratch)
                .unwrap();
        });
    });
    group.finish();
}

fn mesh(c: &mut Criterion) {
    let mut group = c.benchmark_group("mesh");
    group.sample_size(10);
    for (name, shape) in shapes() {
        let shadow = shadow(&shape, 10.0);
        for levels in [1.0, 4.0] {
            let tolerance = Tolerance::levels(levels).unwrap();
            let options = MeshOptions::new(tolerance);
            for (way, options) in [
                ("usual", options),
                ("few", options.few()),
                ("quick", options.quick()),
            ] {
                group.bench_function(BenchmarkId::new(format!("{name}/{way}"), levels), |b| {
                    b.iter(|| black_box(&shadow).mesh(options));
                });
            }
        }
    }
    group.finish();
}

fn mesh_into(c: &mut Criterion) {
    let mut group = c.benchmark_group("mesh-into");
    for (name, shape) in rounded_shapes() {
        let shadow = shadow(&shape, 10.0);
        let (mut buffers, mut scratch) = (MeshBuffers::<u16>::new(), Scratch::new());
        for levels in [1.0, 4.0] {
            let tolerance = Tolerance::levels(levels).unwrap();
            for fresh in [false, true] {
                let kind = if fresh { "new" } else { "warm" };
                group.bench_function(BenchmarkId::new(format!("{name}/{kind}"), levels), |b| {
                    b.iter(|| {
                        if fresh {
                            scratch = Scratch::new();
                        }
                        buffers.clear();
                        let shadow = black_box(&shadow);
                        shadow
                            .mesh_into(&mut buffers, tolerance, &mut scratch)
                            .unwrap()
                    });
                });
            }
        }
    }
    for (name, height, round) in [("card", 200.0, 12.0), ("pill", 64.0, 32.0)] {
        let card = |more: f32| rounded(300.0 + more, height, round);
        let sizes: Vec<_> = (0_u8..64)
            .map(|i| shadow(&card(f32::from(i) * 3.1), 10.0))
            .collect();
        again(&mut group, &format!("{name}/size"), &sizes);
    }
    let rise = |i: u8| shadow(&card(), 4.0 + f32::from(i) * 0.2);
    again(
        &mut group,
        "card/rise",
        &(0_u8..64).map(rise).collect::<Vec<_>>(),
    );
    group.finish();
}

/// Meshes of shadows in turn, whose corners were seen before.
fn again(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, shadows: &[Shadow]) {
    for levels in [1.0, 4.0] {
        let tolerance = Tolerance::levels(levels).unwrap();
        let (mut buffers, mut scratch) = (MeshBuffers::<u16>::new(), Scratch::new());
        let mut mesh = |shadow: &Shadow| {
            buffers.clear();
            shadow.mesh_into(&mut buffers, tolerance, &mut scratch)
        };
        for shadow in shadows {
            mesh(shadow).unwrap();
        }
        let mut turns = shadows.iter().cycle();
        group.bench_function(BenchmarkId::new(name, levels), |b| {
            b.iter(|| mesh(black_box(turns.next().unwrap())).unwrap());
        });
    }
}

fn raster(c: &mut Criterion) {
    let mut group = c.benchmark_group("raster");
    for (name, shape) in shapes() {
        let picture = Picture::new(&shape, 10.0, 1.0);
        let mesh = picture.shadow.mesh(Tolerance::ONE_LEVEL);
        let mut densities = vec![0.0; pixels(&picture.grid)];
        group.throughput(Throughput::Elements(densities.len() as u64));
        group.bench_function(name, |b| {
            b.iter(|| {
                black_box(&mesh)
                    .rasterize(&picture.grid, &mut densities)
                    .unwrap();
            });
        });
    }
    group.finish();
}

fn render(c: &mut Criterion) {
    let mut group = c.benchmark_group("render");
    group.sample_size(10);
    for name in ["card-list", "dialog-over-list", "landing-page"] {
        let scene = fixture(&format!("scenes/{name}"));
        let grid = scene.grid().unwrap();
        let mut pixmap = Pixmap::new(grid.width(), grid.height()).unwrap();
        let mut renderer = Renderer::new();
        group.bench_function(name, |b| {
            b.iter(|| renderer.render(black_box(&scene), &mut pixmap).unwrap());
        });
    }
    group.finish();
}

/// Cards at seven elevations: small ones side by side, or larger ones anywhere.
fn many(count: usize, piled: bool) -> Vec<Surface> {
    let mut state = 1_u64;
    let mut random = |most: f32| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / 16_777_216.0 * most
    };
    let card = |index: usize| {
        let shape = if piled {
            Shape::rounded_rect(random(3720.0), random(2080.0), 104.0, 64.0, 8.0)
        } else {
            let (column, row) = ((index % 35) as f32, (index / 35) as f32);
            Shape::rounded_rect(column * 108.0 + 16.0, row * 74.0 + 8.0, 72.0, 40.0, 8.0)
        };
        Surface::new(
            shape.unwrap(),
            [1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0][index % 7],
        )
    };
    (0..count).map(card).collect()
}

/// How many casters hide a part of the light from the pixels that are seen, added up over these.
fn visible_penumbra(scene: &Scene, light: &Light) -> u64 {
    let grid = scene.grid().unwrap();
    let width = grid.width() as usize;
    let mut order: Vec<&Surface> = scene.surfaces().iter().collect();
    order.sort_by(|a, b| a.elevation().total_cmp(&b.elevation()));
    let mut topmost = vec![0; width * grid.height() as usize];
    let mut scratch = Scratch::new();
    let mut densities = vec![0.0; topmost.len()];
    // The pixels of a shadow, with its densities.
    let mut each = |shadow: &Shadow, tell: &mut dyn FnMut(usize, f32)| {
        let Some(bounds) = shadow.bounds() else {
            return;
        };
        let [columns, rows] = [0, 1].map(|axis| {
            let end = [grid.width(), grid.height()][axis];
            let (min, max) = (bounds.min[axis] - 1.0, bounds.max[axis] + 1.0);
            (min.max(0.0) as u32).min(end)..(max.max(0.0) as u32 + 1).min(end)
        });
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        let origin = [columns.start as f32, rows.start as f32];
        let size = [columns.len() as u32, rows.len() as u32];
        let window = Grid::new(origin, size, 1.0).unwrap();
        let options = PixelOptions::default();
        shadow
            .fill_f32(&window, &mut densities, &options, &mut scratch)
            .unwrap();
        for row in 0..size[1] {
            for column in 0..size[0] {
                let pixel = (row + rows.start) as usize * width + (column + columns.start) as usize;
                tell(pixel, densities[(row * size[0] + column) as usize]);
            }
        }
    };
    let overhead = Light::directional([0.0, 0.0], 0.0).unwrap();
    for (rank, surface) in order.iter().enumerate() {
        let cover = overhead.cast(surface.shape(), 1.0, 0.0).unwrap();
        each(&cover, &mut |pixel, density| {
            if density == 1.0 {
                topmost[pixel] = rank + 1;
            }
        });
    }
    let mut receivers: Vec<f32> = order.iter().map(|surface| surface.elevation()).collect();
    receivers.insert(0, 0.0);
    let mut count = 0;
    for caster in &order {
        let mut elevations = receivers.clone();
        elevations.dedup();
        for below in elevations
            .into_iter()
            .filter(|&below| below < caster.elevation())
        {
            let shadow = light
                .cast(caster.shape(), caster.elevation(), below)
                .unwrap();
            each(&shadow, &mut |pixel, density| {
                let is_partial = density > 0.0 && density < 1.0;
                count += u64::from(is_partial && receivers[topmost[pixel]] == below);
            });
        }
    }
    count
}

fn layers(c: &mut Criterion) {
    let mut group = c.benchmark_group("layers");
    group.sample_size(10);
    let mut renderer = Renderer::new();
    for (order, piled) in [("apart", false), ("piled", true)] {
        for count in [150, 300, 600, 1000] {
            let light = Light::new([1920.0, 0.0, 600.0], 800.0).unwrap();
            let tone = Tone::new(0.19, 0.0).unwrap();
            let mut scene = Scene::new([3840.0, 2160.0], light).unwrap().with_tone(tone);
            for surface in many(count, piled) {
                scene.push(surface).unwrap();
            }
            let mut pixmap = Pixmap::new(3840, 2160).unwrap();
            let penumbra = visible_penumbra(&scene, &light);
            let mut least = Duration::MAX;
            group.throughput(Throughput::Elements(penumbra));
            group.bench_function(BenchmarkId::new(order, count), |b| {
                b.iter_custom(|times| {
                    let mut draw = |_| {
                        let start = Instant::now();
                        renderer.render(black_box(&scene), &mut pixmap).unwrap();
                        let time = start.elapsed();
                        least = least.min(time);
                        time
                    };
                    (0..times).map(&mut draw).sum()
                });
            });
            if least < Duration::MAX {
                println!(
                    "layers/{order}/{count}: {:.1} ms at best, {:.3} us for each of {penumbra} visible pixels of penumbra",
                    least.as_secs_f64() * 1e3,
                    least.as_secs_f64() * 1e6 / penumbra as f64,
                );
            }
        }
    }
    group.finish();
}

/// There are hundreds of benches: each takes a second or two.
fn brief() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
        .sample_size(30)
}

criterion_group! {
    name = benches;
    config = brief();
    targets = cast, methods, outputs, tile, area, radius, cards, mesh, mesh_into, raster, render, layers
}
criterion_main!(benches);
