//! The run over the problems of a file.

use elbowroom_formats::problem_set::PlanningProblem;
use elbowroom_planner::{JointPath, TimedPath};

use super::messages::Result;
use super::model::ProblemModel;
use super::problem_scene::ProblemScene;
use super::{PlanningEngine, ProblemResult, ProblemSettings, end_validity, motion_limits};

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
        let (result, timed) = if let Err(reason) = end_validity::keep_free_goals(&mut scene) {
            (ProblemResult::invalid(set, id, reason.to_string()), None)
        } else {
            let solution = engine.solve(&scene, settings);
            let mut result = ProblemResult::of(set, id, &solution);
            let timed = solution.ok().and_then(|path| timed(engine, &scene, path, settings, &mut result));
            (result, timed)
        };
        let goes_on = each(&result, timed.as_ref());
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
    path: JointPath,
    settings: &ProblemSettings,
    result: &mut ProblemResult,
) -> Option<TimedPath> {
    let Some(limits) = motion_limits::of_chain(&problem.scene.robots()[0].robot.chain, &problem.planned) else {
        result.reason = Some("not timed: a joint has no largest speed".into());
        return None;
    };
    match engine.time(problem, path, &limits, settings) {
        Ok(timed) => {
            result.duration_s = Some(timed.trajectory.duration_s());
            Some(timed)
        }
        Err(e) => {
            result.reason = Some(format!("not timed: {e}"));
            None
        }
    }
}
