//! Profiles across a straight edge.

use penumbral::{Grid, Light, MeshOptions, Profile, Shadow, Shape};

use crate::checks::*;
use crate::common::worst;

fn half_plane() -> Shadow {
    // One edge at x = 500 with nothing else near.
    let shape = Shape::rect(500.0, -2000.0, 2000.0, 4000.0).unwrap();
    Light::directional([0.0, 0.0], 10.0)
        .unwrap()
        .cast(&shape, 1.0, 0.0)
        .unwrap()
}

/// The largest error of densities along y = 0.025 from x = 485 on, twenty a unit, in levels.
fn worst_on_row(shadow: &Shadow, densities: &[f32]) -> f64 {
    let error = |(i, density): (usize, &f32)| {
        let x = 485.0 + (i as f32 + 0.5) / 20.0;
        (f64::from(*density) - shadow.density_at([x, 0.025])).abs() * 255.0
    };
    worst(densities.iter().enumerate().map(error))
}

#[test]
fn a_straight_edge_keeps_its_tolerance_and_takes_no_more_pieces() {
    let shadow = half_plane();
    let mesh = shadow.mesh(levels(1.2));
    let grid = Grid::new([485.0, 0.0], [600, 1], 20.0).unwrap();
    let mut densities = vec![0.0; 600];
    mesh.rasterize(&grid, &mut densities).unwrap();
    let worst = worst_on_row(&shadow, &densities);
    assert!(worst <= 1.1, "{worst} levels");
    // A mesh of fewer pieces is over the tolerance.
    let coarse = shadow.mesh(levels(4.0));
    coarse.rasterize(&grid, &mut densities).unwrap();
    assert!(worst_on_row(&shadow, &densities) > 1.2);
}

#[test]
fn skias_profile_is_forty_levels_wrong_on_every_straight_edge() {
    let shadow = half_plane();
    let mesh = shadow.mesh(MeshOptions::new(levels(1.0)).with_profile(Profile::Skia));
    let grid = Grid::new([485.0, 0.0], [600, 1], 20.0).unwrap();
    let mut densities = vec![0.0; 600];
    mesh.rasterize(&grid, &mut densities).unwrap();
    let worst = worst_on_row(&shadow, &densities);
    println!("Skia's profile: {worst:.1} levels");
    assert!((38.0..42.0).contains(&worst), "{worst}");
    assert!(mesh.error_levels() > 38.0);
}
