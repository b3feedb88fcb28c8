//! Predicted motion of observed obstacles: constant velocity and turn rate.

use elbowroom_proximity::ccd::ConstantTwist;
use elbowroom_spatial::{FrameMotion, Pose, Rotation};

use crate::{Neighbour, ObservedObject};

/// Time, s, for which another robot is predicted to continue its motion before it rests: its joints reverse sooner than
/// a vehicle.
const ROBOT_MOTION_S: f64 = 0.5;

/// Pose and motion of an object after `t_s` seconds. Its velocity turns with it, like the velocity of a vehicle in a
/// curve.
fn after(object: &ObservedObject, t_s: f64) -> (Pose, FrameMotion) {
    let FrameMotion { velocity, angular_velocity, .. } = object.motion;
    let turn = Rotation::from_rotation_vector(angular_velocity * t_s);
    let rate = angular_velocity.length();
    let travel = match angular_velocity.try_normalize().filter(|_| rate * t_s > 1e-9) {
        None => velocity * t_s,
        Some(axis) => {
            // The integral of the turning velocity.
            let along = axis * axis.dot(velocity);
            let across = velocity - along;
            let (s, c) = (rate * t_s).sin_cos();
            along * t_s + across * (s / rate) + axis.cross(across) * ((1.0 - c) / rate)
        }
    };
    let start = object.in_world;
    let pose = Pose { translation: start.translation + travel, rotation: turn * start.rotation };
    (pose, FrameMotion { velocity: turn * velocity, angular_velocity, ..FrameMotion::REST })
}

/// The predicted pose of an object after `t_s` seconds.
pub(crate) fn pose_after(object: &ObservedObject, t_s: f64) -> Pose {
    after(object, t_s).0
}

/// The predicted motion of an object from `from_s` to `to_s` seconds from now.
pub(crate) fn motion_between(object: &ObservedObject, from_s: f64, to_s: f64) -> ConstantTwist {
    let (pose, motion) = after(object, from_s);
    ConstantTwist::from_motion(pose, &motion, to_s - from_s)
}

/// Writes the predicted joint values of another robot after `t_s` seconds.
pub(crate) fn q_after(robot: &Neighbour<'_>, t_s: f64, out: &mut [f64]) {
    let t = t_s.min(ROBOT_MOTION_S);
    out.iter_mut().zip(robot.q.iter().zip(robot.qd)).for_each(|(out, (q, qd))| *out = q + qd * t);
}

#[cfg(test)]
mod tests {
    use elbowroom_robot::ObjectId;
    use elbowroom_spatial::Vec3;

    use super::*;

    #[test]
    fn a_vehicle_in_a_curve_drives_on_its_circle() {
        let (radius, rate) = (2.0, 0.5);
        let motion =
            FrameMotion { velocity: Vec3::Y * (radius * rate), angular_velocity: Vec3::Z * rate, ..FrameMotion::REST };
        let in_world = Pose::from_translation(Vec3::X * radius);
        let object = ObservedObject { object: ObjectId(0), in_world, motion, known: false };
        for n in 0..30 {
            let t = 0.1 * f64::from(n);
            let (s, c) = (rate * t).sin_cos();
            let pose = pose_after(&object, t);
            assert!(pose.translation.distance(Vec3::new(c, s, 0.0) * radius) < 1e-12, "{t}");
            assert!((pose.rotation * Vec3::X).distance(Vec3::new(c, s, 0.0)) < 1e-12, "{t}");
            // Velocities continue from one stretch to the next.
            let next = motion_between(&object, t, t + 1e-4).velocity;
            assert!((next * 1e4).distance(Vec3::new(-s, c, 0.0) * (radius * rate)) < 1e-9, "{t}");
        }
    }

    #[test]
    fn an_object_without_turn_moves_straight() {
        let motion = FrameMotion { velocity: Vec3::new(0.3, -0.2, 0.0), ..FrameMotion::REST };
        let object = ObservedObject { object: ObjectId(0), in_world: Pose::IDENTITY, motion, known: false };
        assert_eq!(pose_after(&object, 2.0).translation, Vec3::new(0.6, -0.4, 0.0));
    }
}
