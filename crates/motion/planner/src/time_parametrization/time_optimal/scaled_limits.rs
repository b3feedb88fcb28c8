//! Scaled limits: limits of the joints in a unit of time such that a section of a path takes about 1 unit.

use super::super::limits::{LimitKind, TimeParametrizationError};
use super::blended_path::PathSection;
use elbowroom_kinematics::JointLimits;

/// Bounds of the limits (per length of the section, in the scaled unit of time). Larger limits are never reached; they
/// are reduced to these bounds so that sums and products stay finite.
const LARGEST: [f64; 3] = [1e6, 1e7, 1e8];

/// Limits of a section of a path.
#[derive(Debug, Clone)]
pub(super) struct ScaledLimits {
    /// Limits per scaled unit of time and its powers.
    pub limits: Vec<JointLimits>,
    /// The unit of time, s.
    pub unit: f64,
}

impl ScaledLimits {
    /// Scales limits. The unit is the longest of the least times that each joint needs for its path by each of its
    /// limits.
    pub fn new(section: &PathSection, limits: &[JointLimits]) -> Result<Self, TimeParametrizationError> {
        let mut unit: f64 = 0.0;
        for joint in 0..limits.len() {
            let far: f64 = section.elements.iter().map(|e| e.length * e.direction[joint].abs()).sum();
            let times = [
                (LimitKind::Velocity, limits[joint].velocity, far / limits[joint].velocity),
                (LimitKind::Acceleration, limits[joint].acceleration, (far / limits[joint].acceleration).sqrt()),
                (LimitKind::Jerk, limits[joint].jerk, (far / limits[joint].jerk).cbrt()),
            ];
            for (kind, value, time) in times {
                if !time.is_finite() {
                    return Err(TimeParametrizationError::Limit { joint, kind, value });
                }
                unit = unit.max(time);
            }
        }
        let scaled = |value: f64, order: i32| {
            let most = LARGEST[order as usize - 1] * section.length;
            (value * unit.powi(order)).min(most).max(f64::MIN_POSITIVE)
        };
        let scaled =
            |l: &JointLimits| JointLimits::new(scaled(l.velocity, 1), scaled(l.acceleration, 2), scaled(l.jerk, 3));
        let limits = limits.iter().map(scaled).collect();
        Ok(Self { limits, unit })
    }
}
