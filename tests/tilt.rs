//! Casters in any pose, against rays to the light's disc.

#![expect(clippy::unwrap_used, reason = "a pose that is refused fails the test")]

#[expect(dead_code, reason = "other tests take more of it")]
mod common;

use core::f32::consts::PI;

use common::worst_of;
use penumbral::plan::Method;
use penumbral::{
    FillRule, Grid, Incomplete, Light, MeshOptions, MeshVertex, Path, PixelOptions, Pose, Scratch,
    ShadowMesh, Shape, Stroke, TiltedShadow, Tolerance,
};

const LIGHT: [f64; 3] = [80.0, 30.0, 300.0];
const LIGHT_RADIUS: f64 = 120.0;
const CARD: [f64; 4] = [50.0, 60.0, 60.0, 40.0];
const PIVOT: [f64; 2] = [80.0, 80.0];

fn light() -> Light {
    Light::new(LIGHT.map(|v| v as f32), LIGHT_RADIUS as f32).unwrap()
}

fn card() -> Shape {
    let [x, y, w, h] = CARD.map(|v| v as f32);
    Shape::rect(x, y, w, h).unwrap()
}

fn flip(elevation: f64, degrees: f64, axis: [f64; 2]) -> TiltedShadow {
    let pose = Pose::turned(
        elevation as f32,
        PIVOT.map(|v| v as f32),
        axis.map(|v| v as f32),
        (degrees as f32).to_radians(),
    )
    .unwrap();
    light().cast_posed(&card(), &pose, 0.0).unwrap()
}

/// The part of 200 x 200 rays to the light's disc that the turned card stops above the ground.
fn by_rays(elevation: f64, degrees: f64, axis: [f64; 2], point: [f64; 2]) -> f64 {
    const SIDE: u32 = 200;
    // As the pose takes it.
    let angle = f64::from((degrees as f32).to_radians());
    let length = axis[0].hypot(axis[1]);
    let along = [axis[0] / length, axis[1] / length];
    let across = [-along[1], along[0]];
    // The card's plane: every point less the pivot is `s along + t (cos across + sin z)`.
    let normal = [
        -across[0] * angle.sin(),
        -across[1] * angle.sin(),
        angle.cos(),
    ];
    let mut stopped = 0;
    for stratum in 0..SIDE * SIDE {
        let part = |index: u32| (f64::from(index) + 0.5) / f64::from(SIDE);
        let distance = LIGHT_RADIUS * part(stratum / SIDE).sqrt();
        let turn = core::f64::consts::TAU * part(stratum % SIDE);
        let to = [
            LIGHT[0] + distance * turn.cos() - point[0],
            LIGHT[1] + distance * turn.sin() - point[1],
            LIGHT[2],
        ];
        let away = [PIVOT[0] - point[0], PIVOT[1] - point[1], elevation];
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let share = dot(normal, away) / dot(normal, to);
        if !(0.0..=1.0).contains(&share) {
            continue;
        }
        let met = [0, 1, 2].map(|i| share * to[i] - away[i]);
        let s = met[0] * along[0] + met[1] * along[1];
        let flat = met[0] * across[0] + met[1] * across[1];
        let t = flat * angle.cos() + met[2] * angle.sin();
        let on_card = [0, 1].map(|i| PIVOT[i] + s * along[i] + t * across[i]);
        let inside = [0, 1].map(|i| on_card[i] >= CARD[i] && on_card[i] <= CARD[i] + CARD[i + 2]);
        stopped += u32::from(inside[0] && inside[1]);
    }
    f64::from(stopped) / f64::from(SIDE * SIDE)
}

#[test]
fn a_level_pose_casts_as_the_shape_does() {
    let tilted = flip(40.0, 0.0, [0.0, 1.0]);
    let level = light().cast(&card(), 40.0, 0.0).unwrap();
    for i in 0..40 {
        let point = [i as f32 * 4.3, 90.0 + (i % 7) as f32 * 9.0];
        let error = tilted.density_at(point) - level.density_at(point);
        assert!(error.abs() < 1e-12, "{point:?}: {error:e}");
    }
}

/// A disc, a blob and a stroke, drawn 400 pixels wide whatever a scene unit is, by their poses and as level casters.
#[test]
fn curves_are_fine_enough_in_any_unit_and_however_magnified() {
    const SIZE: [u32; 2] = [400, 120];
    let shapes = |unit: f32, across: f32| {
        let place = |x: f32, y: f32| [x, y].map(|v| 200.0 * unit + v * across);
        let mut blob = Path::new();
        blob.move_to(place(-0.5, 0.0))
            .cubic_to(place(-0.5, -0.9), place(0.4, -0.6), place(0.5, 0.0))
            .cubic_to(place(0.4, 0.6), place(-0.5, 0.7), place(-0.5, 0.0));
        let mut arch = Path::new();
        arch.move_to(place(-0.4, 0.2))
            .quad_to(place(0.0, -0.9), place(0.4, 0.2));
        let pen = Stroke::new(0.2 * across).unwrap();
        [
            Shape::circle(place(0.0, 0.0), 0.48 * across).unwrap(),
            Shape::path(&blob, FillRule::NonZero).unwrap(),
            Shape::stroke(&arch, &pen).unwrap(),
        ]
    };
    let mut scratch = Scratch::new();
    let mut worst: f32 = 0.0;
    for unit in [1.0 / 400.0, 0.1, 10.0] {
        let grid = Grid::new([0.0, 0.0], SIZE, 1.0 / unit).unwrap();
        for magnified in [1.0, 40.0] {
            for radius in [0.0, 0.4, 4.0, 40.0] {
                // The light stands above the middle, a unit high: what is magnified is right below it.
                let height = 400.0 * unit;
                let elevation = height
                    * if magnified == 1.0 {
                        0.01
                    } else {
                        1.0 - 1.0 / magnified
                    };
                let growth = height / (height - elevation);
                let spread = radius * unit * height / (elevation * growth);
                let light = Light::new([200.0 * unit, 200.0 * unit, height], spread).unwrap();
                let pose = Pose::turned(elevation, [0.0, 0.0], [1.0, 0.0], 0.0).unwrap();
                for shape in shapes(unit, 400.0 * unit / growth) {
                    let mut by = [(); 2].map(|()| vec![0.0; (SIZE[0] * SIZE[1]) as usize]);
                    let exact = PixelOptions::default().with_method(Method::Exact);
                    let level = light.cast(&shape, elevation, 0.0).unwrap();
                    level
                        .fill_f32(&grid, &mut by[0], &exact, &mut scratch)
                        .unwrap();
                    let posed = light.cast_posed(&shape, &pose, 0.0).unwrap();
                    posed
                        .fill_f32(&grid, &mut by[1], &exact, &mut scratch)
                        .unwrap();
                    let error = worst_of(&by[0], &by[1]);
                    println!(
                        "a unit of {} px, {magnified} times, r {radius} px: {error:.3} levels",
                        1.0 / unit
                    );
                    worst = worst.max(error);
                }
            }
        }
    }
    assert!(worst < 1.0, "{worst} levels");
}

#[test]
fn a_card_below_its_receiver_casts_nothing() {
    let pose = Pose::turned(40.0, PIVOT.map(|v| v as f32), [0.0, 1.0], 0.3).unwrap();
    for (receiver, is_empty) in [(0.0, false), (40.0, false), (60.0, true)] {
        let shadow = light().cast_posed(&card(), &pose, receiver).unwrap();
        assert_eq!(shadow.is_empty(), is_empty, "{receiver}");
        assert_eq!(shadow.bounds().is_none(), is_empty, "{receiver}");
    }
}

#[test]
fn a_card_that_lies_on_its_receiver_casts_nothing() {
    let triangle = [[20.0, 30.0], [70.0, 35.0], [45.0, 80.0]];
    let triangle = Shape::polygon(&[triangle], FillRule::NonZero).unwrap();
    for shape in [card(), triangle] {
        for angle in [0.0, PI, -PI, 2.0 * PI] {
            let pose = Pose::turned(0.0, [50.0, 60.0], [1.0, 0.3], angle).unwrap();
            let shadow = light().cast_posed(&shape, &pose, 0.0).unwrap();
            assert!(shadow.is_empty(), "{angle}");
        }
        assert!(light().cast(&shape, 0.0, 0.0).unwrap().is_empty());
    }
}

#[test]
fn a_flipping_card_hides_what_rays_say() {
    let mut worst: f64 = 0.0;
    // Above the ground all the time; then half below it when upright.
    for (elevation, axis) in [(40.0, [0.0, 1.0]), (10.0, [1.0, 0.4])] {
        for degrees in (0..=180).step_by(12) {
            let shadow = flip(elevation, f64::from(degrees), axis);
            for i in 0..24 {
                let point = [
                    30.0 + f64::from(i % 6) * 21.0,
                    45.0 + f64::from(i / 6) * 28.0,
                ];
                let expected = by_rays(elevation, f64::from(degrees), axis, point);
                let got = shadow.density_at(point.map(|v| v as f32));
                worst = worst.max((got - expected).abs() * 255.0);
            }
        }
    }
    println!("worst {worst:.3} levels");
    // The rays' own error: they count, a ray an edge or so.
    assert!(worst < 0.75, "{worst} levels");
}

fn drawn(shadow: &TiltedShadow, size: [u32; 2]) -> Vec<f32> {
    let grid = Grid::new([0.0, 0.0], size, 1.0).unwrap();
    let mut densities = vec![0.0; (size[0] * size[1]) as usize];
    let options = PixelOptions::default();
    shadow
        .fill_f32(&grid, &mut densities, &options, &mut Scratch::new())
        .unwrap();
    densities
}

#[test]
fn pixels_are_the_closed_form_through_the_whole_flip() {
    for (elevation, axis) in [(60.0, [0.0, 1.0]), (55.0, [1.0, 0.7])] {
        let mut before: Option<Vec<f32>> = None;
        for degrees in 0..=180 {
            let shadow = flip(elevation, f64::from(degrees), axis);
            let densities = drawn(&shadow, [160, 140]);
            // One of 23 pixels; the caster is 3 px of penumbra and more above the ground.
            for (index, density) in densities.iter().enumerate().step_by(23) {
                let point = [(index % 160) as f32 + 0.5, (index / 160) as f32 + 0.5];
                let error = (f64::from(*density) - shadow.density_at(point)).abs();
                assert!(error < 1e-6, "{degrees} degrees, {point:?}: {error:e}");
            }
            if let Some(before) = before {
                let most = worst_of(&densities, &before);
                // A degree moves the card's ends by 0.6 px, where r is 8 px and more: 2 / (π r) of density a pixel.
                assert!(most < 14.0, "{degrees} degrees: {most} levels");
            }
            before = Some(densities);
        }
    }
}

/// A card whose lower edge is under the ground, and one with a window: each pixel has a density that the closed form has in it.
#[test]
fn pixels_of_casters_that_dip_below_the_ground_are_the_closed_form() {
    let ring = |x: f32, y: f32, w: f32, h: f32| [[x, y], [x + w, y], [x + w, y + h], [x, y + h]];
    let card = Shape::rect(40.0, 40.0, 120.0, 80.0).unwrap();
    let hole = ring(70.0, 60.0, 60.0, 40.0);
    let window = [ring(40.0, 40.0, 120.0, 80.0), hole];
    let window = Shape::polygon(&window, FillRule::EvenOdd).unwrap();
    for (shape, radius, elevation, angle) in [
        (&card, 100.0, 40.0, 1.0),
        (&card, 800.0, 8.0, 0.3),
        (&card, 800.0, 40.0, 1.4),
        (&card, 20.0, 8.0, 0.3),
        (&window, 800.0, 40.0, 1.4),
        (&window, 200.0, 20.0, 0.4),
    ] {
        let pose = Pose::turned(elevation, [100.0, 80.0], [0.0, 1.0], angle).unwrap();
        let light = Light::new([100.0, 0.0, 600.0], radius).unwrap();
        let shadow = light.cast_posed(shape, &pose, 0.0).unwrap();
        let drawn = drawn(&shadow, [200, 160]);
        let mut worst: f64 = 0.0;
        for (index, density) in (0_u16..).zip(&drawn) {
            let corner = [index % 200, index / 200].map(f32::from);
            let (mut least, mut most) = (1.0_f64, 0.0_f64);
            for step in 0_u8..25 {
                let offset = [step % 5, step / 5].map(|at| f32::from(at) / 4.0);
                let point = [corner[0] + offset[0], corner[1] + offset[1]];
                let exact = shadow.density_at(point);
                (least, most) = (least.min(exact), most.max(exact));
            }
            let off = (least - f64::from(*density)).max(f64::from(*density) - most);
            worst = worst.max(off * 255.0);
        }
        println!("radius {radius}, elevation {elevation}, {angle}: {worst} levels");
        assert!(
            worst <= 1.0,
            "radius {radius}, elevation {elevation}, {angle}: {worst} levels"
        );
    }
}

#[test]
fn a_card_hinged_on_the_ground_is_antialiased_where_it_touches() {
    // The hinge is the card's left side, at elevation 0.
    let pose = Pose::turned(0.0, [50.3, 60.0], [0.0, 1.0], -PI / 5.0).unwrap();
    let hinged = Shape::rect(50.3, 40.25, 60.0, 50.0).unwrap();
    let shadow = light().cast_posed(&hinged, &pose, 0.0).unwrap();
    let densities = drawn(&shadow, [160, 140]);
    for row in 50..80 {
        let at = |column: usize| f64::from(densities[row * 160 + column]);
        // The outline's own left edge covers 0.7 of its pixel, however near to hard the shadow is there.
        assert!((at(50) - 0.7).abs() < 0.02, "row {row}: {}", at(50));
        assert!(
            at(49) < 0.01 && at(52) > 0.99,
            "row {row}: {} {}",
            at(49),
            at(52)
        );
    }
}

#[test]
fn casters_below_the_ground_or_above_the_light_hide_nothing() {
    let at = |elevation: f32| {
        let pose = Pose::turned(elevation, [80.0, 80.0], [0.0, 1.0], 0.0).unwrap();
        light().cast_posed(&card(), &pose, 0.0).unwrap()
    };
    assert!(at(-5.0).bounds().is_none());
    assert!(at(300.5).bounds().is_none());
    assert!(at(299.5).bounds().is_some());
    // Through the light's plane: finite densities everywhere.
    let through = flip(290.0, 60.0, [0.0, 1.0]);
    for density in drawn(&through, [160, 140]) {
        assert!((0.0..=1.0).contains(&density));
    }
}

/// The largest difference in levels between a mesh and the closed form, on a lattice of samples in every triangle and on a grid of
/// pixels that holds the shadow.
fn mesh_error(mesh: &ShadowMesh, shadow: &TiltedShadow) -> f64 {
    const PARTS: u8 = 6;
    let mut worst: f64 = 0.0;
    for corners in mesh.triangles() {
        for i in 0..=PARTS {
            for j in 0..=PARTS - i {
                let weights = [i, j, PARTS - i - j].map(|part| f64::from(part) / f64::from(PARTS));
                let sum = |of: fn(&MeshVertex) -> f32| -> f64 {
                    let parts = corners.iter().zip(weights);
                    parts
                        .map(|(vertex, weight)| f64::from(of(vertex)) * weight)
                        .sum()
                };
                let at = [sum(|v| v.position[0]) as f32, sum(|v| v.position[1]) as f32];
                let density = sum(|v| v.density);
                worst = worst.max((density - shadow.density_at(at)).abs());
            }
        }
    }
    let bounds = shadow.bounds().unwrap();
    let origin = bounds.min.map(|v| v - 2.0);
    let size = [0, 1].map(|i| (bounds.max[i] - origin[i]) as u32 + 2);
    let grid = Grid::new(origin, size, 1.0).unwrap();
    let mut densities = vec![0.0; size[0] as usize * size[1] as usize];
    mesh.rasterize(&grid, &mut densities).unwrap();
    for (index, density) in densities.iter().enumerate() {
        let pixel = [index as u32 % size[0], index as u32 / size[0]];
        let at = [0, 1].map(|i| origin[i] + pixel[i] as f32 + 0.5);
        worst = worst.max((f64::from(*density) - shadow.density_at(at)).abs());
    }
    worst * 255.0
}

#[test]
fn meshes_keep_their_tolerance_through_the_whole_flip() {
    for levels in [1.0_f32, 4.0] {
        let mut most = 0;
        for degrees in (0..=180).step_by(5) {
            let shadow = flip(60.0, f64::from(degrees), [1.0, 0.4]);
            let mesh = shadow.mesh(Tolerance::levels(levels).unwrap());
            let error = mesh_error(&mesh, &shadow);
            let count = mesh.indices().len() / 3;
            most = most.max(count);
            println!(
                "{degrees} degrees: {count} triangles, {error:.3} levels, {:.3} stated",
                mesh.error_levels()
            );
            assert!(mesh.is_complete(), "{degrees} degrees");
            assert!(
                error <= f64::from(levels),
                "{degrees} degrees: {error} levels"
            );
        }
        println!("{levels} levels: {most} triangles at most");
    }
}

#[test]
fn meshes_of_curved_casters_keep_their_tolerance() {
    let shapes = [
        Shape::rounded_rect(50.0, 60.0, 60.0, 40.0, 6.0).unwrap(),
        Shape::circle([80.0, 80.0], 30.0).unwrap(),
    ];
    let tolerance = Tolerance::ONE_LEVEL;
    for light in [light(), Light::android(400.0).unwrap()] {
        // At the last ones the caster is seen edge-on from within its shadow of Android's light: crests of the error are narrow there.
        for degrees in [0.0_f32, 35.0, 76.0, 84.0, 92.0, 120.0] {
            for shape in &shapes {
                let pivot = PIVOT.map(|v| v as f32);
                let pose = Pose::turned(60.0, pivot, [1.0, 0.4], degrees.to_radians()).unwrap();
                let shadow = light.cast_posed(shape, &pose, 0.0).unwrap();
                let mesh = shadow.mesh(tolerance);
                let error = mesh_error(&mesh, &shadow);
                println!(
                    "{degrees} degrees: {} triangles, {error:.3} levels, {:.3} stated",
                    mesh.indices().len() / 3,
                    mesh.error_levels()
                );
                assert!(mesh.is_complete(), "{degrees} degrees");
                assert!(error <= 1.0, "{degrees} degrees: {error} levels");
            }
        }
    }
}

/// Where a caster is sharp, rings of circles of many radii may cross.
#[test]
fn meshes_of_sharp_casters_keep_their_tolerance() {
    let rhombus = |height: f32| {
        let (top, bottom) = (100.0 - height / 2.0, 100.0 + height / 2.0);
        vec![[10.0, 100.0], [100.0, bottom], [190.0, 100.0], [100.0, top]]
    };
    let triangle = vec![[10.0, 100.0], [100.0, 121.0], [190.0, 100.0]];
    let tolerance = Tolerance::levels(4.0).unwrap();
    for (points, x, radius, angle) in [
        (rhombus(42.0), 100.0, 800.0, 0.3),
        (rhombus(42.0), 53.0, 150.0, 0.8),
        (rhombus(2.0), 53.0, 10.0, 0.6),
        (triangle, 53.0, 150.0, 0.4),
    ] {
        let light = Light::new([x, 0.0, 600.0], radius).unwrap();
        let shape = Shape::polygon(&[points], FillRule::NonZero).unwrap();
        let pose = Pose::turned(120.0, [100.0; 2], [0.3, 1.0], angle).unwrap();
        let shadow = light.cast_posed(&shape, &pose, 0.0).unwrap();
        let options = MeshOptions::new(tolerance);
        for options in [options, options.quick()] {
            let mesh = shadow.mesh(options);
            let error = mesh_error(&mesh, &shadow);
            println!("{} triangles, {error:.3} levels", mesh.indices().len() / 3);
            assert!(mesh.is_complete(), "{:?}", mesh.incomplete());
            assert!(error <= 4.0, "{shape:?}: {error} levels");
        }
    }
}

#[test]
fn a_shadow_without_end_has_no_mesh_and_says_so() {
    let mesh = flip(290.0, 60.0, [0.0, 1.0]).mesh(Tolerance::ONE_LEVEL);
    assert_eq!(mesh.incomplete(), Some(Incomplete::Endless));
    assert!(mesh.indices().is_empty());
}

#[test]
fn meshes_of_casters_that_touch_the_ground_say_so() {
    let hinged = flip(20.0, 90.0, [0.0, 1.0]);
    let mesh = hinged.mesh(Tolerance::levels(2.0).unwrap());
    println!(
        "{} triangles, {} levels",
        mesh.indices().len() / 3,
        mesh.error_levels()
    );
    assert_eq!(mesh.incomplete(), Some(Incomplete::Narrow));
    // All but a few pixels about the two points where the penumbra begins are right.
    let bounds = hinged.bounds().unwrap();
    let size = [0, 1].map(|i| (bounds.max[i] - bounds.min[i]) as u32 + 1);
    let grid = Grid::new(bounds.min, size, 1.0).unwrap();
    let mut densities = vec![0.0; size[0] as usize * size[1] as usize];
    mesh.rasterize(&grid, &mut densities).unwrap();
    let mut wrong = 0;
    for (index, density) in densities.iter().enumerate() {
        let pixel = [index as u32 % size[0], index as u32 / size[0]];
        let at = [0, 1].map(|i| bounds.min[i] + pixel[i] as f32 + 0.5);
        let error = (f64::from(*density) - hinged.density_at(at)).abs() * 255.0;
        wrong += u32::from(error > 2.0);
    }
    assert!(wrong <= 8, "{wrong} pixels");
}

#[test]
fn a_hard_shadow_of_a_tilted_caster_is_filled() {
    let light = Light::new(LIGHT.map(|v| v as f32), 0.0).unwrap();
    let pose = Pose::turned(40.0, [80.0, 80.0], [0.0, 1.0], 0.6).unwrap();
    let shadow = light.cast_posed(&card(), &pose, 0.0).unwrap();
    let mesh = shadow.mesh(Tolerance::ONE_LEVEL);
    assert_eq!(mesh.incomplete(), Some(Incomplete::Narrow));
    let area: f64 = mesh
        .triangles()
        .map(|corners| {
            let [a, b, c] = corners.map(|vertex| vertex.position.map(f64::from));
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs() / 2.0
        })
        .sum();
    let bounds = shadow.bounds().unwrap();
    let [width, height] = [0, 1].map(|i| f64::from(bounds.max[i] - bounds.min[i]));
    assert!(area > 0.8 * width * height && area < width * height);
}
