//! The part of the path ahead that the arms that hold the work-piece can carry it along.

use std::collections::VecDeque;

use crate::desired_path::DesiredPath;
use crate::holding::{Holding, Margins};
use crate::{CooperationSettings, HoldLimit};

/// Path time between two configurations that are tested, s.
const STEP_S: f64 = 5e-3;
/// Path time beyond the stopping distance that is tested, s.
const RESERVE_S: f64 = 0.05;
/// Configurations that are tested in one step of the virtual robot, beyond those that it uses up.
const MOST: usize = 2;
/// Most configurations that a step uses up.
const LONGEST_STEP: f64 = 200.0;
/// Most places ahead at which a joint is too slow.
const SLOW: usize = 128;
/// Share of the joint speeds that is used.
const SPEED_SHARE: f64 = 0.95;
/// Steps of the virtual robot until a place where the arm cannot go is tested again.
const RETRY: usize = 25;

/// How far an arm can carry the work-piece along the known path.
#[derive(Debug)]
pub(crate) struct LookAhead {
    /// Path time up to which the arm can carry it, s.
    pub free_to_s: f64,
    /// What is there; `None` if it can go on.
    pub limit: Option<HoldLimit>,
    /// The configuration there.
    pub q: Vec<f64>,
    scratch: Vec<f64>,
    /// Places ahead (path time, s) at which a joint cannot be as fast as desired, and the share of the desired speed there.
    slow: VecDeque<(f64, f64)>,
    /// Whether the hand could move back when the arm began to hold.
    can_retreat: bool,
    wait: usize,
}

impl LookAhead {
    /// An arm at a configuration, with the work-piece at a path time (s).
    pub fn new(q: &[f64], path_s: f64) -> Self {
        Self {
            free_to_s: path_s,
            limit: None,
            q: q.to_vec(),
            scratch: q.to_vec(),
            slow: VecDeque::with_capacity(SLOW),
            can_retreat: false,
            wait: 0,
        }
    }

    /// Starts again from a configuration, perhaps of another arm, and a path time (s).
    pub fn restart(&mut self, q: &[f64], path_s: f64) {
        self.q.clear();
        self.q.extend_from_slice(q);
        self.scratch.clone_from(&self.q);
        self.slow.clear();
        (self.free_to_s, self.limit, self.wait) = (path_s, None, 0);
    }

    /// Looks as far ahead as the work-piece at `path_s` needs to stop. If there is a receiver, the hand must be able to move
    /// back all along.
    pub fn extend(
        &mut self,
        holding: &mut Holding<'_>,
        path: &DesiredPath,
        path_s: f64,
        (settings, has_receiver, dt_s): (&CooperationSettings, bool, f64),
    ) {
        if self.limit.is_some() && self.wait > 0 {
            self.wait -= 1;
            return;
        }
        if self.free_to_s == path_s {
            self.can_retreat = holding.can_retreat(&path.at(path_s), &self.q);
        }
        // With nobody there to take the work-piece, it is better to go on.
        let margins = Margins::executed(settings, self.can_retreat && has_receiver);
        let needed_s = (path_s + settings.ramp_s + RESERVE_S).min(path.end().0);
        // A long step uses up more of the path.
        let most = MOST + (dt_s / STEP_S).min(LONGEST_STEP).ceil() as usize;
        for _ in 0..most {
            let left_s = needed_s - self.free_to_s;
            if left_s <= 0.0 {
                break;
            }
            let step_s = left_s.min(STEP_S);
            self.scratch.copy_from_slice(&self.q);
            let part_in_world = path.at(self.free_to_s + step_s);
            self.limit = holding.follow(&part_in_world, step_s, &mut self.scratch, &margins).err();
            if self.limit.is_some() {
                self.wait = RETRY;
                break;
            }
            self.q.copy_from_slice(&self.scratch);
            self.free_to_s += step_s;
            let share = SPEED_SHARE / holding.effort;
            if share < 1.0 && self.slow.len() < SLOW {
                self.slow.push_back((self.free_to_s, share));
            }
        }
    }

    /// Whether it is known as far ahead as the work-piece at `path_s` needs to stop.
    pub fn is_ready(&self, path: &DesiredPath, path_s: f64, settings: &CooperationSettings) -> bool {
        self.limit.is_some() || self.free_to_s >= (path_s + settings.ramp_s).min(path.end().0) - 1e-9
    }

    /// Largest share of the desired speed at `path_s` from which the work-piece can slow down in time.
    pub fn rate(&mut self, path_s: f64, settings: &CooperationSettings) -> f64 {
        while self.slow.front().is_some_and(|(at_s, _)| *at_s < path_s) {
            self.slow.pop_front();
        }
        let at = |(at_s, share): &(f64, f64)| {
            // The place is one step long.
            let before_s = (at_s - STEP_S - path_s).max(0.0);
            (share * share + 2.0 * before_s / settings.ramp_s).sqrt()
        };
        self.slow.iter().map(at).fold(1.0, f64::min)
    }
}
