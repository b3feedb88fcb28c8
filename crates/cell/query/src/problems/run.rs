//! The run over the problems of a file.

use elbowroom_formats::problem_set::PlanningProblem;
use elbowroom_kinematics::JointLimits;
use elbowroom_planner::{PlannedPath, RrtConnectError, TimedMotion};

use super::messages::Result;
use super::model::ProblemModel;
use super::problem_scene::ProblemScene;
use super::{PlanningEngine, ProblemResult, ProblemSettings, Solution, end_validity, motion_limits};
use crate::plan::TimedPath;

/// Why a path has no time.
#[derive(Debug, thiserror::Error)]
enum NotTimed {
    #[error("not timed: a joint has no largest speed")]
    NoSpeed,
    #[error("not timed: {0}")]
    Planner(#[from] RrtConnectError),
}

/// Solves problems one after the other, and times the paths.
///
/// The times in a result include neither the building of the scenes nor the timing of paths. `each` is called after
/// each problem, with the timed path if there is one; `false` ends the run.
///
/// # Errors
/// As for [`ProblemModel::problem_scene`].
pub fn run(
    model: &ProblemModel,
    problems: &[PlanningProblem],
    settings: &ProblemSettings,
    engine: &mut dyn PlanningEngine,
    each: &mut dyn FnMut(&ProblemResult, Option<&TimedPath>) -> bool,
) -> Result<Vec<ProblemResult>> {
    let mut results = Vec::new();
    for problem in problems {
        let (set, id) = (&problem.set, &problem.id);
        let mut scene = model.problem_scene(problem)?;
        let (result, motion) = if let Err(why) = end_validity::keep_free_goals(&mut scene) {
            (ProblemResult::invalid(set, id, why.to_string()), None)
        } else {
            let solution = engine.solve(&scene, settings);
            let mut result = ProblemResult::of(set, id, &solution);
            let motion = if solution.found { timed(engine, &scene, solution, settings, &mut result) } else { None };
            (result, motion)
        };
        let goes_on = each(&result, motion.as_ref());
        results.push(result);
        if !goes_on {
            break;
        }
    }
    Ok(results)
}

/// The timed path. If there is none, the result has the reason.
fn timed(
    engine: &mut dyn PlanningEngine,
    problem: &ProblemScene,
    solution: Solution,
    settings: &ProblemSettings,
    result: &mut ProblemResult,
) -> Option<TimedPath> {
    let limits = motion_limits::of_chain(&problem.scene.robots()[0].robot.chain, &problem.planned);
    let motion = match limits {
        None => Err(NotTimed::NoSpeed),
        Some(limits) => time(engine, problem, solution, settings, &limits),
    };
    match motion {
        Ok(motion) => {
            result.duration_s = Some(motion.duration_s);
            Some(motion)
        }
        Err(why) => {
            result.reason = Some(why.to_string());
            None
        }
    }
}

fn time(
    engine: &mut dyn PlanningEngine,
    problem: &ProblemScene,
    solution: Solution,
    settings: &ProblemSettings,
    limits: &[JointLimits],
) -> std::result::Result<TimedPath, NotTimed> {
    let path = PlannedPath {
        waypoints: solution.waypoints,
        length_rad: solution.cost_rad,
        raw_length_rad: solution.cost_raw_rad,
        planning_time: solution.planning,
        simplification_time: solution.simplification,
        states_checked: 0,
    };
    let motion = engine.time(problem, &path, limits, settings)?;
    let TimedMotion { duration_s, stops, rows } = motion;
    Ok(TimedPath { duration_s, stops, rows, waypoints: path.waypoints, cost_rad: path.length_rad })
}
