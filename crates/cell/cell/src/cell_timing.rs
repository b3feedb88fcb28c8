//! The control tick.

/// Control tick, and longest run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellTiming {
    /// Period of the control tick, s.
    pub tick_s: f64,
    /// Longest simulated time of a run, s.
    pub max_s: f64,
}

impl CellTiming {
    /// Time of a tick, s, rounded to nanoseconds.
    pub fn at(&self, tick: u64) -> f64 {
        (tick as f64 * self.tick_s * 1e9).round() / 1e9
    }

    /// Time of the tick after the one at `t_s`, exactly as [`at`](Self::at) gives it.
    pub fn after(&self, t_s: f64) -> f64 {
        self.at((t_s / self.tick_s).round() as u64 + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_tick_is_the_next_tick_to_the_bit() {
        for tick_s in [0.001, 0.002, 0.004, 1.0 / 3000.0, 0.0125] {
            let timing = CellTiming { tick_s, max_s: 1.0 };
            for tick in 0..100_000 {
                assert_eq!(timing.after(timing.at(tick)), timing.at(tick + 1));
            }
        }
    }
}
