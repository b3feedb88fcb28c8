//! Controllers obey late: an override counts only after the reaction time.

use std::collections::VecDeque;

use crate::motion::Clock;

/// The overrides that one robot was told and has not obeyed yet.
#[derive(Debug)]
pub(super) struct Delay {
    reaction_s: f64,
    /// When each begins to count, s.
    told: VecDeque<(f64, f64)>,
    obeyed: f64,
}

impl Delay {
    pub fn new(reaction_s: f64) -> Self {
        Self { reaction_s, told: VecDeque::new(), obeyed: 0.0 }
    }

    /// The robot is told an override at `t_s`.
    pub fn tell(&mut self, t_s: f64, speed_override: f64) {
        self.told.push_back((t_s + self.reaction_s, speed_override));
    }

    /// The clock goes on from `t_s` for `dt` seconds, by what counts at each moment.
    pub fn advance(&mut self, clock: &mut Clock, t_s: f64, dt: f64) {
        let (mut at_s, end_s) = (t_s, t_s + dt);
        while let Some((from_s, speed_override)) = self.told.front().copied().filter(|(from_s, _)| *from_s < end_s) {
            if from_s > at_s + 1e-9 {
                clock.advance(from_s - at_s, self.obeyed);
                at_s = from_s;
            }
            self.obeyed = speed_override;
            self.told.pop_front();
        }
        clock.advance(end_s - at_s, self.obeyed);
    }
}
