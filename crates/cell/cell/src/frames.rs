//! Poses and velocities of the sources that regions follow.

use elbowroom_kinematics::ChainState;
use elbowroom_monitor::SourceState;
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_spatial::{FrameMotion, Vec3};

use crate::{Cell, Drive, Follow, FrameSources, MeasuredSource, MovingObject};

/// Frames of robots, encoders, objects and pose files.
#[derive(Debug)]
pub struct Frames<'a> {
    cell: &'a Cell,
    measured: &'a [SourceState],
}

impl<'a> Frames<'a> {
    /// The frames of a cell.
    pub fn new(cell: &'a Cell) -> Self {
        Self { cell, measured: &[] }
    }

    /// The frames of a cell in which the measured sources, in the order of
    /// [`FrameSources::measured`](crate::FrameSources::measured), are where these states say.
    pub fn with_measured(cell: &'a Cell, measured: &'a [SourceState]) -> Self {
        Self { cell, measured }
    }

    /// Index of the measured source that a followed frame moves with; `None` if it moves as the cell file says.
    pub fn measured_source(&self, follow: &Follow) -> Option<usize> {
        let FrameSources { encoders, measured, .. } = &self.cell.frame_sources;
        if measured.is_empty() {
            return None;
        }
        let index = |source: MeasuredSource| measured.iter().position(|m| *m == source);
        match follow {
            Follow::Encoder(e) => index(MeasuredSource::Encoder(*e)),
            Follow::Object(o) => index(MeasuredSource::Object(*o)).or_else(|| {
                let Drive::Belt(belt) = &self.moving_object(*o)?.drive else { return None };
                index(MeasuredSource::Encoder(encoders.iter().position(|e| e.name == belt.name)?))
            }),
            Follow::Poses(_) | Follow::Robot { .. } => None,
        }
    }

    /// Pose and velocity of a frame that moves with a measured source.
    fn measured(&self, follow: &Follow) -> Option<SourceState> {
        let index = self.measured_source(follow)?;
        let state = *self.measured.get(index)?;
        match (follow, self.cell.frame_sources.measured[index]) {
            (Follow::Object(o), MeasuredSource::Encoder(_)) => {
                let rest = self.moving_object(*o)?.rest_in_world;
                Some(SourceState { pose: state.pose * rest, ..state })
            }
            _ => Some(state),
        }
    }

    fn moving_object(&self, object: ObjectId) -> Option<&MovingObject> {
        self.cell.moving_objects.iter().find(|m| m.object == object)
    }

    /// The [`Self::source`] of each followed frame, in order.
    pub fn sources(&self, follows: &[Follow], states: &[ChainState], t_s: f64) -> Vec<SourceState> {
        follows.iter().map(|f| self.source(f, states, t_s)).collect()
    }

    /// Pose and velocity of a followed frame in the world.
    pub fn source(&self, follow: &Follow, states: &[ChainState], t_s: f64) -> SourceState {
        if let Some(state) = self.measured(follow) {
            return state;
        }
        match follow {
            Follow::Encoder(e) => {
                let encoder = &self.cell.frame_sources.encoders[*e];
                let (travel, speed) = encoder.at(t_s);
                let (pose, motion) = encoder.displacement(travel, speed);
                SourceState { pose, motion, stamp_s: t_s }
            }
            Follow::Object(o) => match self.moving_object(*o) {
                Some(moving_object) => {
                    SourceState { pose: moving_object.pose(t_s), motion: moving_object.motion(t_s), stamp_s: t_s }
                }
                None => SourceState { pose: self.cell.objects[o.0].in_world, motion: FrameMotion::REST, stamp_s: t_s },
            },
            Follow::Poses(p) => {
                let track = &self.cell.frame_sources.pose_tracks[*p];
                SourceState { pose: track.pose(t_s), motion: track.motion(t_s), stamp_s: t_s }
            }
            Follow::Robot { robot, link, in_link } => {
                let base = self.cell.robots[robot.0].base_in_world;
                let link_in_root = states[robot.0].link_in_root(*link);
                let offset = link_in_root.transform_vector(in_link.translation);
                let m = states[robot.0].link_motion(*link).shifted(offset);
                let turn = |v: Vec3| base.transform_vector(v);
                let motion = FrameMotion {
                    velocity: turn(m.velocity),
                    angular_velocity: turn(m.angular_velocity),
                    acceleration: turn(m.acceleration),
                    angular_acceleration: turn(m.angular_acceleration),
                };
                SourceState { pose: base * link_in_root * *in_link, motion, stamp_s: t_s }
            }
        }
    }

    /// Whether the cell file moves an object.
    pub fn is_driven(&self, object: ObjectId) -> bool {
        self.moving_object(object).is_some()
    }

    /// Tool centre point of a robot in the world (m) and its speed (m/s).
    pub fn tcp(&self, robot: RobotId, state: &ChainState) -> (Vec3, f64) {
        self.cell.robots[robot.0].tcp(state)
    }

    /// True if an encoder or a pose file that a region follows moves, or an object moves.
    pub fn is_any_moving(&self, t_s: f64) -> bool {
        self.cell.regions.iter().any(|r| r.follow.is_some_and(|f| !is_object(&f) && self.travels(&f, t_s)))
            || self.cell.moving_objects.iter().any(|m| m.is_moving(t_s))
    }

    /// Like [`Frames::is_any_moving`], without the belts that never stop and the objects on them.
    pub fn is_any_moving_but_endless_belts(&self, t_s: f64) -> bool {
        let is_endless =
            |f: &Follow| matches!(f, Follow::Encoder(e) if self.cell.frame_sources.encoders[*e].is_endless());
        let is_carried = |drive: &Drive| matches!(drive, Drive::Belt(encoder) if encoder.is_endless());
        let follows = self.cell.regions.iter().filter_map(|r| r.follow);
        follows.filter(|f| !is_object(f) && !is_endless(f)).any(|f| self.travels(&f, t_s))
            || self.cell.moving_objects.iter().any(|m| !is_carried(&m.drive) && m.is_moving(t_s))
    }

    /// True if a followed frame moves by itself; frames of robots do not.
    pub fn travels(&self, follow: &Follow, t_s: f64) -> bool {
        match follow {
            Follow::Encoder(e) => self.cell.frame_sources.encoders[*e].at(t_s).1 != 0.0,
            Follow::Poses(p) => self.cell.frame_sources.pose_tracks[*p].motion(t_s) != FrameMotion::REST,
            Follow::Object(o) => self.cell.moving_objects.iter().any(|m| m.object == *o && m.is_moving(t_s)),
            Follow::Robot { .. } => false,
        }
    }
}

fn is_object(follow: &Follow) -> bool {
    matches!(follow, Follow::Object(_))
}
