//! The same bits on every machine, by hashes of densities, masks, meshes and pictures.
//!
//! `tests/sameness.sh` runs this for other processors too. Where a change means to change bits, the message has the new table.

#![expect(clippy::unwrap_used, reason = "a case that is refused fails the test")]

#[expect(dead_code, reason = "other tests take more of it")]
mod common;

use common::{Case, by, case, densities};
use penumbral::plan::Method;
use penumbral::{
    Color, Grid, Light, LineCap, LineJoin, NinePatch, Paint, Path, PixelOptions, Pose, Renderer,
    Scene, Scratch, Shape, Stroke, Tolerance,
};
use tiny_skia::Pixmap;

/// The hash of each group.
const GOLDEN: [(&str, u64); 13] = [
    ("exact", 0x7184_6738_19c9_44ea),
    ("auto", 0xa2a0_079e_9c0e_fabd),
    ("direct", 0xd34e_7026_5346_9993),
    ("grid", 0x9031_b374_9549_b1f1),
    ("nine-patch", 0x2c3e_8dee_f177_aff6),
    ("points", 0x60af_0aa3_2f9e_6c9c),
    ("dithered paint", 0x12d0_a908_52c3_9dd0),
    ("masks", 0x19ed_f0a4_6549_3bdd),
    ("meshes", 0x987d_b4f0_8d2c_d2e5),
    ("pictures", 0x8749_68b5_df28_5312),
    ("svg", 0x07fa_0889_28ec_53c5),
    ("strokes", 0xfb0a_49bb_3f47_be65),
    ("tilted", 0x2ea0_6559_12c2_56b8),
];

/// FNV-1a of 64 bits (Fowler, Noll & Vo 1991).
struct Hash(u64);

impl Hash {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn floats(&mut self, floats: &[f32]) {
        for float in floats {
            self.bytes(&float.to_bits().to_le_bytes());
        }
    }
}

/// Cases of all kinds, each with a window of its pixels.
fn cases() -> Vec<(Case, Grid)> {
    let window = |case: &Case| {
        let per_unit = case.grid.pixels_per_unit() as f32;
        let size = if case.radius < 3.0 { [16, 8] } else { [48, 12] };
        let first = case.grid.width() as f32 / 4.0;
        Grid::new([first / per_unit; 2], size, per_unit).unwrap()
    };
    let cases = (700..820).map(case).map(|case| {
        let grid = window(&case);
        (case, grid)
    });
    cases.collect()
}

fn drawn(method: Option<Method>) -> Hash {
    let (mut scratch, mut hash) = (Scratch::new(), Hash::new());
    for (case, grid) in cases() {
        hash.floats(&densities(&case.shadow, &grid, &by(method), &mut scratch));
    }
    hash
}

fn points() -> Hash {
    let mut hash = Hash::new();
    for (case, _) in cases() {
        for point in [[20.25, 30.5], [33.0, 17.125], [8.5, 40.0]] {
            hash.bytes(&case.shadow.density_at(point).to_bits().to_le_bytes());
        }
    }
    hash
}

fn paint() -> Hash {
    let (mut scratch, mut hash) = (Scratch::new(), Hash::new());
    let paint = Paint::new(Color::rgb(30, 60, 90), 0.6).unwrap();
    let options = PixelOptions::default().with_dither(true);
    for (case, grid) in cases() {
        let mut pixels = vec![180; 4 * (grid.width() * grid.height()) as usize];
        case.shadow
            .blend_rgba8(&grid, &mut pixels, &paint, &options, &mut scratch)
            .unwrap();
        hash.bytes(&pixels);
    }
    hash
}

fn masks() -> Hash {
    let (mut scratch, mut hash) = (Scratch::new(), Hash::new());
    for (case, grid) in cases() {
        let per_unit = grid.pixels_per_unit() as f32;
        if let Some((key, _)) = case.shadow.key(per_unit, Tolerance::ONE_LEVEL) {
            hash.bytes(NinePatch::draw(&key, &mut scratch).unwrap().mask());
        }
    }
    hash
}

fn meshes() -> Hash {
    let mut hash = Hash::new();
    for (case, _) in cases().into_iter().step_by(8) {
        let mesh = case.shadow.mesh(Tolerance::levels(8.0).unwrap());
        for vertex in mesh.vertices() {
            hash.floats(&vertex.position);
            hash.floats(&[vertex.density]);
        }
        for index in mesh.indices() {
            hash.bytes(&index.to_le_bytes());
        }
    }
    hash
}

/// Round ends and corners of strokes, and curves of tilted casters, go by trigonometry.
fn strokes() -> Hash {
    let (mut scratch, mut hash) = (Scratch::new(), Hash::new());
    let path = "M10 20C30 0 40 50 55 25L62 40Q70 10 50 8A9 6 20 1 0 30 44";
    let path = Path::from_svg(path).unwrap();
    let pen = Stroke::new(3.0).unwrap();
    let pens = [
        pen,
        pen.with_join(LineJoin::Round).with_cap(LineCap::Round),
        pen.with_join(LineJoin::Bevel).with_cap(LineCap::Square),
    ];
    let grid = Grid::new([20.0, 8.0], [40, 24], 1.0).unwrap();
    for pen in pens {
        let shape = Shape::stroke(&path, &pen).unwrap();
        for spread in [0.4, 5.0] {
            let light = Light::directional([0.0, 0.0], spread).unwrap();
            let shadow = light.cast(&shape, 1.0, 0.0).unwrap();
            hash.floats(&densities(&shadow, &grid, &by(None), &mut scratch));
        }
    }
    hash
}

fn tilted() -> Hash {
    let (mut scratch, mut hash) = (Scratch::new(), Hash::new());
    let light = Light::new([40.0, 10.0, 200.0], 60.0).unwrap();
    let shapes = [
        Shape::rounded_rect(20.0, 12.0, 44.0, 30.0, 6.0).unwrap(),
        Shape::circle([40.0, 30.0], 20.0).unwrap(),
    ];
    let grid = Grid::new([10.0, 20.0], [48, 12], 1.0).unwrap();
    for shape in shapes {
        for elevation in [4.0, 30.0] {
            let pose = Pose::turned(elevation, [40.0, 30.0], [1.0, 0.4], 0.5).unwrap();
            let shadow = light.cast_posed(&shape, &pose, 0.0).unwrap();
            let mut densities = vec![0.0; 48 * 12];
            let options = PixelOptions::default();
            shadow
                .fill_f32(&grid, &mut densities, &options, &mut scratch)
                .unwrap();
            hash.floats(&densities);
            // Below it the caster touches the ground, and refinement is long.
            if elevation > 20.0 {
                let mesh = shadow.mesh(Tolerance::levels(16.0).unwrap());
                for vertex in mesh.vertices() {
                    hash.floats(&vertex.position);
                }
            }
        }
    }
    hash
}

fn scenes() -> [Scene; 2] {
    [
        include_str!("../fixtures/scenes/dialog-over-list.json"),
        include_str!("../fixtures/scenes/icon-set.json"),
    ]
    .map(|text| Scene::from_json(text).unwrap().with_scale(0.25).unwrap())
}

fn pictures() -> Hash {
    let mut hash = Hash::new();
    for scene in scenes() {
        let grid = scene.grid().unwrap();
        let mut pixmap = Pixmap::new(grid.width(), grid.height()).unwrap();
        Renderer::new().render(&scene, &mut pixmap).unwrap();
        hash.bytes(pixmap.data());
    }
    hash
}

fn svg() -> Hash {
    let mut hash = Hash::new();
    let [scene, _] = scenes();
    hash.bytes(
        scene
            .to_svg(Tolerance::levels(16.0).unwrap())
            .unwrap()
            .as_bytes(),
    );
    hash
}

#[test]
fn bits_are_those_of_every_other_machine() {
    let hashes = [
        drawn(Some(Method::Exact)),
        drawn(None),
        drawn(Some(Method::Direct)),
        drawn(Some(Method::Grid)),
        drawn(Some(Method::NinePatch)),
        points(),
        paint(),
        masks(),
        meshes(),
        pictures(),
        svg(),
        strokes(),
        tilted(),
    ];
    let table: Vec<_> = GOLDEN
        .iter()
        .zip(hashes)
        .map(|((name, _), hash)| (*name, hash.0))
        .collect();
    let lines: Vec<String> = table
        .iter()
        .map(|(name, hash)| format!("    (\"{name}\", {hash:#018x}),"))
        .collect();
    println!(
        "{}, {} bits, {} endian",
        std::env::consts::ARCH,
        usize::BITS,
        if cfg!(target_endian = "big") {
            "big"
        } else {
            "little"
        }
    );
    assert!(table == GOLDEN, "the hashes are\n{}", lines.join("\n"));
}
