//! A clearance also holds for pairs that can never touch.

use elbowroom_planner::{CoverModel, CoverObstacles, CoverRrtConnect, RrtConnect, RrtConnectError, RrtConnectSettings};
use elbowroom_proximity::{Shape, Sphere};
use elbowroom_robot::{RobotId, example};
use elbowroom_scene::{Object, Reason, Scene, SceneState};
use elbowroom_spatial::{Pose, Vec3};

/// A ball 140 mm from the column, which turns about its own axis: contact is proven to be out of reach.
#[test]
fn pairs_out_of_reach_of_contact_keep_the_clearance() {
    let mut builder = Scene::builder();
    builder.prove_out_of_reach(true).robot("arm", example::arm().unwrap(), Pose::IDENTITY);
    let shape = Shape::Sphere(Sphere { radius: 0.03 });
    let in_world = Pose::from_translation(Vec3::new(0.23, 0.0, 0.1));
    builder.object(Object { name: "ball".into(), shape, in_world });
    let scene = builder.build().unwrap();
    let proofs: Vec<f64> = scene
        .allowed_collision_matrix()
        .entries()
        .iter()
        .filter_map(|e| if let Reason::OutOfReach { least_m } = e.reason { Some(least_m) } else { None })
        .collect();
    assert!(proofs.iter().any(|least_m| *least_m < 0.15), "the proof that is tested: {proofs:?}");
    let start = SceneState::new(&scene);
    let plan = |clearance_m: f64| {
        let model = CoverModel::new(&scene, &start, RobotId(0), clearance_m).unwrap();
        let obstacles = CoverObstacles::new(&model, &scene, &start, clearance_m);
        let exact = RrtConnect::new(&scene, RobotId(0)).unwrap();
        let settings = RrtConnectSettings { clearance_m, ..RrtConnectSettings::default() };
        CoverRrtConnect::new(exact, &model, &obstacles).plan(&start, &[1.0, 0.0, 0.0], &settings)
    };
    plan(0.0).unwrap();
    let error = plan(0.15).unwrap_err();
    assert!(matches!(&error, RrtConnectError::InCollision { b, .. } if b == "ball"), "{error}");
}
