//! A warm drawing takes no memory.

#![expect(clippy::unwrap_used, reason = "a case that is refused fails the test")]

use penumbral::plan::Method;
use penumbral::{
    Color, FillRule, Grid, Hidden, Light, MeshBuffers, MeshOptions, Paint, Path, PixelOptions,
    Scratch, Shape, Tolerance,
};

fn shapes() -> Vec<(&'static str, Vec<Shape>)> {
    let mut heart = Path::new();
    heart
        .move_to([80.0, 140.0])
        .cubic_to([10.0, 100.0], [0.0, 50.0], [15.0, 30.0])
        .cubic_to([40.0, 5.0], [70.0, 15.0], [80.0, 40.0])
        .cubic_to([90.0, 15.0], [120.0, 5.0], [145.0, 30.0])
        .cubic_to([160.0, 50.0], [150.0, 100.0], [80.0, 140.0]);
    let star: Vec<[f32; 2]> = (0_u8..10)
        .map(|i| {
            let (sin, cos) = (f32::from(i) * core::f32::consts::PI / 5.0).sin_cos();
            let radius = if i % 2 == 0 { 70.0 } else { 28.0 };
            [80.0 + radius * sin, 80.0 - radius * cos]
        })
        .collect();
    let card = |x: f32, y: f32| Shape::rounded_rect(x, y, 36.0, 20.0, 4.0).unwrap();
    let cards = (0_u8..30).map(|i| card(f32::from(i % 4) * 40.0, f32::from(i / 4) * 24.0 - 10.0));
    let ring = |side: f32| {
        let (a, b) = (80.0 - side, 80.0 + side);
        [[80.0, a], [b, 82.0], [80.0, b], [a, 78.0]]
    };
    vec![
        (
            "card",
            vec![Shape::rounded_rect(20.3, 30.0, 110.0, 80.0, 9.0).unwrap()],
        ),
        (
            "pill",
            vec![Shape::rounded_rect(20.3, 50.0, 110.0, 40.0, 20.0).unwrap()],
        ),
        ("circle", vec![Shape::circle([80.0, 80.0], 40.0).unwrap()]),
        (
            "star",
            vec![Shape::polygon(&[star], FillRule::NonZero).unwrap()],
        ),
        (
            "heart",
            vec![Shape::path(&heart, FillRule::NonZero).unwrap()],
        ),
        (
            "ring",
            vec![Shape::polygon(&[ring(60.0), ring(35.0)], FillRule::EvenOdd).unwrap()],
        ),
        (
            "overlapping",
            vec![
                card(30.0, 30.0),
                card(50.0, 40.0),
                Shape::circle([80.0, 60.0], 20.0).unwrap(),
            ],
        ),
        ("cards", cards.collect()),
    ]
}

#[test]
fn a_warm_drawing_takes_no_memory() {
    let grid = Grid::new([0.0, 0.0], [160, 160], 1.0).unwrap();
    let paint = Paint::new(Color::BLACK, 0.2).unwrap();
    let mut scratch = Scratch::new();
    let (mut mask, mut canvas) = (vec![0; 160 * 160], vec![255; 4 * 160 * 160]);
    let mut hidden = Hidden::new(&grid);
    for (name, shapes) in shapes() {
        for radius in [0.0_f32, 0.3, 1.5, 4.0, 12.0, 40.0] {
            let light = Light::directional([0.0, 3.0], radius).unwrap();
            let shadow = light.cast_all(&shapes, 1.0, 0.0).unwrap();
            for method in [
                None,
                Some(Method::Direct),
                Some(Method::Grid),
                Some(Method::NinePatch),
            ] {
                for hides in [false, true] {
                    let mut draw = || {
                        hidden.reset(&grid);
                        if hides {
                            hidden.add_all(shapes.iter(), &mut scratch);
                        }
                        let options = PixelOptions::default()
                            .with_method(method)
                            .with_hidden(&hidden);
                        shadow
                            .fill_a8(&grid, &mut mask, &options, &mut scratch)
                            .unwrap();
                        shadow
                            .blend_rgba8(&grid, &mut canvas, &paint, &options, &mut scratch)
                            .unwrap();
                    };
                    (0..3).for_each(|_| draw());
                    let warm = allocation_counter::measure(draw);
                    assert_eq!(
                        warm.count_total, 0,
                        "{name} at r {radius} by {method:?}, hidden {hides}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_warm_mesh_of_a_rounded_rectangle_takes_no_memory() {
    let (mut buffers, mut scratch) = (MeshBuffers::<u16>::new(), Scratch::new());
    for (name, shapes) in shapes().into_iter().take(3) {
        for radius in [1.5_f32, 6.0, 12.0, 30.0] {
            let light = Light::directional([0.0, 3.0], radius).unwrap();
            let mut mesh = |place: f32| {
                let moved = shapes[0]
                    .transformed([1.0, 0.0, 0.0, 1.0, place, 0.0])
                    .unwrap();
                let shadow = light.cast(&moved, 1.0, 0.0).unwrap();
                let mut into = || {
                    buffers.clear();
                    let tolerance = Tolerance::ONE_LEVEL;
                    let quality = shadow.mesh_into(&mut buffers, tolerance, &mut scratch);
                    assert!(quality.unwrap().is_complete());
                };
                into();
                allocation_counter::measure(into).count_total
            };
            // Where it is moved to does not matter.
            for place in [0.0, 17.3] {
                assert_eq!(mesh(place), 0, "{name} at r {radius}");
            }
        }
    }
}

#[test]
fn a_mesh_of_known_corners_takes_no_memory_whatever_its_size() {
    let (mut buffers, mut scratch) = (MeshBuffers::<u16>::new(), Scratch::new());
    let mut mesh = |size: [f32; 2], round: f32, radius: f32| {
        let shape = Shape::rounded_rect(3.0, 4.0, size[0], size[1], round).unwrap();
        let light = Light::directional([0.0, 3.0], radius).unwrap();
        let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
        buffers.clear();
        let mut quality = None;
        let taken = allocation_counter::measure(|| {
            let tolerance = Tolerance::ONE_LEVEL;
            quality = Some(shadow.mesh_into(&mut buffers, tolerance, &mut scratch));
        });
        assert!(quality.unwrap().unwrap().is_complete());
        taken.count_total
    };
    // Cards and pills, which only grow longer; and cards that rise a little.
    mesh([200.0, 100.0], 8.0, 10.0);
    mesh([200.0, 40.0], 20.0, 10.0);
    for more in [0.5, 60.0, 700.0] {
        assert_eq!(mesh([200.0 + more, 100.0 + more], 8.0, 10.0), 0);
        assert_eq!(mesh([200.0 + more, 40.0], 20.0, 10.0), 0);
    }
    for radius in [9.5, 10.1, 10.3] {
        assert_eq!(mesh([200.0, 100.0], 8.0, radius), 0);
    }
}

#[test]
fn a_warm_mesh_of_another_outline_takes_no_memory_where_it_stays() {
    let light = Light::android(200.0).unwrap();
    let points = [[20.0, 20.0], [90.0, 30.0], [40.0, 50.0], [60.0, 110.0]];
    let kite = Shape::polygon(&[points], FillRule::NonZero).unwrap();
    let shadow = light.cast(&kite, 4.0, 0.0).unwrap();
    let (mut buffers, mut scratch) = (MeshBuffers::<u16>::new(), Scratch::new());
    let mut into = || {
        buffers.clear();
        let quality = shadow.mesh_into(&mut buffers, Tolerance::ONE_LEVEL, &mut scratch);
        assert!(quality.unwrap().is_complete());
    };
    into();
    assert_eq!(allocation_counter::measure(into).count_total, 0);
    let mesh = shadow.mesh(Tolerance::ONE_LEVEL);
    assert_eq!(buffers.vertices, mesh.vertices());
}

#[test]
fn a_warm_mesh_of_halved_squares_takes_no_memory() {
    let (mut buffers, mut scratch) = (MeshBuffers::<u16>::new(), Scratch::new());
    for (name, shapes) in shapes().into_iter().skip(3) {
        let light = Light::directional([0.0, 3.0], 30.0).unwrap();
        let shadow = light.cast_all(&shapes, 1.0, 0.0).unwrap();
        let mut into = |levels| {
            buffers.clear();
            let options = MeshOptions::new(Tolerance::levels(levels).unwrap()).quick();
            let quality = shadow.mesh_into(&mut buffers, options, &mut scratch);
            assert!(quality.unwrap().is_complete());
        };
        into(1.0);
        // Not the same meshes again: other tolerances take other triangles.
        for levels in [1.05, 1.25] {
            let count = allocation_counter::measure(|| into(levels)).count_total;
            assert_eq!(count, 0, "{name} within {levels}");
        }
    }
}
