//! Groups: surfaces that rise together and are clipped together.

use super::Surface;
use crate::error::{self, Result};
use crate::limits::at_most;
use crate::shape::Shape;

/// Groups may not be nested deeper than this.
const MAX_DEPTH: usize = 64;

/// Surfaces, and groups of them, that lie on a plane of their own: a member's elevation is over the group's, which is over that
/// of the group around it. A clip cuts away what of the members is outside: a list that scrolls behind its header casts no
/// shadow from there.
///
/// ```
/// use penumbral::{Group, Light, Scene, Shape, Surface};
///
/// let mut list = Group::new(2.0)?.with_clip(Shape::rect(0.0, 56.0, 360.0, 584.0)?);
/// list.push(Surface::new(Shape::rect(16.0, 20.0, 328.0, 80.0)?, 1.0));
/// let mut scene = Scene::new([360.0, 640.0], Light::android(360.0)?)?;
/// scene.push_group(&list)?;
/// assert_eq!(scene.surfaces()[0].elevation(), 3.0);
/// # Ok::<(), penumbral::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Group {
    elevation: f32,
    clip: Option<Shape>,
    members: Vec<Member>,
}

#[derive(Debug, Clone)]
enum Member {
    Surface(Surface),
    Group(Group),
}

impl Group {
    /// An empty group at an elevation over what it will be put on, scene units.
    ///
    /// # Errors
    /// An elevation that is not finite or passes [`MAX_COORDINATE`](crate::MAX_COORDINATE).
    pub fn new(elevation: f32) -> Result<Self> {
        error::coordinate("group elevation", f64::from(elevation))?;
        Ok(Self {
            elevation,
            clip: None,
            members: Vec::new(),
        })
    }

    /// The same with a clip, in the scene's own coordinates.
    #[must_use]
    pub fn with_clip(mut self, clip: Shape) -> Self {
        self.clip = Some(clip);
        self
    }

    /// Adds a surface.
    pub fn push(&mut self, surface: Surface) {
        self.members.push(Member::Surface(surface));
    }

    /// Adds a group.
    pub fn push_group(&mut self, group: Self) {
        self.members.push(Member::Group(group));
    }

    /// Gives `take` all surfaces that are left of the group in those `around` it.
    pub(super) fn flatten(
        &self,
        around: Option<&Nest<'_>>,
        take: &mut impl FnMut(Surface) -> Result<()>,
    ) -> Result<()> {
        let nest = Nest::new(self, around)?;
        for member in &self.members {
            match member {
                Member::Group(group) => group.flatten(Some(&nest), take)?,
                Member::Surface(surface) => {
                    if let Some(left) = nest.place(surface.clone())? {
                        take(left)?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// A group in the groups around it.
pub(super) struct Nest<'a> {
    around: Option<&'a Self>,
    clip: Option<&'a Shape>,
    depth: usize,
    height: f32,
}

impl<'a> Nest<'a> {
    /// # Errors
    /// Groups nested too deep.
    pub(super) fn new(group: &'a Group, around: Option<&'a Self>) -> Result<Self> {
        let (outer, height) = around.map_or((0, 0.0), |around| (around.depth, around.height));
        at_most("groups within groups", outer + 1, MAX_DEPTH)?;
        Ok(Self {
            around,
            clip: group.clip.as_ref(),
            depth: outer + 1,
            height: height + group.elevation,
        })
    }

    /// By how much all groups raise a member, scene units.
    #[cfg(feature = "scene")]
    pub(super) fn height(&self) -> f32 {
        self.height
    }

    /// What is left of a member, raised by all groups.
    pub(super) fn place(&self, member: Surface) -> Result<Option<Surface>> {
        self.clipped(member.raised(self.height))
    }

    fn clipped(&self, surface: Surface) -> Result<Option<Surface>> {
        let surface = match self.around {
            Some(around) => around.clipped(surface)?,
            None => Some(surface),
        };
        match (surface, self.clip) {
            (Some(surface), Some(clip)) => surface.clipped(clip),
            (surface, _) => Ok(surface),
        }
    }
}
