//! A straight stretch: up to a speed, along, down to another.

use super::limits::Along;
use super::ramp::Ramp;

/// Halvings: far below rounding of any speed.
const HALVINGS: usize = 60;

/// How a straight stretch is gone.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leg {
    up: Ramp,
    down: Ramp,
    top: f64,
    /// Seconds at the top speed.
    hold: f64,
}

impl Leg {
    /// Fastest from one speed to another over a length, which is enough for the change.
    pub fn new(length: f64, from: f64, to: f64, limits: Along) -> Self {
        let ramps = |top: f64| (Ramp::new(from, top, limits), Ramp::new(top, to, limits));
        let over = |top: f64| {
            let (up, down) = ramps(top);
            up.distance() + down.distance()
        };
        let top = greatest(from.max(to), limits.speed, |top| over(top) <= length);
        let (up, down) = ramps(top);
        let rest = (length - up.distance() - down.distance()).max(0.0);
        Self { up, down, top, hold: if top > 0.0 { rest / top } else { 0.0 } }
    }

    pub fn seconds(&self) -> f64 {
        self.up.seconds + self.hold + self.down.seconds
    }

    /// Distance, speed and acceleration after `t` seconds.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let held = t - self.up.seconds;
        if held < 0.0 {
            return self.up.at(t);
        }
        let up = self.up.distance();
        if held < self.hold {
            return [up + self.top * held, self.top, 0.0];
        }
        let [s, v, a] = self.down.at(held - self.hold);
        [up + self.top * self.hold + s, v, a]
    }
}

/// The greatest value of `low..=high` for which something holds that holds for `low` and for all below one that it holds
/// for.
pub(super) fn greatest(low: f64, high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    if low >= high || holds(high) {
        return high.max(low);
    }
    let (mut good, mut bad) = (low, high);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (good + bad);
        if holds(middle) { good = middle } else { bad = middle }
    }
    good
}
