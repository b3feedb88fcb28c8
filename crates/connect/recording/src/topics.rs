//! Topics of a recording.

pub(crate) const METADATA: &str = "elbowroom";
pub(crate) const ROBOT_DESCRIPTION: &str = "/robot_description";
pub(crate) const TF: &str = "/tf";
pub(crate) const TF_STATIC: &str = "/tf_static";
pub(crate) const JOINT_STATES: &str = "/joint_states";
pub(crate) const DIAGNOSTICS: &str = "/diagnostics";
pub(crate) const REGIONS: &str = "/elbowroom/regions";
pub(crate) const NEAREST_POINTS: &str = "/elbowroom/nearest_points";
pub(crate) const STATUS: &str = "/elbowroom/status";
pub(crate) const CONFIGURATION: &str = "/elbowroom/configuration";
pub(crate) const TICK: &str = "/elbowroom/tick";
pub(crate) const LOST: &str = "/elbowroom/lost";
