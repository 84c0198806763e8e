//! Fewer triangles: refinement never takes a vertex back, though later ones make many needless.
//!
//! Sides shrink to a point, one after another, where every triangle that changes stays within the limit. The vertex that is left
//! gets the density in the middle of all that are within it. The triangles outside and in the umbra are there too, so that nothing
//! comes to lie on anything else: the penumbra's two edges lose vertices only, and what a chord cuts off is measured as well.

mod relax;

use glam::DVec2;

use super::measure::{Assessment, Measure};
use super::regions::Region;

/// How many of a vertex's sides are tried, the shortest first, unless triangles count most: with all of them a twentieth fewer are left,
/// for half as much time again.
pub(super) const TRIED: usize = 3;

/// The part of the limit that few samples may reach for more of them to be looked at.
const PROMISING: f64 = 0.95;

/// The part of the limit that may be cut off along the penumbra's edges: about what their rings' own chords leave out.
const CUT: f64 = 0.15;

/// The same where triangles count most, and the part of the penumbra's mass that all that is cut off may have, as far as that is not more
/// than the limit.
const LARGE_CUT: f64 = 0.6;
const LOST: f64 = 0.1;

/// The least height of a triangle, over the penumbra radius.
const FLATTEST: f64 = 1e-3;

/// From which length on triangles are needles, in penumbra radii: they take as long to measure as they are.
const NEEDLE: f64 = 16.0;

/// How many times that length of needles is measured for each triangle there is at first. Along a comb all teeth may be joined by needles
/// with its far ends, and to try them all takes the square of their number.
const PATIENCE: f64 = 12.0;

/// The triangle that is not there any more.
const GONE: [usize; 3] = [usize::MAX; 3];

/// A vertex.
#[derive(Debug, Clone)]
pub(super) struct Corner {
    pub(super) at: DVec2,
    pub(super) density: f64,
    /// The triangles about it.
    around: Vec<usize>,
    /// Whether something there has changed since all its sides were tried.
    fresh: bool,
}

impl Corner {
    pub(super) fn new(at: DVec2, density: f64) -> Self {
        Self {
            at,
            density,
            around: Vec::new(),
            fresh: true,
        }
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    pub(super) corners: [usize; 3],
    pub(super) region: Region,
    /// The largest differences from the profile's density, and from the exact one.
    pub(super) error: f64,
    pub(super) exact_error: f64,
}

impl Triangle {
    /// Keeps what was measured, if anything was.
    fn note(&mut self, assessment: Option<Assessment>) {
        if let Some(found) = assessment {
            (self.error, self.exact_error) = (found.error, found.exact_error);
        }
    }
}

/// A triangle about a vertex, with its side opposite of it.
type Opposite = (usize, [usize; 2]);

/// Where a vertex is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    /// All about it is penumbra.
    Inside,
    /// On an edge of the penumbra between two others, with the penumbra on the left of the way from the first to the second.
    Edge([usize; 2]),
    /// Edges meet there, or no penumbra does.
    Fixed,
}

/// What a vertex may become.
struct Fit {
    at: DVec2,
    density: f64,
    assessments: Vec<Option<Assessment>>,
    /// The exact density of what is cut off at most, and its mass.
    cut: f64,
    lost: f64,
}

pub(super) struct Thinning<'a> {
    measure: &'a mut Measure,
    limit: f64,
    flattest: f64,
    most_cut: f64,
    /// How much of the shadow's mass may still be cut off.
    spare: f64,
    /// How much of needles may still be measured, in lengths from which on they are.
    patience: f64,
    pub(super) corners: Vec<Corner>,
    triangles: Vec<Triangle>,
    /// How wrong it is where the penumbra's edges were cut off.
    pub(super) cut: f64,
}

impl<'a> Thinning<'a> {
    /// Of triangles of the whole plane about a shadow, none of them to be wrong by more than `limit`, where positions are
    /// `rounding` off.
    pub(super) fn new(
        measure: &'a mut Measure,
        limit: f64,
        rounding: f64,
        mut corners: Vec<Corner>,
        triangles: Vec<Triangle>,
    ) -> Self {
        for (index, triangle) in triangles.iter().enumerate() {
            for corner in triangle.corners {
                corners[corner].around.push(index);
            }
        }
        let flattest = (FLATTEST * measure.radius()).max(8.0 * rounding);
        let patience = PATIENCE * triangles.len() as f64;
        Self {
            measure,
            limit,
            flattest,
            most_cut: CUT * limit,
            spare: f64::INFINITY,
            patience,
            corners,
            triangles,
            cut: 0.0,
        }
    }

    /// The triangles that are left.
    pub(super) fn triangles(&self) -> impl Iterator<Item = &Triangle> {
        self.triangles.iter().filter(|t| t.corners != GONE)
    }

    /// Takes away what it can, trying so many of a vertex's sides.
    pub(super) fn run(&mut self, tried: usize) {
        loop {
            let mut changed = false;
            for vertex in 0..self.corners.len() {
                changed |= self.shrink_one(vertex, tried);
            }
            if !changed {
                break;
            }
        }
    }

    /// Shrinks one of a vertex's sides if it can be, the shortest first.
    fn shrink_one(&mut self, vertex: usize, tried: usize) -> bool {
        if !core::mem::replace(&mut self.corners[vertex].fresh, false) {
            return false;
        }
        let place = self.place(vertex);
        let mut others: Vec<usize> = match place {
            Place::Inside => self.star(vertex).map(|(_, [next, _])| next).collect(),
            Place::Edge(others) => others.to_vec(),
            Place::Fixed => return false,
        };
        let at = self.corners[vertex].at;
        let length = |other: usize| (self.corners[other].at - at).length_squared();
        others.sort_by(|&a, &b| length(a).total_cmp(&length(b)).then(a.cmp(&b)));
        others
            .into_iter()
            .take(tried)
            .any(|other| self.shrink(vertex, place, other))
    }

    /// The triangles about a vertex, with their sides opposite of it.
    fn star(&self, vertex: usize) -> impl Iterator<Item = Opposite> {
        self.corners[vertex].around.iter().map(move |&index| {
            let [a, b, c] = self.triangles[index].corners;
            let side = if a == vertex {
                [b, c]
            } else if b == vertex {
                [c, a]
            } else {
                [a, b]
            };
            (index, side)
        })
    }

    /// The same but for those at another vertex.
    fn star_without(&self, vertex: usize, other: usize) -> Vec<Opposite> {
        let star = self.star(vertex);
        star.filter(|(_, side)| !side.contains(&other)).collect()
    }

    fn place(&self, vertex: usize) -> Place {
        let region = |index: usize| self.triangles[index].region;
        let mut beyond = self
            .star(vertex)
            .map(|(index, _)| region(index))
            .filter(|&region| region != Region::Penumbra);
        let Some(first) = beyond.next() else {
            return if self.corners[vertex].around.is_empty() {
                Place::Fixed
            } else {
                Place::Inside
            };
        };
        if beyond.any(|region| region != first) {
            return Place::Fixed;
        }
        let penumbra = || {
            self.star(vertex)
                .filter(|&(index, _)| region(index) == Region::Penumbra)
                .map(|(_, side)| side)
        };
        let mut starts = penumbra().filter(|[from, _]| penumbra().all(|[_, to]| to != *from));
        let mut ends = penumbra().filter(|[_, to]| penumbra().all(|[from, _]| from != *to));
        match (starts.next(), starts.next(), ends.next(), ends.next()) {
            (Some([next, _]), None, Some([_, before]), None) => Place::Edge([before, next]),
            _ => Place::Fixed,
        }
    }

    /// Shrinks a side to one of its ends, or to its middle where nothing keeps it from there.
    fn shrink(&mut self, vertex: usize, place: Place, other: usize) -> bool {
        // No third vertex may be next to both but those of the two triangles between.
        let next = |v: usize| self.star(v).map(|(_, [next, _])| next);
        if next(vertex)
            .filter(|&v| next(other).any(|w| w == v))
            .count()
            != 2
        {
            return false;
        }
        if !self.bears(vertex) || !self.bears(other) {
            return false;
        }
        let mut sides = self.star_without(vertex, other);
        let [from, to] = [vertex, other].map(|v| self.corners[v].at);
        let is_free = place == Place::Inside && self.place(other) == Place::Inside;
        let found = if is_free {
            sides.extend(self.star_without(other, vertex));
            let found = self.fit(to, None, &sides);
            found.or_else(|| self.fit(from.midpoint(to), None, &sides))
        } else {
            let density = self.corners[other].density;
            let fit = self.fit(to, Some(density), &sides);
            fit.and_then(|fit| match place {
                Place::Edge(ends) => self.cut(vertex, ends, fit),
                _ => Some(fit),
            })
        };
        let Some(fit) = found else { return false };
        self.put(vertex, other, &sides, fit);
        true
    }

    /// Whether there is patience to measure the triangles about a vertex once more, and takes of it what they are for.
    fn bears(&mut self, vertex: usize) -> bool {
        let at = self.corners[vertex].at;
        let length = |(_, [next, _]): Opposite| (self.corners[next].at - at).length();
        let longest = self.star(vertex).map(length).fold(0.0, f64::max);
        let needles = longest / (NEEDLE * self.measure.radius());
        if needles > 1.0 {
            self.patience -= needles;
        }
        needles <= 1.0 || self.patience > 0.0
    }

    /// What a vertex at a place may be as a corner of triangles with these sides opposite of it.
    fn fit(&mut self, at: DVec2, forced: Option<f64>, sides: &[Opposite]) -> Option<Fit> {
        let place = |v: usize| self.corners[v].at;
        let has_area = |&(_, side): &Opposite| {
            let [b, c] = side.map(place);
            let longest = (b - at)
                .length()
                .max((c - at).length())
                .max((c - b).length());
            (b - at).perp_dot(c - at) >= self.flattest * longest
        };
        if !sides.iter().all(has_area) {
            return None;
        }
        let (mut low, mut high) = forced.map_or((0.0, 1.0), |density| (density, density));
        for &(index, side) in sides {
            if self.triangles[index].region != Region::Penumbra {
                continue;
            }
            let [b, c] = side.map(|v| &self.corners[v]);
            let all = [at, b.at, c.at];
            let found = self
                .measure
                .allowed(all, [b.density, c.density], PROMISING * self.limit);
            (low, high) = (f64::max(low, found.0), f64::min(high, found.1));
            if low > high {
                return None;
            }
        }
        let density = f64::midpoint(low, high);
        let mut assessments = Vec::with_capacity(sides.len());
        for &(index, side) in sides {
            if self.triangles[index].region != Region::Penumbra {
                assessments.push(None);
                continue;
            }
            let [b, c] = side.map(|v| &self.corners[v]);
            let assessment = self.measure.assess(
                [at, b.at, c.at],
                [density, b.density, c.density],
                [false; 3],
                true,
                self.limit,
            );
            if assessment.most > self.limit {
                return None;
            }
            assessments.push(Some(assessment));
        }
        Some(Fit {
            at,
            density,
            assessments,
            cut: 0.0,
            lost: 0.0,
        })
    }

    /// The same if what the penumbra loses is flat enough, where an edge's vertex goes from between its neighbours to where it fits.
    fn cut(&mut self, vertex: usize, ends: [usize; 2], mut fit: Fit) -> Option<Fit> {
        let [before, next] = ends.map(|v| self.corners[v].at);
        let Corner { at, density, .. } = self.corners[vertex];
        for corners in [[before, at, fit.at], [fit.at, at, next]] {
            let [a, b, c] = corners;
            let area = 0.5 * (b - a).perp_dot(c - a);
            if area <= 0.0 {
                continue;
            }
            let found = self
                .measure
                .assess(corners, [density; 3], [false; 3], true, self.most_cut);
            if found.most > self.most_cut {
                return None;
            }
            fit.cut = fit.cut.max(found.exact_error);
            fit.lost += area * found.exact_error;
        }
        (fit.lost <= self.spare).then_some(fit)
    }

    /// Notes what a fit loses.
    fn lose(&mut self, fit: &Fit) {
        self.cut = self.cut.max(fit.cut);
        self.spare -= fit.lost;
    }

    /// Leaves a vertex out, and `other` as fitted.
    fn put(&mut self, vertex: usize, other: usize, sides: &[Opposite], fit: Fit) {
        self.lose(&fit);
        let between: Vec<usize> = self
            .star(vertex)
            .filter(|(_, side)| side.contains(&other))
            .map(|(index, _)| index)
            .collect();
        for index in between {
            for corner in core::mem::replace(&mut self.triangles[index].corners, GONE) {
                self.corners[corner].around.retain(|&t| t != index);
            }
        }
        for (&(index, [a, b]), assessment) in sides.iter().zip(fit.assessments) {
            self.triangles[index].corners = [other, a, b];
            self.triangles[index].note(assessment);
            for corner in [a, b] {
                self.corners[corner].fresh = true;
            }
        }
        let taken = core::mem::take(&mut self.corners[vertex].around);
        let kept = &mut self.corners[other];
        kept.around.extend(taken);
        (kept.at, kept.density, kept.fresh) = (fit.at, fit.density, true);
    }
}
