//! Shields of virtual fixtures in the scene of the report.

use crate::page_data;
use elbowroom_cell::Cell;
use elbowroom_kinematics::ChainState;
use elbowroom_report::{ReportScene, write_html};
use elbowroom_sim::{RunOptions, simulate};
use elbowroom_spatial::Vec3;

#[test]
fn the_report_has_a_shield_and_when_it_is_switched() {
    let examples = elbowroom_testkit::folder::examples();
    let read = |name: &str| std::fs::read_to_string(examples.join("guided").join(name)).unwrap();
    let folder = std::env::temp_dir().join(format!("elbowroom-shields-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let text = read("cell.toml").replace("../models", &examples.join("models").display().to_string());
    std::fs::write(folder.join("cell.toml"), text.replace("tolerance = 4", "tolerance = 8")).unwrap();
    let row =
        |(k, line): (usize, &str)| format!("{line},{}\n", if k == 0 { "fixture.pocket" } else { ["1", "0"][k / 6] });
    let stream: String = read("hand.csv").lines().take(12).enumerate().map(row).collect();
    std::fs::write(folder.join("hand.csv"), stream).unwrap();
    let cell = Cell::load(folder.join("cell.toml")).unwrap();
    let outcome = simulate(&cell, &RunOptions::default()).unwrap();
    let mut page = Vec::new();
    write_html(&mut page, &ReportScene::of_cell(&cell), &[("run", &outcome.recording)]).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    let data = page_data::block(&String::from_utf8(page).unwrap(), "scene-data");
    let shield = &data["shields"][0];
    assert_eq!((&shield["name"], &shield["active"]), (&"pocket".into(), &true.into()));
    let triangles = data["meshes"][shield["mesh"].as_u64().unwrap() as usize]["i"]["n"].as_u64().unwrap() / 3;
    assert!((1_000..100_000).contains(&triangles), "{triangles}");
    assert_eq!(data["runs"][0]["shields"], serde_json::json!([[[0.25, false]]]));
}

#[test]
fn the_report_has_the_point_of_entry_and_the_shaft_through_it() {
    let examples = elbowroom_testkit::folder::examples();
    let mut text = std::fs::read_to_string(examples.join("guided/cell.toml")).unwrap();
    text += "[fixture.port]\nguide = \"entry\"\ntool = \"ns16\"\nat = [924, 0, 1325]\n";
    let cell = Cell::parse(examples.join("guided/cell.toml"), &text).unwrap();
    let scene = ReportScene::of_cell(&cell);
    let port = scene.shields.iter().find(|shield| shield.name == "port").unwrap();
    let at = Vec3::new(0.924, 0.0, 1.325);
    assert!(port.active && port.in_world.translation.distance(at) < 1e-12);
    assert!(port.vertices.iter().all(|v| (v.length() - 4e-3).abs() < 1e-4), "a ball of 4 mm");
    // The line begins at the tip, 100 mm before the flange, and passes the point.
    let robot = &cell.robots[0];
    let line = scene.robots[0].link_meshes[robot.flange.0].last().unwrap();
    let mut state = ChainState::new(&robot.robot.chain);
    state.q.copy_from_slice(&robot.start);
    robot.robot.chain.forward(&mut state);
    let in_world = robot.base_in_world * state.link_in_root(robot.flange) * line.in_link;
    let points: Vec<Vec3> = line.vertices.iter().map(|v| in_world.transform_point(*v)).collect();
    let heights = points.iter().map(|p| p.z);
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), z| (l.min(z), h.max(z)));
    assert!((low - 1.265).abs() < 1e-6 && (high - 1.665).abs() < 1e-6, "{low} to {high}");
    assert!(points.iter().all(|p| (p.x - at.x).hypot(p.y - at.y) < 1e-3), "{points:?}");
}
