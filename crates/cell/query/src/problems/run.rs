//! The run over the problems of a file.

use elbowroom_formats::problem_set::PlanningProblem;
use elbowroom_planner::{AnytimePath, JointPath, TimedPath};

use super::messages::Result;
use super::model::ProblemModel;
use super::problem_scene::{Motion, ProblemScene};
use super::{
    PlanningEngine, ProblemResult, ProblemSettings, Unsolved, end_validity, joint_move, linear_move, motion_limits,
};

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
            (ProblemResult::invalid([set, id], scene.motion, reason.to_string()), None)
        } else {
            let solution = solve(engine, &scene, settings);
            let mut result = ProblemResult::of([set, id], scene.motion, &solution);
            if let Ok(answer) = &solution {
                measure_line(&scene, quarters(&answer.path.waypoints).iter().map(Vec::as_slice), &mut result);
            }
            let timed = solution.ok().and_then(|answer| timed(engine, &scene, answer.path, settings, &mut result));
            if let Some(timed) = &timed {
                measure_line(&scene, timed.trajectory.rows().iter().map(|row| &row.q[..]), &mut result);
            }
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

fn solve(
    engine: &mut dyn PlanningEngine,
    problem: &ProblemScene,
    settings: &ProblemSettings,
) -> std::result::Result<AnytimePath, Unsolved> {
    match problem.motion {
        Motion::Any => engine.solve(problem, settings),
        Motion::PointToPoint => joint_move::plan(problem, settings).map(AnytimePath::from),
        Motion::Linear(link) => engine.solve_linear(problem, link, settings).map(AnytimePath::from),
    }
}

/// The waypoints and the quarters between them.
fn quarters(waypoints: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let between = |pair: &[Vec<f64>], i: u8| {
        let part = 0.25 * f64::from(i);
        pair[0].iter().zip(&pair[1]).map(|(a, b)| a + (b - a) * part).collect()
    };
    let segments = waypoints.windows(2).flat_map(|pair| (0..4).map(move |i| between(pair, i)));
    segments.chain(waypoints.last().cloned()).collect()
}

/// Adds how far a linear motion is off its line, at some configurations; the largest values remain.
fn measure_line<'q>(
    problem: &ProblemScene,
    configurations: impl Iterator<Item = &'q [f64]>,
    result: &mut ProblemResult,
) {
    let Motion::Linear(link) = problem.motion else { return };
    let off = linear_move::deviation(problem, link, configurations);
    let larger = |before: &mut Option<f64>, now: f64| *before = Some(before.map_or(now, |value| value.max(now)));
    larger(&mut result.line_deviation_m, off.metres);
    larger(&mut result.line_deviation_rad, off.angle_rad);
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
