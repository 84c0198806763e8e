//! Rounded rectangles: few triangles, whatever their corners and wherever an umbra vanishes.

use penumbral::{
    CornerRadii, Grid, Light, MeshBuffers, MeshOptions, MeshVertex, Scratch, ShadowMesh, Shape,
};

use crate::checks::*;

#[test]
fn a_card_takes_few_triangles() {
    let shadow = android_card(8.0);
    for (tolerance, most) in [(0.5, 1_400), (1.0, 700), (2.0, 350), (4.0, 200), (8.0, 110)] {
        let mesh = shadow.mesh(levels(tolerance));
        sanity_check(&mesh);
        let (triangles, worst) = (mesh.triangles().count(), dense_error(&shadow, &mesh, 8));
        println!(
            "{tolerance}: {triangles} triangles, {worst:.3} of {:.3} levels",
            mesh.error_levels()
        );
        assert!(triangles <= most, "{tolerance}: {triangles} triangles");
        assert!(worst <= f64::from(tolerance), "{tolerance}: {worst} levels");
    }
}

/// Far from the origin rounding takes more of the tolerance, and next to the ground the penumbra is narrow beside it.
#[test]
fn cards_far_down_a_list_are_strips_as_well() {
    let light = Light::android(360.0).unwrap();
    for elevation in [1.0, 2.0, 8.0] {
        let mut near = None;
        for y in [0.0, 300.0, 600.0, 1200.0, 4800.0] {
            let card = Shape::rounded_rect(24.0, y, 312.0, 80.0, 12.0).unwrap();
            let shadow = light.cast(&card, elevation, 0.0).unwrap();
            let mesh = shadow.mesh(levels(1.0));
            sanity_check(&mesh);
            let triangles = mesh.triangles().count();
            let few = *near.get_or_insert(triangles);
            let worst = dense_error(&shadow, &mesh, 6);
            println!("{elevation}, y {y}: {triangles} triangles, {worst} levels");
            assert!(mesh.error_levels() <= 1.0 && worst <= mesh.error_levels());
            assert!(
                5 * triangles <= 7 * few,
                "{elevation}, y {y}: {triangles} of {few}"
            );
        }
    }
}

/// As widths that are animated end: the density is within the tolerance of none.
#[test]
fn slivers_of_rectangles_have_meshes() {
    for radius in [0.001, 5.0, 100.0, 900.0] {
        let light = Light::directional([0.0, 0.0], radius).unwrap();
        for share in [1e-30, 1e-9, 1e-7, 4e-7, 1e-6, 1e-5, 1e-3] {
            for [w, h] in [[share * radius, 10.0], [10.0, share * radius]] {
                let shape = Shape::rect(100.0, 1.0, w, h).unwrap();
                let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
                let options = MeshOptions::new(levels(1.0));
                for options in [options, options.quick()] {
                    let mesh = shadow.mesh(options);
                    sanity_check(&mesh);
                    if mesh.is_complete() {
                        let worst = dense_error(&shadow, &mesh, 4);
                        assert!(worst <= 1.0, "{w} x {h}, r {radius}: {worst} levels");
                    }
                }
            }
        }
    }
}

#[test]
fn cards_that_do_not_meet_are_meshed_one_by_one() {
    let light = Light::android(400.0).unwrap();
    let card = |i: u8| Shape::rounded_rect(16.0, 20.0 + 84.0 * f32::from(i), 200.0, 72.0, 12.0);
    let cards: Vec<Shape> = (0..12).map(|i| card(i).unwrap()).collect();
    for options in [
        MeshOptions::new(levels(1.0)),
        MeshOptions::new(levels(1.0)).quick(),
    ] {
        let (mut scratch, mut apart) = (Scratch::new(), MeshBuffers::<u32>::new());
        for card in &cards {
            let shadow = light.cast(card, 2.0, 0.0).unwrap();
            shadow.mesh_into(&mut apart, options, &mut scratch).unwrap();
        }
        let shadow = light.cast_all(&cards, 2.0, 0.0).unwrap();
        let mesh = shadow.mesh(options);
        sanity_check(&mesh);
        assert_eq!(mesh.indices().len(), apart.indices.len());
        let mut together = MeshBuffers::<u32>::new();
        shadow
            .mesh_into(&mut together, options, &mut scratch)
            .unwrap();
        assert_eq!(mesh.vertices(), together.vertices);
    }
}

#[test]
fn rounded_rectangles_keep_their_tolerance() {
    rounded_rectangles(40);
}

/// By `cargo test --release --all-features --test mesh thousand -- --ignored --nocapture`.
#[test]
#[ignore = "minutes"]
fn a_thousand_rounded_rectangles_keep_their_tolerance() {
    rounded_rectangles(1_000);
}

fn rounded_rectangles(count: u32) {
    let mut lots = Lots(7);
    let (mut worst, mut scratch) = (0.0_f64, Scratch::new());
    for index in 0..count {
        let radius = 10.0_f32;
        let mut size = || radius * 0.1 * 300.0_f32.powf(lots.next());
        let (width, height) = (size(), size());
        let mut round = || lots.next() * width.min(height) / 2.0;
        let radii = match index % 4 {
            0 => CornerRadii::from(0.0),
            1 => CornerRadii::from(width.min(height) / 2.0),
            2 => CornerRadii::from(round()),
            _ => CornerRadii::from([round(), round(), round(), round()]),
        };
        let shape = Shape::rounded_rect(-40.0, 30.0, width, height, radii).unwrap();
        let light = Light::directional([0.0, 0.0], radius).unwrap();
        let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
        let tolerance = [0.5, 1.0, 2.0, 4.0, 8.0][index as usize % 5];
        let mesh = shadow.mesh(levels(tolerance));
        sanity_check(&mesh);
        let error = dense_error(&shadow, &mesh, 8) / f64::from(tolerance);
        let name = format!("{width} x {height}, {radii:?} within {tolerance}");
        assert!(
            mesh.is_complete() && error <= 1.0,
            "{name}: {error} of the tolerance"
        );
        assert!(mesh.error_levels() <= f64::from(tolerance), "{name}");
        let slack = f64::from(tolerance) / 255.0 * area(&mesh);
        let cut: f64 = match index % 4 {
            0 => 0.0,
            1 => (4.0 - core::f64::consts::PI) * f64::from(width.min(height) / 2.0).powi(2),
            _ => f64::NAN,
        };
        let missing = mass(&mesh) - (f64::from(width) * f64::from(height) - cut);
        assert!(
            cut.is_nan() || missing.abs() <= slack,
            "{name}: mass off by {missing}"
        );
        worst = worst.max(error);
        let quick = shadow.mesh(MeshOptions::new(levels(tolerance)).quick());
        sanity_check(&quick);
        let error = dense_error(&shadow, &quick, 8) / f64::from(tolerance);
        assert!(
            quick.is_complete() && error <= 1.0,
            "{name}, quick: {error} of the tolerance"
        );
        worst = worst.max(error);
        // A scratch changes nothing, whatever it was used for.
        let mut buffers = MeshBuffers::<u32>::new();
        shadow
            .mesh_into(&mut buffers, levels(tolerance), &mut scratch)
            .unwrap();
        assert_eq!(
            (buffers.vertices.as_slice(), buffers.indices.as_slice()),
            (mesh.vertices(), mesh.indices())
        );
    }
    println!("{count} rounded rectangles: at most {worst:.3} of the tolerance");
}

/// What leads from a square corner to a round one may be long: no triangle along it may be turned round.
#[test]
fn corners_of_two_kinds_on_long_sides_have_triangles_of_one_turn() {
    let light = Light::directional([0.0, 0.0], 2.0).unwrap();
    let mut lots = Lots(11);
    for index in 0..120 {
        let mut size = || 10.0 * 60.0_f32.powf(lots.next());
        let (width, height) = (size(), size());
        let round = lots.next() * width.min(height) / 2.0;
        let radii = [
            [0.0, 0.0, round, round],
            [round, round, 0.0, 0.0],
            [0.0, round, round, 0.0],
            [0.0, round / 5.0, round, round / 2.0],
        ];
        let radii = CornerRadii::from(radii[index % 4]);
        let shape = Shape::rounded_rect(46.89, 35.58, width, height, radii).unwrap();
        let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
        for tolerance in [0.5, 1.0, 2.0, 4.0] {
            let mesh = shadow.mesh(levels(tolerance));
            sanity_check(&mesh);
            let error = dense_error(&shadow, &mesh, 4);
            assert!(
                mesh.is_complete() && error <= f64::from(tolerance),
                "{width} x {height}, {radii:?} within {tolerance}: {error}"
            );
        }
    }
}

#[test]
fn every_point_of_the_penumbra_lies_in_one_triangle() {
    let light = Light::directional([0.0, 0.0], 10.0).unwrap();
    let mut lots = Lots(3);
    for (width, height, round) in [
        (60.0, 40.0, 12.0),
        (60.0, 40.0, 0.0),
        (30.0, 12.0, 6.0),
        (8.0, 8.0, 4.0),
    ] {
        let shape = Shape::rounded_rect(0.0, 0.0, width, height, round).unwrap();
        let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
        let mesh = shadow.mesh(levels(2.0));
        for _ in 0..2_000 {
            let point = [
                lots.next() * (width + 20.0) - 10.0,
                lots.next() * (height + 20.0) - 10.0,
            ];
            let within = |[a, b, c]: [MeshVertex; 3]| {
                let sides = [(a, b), (b, c), (c, a)];
                let least = sides.map(|(a, b)| double_area(a.position, b.position, point));
                least.into_iter().fold(f64::INFINITY, f64::min)
            };
            let depths: Vec<f64> = mesh.triangles().map(within).collect();
            // On an edge, as far as rounding goes, it lies in both triangles or in neither.
            if depths.iter().any(|depth| depth.abs() < 1e-4) || shadow.density_at(point) < 1e-9 {
                continue;
            }
            let count = depths.iter().filter(|&&depth| depth > 0.0).count();
            assert_eq!(count, 1, "{width} x {height}, {round} at {point:?}");
        }
    }
}

#[test]
fn one_interval_fewer_is_too_coarse() {
    // On a straight edge a card at one level takes so many pieces; the next mesh with fewer is off by more.
    let shadow = android_card(8.0);
    let rings = |mesh: &ShadowMesh| {
        let mut densities: Vec<f32> = mesh
            .vertices()
            .iter()
            .map(|vertex| vertex.density)
            .collect();
        densities.sort_by(f32::total_cmp);
        densities.len()
    };
    let fine = shadow.mesh(levels(1.0));
    let mut coarser = 1.0;
    let coarse = loop {
        coarser += 0.1;
        let mesh = shadow.mesh(levels(coarser));
        if rings(&mesh) < rings(&fine) {
            break mesh;
        }
    };
    let count = rings(&coarse);
    // Strips are for all corners about as round over the penumbra: fewer are too coarse for some of them.
    let worst = [8.0, 7.8, 7.6, 7.4, 7.25].map(|elevation| {
        let shadow = android_card(elevation);
        let mesh = shadow.mesh(levels(coarser));
        assert_eq!(rings(&mesh), count);
        dense_error(&shadow, &mesh, 6)
    });
    assert!(worst.iter().any(|error| *error > 1.0), "{worst:?}");
}

#[test]
fn pictures_move_no_faster_than_the_exact_ones() {
    // Through corners as round as the penumbra, and umbrae that vanish.
    let light = Light::new([40.0, 30.0, 600.0], 800.0).unwrap();
    let grid = Grid::new([-60.0, -60.0], [40, 40], 0.2).unwrap();
    for (width, height, round) in [(60.0, 40.0, 12.0), (40.0, 40.0, 20.0), (90.0, 16.0, 2.0)] {
        let shape = Shape::rounded_rect(10.0, 10.0, width, height, round).unwrap();
        let mut last: Option<(Vec<f32>, Vec<f64>)> = None;
        for step in 0_u8..40 {
            let elevation = 0.1 * 1.19_f32.powi(i32::from(step));
            let shadow = light.cast(&shape, elevation, 0.0).unwrap();
            let mesh = shadow.mesh(levels(2.0));
            let mut picture = vec![0.0; 1_600];
            mesh.rasterize(&grid, &mut picture).unwrap();
            let exact: Vec<f64> = (0_u16..1_600)
                .map(|i| shadow.density_at([i % 40, i / 40].map(|v| f32::from(v) * 5.0 - 57.5)))
                .collect();
            if let Some((before, exact_before)) = last {
                for i in 0..1_600 {
                    let moved = f64::from((picture[i] - before[i]).abs());
                    let may = (exact[i] - exact_before[i]).abs();
                    assert!(
                        moved <= may + 4.0 / 255.0,
                        "{width} x {height} at {elevation}"
                    );
                }
            }
            last = Some((picture, exact));
        }
    }
}

#[test]
fn strips_without_width_take_no_chords_without_end() {
    // Narrower than the penumbra by so much that some rays have all of their bends at one end.
    let light = Light::directional([0.0, 0.0], 10.0).unwrap();
    let bar = Shape::rect(0.0, 0.0, 1.6, 70.0).unwrap();
    let shadow = light.cast(&bar, 1.0, 0.0).unwrap();
    let mesh = shadow.mesh(levels(0.5));
    sanity_check(&mesh);
    assert!(mesh.is_complete());
    let count = mesh.triangles().count();
    assert!(count < 2_000, "{count} triangles");
}

#[test]
fn unequal_corners_are_measured_as_what_they_are() {
    // In the smallest rectangle that has these corners one reaches past the middle.
    let light = Light::directional([0.0, 0.0], 10.0).unwrap();
    let radii = CornerRadii::from([15.184315, 5.279913, 25.94477, 3.8129787]);
    let shape = Shape::rounded_rect(0.0, 0.0, 104.267494, 58.488327, radii).unwrap();
    let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
    let mesh = shadow.mesh(levels(4.0));
    let worst = dense_error(&shadow, &mesh, 12);
    assert!(worst <= mesh.error_levels(), "{worst}");
}
