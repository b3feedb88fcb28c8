//! Encoder or object whose place arrives over the network.

use elbowroom_cell::{Cell, MeasuredSource};
use elbowroom_interlock::Micros;
use elbowroom_monitor::{SourceLimits, SourceState};
use elbowroom_spatial::{FrameMotion, Pose, Rotation, Vec3};

use super::doubt::Doubt;
use super::followed_robot::SAME_MOTION;
use super::inbox::Heard;
use crate::messages::JointState;

/// State of a source that is not known: it is stale in every tick.
pub(crate) const LOST: SourceState =
    SourceState { pose: Pose::IDENTITY, motion: FrameMotion::REST, stamp_s: f64::NEG_INFINITY };

/// Place and velocity of a measured source, from its messages: joint states of one position, or of the numbers of a pose.
#[derive(Debug, Clone)]
pub(crate) struct MeasuredFrame {
    source: MeasuredSource,
    /// The last place, and its time on the clock of the sender.
    last: Option<(Micros, Place)>,
    /// Its velocity; `None` if it is unknown. A source of unknown velocity does not count as at rest.
    velocity: Option<Velocity>,
    /// Whether the numbers of the last message say no place.
    is_unclear: bool,
    /// Age of the place; `None` if place or velocity are unknown.
    pub(crate) age: Option<Micros>,
}

/// What a sender measures.
#[derive(Debug, Clone, Copy)]
enum Place {
    /// Travel of an encoder, m.
    Travel(f64),
    /// Pose of an object in the world.
    Pose(Pose),
}

#[derive(Debug, Clone, Copy)]
enum Velocity {
    /// m/s.
    Speed(f64),
    Twist(FrameMotion),
}

impl MeasuredFrame {
    pub(crate) fn new(source: MeasuredSource) -> Self {
        Self { source, last: None, velocity: None, is_unclear: false, age: None }
    }

    /// The measured sources of a cell, in their order.
    pub(crate) fn all(cell: &Cell) -> Vec<Self> {
        cell.frame_sources.measured.iter().copied().map(Self::new).collect()
    }

    /// Reads the last message, if it is new, and updates the age.
    pub(crate) fn take(&mut self, heard: &mut Heard, cell: &Cell, now: Micros) {
        if std::mem::take(&mut heard.is_new) {
            self.follow(heard, cell);
        }
        let stamp = heard.stamp.filter(|_| self.velocity.is_some());
        self.age = stamp.map(|stamp| heard.now(now) - stamp);
    }

    /// Why the last message that was accepted does not say where the source is and how it moves.
    pub(super) fn doubt(&self) -> Option<Doubt> {
        match (self.is_unclear, self.last, self.velocity) {
            (true, ..) => Some(Doubt::SourceUnclear),
            (false, Some(_), None) => Some(Doubt::SourceVelocity),
            _ => None,
        }
    }

    /// State of the source, without its time; `None` if it is unknown.
    pub(crate) fn state(&self, cell: &Cell) -> Option<SourceState> {
        let (pose, motion) = match (self.source, self.last?.1, self.velocity?) {
            (MeasuredSource::Encoder(e), Place::Travel(travel_m), Velocity::Speed(speed)) => {
                cell.frame_sources.encoders[e].displacement(travel_m, speed)
            }
            (MeasuredSource::Object(_), Place::Pose(pose), Velocity::Twist(motion)) => (pose, motion),
            _ => return None,
        };
        Some(SourceState { pose, motion, stamp_s: 0.0 })
    }

    fn follow(&mut self, heard: &Heard, cell: &Cell) {
        let read = heard.stamp.zip(self.read(&heard.state));
        self.is_unclear = read.is_none();
        let Some((stamp, (place, velocity))) = read else {
            (self.last, self.velocity) = (None, None);
            return;
        };
        let before = self.last.replace((stamp, place));
        self.velocity = velocity.or_else(|| {
            let (then, before) = before?;
            let passed = Some(stamp - then).filter(|passed| *passed <= SAME_MOTION)?;
            if passed == Micros(0) { self.velocity } else { self.derived(cell, before, place, passed) }
        });
    }

    /// Reads a place, and the velocity if it is given; `None` if the numbers are not those of such a source.
    fn read(&self, state: &JointState) -> Option<(Place, Option<Velocity>)> {
        let all = || state.q.iter().chain(&state.qd);
        if !all().all(|v| v.is_finite()) {
            return None;
        }
        match (self.source, &state.q[..]) {
            (MeasuredSource::Encoder(_), [travel_m]) => {
                Some((Place::Travel(*travel_m), state.qd.first().copied().map(Velocity::Speed)))
            }
            (MeasuredSource::Object(_), [x, y, z, i, j, k, w, rest @ ..]) => {
                let rotation = Rotation::from_quaternion_xyzw([*i, *j, *k, *w])?;
                let velocity = match rest {
                    [] => None,
                    [vx, vy, vz, wx, wy, wz] => Some(Velocity::Twist(FrameMotion {
                        velocity: Vec3::new(*vx, *vy, *vz),
                        angular_velocity: Vec3::new(*wx, *wy, *wz),
                        ..FrameMotion::REST
                    })),
                    _ => return None,
                };
                Some((Place::Pose(Pose::new(rotation, Vec3::new(*x, *y, *z))), velocity))
            }
            _ => None,
        }
    }

    /// The mean velocity between two places.
    fn derived(&self, cell: &Cell, before: Place, now: Place, passed: Micros) -> Option<Velocity> {
        let rate = 1e6 / passed.0 as f64;
        match (self.source, before, now) {
            (MeasuredSource::Encoder(e), Place::Travel(before), Place::Travel(now)) => {
                let travelled = now - before;
                let Some(wrap) = cell.frame_sources.encoders[e].wrap_m else {
                    return Some(Velocity::Speed(travelled * rate));
                };
                // An encoder that wraps itself has not gone all the way back. Which way it went is known only if it cannot
                // have gone half the way round.
                let rounds = (travelled / wrap).round() * wrap;
                (2.0 * SourceLimits::default().speed_m_s < wrap * rate)
                    .then_some(Velocity::Speed((travelled - rounds) * rate))
            }
            (MeasuredSource::Object(_), Place::Pose(before), Place::Pose(now)) => {
                let turned = now.rotation * before.rotation.inverse();
                Some(Velocity::Twist(FrameMotion {
                    velocity: (now.translation - before.translation) * rate,
                    angular_velocity: turned.to_rotation_vector() * rate,
                    ..FrameMotion::REST
                }))
            }
            _ => None,
        }
    }
}
