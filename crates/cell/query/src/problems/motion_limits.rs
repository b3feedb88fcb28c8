//! Motion limits of the joints that a problem plans.

use elbowroom_cell::model_limits;
use elbowroom_kinematics::{Chain, JointLimits};

/// Limits of a joint that is held, in rad or m per s, s² and s³: they have no effect.
const HELD: JointLimits = JointLimits::new(1.0, 1.0, 1.0);

/// Limits of the joints: by the model, with the defaults of a cell file. `None` if a planned joint has no largest speed.
pub(super) fn of_chain(chain: &Chain, planned: &[bool]) -> Option<Vec<JointLimits>> {
    let joints = chain.active_joints().iter().map(|id| &chain.joints()[id.0]);
    let limits = joints.zip(planned).map(|(j, planned)| if *planned { model_limits(j) } else { Some(HELD) });
    limits.collect()
}
