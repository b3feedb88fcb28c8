//! Does the input deserve trust? (P.6, W.9)

use std::f64::consts::{PI, TAU};

use elbowroom_kinematics::{Chain, JointKind};

use crate::{Fault, Snapshot};

/// A joint beyond its limits by more than this (rad or m) is an implausible reading: controllers overshoot by less.
const LIMIT_TOLERANCE: f64 = 0.05;
/// A joint is implausibly fast beyond this share of its rated speed.
const SPEED_TOLERANCE: f64 = 1.5;
/// Speed assumed possible where the model gives none, rad/s and m/s: faster than any industrial joint.
const FASTEST: f64 = 20.0;
/// Allowance (rad or m) for the quantization of readings when their difference is turned into a speed.
const JITTER: f64 = 1e-3;

/// Checks each snapshot against the one before and against what the robot can do.
#[derive(Debug)]
pub(crate) struct Watchdog {
    joints: Vec<JointBound>,
    stale_s: f64,
    last: Option<(f64, f64)>,
    last_q: Vec<f64>,
}

#[derive(Debug)]
struct JointBound {
    lower: f64,
    upper: f64,
    fastest: f64,
    wraps: bool,
}

impl Watchdog {
    pub(crate) fn new(chain: &Chain, stale_s: f64) -> Self {
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
        Self {
            joints: chain.active_joints().iter().map(bound).collect(),
            stale_s,
            last: None,
            last_q: vec![0.0; chain.dof()],
        }
    }

    /// Accepts the snapshot and remembers it, or says what is wrong with it.
    pub(crate) fn check(&mut self, s: &Snapshot, sources: usize) -> Result<(), Fault> {
        self.check_form(s, sources)?;
        self.check_time(s)?;
        self.check_joints(s)?;
        self.last = Some((s.now_s, s.stamp_s));
        self.last_q.copy_from_slice(s.q);
        Ok(())
    }

    /// Seconds between this snapshot and the one accepted before.
    pub(crate) fn since_last(&self, s: &Snapshot) -> f64 {
        self.last.map_or(0.0, |(now_s, _)| (s.now_s - now_s).max(0.0))
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
        let mut step = (s.q[joint] - self.last_q[joint]).abs();
        if bound.wraps {
            step = (step + PI).rem_euclid(TAU) - PI;
        }
        step.abs() > bound.fastest * (s.stamp_s - stamp_s) + JITTER
    }
}
