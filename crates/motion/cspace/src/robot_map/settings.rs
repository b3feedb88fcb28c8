//! Settings, limits and statistics of building a robot's map.

/// Most axes of a map.
pub const MAX_JOINTS: usize = 8;

/// Settings of a [`RobotMapBuilder`](crate::RobotMapBuilder).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotMapSettings {
    /// How often a cell at the boundary is bisected before it counts as blocked; `None`: until its parts are as small as
    /// [`boundary_resolution`](Self::boundary_resolution). 0 is fast and blocks more cells than necessary; 18 (about what 2
    /// degrees need for the default resolution) hardly more. At most 60.
    pub bisections: Option<u32>,
    /// Half width of the smallest parts of a cell, rad (m where a joint slides): undecided parts are then few of all blocked
    /// cells.
    pub boundary_resolution: f64,
    /// Checks of a cell of three axes before it counts as blocked; fewer with more axes, as its boundary has more parts.
    pub max_checks_per_cell: u32,
    /// Memory limit of the map, bytes.
    pub max_bytes: usize,
    /// Number of threads; `None`: as many as the machine runs at once.
    pub threads: Option<usize>,
}

impl Default for RobotMapSettings {
    fn default() -> Self {
        Self {
            bisections: None,
            boundary_resolution: 3e-4,
            max_checks_per_cell: 4096,
            max_bytes: 1 << 30,
            threads: None,
        }
    }
}

/// Statistics of building a map.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RobotMapStats {
    /// Boxes of joint space that were evaluated, cells included.
    pub boxes: u64,
    /// Distance queries between a piece and an obstacle.
    pub distance_queries: u64,
    /// Collision queries at single configurations.
    pub collision_queries: u64,
    /// Cells that count as blocked because neither contact nor freedom was proven.
    pub undecided: u64,
}

impl RobotMapStats {
    pub(super) fn add(&mut self, other: Self) {
        self.boxes += other.boxes;
        self.distance_queries += other.distance_queries;
        self.collision_queries += other.collision_queries;
        self.undecided += other.undecided;
    }
}
