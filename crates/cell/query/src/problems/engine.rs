//! Interface of the planners that solve a set of problems.

use elbowroom_kinematics::JointLimits;
use std::time::Duration;

use elbowroom_planner::{PlannedPath, RrtConnectError, TimedMotion};

use super::ProblemScene;

/// A planner that solves problems one after the other. It may reuse what it computes for the robot.
pub trait PlanningEngine {
    /// Plans from the start to one of the goals, all of which are free.
    fn solve(&mut self, problem: &ProblemScene, settings: &ProblemSettings) -> Solution;

    /// Times a path that it found, within limits.
    ///
    /// # Errors
    /// As for [`RrtConnect::time_parametrize`](elbowroom_planner::RrtConnect::time_parametrize).
    fn time(
        &mut self,
        problem: &ProblemScene,
        path: &PlannedPath,
        limits: &[JointLimits],
        settings: &ProblemSettings,
    ) -> Result<TimedMotion, RrtConnectError>;
}

/// Settings of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProblemSettings {
    /// Time limit of search and shortcutting per problem.
    pub time_limit: Duration,
    /// Distance that pairs keep, m.
    pub clearance_m: f64,
    /// Seed of the random numbers of each problem.
    pub seed: u64,
    /// Period of the samples of timed paths, s.
    pub period_s: f64,
    /// Whether the search continues until the time limit, with shorter and shorter paths.
    pub optimize: bool,
}

impl Default for ProblemSettings {
    /// 5 s, no clearance, seed 1, samples every 2 ms, the first path found.
    fn default() -> Self {
        Self { time_limit: Duration::from_secs(5), clearance_m: 0.0, seed: 1, period_s: 0.002, optimize: false }
    }
}

/// The answer of a planner to one problem.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Solution {
    /// True if a path was found.
    pub found: bool,
    /// True if every stretch of the path is proven free, not sampled.
    pub proven: bool,
    /// Time of the search.
    pub planning: Duration,
    /// Time of shortcutting.
    pub simplification: Duration,
    /// Length in joint space before shortcutting, rad (and m).
    pub cost_raw_rad: f64,
    /// Length of the path, rad (and m).
    pub cost_rad: f64,
    /// All values of the robot at each waypoint, straight in joint space in between; empty if none was found.
    pub waypoints: Vec<Vec<f64>>,
    /// Reason if no path was found.
    pub reason: Option<String>,
}
