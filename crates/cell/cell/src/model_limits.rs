//! Motion limits of the joints of a model.

use elbowroom_kinematics::{Joint, JointLimits};

/// Default time from full speed to rest.
pub(crate) const STOP_TIME_S: f64 = 0.1;
/// Default time from rest to full speed, if neither the model nor `acceleration` states one.
pub(crate) const ACCELERATION_TIME_S: f64 = 0.25;
/// Default time to full acceleration.
pub(crate) const JERK_TIME_S: f64 = 0.1;

/// Limits of a joint of a model, with the defaults of a cell file for missing values. `None` if the model states no
/// speed.
pub fn model_limits(joint: &Joint) -> Option<JointLimits> {
    let sane = |v: Option<f64>| v.filter(|v| *v > 0.0 && v.is_finite());
    let velocity = sane(joint.limits.velocity)?;
    let acceleration = sane(joint.limits.acceleration).unwrap_or(velocity / ACCELERATION_TIME_S);
    let rates =
        JointLimits::new(velocity, acceleration, acceleration / JERK_TIME_S).stopping_at(velocity / STOP_TIME_S);
    Some(rates.within(joint.limits.lower, joint.limits.upper))
}
