//! Errors of inverse kinematics in the units of the cell file.

use std::fmt;

use elbowroom_kinematics::inverse::IkError;
use elbowroom_kinematics::{Chain, JointKind};
use elbowroom_spatial::units::{AngleUnit, LengthUnit};

use crate::Units;

/// Why inverse kinematics of a robot has no solution, displayed with lengths and angles in the units of its cell.
#[derive(Debug, Clone, PartialEq)]
pub struct CellIkError {
    error: IkError,
    units: Units,
    /// Whether the joint that the error names is prismatic.
    is_prismatic: bool,
}

impl CellIkError {
    /// Creates the error of a chain.
    ///
    /// ```
    /// use elbowroom_cell::{CellIkError, Units};
    /// use elbowroom_kinematics::{Chain, inverse::IkError};
    /// use elbowroom_spatial::units::{AngleUnit, LengthUnit};
    /// let units = Units { length: LengthUnit::Millimetre, angle: AngleUnit::Degree };
    /// let error = IkError::Unreachable { position_error_m: 0.9, angle_error_rad: 0.0 };
    /// let error = CellIkError::new(error, units, &Chain::from_dh("arm", &[])?);
    /// assert_eq!(error.to_string(), "the target is out of reach: the closest found is 900.0 mm and 0.00 deg away");
    /// # Ok::<(), elbowroom_kinematics::ChainError>(())
    /// ```
    pub fn new(error: IkError, units: Units, chain: &Chain) -> Self {
        let joint = if let IkError::Limits { joint, .. } = &error { chain.joint(joint) } else { None };
        let is_prismatic = joint.is_some_and(|id| chain.joints()[id.0].kind == JointKind::Prismatic);
        Self { error, units, is_prismatic }
    }
}

impl fmt::Display for CellIkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let units = self.units;
        let away = |position_m: f64, angle_rad: f64| {
            let [at, turn] = [units.rounded_length(position_m), units.rounded_angle(angle_rad)];
            format!("the closest found is {at} and {turn} away")
        };
        match &self.error {
            IkError::Unreachable { position_error_m, angle_error_rad } => {
                write!(f, "the target is out of reach: {}", away(*position_error_m, *angle_error_rad))
            }
            IkError::NoConvergence { position_error_m, angle_error_rad, restarts } => {
                let away = away(*position_error_m, *angle_error_rad);
                write!(f, "no answer after {restarts} starts: {away}; begin nearer to it")
            }
            IkError::Limits { joint, value, lower, upper } => {
                let show = |v: f64| if self.is_prismatic { units.rounded_length(v) } else { units.rounded_angle(v) };
                let [value, lower, upper] = [*value, *lower, *upper].map(show);
                write!(
                    f,
                    "the target is reached only outside the joint limits: joint `{joint}` would have to be at {value} \
                     but may be {lower} to {upper}"
                )
            }
            other => other.fmt(f),
        }
    }
}

impl std::error::Error for CellIkError {}

impl Units {
    fn rounded_length(self, metres: f64) -> String {
        let digits = if self.length == LengthUnit::Metre { 4 } else { 1 };
        format!("{:.digits$} {}", metres / self.length.to_metres(1.0), self.length.symbol())
    }

    fn rounded_angle(self, radians: f64) -> String {
        let digits = if self.angle == AngleUnit::Radian { 4 } else { 2 };
        format!("{:.digits$} {}", radians / self.angle.to_radians(1.0), self.angle.symbol())
    }
}
