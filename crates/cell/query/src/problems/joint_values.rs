//! Joint values of a problem: start, goals, and which joints are planned.

use elbowroom_formats::problem_set::{JointValue, PlanningProblem};
use elbowroom_formats::suggest;
use elbowroom_kinematics::{Chain, JointId, JointKind};

use super::messages::{Notes, ProblemKey, Result};

/// Difference of a mimic joint from the value that follows from its source above which it is reported, rad or m.
const MIMIC_TOLERANCE: f64 = 1e-6;
/// Tolerance for a value beyond a limit, which then counts as on it, rad or m: models round π to 3.14159.
const LIMIT_ROUNDING: f64 = 1e-5;

/// Start and goals of a problem, in the order of the chain.
#[derive(Debug, Clone)]
pub(super) struct JointValues {
    /// Values at the start.
    pub start: Vec<f64>,
    /// Values at the alternative goals. Joints that a goal does not name stay at the start.
    pub goals: Vec<Vec<f64>>,
    /// True for the joints that a goal names.
    pub planned: Vec<bool>,
    /// Lowest and highest value of each joint; equal for a joint that no goal names.
    pub limits: Vec<(f64, f64)>,
}

/// The values of a problem, for joints with these limits in the model.
pub(super) fn of_problem(
    chain: &Chain,
    limits: &[(f64, f64)],
    key: ProblemKey<'_>,
    problem: &PlanningProblem,
    notes: &mut Notes,
) -> Result<JointValues> {
    let start = start(chain, limits, key, problem, notes);
    let mut planned = vec![false; chain.dof()];
    let mut goals = Vec::new();
    for goal in &problem.goals {
        let mut q = start.clone();
        for JointValue { joint, value } in goal {
            let i = goal_joint(chain, key, joint)?;
            (q[i], planned[i]) = (*value, true);
        }
        goals.push(q);
    }
    let ends = || goals.iter().chain([&start]);
    let planned_limits = |i: usize, model| ends().fold(model, |limits, q: &Vec<f64>| with_rounding(limits, q[i]));
    let limit = |(i, model): (usize, _)| if planned[i] { planned_limits(i, model) } else { (start[i], start[i]) };
    let limits = limits.iter().copied().enumerate().map(limit).collect();
    Ok(JointValues { start, goals, planned, limits })
}

/// Limits that include a value which is beyond them by rounding.
fn with_rounding((lower, upper): (f64, f64), value: f64) -> (f64, f64) {
    let is_near = value >= lower - LIMIT_ROUNDING && value <= upper + LIMIT_ROUNDING;
    if is_near { (lower.min(value), upper.max(value)) } else { (lower, upper) }
}

/// The start values; zero, or the limit nearest to it, if the problem states no value.
fn start(
    chain: &Chain,
    limits: &[(f64, f64)],
    key: ProblemKey<'_>,
    problem: &PlanningProblem,
    notes: &mut Notes,
) -> Vec<f64> {
    let mut q: Vec<f64> = limits.iter().map(|(lower, upper)| 0.0_f64.min(*upper).max(*lower)).collect();
    let mut missing = vec![true; q.len()];
    let mut dependent = Vec::new();
    for JointValue { joint, value } in &problem.start {
        let Some(id) = chain.joint(joint) else {
            notes.once(key, &format!("the start names `{joint}`, which is no joint of the robot: ignored"));
            continue;
        };
        match chain.q_index(id) {
            Some(i) if chain.mimic_source(id).is_none() => (q[i], missing[i]) = (*value, false),
            _ => dependent.push((id, *value)),
        }
    }
    for (i, _) in missing.iter().enumerate().filter(|(_, missing)| **missing) {
        let joint = &chain.joints()[chain.active_joints()[i].0].name;
        notes.once(key, &format!("the start has no value for `{joint}`: taken as {}", q[i]));
    }
    for (id, value) in dependent {
        check_dependent(chain, key, (id, value), &q, notes);
    }
    q
}

/// Warns of a value that a fixed or mimic joint does not have.
fn check_dependent(chain: &Chain, key: ProblemKey<'_>, (id, value): (JointId, f64), q: &[f64], notes: &mut Notes) {
    let joint = &chain.joints()[id.0];
    let actual = if joint.kind == JointKind::Fixed { 0.0 } else { chain.joint_value(id, q) };
    if (actual - value).abs() > MIMIC_TOLERANCE {
        let name = &joint.name;
        let why = if joint.kind == JointKind::Fixed { "is fixed" } else { "follows another joint" };
        notes.once(key, &format!("the start has {value} for `{name}`, which {why} and is at {actual}"));
    }
}

/// The index in `q` of a joint that a goal names.
fn goal_joint(chain: &Chain, key: ProblemKey<'_>, name: &str) -> Result<usize> {
    let names = || chain.active_joints().iter().map(|j| chain.joints()[j.0].name.as_str());
    let independent = |id: JointId| chain.q_index(id).filter(|_| chain.mimic_source(id).is_none());
    chain.joint(name).and_then(independent).ok_or_else(|| {
        let why = if chain.joint(name).is_some() { "has no value of its own" } else { "is no joint of the robot" };
        key.error(format!("the goal names `{name}`, which {why}")).hint(suggest::hint(name, names()))
    })
}
