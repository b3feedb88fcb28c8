//! Two RX60B side by side, and their states.

use std::path::Path;

use elbowroom_formats::robot::{self, LoadOptions};
use elbowroom_proximity::Shape;
use elbowroom_robot::Robot;
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, PairState, Reason, Scene, SceneState, Selection};
use elbowroom_spatial::{Pose, Vec3};

use super::sequence::Sequence;

pub const RIGHT: Selection = Selection::Robot(RobotId(0));
pub const LEFT: Selection = Selection::Robot(RobotId(1));

/// Distances between the axes of the bases, m. The arm reaches 0.67 m from its shoulder: from "almost always entangled" to
/// "hardly within reach".
pub const DISTANCES_M: [f64; 5] = [0.4, 0.6, 0.8, 1.0, 1.2];

/// Loads the model that `cargo xtask models` writes.
pub fn arm(root: &Path) -> Result<Robot, String> {
    let folder = root.join("examples/models/rx60b");
    let options = LoadOptions { srdf: Some(folder.join("rx60b.srdf")), ..LoadOptions::default() };
    robot::load(&folder.join("rx60b.urdf"), &options).map(|loaded| loaded.robot).map_err(|e| e.to_string())
}

/// Builds the scene: the second arm is beside the first, to its left.
pub fn scene(arm: &Robot, distance_m: f64) -> Result<Scene, String> {
    let mut builder = Scene::builder();
    builder.robot("right", arm.clone(), Pose::IDENTITY);
    builder.robot("left", arm.clone(), Pose::from_translation(Vec3::Y * distance_m));
    builder.build().map_err(|e| e.to_string())
}

/// Number of triangles of one arm.
pub fn triangles(arm: &Robot) -> usize {
    let colliders = arm.colliders.iter().flatten();
    colliders.map(|collider| if let Shape::Mesh(mesh) = &collider.shape { mesh.triangles().len() } else { 0 }).sum()
}

/// Joint values of both arms, within their limits, one row of 12 per state.
pub fn states(arm: &Robot, count: usize) -> Vec<Vec<f64>> {
    let chain = &arm.chain;
    let limits: Vec<_> = chain.active_joints().iter().map(|j| chain.joints()[j.0].limits).collect();
    let sequence = Sequence::new(2 * limits.len());
    let scaled = |n| sequence.point(n).zip(limits.iter().cycle()).map(|(x, l)| l.lower + x * (l.upper - l.lower));
    (0..count).map(|n| scaled(n).collect()).collect()
}

/// Moves both arms.
pub fn put(scene: &Scene, state: &mut SceneState, q: &[f64]) -> Result<(), String> {
    let (right, left) = q.split_at(q.len() / 2);
    state.set_q(scene, RobotId(0), right).and_then(|()| state.set_q(scene, RobotId(1), left)).map_err(|e| e.to_string())
}

/// Numbers of pairs between the arms: (all that a joint moves, those that the allowed collision matrix proves out of
/// reach).
pub fn pairs(scene: &Scene) -> (usize, usize) {
    let state = SceneState::new(scene);
    let all = Checker::new(scene, CheckerOptions::default()).between(RIGHT, LEFT).len(&state);
    let between = scene.allowed_collision_matrix().entries().iter().filter(|e| match (e.a, e.b) {
        (elbowroom_robot::GeometryId::Link { robot: a, .. }, elbowroom_robot::GeometryId::Link { robot: b, .. }) => {
            a != b
        }
        _ => false,
    });
    let proven =
        |state: PairState, reason: &Reason| state == PairState::Skipped && matches!(reason, Reason::OutOfReach { .. });
    (all, between.filter(|e| proven(e.state, &e.reason)).count())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_keep_the_limits_and_the_arm_has_the_triangles_of_the_paper() {
        let arm = arm(&crate::workspace_root().unwrap()).unwrap();
        assert_eq!(triangles(&arm), 23_012);
        let chain = &arm.chain;
        for q in states(&arm, 500) {
            assert_eq!(q.len(), 12);
            for (value, joint) in q.iter().zip(chain.active_joints().iter().cycle()) {
                let limits = chain.joints()[joint.0].limits;
                assert!((limits.lower..=limits.upper).contains(value));
            }
        }
    }

    #[test]
    fn every_solid_is_closed_and_faces_outward() {
        let arm = arm(&crate::workspace_root().unwrap()).unwrap();
        for collider in arm.colliders.iter().flatten() {
            let Shape::Mesh(mesh) = &collider.shape else { panic!("{} is no mesh", collider.name) };
            let report = mesh.report();
            assert!(report.closed && !report.inside_out && report.volume > 0.0, "{}: {report:?}", collider.name);
            assert_eq!((report.degenerate, report.duplicate), (0, 0), "{}", collider.name);
        }
    }
}
