//! The kind of motion of a request: `MoveIt`'s industrial planner (Pilz) names it in `planner_id`.

use crate::Diagnostic;
use crate::moveit_msgs::field::Field;
use crate::suggest;

/// The pipeline of `MoveIt` whose planners are kinds of motion.
const PILZ: &str = "pilz_industrial_motion_planner";
/// Its planners.
const PLANNERS: [&str; 3] = ["PTP", "LIN", "CIRC"];
/// What to write for a motion that is searched for.
const SEARCHED: &str = "or no `planner_id` of these, for a path that is searched for";

/// How the robot moves to a goal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum RequestedMotion {
    /// On any path.
    #[default]
    Any,
    /// Straight in joint space: `PTP`.
    PointToPoint,
    /// Straight with the tool, which turns uniformly: `LIN`.
    Linear,
}

/// Reads `pipeline_id` and `planner_id`. The planners of other pipelines are ignored.
pub(super) fn requested_motion(request: &Field<'_>) -> Result<RequestedMotion, Diagnostic> {
    let (pipeline, planner) = (request.text_of("pipeline_id")?, request.text_of("planner_id")?);
    let is_pilz = pipeline.eq_ignore_ascii_case(PILZ);
    let is_motion = PLANNERS.iter().any(|known| known.eq_ignore_ascii_case(planner));
    if !is_pilz && !is_motion {
        return Ok(RequestedMotion::Any);
    }
    let at = |key: &str| Ok(request.get(key)?.unwrap_or_else(|| request.clone()));
    if is_pilz && planner.is_empty() {
        let what = format!("has no `planner_id`, and `{PILZ}` plans by its name");
        return Err(request.error(what, "\"planner_id\": \"LIN\", or \"PTP\""));
    }
    if !is_pilz && !pipeline.is_empty() {
        let what = format!("is \"{pipeline}\", which has no planner \"{planner}\"");
        return Err(at("pipeline_id")?.error(what, format!("\"{PILZ}\", {SEARCHED}")));
    }
    match planner {
        "PTP" => Ok(RequestedMotion::PointToPoint),
        "LIN" => Ok(RequestedMotion::Linear),
        "CIRC" => {
            let what = "is \"CIRC\": motions on circles are not supported";
            let hint = "\"LIN\" once per chord, each from the end of the one before it; \"PTP\"; ";
            Err(at("planner_id")?.error(what, format!("{hint}{SEARCHED}")))
        }
        _ => {
            let what = format!("is \"{planner}\", which is no planner of `{PILZ}`");
            let hint = suggest::hint(planner, PLANNERS[..2].iter().copied());
            Err(at("planner_id")?.error(what, hint))
        }
    }
}
