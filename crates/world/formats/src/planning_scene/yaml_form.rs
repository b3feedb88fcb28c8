//! The message `moveit_msgs/PlanningScene` as YAML.

use std::path::Path;

use super::scene::PlanningScene;
use crate::moveit_msgs::field::{Field, Location, Reading};
use crate::moveit_msgs::{collision_matrix, object, pose, robot_state};
use crate::{Diagnostic, yaml};

/// The layout, for messages.
const LAYOUT: &str =
    "world: {collision_objects: [{id: table, primitives: [{type: box, dimensions: [x, y, z]}], primitive_poses: …}]}";

pub(super) fn parse(text: &str, file: &Path) -> Result<PlanningScene, Diagnostic> {
    let document = yaml::parse(text, file)?;
    let location = Location { file, part: String::new(), yaml: Some(text), yaml_path: String::new() };
    let root = Field::root(&location, &document);
    if !document.is_object() {
        return Err(root.error("is no planning scene", LAYOUT));
    }
    // The response of the service `get_planning_scene` has the scene in a field.
    let root = root.get("scene")?.unwrap_or(root);
    if root.get("world")?.is_none() {
        return Err(root.error("has no `world`: it is no planning scene", LAYOUT));
    }
    let mut reading = Reading::default();
    let objects = object::world(&root, &mut reading)?;
    let state = root.get("robot_state")?.map(|state| robot_state::parse(&state, &mut reading)).transpose()?;
    let state = state.unwrap_or_default();
    object::check_ids(&root, &objects, &state.attached)?;
    Ok(PlanningScene {
        name: root.text_of("name")?.to_owned(),
        objects,
        frames: pose::fixed_frames(&root)?,
        attached: state.attached,
        allowed: collision_matrix::parse(&root, &mut reading)?,
        joints: state.joints,
        base_in_world: state.base_in_world,
        warnings: reading.warnings,
        ..PlanningScene::default()
    })
}
