//! Collision objects of the world and of the robot.

use std::collections::HashSet;

use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;

use super::field::{Field, Reading};
use super::types::{AttachedObject, CollisionObject};
use super::{pose, solid};
use crate::Diagnostic;

/// The objects of `scene.world`.
pub(crate) fn world(scene: &Field<'_>, reading: &mut Reading) -> Result<Vec<CollisionObject>, Diagnostic> {
    let Some(world) = scene.get("world")? else { return Ok(Vec::new()) };
    refuse_octomap(&world)?;
    world.list("collision_objects")?.iter().map(|field| object(field, reading)).collect()
}

/// Refuses an octomap with data: the reader ignores octomaps, so its obstacles would be missing.
fn refuse_octomap(world: &Field<'_>) -> Result<(), Diagnostic> {
    let Some(octomap) = world.get("octomap")?.map(|o| Ok(o.get("octomap")?.unwrap_or(o))).transpose()? else {
        return Ok(());
    };
    if octomap.list("data")?.is_empty() {
        return Ok(());
    }
    Err(octomap.error("has data, which are not read", "boxes or meshes in \"collision_objects\" instead"))
}

/// An object with its shapes in its frame.
fn object(field: &Field<'_>, reading: &mut Reading) -> Result<CollisionObject, Diagnostic> {
    let id = field.require("id", "\"id\": \"NAME\"")?.name()?.to_owned();
    if let Some(operation) = field.get("operation")?.filter(|o| !o.is("add", 0)) {
        let what = format!("is {}: only objects that are added are read", operation.shown());
        return Err(operation.error(what, "\"add\", and no entry for an object that is removed"));
    }
    let own = field.get("pose")?;
    let in_frame = own.as_ref().map_or(Ok(Pose::IDENTITY), pose::pose)?;
    let mut solids = Vec::new();
    for (shape, at) in posed(field, ["primitives", "primitive_poses"], own.is_some())? {
        solids.push((solid::primitive(&shape, reading)?, at));
    }
    for (shape, at) in posed(field, ["meshes", "mesh_poses"], own.is_some())? {
        solids.push((solid::mesh(&shape, reading)?, at));
    }
    for (shape, at) in posed(field, ["planes", "plane_poses"], true)? {
        let (shape, in_object): (Shape, Pose) = solid::plane(&shape)?;
        solids.push((shape, at * in_object));
    }
    for (_, at) in &mut solids {
        *at = in_frame * *at;
    }
    if solids.is_empty() {
        let hint = "\"primitives\": [{\"type\": \"box\", \"dimensions\": [x, y, z]}], and \"primitive_poses\"";
        return Err(field.error(format!("`{id}` has no shape"), hint));
    }
    Ok(CollisionObject { id, frame: pose::frame_id(field)?, solids })
}

/// Shapes with their poses. Shapes without poses have the pose of the object, if it `has_own`.
fn posed<'a>(field: &Field<'a>, keys: [&str; 2], has_own: bool) -> Result<Vec<(Field<'a>, Pose)>, Diagnostic> {
    if has_own && field.list(keys[1])?.is_empty() {
        return Ok(field.list(keys[0])?.into_iter().map(|shape| (shape, Pose::IDENTITY)).collect());
    }
    let pairs = field.paired_lists(keys)?.into_iter();
    pairs.map(|(shape, at)| Ok((shape, pose::pose(&at)?))).collect()
}

/// An object that a link carries.
pub(crate) fn attached(field: &Field<'_>, reading: &mut Reading) -> Result<AttachedObject, Diagnostic> {
    let link = field.require("link_name", "\"link_name\": the link that carries the object")?.name()?.to_owned();
    let mut object = object(&field.require("object", "\"object\": {\"id\": …}")?, reading)?;
    if object.frame.is_empty() {
        object.frame.clone_from(&link);
    }
    Ok(AttachedObject { object, link, touch_links: field.names("touch_links")? })
}

/// Refuses two objects with the same name.
pub(crate) fn check_ids(
    root: &Field<'_>,
    objects: &[CollisionObject],
    attached: &[AttachedObject],
) -> Result<(), Diagnostic> {
    let attached = attached.iter().map(|a| &a.object);
    match duplicate(objects.iter().chain(attached)) {
        Some(id) => Err(root.error(format!("has two objects `{id}`"), "a name of its own for each object")),
        None => Ok(()),
    }
}

/// The first name that two objects share.
pub(crate) fn duplicate<'o>(mut objects: impl Iterator<Item = &'o CollisionObject>) -> Option<&'o str> {
    let mut known = HashSet::new();
    objects.find(|o| !known.insert(o.id.as_str())).map(|o| o.id.as_str())
}
