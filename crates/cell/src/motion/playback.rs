//! A recorded trajectory, played back.

use super::Point;
use crate::TrajectoryRow;

/// Joint values over time, linear between rows.
#[derive(Debug)]
pub struct Playback {
    rows: Vec<TrajectoryRow>,
    /// Half width (s) of the differences that give speed: readings are quantized.
    half_width: f64,
}

impl Playback {
    /// Plays `rows` (at least one, times rising); speeds are averaged over `window_s`.
    pub fn new(rows: Vec<TrajectoryRow>, window_s: f64) -> Self {
        Self { rows, half_width: window_s / 2.0 }
    }

    /// From first to last row, s.
    pub fn duration(&self) -> f64 {
        match (self.rows.first(), self.rows.last()) {
            (Some(a), Some(b)) => b.t_s - a.t_s,
            _ => 0.0,
        }
    }

    /// Joint values `t` seconds after the first row.
    pub fn q(&self, t: f64) -> Vec<f64> {
        let Some(first) = self.rows.first() else { return Vec::new() };
        let t = first.t_s + t;
        let next = self.rows.partition_point(|r| r.t_s <= t);
        match (next.checked_sub(1).map(|i| &self.rows[i]), self.rows.get(next)) {
            (None, _) => first.q.clone(),
            (Some(last), None) => last.q.clone(),
            (Some(a), Some(b)) => {
                let share = (t - a.t_s) / (b.t_s - a.t_s);
                a.q.iter().zip(&b.q).map(|(x, y)| x + (y - x) * share).collect()
            }
        }
    }

    /// Joint values with derivatives by time.
    pub fn at(&self, t: f64) -> Point {
        let h = self.half_width.min(self.duration() / 2.0);
        let q = self.q(t);
        if h <= 0.0 {
            return Point { first: vec![0.0; q.len()], second: vec![0.0; q.len()], q };
        }
        let [before, after] = [self.q((t - h).max(0.0)), self.q((t + h).min(self.duration()))];
        let span = ((t + h).min(self.duration()) - (t - h).max(0.0)).max(h);
        let first = before.iter().zip(&after).map(|(a, b)| (b - a) / span).collect();
        let second = (0..q.len()).map(|j| (after[j] - 2.0 * q[j] + before[j]) / (h * h)).collect();
        Point { q, first, second }
    }
}
