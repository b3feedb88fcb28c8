//! How far joints are beyond their limits.

use elbowroom_cell::QueryModel;
use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::{Joint, Limits};
use elbowroom_robot::RobotId;
use serde::Serialize;

use super::evaluate::{BLOCK, QueryEffort, evaluate_blocks};
use super::row::quoted;
use super::states::QueryStates;

/// The joint limits in one state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitRow {
    /// Index of the state, from 0.
    pub index: usize,
    /// The joint that is farthest beyond its limits; `None` if all joints are within their limits.
    pub farthest: Option<JointOvershoot>,
    /// Whether a joint is beyond its limits by more than a monitor tolerates.
    pub stops: bool,
}

/// A joint beyond its limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointOvershoot {
    /// The robot.
    pub robot: RobotId,
    /// Index of the joint in `q`.
    pub joint: usize,
    /// Its value, rad or m.
    pub value: f64,
    /// Its [overshoot](Limits::overshoot), rad or m.
    pub overshoot: f64,
}

/// A row of joint limits in CSV and JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LimitRecord {
    /// Index of the state, from 0.
    pub index: usize,
    /// 1 if a joint is beyond its limits.
    pub beyond: u8,
    /// The joint that is farthest beyond its limits.
    pub joint: Option<String>,
    /// By how much: positive beyond the upper limit, negative beyond the lower limit, 0 without such a joint.
    pub overshoot: f64,
    /// `rad` or `m`.
    pub unit: Option<&'static str>,
    /// Value of that joint.
    pub value: Option<f64>,
    /// Its lower limit; `None` if it has none.
    pub lower: Option<f64>,
    /// Its upper limit; `None` if it has none.
    pub upper: Option<f64>,
    /// 1 if a joint is beyond its limits by more than a monitor tolerates.
    pub stops: u8,
}

impl LimitRecord {
    /// The columns, in order.
    pub const HEADER: &'static str = "index,beyond,joint,overshoot,unit,value,lower,upper,stops";

    /// The record of a row, with names: `robot.joint`, without the robot for a single robot.
    pub fn of(row: &LimitRow, model: &QueryModel) -> Self {
        let named = row.farthest.map(|farthest| (farthest, joint(model, farthest.robot, farthest.joint)));
        let name = |(farthest, joint): (JointOvershoot, &Joint)| {
            let prefix = &model.robots[farthest.robot.0].name;
            if model.is_single_robot { joint.name.clone() } else { format!("{prefix}.{}", joint.name) }
        };
        let limit =
            |side: fn(&Limits) -> f64| named.map(|(_, joint)| side(&joint.limits)).filter(|limit| limit.is_finite());
        Self {
            index: row.index,
            beyond: u8::from(row.farthest.is_some()),
            joint: named.map(name),
            overshoot: row.farthest.map_or(0.0, |farthest| farthest.overshoot),
            unit: named.map(|(_, joint)| if joint.kind.turns() { "rad" } else { "m" }),
            value: row.farthest.map(|farthest| farthest.value),
            lower: limit(|limits| limits.lower),
            upper: limit(|limits| limits.upper),
            stops: u8::from(row.stops),
        }
    }

    /// The CSV line, without line break; unknown values are empty.
    pub fn csv(&self) -> String {
        let number = |v: &Option<f64>| v.map_or_else(String::new, |v| format!("{v:?}"));
        let (joint, unit) = (self.joint.as_deref().map_or_else(String::new, quoted), self.unit.unwrap_or_default());
        let [value, lower, upper] = [&self.value, &self.lower, &self.upper].map(number);
        let (index, beyond, overshoot, stops) = (self.index, self.beyond, self.overshoot, self.stops);
        format!("{index},{beyond},{joint},{overshoot:?},{unit},{value},{lower},{upper},{stops}")
    }
}

/// Compares the joint values of every state with the limits. `take` is called as by
/// [`evaluate_query`](super::evaluate_query).
///
/// Only independent joints count: a mimic joint has no value of its own.
///
/// # Errors
/// Never, as states were read for this model.
pub fn evaluate_limits(
    model: &QueryModel,
    states: &QueryStates,
    take: &mut dyn FnMut(&[LimitRow]) -> bool,
) -> Result<QueryEffort, Diagnostic> {
    let rows = |block: usize| {
        let indices = block * BLOCK..states.len().min((block + 1) * BLOCK);
        Ok((indices.map(|index| row(model, states, index)).collect(), QueryEffort::default()))
    };
    evaluate_blocks(states, (states.len(), None), &rows, take)
}

fn row(model: &QueryModel, states: &QueryStates, index: usize) -> LimitRow {
    let mut row = LimitRow { index, farthest: None, stops: false };
    for (robot, q) in states.of(index) {
        for (i, value) in q.iter().enumerate() {
            let limits = joint(model, robot, i).limits;
            let overshoot = limits.overshoot(*value);
            if limits.contains(*value, 0.0) {
                continue;
            }
            row.stops |= model.robots[robot.0].is_guarded && !limits.is_plausible(*value);
            if row.farthest.is_none_or(|farthest| overshoot.abs() > farthest.overshoot.abs()) {
                row.farthest = Some(JointOvershoot { robot, joint: i, value: *value, overshoot });
            }
        }
    }
    row
}

/// The independent joint with this index in `q`.
fn joint(model: &QueryModel, robot: RobotId, index: usize) -> &Joint {
    let chain = &model.robots[robot.0].robot.chain;
    &chain.joints()[chain.active_joints()[index].0]
}
