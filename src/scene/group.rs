//! Groups: surfaces that rise together and are clipped together.

use super::Surface;
use crate::error::{self, Error, Result};
use crate::shape::Shape;

/// Groups may not be nested deeper than this.
pub(super) const MAX_DEPTH: usize = 64;

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

    /// Gives `take` all surfaces that are left of the group, raised by all groups that they are in.
    pub(super) fn flatten(
        &self,
        depth: usize,
        height: f32,
        clips: &mut Vec<Shape>,
        take: &mut impl FnMut(Surface) -> Result<()>,
    ) -> Result<()> {
        if depth >= MAX_DEPTH {
            return Err(Error::TooMany {
                field: "groups within groups",
                count: depth + 1,
                limit: MAX_DEPTH,
            });
        }
        let height = height + self.elevation;
        clips.extend(self.clip.clone());
        for member in &self.members {
            match member {
                Member::Group(group) => group.flatten(depth + 1, height, clips, take)?,
                Member::Surface(surface) => {
                    let mut left = Some(surface.clone().raised(height));
                    for clip in &*clips {
                        left = match left {
                            Some(surface) => surface.clipped(clip)?,
                            None => None,
                        };
                    }
                    if let Some(surface) = left {
                        take(surface)?;
                    }
                }
            }
        }
        if self.clip.is_some() {
            clips.pop();
        }
        Ok(())
    }
}
