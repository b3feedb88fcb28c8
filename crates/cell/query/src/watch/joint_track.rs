//! Joint values over time, for the robots' positions at the time of each picture.

use std::path::Path;

use elbowroom_cell::{Cell, CellRobot};
use elbowroom_formats::joint_states::{ExtraColumns, JointStateOptions, JointStateRobot, LimitCheck, TimeColumn};
use elbowroom_formats::{Diagnostic, JointStates};
use elbowroom_kinematics::JointTrajectory;
use elbowroom_robot::RobotId;

/// Time before the first row, or after the last one, beyond which pictures have no joint values, s.
const MARGIN_S: f64 = 0.1;

/// A time that the file of joint values does not cover.
#[derive(Debug, thiserror::Error)]
#[error("no joint values are known at {t_s} s: they are from {} to {} s", covered_s[0], covered_s[1])]
pub(super) struct NoJointValues {
    t_s: f64,
    /// Times of the first and the last row.
    covered_s: [f64; 2],
}

/// Joint values of all robots over time, linear between rows; or their start.
#[derive(Debug)]
pub(super) struct JointTrack {
    start: Vec<Vec<f64>>,
    /// One per robot.
    recorded: Option<Vec<JointTrajectory>>,
}

impl JointTrack {
    /// Reads a file with `t_s` and a column per joint (`robot.joint` if there are several robots).
    ///
    /// Without a file all robots stay at their start.
    pub fn read(cell: &Cell, file: Option<&Path>, warnings: &mut Vec<Diagnostic>) -> Result<Self, Diagnostic> {
        let start = cell.robots.iter().map(|r| r.start.clone()).collect();
        let Some(file) = file else { return Ok(Self { start, recorded: None }) };
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
        let recorded = (0..states.robots()).map(|robot| states.trajectory(RobotId(robot))).collect();
        Ok(Self { start, recorded: Some(recorded) })
    }

    /// The values of each robot at a time that the file covers; `None` at other times, and without a file.
    pub fn recorded_at(&self, t_s: f64) -> Option<Vec<Vec<f64>>> {
        self.recorded.as_ref()?;
        self.at(t_s).ok()
    }

    /// The values of each robot at a time; an error if they are not known.
    pub fn at(&self, t_s: f64) -> Result<Vec<Vec<f64>>, NoJointValues> {
        let Some(recorded) = &self.recorded else { return Ok(self.start.clone()) };
        let (first, last) = recorded.first().map_or((0.0, 0.0), |r| (r.start_s(), r.end_s()));
        if !(t_s >= first - MARGIN_S && t_s <= last + MARGIN_S) {
            return Err(NoJointValues { t_s, covered_s: [first, last] });
        }
        Ok(recorded.iter().map(|trajectory| trajectory.q(t_s)).collect())
    }
}

/// With several robots, a robot without a column stays at its start.
fn robot(robot: &CellRobot, may_stay: bool) -> JointStateRobot<'_> {
    let default_q = may_stay.then_some(&robot.start[..]);
    JointStateRobot { name: &robot.name, chain: &robot.robot.chain, default_q }
}
