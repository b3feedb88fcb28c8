//! Transforms of links, tool centre points, objects and regions.

use elbowroom_cell::Cell;
use elbowroom_kinematics::{Chain, JointId};
use elbowroom_spatial::Pose;
use elbowroom_status::{CellStatus, PoseStatus};

use super::frames;
use crate::msgs::builtin_interfaces::Time;
use crate::msgs::geometry_msgs::{Transform, TransformStamped};
use crate::msgs::std_msgs::Header;
use crate::msgs::tf2_msgs::TFMessage;

/// Poses of frames.
#[derive(Debug, Clone)]
pub(super) struct Transforms {
    robots: Vec<RobotFrames>,
    /// Parent, child and pose of each frame that never moves.
    fixed: Vec<(String, String, Transform)>,
}

#[derive(Debug, Clone)]
struct RobotFrames {
    name: String,
    chain: Chain,
    /// The joints that move.
    moving: Vec<JointId>,
}

impl Transforms {
    pub(super) fn of_cell(cell: &Cell) -> Self {
        let mut fixed = Vec::new();
        let mut robots = Vec::new();
        for robot in &cell.robots {
            let chain = &robot.robot.chain;
            let link = |id: usize| frames::link(&robot.name, &chain.links()[id]);
            fixed.push((frames::WORLD.to_owned(), link(chain.root().0), (&robot.base_in_world).into()));
            let mut moving = Vec::new();
            for (id, joint) in chain.joints().iter().enumerate() {
                if joint.kind.moves() {
                    moving.push(JointId(id));
                } else {
                    fixed.push((link(joint.parent.0), link(joint.child.0), (&joint.origin).into()));
                }
            }
            robots.push(RobotFrames { name: robot.name.clone(), chain: chain.clone(), moving });
        }
        let objects = cell.objects.iter();
        fixed.extend(objects.map(|o| (frames::WORLD.to_owned(), frames::object(&o.name), (&o.in_world).into())));
        Self { robots, fixed }
    }

    pub(super) fn fixed(&self, stamp: &Time) -> TFMessage {
        let stamped = |(parent, child, pose): &(String, String, Transform)| stamped(stamp, parent, child, pose.clone());
        TFMessage { transforms: self.fixed.iter().map(stamped).collect() }
    }

    pub(super) fn moving(&self, status: &CellStatus, stamp: &Time) -> TFMessage {
        let mut transforms = Vec::new();
        for robot in &status.robots {
            let Some(frames) = self.robots.iter().find(|f| f.name == robot.robot) else { continue };
            // Unknown joint values leave the links at their last poses.
            if robot.q.len() == frames.chain.dof() && robot.q.iter().all(|v| v.is_finite()) {
                frames.write(&robot.q, stamp, &mut transforms);
            }
            // In the world frame, as a robot may change its tool.
            if let Some(tcp) = &robot.tcp {
                transforms.push(stamped(stamp, frames::WORLD, &frames::tcp(&robot.robot), transform(tcp)));
            }
        }
        let mut known: Vec<&str> = Vec::new();
        for region in status.robots.iter().flat_map(|r| &r.regions) {
            // Several robots may have the same region.
            if !known.contains(&region.name.as_str()) {
                known.push(&region.name);
                transforms.push(stamped(stamp, frames::WORLD, &frames::region(&region.name), transform(&region.pose)));
            }
        }
        for object in &status.objects {
            transforms.push(stamped(stamp, frames::WORLD, &frames::object(&object.name), transform(&object.pose)));
        }
        TFMessage { transforms }
    }
}

impl RobotFrames {
    fn write(&self, q: &[f64], stamp: &Time, to: &mut Vec<TransformStamped>) {
        for id in &self.moving {
            let joint = &self.chain.joints()[id.0];
            let pose: Pose = self.chain.child_in_parent(*id, self.chain.joint_value(*id, q));
            let link = |id: usize| frames::link(&self.name, &self.chain.links()[id]);
            to.push(stamped(stamp, &link(joint.parent.0), &link(joint.child.0), (&pose).into()));
        }
    }
}

fn transform(pose: &PoseStatus) -> Transform {
    Transform { translation: pose.position_m.into(), rotation: pose.quaternion_xyzw.into() }
}

fn stamped(stamp: &Time, parent: &str, child: &str, transform: Transform) -> TransformStamped {
    let header = Header { stamp: stamp.clone(), frame_id: parent.to_owned() };
    TransformStamped { header, child_frame_id: child.to_owned(), transform }
}
