//! What casters of several elevations hide together, against rays to the light's disc.

#![expect(clippy::unwrap_used, reason = "a scene that is refused fails the test")]

#[expect(dead_code, reason = "other tests take more of it")]
mod common;

use common::{Random, setting, worst_of};
use penumbral::plan::Method;
use penumbral::{
    Color, DensityMap, FillRule, Light, PixelOptions, Pose, Scene, Scratch, Shape, Surface, Tone,
};

/// A rounded rectangle over the ground.
struct Card {
    corner: [f32; 2],
    size: [f32; 2],
    radius: f32,
    elevation: f32,
    opacity: f32,
}

impl Card {
    fn surface(&self) -> Surface {
        let ([x, y], [w, h]) = (self.corner, self.size);
        let shape = Shape::rounded_rect(x, y, w, h, self.radius).unwrap();
        Surface::new(shape, self.elevation).with_opacity(self.opacity)
    }

    /// The side of the square over which a pixel averages its shadow, for a light of that radius.
    fn averaged_side(&self, light_radius: f64) -> f64 {
        let elevation = f64::from(self.elevation);
        let radius = light_radius * elevation / (CENTER[2] - elevation);
        ((3.0 - radius) / 2.0).clamp(0.0, 1.0)
    }

    fn covers(&self, point: [f64; 2]) -> bool {
        let outside = [0, 1].map(|axis| {
            let half = f64::from(self.size[axis]) / 2.0;
            let middle = f64::from(self.corner[axis]) + half;
            (point[axis] - middle).abs() - half + f64::from(self.radius)
        });
        let [x, y] = outside.map(|v| v.max(0.0));
        x.max(y) == 0.0 || x.hypot(y) <= f64::from(self.radius)
    }
}

const CANVAS: f32 = 160.0;
const CENTER: [f64; 3] = [80.0, 40.0, 300.0];

/// What rays from a pixel of the ground to 256 x 256 strata of the disc find held back. Each begins at another point of the square
/// that the pixel averages over.
fn by_rays(cards: &[Card], point: [f64; 2], radius: f64, random: &mut Random) -> f64 {
    const SIDE: u32 = 256;
    let sides: Vec<f64> = cards
        .iter()
        .map(|card| card.averaged_side(radius))
        .collect();
    let mut held = 0.0;
    for stratum in 0..SIDE * SIDE {
        let part = |index: u32, random: &mut Random| {
            (f64::from(index) + f64::from(random.between(0.0, 1.0))) / f64::from(SIDE)
        };
        let distance = radius * part(stratum / SIDE, random).sqrt();
        let angle = core::f64::consts::TAU * part(stratum % SIDE, random);
        let light = [
            CENTER[0] + distance * angle.cos(),
            CENTER[1] + distance * angle.sin(),
        ];
        // Points that fill the square evenly from whichever ray on (Roberts 2018).
        let offset =
            [0.754_877_666, 0.569_840_291].map(|step| f64::from(stratum) * step % 1.0 - 0.5);
        let mut passed = 1.0;
        for (card, side) in cards.iter().zip(&sides) {
            let share = f64::from(card.elevation) / CENTER[2];
            let met = [0, 1].map(|axis| {
                let from = point[axis] + offset[axis] * side;
                from + (light[axis] - from) * share
            });
            if card.covers(met) {
                passed *= 1.0 - f64::from(card.opacity);
            }
        }
        held += 1.0 - passed;
    }
    held / f64::from(SIDE * SIDE)
}

/// Over 60 stacks, or as many as `PENUMBRAL_CASES` says from seed `PENUMBRAL_SEED` on.
#[test]
fn stacks_hide_the_union_of_what_each_hides() {
    let mut random = Random::new(setting("PENUMBRAL_SEED", 7) as u64);
    let (mut map, mut scratch) = (DensityMap::default(), Scratch::new());
    let (mut worst, mut partial) = ([0.0_f64; 7], 0);
    let stacks = setting("PENUMBRAL_CASES", 60);
    for index in 0..stacks {
        let count = 2 + index % 5;
        let translucent = index % 3 == 2;
        let light_radius = random.between(60.0, 300.0);
        let cards: Vec<Card> = (0..count)
            .map(|_| {
                let size = [random.between(20.0, 80.0), random.between(12.0, 80.0)];
                Card {
                    corner: [random.between(20.0, 80.0), random.between(20.0, 80.0)],
                    size,
                    radius: random.between(0.0, size[0].min(size[1]) / 2.0),
                    elevation: random.between(4.0, 40.0),
                    opacity: if translucent {
                        random.between(0.2, 1.0)
                    } else {
                        1.0
                    },
                }
            })
            .collect();
        let light = Light::new(CENTER.map(|v| v as f32), light_radius).unwrap();
        let mut scene = Scene::new([CANVAS; 2], light).unwrap();
        for card in &cards {
            scene.push(card.surface()).unwrap();
        }
        let shadows = scene.ground_shadows().unwrap();
        shadows
            .draw(&mut map, &PixelOptions::default(), &mut scratch)
            .unwrap();
        for _ in 0..12 {
            let at = [0; 2].map(|_| random.below(CANVAS as usize));
            let got = f64::from(map.densities()[at[1] * CANVAS as usize + at[0]]);
            let point = at.map(|v| v as f64 + 0.5);
            let expected = by_rays(&cards, point, f64::from(light_radius), &mut random);
            partial += usize::from(expected > 0.02 && expected < 0.98);
            let error = (got - expected).abs() * 255.0;
            worst[count] = worst[count].max(error);
            // The rays' own noise is below a quarter of a level.
            assert!(
                error < 1.25,
                "stack {index} of {count}, pixel {at:?}: {error} levels"
            );
        }
    }
    println!(
        "2 to 6 casters: worst {:?} levels, {partial} points partial",
        &worst[2..]
    );
    assert!(partial > 4 * stacks, "{partial}");
}

/// What chords cut off of many arcs in one disc adds up: dots under a card are as dark as polygons of many sides and the same area.
#[test]
fn crowds_of_dots_under_a_card_are_as_dark_as_polygons() {
    const SIDES: u16 = 64;
    let (mut map, mut scratch) = (DensityMap::default(), Scratch::new());
    let mut drawn = |dot: &dyn Fn([f32; 2]) -> Shape| {
        let light = Light::new([80.0, 40.0, 300.0], 1200.0).unwrap();
        let mut scene = Scene::new([CANVAS; 2], light).unwrap();
        for i in 0..400_u16 {
            let center = [
                50.0 + 3.0 * f32::from(i % 20),
                50.0 + 3.0 * f32::from(i / 20),
            ];
            scene.push(Surface::new(dot(center), 10.0)).unwrap();
        }
        let card = Shape::rect(60.0, 50.0, 70.0, 60.0).unwrap();
        scene.push(Surface::new(card, 12.0)).unwrap();
        let shadows = scene.ground_shadows().unwrap();
        shadows
            .draw(&mut map, &PixelOptions::default(), &mut scratch)
            .unwrap();
        map.densities().to_vec()
    };
    let dots = drawn(&|center| Shape::circle(center, 1.0).unwrap());
    let turn = core::f32::consts::TAU / f32::from(SIDES);
    let radius = (turn / turn.sin()).sqrt();
    let polygons = drawn(&|center| {
        let corner = |i: u16| {
            let (sin, cos) = (f32::from(i) * turn).sin_cos();
            [center[0] + radius * cos, center[1] + radius * sin]
        };
        Shape::polygon(
            &[(0..SIDES).map(corner).collect::<Vec<_>>()],
            FillRule::NonZero,
        )
        .unwrap()
    });
    let worst = worst_of(&dots, &polygons);
    println!("400 dots under a card: worst {worst:.3} levels");
    assert!(worst < 1.0, "{worst} levels");
}

#[test]
fn stacked_umbrae_are_as_dark_as_one() {
    let scene = |elevations: &[f32]| {
        let light = Light::new([100.0, 100.0, 600.0], 300.0).unwrap();
        let mut scene = Scene::new([200.0, 200.0], light)
            .unwrap()
            .with_background(Color::WHITE)
            .unwrap()
            .with_tone(Tone::new(0.19, 0.0).unwrap());
        for &elevation in elevations {
            let card = Shape::rect(40.0, 40.0, 120.0, 120.0).unwrap();
            scene.push(Surface::new(card, elevation)).unwrap();
        }
        scene
    };
    let shade = |elevations: &[f32]| {
        let scene = scene(elevations);
        let mut pixels = vec![255; 4 * 200 * 200];
        let shadows = scene.ground_shadows().unwrap();
        shadows
            .blend_rgba8(&mut pixels, &PixelOptions::default(), &mut Scratch::new())
            .unwrap();
        pixels[4 * (100 * 200 + 100)]
    };
    // 255 (1 - 0.19), not 255 (1 - 0.19)² = 167.
    assert_eq!(shade(&[8.0]), 207);
    assert_eq!(shade(&[8.0, 16.0]), 207);
    assert_eq!(shade(&[2.0, 8.0, 16.0]), 207);
}

#[test]
fn a_scene_moved_by_whole_pixels_has_the_same_bits() {
    let draw = |shift: f32| {
        // All of this is exact in f32.
        let light = Light::directional([0.25, 0.75], 1.125).unwrap();
        let mut scene = Scene::new([240.0, 160.0], light).unwrap();
        for (x, elevation) in [(40.25, 5.0), (60.5, 9.0), (75.75, 14.0)] {
            let card = Shape::rounded_rect(x + shift, 40.25, 60.0, 50.0, 7.0).unwrap();
            scene.push(Surface::new(card, elevation)).unwrap();
        }
        let mut map = DensityMap::default();
        let shadows = scene.ground_shadows().unwrap();
        shadows
            .draw(&mut map, &PixelOptions::default(), &mut Scratch::new())
            .unwrap();
        map
    };
    let (here, there) = (draw(0.0), draw(37.0));
    for row in 0..160 {
        let part =
            |map: &DensityMap, first: usize| map.densities()[row * 240 + first..][..200].to_vec();
        assert_eq!(part(&here, 0), part(&there, 37), "row {row}");
    }
}

#[test]
fn a_tilted_card_and_a_level_one_hide_their_union() {
    // The tilted card lies level: each pixel is what two level cards make it, by another way.
    let scene = |is_posed: bool| {
        let light = Light::new([80.0, 40.0, 300.0], 150.0).unwrap();
        let mut scene = Scene::new([160.0, 160.0], light).unwrap();
        let high = Shape::rect(50.0, 60.0, 50.0, 40.0).unwrap();
        let low = Shape::rounded_rect(30.0, 40.0, 60.0, 50.0, 9.0).unwrap();
        let pose = Pose::turned(30.0, [0.0, 0.0], [1.0, 0.0], 0.0).unwrap();
        scene.push(Surface::new(low, 12.0)).unwrap();
        scene
            .push(if is_posed {
                Surface::posed(high, &pose)
            } else {
                Surface::new(high, 30.0)
            })
            .unwrap();
        let mut map = DensityMap::default();
        let shadows = scene.ground_shadows().unwrap();
        shadows
            .draw(&mut map, &PixelOptions::default(), &mut Scratch::new())
            .unwrap();
        map
    };
    let (posed, level) = (scene(true), scene(false));
    let worst = worst_of(posed.densities(), level.densities());
    println!("{worst} levels");
    assert!(worst < 1.2, "{worst} levels");
}

/// Shapes at next to one elevation hide what they would as one, however narrow the penumbra.
#[test]
fn hard_shadows_hide_together_what_their_union_does() {
    let mut scratch = Scratch::new();
    let exact = PixelOptions::default().with_method(Method::Exact);
    for radius in [0.0_f32, 0.01, 0.05, 0.1, 0.2, 0.29, 0.35, 0.6, 0.9] {
        let light = Light::directional([0.0, 0.0], radius).unwrap();
        let (mut random, mut worst) = (Random::new(17), (0.0, String::new()));
        for case in 0..60 {
            let mut place = || [random.between(8.0, 14.0), random.between(8.0, 14.0)];
            let [[x, y], [u, v], corner] = [place(), place(), place()];
            let first = Shape::rect(x, y, 12.0, 12.0).unwrap();
            let second = match case % 3 {
                0 => first.clone(),
                1 => Shape::rect(u, y, 12.0, 8.0).unwrap(),
                _ => {
                    let points = [[u, v], [u + 13.0, v + 3.0], [u + 4.0, v + 14.0]];
                    Shape::polygon(&[points], FillRule::NonZero).unwrap()
                }
            };
            let mut shapes = vec![first, second];
            if case % 2 == 0 {
                let [x, y] = corner;
                shapes.push(Shape::circle([x + 6.0, y + 6.0], 7.0).unwrap());
            }
            let mut scene = Scene::new([40.0, 40.0], light).unwrap();
            for (shape, elevation) in shapes.iter().zip([1.0, 1.000_001, 1.000_002]) {
                scene.push(Surface::new(shape.clone(), elevation)).unwrap();
            }
            let shadows = scene.ground_shadows().unwrap();
            let mut map = DensityMap::default();
            // What each hides alone is exact, too.
            shadows.draw(&mut map, &exact, &mut scratch).unwrap();
            let mut union = vec![0.0; 1600];
            let one = light.cast_all(&shapes, 1.0, 0.0).unwrap();
            one.fill_f32(shadows.grid(), &mut union, &exact, &mut scratch)
                .unwrap();
            for (pixel, (found, union)) in map.densities().iter().zip(&union).enumerate() {
                let error = (found - union).abs() * 255.0;
                if error > worst.0 {
                    let at = [pixel % 40, pixel / 40];
                    worst = (error, format!("case {case} at {at:?}: {found}, {union}"));
                }
            }
        }
        println!("radius {radius}: {worst:?}");
        assert!(worst.0 <= 0.8, "radius {radius}: {worst:?}");
    }
}
