//! What `elbowroom plan` prints and writes.

use std::io::{self, Write};
use std::time::Duration;

use elbowroom_planner::{Route, Trajectory};
use serde::{Serialize, Serializer};

use crate::CellRobot;

/// The answer. Serialized: one flat document in SI, without the rows; where there is no path `waypoints` is empty, and
/// what only a path has is null.
#[derive(Debug, Clone, PartialEq)]
pub struct PathAnswer {
    /// True where there is a path.
    pub found: bool,
    /// Name of the robot.
    pub robot: String,
    /// Names of its joints, in the order of all values.
    pub joints: Vec<String>,
    /// Names of the regions that it stays out of.
    pub regions: Vec<String>,
    /// Why none was found.
    pub reason: Option<String>,
    /// Time of the search, µs.
    pub planning_us: u64,
    /// Time of making the path short, µs.
    pub simplify_us: u64,
    /// The path.
    pub motion: Option<Motion>,
}

/// A path in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Straight in joint space from each to the next, rad or m.
    pub waypoints: Vec<Vec<f64>>,
    /// Euclidean length in joint space, rad (and m).
    pub cost_rad: f64,
    /// How long it takes, s.
    pub duration_s: f64,
    /// Corners at which it stops.
    pub stops: usize,
    /// Time (s) and values, linear between.
    pub rows: Vec<(f64, Vec<f64>)>,
}

impl PathAnswer {
    pub(super) fn none(robot: &CellRobot, took: Duration, reason: String) -> Self {
        Self {
            found: false,
            robot: robot.name.clone(),
            joints: robot.joint_names(),
            regions: Vec::new(),
            reason: Some(reason),
            planning_us: micros(took),
            simplify_us: 0,
            motion: None,
        }
    }

    pub(super) fn found(robot: &CellRobot, route: Route, motion: &Trajectory, rows: Vec<(f64, Vec<f64>)>) -> Self {
        let (duration_s, stops) = (motion.seconds(), motion.stops());
        Self {
            found: true,
            robot: robot.name.clone(),
            joints: robot.joint_names(),
            regions: Vec::new(),
            reason: None,
            planning_us: micros(route.planning),
            simplify_us: micros(route.simplifying),
            motion: Some(Motion { waypoints: route.waypoints, cost_rad: route.length_rad, duration_s, stops, rows }),
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
            waypoints: &'a [Vec<f64>],
            cost_rad: Option<f64>,
            duration_s: Option<f64>,
            stops: Option<usize>,
            planning_us: u64,
            simplify_us: u64,
        }
        let motion = self.motion.as_ref();
        let document = Document {
            found: self.found,
            reason: self.reason.as_deref(),
            robot: &self.robot,
            joints: &self.joints,
            regions: &self.regions,
            waypoints: motion.map_or(&[], |m| &m.waypoints),
            cost_rad: motion.map(|m| m.cost_rad),
            duration_s: motion.map(|m| m.duration_s),
            stops: motion.map(|m| m.stops),
            planning_us: self.planning_us,
            simplify_us: self.simplify_us,
        };
        document.serialize(serializer)
    }
}

fn micros(time: Duration) -> u64 {
    u64::try_from(time.as_micros()).unwrap_or(u64::MAX)
}

impl Motion {
    /// Writes `t_s` and a column per joint. Reading the numbers gives the same bits; a cell's `trajectory` takes the file.
    ///
    /// # Errors
    /// Whatever the writer says.
    pub fn write_csv(&self, joints: &[String], mut out: impl Write) -> io::Result<()> {
        writeln!(out, "t_s,{}", joints.join(","))?;
        for (t, q) in &self.rows {
            write!(out, "{t}")?;
            for v in q {
                write!(out, ",{v}")?;
            }
            writeln!(out)?;
        }
        out.flush()
    }
}
