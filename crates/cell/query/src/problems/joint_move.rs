//! Straight motions in joint space (`PTP`).

use std::time::Instant;

use elbowroom_planner::{JointPath, RrtConnectError, RrtConnectSettings};
use elbowroom_scene::{Checker, CheckerOptions, SceneError, Selection, SweepMove, SweepOptions};

use super::problem_scene::{ProblemScene, ROBOT};
use super::{ProblemSettings, Unsolved, rrt_connect};

/// The straight joint motion to the first goal to which a sweep of the exact scene proves it free.
///
/// # Errors
/// No such motion is proven free: where the motion to the first goal is blocked, and by what.
pub(super) fn plan(problem: &ProblemScene, settings: &ProblemSettings) -> Result<JointPath, Unsolved> {
    let begin = Instant::now();
    let rrt = rrt_connect::rrt_settings(settings, settings.time_limit);
    let mut blocked = None;
    for goal in problem.goals() {
        match blocked_motion(problem, goal, &rrt)? {
            None => return Ok(JointPath::of(vec![problem.start().q(ROBOT).to_vec(), goal.clone()], begin.elapsed())),
            Some(reason) => blocked = blocked.or(Some(reason)),
        }
    }
    Err(Unsolved { reason: blocked.unwrap_or_default(), planning: begin.elapsed() })
}

/// Why the motion to a goal is not proven free; `None` if it is.
fn blocked_motion(
    problem: &ProblemScene,
    goal: &[f64],
    settings: &RrtConnectSettings,
) -> Result<Option<String>, RrtConnectError> {
    let waypoints = [problem.start().q(ROBOT).to_vec(), goal.to_vec()];
    if problem.planner()?.first_unproven_segment(problem.start(), &waypoints, settings)?.is_none() {
        return Ok(None);
    }
    Ok(Some(match first_contact(problem, goal, settings.clearance_m)? {
        Some(found) => found,
        None if problem.constraints().is_empty() => "the straight joint motion is not proven free".into(),
        None => "the straight joint motion is not proven to satisfy the path constraints".into(),
    }))
}

/// The first contact on the motion, in words.
fn first_contact(problem: &ProblemScene, goal: &[f64], clearance_m: f64) -> Result<Option<String>, SceneError> {
    let scene = problem.scene();
    let mut checker = Checker::new(scene, CheckerOptions::default());
    let moves = [SweepMove::Robot { robot: ROBOT, to: goal }];
    let options = SweepOptions { clearance_m, ..SweepOptions::default() };
    let hit = checker.between(Selection::Robot(ROBOT), Selection::All).sweep(problem.start(), &moves, &options)?;
    Ok(hit.map(|hit| {
        let [a, b] = [hit.a, hit.b].map(|id| scene.name(id).trim_start_matches('/').to_owned());
        let percent = 100.0 * hit.time;
        let near = if clearance_m > 0.0 {
            format!("are nearer than the clearance of {clearance_m} m")
        } else {
            "meet".to_owned()
        };
        format!("the straight joint motion is free for {percent:.1} % only, there `{a}` and `{b}` {near}")
    }))
}
