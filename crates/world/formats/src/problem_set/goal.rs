//! Goals of a request.

use std::collections::HashSet;

use crate::Diagnostic;
use crate::moveit_msgs::field::Field;
use crate::moveit_msgs::types::JointValue;

/// Constraints of a message on quantities other than joint values.
const OTHER_CONSTRAINTS: [&str; 3] = ["position_constraints", "orientation_constraints", "visibility_constraints"];
/// The layout of a goal, for messages.
const JOINTS: &str = "\"joint_constraints\": [{\"joint_name\": \"NAME\", \"position\": 0.5}, …]";

/// Reads the alternative goals of a request, each as joint values.
pub(super) fn goals(request: &Field<'_>) -> Result<Vec<Vec<JointValue>>, Diagnostic> {
    let goals = request.list("goal_constraints")?;
    if goals.is_empty() {
        let hint = format!("\"goal_constraints\": [{{{JOINTS}}}]");
        return Err(request.error("has no `goal_constraints`", hint));
    }
    goals.iter().map(goal).collect()
}

fn goal(field: &Field<'_>) -> Result<Vec<JointValue>, Diagnostic> {
    for key in OTHER_CONSTRAINTS {
        if !field.list(key)?.is_empty() {
            return Err(field.error(format!("has `{key}`: goals are joint values only"), JOINTS));
        }
    }
    let mut known = HashSet::new();
    let mut values = Vec::new();
    for constraint in field.list("joint_constraints")? {
        let joint = constraint.require("joint_name", JOINTS)?;
        let value = constraint.require("position", JOINTS)?.joint_value()?;
        if !known.insert(joint.name()?) {
            return Err(joint.error(format!("names {} a second time", joint.shown()), "each joint once"));
        }
        values.push(JointValue { joint: joint.name()?.to_owned(), value });
    }
    if values.is_empty() { Err(field.error("has no `joint_constraints`", JOINTS)) } else { Ok(values) }
}
