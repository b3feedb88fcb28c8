//! Fault injection: faults in the input of a robot's monitor.
//!
//! Only the input of the monitor changes: the robot itself moves as commanded, and the recording has its true
//! positions.

use std::collections::VecDeque;

use elbowroom_monitor::Snapshot;
use elbowroom_robot::RobotId;

/// One fault of the input of one robot's monitor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputFault {
    /// The robot.
    pub robot: RobotId,
    /// Start of the fault, s, inclusive.
    pub from_s: f64,
    /// End of the fault, s, exclusive; infinite if the fault does not end.
    pub to_s: f64,
    /// The fault.
    pub kind: InputFaultKind,
}

/// Faults of a monitor's input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InputFaultKind {
    /// Snapshots are delayed by `by_s` seconds, with their original stamps. At the start of the delay, the last one
    /// that arrived in time is repeated until the first delayed one arrives.
    Delayed {
        /// The delay, s.
        by_s: f64,
    },
    /// No snapshot arrives, so the monitor does not answer. The controller keeps the last override for `timeout_s`
    /// after the first tick without an answer, and then sets the override to 0.
    Lost {
        /// The controller's time-out, s; 0 if the controller stops at the first missing answer.
        ///
        /// The stopping-distance law does not account for it: its reaction time must include it.
        timeout_s: f64,
    },
    /// All values stay as at the start of the fault, with current stamps.
    Frozen,
    /// The position of one joint is off by a constant.
    Jump {
        /// Index of the joint in `q`.
        joint: usize,
        /// The offset, rad or m.
        by: f64,
    },
    /// All positions are NaN.
    NotANumber,
}

impl InputFault {
    fn is_active(&self, robot: RobotId, t_s: f64) -> bool {
        self.robot == robot && self.from_s <= t_s && t_s < self.to_s
    }
}

/// Replaces the snapshots of robots with faults; the others pass unchanged.
pub(super) struct FaultInjector<'a> {
    faults: &'a [InputFault],
    /// Past snapshots per robot, oldest first; empty if the robot's faults need none.
    past: Vec<VecDeque<StoredSnapshot>>,
    /// The faulty snapshot.
    faulty: StoredSnapshot,
}

/// A stored snapshot.
#[derive(Debug, Clone, Default)]
struct StoredSnapshot {
    stamp_s: f64,
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    programmed_override: f64,
    intent: Option<Vec<f64>>,
}

impl<'a> FaultInjector<'a> {
    pub fn new(faults: &'a [InputFault], robots: usize) -> Self {
        Self { faults, past: vec![VecDeque::new(); robots], faulty: StoredSnapshot::default() }
    }

    /// The snapshot for the robot's monitor at this instant; `None` if none arrives.
    pub fn apply<'s>(&'s mut self, robot: RobotId, actual: &Snapshot<'s>) -> Option<Snapshot<'s>> {
        if !self.faults.iter().any(|f| f.robot == robot) {
            return Some(*actual);
        }
        self.store(robot, actual);
        let Some(fault) = self.active_fault(robot, actual.now_s) else { return Some(*actual) };
        let (source_s, is_fresh) = match fault.kind {
            InputFaultKind::Lost { .. } => return None,
            InputFaultKind::Delayed { by_s } => ((actual.now_s - by_s).max(fault.from_s), false),
            InputFaultKind::Frozen => (fault.from_s, true),
            InputFaultKind::Jump { .. } | InputFaultKind::NotANumber => (actual.now_s, true),
        };
        let past = &self.past[robot.0];
        let source = past.iter().rev().find(|i| i.stamp_s <= source_s + 1e-9).or(past.front())?;
        self.faulty.clone_from(source);
        if is_fresh {
            self.faulty.stamp_s = actual.stamp_s;
        }
        match fault.kind {
            InputFaultKind::Jump { joint, by } => self.faulty.q.iter_mut().skip(joint).take(1).for_each(|q| *q += by),
            InputFaultKind::NotANumber => self.faulty.q.fill(f64::NAN),
            _ => {}
        }
        Some(self.faulty.snapshot(actual))
    }

    /// True if the controller still applies the last override without an answer from its monitor.
    pub fn keeps_last_override(&self, robot: RobotId, t_s: f64) -> bool {
        let lost = self.active_fault(robot, t_s);
        lost.is_some_and(|f| matches!(f.kind, InputFaultKind::Lost { timeout_s } if t_s < f.from_s + timeout_s - 1e-9))
    }

    fn active_fault(&self, robot: RobotId, t_s: f64) -> Option<InputFault> {
        self.faults.iter().find(|f| f.is_active(robot, t_s)).copied()
    }

    fn store(&mut self, robot: RobotId, actual: &Snapshot<'_>) {
        // The oldest snapshot that any fault of this robot may still need.
        let needed = |f: &InputFault| match f.kind {
            InputFaultKind::Delayed { by_s } => actual.now_s - by_s,
            InputFaultKind::Frozen if f.from_s <= actual.now_s && actual.now_s < f.to_s => f.from_s,
            _ => actual.now_s,
        };
        let oldest_s = self.faults.iter().filter(|f| f.robot == robot).map(needed).fold(actual.now_s, f64::min);
        let past = &mut self.past[robot.0];
        past.push_back(StoredSnapshot::of(actual));
        // Keep one snapshot before the oldest needed one: fault times rarely coincide with ticks.
        while past.len() > 1 && past[1].stamp_s <= oldest_s {
            past.pop_front();
        }
    }
}

impl StoredSnapshot {
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

    /// The snapshot with the stored values, and with the monitor's clock and sources.
    fn snapshot<'s>(&'s self, actual: &Snapshot<'s>) -> Snapshot<'s> {
        Snapshot {
            stamp_s: self.stamp_s,
            q: &self.q,
            qd: &self.qd,
            qdd: &self.qdd,
            programmed_override: self.programmed_override,
            intent: self.intent.as_deref(),
            ..*actual
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faulty(kind: InputFaultKind, ticks: u32) -> Vec<Option<(f64, f64)>> {
        let faults = [InputFault { robot: RobotId(0), from_s: 0.01, to_s: 0.03, kind }];
        let mut injector = FaultInjector::new(&faults, 1);
        let one = |i: u32| {
            let t_s = f64::from(i) * 0.005;
            let q = [f64::from(i)];
            injector.apply(RobotId(0), &Snapshot::stationary(t_s, &q)).map(|s| (s.stamp_s, s.q[0]))
        };
        (0..ticks).map(one).collect()
    }

    #[test]
    fn delayed_input_keeps_its_stamps() {
        let seen = faulty(InputFaultKind::Delayed { by_s: 0.01 }, 8);
        let ticks: Vec<f64> = seen.iter().map(|s| s.unwrap().1).collect();
        assert_eq!(ticks, [0.0, 1.0, 2.0, 2.0, 2.0, 3.0, 6.0, 7.0]);
        assert!(seen.iter().flatten().all(|(stamp_s, q)| (stamp_s - q * 0.005).abs() < 1e-12));
    }

    #[test]
    fn frozen_input_has_fresh_stamps_and_lost_input_none() {
        let frozen = faulty(InputFaultKind::Frozen, 7);
        assert_eq!(frozen[5], Some((0.025, 2.0)));
        assert_eq!(frozen[6], Some((0.03, 6.0)));
        let lost = faulty(InputFaultKind::Lost { timeout_s: 0.0 }, 7);
        assert!(lost[1].is_some() && lost[2].is_none() && lost[5].is_none() && lost[6].is_some());
    }

    #[test]
    fn faults_make_positions_jump_or_invalid() {
        assert_eq!(faulty(InputFaultKind::Jump { joint: 0, by: 10.0 }, 4)[3], Some((0.015, 13.0)));
        assert!(faulty(InputFaultKind::NotANumber, 4)[3].unwrap().1.is_nan());
    }
}
