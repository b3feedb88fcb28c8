//! Reaction time of controllers, after which an override takes effect.

use std::collections::VecDeque;

use crate::motion::ProgramClock;

/// An override that was sent.
#[derive(Debug, Clone, Copy)]
struct PendingOverride {
    /// Time at which it takes effect, s.
    from_s: f64,
    speed_override: f64,
}

/// The overrides sent to one robot that have not taken effect yet.
#[derive(Debug)]
pub(super) struct OverrideDelay {
    reaction_s: f64,
    pending: VecDeque<PendingOverride>,
    applied: f64,
}

impl OverrideDelay {
    pub fn new(reaction_s: f64) -> Self {
        Self { reaction_s, pending: VecDeque::new(), applied: 0.0 }
    }

    /// Sends an override at `t_s`.
    pub fn send(&mut self, t_s: f64, speed_override: f64) {
        self.pending.push_back(PendingOverride { from_s: t_s + self.reaction_s, speed_override });
    }

    /// Drops what was sent and has not taken effect, and holds the robot: a controller that asks before each step whether it may
    /// begin does not begin with the override of the step before.
    pub fn drop_sent(&mut self) {
        self.pending.clear();
        self.applied = 0.0;
    }

    /// Advances the clock from `t_s` by `dt` seconds, with the override in effect at each moment.
    ///
    /// If the controller `asks` before each step, a step that begins within the tick waits for the next one.
    pub fn advance(&mut self, clock: &mut ProgramClock, t_s: f64, dt: f64, asks: bool) {
        let (mut at_s, end_s) = (t_s, t_s + dt);
        let path = clock.path_number();
        while let Some(next) = self.pending.front().copied().filter(|next| next.from_s < end_s - 1e-9) {
            if next.from_s > at_s + 1e-9 && !(asks && clock.path_number() != path) {
                clock.advance(next.from_s - at_s, self.applied);
                at_s = next.from_s;
            }
            self.applied = next.speed_override;
            self.pending.pop_front();
        }
        if !(asks && clock.path_number() != path) {
            clock.advance(end_s - at_s, self.applied);
        }
    }
}
