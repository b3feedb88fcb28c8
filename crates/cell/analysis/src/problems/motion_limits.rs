//! Motion limits of the joints that a problem plans.

use elbowroom_cell::JointLimits;
use elbowroom_kinematics::Chain;
use elbowroom_planner::KinematicLimits;

/// Limits of a joint that is held, in rad or m per s, s² and s³: they have no effect.
const HELD: JointLimits = JointLimits { velocity: 1.0, acceleration: 1.0, jerk: 1.0, stop: 1.0 };

/// Limits of the joints: by the model, with the defaults of a cell file. `None` if a planned joint has no largest speed.
pub(super) fn of_chain(chain: &Chain, planned: &[bool]) -> Option<KinematicLimits> {
    let joints = chain.active_joints().iter().map(|id| &chain.joints()[id.0]);
    let limits = joints.zip(planned).map(|(j, planned)| if *planned { JointLimits::of_joint(j) } else { Some(HELD) });
    let limits: Vec<JointLimits> = limits.collect::<Option<_>>()?;
    Some(KinematicLimits {
        velocity: limits.iter().map(|l| l.velocity).collect(),
        acceleration: limits.iter().map(|l| l.acceleration).collect(),
        jerk: limits.iter().map(|l| l.jerk).collect(),
    })
}
