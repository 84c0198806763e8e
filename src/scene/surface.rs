//! Surfaces: what a scene is made of.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::apart::around_points;
use crate::error::{Error, Result};
#[cfg(feature = "finish")]
use crate::finish::Finish;
use crate::image::{Image, Place};
use crate::light::Projection;
use crate::pose::Pose;
use crate::shadow::Shadow;
use crate::shape::Shape;
use crate::tone::Color;

/// A flat shape over the ground: it casts shadows on what is below, and receives them from what is above unless it is tilted.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    shape: Shape,
    elevation: f32,
    form: Form,
    opacity: f32,
    fill: Color,
    casts: bool,
    name: Option<String>,
    #[cfg(feature = "finish")]
    look: Option<Look>,
}

/// A surface's finish.
#[cfg(feature = "finish")]
#[derive(Debug, Clone, PartialEq)]
struct Look {
    finish: Arc<Finish>,
    /// What the rim goes round, where not all of it is left.
    whole: Option<Shape>,
}

/// How a surface lies, and what it is made of.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Form {
    /// Parallel to the ground.
    Level,
    /// Tilted.
    Posed(Pose),
    /// Parallel to the ground, and transparent where an image is.
    Image(Arc<Image>, Place),
}

impl Surface {
    /// An opaque white surface; its elevation above the ground is in scene units.
    #[must_use]
    pub fn new(shape: Shape, elevation: f32) -> Self {
        Self {
            shape,
            elevation,
            form: Form::Level,
            opacity: 1.0,
            fill: Color::WHITE,
            casts: true,
            name: None,
            #[cfg(feature = "finish")]
            look: None,
        }
    }

    /// An opaque white surface in a pose of its own. It is painted as it is seen from above, in the order of its middle's elevation;
    /// what of it is below the ground is not there. No shadow falls on it.
    #[must_use]
    pub fn posed(shape: Shape, pose: &Pose) -> Self {
        let middle = shape
            .hull()
            .map_or(DVec2::ZERO, |(min, max)| (min + max) / 2.0);
        Self {
            elevation: pose.place(middle).z as f32,
            form: Form::Posed(*pose),
            ..Self::new(shape, 0.0)
        }
    }

    /// An image over the rectangle `rect` (x, y, width, height; scene units) at an elevation. It is painted in its own colours and
    /// casts by its own alpha.
    ///
    /// # Errors
    /// As [`Shape::rect`].
    pub fn image(image: Arc<Image>, rect: [f32; 4], elevation: f32) -> Result<Self> {
        let [x, y, width, height] = rect;
        Ok(Self {
            form: Form::Image(image, Place::new(rect)?),
            ..Self::new(Shape::rect(x, y, width, height)?, elevation)
        })
    }

    /// The same with another fill.
    #[must_use]
    pub fn with_fill(mut self, fill: Color) -> Self {
        self.fill = fill;
        self
    }

    /// The same with another opacity, 0 to 1; it multiplies the fill's own.
    #[must_use]
    pub fn with_opacity(mut self, opacity: f32) -> Self {
        self.opacity = opacity;
        self
    }

    /// The same without a shadow, as of a scrim: what covers all that is below it would darken that twice, and lighten it about the
    /// edges of the picture, which its shadow ends at.
    #[must_use]
    pub fn without_shadow(mut self) -> Self {
        self.casts = false;
        self
    }

    /// The same with a name, for messages.
    #[must_use]
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.name = Some(name.into());
        self
    }

    /// The same with a finish. Where a clip cuts the surface there is no rim.
    #[cfg(feature = "finish")]
    #[must_use]
    pub fn with_finish(mut self, finish: Finish) -> Self {
        self.look = Some(Look {
            finish: Arc::new(finish),
            whole: None,
        });
        self
    }

    /// The finish, if it has one.
    #[cfg(feature = "finish")]
    #[must_use]
    pub fn finish(&self) -> Option<&Finish> {
        self.look.as_ref().map(|look| look.finish.as_ref())
    }

    /// What a rim goes round: the shape before it was clipped.
    #[cfg(all(feature = "finish", feature = "raster"))]
    pub(crate) fn rimmed(&self) -> &Shape {
        let whole = self.look.as_ref().and_then(|look| look.whole.as_ref());
        whole.unwrap_or(&self.shape)
    }

    /// The part of the surface inside a clip, or none: it casts what it shows.
    ///
    /// # Errors
    /// [`Error::NotClipped`] for tilted surfaces and images, and as [`Shape::clipped`].
    pub fn clipped(&self, clip: &Shape) -> Result<Option<Self>> {
        if !matches!(self.form, Form::Level) {
            return Err(Error::NotClipped);
        }
        let shape = self.shape.clipped(clip)?;
        Ok(shape.map(|shape| {
            #[cfg_attr(
                not(feature = "finish"),
                expect(unused_mut, reason = "a finish keeps the whole")
            )]
            let mut part = Self {
                shape,
                ..self.clone()
            };
            #[cfg(feature = "finish")]
            if let Some(look) = &mut part.look {
                look.whole.get_or_insert_with(|| self.shape.clone());
            }
            part
        }))
    }

    /// The same, higher by `height` (scene units).
    #[must_use]
    pub fn raised(mut self, height: f32) -> Self {
        self.elevation += height;
        if let Form::Posed(pose) = &mut self.form {
            *pose = pose.raised(f64::from(height));
        }
        self
    }

    /// The shape, on its own plane.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The elevation above the ground, scene units: of a tilted surface its middle's.
    #[must_use]
    pub fn elevation(&self) -> f32 {
        self.elevation
    }

    /// How the shape's plane lies, if the surface is tilted.
    #[must_use]
    pub fn pose(&self) -> Option<&Pose> {
        match &self.form {
            Form::Posed(pose) => Some(pose),
            Form::Level | Form::Image(..) => None,
        }
    }

    /// The image that the surface is, if it is one.
    #[must_use]
    pub fn as_image(&self) -> Option<&Image> {
        match &self.form {
            Form::Image(image, _) => Some(image),
            Form::Level | Form::Posed(_) => None,
        }
    }

    /// The fill; its alpha and the opacity multiply.
    #[must_use]
    pub fn fill(&self) -> Color {
        self.fill
    }

    /// The name, if it has one.
    #[must_use]
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// How much of what is behind it the surface hides, and of the light: opacity times the fill's alpha, 0 to 1. Of an image,
    /// where it is opaque.
    #[must_use]
    pub fn weight(&self) -> f32 {
        self.opacity * f32::from(self.fill.a) / 255.0
    }

    /// Whether it casts a shadow: not one [`without`](Self::without_shadow), nor what is wholly transparent.
    #[must_use]
    pub fn casts(&self) -> bool {
        self.casts && self.weight() > 0.0
    }

    /// Whether nothing is seen through it.
    #[must_use]
    pub fn is_opaque(&self) -> bool {
        self.weight() >= 1.0 && !matches!(self.form, Form::Image(..))
    }

    /// Whether it casts one shadow with others of its elevation.
    pub(crate) fn is_united(&self) -> bool {
        self.is_opaque() && matches!(self.form, Form::Level)
    }

    pub(crate) fn opacity(&self) -> f32 {
        self.opacity
    }

    pub(crate) fn form(&self) -> &Form {
        &self.form
    }

    /// Whether shadows fall on it: on tilted surfaces none do.
    pub(crate) fn receives(&self) -> bool {
        !matches!(self.form, Form::Posed(_))
    }

    /// The box of the surface as it is seen from above, scene units.
    pub(crate) fn hull(&self) -> Option<(DVec2, DVec2)> {
        around_points(self.corners()?.map(DVec3::truncate))
    }

    /// The elevation of its highest corner.
    pub(crate) fn highest(&self) -> f64 {
        let corners = self.corners().into_iter().flatten();
        corners.map(|corner| corner.z).fold(f64::MIN, f64::max)
    }

    /// Where the corners of a box round the shape are.
    pub(crate) fn corners(&self) -> Option<[DVec3; 4]> {
        let (min, max) = self.shape.hull()?;
        let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
        Some(corners.map(|corner| match &self.form {
            Form::Posed(pose) => pose.place(corner),
            Form::Level | Form::Image(..) => corner.extend(f64::from(self.elevation)),
        }))
    }

    /// The surface's own coverage as it is seen from above: its hard shadow on itself.
    pub(crate) fn cover(&self) -> Shadow {
        match &self.form {
            Form::Posed(pose) => pose.cover(&self.shape),
            Form::Level | Form::Image(..) => {
                Shadow::project(&[self.shape()], &Projection::in_place(0.0))
            }
        }
    }
}
