//! Check that the start and goals of a problem are free.

use elbowroom_scene::{Checker, CheckerOptions, SceneError, SceneState, Selection};

use super::problem_scene::{ProblemScene, ROBOT};

/// Why a problem cannot be planned.
#[derive(Debug, thiserror::Error)]
pub(super) enum InvalidEnd {
    #[error("start: {0}")]
    Start(NotFree),
    #[error("goal: {0}")]
    Goal(NotFree),
}

/// Why joint values are not free.
#[derive(Debug, thiserror::Error)]
pub(super) enum NotFree {
    /// A value beyond the limits, rad or m.
    #[error("`{joint}` is {value}, beyond its limits {lower} to {upper}")]
    Limits { joint: String, value: f64, lower: f64, upper: f64 },
    /// The scene refuses the values.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// An axis has another direction than the path constraint says.
    #[error("the path constraint is violated: {0}")]
    Constraint(String),
    /// Two geometries overlap.
    #[error("`{a}` and `{b}` are in collision")]
    Collision { a: String, b: String },
}

/// Removes the goals that are not free.
///
/// # Errors
/// [`InvalidEnd`] if the start, or every goal, is in collision or beyond the limits: of the start, or of the last goal.
pub(super) fn keep_free_goals(problem: &mut ProblemScene) -> Result<(), InvalidEnd> {
    check_free(problem, problem.start.q(ROBOT)).map_err(InvalidEnd::Start)?;
    let mut last = None;
    let mut free = Vec::new();
    for goal in &problem.goals {
        match check_free(problem, goal) {
            Ok(()) => free.push(goal.clone()),
            Err(why) => last = Some(why),
        }
    }
    problem.goals = free;
    last.filter(|_| problem.goals.is_empty()).map_or(Ok(()), |why| Err(InvalidEnd::Goal(why)))
}

fn check_free(problem: &ProblemScene, q: &[f64]) -> Result<(), NotFree> {
    let chain = &problem.scene.robots()[0].robot.chain;
    let is_beyond = |(v, (lower, upper)): (&f64, &(f64, f64))| !(lower..=upper).contains(&v);
    if let Some(i) = q.iter().zip(problem.limits()).position(is_beyond) {
        let (lower, upper) = problem.limits()[i];
        let joint = chain.joints()[chain.active_joints()[i].0].name.clone();
        return Err(NotFree::Limits { joint, value: q[i], lower, upper });
    }
    if let Some(mut violated) =
        problem.constraints().into_iter().find_map(|mut c| (c.distance_m(q, 0.0) <= 0.0).then_some(c))
    {
        return Err(NotFree::Constraint(violated.describe_nearest(q)));
    }
    let mut state: SceneState = problem.start.clone();
    state.set_q(&problem.scene, ROBOT, q)?;
    let mut checker = Checker::new(&problem.scene, CheckerOptions::default());
    let contact = checker.between(Selection::Robot(ROBOT), Selection::All).collides(&state);
    contact.map_or(Ok(()), |contact| {
        let name = |id| problem.scene.name(id).trim_start_matches('/').to_owned();
        Err(NotFree::Collision { a: name(contact.a), b: name(contact.b) })
    })
}
