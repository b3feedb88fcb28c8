//! Results of a controller, as a table and as JSON.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::latencies::Latencies;

/// Results of a controller.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Measured {
    pub robot: String,
    /// Number of joint states sent.
    pub sent: u64,
    /// Times from sending a joint state to receiving its answer.
    pub latencies: Latencies,
    /// Number of ticks without a valid answer: the robot would have stopped.
    pub missed: u64,
    /// Lateness of the controller's own ticks, between which it only sleeps: the delay that the machine adds to every
    /// wake-up.
    pub lateness: Latencies,
}

impl Measured {
    pub fn merge(&mut self, other: &Self) {
        self.sent += other.sent;
        self.latencies.merge(&other.latencies);
        self.missed += other.missed;
        self.lateness.merge(&other.lateness);
    }

    pub const HEADER: &str = "                              state in to override out, µs          own timer late, µs\n\
                              robot          sent  answered  median   p99  p99.9  worst  missed  median   p99  worst";

    pub fn row(&self) -> String {
        let at = |share| self.latencies.quantile_us(share);
        let late = |share| self.lateness.quantile_us(share);
        format!(
            "{:<10} {:>8} {:>9} {:>7} {:>5} {:>6} {:>6} {:>7} {:>7} {:>5} {:>6}",
            self.robot,
            self.sent,
            self.latencies.count(),
            at(0.5),
            at(0.99),
            at(0.999),
            at(1.0),
            self.missed,
            late(0.5),
            late(0.99),
            late(1.0),
        )
    }

    pub fn json(&self) -> Value {
        let at = |share| self.latencies.quantile_us(share);
        json!({
            "robot": self.robot,
            "sent": self.sent,
            "answered": self.latencies.count(),
            "median_us": at(0.5),
            "p99_us": at(0.99),
            "p999_us": at(0.999),
            "worst_us": at(1.0),
            "missed": self.missed,
            "timer_median_us": self.lateness.quantile_us(0.5),
            "timer_p99_us": self.lateness.quantile_us(0.99),
            "timer_worst_us": self.lateness.quantile_us(1.0),
        })
    }
}
