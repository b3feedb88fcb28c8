//! Check that the start and goals of a problem are free.

use elbowroom_scene::{Checker, CheckerOptions, SceneState, Selection};

use super::problem_scene::{ProblemScene, ROBOT};

/// Removes the goals that are not free.
///
/// # Errors
/// The reason if the start, or every goal, is in collision or beyond the limits. It is the reason of the start, or of
/// the last goal.
pub(super) fn keep_free_goals(problem: &mut ProblemScene) -> Result<(), String> {
    why_invalid(problem, problem.start.q(ROBOT)).map_or(Ok(()), |why| Err(format!("start: {why}")))?;
    let mut reason = String::new();
    let mut free = Vec::new();
    for goal in &problem.goals {
        match why_invalid(problem, goal) {
            None => free.push(goal.clone()),
            Some(why) => reason = format!("goal: {why}"),
        }
    }
    problem.goals = free;
    if problem.goals.is_empty() { Err(reason) } else { Ok(()) }
}

fn why_invalid(problem: &ProblemScene, q: &[f64]) -> Option<String> {
    let chain = &problem.scene.robots()[0].robot.chain;
    let is_beyond = |(v, (lower, upper)): (&f64, &(f64, f64))| !(lower..=upper).contains(&v);
    if let Some(i) = q.iter().zip(problem.limits()).position(is_beyond) {
        let (lower, upper) = problem.limits()[i];
        let name = &chain.joints()[chain.active_joints()[i].0].name;
        return Some(format!("`{name}` is {}, beyond its limits {lower} to {upper}", q[i]));
    }
    let mut state: SceneState = problem.start.clone();
    if let Err(e) = state.set_q(&problem.scene, ROBOT, q) {
        return Some(e.to_string());
    }
    let mut checker = Checker::new(&problem.scene, CheckerOptions::default());
    let contact = checker.between(Selection::Robot(ROBOT), Selection::All).collides(&state)?;
    let [a, b] = [contact.a, contact.b].map(|id| problem.scene.name(id));
    Some(format!("`{}` and `{}` are in collision", a.trim_start_matches('/'), b.trim_start_matches('/')))
}
