//! A solution of inverse kinematics.

/// Joint values within the limits that bring the tip to the target.
#[derive(Debug, Clone, PartialEq)]
pub struct IkSolution {
    /// Values of all of the chain's independent joints, rad or m; joints that do not move the tip are as in the seed.
    pub q: Vec<f64>,
    /// Distance of the tip from the target, m.
    pub position_error_m: f64,
    /// Angle of the tip from the target, rad.
    pub angle_error_rad: f64,
    /// Starting points tried beyond the seed; 0 in closed form.
    pub restarts: usize,
}
