//! Planning on covers if the scene changes what the models contain.

use elbowroom_planner::{CoverModel, CoverObstacles, CoverRrtConnect, RrtConnect, RrtConnectSettings};
use elbowroom_proximity::{Shape, Sphere};
use elbowroom_robot::{GeometryId, ObjectId, RobotId, example};
use elbowroom_scene::{Checker, CheckerOptions, Object, Scene, SceneState, SweepOptions};
use elbowroom_spatial::{Pose, Vec3};

const ROBOT: RobotId = RobotId(0);

#[test]
fn an_object_that_the_scene_enlarges_is_avoided_in_its_size() {
    let mut builder = Scene::builder();
    builder.robot("arm", example::arm().unwrap(), Pose::IDENTITY);
    let ball = Shape::Sphere(Sphere { radius: 0.03 });
    let in_world = Pose::from_translation(Vec3::new(0.6, 0.0, 0.3));
    let id = builder.object(Object { name: "ball".into(), shape: ball, in_world });
    assert_eq!(id, ObjectId(0));
    builder.scale(GeometryId::Object(id), 6.0);
    let scene = builder.build().unwrap();
    let mut start = SceneState::new(&scene);
    start.set_q(&scene, ROBOT, &[-1.2, 1.3, 0.3]).unwrap();
    let model = CoverModel::new(&scene, &start, ROBOT, 0.0).unwrap();
    let obstacles = CoverObstacles::new(&model, &scene, &start, 0.0);
    let mut planner = CoverRrtConnect::new(RrtConnect::new(&scene, ROBOT).unwrap(), &model, &obstacles);
    let path = planner.plan(&start, &[1.2, 1.3, 0.3], &RrtConnectSettings::default()).unwrap();
    let mut exact = Checker::new(&scene, CheckerOptions::default());
    let hit = exact.sweep_path(&start, ROBOT, &path.waypoints, &SweepOptions::default()).unwrap();
    assert!(hit.is_none(), "{hit:?}");
}
