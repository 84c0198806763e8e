//! Shading models: what brightness the pixels of a rim's triangles get.

mod curvature;
mod fast_phong;
mod flat;
mod gouraud;
mod phong;

use core::ops::{Add, Div, Mul, Range, Sub};

use glam::{DVec2, DVec3};

use super::{Intensity, Lighting, RimFace, RimMesh};
use crate::grid::Grid;
use crate::scan::{Corner, Run, Value, scan_convert};

/// A way to shade a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum ShadingModel {
    /// One intensity a face, that of its middle: curved surfaces look faceted.
    Flat,
    /// Intensities interpolated between vertices. It cannot find a highlight inside of a face, and where intensity bends at an edge
    /// the eye sees a band (Mach 1865).
    Gouraud,
    /// Normals interpolated between vertices: round wherever vertices have one normal for all of their faces, at creases as well.
    Phong,
    /// Phong's intensities by a Taylor expansion over each face: within a level of Phong's at its corners, or Phong's own where the
    /// expansion is not.
    FastPhong,
    /// Phong's illumination with the interpolated vertex normal and the face's own blended by the interpolated curvature factor, so
    /// that in one mesh a round corner stays round and a sharp one sharp.
    #[default]
    CurvatureDriven,
}

impl ShadingModel {
    /// All of them.
    pub const ALL: &'static [Self] = &[
        Self::Flat,
        Self::Gouraud,
        Self::Phong,
        Self::FastPhong,
        Self::CurvatureDriven,
    ];

    /// Its name, as scenes give it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Flat => "flat",
            Self::Gouraud => "gouraud",
            Self::Phong => "phong",
            Self::FastPhong => "fast-phong",
            Self::CurvatureDriven => "curvature",
        }
    }
}

/// Pixels that meshes are shaded on.
#[derive(Debug, Clone)]
pub struct Canvas<P = Intensity> {
    columns: Range<i64>,
    rows: Range<i64>,
    /// Where pixel 0, 0 begins, in pixels from the scene's origin.
    corner: DVec2,
    pixels_per_unit: f64,
    pixels: Vec<Option<P>>,
}

/// From which column on runs are followed at least: one that begins left of what is drawn gets the same bits on any part of the
/// picture. No canvas of a picture reaches farther left.
const FIRST_COLUMN: i64 = -16;

impl<P: Clone> Canvas<P> {
    /// A canvas of a grid's pixels, none of them shaded.
    #[must_use]
    pub fn new(grid: &Grid) -> Self {
        Self::within(grid, 1, 0)
    }

    /// A canvas of so many pixels along each of a grid's, and a margin of some of the grid's on every side.
    pub(super) fn within(grid: &Grid, finer: u32, margin: u32) -> Self {
        let whole = grid.corner().floor();
        let (finer, margin) = (i64::from(finer), i64::from(margin));
        let side = |first: f64, count: u32| {
            let first = first as i64;
            finer * (first - margin)..finer * (first + i64::from(count) + margin)
        };
        let (columns, rows) = (side(whole.x, grid.width()), side(whole.y, grid.height()));
        let count = (columns.end - columns.start) * (rows.end - rows.start);
        Self {
            columns,
            rows,
            corner: (grid.corner() - whole) * finer as f64,
            pixels_per_unit: grid.pixels_per_unit() * finer as f64,
            pixels: vec![None; count as usize],
        }
    }

    /// The pixels, row by row: none where the mesh is not.
    #[must_use]
    pub fn pixels(&self) -> &[Option<P>] {
        &self.pixels
    }

    /// A position in pixels.
    fn place(&self, position: [f64; 3]) -> DVec2 {
        DVec2::new(position[0], position[1]) * self.pixels_per_unit - self.corner
    }

    /// Gives `put` the runs of a face whose corners have values: how many of a run's pixels are left of the canvas, and the others.
    fn runs<T: Value>(
        &mut self,
        mesh: &RimMesh,
        face: &RimFace,
        values: [T; 3],
        mut put: impl FnMut(&Run<T>, i64, &mut [Option<P>]),
    ) {
        let corners = [0, 1, 2].map(|i| Corner {
            at: self.place(mesh.vertices()[face.vertices[i]].position),
            value: values[i],
        });
        let left = self.columns.start;
        let followed = left.min(FIRST_COLUMN)..self.columns.end;
        scan_convert(corners, &followed, &self.rows, |run| {
            let start = run.columns.start.max(left);
            if start < run.columns.end {
                let row = (run.row - self.rows.start) * (self.columns.end - left) - left;
                let (first, end) = ((row + start) as usize, (row + run.columns.end) as usize);
                put(
                    &run,
                    start - run.columns.start,
                    &mut self.pixels[first..end],
                );
            }
        });
    }

    /// Steps through the pixels of a face by additions alone: `put` gets each pixel and its value.
    fn each<T: Value>(
        &mut self,
        mesh: &RimMesh,
        face: &RimFace,
        values: [T; 3],
        mut put: impl FnMut(&mut Option<P>, T),
    ) {
        self.runs(mesh, face, values, |run, skipped, pixels| {
            let mut value = run.first;
            for _ in 0..skipped {
                value = value + run.step;
            }
            for pixel in pixels {
                put(pixel, value);
                value = value + run.step;
            }
        });
    }
}

impl Canvas {
    /// Shades the pixels whose centres a mesh covers, and no others.
    pub fn draw(&mut self, mesh: &RimMesh, lighting: &Lighting, model: ShadingModel) {
        self.pixels.fill(None);
        match model {
            ShadingModel::Flat => flat::draw(mesh, lighting, self),
            ShadingModel::Gouraud => gouraud::draw(mesh, lighting, self),
            ShadingModel::Phong => phong::draw(mesh, lighting, self),
            ShadingModel::FastPhong => fast_phong::draw(mesh, lighting, self),
            ShadingModel::CurvatureDriven => curvature::draw(mesh, lighting, self),
        }
    }
}

/// What is interpolated between a face's corners to find a normal: all of it linear.
#[derive(Debug, Clone, Copy)]
struct Fragment {
    point: DVec3,
    normal: DVec3,
    curvature: f64,
}

impl Fragment {
    fn corners(mesh: &RimMesh, face: &RimFace) -> [Self; 3] {
        face.vertices.map(|index| {
            let vertex = &mesh.vertices()[index];
            Self {
                point: DVec3::from(vertex.position),
                normal: DVec3::from(vertex.normal),
                curvature: vertex.curvature,
            }
        })
    }
}

impl Add for Fragment {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            point: self.point + other.point,
            normal: self.normal + other.normal,
            curvature: self.curvature + other.curvature,
        }
    }
}

impl Sub for Fragment {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}

impl Mul<f64> for Fragment {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            point: self.point * factor,
            normal: self.normal * factor,
            curvature: self.curvature * factor,
        }
    }
}

impl Div<f64> for Fragment {
    type Output = Self;

    fn div(self, divisor: f64) -> Self {
        self * (1.0 / divisor)
    }
}

/// The pixels' normals, of unit length, by which a model shades them; none where the mesh is not. Gouraud shading and the fast
/// Phong shading have those of Phong's.
#[must_use]
pub fn normals(grid: &Grid, mesh: &RimMesh, model: ShadingModel) -> Vec<Option<[f64; 3]>> {
    let mut canvas: Canvas<[f64; 3]> = Canvas::new(grid);
    for face in mesh.faces() {
        canvas.each(
            mesh,
            face,
            Fragment::corners(mesh, face),
            |pixel, fragment| {
                let normal = match model {
                    ShadingModel::Flat => DVec3::from(face.normal),
                    ShadingModel::CurvatureDriven => curvature::normal(&fragment, face),
                    _ => phong::normal(&fragment),
                };
                *pixel = Some(normal.to_array());
            },
        );
    }
    canvas.pixels
}
