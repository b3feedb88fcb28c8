//! Operators: who guides a robot, and by which stream of desired poses.

use std::path::PathBuf;

use elbowroom_robot::RobotId;
use elbowroom_shared_control::NavigatorSettings;
use elbowroom_spatial::Pose;

use crate::{FixtureSwitches, FixtureTool};

/// An operator: `[operator.NAME]`.
#[derive(Debug, Clone)]
pub struct CellOperator {
    /// Its name.
    pub name: String,
    /// Line of its table.
    pub line: usize,
    /// The guided robot.
    pub robot: RobotId,
    /// Its tool.
    pub tool: FixtureTool,
    /// The desired poses of its tool point.
    pub stream: OperatorStream,
    /// When it switches which fixtures.
    pub switches: FixtureSwitches,
    /// Distances and speeds.
    pub settings: NavigatorSettings,
}

/// What an operator wants at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OperatorInput {
    /// This pose of the tool point, in the world.
    Pose(Pose),
    /// Nothing: the enabling switch is not pressed, or the stream has not begun.
    Disabled,
    /// Unknown: the last row is too old.
    Stale,
    /// Nothing more: the stream is over.
    Over,
}

/// A row of a stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperatorRow {
    /// Time, s.
    pub t_s: f64,
    /// Pose of the hand controller, in the world.
    pub pose: Pose,
    /// Whether the enabling switch is pressed.
    pub enabled: bool,
    /// Whether the clutch is open: the hand moves without the tool.
    pub clutch: bool,
}

/// What the hand does between two rows of a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// It stays at the first.
    #[default]
    Hold,
    /// It moves straight to the second, and turns evenly.
    Linear,
}

/// A recorded or generated stream of desired poses.
#[derive(Debug, Clone, PartialEq)]
pub struct OperatorStream {
    /// The file.
    pub file: PathBuf,
    /// Age (s) from which a row is too old.
    pub stale_s: f64,
    /// Times (s, increasing) and desired poses of the tool point; `None` while the operator is not enabled.
    rows: Vec<(f64, Option<Pose>)>,
    interpolation: Interpolation,
}

impl OperatorStream {
    /// The desired poses of these rows, in order of time; a row holds until the next.
    ///
    /// Motions of the hand count `scale` times, from the first row on and again from each row at which the clutch closes:
    /// while it is open, the desired pose stays.
    pub fn new(file: PathBuf, rows: &[OperatorRow], scale: f64, stale_s: f64) -> Self {
        let mut wanted = Vec::with_capacity(rows.len());
        let interpolation = Interpolation::Hold;
        let Some(first) = rows.first() else { return Self { file, stale_s, rows: wanted, interpolation } };
        // The hand and the tool at the last engagement.
        let (mut hand, mut tool) = (first.pose, first.pose);
        let (mut last, mut was_open) = (first.pose, first.clutch);
        for row in rows {
            if row.clutch {
                (hand, tool) = (row.pose, last);
            } else {
                if was_open {
                    (hand, tool) = (row.pose, last);
                }
                let moved = (row.pose.translation - hand.translation) * scale;
                let turned = row.pose.rotation * hand.rotation.inverse();
                last = Pose::new((turned * tool.rotation).renormalized(), tool.translation + moved);
            }
            was_open = row.clutch;
            wanted.push((row.t_s, row.enabled.then_some(last)));
        }
        Self { file, stale_s, rows: wanted, interpolation }
    }

    /// The stream with another motion between its rows.
    #[must_use]
    pub fn interpolated(self, interpolation: Interpolation) -> Self {
        Self { interpolation, ..self }
    }

    /// Largest speed of the desired point, m/s, if a row that holds is left within `tick_s`. Motions beyond `limit_m` are
    /// none.
    pub fn largest_speed_m_s(&self, limit_m: f64, tick_s: f64) -> f64 {
        let speed = |w: &[(f64, Option<Pose>)]| {
            let step_m = w[0].1?.translation.distance(w[1].1?.translation);
            let between_s = w[1].0 - w[0].0;
            let is_even = self.interpolation == Interpolation::Linear && between_s <= self.stale_s;
            (step_m <= limit_m).then_some(step_m / if is_even { between_s } else { tick_s })
        };
        self.rows.windows(2).filter_map(speed).fold(0.0, f64::max)
    }

    /// The rows after one time (s; from the first if `None`) until another: their times, and the desired poses while the
    /// operator is enabled.
    pub fn rows_between(&self, after_s: Option<f64>, until_s: f64) -> impl Iterator<Item = (f64, Option<Pose>)> + '_ {
        let first = after_s.map_or(0, |after_s| self.rows.partition_point(|row| row.0 <= after_s));
        let end = self.rows.partition_point(|row| row.0 <= until_s).max(first);
        self.rows[first..end].iter().copied()
    }

    /// What the operator wants at a time (s).
    pub fn at(&self, t_s: f64) -> OperatorInput {
        let next = self.rows.partition_point(|row| row.0 <= t_s);
        let Some((since_s, wanted)) = next.checked_sub(1).and_then(|k| self.rows.get(k)) else {
            return if self.rows.is_empty() { OperatorInput::Over } else { OperatorInput::Disabled };
        };
        if t_s - since_s > self.stale_s {
            return if next == self.rows.len() { OperatorInput::Over } else { OperatorInput::Stale };
        }
        let Some(wanted) = *wanted else { return OperatorInput::Disabled };
        match (self.interpolation, self.rows.get(next)) {
            // A row that comes too late is not foreseen: until then the last one holds.
            (Interpolation::Linear, Some(&(until_s, Some(to)))) if until_s - since_s <= self.stale_s => {
                OperatorInput::Pose(wanted.interpolate(&to, (t_s - since_s) / (until_s - since_s)))
            }
            _ => OperatorInput::Pose(wanted),
        }
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::Vec3;

    use super::*;

    fn row(t_s: f64, x: f64, clutch: bool) -> OperatorRow {
        OperatorRow { t_s, pose: Pose::from_translation(Vec3::X * x), enabled: true, clutch }
    }

    fn x(input: OperatorInput) -> f64 {
        let OperatorInput::Pose(pose) = input else { panic!("{input:?}") };
        pose.translation.x
    }

    #[test]
    fn an_open_clutch_moves_the_hand_alone_and_motions_are_scaled() {
        let rows = [
            row(0.0, 1.0, false),
            row(1.0, 1.2, false),
            row(2.0, 1.2, true),
            row(3.0, 0.8, true),
            row(4.0, 0.9, false),
            row(5.0, 1.0, false),
        ];
        let stream = OperatorStream::new("hand.csv".into(), &rows, 0.5, 2.0);
        let found = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|t| x(stream.at(t)));
        for (found, expected) in found.into_iter().zip([1.0, 1.1, 1.1, 1.1, 1.1, 1.15]) {
            assert!((found - expected).abs() < 1e-12, "{found} instead of {expected}");
        }
    }

    #[test]
    fn between_rows_a_hand_holds_or_moves_but_not_over_a_gap_or_where_it_lets_go() {
        let rows = [
            row(0.0, 0.0, false),
            row(0.1, 0.1, false),
            row(0.9, 0.2, false),
            row(1.0, 0.3, false),
            OperatorRow { enabled: false, ..row(1.1, 0.4, false) },
        ];
        let held = OperatorStream::new("hand.csv".into(), &rows, 1.0, 0.5);
        let moved = held.clone().interpolated(Interpolation::Linear);
        for (t_s, held_x, moved_x) in
            [(0.0, 0.0, 0.0), (0.05, 0.0, 0.05), (0.1, 0.1, 0.1), (0.4, 0.1, 0.1), (0.95, 0.2, 0.25), (1.05, 0.3, 0.3)]
        {
            assert_eq!(x(held.at(t_s)), held_x, "at {t_s} s");
            assert!((x(moved.at(t_s)) - moved_x).abs() < 1e-12, "at {t_s} s");
        }
    }

    #[test]
    fn old_rows_are_stale_and_the_end_is_the_end() {
        let rows = [row(1.0, 0.0, false), row(3.0, 0.1, false), OperatorRow { enabled: false, ..row(3.1, 0.2, false) }];
        let stream = OperatorStream::new("hand.csv".into(), &rows, 1.0, 0.5);
        assert_eq!(stream.at(0.5), OperatorInput::Disabled);
        assert_eq!(x(stream.at(1.4)), 0.0);
        assert_eq!(stream.at(1.6), OperatorInput::Stale);
        assert_eq!(x(stream.at(3.0)), 0.1);
        assert_eq!(stream.at(3.2), OperatorInput::Disabled);
        assert_eq!(stream.at(3.7), OperatorInput::Over);
    }
}
