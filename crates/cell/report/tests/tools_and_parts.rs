//! Held parts and tools of a robot in the data of the page.

use crate::page_data;
use elbowroom_cell::Cell;
use elbowroom_report::{ReportScene, write_html};
use elbowroom_sim::{RunOptions, simulate};
use serde_json::json;

const CELL: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
tick_ms = 5
[robot.r]
dh = [{ a = 500, min = -170, max = 170, speed = 90 }]
links = [{ capsule = { from = [-500, 0, 0], to = [0, 0, 0], radius = 30 } }]
[robot.r.tools.hand]
tcp = { at = [60, 0, 0] }
box = { at = [45, 0, 0], size = [30, 30, 30] }
[robot.r.tools.lance]
tcp = { at = [300, 0, 0] }
box = { at = [165, 0, 0], size = [270, 20, 20] }
mounted = false
[object.part]
shape = "box"
at = [610, 0, 0]
size = [80, 60, 60]
[program.r]
steps = [
  { wait = 0.2 },
  { grip = "part" },
  { move = "joint", to = [90] },
  { release = "part" },
  { move = "joint", to = [0] },
  { tool = "lance" },
  { wait = 0.2 },
]
"#;

#[test]
fn the_page_knows_what_is_held_and_which_tool_is_mounted_when() {
    let cell = Cell::parse("test.toml", CELL).unwrap();
    let outcome = simulate(&cell, &RunOptions::default()).unwrap();
    assert!(!outcome.has_violation());
    let mut page = Vec::new();
    write_html(&mut page, &ReportScene::of_cell(&cell), &[("run", &outcome.recording)]).unwrap();
    let data = page_data::block(&String::from_utf8(page).unwrap(), "scene-data");
    let (robot, run) = (&data["robots"][0], &data["runs"][0]);
    let [hand, lance] = [0, 1].map(|i| cell.robots[0].payload.tools[i].link.0);

    let held = run["objects"][0]["held"].as_array().unwrap();
    assert_eq!((held.len(), &held[0][0]), (1, &json!(0)));
    assert!((held[0][1].as_f64().unwrap() - 0.2).abs() < 0.02 && held[0][2].as_f64() > held[0][1].as_f64());
    assert_eq!((&robot["gripped"][0]["object"], &robot["gripped"][0]["volume"]["link"]), (&json!(0), &json!(hand)));

    let track = &run["robots"][0];
    let absent = track["absent"].as_array().unwrap();
    assert_eq!((absent.len(), &absent[0]), (2, &json!([0.0, [lance]])));
    assert_eq!(absent[1][1], json!([hand]));
    let tcps = track["tcps"].as_array().unwrap();
    assert_eq!((tcps.len(), &tcps[0][1], &tcps[1][1]), (2, &json!(hand), &json!(lance)));
    assert_eq!(tcps[1][0], absent[1][0]);
    let of_tools = robot["volumes"].as_array().unwrap().iter().filter(|v| v["exchanged"] == json!(true));
    assert_eq!(of_tools.count(), 4, "two solids and two tool centre points");
}
