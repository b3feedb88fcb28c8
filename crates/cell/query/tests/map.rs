//! Maps of cells.

use crate::common::parse;
use elbowroom_cspace::ObstacleModel;
use elbowroom_proximity::{Shape, Sphere};
use elbowroom_query::map::{MapQuery, MapRequest, map};
use elbowroom_robot::ObjectId;
use elbowroom_spatial::{Pose, Vec3};

fn ball(radius: f64, at: [f64; 3], motion: &str) -> String {
    format!("[object.ball]\nshape = \"sphere\"\nradius = {radius}\nat = {at:?}\n{motion}\n")
}

#[test]
fn only_fixed_objects_count_as_static_in_a_map() {
    let cell = |motion: &str| {
        parse(&format!(
            "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\n[robot.arm]\n\
             dh = [{{ a = 400, min = -170, max = 170, speed = 90 }}, {{ a = 300, min = -170, max = 170, speed = 90 }}]\n\
             links = [[], {{ capsule = {{ from = [-300, 0, 0], to = [0, 0, 0], radius = 40 }} }}]\n\
             [object.post]\nshape = \"sphere\"\nat = [600, 0, 0]\nradius = 100\n{}",
            ball(100.0, [-500.0, 200.0, 0.0], motion)
        ))
    };
    let stationary = map(&cell(""), &MapRequest::default()).unwrap();
    let moving = map(&cell("motion = { via = [[0, 900, 0]], speed = 100 }"), &MapRequest::default()).unwrap();
    assert_eq!((stationary.blocked, stationary.static_blocked), (moving.blocked, stationary.blocked));
    assert_eq!(moving.static_blocked, moving.obstacles[0].blocks.blocked());
    assert!(moving.static_blocked < moving.blocked && moving.warnings.iter().any(|w| w.to_string().contains("ball")));
}

#[test]
fn an_object_that_moves_blocks_the_cells_of_its_new_place() {
    // A map of two joints on solids, and one of three joints on sphere covers.
    let two = "[map.arm]\njoints = [\"joint_1\", \"joint_2\"]\nstep = 5\n";
    for (joints, of_map) in [(2, two), (3, "[map.arm]\nstep = 10\n")] {
        let row = "{ a = 400, min = -170, max = 170, speed = 90 }";
        let link = "{ capsule = { from = [-400, 0, 0], to = [0, 0, 0], radius = 40 } }";
        let cell = |at: [f64; 3]| {
            let (dh, links) = (vec![row; joints].join(", "), vec![link; joints].join(", "));
            let head = "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\n";
            parse(&format!("{head}[robot.arm]\ndh = [{dh}]\nlinks = [{links}]\n{}{of_map}", ball(100.0, at, "")))
        };
        let first = cell([600.0, 0.0, 0.0]);
        let query = MapQuery::new(&first, &MapRequest::default(), &|_| ()).unwrap();
        let mut counts = Vec::new();
        for at in [[0.0, 550.0, 50.0], [-300.0, 300.0, 0.0], [600.0, 0.0, 0.0], [9000.0, 0.0, 0.0]] {
            let alone = map(&cell(at), &MapRequest::default()).unwrap();
            let in_world = Pose::from_translation(Vec3::from(at.map(|v| v * 1e-3)));
            let moved = query.cells_of(ObjectId(0), &in_world, ObstacleModel::Exact).unwrap();
            assert_eq!(query.union([&moved]), alone.dense, "{joints} joints, {at:?}");
            let solid = (Shape::Sphere(Sphere { radius: 0.1 }), in_world);
            let seen = query.cells_of_solids(&[solid], ObstacleModel::Exact).unwrap();
            assert_eq!(query.union([&seen]), alone.dense, "{joints} joints, a solid at {at:?}");
            counts.push(moved.blocked());
        }
        assert!(counts[..3].iter().all(|count| *count > 0) && counts[3] == 0, "{counts:?}");
        let nowhere = Pose::from_translation(Vec3::new(f64::NAN, 0.0, 0.0));
        assert!(query.cells_of(ObjectId(0), &nowhere, ObstacleModel::Exact).is_err());
    }
}
