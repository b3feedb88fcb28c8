//! The path of an object between two instants.

use elbowroom_proximity::impact::{Path, Steady};
use elbowroom_spatial::Pose;

use super::{Drive, Mover};

/// How an object goes from one time to another; `t` of the [`Path`] goes from 0 to 1.
#[derive(Debug, Clone, Copy)]
pub struct Leg<'m> {
    mover: &'m Mover,
    from_s: f64,
    to_s: f64,
    steady: Option<Steady>,
}

impl<'m> Leg<'m> {
    pub(super) fn new(mover: &'m Mover, from_s: f64, to_s: f64) -> Self {
        let changes = match &mover.drive {
            Drive::Belt(encoder) => encoder.changes(from_s, to_s) || encoder.begins_again(from_s, to_s),
            Drive::Way(way) => way.changes(from_s, to_s),
        };
        let steady = || Steady::from_motion(mover.pose(from_s), &mover.motion(from_s), to_s - from_s);
        Self { mover, from_s, to_s, steady: (!changes).then(steady) }
    }

    /// True where the object does not go all of the way: its belt begins again in between.
    pub fn jumps(&self) -> bool {
        match &self.mover.drive {
            Drive::Belt(encoder) => encoder.begins_again(self.from_s, self.to_s),
            Drive::Way(_) => false,
        }
    }

    fn time(&self, t: f64) -> f64 {
        // Exact at both ends.
        if t == 1.0 { self.to_s } else { self.from_s + t * (self.to_s - self.from_s) }
    }
}

impl Path for Leg<'_> {
    fn pose(&self, t: f64) -> Pose {
        self.mover.pose(self.time(t))
    }

    fn speed(&self, radius: f64, from: f64, to: f64) -> f64 {
        let seconds = self.to_s - self.from_s;
        let fastest = match &self.mover.drive {
            _ if self.jumps() => return f64::INFINITY,
            Drive::Belt(encoder) => encoder.fastest(self.time(from), self.time(to)),
            Drive::Way(way) => way.fastest(radius),
        };
        // Positions far away are rounded: never say less than what they do.
        fastest * seconds * (1.0 + 1e-9)
    }

    fn steady(&self) -> Option<Steady> {
        self.steady
    }
}
