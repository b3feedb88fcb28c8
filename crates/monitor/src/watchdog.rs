//! Does the input deserve trust? (P.6, W.9)

use std::f64::consts::{PI, TAU};

use elbowroom_kinematics::{Chain, JointKind};

use crate::commands::Obeyed;
use crate::{Fault, Laws, Snapshot};

/// A joint beyond its limits by more than this (rad or m) is an implausible reading: controllers overshoot by less.
const LIMIT_TOLERANCE: f64 = 0.05;
/// A joint is implausibly fast beyond this share of its rated speed.
const SPEED_TOLERANCE: f64 = 1.5;
/// Speed assumed possible where the model gives none, rad/s and m/s: faster than any industrial joint.
const FASTEST: f64 = 20.0;
/// Allowance (rad or m) for the quantization of readings when their difference is turned into a speed.
const JITTER: f64 = 1e-3;
/// A joint may move by this share more than its reported velocities say.
const VELOCITY_TOLERANCE: f64 = 1.25;
/// After a longer silence (s) velocities explain nothing.
const SILENCE_S: f64 = 0.1;
/// A reading that stays the same to the last bit for so much of the program's time (s) is frozen.
const FROZEN_S: f64 = 0.1;

/// Checks each snapshot against the one before and against what the robot can do.
#[derive(Debug)]
pub(crate) struct Watchdog {
    joints: Vec<JointBound>,
    stale_s: f64,
    /// The stopping-distance law needs velocities, and readings that are alive.
    needs_motion: bool,
    /// Times of the last trusted snapshot.
    last: Option<(f64, f64)>,
    last_q: Vec<f64>,
    /// Stamp of the last snapshot that was heard, trusted or not, and its velocities.
    heard_s: Option<f64>,
    heard_qd: Vec<f64>,
    /// How far each joint may be from its last trusted reading by the velocities heard since.
    explained: Vec<f64>,
    /// Derived from positions, where none are given.
    velocity: Vec<f64>,
    /// Time over which it was derived, s.
    derived_over_s: f64,
    /// Program time that may have passed since the reading last changed, s.
    unnoticed_s: f64,
    /// Program time that must have passed since then, unless the reading is frozen, s.
    frozen_s: f64,
}

#[derive(Debug)]
struct JointBound {
    lower: f64,
    upper: f64,
    fastest: f64,
    wraps: bool,
}

impl JointBound {
    /// From one reading to another, the short way round where the joint turns without end.
    fn step(&self, from: f64, to: f64) -> f64 {
        let step = to - from;
        if self.wraps { (step + PI).rem_euclid(TAU) - PI } else { step }
    }
}

impl Watchdog {
    pub(crate) fn new(chain: &Chain, laws: &Laws) -> Self {
        let bound = |id: &elbowroom_kinematics::JointId| {
            let joint = &chain.joints()[id.0];
            let wraps = joint.kind == JointKind::Continuous;
            JointBound {
                lower: if wraps { f64::NEG_INFINITY } else { joint.limits.lower - LIMIT_TOLERANCE },
                upper: if wraps { f64::INFINITY } else { joint.limits.upper + LIMIT_TOLERANCE },
                fastest: joint.limits.velocity.map_or(FASTEST, |v| v * SPEED_TOLERANCE),
                wraps,
            }
        };
        let zeros = vec![0.0; chain.dof()];
        Self {
            joints: chain.active_joints().iter().map(bound).collect(),
            stale_s: laws.stale_s,
            needs_motion: laws.stopping_distance.is_some(),
            last: None,
            last_q: zeros.clone(),
            heard_s: None,
            heard_qd: zeros.clone(),
            explained: zeros.clone(),
            velocity: zeros,
            derived_over_s: 0.0,
            unnoticed_s: 0.0,
            frozen_s: 0.0,
        }
    }

    /// Accepts the snapshot and remembers it, or says what is wrong with it; `obeyed` are the overrides that the robot may be
    /// obeying.
    pub(crate) fn check(&mut self, s: &Snapshot, sources: usize, obeyed: Obeyed) -> Result<(), Fault> {
        self.check_form(s, sources)?;
        self.check_time(s)?;
        self.hear(s);
        self.check_joints(s)?;
        let motion = if self.needs_motion { self.check_motion(s, obeyed) } else { Ok(()) };
        self.last = Some((s.now_s, s.stamp_s));
        self.last_q.copy_from_slice(s.q);
        self.explained.fill(0.0);
        motion
    }

    /// Seconds between this snapshot and the one accepted before.
    pub(crate) fn since_last(&self, s: &Snapshot) -> f64 {
        self.last.map_or(0.0, |(now_s, _)| (s.now_s - now_s).max(0.0))
    }

    /// Joint velocities derived from successive positions; empty where none are needed.
    pub(crate) fn velocity(&self) -> &[f64] {
        if self.needs_motion { &self.velocity } else { &[] }
    }

    /// The velocities of the last trusted snapshot are those of some instant within this time (s) before it; 0 where they
    /// were given.
    pub(crate) fn velocity_uncertain_s(&self) -> f64 {
        self.derived_over_s
    }

    /// Program time (s) that may have passed since the reading last changed.
    pub(crate) fn unnoticed_s(&self) -> f64 {
        self.unnoticed_s
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
        let earlier = self.last.is_some_and(|(now_s, stamp_s)| s.now_s < now_s || s.stamp_s < stamp_s);
        if earlier || s.stamp_s > s.now_s {
            return Err(Fault::Backwards);
        }
        if s.now_s - s.stamp_s > self.stale_s { Err(Fault::Stale) } else { Ok(()) }
    }

    /// Adds up how far the joints may have moved by what is said of their velocities.
    fn hear(&mut self, s: &Snapshot) {
        let silence_s = self.heard_s.map_or(f64::INFINITY, |heard_s| (s.stamp_s - heard_s).max(0.0));
        for (joint, bound) in self.joints.iter().enumerate() {
            let speed = match s.qd.get(joint) {
                Some(qd) if silence_s <= SILENCE_S => VELOCITY_TOLERANCE * qd.abs().max(self.heard_qd[joint].abs()),
                _ => bound.fastest,
            };
            self.explained[joint] += speed.min(bound.fastest) * silence_s;
        }
        self.heard_s = Some(s.stamp_s);
        if s.qd.is_empty() { self.heard_qd.fill(0.0) } else { self.heard_qd.copy_from_slice(s.qd) }
    }

    fn check_joints(&self, s: &Snapshot) -> Result<(), Fault> {
        for (joint, bound) in self.joints.iter().enumerate() {
            let q = s.q[joint];
            if !(bound.lower <= q && q <= bound.upper) {
                return Err(Fault::BeyondLimits { joint });
            }
            if s.qd.get(joint).is_some_and(|v| v.abs() > bound.fastest) || self.jumped(s, joint, bound) {
                return Err(Fault::TooFast { joint });
            }
        }
        Ok(())
    }

    fn jumped(&self, s: &Snapshot, joint: usize, bound: &JointBound) -> bool {
        let Some((_, stamp_s)) = self.last else { return false };
        let possible = bound.fastest * (s.stamp_s - stamp_s);
        bound.step(self.last_q[joint], s.q[joint]).abs() > possible.min(self.explained[joint]) + JITTER
    }

    /// Velocities must be known, and a reading must change while the robot moves.
    fn check_motion(&mut self, s: &Snapshot, obeyed: Obeyed) -> Result<(), Fault> {
        let Some((_, stamp_s)) = self.last else {
            return if s.qd.is_empty() { Err(Fault::NoVelocity) } else { Ok(()) };
        };
        let passed_s = s.stamp_s - stamp_s;
        self.derive_velocity(s, passed_s);
        let wanted = s.intent.unwrap_or(s.qd);
        if s.q.iter().zip(&self.last_q).any(|(a, b)| a.to_bits() != b.to_bits()) {
            (self.unnoticed_s, self.frozen_s) = (0.0, 0.0);
        } else if passed_s <= SILENCE_S && wanted.iter().any(|v| *v != 0.0) {
            self.unnoticed_s += obeyed.largest * passed_s;
            self.frozen_s += obeyed.least * passed_s;
        }
        if self.frozen_s > FROZEN_S { Err(Fault::Frozen) } else { Ok(()) }
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
