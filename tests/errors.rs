//! Errors as users meet them: every one, by the inputs of the table in its documentation.

#![expect(clippy::unwrap_used, reason = "what fails in a helper is the test")]

use penumbral::{
    Blending, Bounds, Color, DensityMap, Error, FillRule, Grid, Hidden, Light, Limits,
    MAX_SEGMENTS, MeshSlices, MeshVertex, Paint, Path, PixelOptions, Pose, Renderer, Scene,
    Scratch, Shape, Surface, Tolerance, Tone, plan,
};
use tiny_skia::Pixmap;

fn light() -> Light {
    Light::new([30.0, 20.0, 600.0], 800.0).unwrap()
}

fn card() -> Shape {
    Shape::rect(10.0, 10.0, 20.0, 20.0).unwrap()
}

fn scene() -> Scene {
    let mut scene = Scene::new([60.0, 40.0], light()).unwrap();
    scene.push(Surface::new(card(), 8.0)).unwrap();
    scene
}

fn pose() -> Pose {
    Pose::turned(20.0, [10.0, 10.0], [0.0, 1.0], 0.4).unwrap()
}

fn posed() -> Surface {
    Surface::posed(card(), &pose())
}

fn grid() -> Grid {
    Grid::new([0.0, 0.0], [10, 10], 1.0).unwrap()
}

fn pixmap(width: u32) -> Pixmap {
    Pixmap::new(width, 40).unwrap()
}

/// Draws onto so many bytes with pixels hidden on another grid, where there is one.
fn drawn(length: usize, hidden: Option<Grid>) -> Result<(), Error> {
    let hidden = hidden.map(|grid| Hidden::new(&grid));
    let options = PixelOptions::default().with_hidden(hidden.as_ref());
    let shadow = light().cast(&card(), 8.0, 0.0)?;
    shadow.fill_a8(&grid(), &mut vec![0; length], &options, &mut Scratch::new())
}

#[test]
fn what_is_refused_leaves_the_buffer_as_it_was() {
    let hidden = Hidden::new(&Grid::new([1.0, 0.0], [10, 10], 1.0).unwrap());
    let options = PixelOptions::default().with_hidden(&hidden);
    let shadow = light().cast(&card(), 8.0, 0.0).unwrap();
    let (mut mask, mut densities, mut scratch) = ([7; 100], [0.7; 100], Scratch::new());
    let refused = shadow.fill_a8(&grid(), &mut mask, &options, &mut scratch);
    assert!(refused.is_err() && mask == [7; 100]);
    let refused = shadow.fill_f32(&grid(), &mut densities, &options, &mut scratch);
    assert!(refused.is_err() && densities == [0.7; 100]);
}

/// Does something with pixels hidden on a grid of 10 x 10.
fn hiding(act: impl Fn(&PixelOptions<'_>) -> Result<(), Error>) -> Result<(), Error> {
    let hidden = Hidden::new(&grid());
    act(&PixelOptions::default().with_hidden(&hidden))
}

fn mapped(options: &PixelOptions<'_>) -> Result<(), Error> {
    let (scene, mut map) = (scene(), DensityMap::default());
    scene
        .ground_shadows()?
        .draw(&mut map, options, &mut Scratch::new())
}

fn skipped(options: &PixelOptions<'_>) -> Result<(), Error> {
    let shadow = light().cast(&card(), 8.0, 0.0)?;
    let grid = Grid::new([0.0, 0.0], [60, 40], 1.0)?;
    plan::skip(&shadow, &grid, options, None).map(drop)
}

/// Makes a mesh into slices of so many vertices and indices.
fn meshed(vertices: usize, indices: usize) -> Result<(), Error> {
    let vertex = MeshVertex {
        position: [0.0; 2],
        density: 0.0,
    };
    let (mut vertices, mut indices) = (vec![vertex; vertices], vec![0_u32; indices]);
    let mut slices = MeshSlices::new(&mut vertices, &mut indices);
    let shadow = light().cast(&card(), 8.0, 0.0)?;
    let mut scratch = Scratch::new();
    let made = shadow.mesh_into(&mut slices, Tolerance::levels(4.0)?, &mut scratch);
    made.map(drop)
}

fn limited(limits: Limits) -> Result<(), Error> {
    Renderer::with_limits(limits).render(&scene(), &mut pixmap(60))
}

/// The error's variant, an input that causes it, and what is said of it.
fn cases() -> Vec<(&'static str, Result<(), Error>, &'static str)> {
    let line = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]].map(|[x, _]: [f32; 2]| [x, 0.0]);
    let many = vec![[0.0, 0.0]; MAX_SEGMENTS + 1];
    let json = |text: &str| Scene::from_json(text).map(drop);
    let cast = |elevation, receiver| light().cast(&card(), elevation, receiver).map(drop);
    #[rustfmt::skip]
    let cases = vec![
        ("NotFinite", Shape::rect(f32::NAN, 0.0, 1.0, 1.0).map(drop), "x is NaN: give a finite number"),
        ("NotFinite", Light::new([0.0, 0.0, f32::INFINITY], 1.0).map(drop), "light.z is inf: give a finite number, no larger than an f32 holds"),
        ("OutOfRange", Shape::rect(1e9, 0.0, 1.0, 1.0).map(drop), "x is 1e9: give a number from -16777216 to 16777216"),
        ("OutOfRange", Tolerance::levels(65.0).map(drop), "tolerance is 65: give a number from 0.0625 to 64"),
        ("NotPositive", Shape::circle([0.0, 0.0], 0.0).map(drop), "radius is 0: give a number above 0"),
        ("NotPositive", Shape::polygon(&[line], FillRule::NonZero).map(drop), "path height is 0: give a number above 0"),
        ("EmptyPath", Shape::path(&Path::new(), FillRule::NonZero).map(drop), "path encloses nothing: give a contour of at least three points"),
        ("TooMany", Shape::polygon(&[many], FillRule::NonZero).map(drop), "1048577 polygon points, over the limit of 1048576: simplify or split what has them"),
        ("TooMany", limited(Limits::default().with_pixels(1000)), "2400 pixels, over the limit of 1000: simplify or split what has them"),
        ("TooMany", limited(Limits::default().with_vertices(3)), "4 vertices, over the limit of 3: simplify or split what has them"),
        ("TooMany", limited(Limits::default().with_surfaces(0)), "1 surfaces, over the limit of 0: simplify or split what has them"),
        ("PathData", Path::from_svg("M 0 0 L").map(drop), "SVG path data, character 8: the data end inside a segment"),
        ("CasterNotBelowLight", cast(600.0, 0.0), "elevation 600 is not below the light at z = 600: lower the caster or raise the light"),
        ("ReceiverNotBelowLight", light().cast_posed(&card(), &pose(), 600.0).map(drop), "receiver 600 is not below the light at z = 600: lower the receiver or raise the light"),
        ("CasterBelowReceiver", cast(1.0, 2.0), "elevation 1 is below the receiver at 2: a caster must be at or above what it shades"),
        ("ShadowTooLarge", cast(599.999_94, 0.0), "the shadow of a caster at elevation 599.99994 reaches"),
        ("PictureSize", Grid::new([0.0, 0.0], [0, 5], 1.0).map(drop), "a picture of 0 x 5 pixels: give 1 to 33554432 pixels in all"),
        ("PictureSize", Scene::new([1e6, 1e6], light()).map(drop), "a picture of 1000000 x 1000000 pixels: give 1 to 33554432 pixels in all"),
        ("BufferSize", drawn(99, None), "the buffer holds 99 bytes or pixels, the grid needs 100: allocate stride x height"),
        ("BufferSize", Paint::new(Color::BLACK, 0.2).and_then(|paint| paint.blend_mask(&grid(), &[0; 99], 10, &mut [0; 400], &mut Scratch::new())), "the buffer holds 99 bytes or pixels, the grid needs 100: allocate stride x height"),
        ("OutOfRange", Paint::new(Color::BLACK, 0.2).and_then(|paint| paint.blend_mask(&grid(), &[0; 100], 9, &mut [0; 400], &mut Scratch::new())), "mask_stride is 9: give a number from 10 to 2.1474836e9"),
        ("BufferSize", Renderer::new().render(&scene(), &mut pixmap(61)), "the buffer holds 2440 bytes or pixels, the grid needs 2400: allocate stride x height"),
        ("MeshRoom", meshed(10, 999), "there is room for 10 vertices, the mesh may need "),
        ("MeshRoom", meshed(999, 10), "there is room for 10 indices, the mesh may need "),
        ("OtherGrid", drawn(100, Grid::new([1.0, 0.0], [10, 10], 1.0).ok()), "options.hidden was made for another grid: make it for the grid that is drawn"),
        ("OtherGrid", hiding(mapped), "options.hidden was made for another grid: make it for the grid that is drawn"),
        ("OtherGrid", hiding(skipped), "options.hidden was made for another grid: make it for the grid that is drawn"),
        ("NotFinite", scene().push(posed().raised(f32::NAN)), "elevation is NaN: give a finite number"),
        ("OutOfRange", scene().push(posed().raised(1e30)), "elevation is 1e30: give a number from -16777216 to 16777216"),
        ("NotFlat", Pose::of_corners([10.0, 20.0, 40.0, 30.0], [5.0, 9.0, 14.0, 11.0]).map(drop), "the corners' elevations miss one plane by -1: "),
        ("NotOpaque", scene().with_background(Color { a: 128, ..Color::WHITE }).map(drop), "background has the alpha 128 of 255: give an opaque colour"),
        ("NotInSvg", scene().with_tone(Tone::default().with_blending(Blending::Linear)).to_svg(Tolerance::ONE_LEVEL).map(drop), "linear blending cannot be written as SVG"),
        ("NotClipped", posed().clipped(&card()).map(drop), "a tilted surface and an image are not clipped"),
        ("Scene", json("{"), "line 1, column 1, scene: the text ends within an object"),
        ("Scene", json(r#"{"canvas": [1, 1], "sky": 1}"#), "line 1, column 24, scene.sky: unknown field `sky`"),
        #[cfg(feature = "finish")]
        ("NotFinished", scene().push(posed().with_finish(penumbral::finish::Finish::new())), "a tilted surface and an image take no finish: leave it out"),
        ("Stopped", Renderer::new().render_while(&scene(), &mut pixmap(60), |_, _| false), "the drawing was stopped"),
    ];
    cases
}

#[test]
fn every_error_says_what_was_wrong_and_what_to_do() {
    for (name, result, message) in cases() {
        let error = result.unwrap_err();
        let shown = format!("{error:?}");
        assert_eq!(shown.split([' ', '{']).next(), Some(name), "{shown}");
        assert!(
            error.to_string().starts_with(message),
            "{error}, not {message}"
        );
        assert_eq!(error.to_string().lines().count(), 1);
    }
}

#[test]
fn the_table_has_every_error_and_each_is_tried() {
    let source = include_str!("../src/error.rs");
    let (_, body) = source.split_once("pub enum Error {").unwrap();
    let (body, _) = body.split_once("\n}").unwrap();
    let variants = body.lines().filter_map(|line| {
        let name = line
            .strip_prefix("    ")?
            .trim_end_matches(" {")
            .trim_end_matches(',');
        let is_name = name.starts_with(char::is_uppercase) && name.chars().all(char::is_alphabetic);
        is_name.then_some(name)
    });
    let tried = cases();
    let mut count = 0;
    for variant in variants {
        count += 1;
        assert!(
            source.contains(&format!("| [`{variant}`](Error::{variant}) | ")),
            "{variant}"
        );
        // Finishes are a feature.
        let is_tried = tried.iter().any(|(name, ..)| *name == variant);
        let is_out = variant == "NotFinished" && !cfg!(feature = "finish");
        assert!(is_tried || is_out, "{variant}");
    }
    assert_eq!(count, 21);
}

/// Stopped wherever it asks, a drawing ends at once, and the next one is as if nothing had been.
#[test]
fn a_drawing_stops_where_it_is_told_to() {
    let mut scene = scene();
    let translucent = Surface::new(card(), 4.0).with_opacity(0.5);
    scene.push(translucent).unwrap();
    let (mut whole, mut asked) = (pixmap(60), Vec::new());
    Renderer::new()
        .render_while(&scene, &mut whole, |done, layers| {
            asked.push((done, layers));
            true
        })
        .unwrap();
    assert_eq!(asked.last(), Some(&(3, 3)));
    assert!(asked.is_sorted());
    let mut renderer = Renderer::new();
    for stop in 0..asked.len() {
        let mut count = 0;
        let stopped = renderer.render_while(&scene, &mut pixmap(60), |_, _| {
            count += 1;
            count <= stop
        });
        assert_eq!((stopped, count), (Err(Error::Stopped), stop + 1));
        let mut again = pixmap(60);
        renderer.render(&scene, &mut again).unwrap();
        assert!(again == whole, "stopped after {stop}");
    }
}

/// A picture of several bands of rows shows the same as parts of it that are drawn in one.
#[test]
fn bands_of_a_large_picture_meet() {
    let light = Light::new([500.0, 500.0, 600.0], 800.0).unwrap();
    let mut scene = Scene::new([1000.0, 2100.0], light).unwrap();
    for (size, elevation) in [(900.0, 4.0), (500.0, 12.0)] {
        let card = Shape::rounded_rect(60.0, 300.0, size, 1.6 * size, 30.0).unwrap();
        scene.push(Surface::new(card, elevation)).unwrap();
    }
    let mut renderer = Renderer::new();
    let mut whole = Pixmap::new(1000, 2100).unwrap();
    renderer.render(&scene, &mut whole).unwrap();
    for first in [0_u32, 500, 1000, 1040, 2000] {
        let rows = first as usize * 4000..(first as usize + 100) * 4000;
        let part = Bounds {
            min: [0.0, first as f32],
            max: [1000.0, first as f32 + 100.0],
        };
        let mut pixmap = Pixmap::new(1000, 2100).unwrap();
        renderer
            .render_within(&scene, &[part], &mut pixmap)
            .unwrap();
        let (part, rows) = (&pixmap.data()[rows.clone()], &whole.data()[rows]);
        assert!(part == rows, "rows from {first} on");
    }
}
