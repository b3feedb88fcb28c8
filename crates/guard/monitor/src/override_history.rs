//! The recently commanded overrides, which the robot may still be executing.

use std::collections::VecDeque;

/// Number of overrides that are stored; if more are pending, the oldest two are merged.
const CAPACITY: usize = 256;

/// A commanded override.
#[derive(Debug, Clone, Copy)]
struct CommandedOverride {
    at_s: f64,
    /// The largest of this override and all later ones.
    max: f64,
    /// The smallest of this override and all later ones.
    min: f64,
}

/// Range of the overrides that the robot may be executing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct OverrideRange {
    pub(crate) max: f64,
    pub(crate) min: f64,
}

/// Upper bounds of the robot's motion until the override of this tick takes effect.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct PendingMotion {
    /// Program time that passes, s.
    pub(crate) program_s: f64,
    /// Override at the end.
    pub(crate) speed_override: f64,
}

/// Stop time of the program and its rate of change.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StopTime {
    /// Stop time m at override 1, s.
    pub(crate) full_stop_s: f64,
    /// Bound α of the rate of change of m by program time.
    pub(crate) growth: f64,
}

/// The commanded overrides that may still be in effect. A robot executes a lower override up to the reaction time
/// late, a higher override at once.
#[derive(Debug)]
pub(crate) struct OverrideHistory {
    reaction_s: f64,
    /// Age (s) of the oldest valid snapshot: overrides that had no effect before it are removed.
    stale_s: f64,
    commanded: VecDeque<CommandedOverride>,
    /// Time of the first override, s.
    first_s: f64,
}

impl OverrideHistory {
    pub(crate) fn new(reaction_s: f64, stale_s: f64) -> Self {
        Self { reaction_s, stale_s, commanded: VecDeque::with_capacity(CAPACITY), first_s: f64::INFINITY }
    }

    pub(crate) fn push(&mut self, now_s: f64, speed_override: f64) {
        self.first_s = self.first_s.min(now_s);
        for c in &mut self.commanded {
            (c.max, c.min) = (c.max.max(speed_override), c.min.min(speed_override));
        }
        if self.commanded.len() == CAPACITY {
            let oldest = self.commanded.pop_front();
            if let (Some(oldest), Some(next)) = (oldest, self.commanded.front_mut()) {
                let (max, min) = (oldest.max.max(next.max), oldest.min.min(next.min));
                *next = CommandedOverride { at_s: oldest.at_s, max, min };
            }
        }
        self.commanded.push_back(CommandedOverride { at_s: now_s, max: speed_override, min: speed_override });
        self.remove_expired(now_s - self.stale_s);
    }

    /// Removes the overrides without effect at `stamp_s`.
    fn remove_expired(&mut self, stamp_s: f64) {
        while self.commanded.get(1).is_some_and(|next| next.at_s + self.reaction_s <= stamp_s) {
            self.commanded.pop_front();
        }
    }

    /// The largest override that may be in effect, and the time (s) from which no larger one may be.
    pub(crate) fn largest(&self) -> (f64, f64) {
        self.commanded.front().map_or((0.0, f64::NEG_INFINITY), |c| (c.max, c.at_s + self.reaction_s))
    }

    /// The overrides that may be in effect at `now_s`. Before the first override the robot is at rest.
    pub(crate) fn range(&self, now_s: f64) -> OverrideRange {
        let Some(oldest) = self.commanded.front() else { return OverrideRange::default() };
        let min = if now_s - self.first_s >= self.reaction_s { oldest.min } else { 0.0 };
        OverrideRange { max: oldest.max, min }
    }

    /// Bounds the motion from `stamp_s` until an override commanded at `now_s` takes effect. At `stamp_s` the robot runs
    /// at the override `running`. `stop_time` returns the stop time after some program time. While the robot is faster
    /// than commanded, its override falls by at least `(1 − α·σ²) / m` per second.
    pub(crate) fn pending_motion(
        &mut self,
        stamp_s: f64,
        now_s: f64,
        running: f64,
        stop_time: impl Fn(f64) -> StopTime,
    ) -> PendingMotion {
        self.remove_expired(stamp_s);
        let (mut at_s, mut sigma, mut program_s) = (stamp_s, running, 0.0);
        for (i, command) in self.commanded.iter().enumerate() {
            let ends_s = self.commanded.get(i + 1).map_or(now_s, |next| next.at_s) + self.reaction_s;
            let time = ends_s - at_s;
            if time <= 0.0 {
                continue;
            }
            at_s = ends_s;
            if sigma <= command.max {
                sigma = command.max;
                program_s += sigma * time;
                continue;
            }
            let StopTime { full_stop_s, growth } = stop_time(program_s + sigma * time);
            let rate = (1.0 - growth * sigma * sigma).max(0.0) / full_stop_s.max(1e-9);
            let next = (sigma - rate * time).max(command.max);
            program_s += 0.5 * (sigma + next) * time;
            sigma = next;
        }
        program_s += sigma * (now_s + self.reaction_s - at_s).max(0.0);
        PendingMotion { program_s, speed_override: sigma }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stop_time(full_stop_s: f64) -> impl Fn(f64) -> StopTime {
        move |_| StopTime { full_stop_s, growth: 0.0 }
    }

    #[test]
    fn a_lower_override_counts_after_the_reaction_time_and_a_higher_one_at_once() {
        let mut history = OverrideHistory::new(0.01, 0.02);
        history.push(0.0, 0.5);
        let pending = history.pending_motion(0.0, 0.002, 0.5, stop_time(1e12));
        assert_eq!(pending, PendingMotion { program_s: 0.5 * 0.012, speed_override: 0.5 });
        history.push(0.002, 0.25);
        // 0.5 is in effect until 0.012, then 0.25; but the robot does not brake.
        let pending = history.pending_motion(0.002, 0.004, 0.5, stop_time(1e12));
        assert!((pending.program_s - 0.5 * 0.012).abs() < 1e-12 && (pending.speed_override - 0.5).abs() < 1e-9);
        // It brakes at once: from 0.5 to 0.25 within the last 2 ms.
        let pending = history.pending_motion(0.002, 0.004, 0.5, stop_time(1e-6));
        let expected = 0.5 * 0.01 + 0.375 * 0.002;
        assert!((pending.program_s - expected).abs() < 1e-12 && pending.speed_override == 0.25);
        history.push(0.004, 0.9);
        assert_eq!(history.pending_motion(0.004, 0.006, 0.5, stop_time(1e12)).speed_override, 0.9);
    }

    #[test]
    fn overrides_beyond_the_capacity_are_merged_not_dropped() {
        let mut history = OverrideHistory::new(1.0, 0.02);
        history.push(0.0, 1.0);
        for i in 1..1000 {
            history.push(1e-3 * f64::from(i), 0.0);
        }
        assert_eq!(history.largest().0, 1.0);
        let pending = history.pending_motion(0.5, 0.999, 1.0, stop_time(1e-6));
        assert!(pending.program_s > 0.5, "the first override is still in effect: {}", pending.program_s);
    }
}
