//! Joint values over time, for the robots' positions at the time of each picture.

use std::path::Path;

use elbowroom_cell::{Cell, CellRobot};
use elbowroom_formats::joint_states::{ExtraColumns, JointStateOptions, JointStateRobot, LimitCheck, TimeColumn};
use elbowroom_formats::{FormatError, JointStates, Warning};
use elbowroom_robot::RobotId;

/// Time before the first row, or after the last one, beyond which pictures have no joint values, s.
const MARGIN_S: f64 = 0.1;

/// Joint values of all robots over time, linear between rows; or their start.
#[derive(Debug)]
pub(super) struct JointTrack {
    start: Vec<Vec<f64>>,
    states: Option<JointStates>,
}

impl JointTrack {
    /// Reads a file with `t_s` and a column per joint (`robot.joint` if there are several robots).
    ///
    /// Without a file all robots stay at their start.
    pub fn read(cell: &Cell, file: Option<&Path>, warnings: &mut Vec<Warning>) -> Result<Self, FormatError> {
        let start = cell.robots.iter().map(|r| r.start.clone()).collect();
        let Some(file) = file else { return Ok(Self { start, states: None }) };
        let may_stay = cell.robots.len() > 1;
        let robots = cell.robots.iter().map(|r| robot(r, may_stay)).collect();
        let options = JointStateOptions {
            time: TimeColumn::Required,
            extra_columns: ExtraColumns::Skipped,
            limits: LimitCheck::Warn,
            ..JointStateOptions::states(robots)
        };
        let mut states = JointStates::read(file, &options)?;
        warnings.append(&mut states.warnings);
        Ok(Self { start, states: Some(states) })
    }

    /// The values of each robot at a time that the file covers; `None` at other times, and without a file.
    pub fn recorded_at(&self, t_s: f64) -> Option<Vec<Vec<f64>>> {
        self.states.as_ref()?;
        self.at(t_s).ok()
    }

    /// The values of each robot at a time; an error if they are not known.
    pub fn at(&self, t_s: f64) -> Result<Vec<Vec<f64>>, String> {
        let Some(states) = &self.states else { return Ok(self.start.clone()) };
        let times = states.times_s();
        let (first, last) = (times[0], times[times.len() - 1]);
        if !(t_s >= first - MARGIN_S && t_s <= last + MARGIN_S) {
            return Err(format!("no joint values are known at {t_s} s: they are from {first} to {last} s"));
        }
        let next = times.partition_point(|t| *t <= t_s).clamp(1, times.len().max(2) - 1).min(times.len() - 1);
        let before = next.saturating_sub(1);
        let width = times[next] - times[before];
        let share = if width > 0.0 { ((t_s - times[before]) / width).clamp(0.0, 1.0) } else { 0.0 };
        let between = |robot: RobotId| {
            let ends = states.q(before, robot).iter().zip(states.q(next, robot));
            ends.map(|(a, b)| a + (b - a) * share).collect()
        };
        Ok((0..states.robots()).map(RobotId).map(between).collect())
    }
}

/// With several robots, a robot without a column stays at its start.
fn robot(robot: &CellRobot, may_stay: bool) -> JointStateRobot<'_> {
    let default_q = may_stay.then_some(&robot.start[..]);
    JointStateRobot { name: &robot.name, chain: &robot.robot.chain, default_q }
}
