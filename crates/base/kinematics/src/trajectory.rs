//! Joint values over time.

/// State of the joints on a path, with first and second derivatives with respect to time, or to another parameter of
/// the path.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TrajectoryPoint {
    /// Joint values, rad or m.
    pub q: Vec<f64>,
    /// First derivative; with respect to time: rad/s or m/s.
    pub dq: Vec<f64>,
    /// Second derivative; with respect to time: rad/s² or m/s².
    pub ddq: Vec<f64>,
}

impl TrajectoryPoint {
    /// The state of joints at rest.
    pub fn at_rest(q: Vec<f64>) -> Self {
        Self { dq: vec![0.0; q.len()], ddq: vec![0.0; q.len()], q }
    }
}

/// A row of a trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryRow {
    /// Time, s.
    pub t_s: f64,
    /// Joint values, rad or m.
    pub q: Vec<f64>,
}

/// Joint values at increasing times, linear in between: a recording, or the samples that a controller interpolates.
///
/// Before the first row the values are those of the first row, after the last row those of the last.
///
/// ```
/// use elbowroom_kinematics::{JointTrajectory, TrajectoryRow};
/// let row = |t_s: f64, q: f64| TrajectoryRow { t_s, q: vec![q] };
/// let trajectory = JointTrajectory::new(vec![row(0.5, 1.0), row(1.5, 3.0)]);
/// assert_eq!((trajectory.q(1.0), trajectory.q(9.0), trajectory.duration_s()), (vec![2.0], vec![3.0], 1.0));
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointTrajectory {
    rows: Vec<TrajectoryRow>,
}

impl JointTrajectory {
    /// Creates a trajectory from rows of equal length at increasing times.
    pub fn new(rows: Vec<TrajectoryRow>) -> Self {
        Self { rows }
    }

    /// The trajectory after a rest (s, above 0) at its first row, on the same time axis.
    #[must_use]
    pub fn after_rest(mut self, rest_s: f64) -> Self {
        if let Some(first) = self.rows.first() {
            self.rows.insert(0, TrajectoryRow { t_s: first.t_s - rest_s, q: first.q.clone() });
        }
        self
    }

    /// The rows.
    pub fn rows(&self) -> &[TrajectoryRow] {
        &self.rows
    }

    /// Time of the first row, s; 0 without rows.
    pub fn start_s(&self) -> f64 {
        self.rows.first().map_or(0.0, |first| first.t_s)
    }

    /// Time of the last row, s; 0 without rows.
    pub fn end_s(&self) -> f64 {
        self.rows.last().map_or(0.0, |last| last.t_s)
    }

    /// Time from the first to the last row, s.
    pub fn duration_s(&self) -> f64 {
        self.end_s() - self.start_s()
    }

    /// Joint values of the first row.
    pub fn first(&self) -> Option<&[f64]> {
        self.rows.first().map(|row| &row.q[..])
    }

    /// Joint values of the last row.
    pub fn last(&self) -> Option<&[f64]> {
        self.rows.last().map(|row| &row.q[..])
    }

    /// Joint values at a time (s, on the time axis of the rows).
    pub fn q(&self, t_s: f64) -> Vec<f64> {
        let joints = self.rows.first().map_or(0, |row| row.q.len());
        (0..joints).map(|joint| self.value(joint, t_s)).collect()
    }

    /// Value of one joint at a time (s, on the time axis of the rows); 0 without rows.
    pub fn value(&self, joint: usize, t_s: f64) -> f64 {
        let next = self.rows_until(t_s);
        match (next.checked_sub(1).and_then(|i| self.rows.get(i)), self.rows.get(next)) {
            (None, None) => 0.0,
            (None, Some(row)) | (Some(row), None) => row.q[joint],
            (Some(a), Some(b)) => a.q[joint] + (b.q[joint] - a.q[joint]) * ((t_s - a.t_s) / (b.t_s - a.t_s)),
        }
    }

    /// Number of rows at or before a time (s, on the time axis of the rows).
    pub fn rows_until(&self, t_s: f64) -> usize {
        self.rows.partition_point(|row| row.t_s <= t_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_on_the_segments_and_rest_before_and_after() {
        let times = [-1.0, 0.5, 0.75, 4.0];
        let row = |t_s: f64| TrajectoryRow { t_s, q: vec![t_s.sin(), 1.0] };
        let trajectory = JointTrajectory::new(times.map(row).to_vec());
        for n in -200..600 {
            let t_s = f64::from(n) / 100.0;
            let inside = t_s.clamp(-1.0, 4.0);
            let i = (0..3).find(|i| inside <= times[i + 1]).unwrap();
            let share = (inside - times[i]) / (times[i + 1] - times[i]);
            let expected = times[i].sin() * (1.0 - share) + times[i + 1].sin() * share;
            let q = trajectory.q(t_s);
            assert!((q[0] - expected).abs() < 1e-12 && q[1] == 1.0, "{t_s}: {q:?}");
        }
        assert_eq!((trajectory.start_s(), trajectory.duration_s()), (-1.0, 5.0));
        let rested = trajectory.clone().after_rest(2.0);
        assert_eq!((rested.start_s(), rested.q(-2.5), rested.q(3.0)), (-3.0, trajectory.q(-1.0), trajectory.q(3.0)));
    }

    #[test]
    fn without_rows_there_is_no_motion() {
        let none = JointTrajectory::default().after_rest(1.0);
        assert_eq!((none.duration_s(), none.q(0.0), none.first(), none.last()), (0.0, vec![], None, None));
    }
}
