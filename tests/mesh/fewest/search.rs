//! A triangulation of the plane that loses triangles as long as its error allows.
//!
//! Vertices move, sides flip and shrink to points, each only where all triangles that change stay within the limit; a vertex gets the
//! density in the middle of those that are within it. What is preferred lowers a high power of the errors, so that they spread evenly and
//! the next side can go. Then, again and again, some sides somewhere are divided, all around is moved about and shrunk: kept if no
//! more triangles are left than before.

use glam::DVec2;

use super::field::{Corner, Difference, Field};
use crate::checks::Lots;

/// The triangle that is not there any more.
const GONE: [usize; 3] = [usize::MAX; 3];

/// The least area of a triangle twice over, in squares of samples.
const LEAST_AREA: f64 = 0.02;

#[derive(Clone)]
struct Vertex {
    at: DVec2,
    density: f64,
    /// Of the frame about all.
    fixed: bool,
    /// The triangles that it is a corner of.
    around: Vec<usize>,
}

#[derive(Clone)]
struct Triangle {
    corners: [usize; 3],
    energy: f64,
}

/// A vertex as it could be: with its density and the energies of the triangles about it.
struct Fit {
    density: f64,
    energies: Vec<f64>,
}

#[derive(Clone)]
pub(super) struct Search<'a> {
    field: &'a Field,
    limit: f64,
    vertices: Vec<Vertex>,
    triangles: Vec<Triangle>,
    free: Vec<usize>,
}

impl<'a> Search<'a> {
    /// Begins with triangles, all of the plane in them but for what is far away.
    pub(super) fn new(
        field: &'a Field,
        limit: f64,
        corners: &[Corner],
        fixed: usize,
        triangles: &[[usize; 3]],
    ) -> Self {
        let vertex = |(i, &(at, density)): (usize, &Corner)| Vertex {
            at,
            density,
            fixed: i < fixed,
            around: Vec::new(),
        };
        let mut search = Self {
            field,
            limit,
            vertices: corners.iter().enumerate().map(vertex).collect(),
            triangles: Vec::new(),
            free: Vec::new(),
        };
        for &corners in triangles {
            search.add(corners, 0.0);
        }
        for index in 0..search.triangles.len() {
            let [a, b, c] = search.triangles[index].corners;
            let vertex = search.vertices[a].clone();
            let energy = search.energy_of(vertex.at, &[[b, c]], vertex.density);
            search.triangles[index].energy = energy;
        }
        search
    }

    /// The triangles that are not all outside, by their corners.
    pub(super) fn drawn(&self) -> impl Iterator<Item = [Corner; 3]> {
        let corner = |v: usize| (self.vertices[v].at, self.vertices[v].density);
        let alive = self.triangles.iter().filter(|t| t.corners != GONE);
        let drawn = alive.filter(|t| self.is_drawn(t.corners));
        drawn.map(move |t| t.corners.map(corner))
    }

    pub(super) fn count(&self) -> usize {
        self.drawn().count()
    }

    fn is_drawn(&self, corners: [usize; 3]) -> bool {
        corners.iter().any(|&v| self.vertices[v].density > 0.0)
    }

    fn energy(&self) -> f64 {
        let alive = self.triangles.iter().filter(|t| t.corners != GONE);
        alive.map(|t| t.energy).sum()
    }

    fn add(&mut self, corners: [usize; 3], energy: f64) {
        let triangle = Triangle { corners, energy };
        let index = match self.free.pop() {
            Some(index) => {
                self.triangles[index] = triangle;
                index
            }
            None => {
                self.triangles.push(triangle);
                self.triangles.len() - 1
            }
        };
        for corner in corners {
            self.vertices[corner].around.push(index);
        }
    }

    fn remove(&mut self, index: usize) -> [usize; 3] {
        let corners = core::mem::replace(&mut self.triangles[index].corners, GONE);
        for corner in corners {
            self.vertices[corner].around.retain(|&t| t != index);
        }
        self.free.push(index);
        corners
    }

    /// The side of a triangle opposite of a corner.
    fn opposite(&self, index: usize, vertex: usize) -> [usize; 2] {
        let [a, b, c] = self.triangles[index].corners;
        if a == vertex {
            [b, c]
        } else if b == vertex {
            [c, a]
        } else {
            [a, b]
        }
    }

    fn corner(&self, vertex: usize) -> Corner {
        (self.vertices[vertex].at, self.vertices[vertex].density)
    }

    /// The differences in triangles from `at` to sides, with where each triangle's end; none if one of them has no area.
    fn differences(
        &self,
        at: DVec2,
        sides: &[[usize; 2]],
    ) -> Option<(Vec<Difference>, Vec<[usize; 2]>)> {
        let mut all = Vec::with_capacity(256);
        let mut ends = Vec::with_capacity(sides.len());
        for side in sides {
            let [a, b] = side.map(|v| self.corner(v));
            if (a.0 - at).perp_dot(b.0 - at) < LEAST_AREA {
                return None;
            }
            self.field.push_side(at, a, &mut all);
            let along = all.len();
            self.field.push_inside(at, [a, b], &mut all);
            ends.push([along, all.len()]);
        }
        Some((all, ends))
    }

    /// The density of a vertex at `at` that suits triangles to these sides, if one is within the limit; `forced` is the only one that
    /// may be.
    fn fit(&self, at: DVec2, sides: &[[usize; 2]], forced: Option<f64>) -> Option<Fit> {
        let (all, ends) = self.differences(at, sides)?;
        let (mut low, mut high) = (0.0_f64, 1.0_f64);
        for &[rest, weight] in &all {
            if weight > 1e-9 {
                low = low.max((-self.limit - rest) / weight);
                high = high.min((self.limit - rest) / weight);
            } else if rest.abs() > self.limit {
                return None;
            }
        }
        let density = forced.unwrap_or(f64::midpoint(low, high));
        if density < low || density > high {
            return None;
        }
        Some(Fit {
            density,
            energies: self.energies(&all, &ends, density),
        })
    }

    fn energies(&self, all: &[Difference], ends: &[[usize; 2]], density: f64) -> Vec<f64> {
        let mut start = 0;
        let mut energies = Vec::with_capacity(ends.len());
        for &[along, end] in ends {
            let of = |differences: &[Difference]| -> f64 {
                let power = |&[rest, weight]: &Difference| {
                    let share = (rest + weight * density) / self.limit;
                    let square = share * share;
                    square * square * square
                };
                differences.iter().map(power).sum()
            };
            // Of triangles without samples inside, the sides tell.
            energies.push(of(&all[along..end]) + 0.5 * of(&all[start..along]));
            start = end;
        }
        energies
    }

    /// The energy of triangles, whatever their error.
    fn energy_of(&self, at: DVec2, sides: &[[usize; 2]], density: f64) -> f64 {
        let found = self.differences(at, sides);
        found.map_or(f64::INFINITY, |(all, ends)| {
            self.energies(&all, &ends, density).iter().sum()
        })
    }

    fn star(&self, vertex: usize) -> Vec<[usize; 2]> {
        let around = self.vertices[vertex].around.iter();
        around.map(|&t| self.opposite(t, vertex)).collect()
    }

    fn energy_around(&self, vertex: usize) -> f64 {
        let around = self.vertices[vertex].around.iter();
        around.map(|&t| self.triangles[t].energy).sum()
    }

    /// Moves a vertex some way, if that lowers the energy by more than `heat` raises it.
    fn relocate(&mut self, vertex: usize, heat: f64, lots: &mut Lots) {
        let (at, density) = self.corner(vertex);
        if self.vertices[vertex].fixed || self.vertices[vertex].around.is_empty() {
            return;
        }
        let star = self.star(vertex);
        let to = star[pick(star.len(), lots)];
        let [to, other] = to.map(|v| self.vertices[v].at);
        let size = 0.5 * 0.02_f64.powf(f64::from(lots.next()));
        let ways = [to - at, (to - other).perp() * 0.5];
        let shares = [0, 1].map(|_| size * (2.0 * f64::from(lots.next()) - 1.0));
        let next = match pick(3, lots) {
            0 => at + ways[0] * shares[0],
            1 => at + ways[0] * shares[0] + ways[1] * shares[1],
            _ => {
                let near = (to - at).length();
                at + DVec2::new(shares[0], shares[1]) * near
            }
        };
        let forced = (density == 0.0).then_some(0.0);
        if let Some(fit) = self.fit(next, &star, forced)
            && fit.energies.iter().sum::<f64>() < self.energy_around(vertex) * (1.0 + heat) + heat
        {
            self.put(vertex, next, fit);
        }
    }

    fn put(&mut self, vertex: usize, at: DVec2, fit: Fit) {
        (self.vertices[vertex].at, self.vertices[vertex].density) = (at, fit.density);
        for (i, energy) in fit.energies.into_iter().enumerate() {
            let index = self.vertices[vertex].around[i];
            self.triangles[index].energy = energy;
        }
    }

    /// Puts a vertex beside the shadow if fewer triangles are drawn then.
    fn lower(&mut self, vertex: usize) {
        let (at, density) = self.corner(vertex);
        if density == 0.0 || self.vertices[vertex].around.is_empty() {
            return;
        }
        let star = self.star(vertex);
        let outside = |side: &[usize; 2]| side.iter().all(|&v| self.vertices[v].density == 0.0);
        if star.iter().any(outside)
            && let Some(fit) = self.fit(at, &star, Some(0.0))
        {
            self.put(vertex, at, fit);
        }
    }

    /// The triangles beside a side, with their corners opposite of it.
    fn beside(&self, from: usize, to: usize) -> Option<[(usize, usize); 2]> {
        let find = |from: usize, to: usize| {
            let around = self.vertices[from].around.iter();
            around
                .map(|&t| (t, self.opposite(t, from)))
                .find(|(_, side)| side[0] == to)
                .map(|(t, side)| (t, side[1]))
        };
        Some([find(from, to)?, find(to, from)?])
    }

    /// Turns a side of a triangle in its square, if that lowers the energy.
    fn flip(&mut self, index: usize, lots: &mut Lots) {
        let corners = self.triangles[index].corners;
        if corners == GONE {
            return;
        }
        let first = pick(3, lots);
        let [from, to] = [corners[first], corners[(first + 1) % 3]];
        let Some([(left, a), (right, b)]) = self.beside(from, to) else {
            return;
        };
        // Two triangles: a, from, b and a, b, to.
        let before = self.triangles[left].energy + self.triangles[right].energy;
        let drawn = |corners: [[usize; 3]; 2]| corners.map(|c| self.is_drawn(c));
        let now = drawn([[from, to, a], [to, from, b]]);
        let then = drawn([[a, from, b], [a, b, to]]);
        let count = |all: [bool; 2]| all.iter().filter(|&&d| d).count();
        let (at, density) = self.corner(a);
        if let Some(fit) = self.fit(at, &[[from, b], [b, to]], Some(density)) {
            let after: f64 = fit.energies.iter().sum();
            if count(then) < count(now) || (count(then) == count(now) && after < before) {
                self.remove(left);
                self.remove(right);
                self.add([a, from, b], fit.energies[0]);
                self.add([a, b, to], fit.energies[1]);
            }
        }
    }

    /// Shrinks a side of a triangle to a point, if it can be and raises the energy by less than `most`.
    fn shrink(&mut self, index: usize, most: f64, lots: &mut Lots) -> bool {
        let corners = self.triangles[index].corners;
        if corners == GONE || !self.is_drawn(corners) {
            return false;
        }
        let first = pick(3, lots);
        let [from, to] = [corners[first], corners[(first + 1) % 3]];
        let Some([(left, _), (right, _)]) = self.beside(from, to) else {
            return false;
        };
        if self.vertices[from].fixed && self.vertices[to].fixed {
            return false;
        }
        // No third vertex may be next to both.
        let next = |v: usize| self.star(v).into_iter().map(|side| side[0]);
        let common = next(from).filter(|v| next(to).any(|w| w == *v)).count();
        if common != 2 {
            return false;
        }
        let others = |v: usize| {
            let around = self.vertices[v].around.iter().copied();
            around.filter(move |&t| t != left && t != right)
        };
        let all: Vec<(usize, [usize; 2])> = others(from)
            .map(|t| (t, self.opposite(t, from)))
            .chain(others(to).map(|t| (t, self.opposite(t, to))))
            .collect();
        let star: Vec<[usize; 2]> = all.iter().map(|&(_, side)| side).collect();
        let before: f64 = [left, right]
            .into_iter()
            .chain(all.iter().map(|&(t, _)| t))
            .map(|t| self.triangles[t].energy)
            .sum();
        let [p, q] = [from, to].map(|v| self.vertices[v].at);
        let zero = [from, to].map(|v| self.vertices[v].density == 0.0);
        let share = f64::from(lots.next());
        let aside = (q - p).perp() * (f64::from(lots.next()) - 0.5);
        let mut ways = vec![
            (p, zero[0]),
            (q, zero[1]),
            (p.midpoint(q), false),
            (p + (q - p) * share + aside, false),
        ];
        if zero[0] != zero[1] {
            ways.push((p + (q - p) * share, true));
        }
        if self.vertices[from].fixed {
            ways = vec![(p, true)];
        } else if self.vertices[to].fixed {
            ways = vec![(q, true)];
        } else if zero[0] && zero[1] {
            ways.iter_mut().for_each(|way| way.1 = true);
        }
        let found = ways.into_iter().filter_map(|(at, zero)| {
            let fit = self.fit(at, &star, zero.then_some(0.0))?;
            Some((fit.energies.iter().sum::<f64>(), at, fit))
        });
        let Some((after, at, fit)) = found.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            return false;
        };
        if after - before > most {
            return false;
        }
        let [kept, lost] = if self.vertices[to].fixed {
            [to, from]
        } else {
            [from, to]
        };
        self.remove(left);
        self.remove(right);
        for &(index, _) in &all {
            self.remove(index);
        }
        debug_assert!(self.vertices[lost].around.is_empty());
        (self.vertices[kept].at, self.vertices[kept].density) = (at, fit.density);
        for ((_, [s, t]), energy) in all.into_iter().zip(fit.energies) {
            self.add([kept, s, t], energy);
        }
        true
    }

    /// Divides a side of a triangle.
    fn divide(&mut self, index: usize, lots: &mut Lots) {
        let corners = self.triangles[index].corners;
        if corners == GONE || !self.is_drawn(corners) {
            return;
        }
        let first = pick(3, lots);
        let [from, to] = [corners[first], corners[(first + 1) % 3]];
        let Some([(left, a), (right, b)]) = self.beside(from, to) else {
            return;
        };
        let [p, q] = [from, to].map(|v| self.vertices[v].at);
        let at = p + (q - p) * (0.2 + 0.6 * f64::from(lots.next()));
        let outside = [from, to].iter().all(|&v| self.vertices[v].density == 0.0);
        let star = [[to, a], [a, from], [from, b], [b, to]];
        let Some(fit) = self.fit(at, &star, outside.then_some(0.0)) else {
            return;
        };
        self.remove(left);
        self.remove(right);
        let vertex = self.vertices.len();
        self.vertices.push(Vertex {
            at,
            density: fit.density,
            fixed: false,
            around: Vec::new(),
        });
        for ([s, t], energy) in star.into_iter().zip(fit.energies) {
            self.add([vertex, s, t], energy);
        }
    }

    /// Moves and flips all, in no order.
    fn relax(&mut self, rounds: usize, heat: f64, lots: &mut Lots) {
        for _ in 0..rounds * self.vertices.len() {
            let vertex = pick(self.vertices.len(), lots);
            self.relocate(vertex, heat, lots);
            let triangle = pick(self.triangles.len(), lots);
            self.flip(triangle, lots);
        }
    }

    /// From many triangles to few: those that matter least go first.
    pub(super) fn thin(&mut self, lots: &mut Lots) {
        let mut most = 1e-3;
        while most < 1e4 {
            for _ in 0..2 {
                for _ in 0..3 * self.triangles.len() {
                    let triangle = pick(self.triangles.len(), lots);
                    self.shrink(triangle, most, lots);
                }
                for vertex in 0..self.vertices.len() {
                    self.lower(vertex);
                }
                self.compact();
                self.relax(2, 0.0, lots);
            }
            most *= 2.5;
        }
    }

    /// Leaves out vertices and triangles that are gone.
    fn compact(&mut self) {
        let mut numbers = vec![usize::MAX; self.vertices.len()];
        let mut kept = Vec::new();
        for (index, vertex) in self.vertices.iter().enumerate() {
            if vertex.fixed || !vertex.around.is_empty() {
                numbers[index] = kept.len();
                kept.push(Vertex {
                    around: Vec::new(),
                    ..vertex.clone()
                });
            }
        }
        self.vertices = kept;
        self.free.clear();
        let all = core::mem::take(&mut self.triangles);
        for triangle in all.into_iter().filter(|t| t.corners != GONE) {
            self.add(triangle.corners.map(|v| numbers[v]), triangle.energy);
        }
    }

    /// One try to do with fewer triangles somewhere.
    fn attempt(&mut self, lots: &mut Lots) {
        let center = pick(self.vertices.len(), lots);
        let mut near = vec![center];
        for _ in 0..2 {
            let next: Vec<usize> = near.iter().flat_map(|&v| self.star(v)).flatten().collect();
            near.extend(next);
            near.sort_unstable();
            near.dedup();
        }
        for _ in 0..pick(3, lots) {
            let around = &self.vertices[near[pick(near.len(), lots)]].around;
            if !around.is_empty() {
                let triangle = around[pick(around.len(), lots)];
                self.divide(triangle, lots);
            }
        }
        let heat = if lots.next() < 0.5 { 0.3 } else { 0.0 };
        for round in 0..6 * near.len() {
            let vertex = near[pick(near.len(), lots)];
            let heat = if round < 2 * near.len() { heat } else { 0.0 };
            self.relocate(vertex, heat, lots);
            let around = &self.vertices[vertex].around;
            if around.is_empty() {
                continue;
            }
            let triangle = around[pick(around.len(), lots)];
            match round % 3 {
                0 => drop(self.shrink(triangle, f64::INFINITY, lots)),
                1 => self.flip(triangle, lots),
                _ => self.lower(vertex),
            }
        }
    }

    /// Tries so often as there are triangles, `rounds` times.
    pub(super) fn improve(&mut self, rounds: usize, lots: &mut Lots) {
        self.compact();
        let (mut count, mut energy) = (self.count(), self.energy());
        for _ in 0..rounds * count {
            let mut next = self.clone();
            next.attempt(lots);
            let (next_count, next_energy) = (next.count(), next.energy());
            if next_count < count || (next_count == count && next_energy < 1.003 * energy) {
                next.compact();
                *self = next;
                (count, energy) = (next_count, next_energy);
            }
        }
    }
}

fn pick(count: usize, lots: &mut Lots) -> usize {
    ((f64::from(lots.next()) * count as f64) as usize).min(count - 1)
}
