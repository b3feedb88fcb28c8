//! Result of planning: the output of `elbowroom plan`.

use std::io::{self, Write};
use std::time::Duration;

use elbowroom_cell::CellRobot;
use elbowroom_kinematics::inverse::ArmConfiguration;
use elbowroom_kinematics::{JointTrajectory, TrajectoryRow};
use elbowroom_planner::TimedPath;
use serde::{Serialize, Serializer};

use super::point_path::PointPath;

/// Result of planning.
///
/// Serialized as one flat document in SI units, without the rows. Without a path, `waypoints` is empty, and the other
/// properties of a path are null.
#[derive(Debug, Clone, PartialEq)]
pub struct PathAnswer {
    /// True if a path was found.
    pub found: bool,
    /// Name of the robot.
    pub robot: String,
    /// Names of its joints, in the order of the values.
    pub joints: Vec<String>,
    /// Names of the regions that the path avoids.
    pub regions: Vec<String>,
    /// Shoulder, elbow and wrist at the end of the path; `None` without a path, and for other arms than six axes with a
    /// spherical wrist.
    pub configuration: Option<ArmConfiguration>,
    /// Reason if no path was found.
    pub reason: Option<String>,
    /// Time for building the map on which the path was planned; `None` without a map.
    pub map_time: Option<Duration>,
    /// Time of the search, µs.
    pub planning_us: u64,
    /// Time of shortcutting, µs.
    pub simplify_us: u64,
    /// The way of the point that was to be moved; `None` without a path, and for another goal.
    pub point: Option<PointPath>,
    /// The path and its motion.
    pub timed: Option<TimedPath>,
}

impl PathAnswer {
    pub(super) fn none(robot: &CellRobot, took: Duration, reason: String) -> Self {
        Self {
            found: false,
            robot: robot.name.clone(),
            joints: robot.joint_names(),
            regions: Vec::new(),
            configuration: None,
            reason: Some(reason),
            map_time: None,
            planning_us: micros(took),
            simplify_us: 0,
            point: None,
            timed: None,
        }
    }

    pub(super) fn found(robot: &CellRobot, timed: TimedPath) -> Self {
        Self {
            found: true,
            robot: robot.name.clone(),
            joints: robot.joint_names(),
            regions: Vec::new(),
            configuration: timed.trajectory.last().and_then(|q| robot.ik_solver().configuration(q)),
            reason: None,
            map_time: None,
            planning_us: micros(timed.path.planning_time),
            simplify_us: micros(timed.path.simplification_time),
            point: None,
            timed: Some(timed),
        }
    }
}

impl Serialize for PathAnswer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Document<'a> {
            found: bool,
            reason: Option<&'a str>,
            robot: &'a str,
            joints: &'a [String],
            regions: &'a [String],
            configuration: Option<String>,
            waypoints: &'a [Vec<f64>],
            cost_rad: Option<f64>,
            duration_s: Option<f64>,
            stops: Option<usize>,
            #[serde(skip_serializing_if = "Option::is_none")]
            point: Option<&'a PointPath>,
            map_us: Option<u64>,
            planning_us: u64,
            simplify_us: u64,
        }
        let timed = self.timed.as_ref();
        let document = Document {
            found: self.found,
            reason: self.reason.as_deref(),
            robot: &self.robot,
            joints: &self.joints,
            regions: &self.regions,
            configuration: self.configuration.map(|c| c.to_string()),
            waypoints: timed.map_or(&[], |t| &t.path.waypoints),
            cost_rad: timed.map(|t| t.path.length_rad),
            duration_s: timed.map(|t| t.trajectory.duration_s()),
            stops: timed.map(|t| t.stops),
            point: self.point.as_ref(),
            map_us: self.map_time.map(micros),
            planning_us: self.planning_us,
            simplify_us: self.simplify_us,
        };
        document.serialize(serializer)
    }
}

fn micros(time: Duration) -> u64 {
    u64::try_from(time.as_micros()).unwrap_or(u64::MAX)
}

/// Writes `t_s` and a column per value of a row. The numbers read back to the same bits; the `trajectory` of a cell accepts
/// the file.
///
/// # Errors
/// Errors of the writer.
pub fn write_csv(columns: &[String], trajectory: &JointTrajectory, mut out: impl Write) -> io::Result<()> {
    writeln!(out, "t_s,{}", columns.join(","))?;
    for TrajectoryRow { t_s, q } in trajectory.rows() {
        write!(out, "{t_s}")?;
        for v in q {
            write!(out, ",{v}")?;
        }
        writeln!(out)?;
    }
    out.flush()
}
