//! Plausibility check of the input.

use std::f64::consts::{PI, TAU};

use elbowroom_kinematics::{Chain, JointId, JointKind, Limits};

use crate::override_history::OverrideRange;
use crate::unchanged_reading::UnchangedReading;
use crate::{Fault, Laws, Snapshot};

/// Settings of the plausibility check.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WatchdogSettings {
    /// Largest plausible speed of a joint as a multiple of its rated speed.
    pub(crate) speed_factor: f64,
    /// Largest plausible speed of a joint without a rated speed, rad/s or m/s: faster than any industrial joint.
    pub(crate) default_speed: f64,
    /// Quantization of the readings (rad or m), if their difference gives a speed.
    pub(crate) jitter: f64,
    /// Largest plausible travel of a joint as a multiple of its reported velocity.
    pub(crate) velocity_factor: f64,
    /// Time (s) between two readings above which velocities do not explain the travel.
    pub(crate) silence_s: f64,
    /// Largest plausible demand of a program as a multiple of a joint's largest speed. At override 1 a program may
    /// demand more than the joint can do, but not so much that the arithmetic fails.
    pub(crate) demand_factor: f64,
    /// Shortest time in which a joint reaches its largest demand, s.
    pub(crate) least_rise_s: f64,
}

impl Default for WatchdogSettings {
    fn default() -> Self {
        Self {
            speed_factor: 1.5,
            default_speed: 20.0,
            jitter: 1e-3,
            velocity_factor: 1.25,
            silence_s: 0.1,
            demand_factor: 100.0,
            least_rise_s: 1e-3,
        }
    }
}

/// Checks each snapshot against the previous one and against the limits of the robot.
#[derive(Debug)]
pub(crate) struct Watchdog {
    settings: WatchdogSettings,
    joints: Vec<JointBound>,
    stale_s: f64,
    /// True with the stopping-distance law, which needs velocities and readings that are not frozen.
    needs_motion: bool,
    last_valid: Option<SnapshotTimes>,
    last_q: Vec<f64>,
    /// Time stamp of the last snapshot, valid or not, and its velocities.
    received_s: Option<f64>,
    received_qd: Vec<f64>,
    /// Largest travel of each joint since the last valid reading by the velocities received since.
    explained_travel: Vec<f64>,
    /// Velocities derived from positions, for snapshots without velocities.
    velocity: Vec<f64>,
    /// Time over which the velocities were derived, s; 0 if they were given.
    derived_over_s: f64,
    unchanged: UnchangedReading,
}

/// Times of a snapshot, s.
#[derive(Debug, Clone, Copy)]
struct SnapshotTimes {
    now_s: f64,
    stamp_s: f64,
}

#[derive(Debug)]
struct JointBound {
    limits: Limits,
    max_speed: f64,
    wraps: bool,
}

impl JointBound {
    /// Difference of two readings; the shorter way round if the joint is continuous.
    fn step(&self, from: f64, to: f64) -> f64 {
        let step = to - from;
        if self.wraps { (step + PI).rem_euclid(TAU) - PI } else { step }
    }
}

impl Watchdog {
    pub(crate) fn new(chain: &Chain, laws: &Laws, settings: WatchdogSettings) -> Self {
        let bound = |id: &JointId| {
            let joint = &chain.joints()[id.0];
            let wraps = joint.kind == JointKind::Continuous;
            JointBound {
                limits: joint.limits,
                max_speed: joint.limits.velocity.map_or(settings.default_speed, |v| v * settings.speed_factor),
                wraps,
            }
        };
        let zeros = vec![0.0; chain.dof()];
        let joints: Vec<JointBound> = chain.active_joints().iter().map(bound).collect();
        let unchanged = UnchangedReading::new(laws, joints.iter().map(|j| j.max_speed).collect());
        Self {
            settings,
            joints,
            stale_s: laws.stale_s,
            needs_motion: laws.stopping_distance.is_some(),
            last_valid: None,
            last_q: zeros.clone(),
            received_s: None,
            received_qd: zeros.clone(),
            explained_travel: zeros.clone(),
            velocity: zeros,
            derived_over_s: 0.0,
            unchanged,
        }
    }

    /// Accepts and stores the snapshot, or returns its fault. `overrides` are the overrides that the robot may be
    /// executing.
    pub(crate) fn check(&mut self, s: &Snapshot, sources: usize, overrides: OverrideRange) -> Result<(), Fault> {
        self.check_form(s, sources)?;
        self.check_time(s)?;
        self.receive(s);
        self.check_joints(s)?;
        let motion = if self.needs_motion { self.check_motion(s, overrides) } else { Ok(()) };
        self.last_valid = Some(SnapshotTimes { now_s: s.now_s, stamp_s: s.stamp_s });
        self.last_q.copy_from_slice(s.q);
        self.unchanged.take_program(s);
        self.explained_travel.fill(0.0);
        motion
    }

    /// Forgets the last valid snapshot: the next joint values may be anywhere.
    pub(crate) fn forget_position(&mut self) {
        self.last_valid = None;
        self.explained_travel.fill(0.0);
        self.unchanged.forget();
    }

    /// Seconds since the last valid snapshot.
    pub(crate) fn since_last(&self, s: &Snapshot) -> f64 {
        self.last_valid.map_or(0.0, |last| (s.now_s - last.now_s).max(0.0))
    }

    /// Joint velocities derived from successive positions; empty if none are needed.
    pub(crate) fn velocity(&self) -> &[f64] {
        if self.needs_motion { &self.velocity } else { &[] }
    }

    /// Uncertainty of the time of the velocities, s: they are the velocities at some instant within this time before the
    /// last valid snapshot; 0 if they were given.
    pub(crate) fn velocity_uncertain_s(&self) -> f64 {
        self.derived_over_s
    }

    /// Largest program time (s) since the reading last changed.
    pub(crate) fn max_unchanged_s(&self) -> f64 {
        self.unchanged.max_s()
    }

    fn check_form(&self, s: &Snapshot, sources: usize) -> Result<(), Fault> {
        let dof = self.joints.len();
        let fits = |v: &[f64]| v.is_empty() || v.len() == dof;
        if s.q.len() != dof
            || !fits(s.qd)
            || !fits(s.qdd)
            || s.intent.is_some_and(|i| i.len() != dof)
            || s.sources.len() != sources
        {
            return Err(Fault::WrongLength);
        }
        let intent = s.intent.unwrap_or(&[]);
        let mut numbers = [s.q, s.qd, s.qdd, intent].into_iter().flatten().chain([&s.now_s, &s.stamp_s]);
        if !numbers.all(|v| v.is_finite()) {
            return Err(Fault::NotFinite);
        }
        if (0.0..=1.0).contains(&s.programmed_override) { Ok(()) } else { Err(Fault::ProgrammedOverride) }
    }

    fn check_time(&self, s: &Snapshot) -> Result<(), Fault> {
        let earlier = self.last_valid.is_some_and(|last| s.now_s < last.now_s || s.stamp_s < last.stamp_s);
        if earlier || s.stamp_s > s.now_s {
            return Err(Fault::Backwards);
        }
        if s.now_s - s.stamp_s > self.stale_s { Err(Fault::Stale) } else { Ok(()) }
    }

    /// Accumulates the travel that the reported velocities explain.
    fn receive(&mut self, s: &Snapshot) {
        let silence_s = self.received_s.map_or(f64::INFINITY, |received_s| (s.stamp_s - received_s).max(0.0));
        for (joint, bound) in self.joints.iter().enumerate() {
            let speed = match s.qd.get(joint) {
                Some(qd) if silence_s <= self.settings.silence_s => {
                    self.settings.velocity_factor * qd.abs().max(self.received_qd[joint].abs())
                }
                _ => bound.max_speed,
            };
            self.explained_travel[joint] += speed.min(bound.max_speed) * silence_s;
        }
        self.received_s = Some(s.stamp_s);
        if s.qd.is_empty() { self.received_qd.fill(0.0) } else { self.received_qd.copy_from_slice(s.qd) }
    }

    fn check_joints(&self, s: &Snapshot) -> Result<(), Fault> {
        for (joint, bound) in self.joints.iter().enumerate() {
            let q = s.q[joint];
            if !bound.limits.is_plausible(q) {
                return Err(Fault::BeyondLimits { joint, overshoot: bound.limits.overshoot(q) });
            }
            let is_fast = s.qd.get(joint).is_some_and(|v| v.abs() > bound.max_speed);
            if is_fast || self.demands_too_much(s, joint, bound) || self.jumped(s, joint, bound) {
                return Err(Fault::TooFast { joint });
            }
        }
        Ok(())
    }

    fn demands_too_much(&self, s: &Snapshot, joint: usize, bound: &JointBound) -> bool {
        let rise = s.qdd.get(joint).map(|a| a * self.settings.least_rise_s);
        let most = self.settings.demand_factor * bound.max_speed.max(0.01);
        [s.intent.map(|intent| intent[joint]), rise].into_iter().flatten().any(|v| v.abs() > most)
    }

    fn jumped(&self, s: &Snapshot, joint: usize, bound: &JointBound) -> bool {
        let Some(last) = self.last_valid else { return false };
        let possible = bound.max_speed * (s.stamp_s - last.stamp_s);
        let explained = possible.min(self.explained_travel[joint]);
        bound.step(self.last_q[joint], s.q[joint]).abs() > explained + self.settings.jitter
    }

    /// Requires known velocities, and readings that change while the robot moves.
    fn check_motion(&mut self, s: &Snapshot, overrides: OverrideRange) -> Result<(), Fault> {
        let Some(last) = self.last_valid else {
            return if s.qd.is_empty() { Err(Fault::NoVelocity) } else { Ok(()) };
        };
        let passed_s = s.stamp_s - last.stamp_s;
        self.derive_velocity(s, passed_s);
        if s.q.iter().zip(&self.last_q).any(|(a, b)| a.to_bits() != b.to_bits()) {
            self.unchanged.forget();
            return Ok(());
        }
        if passed_s <= self.settings.silence_s {
            self.unchanged.count(s, passed_s, overrides);
        }
        if self.unchanged.is_frozen() { Err(Fault::Frozen) } else { Ok(()) }
    }

    fn derive_velocity(&mut self, s: &Snapshot, passed_s: f64) {
        if !s.qd.is_empty() {
            self.derived_over_s = 0.0;
        } else if passed_s > 0.0 {
            let steps = self.joints.iter().zip(&self.last_q).zip(s.q);
            self.velocity.iter_mut().zip(steps).for_each(|(v, ((b, from), to))| *v = b.step(*from, *to) / passed_s);
            self.derived_over_s = passed_s;
        }
    }
}
