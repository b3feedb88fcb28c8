//! What a robot carries, and its tools, in the scene of the report.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use elbowroom_cell::Cell;
use elbowroom_report::{ReportScene, write_html};
use elbowroom_sim::{RunOptions, simulate};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use serde_json::Value;

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

fn data() -> Value {
    let cell = Cell::parse("test.toml", CELL).unwrap();
    let outcome = simulate(&cell, &RunOptions::default()).unwrap();
    assert!(!outcome.has_violation());
    let mut page = Vec::new();
    write_html(&mut page, &ReportScene::of_cell(&cell), &[("run", &outcome.recording)]).unwrap();
    let page = String::from_utf8(page).unwrap();
    let data = page.split("id=\"scene-data\"").nth(1).unwrap();
    serde_json::from_str(&data[data.find('{').unwrap()..data.find("</script>").unwrap()]).unwrap()
}

fn floats(v: &Value) -> Vec<f64> {
    let bytes = STANDARD.decode(v.as_str().unwrap()).unwrap();
    bytes.chunks_exact(4).map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))).collect()
}

/// The poses of one of `count` things, one per frame.
fn poses(values: &[f64], count: usize, index: usize) -> Vec<Pose> {
    let pose = |v: &[f64]| {
        Pose::new(Rotation::from_quaternion_xyzw([v[0], v[1], v[2], v[3]]).unwrap(), Vec3::new(v[4], v[5], v[6]))
    };
    values.chunks_exact(7).skip(index).step_by(count).map(pose).collect()
}

#[test]
fn a_part_moves_with_the_tool_and_stays_where_it_is_released() {
    let data = data();
    let run = &data["runs"][0];
    let links = data["robots"][0]["links"].as_array().unwrap().len();
    let hand = poses(&floats(&run["robots"][0]["poses"]), links, links - 1);
    let part = poses(&floats(&run["objects"][0]), 1, 0);
    assert_eq!(hand.len(), part.len());
    let from_hand = |i: usize| hand[i].inverse_mul(&part[i]).translation;
    let (mut carried, mut left) = (0, 0);
    for i in 0..part.len() {
        let is_at =
            |angle: f64| part[i].translation.distance(Vec3::new(0.61 * angle.cos(), 0.61 * angle.sin(), 0.0)) < 1e-5;
        if is_at(0.0) || is_at(std::f64::consts::FRAC_PI_2) {
            left += usize::from(is_at(std::f64::consts::FRAC_PI_2));
            continue;
        }
        assert!(from_hand(i).distance(Vec3::X * 0.11) < 1e-5, "frame {i}: {:?}", from_hand(i));
        carried += 1;
    }
    assert!(carried > 50 && left > 50, "carried in {carried} frames, left in {left}");
}

#[test]
fn the_page_knows_which_tool_is_mounted_when() {
    let data = data();
    let links = data["robots"][0]["links"].as_array().unwrap().len();
    let absent = data["runs"][0]["robots"][0]["absent"].as_array().unwrap();
    // The tools are the last links.
    assert_eq!(absent[0], serde_json::json!([0.0, [links - 1]]));
    assert_eq!((absent.len(), &absent[1][1]), (2, &serde_json::json!([links - 2])));
    assert!(absent[1][0].as_f64().unwrap() > 2.0);
}
