//! Paths on the grid.

/// One of the two ends of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathEnd {
    /// The present configuration.
    Start,
    /// The configuration to reach.
    Goal,
}

impl std::fmt::Display for PathEnd {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Start => "start",
            Self::Goal => "goal",
        })
    }
}

/// A path through free cells: straight in joint space from each waypoint to the next.
#[derive(Debug, Clone, PartialEq)]
pub struct GridPath {
    /// Values of the map's three joints, radians; at least one waypoint. The first waypoint is the start.
    pub waypoints: Vec<[f64; 3]>,
    /// Weighted length in joint space, radians.
    pub length_rad: f64,
    /// Weighted distance of the first waypoint from the requested start, radians: 0 unless its cell is blocked.
    pub start_moved_rad: f64,
    /// Weighted distance of the last waypoint from the requested goal, radians: 0 unless its cell is blocked.
    pub goal_moved_rad: f64,
}

/// A setting of the [`GridPlanner`](crate::GridPlanner).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GridPlannerSetting {
    /// [`GridPlannerSettings::weights`](crate::GridPlannerSettings::weights).
    Weight,
    /// [`GridPlannerSettings::max_end_shift_rad`](crate::GridPlannerSettings::max_end_shift_rad).
    MaxEndShift,
}

impl std::fmt::Display for GridPlannerSetting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Weight => "a weight",
            Self::MaxEndShift => "the largest shift of an end",
        })
    }
}

/// Why a path cannot be planned.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GridPlannerError {
    /// A configuration is outside the grid.
    #[error(
        "the {end} is outside the map: joint {joint} is {value} rad, its range is {min} to {max} rad: bring it within the limits"
    )]
    Outside {
        /// Start or goal.
        end: PathEnd,
        /// Index of the joint in the map.
        joint: usize,
        /// Value of the joint, radians.
        value: f64,
        /// Lower limit, radians.
        min: f64,
        /// Upper limit, radians.
        max: f64,
    },
    /// The cell is blocked, and all cells around it are blocked.
    #[error(
        "the {end} is in a blocked cell and no free one is within {radius_rad} rad: move it, or allow a larger shift"
    )]
    Blocked {
        /// Start or goal.
        end: PathEnd,
        /// Search radius for a free cell, weighted radians.
        radius_rad: f64,
    },
    /// Start and goal are free but not connected.
    #[error(
        "no path: the free cells of the start and those of the goal are not joined: take an obstacle away, or use a finer map"
    )]
    NoPath,
    /// A weight, or the largest shift of an end, is invalid.
    #[error("{setting} is {value}: weights must be finite and above 0, the largest shift 0 or more")]
    InvalidSetting {
        /// The setting.
        setting: GridPlannerSetting,
        /// Value of the setting.
        value: f64,
    },
    /// The shapes of the occupancy and the planner's grid differ.
    #[error(
        "the occupancy bitmap has {occupancy:?} cells, the grid {grid:?}: use the bitmap of the map that the grid belongs to"
    )]
    Shape {
        /// Number of cells of the occupancy bitmap per axis.
        occupancy: [usize; 3],
        /// Number of cells of the grid per axis.
        grid: [usize; 3],
    },
}
