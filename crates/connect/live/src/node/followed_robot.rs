//! Robot whose joint values determine the places of regions.

use elbowroom_interlock::Micros;
use elbowroom_kinematics::{Chain, ChainState};

use super::inbox::Heard;

/// Longest time between two positions that give a velocity.
pub(super) const SAME_MOTION: Micros = Micros(100_000);

/// State of a robot that is followed.
#[derive(Debug, Clone, Default)]
pub(super) struct FollowedRobot {
    /// Time of the joint values in its chain, on the clock of its controller.
    stamp: Option<Micros>,
    /// Whether its velocities are given, or follow from the last two positions. A robot of unknown velocity does not
    /// count as at rest.
    knows_velocities: bool,
    /// Age of its joint values; `None` if its position or its velocity is unknown.
    pub(super) age: Option<Micros>,
}

impl FollowedRobot {
    /// Moves its chain to the last received position, if it is new, and updates the age.
    pub(super) fn take(&mut self, heard: &mut Heard, chain: &Chain, state: &mut ChainState, now: Micros) {
        if std::mem::take(&mut heard.is_new) {
            self.follow(heard, state);
            chain.forward_motion(state);
        }
        let stamp = heard.stamp.filter(|_| self.knows_velocities);
        self.age = stamp.map(|stamp| heard.now(now) - stamp);
    }

    fn follow(&mut self, heard: &Heard, state: &mut ChainState) {
        let (values, before) = (&heard.state, std::mem::replace(&mut self.stamp, heard.stamp));
        if values.q.len() != state.q.len() {
            (self.stamp, self.knows_velocities) = (None, false);
            return;
        }
        if values.qd.len() == state.qd.len() {
            state.qd.copy_from_slice(&values.qd);
            self.knows_velocities = true;
        } else {
            let passed = before.zip(self.stamp).map(|(before, stamp)| stamp - before);
            self.knows_velocities = self.derive_velocities(&values.q, passed, state);
        }
        state.q.copy_from_slice(&values.q);
        state.qdd.fill(0.0);
    }

    /// Computes the mean velocities since the previous positions; false if they cannot be known.
    fn derive_velocities(&self, q: &[f64], passed: Option<Micros>, state: &mut ChainState) -> bool {
        let Some(passed) = passed.filter(|passed| *passed <= SAME_MOTION) else { return false };
        if passed == Micros(0) {
            return self.knows_velocities;
        }
        let rate = 1e6 / passed.0 as f64;
        for (velocity, (now, before)) in state.qd.iter_mut().zip(q.iter().zip(&state.q)) {
            *velocity = (now - before) * rate;
        }
        true
    }
}
