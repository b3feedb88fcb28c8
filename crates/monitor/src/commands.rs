//! What the robot was told, and what it may therefore still be doing.

use std::collections::VecDeque;

/// Answers that are remembered; where more are under way at once, the oldest are taken together.
const MOST: usize = 256;

/// An answer.
#[derive(Debug, Clone, Copy)]
struct Command {
    at_s: f64,
    /// The largest override of this answer and all later ones.
    largest: f64,
    /// The least of them.
    least: f64,
}

/// Overrides that the robot may be obeying.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Obeyed {
    pub(crate) largest: f64,
    pub(crate) least: f64,
}

/// Overrides that were asked for and may still count: a robot obeys a lower one up to the reaction time late, a higher one
/// at once.
#[derive(Debug)]
pub(crate) struct Commands {
    reaction_s: f64,
    /// No snapshot that is older than this (s) is believed: what counted no more before it is forgotten.
    stale_s: f64,
    issued: VecDeque<Command>,
    /// When the first answer was given, s.
    since_s: f64,
}

impl Commands {
    pub(crate) fn new(reaction_s: f64, stale_s: f64) -> Self {
        Self { reaction_s, stale_s, issued: VecDeque::with_capacity(MOST), since_s: f64::INFINITY }
    }

    pub(crate) fn push(&mut self, now_s: f64, speed_override: f64) {
        self.since_s = self.since_s.min(now_s);
        for c in &mut self.issued {
            (c.largest, c.least) = (c.largest.max(speed_override), c.least.min(speed_override));
        }
        if self.issued.len() == MOST {
            let oldest = self.issued.pop_front();
            if let (Some(oldest), Some(next)) = (oldest, self.issued.front_mut()) {
                let (largest, least) = (oldest.largest.max(next.largest), oldest.least.min(next.least));
                *next = Command { at_s: oldest.at_s, largest, least };
            }
        }
        self.issued.push_back(Command { at_s: now_s, largest: speed_override, least: speed_override });
        self.forget(now_s - self.stale_s);
    }

    /// Forgets what counted no more at `stamp_s`.
    fn forget(&mut self, stamp_s: f64) {
        while self.issued.get(1).is_some_and(|next| next.at_s + self.reaction_s <= stamp_s) {
            self.issued.pop_front();
        }
    }

    /// The largest override that may still count.
    pub(crate) fn largest(&self) -> f64 {
        self.issued.front().map_or(0.0, |c| c.largest)
    }

    /// The overrides that may still count at `now_s`. Before the first answer the robot stands.
    pub(crate) fn obeyed(&self, now_s: f64) -> Obeyed {
        let Some(oldest) = self.issued.front() else { return Obeyed::default() };
        let least = if now_s - self.since_s >= self.reaction_s { oldest.least } else { 0.0 };
        Obeyed { largest: oldest.largest, least }
    }

    /// How much of the program's time passes at most from `stamp_s` until an answer given at `now_s` counts, and the override
    /// that the robot then has at most. It runs at `running` at `stamp_s`. `stop` says, for the program time passed, the stop
    /// time m at override 1 and how fast it can change by the program's time, α: while the robot is faster than it was told,
    /// its override falls by `(1 − α·σ²) / m` per second at least.
    pub(crate) fn run(
        &mut self,
        stamp_s: f64,
        now_s: f64,
        running: f64,
        stop: impl Fn(f64) -> (f64, f64),
    ) -> (f64, f64) {
        self.forget(stamp_s);
        let (mut at_s, mut sigma, mut run_s) = (stamp_s, running, 0.0);
        for (i, command) in self.issued.iter().enumerate() {
            let ends_s = self.issued.get(i + 1).map_or(now_s, |next| next.at_s) + self.reaction_s;
            let time = ends_s - at_s;
            if time <= 0.0 {
                continue;
            }
            at_s = ends_s;
            if sigma <= command.largest {
                sigma = command.largest;
                run_s += sigma * time;
                continue;
            }
            let (full_stop_s, growth) = stop(run_s + sigma * time);
            let fall = (1.0 - growth * sigma * sigma).max(0.0) / full_stop_s.max(1e-9);
            let then = (sigma - fall * time).max(command.largest);
            run_s += 0.5 * (sigma + then) * time;
            sigma = then;
        }
        run_s += sigma * (now_s + self.reaction_s - at_s).max(0.0);
        (run_s, sigma)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lower_override_counts_after_the_reaction_time_and_a_higher_one_at_once() {
        let mut c = Commands::new(0.01, 0.02);
        let never = |_: f64| (1e12, 0.0);
        c.push(0.0, 0.5);
        assert_eq!(c.run(0.0, 0.002, 0.5, never), (0.5 * 0.012, 0.5));
        c.push(0.002, 0.25);
        // 0.5 counts until 0.012, then 0.25; but the robot does not brake.
        let (run_s, sigma) = c.run(0.002, 0.004, 0.5, never);
        assert!((run_s - 0.5 * 0.012).abs() < 1e-12 && (sigma - 0.5).abs() < 1e-9);
        // It brakes at once: half of the way at 0.25.
        let (run_s, sigma) = c.run(0.002, 0.004, 0.5, |_| (1e-6, 0.0));
        assert!((run_s - (0.5 * 0.01 + 0.375 * 0.002)).abs() < 1e-12 && sigma == 0.25);
        c.push(0.004, 0.9);
        assert_eq!(c.run(0.004, 0.006, 0.5, never).1, 0.9);
    }

    #[test]
    fn many_answers_under_way_are_taken_together_not_forgotten() {
        let mut c = Commands::new(1.0, 0.02);
        c.push(0.0, 1.0);
        for i in 1..1000 {
            c.push(1e-3 * f64::from(i), 0.0);
        }
        assert_eq!(c.largest(), 1.0);
        let (run_s, _) = c.run(0.5, 0.999, 1.0, |_| (1e-6, 0.0));
        assert!(run_s > 0.5, "the first answer still counts: {run_s}");
    }
}
