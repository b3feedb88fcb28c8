//! Settings of inverse kinematics.

/// The method by which an [`IkSolver`](super::IkSolver) finds its solutions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IkMethod {
    /// Closed form for six axes with a spherical wrist.
    SphericalWrist,
    /// Damped least squares with restarts.
    Numeric,
}

/// What must match the target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum IkTask {
    /// Position and orientation.
    #[default]
    Pose,
    /// Position alone; the orientation is free.
    Position,
}

/// Settings of an [`IkSolver`](super::IkSolver).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IkOptions {
    /// What must match the target.
    pub task: IkTask,
    /// Largest accepted distance from the target, m.
    pub position_tolerance_m: f64,
    /// Largest accepted rotation from the target, rad.
    pub angle_tolerance_rad: f64,
    /// Numeric method: largest number of starting points, including the seed.
    pub restarts: usize,
    /// Numeric method: largest number of iterations from one starting point.
    pub iterations: usize,
}

impl Default for IkOptions {
    fn default() -> Self {
        Self {
            task: IkTask::Pose,
            position_tolerance_m: 1e-9,
            angle_tolerance_rad: 1e-9,
            restarts: 100,
            iterations: 60,
        }
    }
}
