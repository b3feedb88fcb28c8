//! Interface of the planners that solve a set of problems.

use elbowroom_kinematics::{JointLimits, LinkId};
use std::time::Duration;

use elbowroom_planner::{AnytimePath, JointPath, RrtConnectError, TimedPath};

use super::ProblemScene;

/// A planner that solves problems one after the other. It may reuse what it computes for the robot.
pub trait PlanningEngine {
    /// Plans from the start to one of the goals, all of which are free. Every stretch of the path is proven free. With
    /// [`optimize`](ProblemSettings::optimize) the path is shortened until the time limit.
    ///
    /// # Errors
    /// No path was found.
    fn solve(&mut self, problem: &ProblemScene, settings: &ProblemSettings) -> Result<AnytimePath, Unsolved>;

    /// Moves a link straight from its pose at the start to its pose at one of the goals, in one posture, proven free. By
    /// default no line is found.
    ///
    /// # Errors
    /// No such line can be followed.
    fn solve_linear(
        &mut self,
        problem: &ProblemScene,
        link: LinkId,
        settings: &ProblemSettings,
    ) -> Result<JointPath, Unsolved> {
        let _ = (problem, link, settings);
        Err(RrtConnectError::LinearMoveWithoutCovers.into())
    }

    /// Times a path that it found, within limits.
    ///
    /// # Errors
    /// As for [`RrtConnect::time_parametrize`](elbowroom_planner::RrtConnect::time_parametrize).
    fn time(
        &mut self,
        problem: &ProblemScene,
        path: JointPath,
        limits: &[JointLimits],
        settings: &ProblemSettings,
    ) -> Result<TimedPath, RrtConnectError>;
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

/// Why a planner has no path.
#[derive(Debug, Clone, PartialEq)]
pub struct Unsolved {
    /// The reason.
    pub reason: String,
    /// Time of the search.
    pub planning: Duration,
}
