//! Distances, speeds and times of a virtual robot.

/// Settings of a [`VirtualRobot`](crate::VirtualRobot).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CooperationSettings {
    /// Largest speed of the origin of the work-piece, m/s.
    pub speed_m_s: f64,
    /// Largest angular speed of the work-piece, rad/s.
    pub angular_speed_rad_s: f64,
    /// Time in which the work-piece gets from rest to the desired speed, and stops from it, s.
    pub ramp_s: f64,
    /// Distance from everything else that a free arm keeps, and at which the work-piece stops, m.
    pub gap_m: f64,
    /// Speed of a hand on its way from the pre-grasp to the grasp, and back, m/s.
    pub approach_m_s: f64,
    /// Time that a hand takes to close or to open, s.
    pub settle_s: f64,
    /// How far ahead the motion is foreseen, s.
    pub horizon_s: f64,
    /// A hand-over begins when the holder will fail within its duration times one plus this.
    pub reserve: f64,
    /// A receiver must be able to hold the work-piece longer than the giver by this time, s.
    pub gain_s: f64,
    /// Least time between two hand-overs, while the work-piece moves, s.
    pub rest_s: f64,
    /// Share of the joint speeds that a foreseen motion may need.
    pub speed_share: f64,
    /// Least singular value of the Jacobian of a foreseen configuration. Metres are divided by the reach of the arm.
    pub least_singular_value: f64,
    /// Least distance to the limit of a joint in a foreseen configuration, rad or m.
    pub joint_margin: f64,
    /// Share of the part of the work-piece in view of the camera that an arm may hide.
    pub hidden_share: f64,
}

impl Default for CooperationSettings {
    fn default() -> Self {
        Self {
            speed_m_s: 0.25,
            angular_speed_rad_s: 1.0,
            ramp_s: 0.2,
            gap_m: 0.01,
            approach_m_s: 0.1,
            settle_s: 0.3,
            horizon_s: 5.0,
            reserve: 0.3,
            gain_s: 0.5,
            rest_s: 1.0,
            speed_share: 0.8,
            least_singular_value: 0.02,
            joint_margin: 0.02,
            hidden_share: 0.3,
        }
    }
}

impl CooperationSettings {
    /// Whether every number is finite and positive, and shares are at most 1.
    pub(crate) fn is_usable(&self) -> bool {
        let positive = [
            self.speed_m_s,
            self.angular_speed_rad_s,
            self.ramp_s,
            self.gap_m,
            self.approach_m_s,
            self.settle_s,
            self.horizon_s,
            self.gain_s,
            self.speed_share,
        ];
        let not_negative = [self.reserve, self.rest_s, self.least_singular_value, self.joint_margin, self.hidden_share];
        positive.iter().all(|v| *v > 0.0 && v.is_finite())
            && not_negative.iter().all(|v| *v >= 0.0 && v.is_finite())
            && self.speed_share.max(self.hidden_share) <= 1.0
    }
}
