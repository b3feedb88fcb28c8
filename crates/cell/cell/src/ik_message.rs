//! Errors of inverse kinematics in the units of the cell file.

use elbowroom_kinematics::inverse::IkError;
use elbowroom_kinematics::{Chain, JointKind};
use elbowroom_spatial::units::{AngleUnit, LengthUnit};

use crate::Units;

impl Units {
    /// Describes why inverse kinematics of `chain` has no solution, with lengths and angles in these units.
    ///
    /// ```
    /// use elbowroom_cell::Units;
    /// use elbowroom_kinematics::{Chain, inverse::IkError};
    /// use elbowroom_spatial::units::{AngleUnit, LengthUnit};
    /// let units = Units { length: LengthUnit::Millimetre, angle: AngleUnit::Degree };
    /// let error = IkError::Unreachable { position_error_m: 0.9, angle_error_rad: 0.0 };
    /// let text = units.describe_ik_error(&error, &Chain::from_dh("arm", &[])?);
    /// assert_eq!(text, "the target is out of reach: the closest found is 900.0 mm and 0.00 deg away");
    /// # Ok::<(), elbowroom_kinematics::ChainError>(())
    /// ```
    pub fn describe_ik_error(self, error: &IkError, chain: &Chain) -> String {
        let away = |position_m: f64, angle_rad: f64| {
            let [at, turn] = [self.rounded_length(position_m), self.rounded_angle(angle_rad)];
            format!("the closest found is {at} and {turn} away")
        };
        match error {
            IkError::Unreachable { position_error_m, angle_error_rad } => {
                format!("the target is out of reach: {}", away(*position_error_m, *angle_error_rad))
            }
            IkError::NoConvergence { position_error_m, angle_error_rad, restarts } => format!(
                "no answer after {restarts} starts: {}; begin nearer to it",
                away(*position_error_m, *angle_error_rad)
            ),
            IkError::Limits { joint, value, lower, upper } => {
                let id = chain.joint(joint);
                let is_prismatic = id.is_some_and(|id| chain.joints()[id.0].kind == JointKind::Prismatic);
                let show = |v: f64| if is_prismatic { self.rounded_length(v) } else { self.rounded_angle(v) };
                let [value, lower, upper] = [*value, *lower, *upper].map(show);
                format!(
                    "the target is reached only outside the joint limits: joint `{joint}` would have to be at {value} \
                     but may be {lower} to {upper}"
                )
            }
            other => other.to_string(),
        }
    }

    fn rounded_length(self, metres: f64) -> String {
        let digits = if self.length == LengthUnit::Metre { 4 } else { 1 };
        format!("{:.digits$} {}", metres / self.length.to_metres(1.0), self.length.symbol())
    }

    fn rounded_angle(self, radians: f64) -> String {
        let digits = if self.angle == AngleUnit::Radian { 4 } else { 2 };
        format!("{:.digits$} {}", radians / self.angle.to_radians(1.0), self.angle.symbol())
    }
}
