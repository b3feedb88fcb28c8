//! The result of planning.

use std::time::Duration;

use crate::interpolation::path_length;

/// A path from start to goal: straight in joint space from each waypoint to the next, and proven free.
#[derive(Debug, Clone, PartialEq)]
pub struct JointPath {
    /// All values of the robot, rad (m for prismatic joints), at least two waypoints; the first is the start.
    pub waypoints: Vec<Vec<f64>>,
    /// Euclidean length in joint space, rad (and m).
    pub length_rad: f64,
    /// Length before shortcutting.
    pub raw_length_rad: f64,
    /// Time of the search.
    pub planning_time: Duration,
    /// Time of shortcutting.
    pub simplification_time: Duration,
    /// Number of checked configurations.
    pub states_checked: u64,
}

impl JointPath {
    /// Creates a path from waypoints (at least one) and the time of the search; a single waypoint is duplicated.
    pub fn of(mut waypoints: Vec<Vec<f64>>, planning_time: Duration) -> Self {
        if let [only] = &waypoints[..] {
            waypoints.push(only.clone());
        }
        let length_rad = path_length(&waypoints);
        Self {
            waypoints,
            length_rad,
            raw_length_rad: length_rad,
            planning_time,
            simplification_time: Duration::ZERO,
            states_checked: 0,
        }
    }

    /// Adds straight segments to other ends.
    #[must_use]
    pub fn with_ends(mut self, [from, to]: [Vec<f64>; 2]) -> Self {
        let before = path_length(&self.waypoints);
        self.waypoints.insert(0, from);
        self.waypoints.push(to);
        self.waypoints.dedup();
        if self.waypoints.len() < 2 {
            self.waypoints.push(self.waypoints[0].clone());
        }
        self.length_rad = path_length(&self.waypoints);
        self.raw_length_rad += self.length_rad - before;
        self
    }
}
