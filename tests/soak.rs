//! Minutes of random animated scenes through one renderer and one scratch: no growth of memory, no drift from fresh ones.
//!
//!     PENUMBRAL_MINUTES=10 cargo test --release --all-features --test soak -- --ignored --nocapture

#![expect(clippy::unwrap_used, reason = "a case that is refused fails the test")]

#[expect(dead_code, reason = "other tests take more of it")]
mod common;

use std::collections::HashMap;
use std::fs;
use std::time::{Duration, Instant};

use common::{Random, bits, by, densities, setting, shapes};
use penumbral::{
    Color, Grid, Light, NinePatch, Renderer, Scene, Scratch, ShadowKey, Shape, Surface, Tolerance,
};
use tiny_skia::Pixmap;

const SIZE: u32 = 240;

/// A surface that wanders up, down and about.
struct Actor {
    shape: Shape,
    start: [f32; 2],
    speed: [f32; 2],
    elevation: f32,
    rise: f32,
    fill: Color,
    opacity: f32,
}

impl Actor {
    fn random(random: &mut Random) -> Vec<Self> {
        let (_, shapes, _) = shapes(random, 110.0);
        let start = [0; 2].map(|_| random.between(-20.0, 140.0));
        let speed = [0; 2].map(|_| random.between(-2.0, 2.0));
        let elevation = random.pick(&[0.0, 1.0, 2.0, 4.0, 8.0, 24.0]);
        let rise = random.pick(&[0.0, 0.1, 0.7]);
        let fill = Color::rgb(200, random.below(256) as u8, 90);
        let opacity = random.pick(&[1.0, 1.0, 1.0, 0.5]);
        let actor = |shape| Self {
            shape,
            start,
            speed,
            elevation,
            rise,
            fill,
            opacity,
        };
        shapes.into_iter().map(actor).collect()
    }

    fn at(&self, frame: usize) -> Surface {
        let time = frame as f32;
        let place = [0, 1].map(|axis| self.start[axis] + self.speed[axis] * time);
        let shape = self.shape.translated(place).unwrap();
        Surface::new(shape, self.elevation + self.rise * time)
            .with_fill(self.fill)
            .with_opacity(self.opacity)
    }
}

/// Pages that the process holds, where that can be told.
fn resident() -> u64 {
    let statm = fs::read_to_string("/proc/self/statm").unwrap_or_default();
    statm
        .split(' ')
        .nth(1)
        .and_then(|pages| pages.parse().ok())
        .unwrap_or(0)
}

fn draw(renderer: &mut Renderer, scene: &Scene) -> Pixmap {
    let mut pixmap = Pixmap::new(SIZE, SIZE).unwrap();
    renderer.render(scene, &mut pixmap).unwrap();
    pixmap
}

/// Draws scenes for so long, and twice as many as warm memory up after those at least.
fn soak(time: Duration, warm_up: usize, seed: u64) {
    let start = Instant::now();
    let mut random = Random::new(seed);
    let (mut renderer, mut scratch) = (Renderer::new(), Scratch::new());
    let mut patches: HashMap<ShadowKey, NinePatch> = HashMap::new();
    let grid = Grid::new([0.0, 0.0], [SIZE, SIZE], 1.0).unwrap();
    let (mut scenes, mut frames, mut worst, mut early) = (0, 0_usize, Duration::ZERO, None);
    while scenes < 3 * warm_up || start.elapsed() < time {
        let light = Light::new([120.0, random.between(-50.0, 200.0), 600.0], 800.0).unwrap();
        let actors: Vec<Actor> = (0..1 + random.below(7))
            .flat_map(|_| Actor::random(&mut random))
            .collect();
        for frame in 0..24 {
            let mut scene = Scene::new([SIZE as f32; 2], light).unwrap();
            for actor in &actors {
                scene.push(actor.at(frame)).unwrap();
            }
            let begin = Instant::now();
            let picture = draw(&mut renderer, &scene);
            worst = worst.max(begin.elapsed());
            frames += 1;
            // A mask of this key is the mask of this key, however long it has been kept.
            let surface = &scene.surfaces()[0];
            let shadow = light
                .cast(surface.shape(), surface.elevation(), 0.0)
                .unwrap();
            if let Some((key, _)) = shadow.key(1.0, Tolerance::ONE_LEVEL) {
                let drawn = NinePatch::draw(&key, &mut scratch).unwrap();
                assert!(*patches.entry(key).or_insert_with(|| drawn.clone()) == drawn);
            }
            if patches.len() > 500 {
                patches.clear();
            }
            if frame % 12 == 5 {
                assert!(
                    draw(&mut Renderer::new(), &scene) == picture,
                    "scene {scenes}, frame {frame}"
                );
                let kept = densities(&shadow, &grid, &by(None), &mut scratch);
                let fresh = densities(&shadow, &grid, &by(None), &mut Scratch::new());
                assert!(bits(&kept) == bits(&fresh), "scene {scenes}, frame {frame}");
            }
        }
        scenes += 1;
        if scenes == warm_up {
            early = Some(resident());
        }
        if scenes % 1000 == 0 {
            println!("{scenes} scenes, {} pages", resident());
        }
    }
    let early = early.unwrap();
    println!(
        "{frames} frames of {scenes} scenes in {:.0?}: worst frame {worst:.1?}; {early} pages after {warm_up} scenes, {} at the end",
        start.elapsed(),
        resident()
    );
    // Both are 0 where it cannot be told; more is what the largest scene so far took.
    assert!(early > 0 || !cfg!(target_os = "linux"));
    assert!(resident() <= early + early / 2 + 4096);
}

#[test]
fn a_few_scenes_leave_nothing_behind() {
    soak(Duration::ZERO, 4, 5);
}

#[test]
#[ignore = "takes minutes"]
fn minutes_of_scenes_leave_nothing_behind() {
    let minutes = setting("PENUMBRAL_MINUTES", 10) as u64;
    let seed = setting("PENUMBRAL_SEED", 0) as u64;
    soak(Duration::from_secs(60 * minutes), 200, seed);
}
