//! What a finish promises: normals, shading, detail, and nothing where there is none.

#![expect(clippy::unwrap_used, reason = "what fails in a helper is the test")]

use std::sync::Arc;

use penumbral::finish::{
    Canvas, Finish, Intensity, Lighting, Material, Rim, RimMesh, RimProfile, RimSurface,
    ShadingModel, Tile, normals,
};
use penumbral::{
    Color, CornerRadii, Error, FillRule, Grid, Group, Image, Light, Renderer, Scene, Shape,
    Surface, Tolerance,
};
use tiny_skia::Pixmap;

/// A card with three round corners and a sharp one, at the right below, whose rim is a quarter round.
fn card() -> (Shape, Rim) {
    let radii = CornerRadii([[60.0; 2], [60.0; 2], [0.0; 2], [60.0; 2]]);
    let card = Shape::rounded_rect(0.0, 0.0, 240.0, 180.0, radii).unwrap();
    (
        card,
        Rim::new(24.0, 24.0, RimProfile::QuarterRound).unwrap(),
    )
}

fn degrees_between(a: [f64; 3], b: [f64; 3]) -> f64 {
    let cosine: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    cosine.clamp(-1.0, 1.0).acos().to_degrees()
}

/// The largest angles, degrees, between a model's normals and the surface's own: on smooth parts, and beside the crease, within 8
/// pixels of the line from the sharp corner to the inset's.
fn misses(model: ShadingModel) -> [f64; 2] {
    let (card, rim) = card();
    let surface = RimSurface::new(&card, &rim);
    let mesh = RimMesh::new(&card, &rim).unwrap();
    let grid = Grid::new([0.0, 0.0], [240, 180], 1.0).unwrap();
    let mut largest = [0.0_f64; 2];
    for (index, normal) in normals(&grid, &mesh, model).into_iter().enumerate() {
        let Some(normal) = normal else { continue };
        let (x, y) = ((index % 240) as f64 + 0.5, (index / 240) as f64 + 0.5);
        let (left, up) = (240.0 - x, 180.0 - y);
        let across = (left - up).abs() / 2.0_f64.sqrt();
        // On the crease itself either side is right.
        if across == 0.0 && left < 24.0 {
            continue;
        }
        let is_beside = left < 24.0 && up < 24.0 && across < 8.0;
        let miss = degrees_between(normal, surface.normal_at([x, y]));
        let largest = &mut largest[usize::from(is_beside)];
        *largest = largest.max(miss);
    }
    largest
}

#[test]
fn in_one_mesh_what_is_round_stays_round_and_what_is_sharp_sharp() {
    let [faces, vertices, driven] = [
        ShadingModel::Flat,
        ShadingModel::Phong,
        ShadingModel::CurvatureDriven,
    ]
    .map(misses);
    println!("degrees on smooth parts and beside the crease:");
    println!("faces {faces:.2?}, vertices {vertices:.2?}, curvature-driven {driven:.2?}");
    assert!(driven[0] < 3.0 && driven[1] < 3.0);
    // Faces are sharp, but facet the arcs; vertices blur the crease by nearly half of its 90 degrees.
    assert!(faces[0] > driven[0] + 1.0 && faces[1] < 3.0);
    assert!(vertices[1] > 30.0);
}

/// Outlines with arcs, curves, sharp and inner corners, holes and places narrower than the rim.
fn outlines() -> Vec<(&'static str, Shape)> {
    let polygon = |points: &[[f32; 2]]| Shape::polygon(&[points], FillRule::NonZero).unwrap();
    let svg = |data: &str| {
        let path = penumbral::Path::from_svg(data).unwrap();
        Shape::path(&path, FillRule::EvenOdd).unwrap()
    };
    vec![
        ("card", card().0),
        (
            "small corners",
            Shape::rounded_rect(16.0, 122.0, 186.0, 90.0, 12.0).unwrap(),
        ),
        (
            "other corners",
            Shape::rounded_rect(218.0, 122.0, 186.0, 90.0, 12.0).unwrap(),
        ),
        (
            "tight corners",
            Shape::rounded_rect(3.3, 1.7, 120.0, 80.0, 2.0).unwrap(),
        ),
        (
            "pill",
            Shape::rounded_rect(0.0, 0.0, 120.0, 24.0, 12.0).unwrap(),
        ),
        ("circle", Shape::circle([50.0, 50.0], 30.0).unwrap()),
        (
            "ellipse",
            Shape::ellipse([50.0, 50.0], [40.0, 11.0]).unwrap(),
        ),
        ("sliver", Shape::rect(0.0, 0.0, 200.0, 3.0).unwrap()),
        (
            "star",
            polygon(&[
                [50.0, 0.0],
                [62.0, 38.0],
                [100.0, 38.0],
                [69.0, 60.0],
                [81.0, 98.0],
                [50.0, 75.0],
                [19.0, 98.0],
                [31.0, 60.0],
                [0.0, 38.0],
                [38.0, 38.0],
            ]),
        ),
        (
            "two rooms",
            polygon(&[
                [0.0, 0.0],
                [40.0, 0.0],
                [40.0, 16.0],
                [60.0, 16.0],
                [60.0, 0.0],
                [100.0, 0.0],
                [100.0, 40.0],
                [60.0, 40.0],
                [60.0, 24.0],
                [40.0, 24.0],
                [40.0, 40.0],
                [0.0, 40.0],
            ]),
        ),
        ("ring", svg("M0 0H100V80H0ZM30 30V50H70V30Z")),
        (
            "heart",
            svg("M10 24A18 18 0 0 1 64 18A18 18 0 0 1 118 24Q122 60 64 100Q6 60 10 24Z"),
        ),
    ]
}

/// Of a rim 8 units high: what the steps of curves make of it, and ridges that end between two rings.
const OFF_AT_VERTICES: f64 = 0.15;

/// Besides, chords of a bevel and a cosine: a quarter round is upright at the outline, and its first chord farther off.
const OFF_IN_FACES: f64 = 0.15;

/// Lines are no finer than a shape of that size needs.
#[test]
fn rims_next_to_nothing_wide_have_no_more_vertices() {
    let shape = Shape::ellipse([80.0, 60.0], [50.0, 30.0]).unwrap();
    let count = |width: f32| {
        let rim = Rim::new(width, width, RimProfile::Bevel).unwrap();
        RimMesh::new(&shape, &rim).map(|mesh| mesh.vertices().len())
    };
    assert_eq!(count(1e-20), count(1e-12));
}

#[test]
fn meshes_are_the_surface_on_any_outline() {
    for (name, shape) in outlines() {
        for profile in [
            RimProfile::Bevel,
            RimProfile::QuarterRound,
            RimProfile::Cosine,
        ] {
            let rim = Rim::new(10.0, 8.0, profile).unwrap();
            let mesh = RimMesh::new(&shape, &rim).unwrap();
            let surface = RimSurface::new(&shape, &rim);
            let miss = |[x, y, z]: [f64; 3]| (z - surface.rise_at([x, y])).abs();
            for vertex in mesh.vertices() {
                let off = miss(vertex.position);
                assert!(off < OFF_AT_VERTICES, "{name}, {profile:?}: {off}");
                assert!((0.0..=1.0).contains(&vertex.curvature));
            }
            for face in mesh.faces() {
                assert!(face.normal[2] > 0.0);
                let corners = face.vertices.map(|index| mesh.vertices()[index].position);
                let middle = [0, 1, 2].map(|i| corners.iter().map(|at| at[i]).sum::<f64>() / 3.0);
                let off = miss(middle);
                assert!(
                    profile == RimProfile::QuarterRound || off < OFF_IN_FACES,
                    "{name}, {profile:?}: {off}"
                );
            }
        }
    }
}

/// A lamp to the left above, a directional one, and a disc whose highlight is smaller than it.
fn lights() -> [Light; 3] {
    [
        Light::new([-40.0, -200.0, 300.0], 20.0).unwrap(),
        Light::directional([0.6, 0.9], 0.05).unwrap(),
        Light::new([60.0, -100.0, 300.0], 260.0).unwrap(),
    ]
}

fn shaded(model: ShadingModel, light: Light, steps: u32) -> Vec<Option<Intensity>> {
    let (card, rim) = card();
    let mesh = RimMesh::new(&card, &rim.with_steps(steps).unwrap()).unwrap();
    let material = Material::default()
        .with_strengths(0.3, 0.6, 0.8)
        .and_then(|material| material.with_shininess(60.0))
        .and_then(|material| material.with_attenuation([0.5, 1e-3, 1e-6]))
        .unwrap();
    let lighting = Lighting::new([(light, 1.0)], 8.0, &material).unwrap();
    let mut canvas = Canvas::new(&Grid::new([0.0, 0.0], [480, 360], 2.0).unwrap());
    canvas.draw(&mesh, &lighting, model);
    canvas.pixels().to_vec()
}

/// The largest and the root mean square difference of two pictures, in levels of white, and the brightest gloss of each.
fn compare(a: &[Option<Intensity>], b: &[Option<Intensity>]) -> ([f64; 2], [f32; 2]) {
    let (mut most, mut squares, mut count, mut gloss) = (0.0_f64, 0.0, 0.0, [0.0_f32; 2]);
    for (a, b) in a.iter().zip(b) {
        assert_eq!(a.is_some(), b.is_some());
        let (Some(a), Some(b)) = (a, b) else { continue };
        let level = |of: &Intensity| 255.0 * f64::from(of.body + of.gloss);
        let miss = (level(a) - level(b)).abs();
        most = most.max(miss);
        squares += miss * miss;
        count += 1.0;
        gloss = [gloss[0].max(a.gloss), gloss[1].max(b.gloss)];
    }
    ([most, (squares / count).sqrt()], gloss)
}

#[test]
fn fast_phong_is_within_two_levels_of_phong() {
    for light in lights() {
        for steps in [4, 8, 24] {
            let [fast, phong] = [ShadingModel::FastPhong, ShadingModel::Phong]
                .map(|model| shaded(model, light, steps));
            let ([most, rms], _) = compare(&fast, &phong);
            println!("{light:?}, {steps} steps: {most:.3} levels at most, {rms:.3} rms");
            assert!(most > 0.0 && most <= 2.0);
        }
    }
}

#[test]
fn gouraud_loses_highlights_that_phong_finds() {
    let [lamp, ..] = lights();
    for steps in [4, 24] {
        let [gouraud, phong] =
            [ShadingModel::Gouraud, ShadingModel::Phong].map(|model| shaded(model, lamp, steps));
        let ([most, rms], gloss) = compare(&gouraud, &phong);
        println!(
            "{steps} steps: {most:.1} levels at most, {rms:.2} rms; gloss {gloss:.2?} at most; \
             bends from pixel to pixel {:.1} and {:.1} levels",
            sharpest_bend(&gouraud),
            sharpest_bend(&phong)
        );
        if steps == 4 {
            // The highlight lies between its vertices; where intensities bend there are bands.
            assert!(gloss[0] < 0.9 * gloss[1] && most > 10.0);
            assert!(sharpest_bend(&gouraud) > sharpest_bend(&phong));
        }
    }
}

/// The sharpest change of slope down the middle column's upper rim, in levels a pixel: what the eye sees as a Mach band.
fn sharpest_bend(pixels: &[Option<Intensity>]) -> f64 {
    let column: Vec<f64> = (8..48)
        .filter_map(|row| pixels[row * 480 + 240])
        .map(|of| 255.0 * f64::from(of.body + of.gloss))
        .collect();
    let bends = column
        .windows(3)
        .map(|of| (of[0] - 2.0 * of[1] + of[2]).abs());
    bends.fold(0.0, f64::max)
}

/// A fine pattern that has moire wherever it is sampled by points.
fn pattern() -> Image {
    let pixels = (0..256 * 256).flat_map(|index| {
        let (x, y) = (index % 256, index / 256);
        let bit = if (x * x / 97 + y * y / 61 + x / 3) % 2 == 0 {
            255
        } else {
            0
        };
        [bit, 255 - bit, (x * 7 % 256) as u8, 255]
    });
    Image::from_rgba8([256, 256], pixels.collect()).unwrap()
}

fn picture(scene: &Scene) -> Pixmap {
    let grid = scene.grid().unwrap();
    let mut pixmap = Pixmap::new(grid.width(), grid.height()).unwrap();
    Renderer::new().render(scene, &mut pixmap).unwrap();
    pixmap
}

/// A card of 40 x 40 units with nothing to see but its texture, of copies of a size in units.
fn textured(image: &Image, size: [f32; 2]) -> Pixmap {
    let tile = Tile::new(Arc::new(image.clone()), size).unwrap();
    let plain = Material::default().with_strengths(1.0, 0.0, 0.0).unwrap();
    let finish = Finish::new().with_texture(tile).with_material(plain);
    let mut scene = Scene::new([40.0, 40.0], Light::android(40.0).unwrap()).unwrap();
    let card = Surface::new(Shape::rect(0.0, 0.0, 40.0, 40.0).unwrap(), 1.0);
    scene.push(card.with_finish(finish)).unwrap();
    picture(&scene)
}

/// The part of a pixel that is of each texel along one side.
fn texels(pixel: usize, size: f32) -> Vec<(usize, f64)> {
    let per_pixel = 256.0 / f64::from(size);
    let [start, end] = [pixel, pixel + 1].map(|edge| edge as f64 * per_pixel);
    (start as usize..end.ceil() as usize)
        .map(|texel| {
            let part = end.min(texel as f64 + 1.0) - start.max(texel as f64);
            (texel % 256, part / per_pixel)
        })
        .collect()
}

/// The texels that 64 samples along one side meet.
fn samples(pixel: usize, size: f32) -> Vec<(usize, f64)> {
    let meet = |sample: usize| {
        let at = pixel as f64 + (sample as f64 + 0.5) / 64.0;
        ((at / f64::from(size) * 256.0) as usize % 256, 1.0 / 64.0)
    };
    (0..64).map(meet).collect()
}

/// The largest difference, levels, between a texture drawn and averages of its texels by weights along either side.
fn texture_miss(size: [f32; 2], weights: fn(usize, f32) -> Vec<(usize, f64)>) -> f64 {
    let image = pattern();
    let drawn = textured(&image, size);
    let mut most = 0.0_f64;
    for row in 0..40 {
        for column in 0..40 {
            let (across, down) = (weights(column, size[0]), weights(row, size[1]));
            let mut sums = [0.0; 3];
            for (x, of_x) in &across {
                for (y, of_y) in &down {
                    for (channel, sum) in sums.iter_mut().enumerate() {
                        let texel = image.pixels()[4 * (y * 256 + x) + channel];
                        *sum += of_x * of_y * f64::from(texel);
                    }
                }
            }
            let pixel = drawn.pixel(column as u32, row as u32).unwrap();
            for (sum, found) in sums.iter().zip([pixel.red(), pixel.green(), pixel.blue()]) {
                most = most.max((sum - f64::from(found)).abs());
            }
        }
    }
    most
}

#[test]
fn a_texture_shrunk_sixteen_times_has_no_moire() {
    // 64 samples along a pixel have four in each of 16 texels, and none on an edge.
    let sampled = texture_miss([16.0, 16.0], samples);
    // Where edges of pixels cut texels that many samples are 4.4 levels off themselves, so the areas are the truth.
    let cut = texture_miss([15.7, 16.1], texels);
    println!("{sampled:.2} levels from 64 x 64 samples, {cut:.2} from the areas of cut texels");
    // Half a level is rounding's; a hundredth is that of sums.
    assert!(sampled <= 2.0 && cut <= 0.51);
}

fn scene(finish: Option<Finish>, fill: Color) -> Scene {
    let mut scene = Scene::new([120.0, 90.0], lights()[0]).unwrap();
    let card = Shape::rounded_rect(10.0, 10.0, 90.0, 60.0, 14.0).unwrap();
    let mut card = Surface::new(card, 4.0).with_fill(fill);
    if let Some(finish) = finish {
        card = card.with_finish(finish);
    }
    scene.push(card).unwrap();
    let knob = Shape::circle([84.0, 60.0], 12.0).unwrap();
    scene.push(Surface::new(knob, 12.0)).unwrap();
    scene
}

fn rimmed() -> Finish {
    Finish::new().with_rim(Rim::new(9.0, 9.0, RimProfile::QuarterRound).unwrap())
}

#[test]
fn what_is_drawn_again_is_the_same_bits() {
    let red = Color::rgb(200, 60, 50);
    let before = scene(Some(rimmed()), red);
    for &shading in ShadingModel::ALL {
        let after = scene(Some(rimmed().with_shading(shading)), red);
        let mut pixmap = picture(&before);
        let boxes = after.damage_since(&before).unwrap();
        Renderer::new()
            .render_within(&after, &boxes, &mut pixmap)
            .unwrap();
        assert!(pixmap == picture(&after), "{shading:?}");
        // Any part of it.
        let part = penumbral::Bounds {
            min: [13.0, 11.0],
            max: [40.0, 30.0],
        };
        Renderer::new()
            .render_within(&after, &[part], &mut pixmap)
            .unwrap();
        assert!(pixmap == picture(&after), "{shading:?}");
    }
}

#[test]
fn shadows_fall_on_rims_and_opacity_holds() {
    let red = Color::rgb(200, 60, 50);
    let [with, without] = [Some(rimmed()), None].map(|finish| picture(&scene(finish, red)));
    // The ground is as it was, and the rim away from the light is dark.
    assert_eq!(with.pixel(3, 80), without.pixel(3, 80));
    assert!(with.pixel(50, 68).unwrap().red() + 60 < without.pixel(50, 68).unwrap().red());
    // Half of the card's colour over the ground is half way between.
    let translucent = picture(&scene(Some(rimmed()), Color { a: 128, ..red }));
    let (a, b) = (
        with.pixel(30, 12).unwrap().red(),
        translucent.pixel(30, 12).unwrap().red(),
    );
    assert!(a != b);
    // The knob's shadow darkens the finished card.
    let lit = with.pixel(40, 50).unwrap().red();
    assert!(with.pixel(92, 66).unwrap().red() < lit || with.pixel(70, 66).unwrap().red() < lit);
}

#[test]
fn a_clip_makes_no_rim() {
    let red = Color::rgb(200, 60, 50);
    let mut clipped = Scene::new([120.0, 90.0], lights()[0]).unwrap();
    let mut group = Group::new(0.0)
        .unwrap()
        .with_clip(Shape::rect(0.0, 0.0, 50.0, 90.0).unwrap());
    let card = Shape::rounded_rect(10.0, 10.0, 90.0, 60.0, 14.0).unwrap();
    let card = Surface::new(card, 4.0).with_fill(red).with_finish(rimmed());
    group.push(card.clone());
    clipped.push_group(&group).unwrap();
    let mut whole = Scene::new([120.0, 90.0], lights()[0]).unwrap();
    whole.push(card).unwrap();
    let [clipped, whole] = [clipped, whole].map(|scene| picture(&scene));
    for (x, y) in [(49, 40), (49, 13), (30, 66), (12, 40)] {
        assert_eq!(clipped.pixel(x, y), whole.pixel(x, y), "{x}, {y}");
    }
}

#[test]
fn scenes_name_what_is_wrong_with_a_finish() {
    let dot = || Image::from_rgba8([1, 1], vec![255; 4]).unwrap();
    let read = |finish: &str| {
        let text = format!(
            "{{\"canvas\":[9,9],\"light\":{{\"x\":5,\"y\":0,\"z\":60,\"radius\":8}},\"surfaces\":[\n\
             {{\"shape\":\"circle\",\"cx\":1,\"cy\":2,\"r\":3,\"elevation\":5,\"finish\":{finish}}}]}}"
        );
        match finish.contains("dot.png") {
            true => Scene::from_json_with_images(&text, &mut |_| Ok(dot())),
            false => Scene::from_json(&text),
        }
    };
    assert!(read(r#"{"rim":{"width":1,"height":1}}"#).is_ok());
    for (finish, message) in [
        (
            r#"{"rim":{"width":0,"height":1}}"#,
            "surfaces[0]: finish.rim.width is 0: give a number above 0",
        ),
        (
            r#"{"rim":{"width":1,"height":1,"profile":"cove"}}"#,
            "finish.rim.profile \"cove\" is unknown: give bevel, quarter-round or cosine",
        ),
        (
            r#"{"rim":{"width":1,"height":1,"steps":99}}"#,
            "surfaces[0]: finish.rim.steps is 99: give a number from 1 to 64",
        ),
        (
            r#"{"material":{"ambient":0,"diffuse":5,"specular":0,"shininess":1}}"#,
            "surfaces[0]: finish.material.diffuse is 5: give a number from 0 to 4",
        ),
        (
            r#"{"bump":{"image":"dot.png","tile":[1,1],"depth":1e9}}"#,
            "surfaces[0]: finish.bump.depth is 1e9: give a number from",
        ),
        (
            r#"{"frame":{"image":"dot.png","tile":[1,0],"depth":0,"degrees":0,"twist":0}}"#,
            "surfaces[0]: finish.frame.tile[1] is 0: give a number above 0",
        ),
        (
            r#"{"frame":{"image":"dot.png","tile":[1,1],"depth":0,"degrees":1e9,"twist":0}}"#,
            "surfaces[0]: finish.frame.degrees is 1e9: give a number from",
        ),
        (
            r#"{"environment":{"image":"dot.png","tile":[1,1],"height":1,"strength":2}}"#,
            "surfaces[0]: finish.environment.strength is 2: give a number from 0 to 1",
        ),
        (
            r#"{"rim":{"width":1,"height":1},"shading":"toon"}"#,
            "finish.shading \"toon\" is unknown: give flat, gouraud, phong, fast-phong, curvature",
        ),
        (
            r#"{"shading":"phong"}"#,
            "finish.shading is of a rim: give `rim` or leave it out",
        ),
        (
            r#"{"rim":{"width":1}}"#,
            "surfaces[0].finish.rim: missing field `height`",
        ),
        (
            r#"{"gloss":1}"#,
            "surfaces[0].finish.gloss: unknown field `gloss`",
        ),
        (
            r#"{"texture":{"image":"wood.png","tile":[1,1]}}"#,
            "the image \"wood.png\" is not read here",
        ),
        (r#"null"#, "surfaces[0].finish: invalid type: null"),
    ] {
        let text = read(finish).unwrap_err().to_string();
        assert!(text.contains(message), "{text}");
    }
    let posed = penumbral::Pose::turned(5.0, [0.0, 0.0], [1.0, 0.0], 0.2).unwrap();
    let card = Surface::posed(Shape::rect(0.0, 0.0, 9.0, 9.0).unwrap(), &posed);
    let mut scene = Scene::new([20.0, 20.0], lights()[0]).unwrap();
    assert_eq!(
        scene.push(card.with_finish(rimmed())),
        Err(Error::NotFinished)
    );
    let flat = Surface::new(Shape::rect(0.0, 0.0, 9.0, 9.0).unwrap(), 1.0);
    scene.push(flat.with_finish(rimmed())).unwrap();
    assert_eq!(
        scene.to_svg(Tolerance::ONE_LEVEL),
        Err(Error::NotInSvg { what: "a finish" })
    );
}
