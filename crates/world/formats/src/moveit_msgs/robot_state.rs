//! The state of the robot: joint values, pose of its base, attached objects.

use std::collections::HashSet;

use elbowroom_spatial::Pose;

use super::field::{Field, Reading};
use super::types::{AttachedObject, JointValue};
use super::{object, pose};
use crate::Diagnostic;

/// Rotations (rad) and translations (m) up to this count as zero.
const IDENTITY_TOLERANCE: f64 = 1e-9;

/// The state of the robot, as far as the file has it.
#[derive(Debug, Default)]
pub(crate) struct RobotState {
    pub(crate) joints: Vec<JointValue>,
    pub(crate) base_in_world: Option<Pose>,
    pub(crate) attached: Vec<AttachedObject>,
}

impl RobotState {
    /// Overrides this state with the values of another state.
    pub(crate) fn overlay(&mut self, other: Self) {
        let given: HashSet<String> = other.joints.iter().map(|j| j.joint.clone()).collect();
        self.joints.retain(|j| !given.contains(&j.joint));
        self.joints.extend(other.joints);
        self.base_in_world = other.base_in_world.or(self.base_in_world);
        let given: HashSet<String> = other.attached.iter().map(|a| a.object.id.clone()).collect();
        self.attached.retain(|a| !given.contains(&a.object.id));
        self.attached.extend(other.attached);
    }
}

pub(crate) fn parse(field: &Field<'_>, reading: &mut Reading) -> Result<RobotState, Diagnostic> {
    let joints = field.get("joint_state")?.map_or(Ok(Vec::new()), |f| joint_values(&f, ["name", "position"]))?;
    let base_in_world = match field.get("multi_dof_joint_state")? {
        Some(joints) => base(&joints)?,
        None => None,
    };
    let attached = field.list("attached_collision_objects")?;
    let attached = attached.iter().map(|f| object::attached(f, reading)).collect::<Result<_, _>>()?;
    Ok(RobotState { joints, base_in_world, attached })
}

/// Names and values of joints, each joint once.
fn joint_values(field: &Field<'_>, keys: [&str; 2]) -> Result<Vec<JointValue>, Diagnostic> {
    let mut values = Vec::new();
    let mut known = HashSet::new();
    for (name, value) in field.paired_lists(keys)? {
        if !known.insert(name.name()?) {
            return Err(name.error(format!("names {} a second time", name.shown()), "each joint once"));
        }
        values.push(JointValue { joint: name.name()?.to_owned(), value: value.joint_value()? });
    }
    Ok(values)
}

/// The pose of the base: the pose of the joint that moves it. `None` if all joints are at rest.
fn base(field: &Field<'_>) -> Result<Option<Pose>, Diagnostic> {
    let mut moved = None;
    for (_, transform) in field.paired_lists(["joint_names", "transforms"])? {
        let pose = pose::transform(&transform)?;
        let is_identity =
            pose.rotation.angle() <= IDENTITY_TOLERANCE && pose.translation.length() <= IDENTITY_TOLERANCE;
        if is_identity {
            continue;
        }
        if moved.replace(pose).is_some() {
            return Err(field.error("moves the robot by two joints", "one joint: that of the base in the world"));
        }
    }
    Ok(moved)
}
