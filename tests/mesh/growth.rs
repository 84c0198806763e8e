//! How time grows with the number of triangles: as n log n, to 100,000 of them.

use std::time::Instant;

use penumbral::{FillRule, Light, MeshOptions, Path, Shadow, Shape};

use crate::checks::*;

const BELL: &str = "M12 22A2 2 0 0 0 14 20H10A2 2 0 0 0 12 22M18 16V11C18 7.93 16.36 5.36 13.5 4.68V4A1.5 1.5 0 0 0 10.5 4\
    V4.68C7.63 5.36 6 7.92 6 11V16L4 18V19H20V18Z";

/// How often a mesh is made: the least time counts.
const RUNS: usize = 2;

/// From how many triangles on, and up to how many.
const FIRST: f64 = 1e3;
const LAST: f64 = 1e5;

/// By how much time over n log n may grow between the two. Caches hold the first and not the last; were it n^1.5, it would be
/// six times as much, and fifty at n².
const GROWTH: f64 = 3.0;

/// The most vertices: refinement takes three times as many as are left when it has been thinned.
const MOST_VERTICES: usize = 1 << 18;

/// Teeth as wide as the gaps between them.
fn comb(teeth: u16) -> Vec<Shape> {
    let mut ring = vec![[0.0, -4.0]];
    for tooth in 0..teeth {
        let x = 3.0 * f32::from(tooth);
        ring.extend([[x, 10.0], [x + 1.5, 10.0], [x + 1.5, 0.0], [x + 3.0, 0.0]]);
    }
    ring.push([3.0 * f32::from(teeth), -4.0]);
    vec![Shape::polygon(&[ring], FillRule::NonZero).unwrap()]
}

/// Rows of bells, as many in each.
fn bells(side: u16) -> Vec<Shape> {
    let bell = Shape::path(&Path::from_svg(BELL).unwrap(), FillRule::NonZero).unwrap();
    let place = |i: u16| [i % side, i / side].map(|i| 24.0 * f32::from(i));
    let moved = |i| bell.translated(place(i)).unwrap();
    (0..side * side).map(moved).collect()
}

/// Rows of squares, as many in each, of all shapes the one with the most triangles before there are too many samples to halve.
fn squares(side: u16) -> Vec<Shape> {
    let place = |i: u16| [i % side, i / side].map(|i| 2.0 * f32::from(i));
    let square = |i| {
        let [x, y] = place(i);
        Shape::rect(x, y, 1.0, 1.0).unwrap()
    };
    (0..side * side).map(square).collect()
}

/// A mesh as it was made in the least time.
struct Timed {
    triangles: f64,
    seconds: f64,
    /// Whether squares were halved: only such meshes state the whole tolerance as their error.
    halved: bool,
}

fn timed(shadow: &Shadow, options: MeshOptions, tolerance: f32) -> Timed {
    let mut least = f64::INFINITY;
    let mut made = None;
    for _ in 0..RUNS {
        let start = Instant::now();
        let mesh = shadow.mesh(options);
        least = least.min(start.elapsed().as_secs_f64());
        assert!(mesh.is_complete());
        made = Some(mesh);
    }
    let mesh = made.unwrap();
    Timed {
        triangles: mesh.triangles().count() as f64,
        seconds: least,
        halved: mesh.error_levels() == f64::from(tolerance),
    }
}

/// Meshes of more and more of a shape, by how much time over n log n grows at most. Gives the most triangles of refined ones and
/// of halved ones.
fn growth(
    name: &str,
    shapes: fn(u16) -> Vec<Shape>,
    radius: f32,
    tolerance: f32,
    quick: bool,
) -> [f64; 2] {
    let light = Light::directional([0.0, 0.0], radius).unwrap();
    let mut options = MeshOptions::new(levels(tolerance)).with_max_vertices(MOST_VERTICES);
    if quick {
        options = options.quick();
    }
    // Of refined ones and of halved ones.
    let (mut first, mut most) = ([None; 2], [0.0; 2]);
    for size in (0..10).flat_map(|power| [2 << power, 3 << power]) {
        let shadow = light.cast_all(&shapes(size), 1.0, 0.0).unwrap();
        let made = timed(&shadow, options, tolerance);
        let count = made.triangles;
        let share = made.seconds * 1e9 / (count * count.log2());
        let kind = if made.halved { "halved" } else { "refined" };
        println!(
            "{name} {size} at r {radius} within {tolerance}, {kind}: {count} triangles in {:.1} ms, {share:.0} ns over n log n",
            made.seconds * 1e3
        );
        if quick && !made.halved {
            break;
        }
        let kind = usize::from(made.halved);
        most[kind] = count;
        if count >= FIRST {
            let first = *first[kind].get_or_insert(share);
            assert!(share <= GROWTH * first, "{share} after {first}");
        }
        if count >= LAST {
            break;
        }
    }
    most
}

/// All shapes; the most triangles of refined meshes and of halved ones.
fn growth_of_all(quick: bool) -> [f64; 2] {
    let mut most = [0.0_f64; 2];
    for tolerance in [0.5, 2.0, 8.0] {
        let combs = [0.4, 2.0].map(|radius| growth("comb", comb, radius, tolerance, quick));
        let bells = [1.0, 6.0].map(|radius| growth("bells", bells, radius, tolerance, quick));
        let squares = [growth("squares", squares, 1.0, tolerance, quick)];
        for counts in combs.into_iter().chain(bells).chain(squares) {
            most = [0, 1].map(|kind: usize| most[kind].max(counts[kind]));
        }
    }
    most
}

/// By `cargo test --release --all-features --test mesh growth -- --ignored --nocapture`.
#[test]
#[ignore = "an hour, and it times"]
fn time_of_meshes_of_few_triangles_grows_as_n_log_n() {
    let [refined, _] = growth_of_all(false);
    assert!(refined >= LAST, "{refined}");
}

#[test]
#[ignore = "minutes, and it times"]
fn time_of_quick_meshes_grows_as_n_log_n() {
    let [_, halved] = growth_of_all(true);
    assert!(halved >= LAST, "{halved}");
}
