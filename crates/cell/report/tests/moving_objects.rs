//! Moving objects in the scene of the report.

use crate::page_data;
use elbowroom_cell::Cell;
use elbowroom_report::{ReportScene, write_html};
use elbowroom_sim::{RunOptions, simulate};

const CELL: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
tick_ms = 5
[robot.r]
base = { at = [0, 0, 0], rpy = [0, 90, 0] }
dh = [{ kind = "prismatic", min = -2000, max = 2000, speed = 1000, acceleration = 4000 }]
links = [{ sphere = { radius = 50 } }]
[object.ball]
shape = "sphere"
radius = 30
at = [500, -300, 0]
motion = { via = [[500, 300, 0]], speed = 200 }
[program.r]
steps = [{ wait = 5 }]
"#;

#[test]
fn the_report_has_the_poses_of_a_moving_object() {
    let cell = Cell::parse("test.toml", CELL).unwrap();
    let outcome = simulate(&cell, &RunOptions::default()).unwrap();
    let mut page = Vec::new();
    let scene = ReportScene::of_cell(&cell);
    write_html(&mut page, &scene, &[("run", &outcome.recording)]).unwrap();
    let data = page_data::block(&String::from_utf8(page).unwrap(), "scene-data");
    let frames = data["runs"][0]["frames"].as_u64().unwrap();
    let poses = &data["runs"][0]["objects"][0]["poses"];
    assert_eq!((poses["n"].as_u64(), poses["width"].as_u64()), (Some(7 * frames), Some(7)), "{poses}");
}
