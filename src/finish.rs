//! Surface finish: rims that catch the light which casts the shadows, and detail on what is flat.
//!
//! Coordinates are those of scenes, with z up from the surface's own plane towards the viewer, who is far above. A rim is the
//! surface whose height depends on the distance from the outline ([`RimSurface`]); it is drawn as a mesh ([`RimMesh`]) by one of five
//! models ([`ShadingModel`]). The flat part inside may have a texture, bumps, fibres and something to mirror.
//!
//! | file | what it holds |
//! |---|---|
//! | `rim.rs`, `analytic.rs`, `mesh.rs` | [`Rim`], the surface itself, and as triangles with normals and curvature factors |
//! | `illumination.rs`, `number.rs` | [`Material`], [`Lighting`]: how bright a point is; with Taylor expansions as well as with numbers |
//! | `shading.rs`, `shading/` | [`ShadingModel`] and [`Canvas`]: a model a file |
//! | `tile.rs`, `detail.rs` | [`Tile`]: images averaged over pixels; [`Bump`], [`Frame`], [`Environment`] |
//! | `draw.rs` | a surface's finish as colours |
//!
//! Curvature-driven shading follows US 2016/0049001; the other models do not use it.

mod analytic;
pub(crate) mod detail;
#[cfg(feature = "raster")]
mod draw;
mod illumination;
mod mesh;
mod number;
mod rim;
mod shading;
mod tile;

pub use self::analytic::RimSurface;
use self::detail::Detail;
pub use self::detail::{Bump, Environment, Frame};
#[cfg(feature = "raster")]
pub(crate) use self::draw::Finished;
pub use self::illumination::{Intensity, Lighting, Material};
pub use self::mesh::{RimFace, RimMesh, RimVertex};
pub use self::rim::{Rim, RimProfile};
pub use self::shading::{Canvas, ShadingModel, normals};
pub use self::tile::{MAX_TEXELS, Tile};

/// How a surface looks in its scene's light: all of it is lit then, the flat part as well.
///
/// ```
/// use penumbral::finish::{Finish, Rim, RimProfile};
/// use penumbral::{Color, Light, Scene, Shape, Surface};
///
/// let finish = Finish::new().with_rim(Rim::new(6.0, 6.0, RimProfile::QuarterRound)?);
/// let button = Shape::rounded_rect(20.0, 20.0, 80.0, 40.0, 12.0)?;
/// let surface = Surface::new(button, 4.0).with_fill(Color::rgb(60, 120, 200));
/// let mut scene = Scene::new([120.0, 80.0], Light::new([0.0, -100.0, 300.0], 40.0)?)?;
/// scene.push(surface.with_finish(finish))?;
/// # Ok::<(), penumbral::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Finish {
    rim: Option<Rim>,
    shading: ShadingModel,
    material: Material,
    detail: Detail,
}

impl Finish {
    /// Light on a flat surface without detail.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The same with a rim.
    #[must_use]
    pub fn with_rim(mut self, rim: Rim) -> Self {
        self.rim = Some(rim);
        self
    }

    /// The same with another model to shade the rim by.
    #[must_use]
    pub fn with_shading(mut self, shading: ShadingModel) -> Self {
        self.shading = shading;
        self
    }

    /// The same of another material.
    #[must_use]
    pub fn with_material(mut self, material: Material) -> Self {
        self.material = material;
        self
    }

    /// The same with a texture over the fill: each pixel takes its texels by the area that they have in it.
    #[must_use]
    pub fn with_texture(mut self, texture: Tile) -> Self {
        self.detail.texture = Some(texture);
        self
    }

    /// The same with bumps.
    #[must_use]
    pub fn with_bump(mut self, bump: Bump) -> Self {
        self.detail.bump = Some(bump);
        self
    }

    /// The same of brushed metal.
    #[must_use]
    pub fn with_frame(mut self, frame: Frame) -> Self {
        self.detail.frame = Some(frame);
        self
    }

    /// The same with something to mirror.
    #[must_use]
    pub fn with_environment(mut self, environment: Environment) -> Self {
        self.detail.environment = Some(environment);
        self
    }

    /// The rim, if there is one.
    #[must_use]
    pub fn rim(&self) -> Option<&Rim> {
        self.rim.as_ref()
    }

    /// The model that the rim is shaded by.
    #[must_use]
    pub fn shading(&self) -> ShadingModel {
        self.shading
    }

    /// The material.
    #[must_use]
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// The colour of a pixel of the flat part: red, green and blue of the fill there, its middle and its side (scene units).
    #[must_use]
    pub fn flat_color(
        &self,
        fill: [u8; 3],
        middle: [f64; 2],
        side: f64,
        lighting: &Lighting,
    ) -> [u8; 3] {
        self.detail.color(fill, middle.into(), side, lighting)
    }
}
