//! Check of robots that play recordings: they are on the path of the rows, and not ahead of their times.

use elbowroom_sim::Recording;

use super::findings::{Finding, Findings};
use crate::fuzz_cells::spec::{CellSpec, RecordingSpec};

/// By how much a joint may be off, rad or m: numbers that were converted from other units are rounded.
const OFF: f64 = 1e-9;
/// Rounding of times, s.
const ROUNDING_S: f64 = 1e-9;

/// Compares each robot with the rows that were written, in their units and with their offset.
pub fn check(spec: &CellSpec, recording: &Recording, findings: &mut Findings) {
    for (robot, r) in spec.robots.iter().enumerate() {
        if let Some(played) = &r.program.recording {
            findings.list.extend(first_off(played, robot, recording));
        }
    }
}

/// Finds the first sample off the path or ahead of it, in the first pass.
pub fn first_off(played: &RecordingSpec, robot: usize, recording: &Recording) -> Option<Finding> {
    let (begin_s, end_s) = (played.rows.first()?.0, played.rows.last()?.0);
    let mut along = Along { rows: &played.rows, row: 0, share: 0.0 };
    for sample in &recording.robots[robot].samples {
        let t_s = sample.t_s;
        // The robot starts at the first row, whatever its time is.
        let earliest_s = |row_s: f64| row_s - begin_s + played.offset_s();
        let Some(reached_s) = along.reach(&sample.q) else {
            // From the end on it may drive back for the next pass, also within a tick.
            let is_on = t_s <= earliest_s(end_s);
            return is_on.then_some(Finding::OffRecording { robot, t_s, ahead_s: None });
        };
        let ahead_s = earliest_s(reached_s) - t_s;
        if reached_s - begin_s > ROUNDING_S && ahead_s > ROUNDING_S {
            return Some(Finding::OffRecording { robot, t_s, ahead_s: Some(ahead_s) });
        }
        if along.is_at_end() {
            break;
        }
    }
    None
}

/// A place on the straight lines from row to row.
struct Along<'a> {
    rows: &'a [(f64, Vec<f64>)],
    /// The row before it.
    row: usize,
    /// The share of the way to the next row.
    share: f64,
}

impl Along<'_> {
    /// Goes on to the next place with these joint values; returns its time, s, or `None` if there is none.
    fn reach(&mut self, q: &[f64]) -> Option<f64> {
        for row in self.row..self.rows.len() - 1 {
            let least = if row == self.row { self.share } else { 0.0 };
            let ((t0, a), (t1, b)) = (&self.rows[row], &self.rows[row + 1]);
            let way = || a.iter().zip(b).map(|(a, b)| b - a);
            let length = way().map(|d| d * d).sum::<f64>();
            let along = way().zip(a).zip(q).map(|((d, a), q)| d * (q - a)).sum::<f64>();
            let share = if length > 0.0 { (along / length).clamp(least, 1.0) } else { least };
            let is_there = way().zip(a).zip(q).all(|((d, a), q)| (a + d * share - q).abs() <= OFF);
            if is_there {
                (self.row, self.share) = (row, share);
                return Some(t0 + (t1 - t0) * share);
            }
        }
        None
    }

    fn is_at_end(&self) -> bool {
        self.row + 2 >= self.rows.len() && self.share >= 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_followed_forwards_only() {
        let rows = [(0.0, vec![0.0, 0.0]), (1.0, vec![1.0, 0.0]), (3.0, vec![1.0, 0.0]), (4.0, vec![0.0, 0.0])];
        let mut along = Along { rows: &rows, row: 0, share: 0.0 };
        assert_eq!(along.reach(&[0.25, 0.0]), Some(0.25));
        assert_eq!(along.reach(&[0.5, 0.0]), Some(0.5));
        // Back again is only possible on the way back.
        assert_eq!(along.reach(&[0.25, 0.0]), Some(3.75));
        assert_eq!(along.reach(&[0.25, 0.1]), None);
        assert_eq!(along.reach(&[0.0, 0.0]), Some(4.0));
        assert!(along.is_at_end());
    }
}
