//! Corners of rounded rectangles that are shared: by other sizes, and by near radii.

use core::num::NonZeroUsize;

use penumbral::{
    CornerRadii, Grid, Light, MeshBuffers, MeshCache, MeshVertex, Scratch, Shadow, Shape,
};

use crate::checks::*;
use crate::common::worst;

/// The penumbra radius of most of them.
const RADIUS: f32 = 10.0;

fn cast(size: [f32; 2], radii: impl Into<CornerRadii>, radius: f32) -> Shadow {
    let shape = Shape::rounded_rect(-7.0, 30.0, size[0], size[1], radii).unwrap();
    let light = Light::directional([0.0, 0.0], radius).unwrap();
    light.cast(&shape, 1.0, 0.0).unwrap()
}

/// A mesh from a scratch that has made others.
fn warm(shadow: &Shadow, tolerance: f32, scratch: &mut Scratch) -> MeshBuffers<u32> {
    let mut buffers = MeshBuffers::new();
    let quality = shadow
        .mesh_into(&mut buffers, levels(tolerance), scratch)
        .unwrap();
    assert!(quality.is_complete() && quality.error_levels <= f64::from(tolerance));
    buffers
}

#[test]
fn pictures_move_with_the_size_through_corners_that_touch() {
    let grid = Grid::new([-20.0, 17.0], [26, 20], 0.25).unwrap();
    let mut scratch = Scratch::new();
    for (round, height) in [(6.0_f32, 90.0_f32), (6.0, 14.0), (20.0, 40.0), (0.0, 90.0)] {
        // Two corners and what is felt beyond them, on both sides of where they are apart.
        let touching = 2.0 * (round + RADIUS);
        let apart = touching + RADIUS * (2.0 / 1024.0 + 1.0 / 64.0);
        let widths = [-2.0, -0.01, 0.0, 0.01].map(|more| touching + more);
        let more = [-0.001, 0.0, 0.001, 0.4, 3.0, 30.0].map(|more| apart + more);
        let mut last: Option<(Vec<f32>, Vec<f64>)> = None;
        for width in widths.into_iter().chain(more) {
            let shadow = cast([width, height], round, RADIUS);
            let mesh = shadow.mesh(levels(2.0));
            sanity_check(&mesh);
            let name = format!("{width} x {height}, {round}");
            let worst = dense_error(&shadow, &mesh, 6);
            assert!(worst <= mesh.error_levels(), "{name}: {worst}");
            assert!(mesh.is_complete() && mesh.error_levels() <= 2.0, "{name}");
            let kept = warm(&shadow, 2.0, &mut scratch);
            assert_eq!(
                (kept.vertices.as_slice(), kept.indices.as_slice()),
                (mesh.vertices(), mesh.indices()),
                "{name}"
            );
            let mut picture = vec![0.0; 520];
            mesh.rasterize(&grid, &mut picture).unwrap();
            let exact: Vec<f64> = (0_u16..520)
                .map(|i| {
                    let [x, y] = [i % 26, i / 26].map(|v| f32::from(v) * 4.0 + 2.0);
                    shadow.density_at([x - 20.0, y + 17.0])
                })
                .collect();
            if let Some((before, exact_before)) = last {
                for i in 0..520 {
                    let moved = f64::from((picture[i] - before[i]).abs());
                    let may = (exact[i] - exact_before[i]).abs();
                    assert!(moved <= may + 4.0 / 255.0, "{name}: {moved} for {may}");
                }
            }
            last = Some((picture, exact));
        }
    }
}

#[test]
fn another_size_finds_its_corners_in_a_cache_and_takes_the_same_bits() {
    let mut cache = MeshCache::new(NonZeroUsize::new(4).unwrap());
    // A card, a pill, and a bar that is thinner than the penumbra is wide: of the latter only the length is free.
    for (index, (round, sizes)) in [
        (
            8.0,
            [[90.0, 60.0], [300.0, 60.0], [90.0, 200.0], [41.0, 41.0]],
        ),
        (
            15.0,
            [[90.0, 30.0], [300.0, 30.0], [70.0, 30.0], [900.0, 30.0]],
        ),
        (3.0, [[90.0, 8.0], [300.0, 8.0], [70.0, 8.0], [900.0, 8.0]]),
    ]
    .into_iter()
    .enumerate()
    {
        for size in sizes {
            let shadow = cast(size, round, RADIUS);
            let kept = cache.mesh(&shadow, levels(2.0));
            let mut fresh = MeshCache::new(NonZeroUsize::MIN);
            assert_eq!(kept.mesh, fresh.mesh(&shadow, levels(2.0)).mesh);
            assert_eq!([fresh.corner_hits(), fresh.corner_misses()], [0, 1]);
        }
        let made = index as u64 + 1;
        assert_eq!([cache.hits(), cache.misses()], [0, 4 * made]);
        assert_eq!(
            [cache.corner_hits(), cache.corner_misses()],
            [3 * made, made]
        );
    }
}

#[test]
fn a_card_that_rises_moves_its_vertices() {
    let mut cache = MeshCache::new(NonZeroUsize::new(4).unwrap());
    let mut last: Option<(f32, MeshBuffers<u32>)> = None;
    let mut scratch = Scratch::new();
    // Corner radii over the penumbra's from 1.25 to 1.375.
    for step in 0_u8..=20 {
        let radius = 12.0 / (1.25 + 0.125 * (f32::from(step) + 0.5) / 21.0);
        let shadow = cast([120.0, 90.0], 12.0, radius);
        cache.mesh(&shadow, levels(1.0));
        let buffers = warm(&shadow, 1.0, &mut scratch);
        if let Some((radius_before, before)) = last {
            assert_eq!(buffers.indices, before.indices);
            let far = |a: &MeshVertex, b: &MeshVertex| {
                let [x, y] = [0, 1].map(|i: usize| a.position[i] - b.position[i]);
                x.hypot(y).max(RADIUS * (a.density - b.density).abs())
            };
            assert_eq!(buffers.vertices.len(), before.vertices.len());
            let pairs = buffers.vertices.iter().zip(&before.vertices);
            let most = worst(pairs.map(|(a, b)| f64::from(far(a, b)))) as f32;
            let may = 2.0 * (radius - radius_before).abs();
            assert!(most <= may, "{most} from {radius_before} to {radius}");
        }
        last = Some((radius, buffers));
    }
    assert_eq!([cache.corner_hits(), cache.corner_misses()], [20, 1]);
}

#[test]
fn radii_through_every_special_value_keep_the_tolerance() {
    let mut scratch = Scratch::new();
    // Sharp ones, about the ends of spans, and about 1, where the umbra's corner begins to be round.
    let ratios = [
        0.0, 1e-6, 0.03, 0.0625, 0.09, 0.124_999, 0.125, 0.19, 0.4375, 0.93, 0.97, 0.999_99, 1.0,
        1.000_01, 1.01, 1.015_6, 1.015_7, 1.02, 1.031_25, 1.05, 1.09, 1.124, 1.125, 1.19, 1.249,
        1.4375, 1.93, 2.0, 2.125, 3.9, 4.2, 9.3, 31.0,
    ];
    for (index, ratio) in ratios.into_iter().enumerate() {
        let radius = if ratio > 2.0 { 30.0 / ratio } else { RADIUS };
        let shadow = cast([95.0, 85.0], ratio * radius, radius);
        for tolerance in [[0.5, 4.0], [1.0, 8.0], [2.0, 1.0]][index % 3] {
            let kept = warm(&shadow, tolerance, &mut scratch);
            let mesh = shadow.mesh(levels(tolerance));
            assert_eq!(
                (kept.vertices.as_slice(), kept.indices.as_slice()),
                (mesh.vertices(), mesh.indices())
            );
            sanity_check(&mesh);
            let worst = dense_error(&shadow, &mesh, 8);
            assert!(
                worst <= mesh.error_levels(),
                "{ratio} within {tolerance}: {worst} of {}",
                mesh.error_levels()
            );
        }
    }
}

#[test]
fn corners_of_chance_keep_their_tolerance_at_every_size() {
    corners_of_chance(40);
}

/// By `cargo test --release --all-features --test mesh chance -- --ignored --nocapture`.
#[test]
#[ignore = "minutes"]
fn a_thousand_corners_of_chance_keep_their_tolerance() {
    corners_of_chance(1_000);
}

fn corners_of_chance(count: u32) {
    let (mut lots, mut worst, mut scratch) = (Lots(23), 0.0_f64, Scratch::new());
    for index in 0..count {
        let round = RADIUS * (lots.next() * 3.0).powi(2) * 0.3;
        let mut side = || 2.0 * round + RADIUS * (4.0 * lots.next()).powi(2);
        let size = [side(), side()];
        let tolerance = TOLERANCES[index as usize % 5];
        let shadow = cast(size, round, RADIUS);
        let kept = warm(&shadow, tolerance, &mut scratch);
        let mesh = shadow.mesh(levels(tolerance));
        assert_eq!(kept.vertices, mesh.vertices());
        sanity_check(&mesh);
        let error = dense_error(&shadow, &mesh, 8) / f64::from(tolerance);
        let name = format!("{size:?}, {round} within {tolerance}");
        assert!(mesh.is_complete() && error <= 1.0, "{name}: {error}");
        worst = worst.max(error);
    }
    println!("{count} rounded rectangles: at most {worst:.3} of the tolerance");
}
