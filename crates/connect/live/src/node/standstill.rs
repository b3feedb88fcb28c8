//! Detection of rest, after which the new place of a moved robot is accepted.

use elbowroom_interlock::Micros;

/// Time for which the robot must be at rest.
const REST: Micros = Micros(1_000_000);
/// Largest difference between readings of a joint at rest, rad or m.
const JITTER: f64 = 1e-3;

/// Watches a robot whose place is in doubt until it has been at rest for a second.
///
/// A robot at rest shows it by its velocities *and* by its positions: values that jump back and forth come from a
/// faulty sensor or from two controllers.
#[derive(Debug)]
pub(super) struct Standstill {
    /// Number of the controller's present start.
    controller: Option<u64>,
    /// Whether the controller has started again, and the robot has not moved since.
    has_restarted: bool,
    since: Option<Micros>,
    q: Vec<f64>,
}

impl Standstill {
    /// Creates the watch for a robot with this number of joints.
    pub(super) fn new(joints: usize) -> Self {
        Self { controller: None, has_restarted: false, since: None, q: Vec::with_capacity(joints) }
    }

    /// Records that joint values of this controller start have arrived.
    pub(super) fn hear(&mut self, controller: u64) {
        self.has_restarted |= self.controller.is_some_and(|before| before != controller);
        self.controller = Some(controller);
    }

    /// Returns true once when the place is accepted: it was in doubt, because the values have jumped or the controller
    /// has started again, and the robot has been at rest for a second.
    pub(super) fn ends(&mut self, has_jumped: bool, q: &[f64], qd: &[f64], now: Micros) -> bool {
        let is_at_rest = qd.iter().all(|v| *v == 0.0);
        if !is_at_rest || !(has_jumped || self.has_restarted) {
            // The place of a moving robot is not in doubt.
            self.has_restarted &= is_at_rest;
            self.since = None;
            return false;
        }
        let is_same = self.q.len() == q.len() && self.q.iter().zip(q).all(|(a, b)| (a - b).abs() <= JITTER);
        match self.since {
            Some(since) if is_same && now - since > REST => {
                (self.since, self.has_restarted) = (None, false);
                true
            }
            Some(_) if is_same => false,
            _ => {
                self.q.clear();
                self.q.extend_from_slice(q);
                self.since = Some(now);
                false
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the ticks, of 4000 ticks of 1 ms, at which the place is accepted.
    fn counts_at(
        has_jumped: bool,
        mut robot: impl FnMut(u64) -> (f64, f64),
        mut controller: impl FnMut(u64) -> u64,
    ) -> Vec<u64> {
        let mut standstill = Standstill::new(1);
        let mut tick = |t: u64| {
            standstill.hear(controller(t));
            let (q, qd) = robot(t);
            standstill.ends(has_jumped, &[q], &[qd], Micros(t * 1_000))
        };
        (0..4_000).filter(|t| tick(*t)).collect()
    }

    #[test]
    fn a_robot_that_rests_elsewhere_counts_each_second() {
        assert_eq!(counts_at(true, |_| (0.3, 0.0), |_| 1)[0], 1_001);
        assert!(counts_at(false, |_| (0.3, 0.0), |_| 1).is_empty(), "nothing was in doubt");
    }

    #[test]
    fn values_that_jump_to_and_fro_or_move_never_count() {
        assert!(counts_at(true, |t| (if t % 2 == 0 { 1.0 } else { -1.0 }, 0.0), |_| 1).is_empty());
        assert!(counts_at(true, |t| (if t % 900 == 0 { 1.0 } else { -1.0 }, 0.0), |_| 1).is_empty());
        assert!(counts_at(true, |t| (t as f64 * 1e-5, 0.0), |_| 1).is_empty());
        assert!(counts_at(true, |_| (0.3, 0.1), |_| 1).is_empty());
        assert!(counts_at(true, |_| (f64::NAN, 0.0), |_| 1).is_empty());
    }

    #[test]
    fn a_controller_that_starts_again_at_rest_counts_once() {
        assert_eq!(counts_at(false, |_| (0.3, 0.0), |t| u64::from(t >= 1_500)), [2_501]);
        let moves = |t: u64| if t < 2_000 { (0.3, 0.0) } else { (0.3, 0.2) };
        assert!(counts_at(false, moves, |t| u64::from(t >= 1_500)).is_empty());
    }
}
