//! Check of robots that play recordings: on the path of the rows, not ahead of their times, and not late at full override.

use elbowroom_sim::Recording;

use super::findings::{Finding, Findings};
use crate::fuzz_cells::spec::{CellSpec, RecordingSpec};

/// By how much a joint may be off, rad or m: numbers that were converted from other units are rounded.
const OFF: f64 = 1e-9;
/// Rounding of times, s.
const ROUNDING_S: f64 = 1e-9;
/// By how much a robot whose override is always full may be late, s: a recording that begins in motion is joined.
const LATE_S: f64 = 1.0;

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
    let (mut last_s, mut was_free) = (begin_s, true);
    for sample in &recording.robots[robot].samples {
        let t_s = sample.t_s;
        // The robot starts at the first row, whatever its time is.
        let earliest_s = |row_s: f64| row_s - begin_s + played.offset_s();
        let Some(reached_s) = along.reach(&sample.q) else {
            // From the end on it may drive back for the next pass, also within a tick.
            let ended = end_s - last_s <= recording.tick_s + ROUNDING_S;
            return (!ended).then_some(Finding::OffRecording { robot, t_s, ahead_s: None });
        };
        let ahead_s = earliest_s(reached_s) - t_s;
        if reached_s - begin_s > ROUNDING_S && ahead_s > ROUNDING_S {
            return Some(Finding::OffRecording { robot, t_s, ahead_s: Some(ahead_s) });
        }
        // Nothing but the joined start delays a robot at full override.
        was_free &= sample.speed_override >= 1.0;
        let rests_s = along.rests_s(&sample.q).unwrap_or(reached_s);
        let late_s = t_s - earliest_s(rests_s);
        if was_free && late_s > LATE_S && rests_s < end_s {
            return Some(Finding::OffRecording { robot, t_s, ahead_s: Some(-late_s) });
        }
        if rests_s >= end_s {
            break;
        }
        last_s = reached_s;
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
            let share = |along: f64| if length > 0.0 { (along / length).clamp(least, 1.0) } else { least };
            let nearest = share(along);
            let is_there = way().zip(a).zip(q).all(|((d, a), q)| (a + d * nearest - q).abs() <= OFF);
            if is_there {
                // The earliest place that these numbers may mean.
                let earliest = share(along - OFF * length.sqrt());
                (self.row, self.share) = (row, earliest);
                return Some(t0 + (t1 - t0) * earliest);
            }
        }
        None
    }

    /// Time of the last of the next rows that have these joint values.
    fn rests_s(&self, q: &[f64]) -> Option<f64> {
        let is_same = |row: &[f64]| row.iter().zip(q).all(|(a, b)| (a - b).abs() <= OFF);
        self.rows[self.row + 1..].iter().take_while(|(_, row)| is_same(row)).last().map(|(t_s, _)| *t_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_followed_forwards_only() {
        let rows = [(0.0, vec![0.0, 0.0]), (1.0, vec![1.0, 0.0]), (3.0, vec![1.0, 0.0]), (4.0, vec![0.0, 0.0])];
        let mut along = Along { rows: &rows, row: 0, share: 0.0 };
        let mut is_at = |q: [f64; 2], t_s: Option<f64>| {
            let found = along.reach(&q);
            assert!(found.zip(t_s).map_or(found == t_s, |(a, b)| (a - b).abs() < 1e-8), "{found:?} {t_s:?}");
        };
        is_at([0.25, 0.0], Some(0.25));
        is_at([0.5, 0.0], Some(0.5));
        // Back again is only possible on the way back.
        is_at([0.25, 0.0], Some(3.75));
        is_at([0.25, 0.1], None);
        is_at([0.0, 0.0], Some(4.0));
        assert_eq!((along.rests_s(&[0.0, 0.0]), along.rests_s(&[0.1, 0.0])), (Some(4.0), None));
        let begin = Along { rows: &rows, row: 0, share: 1.0 };
        assert_eq!(begin.rests_s(&[1.0, 0.0]), Some(3.0));
    }

    #[test]
    fn rounding_in_a_short_segment_is_no_time() {
        let rows = [(0.0, vec![0.3]), (0.05, vec![0.3 + 1e-9]), (0.1, vec![0.4])];
        let mut along = Along { rows: &rows, row: 0, share: 0.0 };
        assert_eq!(along.reach(&[0.3 + 4e-16]), Some(0.0));
    }
}
