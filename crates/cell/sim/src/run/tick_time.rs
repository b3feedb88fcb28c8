//! The times of ticks.

/// Time of a tick, s, rounded to nanoseconds.
pub(super) fn tick_time_s(tick: u64, tick_s: f64) -> f64 {
    (tick as f64 * tick_s * 1e9).round() / 1e9
}

/// Time of the tick after the one at `t_s`, exactly as [`tick_time_s`] gives it.
pub(super) fn next_tick_time_s(t_s: f64, tick_s: f64) -> f64 {
    tick_time_s((t_s / tick_s).round() as u64 + 1, tick_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_tick_is_the_next_tick_to_the_bit() {
        for tick_s in [0.001, 0.002, 0.004, 1.0 / 3000.0, 0.0125] {
            for tick in 0..100_000 {
                assert_eq!(next_tick_time_s(tick_time_s(tick, tick_s), tick_s), tick_time_s(tick + 1, tick_s));
            }
        }
    }
}
