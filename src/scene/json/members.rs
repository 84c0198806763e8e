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
use crate::scene::group::MAX_DEPTH;
use crate::scene::{Group, Surface};

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

/// Reads surfaces and groups of a scene.
pub(super) struct Members<'i> {
    limits: &'i Limits,
    /// How many there were, and the vertices of all.
    count: usize,
    vertices: usize,
    images: &'i mut Images<'i>,
}

pub(super) enum Member {
    Surface(Surface),
    Group(Group),
}

impl<'i> Members<'i> {
    pub(super) fn new(limits: &'i Limits, images: &'i mut Images<'i>) -> Self {
        Self {
            limits,
            count: 0,
            vertices: 0,
            images,
        }
    }

    pub(super) fn read(&mut self, part: Part<'_>, field: &str, depth: usize) -> Result<Member> {
        self.count += 1;
        at_most("surfaces", self.count, self.limits.surfaces)
            .map_err(|error| part.refuse(field, &error))?;
        if depth > MAX_DEPTH {
            return Err(part.refuse(field, &format!("groups are read {MAX_DEPTH} deep")));
        }
        let is_group = part.is_object() && part.read::<MaybeGroup>(field)?.group.is_some();
        if !is_group {
            let fields: SurfaceFields = part.read_object(field)?;
            let built = fields
                .build(self.images)
                .map_err(|reason| part.refuse(field, &reason))?;
            self.vertices += built.shape().vertices();
            at_most("vertices", self.vertices, self.limits.vertices)
                .map_err(|error| part.refuse(field, &error))?;
            return Ok(Member::Surface(built));
        }
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
        for (index, raw) in fields.group.into_iter().enumerate() {
            let field = format!("{field}.group[{index}]");
            match self.read(part.within(raw), &field, depth + 1)? {
                Member::Surface(surface) => group.push(surface),
                Member::Group(inner) => group.push_group(inner),
            }
        }
        Ok(Member::Group(group))
    }
}
