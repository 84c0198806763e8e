//! Surfaces, and groups of them.

use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::value::RawValue;

use super::Images;
use super::optional::some;
use super::part::Part;
use super::surface::SurfaceFields;
use crate::error::Result;
use crate::limits::{Limits, at_most};
use crate::scene::group::Nest;
use crate::scene::{Group, Scene};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GroupFields<'a> {
    #[serde(borrow)]
    group: Vec<&'a RawValue>,
    elevation: f32,
    #[serde(borrow, default, deserialize_with = "some")]
    clip: Option<&'a RawValue>,
}

/// What tells a group from a surface.
#[derive(Deserialize)]
struct MaybeGroup {
    #[serde(default)]
    group: Option<IgnoredAny>,
}

/// Reads surfaces and groups, and puts what is left of them on a scene: what is wrong with one is told where it is, not where
/// its group is.
pub(super) struct Members<'i> {
    scene: &'i mut Scene,
    limits: &'i Limits,
    /// How many there were, and the vertices of all.
    count: usize,
    vertices: usize,
    images: &'i mut Images<'i>,
}

impl<'i> Members<'i> {
    pub(super) fn new(
        scene: &'i mut Scene,
        limits: &'i Limits,
        images: &'i mut Images<'i>,
    ) -> Self {
        Self {
            scene,
            limits,
            count: 0,
            vertices: 0,
            images,
        }
    }

    /// Reads a surface or a group in those `around` it.
    pub(super) fn read(
        &mut self,
        part: Part<'_>,
        field: &str,
        around: Option<&Nest<'_>>,
    ) -> Result<()> {
        self.count += 1;
        at_most("surfaces", self.count, self.limits.surfaces)
            .map_err(|error| part.refuse(field, &error))?;
        if part.is_object() && part.read::<MaybeGroup>(field)?.group.is_some() {
            self.read_group(part, field, around)
        } else {
            self.read_surface(part, field, around)
        }
    }

    fn read_surface(
        &mut self,
        part: Part<'_>,
        field: &str,
        around: Option<&Nest<'_>>,
    ) -> Result<()> {
        let fields: SurfaceFields = part.read_object(field)?;
        let surface = fields
            .build(self.images)
            .map_err(|reason| part.refuse(field, &reason))?;
        let whole = surface.shape().vertices();
        self.take(whole)
            .map_err(|error| part.refuse(field, &error))?;
        let left = match around {
            Some(nest) => nest.place(surface),
            None => Ok(Some(surface)),
        };
        let pushed = left.and_then(|left| {
            if let Some(left) = left {
                // Where a curve was cut it is lines.
                self.take(left.shape().vertices().saturating_sub(whole))?;
                self.scene.push(left)?;
                self.scene.surface_fields.push(field.to_owned());
            }
            Ok(())
        });
        pushed.map_err(|error| match around {
            // The elevation that is told is a sum, which no file shows.
            Some(nest) if error.is_of_elevation() => {
                let height = nest.height();
                part.refuse(field, &format!("{error}; its groups raise it by {height}"))
            }
            _ => part.refuse(field, &error),
        })
    }

    /// Counts vertices, if so many more may be.
    fn take(&mut self, vertices: usize) -> Result<()> {
        self.vertices += vertices;
        at_most("vertices", self.vertices, self.limits.vertices)
    }

    fn read_group(&mut self, part: Part<'_>, field: &str, around: Option<&Nest<'_>>) -> Result<()> {
        let fields: GroupFields<'_> = part.read_object(field)?;
        let mut group = Group::new(fields.elevation).map_err(|error| {
            let error = error.renamed(&[["group elevation", "elevation"]]);
            part.refuse(field, &error)
        })?;
        if let Some(clip) = fields.clip.map(|raw| part.within(raw)) {
            let field = format!("{field}.clip");
            let shape = clip.read_object::<SurfaceFields>(&field)?.build_clip();
            group = group.with_clip(shape.map_err(|reason| clip.refuse(&field, &reason))?);
        }
        let nest = Nest::new(&group, around).map_err(|error| part.refuse(field, &error))?;
        for (index, raw) in fields.group.into_iter().enumerate() {
            let field = format!("{field}.group[{index}]");
            self.read(part.within(raw), &field, Some(&nest))?;
        }
        Ok(())
    }
}
