//! What reading and drawing a scene takes of memory is within the formula of [`penumbral::Limits`].

use penumbral::{Bounds, FillRule, Grid, Hidden, Image, Renderer, Scene, Scratch, Shape};
use tiny_skia::Pixmap;

/// A scene of surfaces and its vertices.
struct Case {
    name: &'static str,
    canvas: [u32; 2],
    surfaces: Vec<String>,
    vertices: usize,
    /// How many are curves, and how long in pixels.
    curves: (usize, f64),
    crossings: usize,
    /// The side of the square image `image.png`.
    texels: u32,
}

/// Points about a circle, or across it and back.
fn polygon(count: usize, crossing: bool, elevation: usize) -> String {
    let points = (0..count).map(|i| {
        let turn = if crossing { i * (count / 2 - 1) } else { i };
        let angle = turn as f64 * core::f64::consts::TAU / count as f64;
        let radius = if crossing {
            90.0
        } else {
            80.0 + (i % 7) as f64
        };
        format!(
            "[{:.4},{:.4}]",
            100.0 + radius * angle.cos(),
            100.0 + radius * angle.sin()
        )
    });
    let points: Vec<String> = points.collect();
    format!(
        r#"{{"shape":"polygon","points":[{}],"elevation":{elevation}}}"#,
        points.join(",")
    )
}

fn cases() -> Vec<Case> {
    let card = |i: usize, round: &str, elevation: usize| {
        let (x, y) = (9 * (i % 20), 9 * (i / 20));
        format!(r#"{{"shape":"rrect","x":{x},"y":{y},"w":8,"h":8,{round}"elevation":{elevation}}}"#)
    };
    let waves = (0..300).map(|i| {
        let (x, y) = (i % 60 * 3, i / 60 * 4);
        format!("M{x} {y}q1 -2 2 0t1 1z")
    });
    let waves: String = waves.collect();
    vec![
        Case {
            name: "pixels",
            canvas: [1500, 1000],
            surfaces: vec![card(8, r#""radius":3,"#, 4)],
            vertices: 8,
            curves: (0, 0.0),
            crossings: 0,
            texels: 1,
        },
        Case {
            name: "a picture of several bands",
            canvas: [3000, 3000],
            surfaces: vec![card(8, r#""radius":3,"#, 4)],
            vertices: 8,
            curves: (0, 0.0),
            crossings: 0,
            texels: 1,
        },
        Case {
            name: "points of a polygon",
            canvas: [200, 200],
            surfaces: vec![polygon(1000, false, 8)],
            vertices: 1000,
            curves: (0, 0.0),
            crossings: 0,
            texels: 1,
        },
        Case {
            name: "crossings",
            canvas: [200, 200],
            surfaces: vec![polygon(201, true, 8)],
            vertices: 201,
            curves: (0, 0.0),
            crossings: 19698,
            texels: 1,
        },
        Case {
            name: "curves",
            canvas: [200, 200],
            surfaces: vec![format!(r#"{{"shape":"path","d":"{waves}","elevation":3}}"#)],
            vertices: 600,
            curves: (600, 3.0),
            crossings: 0,
            texels: 1,
        },
        Case {
            name: "large curves",
            canvas: [200, 200],
            surfaces: vec![format!(
                r#"{{"shape":"path","d":"{}","elevation":3}}"#,
                (0..12)
                    .map(|i| format!("M{} 9c40 250 140 -150 150 90z", 3 * i))
                    .collect::<String>()
            )],
            vertices: 12,
            curves: (12, 260.0),
            crossings: 500,
            texels: 1,
        },
        Case {
            name: "cards at one elevation",
            canvas: [200, 200],
            surfaces: (0..100).map(|i| card(i, r#""radius":2,"#, 4)).collect(),
            vertices: 100 * 8,
            curves: (0, 0.0),
            crossings: 0,
            texels: 1,
        },
        Case {
            name: "cards at many",
            canvas: [200, 200],
            surfaces: (0..12).map(|i| card(i, "", i % 4)).collect(),
            vertices: 12 * 4,
            curves: (0, 0.0),
            crossings: 0,
            texels: 1,
        },
        Case {
            name: "an image over cards at many",
            canvas: [200, 200],
            surfaces: (0..5)
                .map(|i| card(i, "", i))
                .chain([
                    r#"{"shape":"rrect","image":"image.png","x":10,"y":10,"w":90,"h":90,"elevation":9}"#.to_owned(),
                ])
                .collect(),
            vertices: 5 * 4 + 4,
            curves: (0, 0.0),
            crossings: 0,
            texels: 700,
        },
    ]
}

#[test]
fn memory_is_within_the_formula() {
    for case in cases() {
        let [width, height] = case.canvas;
        let text = format!(
            r#"{{"canvas":[{width},{height}],"light":{{"x":100,"y":0,"z":600,"radius":800}},"surfaces":[{}]}}"#,
            case.surfaces.join(",")
        );
        let taken = allocation_counter::measure(|| {
            let mut image = |_: &str| {
                let bytes = vec![128; 4 * (case.texels * case.texels) as usize];
                Image::from_rgba8([case.texels; 2], bytes).map_err(|error| error.to_string())
            };
            let scene = Scene::from_json_with_images(&text, &mut image).unwrap();
            let mut pixmap = Pixmap::new(width, height).unwrap();
            Renderer::new().render(&scene, &mut pixmap).unwrap();
            let all = Bounds {
                min: [0.0, 0.0],
                max: [width as f32, height as f32],
            };
            Renderer::new()
                .render_within(&scene, &[all], &mut pixmap)
                .unwrap();
        });
        let pixels = (width * height) as usize;
        let band = pixels.min(1 << 20);
        let (curves, length) = case.curves;
        let lines = 32 * (curves as f64 * length.sqrt()) as usize;
        let formula = 4 * pixels
            + 20 * band
            + 2048 * (case.vertices + lines)
            + 256 * case.crossings
            + 20 * text.len()
            + 32 * (case.texels * case.texels) as usize
            + (1 << 20);
        println!(
            "{}: {} bytes of {formula}, {pixels} pixels, {} vertices, {} of text",
            case.name,
            taken.bytes_max,
            case.vertices,
            text.len()
        );
        assert!(taken.bytes_max <= formula as u64, "{}", case.name);
    }
}

/// What hides pixels takes memory for its edges and for the pixels, not for their product.
#[test]
fn hidden_pixels_take_memory_by_edges_and_rows() {
    let teeth = 2500;
    let comb: Vec<[f32; 2]> = (0..teeth)
        .flat_map(|tooth| {
            let x = 0.05 * tooth as f32;
            [[x, 0.0], [x + 0.01, 4000.0]]
        })
        .chain([[126.0, 4000.0], [126.0, 0.0]])
        .collect();
    let comb = Shape::polygon(&[comb], FillRule::NonZero).unwrap();
    let card = Shape::rect(1.0, 0.0, 120.0, 4000.0).unwrap();
    let grid = Grid::new([0.0, 0.0], [128, 4000], 1.0).unwrap();
    let mut hidden = Hidden::new(&grid);
    let taken = allocation_counter::measure(|| hidden.add(&comb, &mut Scratch::new()));
    println!("a comb: {} bytes", taken.bytes_max);
    assert!(taken.bytes_max < 8 << 20, "{}", taken.bytes_max);
    let cards = core::iter::repeat_n(&card, 1000);
    let taken = allocation_counter::measure(|| hidden.add_all(cards, &mut Scratch::new()));
    println!("cards on one another: {} bytes", taken.bytes_max);
    assert!(taken.bytes_max < 8 << 20, "{}", taken.bytes_max);
}
