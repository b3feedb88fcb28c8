//! Path constraints of a request.

use std::f64::consts::PI;

use elbowroom_spatial::Vec3;

use crate::Diagnostic;
use crate::moveit_msgs::field::Field;
use crate::moveit_msgs::pose;

/// Constraints of a path on other quantities than orientations.
const OTHER_CONSTRAINTS: [&str; 3] = ["position_constraints", "joint_constraints", "visibility_constraints"];
/// The layout of a constraint, for messages.
const LAYOUT: &str = "{\"link_name\": \"LINK\", \"orientation\": [0, 0, 0, 1], \"absolute_x_axis_tolerance\": 0.1, \
                      \"absolute_y_axis_tolerance\": 0.1, \"absolute_z_axis_tolerance\": 3.15}";

/// An axis of a link that keeps its direction along a path: of an orientation constraint that leaves turns about one axis
/// free.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisConstraint {
    /// The link.
    pub link: String,
    /// The axis in the link's frame, of length 1.
    pub axis_in_link: Vec3,
    /// The frame of the direction; empty for the world.
    pub frame: String,
    /// The direction in that frame, of length 1.
    pub direction: Vec3,
    /// Largest angle between axis and direction, rad: the smaller one of the two tolerances.
    pub tolerance_rad: f64,
}

/// Reads the path constraints of a request.
pub(super) fn axis_constraints(request: &Field<'_>) -> Result<Vec<AxisConstraint>, Diagnostic> {
    let Some(constraints) = request.get("path_constraints")? else { return Ok(Vec::new()) };
    for key in OTHER_CONSTRAINTS {
        if !constraints.list(key)?.is_empty() {
            let hint = "`orientation_constraints` only, or an empty list: a path could violate it";
            return Err(constraints.error(format!("has `{key}`, which are not supported"), hint));
        }
    }
    let all = constraints.list("orientation_constraints")?;
    all.iter().filter_map(|field| axis_constraint(field).transpose()).collect()
}

/// The constraint of a message; `None` if it leaves every orientation free.
fn axis_constraint(field: &Field<'_>) -> Result<Option<AxisConstraint>, Diagnostic> {
    let tolerance = |axis: char| {
        let tolerance = field.require(&format!("absolute_{axis}_axis_tolerance"), LAYOUT)?;
        let value = tolerance.number()?;
        if value > 0.0 { Ok(value) } else { Err(tolerance.error("is not above 0", "an angle in radians, such as 0.1")) }
    };
    let tolerances = [tolerance('x')?, tolerance('y')?, tolerance('z')?];
    let free: Vec<usize> = (0..3).filter(|i| tolerances[*i] >= PI).collect();
    let axis = match free[..] {
        [axis] => axis,
        [_, _, _] => return Ok(None),
        _ => {
            let what = format!(
                "leaves {} axes free, and one is supported: the axis about which the link may turn",
                free.len()
            );
            return Err(
                field.error(what, "3.15 (rad) or more as the tolerance of that axis, and less as the two others")
            );
        }
    };
    let axis_in_link = [Vec3::X, Vec3::Y, Vec3::Z][axis];
    Ok(Some(AxisConstraint {
        link: field.require("link_name", LAYOUT)?.name()?.to_owned(),
        axis_in_link,
        frame: pose::frame_id(field)?,
        direction: pose::orientation(field)? * axis_in_link,
        tolerance_rad: tolerances.into_iter().fold(PI, f64::min),
    }))
}
