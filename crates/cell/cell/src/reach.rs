//! How far a robot reaches.

use elbowroom_kinematics::{JointKind, LinkId};
use elbowroom_proximity::{Shape, Sphere, separation, within};
use elbowroom_robot::Collider;
use elbowroom_spatial::{Pose, Vec3};

use crate::CellRobot;

const POINT: Shape = Shape::Sphere(Sphere { radius: 0.0 });

/// A ball that contains every guarded or solid point of a robot, at any joint values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reach {
    /// Origin of the root link in the world.
    pub base: Vec3,
    /// Radius of the ball, m; infinite if a joint slides without limits.
    pub radius_m: f64,
}

impl Reach {
    /// Sum of offsets, strokes and solids along the chain, with or without tool and load.
    pub fn of(robot: &CellRobot, with_tool: bool) -> Self {
        let chain = &robot.robot.chain;
        let without_payload = robot.without_payload();
        let colliders = if with_tool { &robot.robot.colliders } else { &without_payload.colliders };
        let along = |link: LinkId| {
            let joint = |j: &elbowroom_kinematics::JointId| {
                let joint = &chain.joints()[j.0];
                let slides = joint.kind == JointKind::Prismatic;
                let stroke = if slides { joint.limits.lower.abs().max(joint.limits.upper.abs()) } else { 0.0 };
                joint.origin.translation.length() + stroke
            };
            chain.path(link).iter().map(joint).sum::<f64>()
        };
        let radius = |b: &Collider| {
            let boxed = b.shape.aabb(&b.in_link);
            boxed.min.abs().max(boxed.max.abs()).length()
        };
        let link = |(i, colliders): (usize, &Vec<Collider>)| {
            along(LinkId(i)) + colliders.iter().map(radius).fold(0.0, f64::max)
        };
        let tcp = if with_tool { robot.tcp_in_flange.translation.length() } else { 0.0 };
        let solids = colliders.iter().enumerate().map(link).fold(0.0, f64::max);
        Self { base: robot.base_in_world.translation, radius_m: solids.max(along(robot.flange) + tcp) }
    }

    /// Distance (m) of a solid from the base.
    pub fn distance_m(&self, shape: &Shape, in_world: &Pose) -> f64 {
        separation(&POINT, &Pose::from_translation(self.base), shape, in_world).distance
    }

    /// Whether a solid is within reach, or farther by at most `more_m` (m).
    pub fn meets(&self, shape: &Shape, in_world: &Pose, more_m: f64) -> bool {
        let limit = self.radius_m + more_m;
        // An unbounded reach contains everything.
        !limit.is_finite() || within(&POINT, &Pose::from_translation(self.base), shape, in_world, limit)
    }
}
