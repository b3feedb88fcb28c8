//! Fault injection: what reaches a robot's monitor in place of the truth.
//!
//! The robot itself goes on as it was told: only what the monitor hears of it is changed. What the recording says of
//! positions is always the truth.

use std::collections::VecDeque;

use elbowroom_monitor::Snapshot;

/// One fault of the input of one robot's monitor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputFault {
    /// Index of the robot.
    pub robot: usize,
    /// From this time on (s, included) the input is wrong.
    pub from_s: f64,
    /// Until this time (s, not included); infinite for ever.
    pub to_s: f64,
    /// What is wrong with it.
    pub kind: InputFaultKind,
}

/// What can be wrong with the input of a monitor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InputFaultKind {
    /// Snapshots arrive `by_s` seconds late, with the stamps of when they were taken. As the delay begins, the last one
    /// that came in time is repeated until the first late one is there.
    Late {
        /// The delay, s.
        by_s: f64,
    },
    /// No snapshot arrives, so the monitor does not answer. The controller goes on with the last override for
    /// `timeout_s` after the first tick without an answer, and then takes the override as 0.
    Lost {
        /// The controller's own time-out, s; 0 for one that stops at the first missing answer. The stopping-distance law
        /// knows nothing of it: its reaction time must contain it.
        timeout_s: f64,
    },
    /// The values of the beginning, under fresh stamps.
    Frozen,
    /// The position of one joint is wrong by a constant.
    Jump {
        /// Index of the joint in `q`.
        joint: usize,
        /// Added to it, rad or m.
        by: f64,
    },
    /// All positions are not a number.
    NotANumber,
}

impl InputFault {
    fn is_on(&self, robot: usize, t_s: f64) -> bool {
        self.robot == robot && self.from_s <= t_s && t_s < self.to_s
    }
}

/// Stands between the robots and their monitors. Robots without faults pass at no cost.
pub(super) struct Inputs<'a> {
    faults: &'a [InputFault],
    /// Per robot what is remembered of it, oldest first; empty where no fault needs it.
    past: Vec<VecDeque<Input>>,
    /// What the monitor is given instead of the truth.
    given: Input,
}

/// A snapshot that is kept.
#[derive(Debug, Clone, Default)]
struct Input {
    stamp_s: f64,
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    programmed_override: f64,
    intent: Option<Vec<f64>>,
}

impl<'a> Inputs<'a> {
    pub fn new(faults: &'a [InputFault], robots: usize) -> Self {
        Self { faults, past: vec![VecDeque::new(); robots], given: Input::default() }
    }

    /// What the robot's monitor is given at this instant; `None` where nothing arrives.
    pub fn pass<'s>(&'s mut self, robot: usize, truth: &Snapshot<'s>) -> Option<Snapshot<'s>> {
        if !self.faults.iter().any(|f| f.robot == robot) {
            return Some(*truth);
        }
        self.remember(robot, truth);
        let Some(fault) = self.on(robot, truth.now_s) else { return Some(*truth) };
        let (then_s, fresh) = match fault.kind {
            InputFaultKind::Lost { .. } => return None,
            InputFaultKind::Late { by_s } => ((truth.now_s - by_s).max(fault.from_s), false),
            InputFaultKind::Frozen => (fault.from_s, true),
            InputFaultKind::Jump { .. } | InputFaultKind::NotANumber => (truth.now_s, true),
        };
        let past = &self.past[robot];
        let then = past.iter().rev().find(|i| i.stamp_s <= then_s + 1e-9).or(past.front())?;
        self.given.clone_from(then);
        if fresh {
            self.given.stamp_s = truth.stamp_s;
        }
        match fault.kind {
            InputFaultKind::Jump { joint, by } => self.given.q.iter_mut().skip(joint).take(1).for_each(|q| *q += by),
            InputFaultKind::NotANumber => self.given.q.fill(f64::NAN),
            _ => {}
        }
        Some(self.given.snapshot(truth))
    }

    /// True where the controller, not having heard from its monitor, still goes on with the last override.
    pub fn goes_on(&self, robot: usize, t_s: f64) -> bool {
        let lost = self.on(robot, t_s);
        lost.is_some_and(|f| matches!(f.kind, InputFaultKind::Lost { timeout_s } if t_s < f.from_s + timeout_s - 1e-9))
    }

    fn on(&self, robot: usize, t_s: f64) -> Option<InputFault> {
        self.faults.iter().find(|f| f.is_on(robot, t_s)).copied()
    }

    fn remember(&mut self, robot: usize, truth: &Snapshot<'_>) {
        // The oldest that any fault of this robot can still ask for.
        let needed = |f: &InputFault| match f.kind {
            InputFaultKind::Late { by_s } => truth.now_s - by_s,
            InputFaultKind::Frozen if f.from_s <= truth.now_s && truth.now_s < f.to_s => f.from_s,
            _ => truth.now_s,
        };
        let oldest_s = self.faults.iter().filter(|f| f.robot == robot).map(needed).fold(truth.now_s, f64::min);
        let past = &mut self.past[robot];
        past.push_back(Input::of(truth));
        // One before the oldest that is needed: times of ticks seldom are met exactly.
        while past.len() > 1 && past[1].stamp_s <= oldest_s {
            past.pop_front();
        }
    }
}

impl Input {
    fn of(s: &Snapshot<'_>) -> Self {
        Self {
            stamp_s: s.stamp_s,
            q: s.q.to_vec(),
            qd: s.qd.to_vec(),
            qdd: s.qdd.to_vec(),
            programmed_override: s.programmed_override,
            intent: s.intent.map(<[f64]>::to_vec),
        }
    }

    /// Clock and sources are the monitor's own.
    fn snapshot<'s>(&'s self, truth: &Snapshot<'s>) -> Snapshot<'s> {
        Snapshot {
            stamp_s: self.stamp_s,
            q: &self.q,
            qd: &self.qd,
            qdd: &self.qdd,
            programmed_override: self.programmed_override,
            intent: self.intent.as_deref(),
            ..*truth
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn given(kind: InputFaultKind, ticks: u32) -> Vec<Option<(f64, f64)>> {
        let faults = [InputFault { robot: 0, from_s: 0.01, to_s: 0.03, kind }];
        let mut inputs = Inputs::new(&faults, 1);
        let one = |i: u32| {
            let t_s = f64::from(i) * 0.005;
            let q = [f64::from(i)];
            inputs.pass(0, &Snapshot::still(t_s, &q)).map(|s| (s.stamp_s, s.q[0]))
        };
        (0..ticks).map(one).collect()
    }

    #[test]
    fn late_input_keeps_its_old_stamps() {
        let seen = given(InputFaultKind::Late { by_s: 0.01 }, 8);
        let ticks: Vec<f64> = seen.iter().map(|s| s.unwrap().1).collect();
        assert_eq!(ticks, [0.0, 1.0, 2.0, 2.0, 2.0, 3.0, 6.0, 7.0]);
        assert!(seen.iter().flatten().all(|(stamp_s, q)| (stamp_s - q * 0.005).abs() < 1e-12));
    }

    #[test]
    fn frozen_input_has_fresh_stamps_and_lost_input_none() {
        let frozen = given(InputFaultKind::Frozen, 7);
        assert_eq!(frozen[5], Some((0.025, 2.0)));
        assert_eq!(frozen[6], Some((0.03, 6.0)));
        let lost = given(InputFaultKind::Lost { timeout_s: 0.0 }, 7);
        assert!(lost[1].is_some() && lost[2].is_none() && lost[5].is_none() && lost[6].is_some());
    }

    #[test]
    fn positions_jump_or_are_no_numbers() {
        assert_eq!(given(InputFaultKind::Jump { joint: 0, by: 10.0 }, 4)[3], Some((0.015, 13.0)));
        assert!(given(InputFaultKind::NotANumber, 4)[3].unwrap().1.is_nan());
    }
}
