//! What planning answers.

/// One of the two ends of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// Where the arm is.
    Start,
    /// Where it shall go.
    Goal,
}

impl std::fmt::Display for End {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Start => "start",
            Self::Goal => "goal",
        })
    }
}

/// A way through free cells: straight in joint space from each waypoint to the next.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// Values of the map's three joints, radians; at least one, the first where the path starts.
    pub waypoints: Vec<[f64; 3]>,
    /// Length in joint space, weighted, radians.
    pub length_rad: f64,
    /// How far the first waypoint is from the start that was asked for, weighted radians: 0 unless its cell is blocked.
    pub start_moved_rad: f64,
    /// The same at the goal.
    pub goal_moved_rad: f64,
}

/// Why there is no path.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// The map has no such configuration.
    #[error(
        "the {end} is outside the map: joint {joint} is {value} rad, its range is {min} to {max} rad: bring it within the limits"
    )]
    Outside {
        /// Start or goal.
        end: End,
        /// Number of the joint in the map.
        joint: usize,
        /// Its value, radians.
        value: f64,
        /// Lower limit, radians.
        min: f64,
        /// Upper limit, radians.
        max: f64,
    },
    /// The cell is blocked and so are all around it.
    #[error(
        "the {end} is in a blocked cell and no free one is within {radius_rad} rad: move it, or allow a larger radius"
    )]
    Blocked {
        /// Start or goal.
        end: End,
        /// How far a free cell was looked for, weighted radians.
        radius_rad: f64,
    },
    /// Start and goal are free and not joined.
    #[error(
        "no path: the free cells of the start and those of the goal are not joined: take an obstacle away, or use a finer map"
    )]
    NoPath,
    /// A weight or the radius cannot be used.
    #[error("{what} is {value}: weights must be finite and above 0, the radius 0 or more")]
    Option {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The table is not one of the planner's grid.
    #[error("the table has {table:?} cells, the grid {grid:?}: use the table of the map that the grid belongs to")]
    Shape {
        /// Numbers of cells of the table.
        table: [usize; 3],
        /// Numbers of cells of the grid.
        grid: [usize; 3],
    },
}
