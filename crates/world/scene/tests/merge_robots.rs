//! Merged robots: the answers of a scene do not change if some of its robots are merged into one.

use elbowroom_kinematics::LinkId;
use elbowroom_proximity::{Cuboid, Shape, Sphere};
use elbowroom_robot::{GeometryId, ObjectId, RobotId, example};
use elbowroom_scene::{
    Attachment, Checker, CheckerOptions, MergedRobots, Object, PairEdit, Scene, SceneError, SceneState,
};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::random::SplitMix;

/// Three arms around a table. The second holds the part, the ball is scaled, one pair is skipped and one has a margin.
fn scene() -> Scene {
    let mut builder = Scene::builder();
    for (i, name) in ["left", "right", "behind"].into_iter().enumerate() {
        let base = Pose::from_xyz_rpy([0.5 * i as f64 - 0.5, 0.3 * (i % 2) as f64, 0.0], [0.0, 0.0, 0.4 * i as f64]);
        builder.robot(name, example::arm().unwrap(), base);
    }
    let boxed = |half: f64| Shape::Cuboid(Cuboid { half_extents: Vec3::splat(half) });
    let at = |x, y, z| Pose::from_translation(Vec3::new(x, y, z));
    builder.object(Object { name: "table".into(), shape: boxed(0.15), in_world: at(0.3, 0.6, 0.1) });
    builder.object(Object { name: "part".into(), shape: boxed(0.05), in_world: at(2.0, 0.0, 0.0) });
    let ball = builder.object(Object {
        name: "ball".into(),
        shape: Shape::Sphere(Sphere { radius: 0.05 }),
        in_world: at(-0.2, 0.7, 0.6),
    });
    builder.scale(GeometryId::Object(ball), 2.0);
    builder.padding(GeometryId::Object(ball), 0.01);
    let link = |robot, link| GeometryId::Link { robot: RobotId(robot), link: LinkId(link) };
    builder.edit(link(0, 3), link(1, 3), PairEdit::Margin(0.03));
    builder.edit(link(0, 2), link(2, 3), PairEdit::Skip("a test".into()));
    builder.build().unwrap()
}

fn state(scene: &Scene, random: &mut SplitMix) -> SceneState {
    let mut state = SceneState::new(scene);
    for robot in 0..3 {
        let q = [random.between(-3.0, 3.0), random.between(-2.2, 2.2), random.between(-2.5, 2.5)];
        state.set_q(scene, RobotId(robot), &q).unwrap();
    }
    let in_link = Pose::from_translation(Vec3::Z * 0.42);
    let held = Attachment {
        robot: RobotId(1),
        link: LinkId(3),
        in_link,
        touch_links: vec![LinkId(3)],
        visiting_links: vec![],
    };
    state.attach_at(scene, ObjectId(1), held).unwrap();
    let moved = Vec3::new(random.between(-0.5, 0.5), random.between(0.0, 0.9), random.between(0.2, 1.0));
    state.place(scene, ObjectId(2), Pose::from_translation(moved)).unwrap();
    state
}

#[test]
fn contacts_and_distances_stay_as_they_were() {
    let scene = scene();
    let mut random = SplitMix(4);
    for group in [&[RobotId(0), RobotId(1)][..], &[RobotId(2), RobotId(1)], &[RobotId(0), RobotId(1), RobotId(2)]] {
        let merged = MergedRobots::new(&scene, group).unwrap();
        assert_eq!(merged.scene().robots().len(), 4 - group.len());
        let mut before = Checker::new(&scene, CheckerOptions::default());
        let mut after = Checker::new(merged.scene(), CheckerOptions::default());
        let (mut hits, mut free) = (0, 0);
        for _ in 0..300 {
            let state = state(&scene, &mut random);
            let same = merged.state(&scene, &state).unwrap();
            for (robot, q) in group.iter().zip(merged.split(same.q(merged.robot()))) {
                assert_eq!(q, state.q(*robot));
            }
            let ids = scene.geometries().map(|id| (id, merged.geometry(id)));
            for (id, merged_id) in ids {
                let (a, b) = (state.pose(&scene, id).unwrap(), same.pose(merged.scene(), merged_id).unwrap());
                // The frame of a scaled ball is its centre.
                assert!((a.translation - b.translation).length() < 1e-12, "{id:?}");
            }
            let collides = [before.collides(&state).is_some(), after.collides(&same).is_some()];
            assert_eq!(collides[0], collides[1]);
            hits += usize::from(collides[0]);
            free += usize::from(!collides[0]);
            if !collides[0] {
                let distances = [before.distance(&state), after.distance(&same)].map(|d| d.unwrap().metres);
                assert!((distances[0] - distances[1]).abs() < 1e-9, "{distances:?}");
            }
        }
        assert!(hits > 50 && free > 20, "{hits} hits, {free} free");
    }
}

#[test]
fn unknown_robots_and_robots_named_twice_are_errors() {
    let scene = scene();
    let error = MergedRobots::new(&scene, &[RobotId(0), RobotId(7)]).unwrap_err();
    assert!(matches!(error, SceneError::NoSuchRobot { index: 7, count: 3 }), "{error}");
    let error = MergedRobots::new(&scene, &[RobotId(1), RobotId(1)]).unwrap_err();
    assert!(error.to_string().contains("name each robot once"), "{error}");
}
