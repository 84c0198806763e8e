//! Surface finish: rims that catch the light which casts the shadows, and detail on what is flat.

mod analytic;
mod illumination;
mod mesh;
mod number;
mod rim;
mod shading;

pub use self::analytic::RimSurface;
pub use self::illumination::{Intensity, Lighting, Material};
pub use self::mesh::{RimFace, RimMesh, RimVertex};
pub use self::rim::{Profile, Rim};
pub use self::shading::{
    Canvas, CurvatureDriven, FastPhong, Flat, Gouraud, Phong, Shading, ShadingModel, normals,
};
