//! Where things are that regions follow, and how they move.

use elbowroom_kinematics::ChainState;
use elbowroom_monitor::Source;
use elbowroom_spatial::{Motion, Pose, Vec3};

use crate::{Cell, Follow};

/// Frames of robots and encoders.
#[derive(Debug)]
pub(crate) struct Frames<'a> {
    cell: &'a Cell,
}

impl<'a> Frames<'a> {
    pub fn new(cell: &'a Cell) -> Self {
        Self { cell }
    }

    pub fn sources(&self, follows: &[Follow], states: &[ChainState], t_s: f64) -> Vec<Source> {
        follows.iter().map(|f| self.source(f, states, t_s)).collect()
    }

    /// Pose and motion of a followed frame in the world.
    pub fn source(&self, follow: &Follow, states: &[ChainState], t_s: f64) -> Source {
        match follow {
            Follow::Encoder(e) => {
                let (travel, speed) = self.cell.encoders[*e].at(t_s);
                let direction = self.cell.encoders[*e].direction;
                let motion = Motion { velocity: direction * speed, ..Motion::REST };
                Source { pose: Pose::from_translation(direction * travel), motion, stamp_s: t_s }
            }
            Follow::Object(o) => match self.cell.movers.iter().find(|m| m.object == *o) {
                Some(mover) => Source { pose: mover.pose(t_s), motion: mover.motion(t_s), stamp_s: t_s },
                None => Source { pose: self.cell.objects[*o].in_world, motion: Motion::REST, stamp_s: t_s },
            },
            Follow::Poses(p) => {
                let track = &self.cell.pose_tracks[*p];
                Source { pose: track.pose(t_s), motion: track.motion(t_s), stamp_s: t_s }
            }
            Follow::Robot { robot, link, in_link } => {
                let base = self.cell.robots[*robot].base_in_world;
                let link_in_root = states[*robot].link_in_root(*link);
                let offset = link_in_root.transform_vector(in_link.translation);
                let m = states[*robot].link_motion(*link).shifted(offset);
                let turn = |v: Vec3| base.transform_vector(v);
                let motion = Motion {
                    velocity: turn(m.velocity),
                    angular_velocity: turn(m.angular_velocity),
                    acceleration: turn(m.acceleration),
                    angular_acceleration: turn(m.angular_acceleration),
                };
                Source { pose: base * link_in_root * *in_link, motion, stamp_s: t_s }
            }
        }
    }

    /// Tool centre point in the world (m) and its speed (m/s).
    pub fn tcp(&self, robot: usize, state: &ChainState) -> (Vec3, f64) {
        let r = &self.cell.robots[robot];
        let flange_in_root = state.link_in_root(r.flange);
        let offset = flange_in_root.transform_vector(r.tcp_in_flange.translation);
        let tcp_in_root = flange_in_root * r.tcp_in_flange;
        let speed = state.link_motion(r.flange).velocity_at(offset).length();
        ((r.base_in_world * tcp_in_root).translation, speed)
    }

    /// True where an encoder or a file of poses moves that a region follows, or an object moves.
    pub fn anything_travels(&self, t_s: f64) -> bool {
        let travels = |f: &Option<Follow>| match f {
            Some(Follow::Encoder(e)) => self.cell.encoders[*e].at(t_s).1 != 0.0,
            Some(Follow::Poses(p)) => self.cell.pose_tracks[*p].motion(t_s) != Motion::REST,
            Some(Follow::Robot { .. } | Follow::Object(_)) | None => false,
        };
        self.cell.regions.iter().any(|r| travels(&r.follow)) || self.cell.movers.iter().any(|m| m.moving(t_s))
    }
}
