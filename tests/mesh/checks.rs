//! What is asked of every mesh: its structure, its error against the exact density, its mass.

use std::collections::HashMap;

use penumbral::{Light, MeshVertex, Shadow, ShadowMesh, Shape, Tolerance};

use crate::common::worst;

/// Weights of a triangle's corners, none of them where refinement looks.
pub(crate) const SAMPLES: [[f64; 3]; 9] = [
    [0.25, 0.25, 0.5],
    [0.25, 0.5, 0.25],
    [0.5, 0.25, 0.25],
    [0.75, 0.25, 0.0],
    [0.0, 0.75, 0.25],
    [0.25, 0.0, 0.75],
    [0.1, 0.3, 0.6],
    [0.6, 0.1, 0.3],
    [0.3, 0.6, 0.1],
];

/// The tolerances that meshes are tested at, in levels.
pub(crate) const TOLERANCES: [f32; 5] = [0.5, 1.0, 2.0, 4.0, 8.0];

pub(crate) fn levels(levels: f32) -> Tolerance {
    Tolerance::levels(levels).unwrap()
}

/// The largest and the root mean square error by sampling inside the triangles, in levels.
pub(crate) fn sampled_error(shadow: &Shadow, mesh: &ShadowMesh) -> (f64, f64) {
    let (mut most, mut sum, mut area_sum) = (0.0_f64, 0.0, 0.0);
    for [a, b, c] in mesh.triangles() {
        let area = double_area(a.position, b.position, c.position);
        for weights in SAMPLES {
            let mix = |values: [f32; 3]| {
                values
                    .iter()
                    .zip(weights)
                    .map(|(v, w)| f64::from(*v) * w)
                    .sum::<f64>()
            };
            let x = mix([a.position[0], b.position[0], c.position[0]]);
            let y = mix([a.position[1], b.position[1], c.position[1]]);
            let density = mix([a.density, b.density, c.density]);
            let error = (density - shadow.density_at([x as f32, y as f32])) * 255.0;
            most = most.max(worst([error.abs()]));
            sum += error * error * area;
            area_sum += area;
        }
    }
    (
        most,
        if area_sum > 0.0 {
            (sum / area_sum).sqrt()
        } else {
            0.0
        },
    )
}

pub(crate) fn double_area(a: [f32; 2], b: [f32; 2], c: [f32; 2]) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| p.map(f64::from));
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Checks that triangles turn one way, have area, and meet edge to edge, and that what bounds them has density 0.
pub(crate) fn sanity_check(mesh: &ShadowMesh) {
    let mut edges: HashMap<(u32, u32), u32> = HashMap::new();
    for corners in mesh.indices().chunks_exact(3) {
        let at = |i: usize| mesh.vertices()[corners[i] as usize].position;
        assert!(double_area(at(0), at(1), at(2)) > 0.0);
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            let count = edges.entry((corners[from], corners[to])).or_default();
            *count += 1;
            assert_eq!(*count, 1, "two triangles on the same side of an edge");
        }
    }
    for &(from, to) in edges.keys() {
        if !edges.contains_key(&(to, from)) {
            for end in [from, to] {
                assert_eq!(
                    mesh.vertices()[end as usize].density,
                    0.0,
                    "an open edge inside of the penumbra"
                );
            }
        }
    }
    for vertex in mesh.vertices() {
        assert!((0.0..=1.0).contains(&vertex.density));
    }
}

/// The mesh's volume, its densities summed over its area.
pub(crate) fn mass(mesh: &ShadowMesh) -> f64 {
    mesh.triangles()
        .map(|[a, b, c]| {
            let mean = f64::from(a.density + b.density + c.density) / 3.0;
            double_area(a.position, b.position, c.position) / 2.0 * mean
        })
        .sum()
}

pub(crate) fn area(mesh: &ShadowMesh) -> f64 {
    mesh.triangles()
        .map(|[a, b, c]| double_area(a.position, b.position, c.position) / 2.0)
        .sum()
}

/// [`sanity_check`], for meshes that have a penumbra.
pub(crate) fn sanity_check_where_soft(mesh: &ShadowMesh) {
    if mesh.vertices().iter().any(|vertex| vertex.density == 0.0) {
        sanity_check(mesh);
    }
}

/// The largest error in levels: on a lattice of `parts` parts a side of each triangle, of more where it is long for the
/// penumbra, and from the worst samples on upwards.
pub(crate) fn dense_error(shadow: &Shadow, mesh: &ShadowMesh, parts: u32) -> f64 {
    dense_error_of(shadow, mesh.triangles(), parts)
}

/// The same of any triangles.
pub(crate) fn dense_error_of(
    shadow: &Shadow,
    triangles: impl Iterator<Item = [MeshVertex; 3]>,
    parts: u32,
) -> f64 {
    let mut tops: Vec<(f64, [f64; 2], [MeshVertex; 3])> = Vec::new();
    for corners in triangles {
        let [a, b, c] = corners.map(|corner| corner.position.map(f64::from));
        let length = |from: [f64; 2], to: [f64; 2]| (to[0] - from[0]).hypot(to[1] - from[1]);
        let longest = length(a, b).max(length(b, c)).max(length(c, a));
        let long = (longest / (0.2 * shadow.radius())).ceil().min(32.0) as u32;
        // The whole of an umbra is flat.
        let parts = match corners.iter().all(|corner| corner.density == 1.0) {
            true => parts,
            false => parts.max(long),
        };
        let mut top = (0.0, [0.0; 2], corners);
        for i in 0..=parts {
            for j in 0..=parts - i {
                let weights = [i, j].map(|part| f64::from(part) / f64::from(parts));
                let error = error_in(shadow, &corners, weights);
                if error > top.0 {
                    top = (error, weights, corners);
                }
            }
        }
        tops.push(top);
    }
    tops.sort_by(|a, b| b.0.total_cmp(&a.0));
    let climb = |(mut error, mut weights, corners): (f64, [f64; 2], [MeshVertex; 3])| {
        let mut step = 0.5 / f64::from(parts);
        while step > 1e-4 {
            let before = error;
            let ways = [[1.0, 0.0], [0.0, 1.0], [1.0, -1.0]];
            for way in ways.into_iter().flat_map(|[a, b]| [[a, b], [-a, -b]]) {
                let next = [0, 1].map(|i: usize| (weights[i] + way[i] * step).max(0.0));
                let found = error_in(shadow, &corners, next);
                if next[0] + next[1] <= 1.0 && found > error {
                    (error, weights) = (found, next);
                }
            }
            if error == before {
                step /= 2.0;
            }
        }
        error
    };
    worst(tops.into_iter().take(16).map(climb))
}

/// The error in levels where a triangle's first two corners have these weights.
fn error_in(shadow: &Shadow, corners: &[MeshVertex; 3], [a, b]: [f64; 2]) -> f64 {
    let weights = [a, b, 1.0 - a - b];
    let mix = |value: fn(&MeshVertex) -> f32| {
        let values = corners.iter().map(|corner| f64::from(value(corner)));
        values.zip(weights).map(|(v, w)| v * w).sum::<f64>()
    };
    let (x, y) = (mix(|v| v.position[0]), mix(|v| v.position[1]));
    // No comparison finds what is no number.
    worst([(mix(|v| v.density) - shadow.density_at([x as f32, y as f32])).abs() * 255.0])
}

pub(crate) fn android_card(elevation: f32) -> Shadow {
    let card = Shape::rounded_rect(0.0, 0.0, 300.0, 200.0, 12.0).unwrap();
    let light = Light::new([150.0, 100.0, 600.0], 800.0).unwrap();
    light.cast(&card, elevation, 0.0).unwrap()
}

/// Numbers in no order, the same on every machine.
pub(crate) struct Lots(pub(crate) u64);

impl Lots {
    /// The next one, from 0 to 1.
    pub(crate) fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 40) as f32 / (1_u64 << 24) as f32
    }
}
