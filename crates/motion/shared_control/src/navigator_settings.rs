//! Settings of a navigator.

use crate::NavigatorError;

/// Speed and clearance of a navigator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NavigatorSettings {
    /// Distance at which the tool glides along a surface, metres. It rounds the path at ridges with this radius: a
    /// larger gap makes the motion smoother and keeps the tool farther away.
    pub gap_m: f64,
    /// Distance that is never undercut, metres; below `gap_m`. What lies between the two is left for errors of
    /// the linear model in one step and for turning.
    pub least_gap_m: f64,
    /// Largest speed of the tool point, m/s.
    pub speed_m_s: f64,
    /// Largest angular speed, rad/s.
    pub turn_rad_s: f64,
    /// Acceleration with which the tool follows the hand and slows down before a surface, m/s². At ridges and for the
    /// last micrometres the tool slows down as fast as the surface demands.
    pub acceleration_m_s2: f64,
    /// Speed towards a surface per distance to the gap, 1/s, for small distances.
    pub approach_rate_1_s: f64,
    /// Longest duration of one step, seconds. A longer one is not a control cycle, and the tool stands.
    pub longest_step_s: f64,
}

impl Default for NavigatorSettings {
    /// Half a millimetre of gap, 0.25 m/s: the speed limit of ISO 10218-1 for manual guidance is of that size.
    fn default() -> Self {
        Self {
            gap_m: 0.5e-3,
            least_gap_m: 0.25e-3,
            speed_m_s: 0.25,
            turn_rad_s: 1.0,
            acceleration_m_s2: 5.0,
            approach_rate_1_s: 100.0,
            longest_step_s: 0.05,
        }
    }
}

impl NavigatorSettings {
    /// Checks the settings.
    ///
    /// # Errors
    /// The first setting that is not a positive number, or a least gap that is not below the gap.
    pub(crate) fn check(&self) -> Result<(), NavigatorError> {
        NavigatorError::check_positive(&[
            ("gap_m", self.gap_m),
            ("least_gap_m", self.least_gap_m),
            ("speed_m_s", self.speed_m_s),
            ("turn_rad_s", self.turn_rad_s),
            ("acceleration_m_s2", self.acceleration_m_s2),
            ("approach_rate_1_s", self.approach_rate_1_s),
            ("longest_step_s", self.longest_step_s),
        ])?;
        if self.least_gap_m >= self.gap_m {
            let wanted = "less than gap_m";
            return Err(NavigatorError::Setting { name: "least_gap_m", value: self.least_gap_m, wanted });
        }
        Ok(())
    }

    /// Largest speed towards a surface at this distance, m/s; negative below the gap: the tool moves away.
    ///
    /// Near the gap it is proportional to the distance that is left, farther away it is the speed from which the tool
    /// stops in that distance. A step of `dt_s` goes at most half of the way.
    pub(crate) fn approach_speed(&self, gap_m: f64, dt_s: f64) -> f64 {
        let left = gap_m - self.gap_m;
        let rate = self.approach_rate_1_s.min(0.5 / dt_s);
        if left < 0.0 {
            return (rate * left).max(-0.5 * self.speed_m_s);
        }
        (rate * left).min((2.0 * self.acceleration_m_s2 * left).sqrt())
    }

    /// Distance beyond which no surface limits this speed, metres: there [`Self::approach_speed`] exceeds it.
    pub(crate) fn influence_m(&self, speed_m_s: f64, dt_s: f64) -> f64 {
        let rate = self.approach_rate_1_s.min(0.5 / dt_s);
        self.gap_m + (speed_m_s / rate).max(speed_m_s * speed_m_s / (2.0 * self.acceleration_m_s2))
    }
}
