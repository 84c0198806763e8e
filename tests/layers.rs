//! Scenes as users see them: receivers, groups and clips, lights, images, and pictures drawn again in part.

#![expect(clippy::unwrap_used, reason = "a scene that is refused fails the test")]

#[expect(dead_code, reason = "other tests take more of it")]
mod common;

use std::collections::BTreeSet;
use std::env;
use std::sync::Arc;

use common::Random;
use penumbral::{
    Blending, Bounds, Color, Error, FillRule, Group, Image, Light, Overlap, Path, Pose, Renderer,
    Scene, Shape, Surface, Tolerance, Tone,
};
use tiny_skia::Pixmap;

const CANVAS: [f32; 2] = [200.0, 150.0];

fn empty() -> Scene {
    let light = Light::new([100.0, -20.0, 300.0], 150.0).unwrap();
    Scene::new(CANVAS, light)
        .unwrap()
        .with_background(Color::WHITE)
        .unwrap()
        .with_tone(Tone::new(0.3, 0.05).unwrap())
}

fn pixmap(scene: &Scene) -> Pixmap {
    let grid = scene.grid().unwrap();
    Pixmap::new(grid.width(), grid.height()).unwrap()
}

fn drawn(scene: &Scene) -> Pixmap {
    let mut pixmap = pixmap(scene);
    Renderer::new().render(scene, &mut pixmap).unwrap();
    pixmap
}

fn red(pixmap: &Pixmap, x: u32, y: u32) -> u8 {
    pixmap.pixel(x, y).unwrap().red()
}

fn rect(x: f32, y: f32, w: f32, h: f32) -> Shape {
    Shape::rect(x, y, w, h).unwrap()
}

#[test]
fn a_scrim_without_shadow_darkens_evenly() {
    let [width, height] = CANVAS;
    let scrim = Surface::new(rect(0.0, 0.0, width, height), 8.0)
        .with_fill(Color::BLACK)
        .with_opacity(0.32);
    let reds = |scrim: &Surface| {
        let mut scene = empty();
        scene.push(scrim.clone()).unwrap();
        let picture = drawn(&scene);
        let reds = picture.pixels().iter().map(|pixel| pixel.red());
        reds.collect::<BTreeSet<u8>>()
    };
    // 255 (1 - 0.32), and a shadow besides.
    assert_eq!(reds(&scrim.clone().without_shadow()), [173].into());
    assert!(reds(&scrim).len() > 3 && !scrim.clone().without_shadow().casts());
    // What is transparent casts none either.
    assert!(scrim.casts() && !scrim.with_opacity(0.0).casts());
}

#[test]
fn abutting_cards_are_one_card_bit_for_bit() {
    let mut split = empty();
    split
        .push(Surface::new(rect(40.0, 40.0, 50.0, 60.0), 12.0))
        .unwrap();
    split
        .push(Surface::new(rect(90.0, 40.0, 70.0, 60.0), 12.0))
        .unwrap();
    let mut joined = empty();
    joined
        .push(Surface::new(rect(40.0, 40.0, 120.0, 60.0), 12.0))
        .unwrap();
    assert_eq!(drawn(&split).data(), drawn(&joined).data());
}

#[test]
fn a_shadow_steps_at_the_receiving_card_and_equals_do_not_shade_each_other() {
    let mut scene = empty().with_tone(Tone::new(0.3, 0.0).unwrap());
    scene
        .push(Surface::new(rect(20.0, 60.0, 80.0, 80.0), 10.0))
        .unwrap();
    scene
        .push(Surface::new(rect(100.0, 60.0, 80.0, 80.0), 10.0))
        .unwrap();
    let calm = drawn(&scene);
    // Each card's face is as lit at the other's edge as anywhere.
    for x in 22..178 {
        assert_eq!(red(&calm, x, 100), 255, "column {x}");
    }
    scene
        .push(Surface::new(rect(60.0, 30.0, 80.0, 60.0), 24.0))
        .unwrap();
    let picture = drawn(&scene);
    // On the cards the bar's shadow is narrower and nearer than on the ground beside them.
    assert!(red(&picture, 100, 95) < 230);
    let (on_card, on_ground) = (red(&picture, 30, 75), red(&picture, 15, 75));
    assert!(on_card > on_ground, "{on_card} {on_ground}");
}

#[test]
fn a_clipped_group_neither_shows_nor_casts_what_is_outside() {
    let mut group = Group::new(4.0)
        .unwrap()
        .with_clip(rect(0.0, 60.0, 200.0, 90.0));
    group.push(Surface::new(rect(40.0, 10.0, 120.0, 80.0), 8.0).with_fill(Color::rgb(9, 9, 9)));
    let mut inner = Group::new(2.0).unwrap();
    inner.push(Surface::new(rect(50.0, 100.0, 30.0, 20.0), 1.0));
    inner.push(Surface::new(rect(50.0, 10.0, 30.0, 20.0), 1.0));
    group.push_group(inner);
    let mut scene = empty();
    scene.push_group(&group).unwrap();
    assert_eq!(scene.surfaces().len(), 2);
    assert_eq!(scene.surfaces()[1].elevation(), 7.0);
    let mut expected = empty();
    expected
        .push(Surface::new(rect(40.0, 60.0, 120.0, 30.0), 12.0).with_fill(Color::rgb(9, 9, 9)))
        .unwrap();
    expected
        .push(Surface::new(rect(50.0, 100.0, 30.0, 20.0), 7.0))
        .unwrap();
    assert_eq!(drawn(&scene).data(), drawn(&expected).data());

    // A member that is refused takes the group with it.
    let mut bad = Group::new(4.0).unwrap();
    bad.push(Surface::new(rect(0.0, 0.0, 10.0, 10.0), 1.0));
    bad.push(Surface::new(rect(0.0, 0.0, 10.0, 10.0), 400.0));
    assert!(scene.push_group(&bad).is_err());
    assert_eq!(scene.surfaces().len(), 2);
    let pose = Pose::turned(9.0, [5.0, 5.0], [1.0, 0.0], 0.3).unwrap();
    let mut tilted = Group::new(0.0).unwrap().with_clip(rect(0.0, 0.0, 9.0, 9.0));
    tilted.push(Surface::posed(rect(0.0, 0.0, 10.0, 10.0), &pose));
    assert_eq!(scene.push_group(&tilted), Err(Error::NotClipped));
}

#[test]
fn stacks_are_as_dark_as_one_unless_the_old_look_is_asked_for() {
    let scene = |overlap| {
        let mut scene = empty()
            .with_tone(Tone::new(0.19, 0.0).unwrap())
            .with_overlap(overlap);
        for elevation in [12.0, 24.0] {
            let stack = Surface::new(rect(50.0, 30.0, 100.0, 80.0), elevation).with_opacity(1.0);
            scene.push(stack).unwrap();
        }
        // Under both, a card that shows the shadows on it.
        scene
            .push(Surface::new(rect(40.0, 20.0, 120.0, 120.0), 6.0))
            .unwrap();
        scene
    };
    let darkest = |overlap| *drawn(&scene(overlap)).data().iter().min().unwrap();
    assert_eq!(darkest(Overlap::Union), 207);
    assert!(
        darkest(Overlap::SourceOver) < 195,
        "{}",
        darkest(Overlap::SourceOver)
    );
}

#[test]
fn each_light_casts_its_own_shadow_in_the_tones_colour() {
    let tone = Tone::new(0.5, 0.0)
        .unwrap()
        .with_color(Color::rgb(0, 0, 255));
    let scene = |lights: usize| {
        let light = Light::new([-100.0, 75.0, 100.0], 5.0).unwrap();
        let mut scene = empty().with_tone(tone);
        if lights == 2 {
            scene.push_light(light, 0.5).unwrap();
        }
        scene
            .push(Surface::new(rect(80.0, 55.0, 40.0, 40.0), 30.0))
            .unwrap();
        scene
    };
    let (one, two) = (drawn(&scene(1)), drawn(&scene(2)));
    // To the right of the card is the second light's umbra: half blue.
    let pixel = two.pixel(165, 75).unwrap();
    assert_eq!((pixel.red(), pixel.green(), pixel.blue()), (128, 128, 255));
    assert_eq!(red(&one, 165, 75), 255);
    let linear = scene(2).with_tone(tone.with_blending(Blending::Linear));
    assert_eq!(red(&drawn(&linear), 165, 75), 188);
    assert!(
        scene(1)
            .push_light(Light::new([0.0, 0.0, 20.0], 1.0).unwrap(), 0.2)
            .is_err()
    );
}

#[test]
fn svg_pictures_write_opacity_apart_from_colours() {
    let translucent = |a| Color {
        a,
        ..Color::rgb(9, 20, 30)
    };
    let tone = Tone::new(0.3, 0.0).unwrap().with_color(translucent(16));
    let mut scene = empty().with_tone(tone);
    scene
        .push(Surface::new(rect(40.0, 40.0, 50.0, 60.0), 6.0).with_fill(translucent(51)))
        .unwrap();
    let svg = scene.to_svg(Tolerance::ONE_LEVEL).unwrap();
    let colors: BTreeSet<&str> = svg
        .split('"')
        .filter(|text| text.starts_with('#') && text.parse::<Color>().is_ok())
        .collect();
    assert_eq!(colors, BTreeSet::from(["#09141e", "#ffffff"]));
    assert!(svg.contains("fill-opacity=\"0.2\""));
}

#[test]
fn an_image_is_drawn_and_casts_by_its_alpha() {
    // The left half is transparent.
    let pixels = [[0; 4], [200, 10, 10, 255]].concat();
    let image = Arc::new(Image::from_rgba8([2, 1], pixels).unwrap());
    let scene = |with_image: bool| {
        let mut scene = empty();
        if with_image {
            let image = Surface::image(Arc::clone(&image), [40.0, 40.0, 80.0, 40.0], 10.0).unwrap();
            scene.push(image).unwrap();
        }
        scene
    };
    let picture = drawn(&scene(true));
    let at = |x, y| picture.pixel(x, y).unwrap();
    assert_eq!((at(112, 60).red(), at(112, 60).green()), (200, 10));
    // Beside its opaque half the ground is shaded; left of its transparent half it is not.
    assert!(at(100, 84).red() < 240);
    assert_eq!(at(44, 60).red(), 255);
    assert!(Image::from_rgba8([2, 2], vec![0; 15]).is_err());
    assert!(Image::from_rgba8([0, 2], Vec::new()).is_err());
}

/// Texels are placed from where the picture begins, not from where what is drawn of it does.
#[test]
fn windows_of_an_image_show_the_same_bits() {
    let mut random = Random::new(12);
    let pixels = (0..64 * 48 * 4).map(|_| random.below(256) as u8).collect();
    let image = Arc::new(Image::from_rgba8([64, 48], pixels).unwrap());
    let mut scene = empty();
    let place = [20.3, 10.7, 121.4, 93.3];
    scene
        .push(Surface::image(image, place, 6.0).unwrap())
        .unwrap();
    let (fresh, mut renderer) = (drawn(&scene), Renderer::new());
    for _ in 0..60 {
        let [x, y] = CANVAS.map(|side| random.between(0.0, side - 2.0));
        let bounds = Bounds {
            min: [x, y],
            max: [
                random.between(x + 1.0, CANVAS[0]),
                random.between(y + 1.0, CANVAS[1]),
            ],
        };
        let mut again = fresh.clone();
        renderer
            .render_within(&scene, &[bounds], &mut again)
            .unwrap();
        assert!(fresh == again, "{bounds:?}");
    }
}

/// Mostly the same few elevations, as in an interface: those at one are united.
fn few_elevations(random: &mut Random) -> f32 {
    [0.0, 1.0, 2.5, 2.5, 6.0, random.between(0.5, 20.0)][random.below(6)]
}

fn any_surface(random: &mut Random, elevation: fn(&mut Random) -> f32) -> Surface {
    let canvas = CANVAS;
    let (x, y) = (
        random.between(-20.0, canvas[0]),
        random.between(-20.0, canvas[1]),
    );
    let (w, h) = (random.between(4.0, 60.0), random.between(4.0, 60.0));
    let elevation = elevation(random);
    let shape = match random.below(5) {
        0 => rect(x, y, w, h),
        1 => Shape::circle([x, y], w / 2.0).unwrap(),
        2 => Shape::polygon(
            &[[[x, y], [x + w, y + h / 3.0], [x + w / 4.0, y + h]]],
            FillRule::NonZero,
        )
        .unwrap(),
        3 => {
            let mut path = Path::new();
            path.move_to([x, y])
                .cubic_to([x + w, y - h], [x + w, y + h], [x, y + h]);
            path.quad_to([x - w / 3.0, y + h / 2.0], [x, y]);
            Shape::path(&path, FillRule::EvenOdd).unwrap()
        }
        _ => Shape::rounded_rect(x, y, w, h, w.min(h) / 3.0).unwrap(),
    };
    let color = Color::rgb(random.below(256) as u8, random.below(256) as u8, 80);
    if random.below(9) == 0 {
        let axis = [random.between(-1.0, 1.0), 1.0];
        let pose = Pose::turned(elevation + 8.0, [x, y], axis, random.between(0.0, 3.0)).unwrap();
        return Surface::posed(shape, &pose).with_fill(color);
    }
    if random.below(9) == 0 {
        let pixels = (0..5 * 4 * 4).map(|_| random.below(256) as u8).collect();
        let image = Arc::new(Image::from_rgba8([5, 4], pixels).unwrap());
        return Surface::image(image, [x, y, w, h], elevation).unwrap();
    }
    let opacity = if random.below(4) == 0 { 0.6 } else { 1.0 };
    Surface::new(shape, elevation)
        .with_fill(color)
        .with_opacity(opacity)
}

fn scene_of(surfaces: &[Surface]) -> Scene {
    let mut scene = empty();
    for surface in surfaces {
        scene.push(surface.clone()).unwrap();
    }
    scene
}

/// `PENUMBRAL_EDITS=1000 cargo test --release --all-features --test layers` makes a thousand.
#[test]
fn what_is_drawn_again_in_part_is_what_is_drawn_afresh() {
    let edits = env::var("PENUMBRAL_EDITS").map_or(25, |count| count.parse().unwrap());
    let share = drawn_again(edits, 12, few_elevations);
    assert!(share < 0.8, "{share}");
}

/// What a cast is among the many of its group changes with surfaces far away.
#[test]
fn many_elevations_are_drawn_again_as_they_are_drawn_afresh() {
    drawn_again(5, 40, |random| random.between(0.5, 20.0));
}

/// Edits a scene of so many surfaces at first, and compares what is drawn again with what is drawn afresh. The share of the canvas
/// that is drawn again each time.
fn drawn_again(edits: usize, count: usize, elevation: fn(&mut Random) -> f32) -> f32 {
    let mut random = Random::new(11);
    let any_surface = |random: &mut Random| any_surface(random, elevation);
    let mut surfaces: Vec<Surface> = (0..count).map(|_| any_surface(&mut random)).collect();
    let mut before = scene_of(&surfaces);
    let mut picture = drawn(&before);
    let (mut renderer, mut area) = (Renderer::new(), 0.0);
    for edit in 0..edits {
        match random.below(5) {
            0 => surfaces.insert(random.below(surfaces.len() + 1), any_surface(&mut random)),
            1 if surfaces.len() > 6 => {
                surfaces.remove(random.below(surfaces.len()));
            }
            _ => {
                let index = random.below(surfaces.len());
                surfaces[index] = any_surface(&mut random);
            }
        }
        let after = scene_of(&surfaces);
        let damage = after.damage_since(&before).unwrap();
        for bounds in &damage {
            area += (bounds.max[0] - bounds.min[0]) * (bounds.max[1] - bounds.min[1]);
        }
        renderer
            .render_within(&after, &damage, &mut picture)
            .unwrap();
        let fresh = drawn(&after);
        let differing = fresh
            .pixels()
            .iter()
            .zip(picture.pixels())
            .position(|(a, b)| a != b);
        assert_eq!(
            differing.map(|at| [at % 200, at / 200]),
            None,
            "edit {edit}"
        );
        before = after;
    }
    let share = area / edits as f32 / (CANVAS[0] * CANVAS[1]);
    println!(
        "{edits} edits, {:.0} % of the canvas drawn again each",
        100.0 * share
    );
    share
}

#[test]
fn the_background_of_an_svg_is_as_large_as_what_is_shown() {
    let light = Light::new([0.2, 0.0, 6.0], 1.0).unwrap();
    let scene = Scene::new([540.0 / 1024.0; 2], light).unwrap();
    let scene = scene.with_scale(1024.0).unwrap();
    let svg = scene.to_svg(Tolerance::ONE_LEVEL).unwrap();
    let side = svg.split("viewBox=\"0 0 ").nth(1).unwrap();
    let side = side.split(' ').next().unwrap();
    let whole = format!("<rect x=\"0\" y=\"0\" width=\"{side}\" height=\"{side}\"");
    assert!(svg.contains(&whole), "{svg}");
}
