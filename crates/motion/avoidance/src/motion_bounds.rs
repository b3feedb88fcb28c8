//! Bounds of the motion of links by joints, for proofs that nothing can collide before the next tick.

use elbowroom_kinematics::LinkId;
use elbowroom_kinematics::motion_bound::motion_bound;
use elbowroom_robot::{ObjectId, Robot, RobotId};
use elbowroom_scene::{Scene, SceneState};
use elbowroom_spatial::Vec3;

use crate::{ObstacleKind, ProximityPair};

/// Bounds in metres per rad (or m) of each joint: per link, and per pair of links relative to each other.
#[derive(Debug, Clone)]
pub(crate) struct MotionBounds {
    links: usize,
    joints: usize,
    of_link: Vec<f64>,
    of_pair: Vec<f64>,
}

impl MotionBounds {
    /// Computes the bounds of a robot. `attached_radius_m` is, per link, the largest distance of a point of an attached
    /// object from the link's origin, m.
    fn new(robot: &Robot, attached_radius_m: impl Fn(LinkId) -> f64) -> Self {
        let chain = &robot.chain;
        let (links, joints) = (chain.links().len(), chain.dof());
        let mut bounds =
            Self { links, joints, of_link: vec![0.0; links * joints], of_pair: vec![0.0; links * links * joints] };
        let radius = |l: usize| robot.link_radius(LinkId(l)).max(attached_radius_m(LinkId(l)));
        for a in 0..links {
            let path = chain.path(LinkId(a));
            for (joint, lever_arm) in motion_bound(chain, LinkId(a), radius(a), &path) {
                bounds.of_link[a * joints + joint] += lever_arm;
            }
            for b in 0..links {
                let other = chain.path(LinkId(b));
                let between: Vec<_> = path.iter().copied().filter(|j| !other.contains(j)).collect();
                // Each link of a pair is moved by the joints that are not on the path of the other link.
                for (joint, lever_arm) in motion_bound(chain, LinkId(a), radius(a), &between) {
                    bounds.of_pair[(a * links + b) * joints + joint] += lever_arm;
                    bounds.of_pair[(b * links + a) * joints + joint] += lever_arm;
                }
            }
        }
        bounds
    }

    /// The bounds of a robot of a scene, with the objects that are attached to it.
    pub(crate) fn of_state(scene: &Scene, state: &SceneState, robot: RobotId) -> Self {
        let attached = (0..scene.objects().len()).filter_map(|o| {
            let a = state.attachment(ObjectId(o)).filter(|a| a.robot == robot)?;
            Some((a.link, scene.objects()[o].shape.aabb(&a.in_link).max_distance(Vec3::ZERO)))
        });
        let attached: Vec<(LinkId, f64)> = attached.collect();
        let radius = |link| attached.iter().filter(|(l, _)| *l == link).map(|(_, r)| *r).fold(0.0, f64::max);
        Self::new(&scene.robots()[robot.0].robot, radius)
    }

    /// Upper bound of the travel of any point of any link in `dt` seconds at joint velocities `qd`, m.
    pub(crate) fn max_travel(&self, qd: &[f64], dt: f64) -> f64 {
        let of = |row: &[f64]| row.iter().zip(qd).map(|(lever_arm, v)| lever_arm * v.abs()).sum::<f64>();
        self.of_link.chunks(self.joints.max(1)).map(of).fold(0.0, f64::max) * dt
    }

    /// Upper bound of the decrease of the pair's distance in `dt` seconds at joint velocities `qd`, m.
    pub(crate) fn max_closing(&self, pair: &ProximityPair, qd: &[f64], dt: f64) -> f64 {
        let a = pair.link.0;
        let row = match pair.obstacle {
            ObstacleKind::OwnLink(b) => &self.of_pair[(a * self.links + b.0) * self.joints..][..self.joints],
            _ => &self.of_link[a * self.joints..][..self.joints],
        };
        row.iter().zip(qd).map(|(lever_arm, v)| lever_arm * v.abs()).sum::<f64>() * dt
    }
}
