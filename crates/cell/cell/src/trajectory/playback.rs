//! Playback of a recorded trajectory.

use elbowroom_kinematics::{JointTrajectory, TrajectoryPoint};

/// Half widths (s) for averaging speeds, in order of preference. Averaging is needed because readings are quantized.
const HALF_WIDTHS: [f64; 4] = [0.02, 0.01, 0.005, 0.0025];
/// Largest deviation (m) of the averaged path from the recorded one: stopping distances depend on speeds.
const NEAR_M: f64 = 1e-4;
/// Ratio of consecutive time intervals in the search for the largest acceleration.
const LONGER: f64 = 1.1;
/// Offset (s) to just before a row.
const BEFORE_S: f64 = 1e-9;

/// A trajectory with times from its first row, and with speeds and accelerations.
#[derive(Debug)]
pub struct Playback {
    trajectory: JointTrajectory,
    /// Half width (s) of the differences that give speed; 0 for the speed from row to row.
    half_width: f64,
}

impl Playback {
    /// Plays a trajectory of at least one row; `motion_bounds` per joint in m per unit.
    pub fn new(trajectory: JointTrajectory, motion_bounds: &[f64]) -> Self {
        let mut play = Self { trajectory, half_width: 0.0 };
        play.half_width = HALF_WIDTHS.into_iter().find(|h| play.stays_near(*h, motion_bounds)).unwrap_or(0.0);
        play
    }

    fn stays_near(&self, h: f64, motion_bounds: &[f64]) -> bool {
        let inside = |t: &f64| *t >= h && t + h <= self.duration();
        self.times().filter(inside).all(|t| {
            let [before, here, after] = [self.q(t - h), self.q(t), self.q(t + h)];
            let beside = |j: usize| 0.5 * (after[j] - 2.0 * here[j] + before[j]).abs();
            motion_bounds.iter().enumerate().all(|(j, bound)| bound * beside(j) <= NEAR_M)
        })
    }

    /// Times of the rows from the first one, s.
    fn times(&self) -> impl Iterator<Item = f64> + '_ {
        self.trajectory.rows().iter().map(|row| row.t_s - self.start_s())
    }

    fn start_s(&self) -> f64 {
        self.trajectory.start_s()
    }

    /// Time from the first to the last row, s.
    pub fn duration(&self) -> f64 {
        self.trajectory.duration_s()
    }

    /// Joint values `t` seconds after the first row.
    pub fn q(&self, t: f64) -> Vec<f64> {
        self.trajectory.q(self.start_s() + t)
    }

    /// Value of one joint `t` seconds after the first row.
    fn value(&self, joint: usize, t: f64) -> f64 {
        self.trajectory.value(joint, self.start_s() + t)
    }

    /// Joint values with time derivatives.
    pub fn at(&self, t: f64) -> TrajectoryPoint {
        let q = self.q(t);
        let h = self.half_width.min(self.duration() / 2.0);
        let dq = (0..q.len()).map(|j| self.speed(j, t)).collect();
        if h <= 0.0 {
            return TrajectoryPoint { ddq: vec![0.0; q.len()], q, dq };
        }
        let [before, after] = [self.q((t - h).max(0.0)), self.q((t + h).min(self.duration()))];
        let ddq = (0..q.len()).map(|j| (after[j] - 2.0 * q[j] + before[j]) / (h * h)).collect();
        TrajectoryPoint { q, dq, ddq }
    }

    /// Averaged speed of a joint, rad/s or m/s.
    fn speed(&self, joint: usize, t: f64) -> f64 {
        let h = self.half_width.min(self.duration() / 2.0);
        if h <= 0.0 {
            return self.slope(self.trajectory.rows_until(self.start_s() + t), joint);
        }
        let [from, to] = [(t - h).max(0.0), (t + h).min(self.duration())];
        (self.value(joint, to) - self.value(joint, from)) / (to - from).max(h)
    }

    /// Slope of the interval that ends at this row; beyond the last row, the slope of the last interval.
    fn slope(&self, end: usize, joint: usize) -> f64 {
        let rows = self.trajectory.rows();
        let end = end.clamp(1, rows.len().saturating_sub(1).max(1));
        match (rows.get(end - 1), rows.get(end)) {
            (Some(a), Some(b)) => (b.q[joint] - a.q[joint]) / (b.t_s - a.t_s),
            _ => 0.0,
        }
    }

    /// The largest averaged speed (rad/s or m/s) of a joint, and its time (s, on the time axis of the rows).
    pub fn fastest(&self, joint: usize) -> (f64, f64) {
        let speeds = self.times().map(|t| (self.speed(joint, t).abs(), t + self.start_s()));
        speeds.fold((0.0, 0.0), |most, now| if now.0 > most.0 { now } else { most })
    }

    /// The largest change of a joint's speed at a row, rad/s or m/s.
    pub fn largest_jump(&self, joint: usize) -> f64 {
        let jump = |end: usize| (self.slope(end + 1, joint) - self.slope(end, joint)).abs();
        (1..self.trajectory.rows().len().saturating_sub(1)).map(jump).fold(0.0, f64::max)
    }

    /// Smallest acceleration A (rad/s² or m/s²) above `stated` that covers the motion of a joint, and its time (s, on
    /// the time axis of the rows); 0 if `stated` is sufficient.
    ///
    /// For every u from `least_s` (s) on, the joint leaves its straight course `q′·u` by at most `A·u²/2` and `beside`
    /// (rad or m).
    ///
    /// A change dv of the velocity at a row needs `2·dv / least_s`: the deviation begins at the row and only grows with
    /// u.
    pub fn hardest(&self, joint: usize, stated: f64, least_s: f64, beside: f64) -> (f64, f64) {
        let most = (1..self.trajectory.rows().len()).map(|end| self.slope(end, joint).abs()).fold(0.0, f64::max);
        let mut hardest = (0.0, 0.0);
        for row in self.times() {
            for t in [row - BEFORE_S, row - self.half_width, row + self.half_width] {
                let (from, speed) = (self.value(joint, t), self.speed(joint, t.max(0.0)));
                let mut u = least_s;
                // Beyond this interval no course deviates from a straight one by more than twice the largest speed.
                while t >= 0.0 && t + u <= self.duration() && 4.0 * most / u > stated.max(hardest.0) {
                    let away = (self.value(joint, t + u) - from - speed * u).abs() - beside;
                    let needed = 2.0 * away / (u * u);
                    if needed > stated.max(hardest.0) {
                        hardest = (needed, row + self.start_s());
                    }
                    u *= LONGER;
                }
            }
        }
        hardest
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_kinematics::TrajectoryRow;

    use super::*;

    fn play(step_s: f64, count: usize, q: impl Fn(f64) -> f64) -> Playback {
        let row = |i: usize| TrajectoryRow { t_s: step_s * i as f64, q: vec![q(step_s * i as f64)] };
        Playback::new(JointTrajectory::new((0..=count).map(row).collect()), &[1.0])
    }

    #[test]
    fn a_corner_needs_twice_its_change_of_speed_over_the_least_time() {
        let corner = play(0.1, 10, |t| if t < 0.45 { 0.0 } else { 2.0 * (t - 0.4) });
        let (needed, at_s) = corner.hardest(0, 8.0, 0.002, 0.0);
        assert!((needed - 2.0 * 2.0 / 0.002).abs() < 0.01 && (at_s - 0.4).abs() < 1e-9, "{needed} at {at_s}");
        assert_eq!(corner.largest_jump(0).round(), 2.0);
        // Speeds are those between rows, also next to the corner.
        assert!(corner.speed(0, 0.399).abs() < 1e-12 && (corner.speed(0, 0.401) - 2.0).abs() < 1e-9);
    }

    #[test]
    fn a_smooth_recording_demands_its_accelerations() {
        let smooth = play(0.002, 1000, |t| 2.0 * (1.0 - (2.0 * t).cos()));
        assert_eq!(smooth.hardest(0, 9.0, 0.002, 0.25e-3).0, 0.0);
        let (needed, _) = smooth.hardest(0, 4.0, 0.002, 0.25e-3);
        assert!((needed - 8.0).abs() < 0.5, "{needed}");
    }

    #[test]
    fn quantization_is_not_taken_for_acceleration() {
        let rough = play(0.001, 2000, |t| ((2.0 * t).sin() * 5e4).round() / 5e4);
        assert!((rough.speed(0, 1.0) - 2.0 * 2.0_f64.cos()).abs() < 0.01);
        assert_eq!(rough.hardest(0, 5.0, 0.002, 0.25e-3).0, 0.0);
    }
}
