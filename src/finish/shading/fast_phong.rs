//! Fast Phong shading: the normal is A x + B y + C over a face, and the intensity a second-order Taylor expansion of what Phong's
//! illumination makes of it (Bishop & Weimer 1986): two additions a pixel for each of body and gloss.

use glam::{DVec2, DVec3};

use super::{Canvas, Fragment};
use crate::finish::number::{Number, Taylor};
use crate::finish::{Intensity, Lighting, RimFace, RimMesh};

/// How far an expansion may be from Phong's intensities at a face's corners, in levels.
const LEVELS: f64 = 1.0;

/// Expanding costs as much as so many pixels of Phong's: faces of fewer are shaded pixel by pixel.
const FEWEST_PIXELS: f64 = 8.0;

pub(super) fn draw(mesh: &RimMesh, lighting: &Lighting, canvas: &mut Canvas) {
    let mut known: Vec<Option<(f64, f64)>> = vec![None; mesh.vertices().len()];
    for face in mesh.faces() {
        let corners = Fragment::corners(mesh, face);
        let places = face
            .vertices
            .map(|i| canvas.place(mesh.vertices()[i].position));
        let mut at_vertex = |corner: usize| {
            *known[face.vertices[corner]].get_or_insert_with(|| {
                let Fragment { point, normal, .. } = corners[corner];
                lighting.intensity(point.to_array(), normal.to_array())
            })
        };
        match Expansion::new(lighting, &corners, places) {
            Some(expansion) if expansion.is_near(&mut at_vertex) => {
                expansion.draw(mesh, face, canvas);
            }
            _ => canvas.each(mesh, face, corners, |pixel, at| {
                let normal = super::phong::normal(&at);
                *pixel = Some(lighting.at(at.point.to_array(), normal.to_array()));
            }),
        }
    }
}

/// Body and gloss over a face about its middle, in pixels.
struct Expansion {
    middle: DVec2,
    places: [DVec2; 3],
    body: Taylor,
    gloss: Taylor,
}

impl Expansion {
    /// None for faces so small that it would not pay.
    fn new(lighting: &Lighting, corners: &[Fragment; 3], places: [DVec2; 3]) -> Option<Self> {
        let (u, v) = (places[1] - places[0], places[2] - places[0]);
        let area = u.perp_dot(v);
        if area.abs() < 2.0 * FEWEST_PIXELS {
            return None;
        }
        let middle = (places[0] + places[1] + places[2]) / 3.0;
        // What has the corners' values a, b and c is linear: A x + B y + C.
        let linear = |of: fn(&Fragment) -> DVec3| {
            let [a, b, c] = [of(&corners[0]), of(&corners[1]), of(&corners[2])];
            let along_x = ((b - a) * v.y - (c - a) * u.y) / area;
            let along_y = ((c - a) * u.x - (b - a) * v.x) / area;
            let at = (a + b + c) / 3.0;
            [0, 1, 2].map(|i| Taylor::linear(at[i], along_x[i], along_y[i]))
        };
        let normal = linear(|corner| corner.normal);
        let square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
        if square.value() <= 0.0 {
            return None;
        }
        let inverse = square.inverse_root();
        let unit = normal.map(|coordinate| coordinate * inverse);
        let (body, gloss) = lighting.intensity(linear(|corner| corner.point), unit);
        Some(Self {
            middle,
            places,
            body,
            gloss,
        })
    }

    fn is_near(&self, at_vertex: &mut impl FnMut(usize) -> (f64, f64)) -> bool {
        (0..3).all(|corner| {
            let at = self.places[corner] - self.middle;
            let (body, gloss) = at_vertex(corner);
            let error =
                (self.body.at(at.x, at.y) - body).abs() + (self.gloss.at(at.x, at.y) - gloss).abs();
            255.0 * error <= LEVELS
        })
    }

    fn draw(&self, mesh: &RimMesh, face: &RimFace, canvas: &mut Canvas) {
        canvas.runs(mesh, face, [0.0; 3], |run, skipped, pixels| {
            let first = DVec2::new(run.columns.start as f64, run.row as f64) + 0.5 - self.middle;
            let [mut body, mut gloss] =
                [&self.body, &self.gloss].map(|expansion| Differences::new(expansion, first));
            for _ in 0..skipped {
                body.step();
                gloss.step();
            }
            for pixel in pixels {
                *pixel = Some(Intensity::new((body.value, gloss.value)));
                body.step();
                gloss.step();
            }
        });
    }
}

/// A parabola along a scan line by its differences.
struct Differences {
    value: f64,
    first: f64,
    second: f64,
}

impl Differences {
    fn new(expansion: &Taylor, at: DVec2) -> Self {
        let [_, cx, _, cxx, cxy, _] = expansion.0;
        Self {
            value: expansion.at(at.x, at.y),
            first: cx + cxx * (2.0 * at.x + 1.0) + cxy * at.y,
            second: 2.0 * cxx,
        }
    }

    fn step(&mut self) {
        self.value += self.first;
        self.first += self.second;
    }
}
