//! Settings, limits and statistics of building a robot's map.

/// Largest number of axes of a map.
pub const MAX_JOINTS: usize = 8;

/// Settings of a [`RobotMapBuilder`](crate::RobotMapBuilder).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotMapSettings {
    /// Number of bisections of a cell at the boundary before it counts as blocked. `None`: until its parts are as small
    /// as [`boundary_resolution`](Self::boundary_resolution). 0 is fast but blocks more cells than necessary; 18 (about
    /// the number for 2 degrees at the default resolution) blocks hardly more than necessary. At most 60.
    pub bisections: Option<u32>,
    /// Half width of the smallest parts of a cell, rad (m for a prismatic joint): with this size, undecided parts are a
    /// small fraction of all blocked cells.
    pub boundary_resolution: f64,
    /// Number of checks of a cell of three axes before it counts as blocked; with more axes the boundary has more parts
    /// and fewer checks are made.
    pub max_checks_per_cell: u32,
    /// Memory limit of the map, bytes.
    pub max_bytes: usize,
    /// Number of threads; `None`: as many as the machine can run at once.
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
    /// Number of evaluated boxes of joint space, cells included.
    pub boxes: u64,
    /// Number of distance queries between a piece and an obstacle.
    pub distance_queries: u64,
    /// Number of collision queries at single configurations.
    pub collision_queries: u64,
    /// Number of cells that count as blocked because neither contact nor freedom was proven.
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
