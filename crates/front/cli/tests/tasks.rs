//! Tasks of users in their second hour, as typed commands on robots that the project does not include. Each test prints the
//! command and its output: `cargo test -p elbowroom-cli --test main tasks:: -- --nocapture`.

#![allow(clippy::print_stdout, reason = "shows what users type and see")]

use std::fmt::Write as _;
use std::path::Path;

use crate::common::{Answer, elbowroom, with_cell};
use elbowroom_testkit::folder;
use tempfile::TempDir;

/// Returns the robot of a folder of the data, as a path for a cell file.
fn urdf(data: &Path, name: &str) -> String {
    data.join("urdf").join(name).join(format!("{name}.urdf")).display().to_string()
}

/// Head of a cell file, in millimetres and degrees.
const HEAD: &str = "version = 1\nunits = { length = \"mm\", angle = \"deg\" }\n";

/// Runs a command; prints it with the end of its output.
#[track_caller]
fn type_command(dir: &TempDir, line: &str, status: i32) -> Answer {
    let args: Vec<&str> = line.split_whitespace().collect();
    let answer = elbowroom(dir.path(), &args);
    println!("$ elbowroom {line}");
    for line in answer.stdout.lines().take(14) {
        println!("{}", line.chars().take(160).collect::<String>());
    }
    for line in answer.stderr.lines().take(4) {
        println!("  | {}", line.chars().take(160).collect::<String>());
    }
    println!("exit {}\n", answer.status);
    answer.expect(status)
}

/// Returns the rows of a CSV after its header.
fn rows(csv: &str) -> Vec<Vec<String>> {
    csv.lines().skip(1).map(|row| row.split(',').map(str::to_owned).collect()).collect()
}

/// 1: guard an unseen arm with a gripper; 2: find out why it stopped; 3: check whether entry is excluded.
#[test]
fn guard_an_arm_with_a_gripper_and_find_out_why_it_stopped() {
    let Some(data) = folder::data() else { return };
    let model = urdf(&data, "panda");
    let cell = |law: &str| {
        format!(
            r#"{HEAD}[robot.arm]
model = "{model}"
srdf = "{}"
flange = "panda_hand"
start = "ready"
[region.operator]
shape = "box"
from = [450, 200, 0]
to = [800, 700, 1200]
kind = "forbidden"
warning = 200
{law}
[program.arm]
steps = [
  {{ move = "joint", to = [60, 20, 0, -90, 0, 110, 45, 20], speed = 30 }},
  {{ move = "joint", to = "ready", speed = 30 }},
]
"#,
            model.replace(".urdf", ".srdf"),
        )
    };
    let dir = with_cell(&cell(""));
    let summary = type_command(&dir, "run cell.toml", 0);
    assert!(
        summary.stdout.contains("before operator") && summary.stdout.contains("TCP on panda_hand"),
        "{}",
        summary.stdout
    );
    assert!(summary.stdout.contains("continues when the program moves away"), "{}", summary.stdout);
    let json = type_command(&dir, "run cell.toml --json", 0).json();
    let arm = &json["robots"][0];
    assert_eq!((arm["outcome"].as_str(), arm["by"].as_str()), (Some("stopped"), Some("operator")));
    assert!(arm["part"].as_str().unwrap().starts_with("panda_") && arm["point_m"].is_array());
    assert!(json["regions"][0]["min_distance_m"].as_f64().unwrap() > 0.0 && json["regions"][0]["entered"] == false);
    type_command(&dir, "check cell.toml", 0);
}

/// 4: distances between an arm and a belt for many states.
#[test]
fn distances_between_arm_and_belt() {
    let Some(data) = folder::data() else { return };
    let dir = with_cell(&format!(
        "{HEAD}[robot.arm]\nmodel = \"{}\"\n[object.belt]\nshape = \"box\"\nat = [1800, 0, 350]\nsize = [600, 4000, 700]\n",
        urdf(&data, "kuka_kr150r3100_2")
    ));
    let mut states = "joint_a1,joint_a2,joint_a3,joint_a4,joint_a5,joint_a6\n".to_owned();
    for i in 0..500 {
        let swing = f64::from(i) / 500.0;
        writeln!(states, "{},{},{},0,{swing},0", 3.0 * swing - 1.5, swing - 1.8, 1.0 - swing).unwrap();
    }
    std::fs::write(dir.path().join("states.csv"), states).unwrap();
    let answer = type_command(&dir, "query cell.toml --ask distance --between arm,belt --states states.csv", 0);
    let rows = rows(&answer.stdout);
    assert_eq!(rows.len(), 500);
    assert!(rows.iter().all(|r| r[3].starts_with("arm/") && r[4] == "belt"), "the arm's own wrist is not asked for");
}

/// 5: plan to a pose and play the path; 6: the same as a step of a program.
#[test]
fn plan_to_a_pose_and_play_it() {
    let Some(data) = folder::data() else { return };
    let cell = format!(
        r#"{HEAD}[robot.kr]
model = "{}"
states = {{ home = [60, -90, 90, 0, 90, 0] }}
start = "home"
[object.post]
shape = "box"
at = [950, 450, 500]
size = [60, 60, 1000]
[object.floor]
shape = "box"
at = [0, 0, -110]
size = [5000, 5000, 200]
"#,
        urdf(&data, "kuka_kr16_2")
    );
    let dir = with_cell(&cell);
    type_command(&dir, "plan cell.toml --to-pose 1000,-200,600,180,0,0 --out path.csv", 0);
    let played = dir.path().join("played.toml");
    std::fs::write(&played, format!("{cell}[program.kr]\ntrajectory = \"path.csv\"\n")).unwrap();
    let json = type_command(&dir, "run played.toml --json", 0).json();
    assert_eq!(json["robots"][0]["finished"], true);
    assert_eq!(json["robots"][0]["collisions"].as_array().unwrap().len(), 0);
    let steps = r#"steps = [
  { move = "planned", to = { at = [1000, -200, 600], rpy = [180, 0, 0] } },
  { move = "planned", to = "home" },
]
"#;
    std::fs::write(&played, format!("{cell}[program.kr]\n{steps}")).unwrap();
    let json = type_command(&dir, "run played.toml --json --out out", 0).json();
    assert_eq!(json["robots"][0]["outcome"], "finished");
    let trace = std::fs::read_to_string(dir.path().join("out/trace.csv")).unwrap();
    // t_s, robot, six joints, then the TCP.
    let near = |row: &[String]| {
        let at = |i: usize| row[8 + i].parse::<f64>().unwrap();
        (at(0) - 1.0).hypot(at(1) + 0.2).hypot(at(2) - 0.6) < 1e-4
    };
    assert!(rows(&trace).iter().any(|row| near(row)), "the TCP comes to the pose");
}

/// 7: pick, carry, place.
#[test]
fn pick_carry_place() {
    let Some(data) = folder::data() else { return };
    let dir = with_cell(&format!(
        r#"{HEAD}[robot.kr]
model = "{}"
start = [0, -90, 90, 0, 90, 0]
tool = {{ tcp = {{ at = [0, 0, 150] }}, box = {{ at = [0, 0, 75], size = [60, 60, 148] }} }}
[object.table]
shape = "box"
at = [1000, 0, 200]
size = [500, 800, 400]
[object.part]
shape = "box"
at = [1000, -200, 450.5]
size = [80, 80, 100]
[program.kr]
steps = [
  {{ move = "planned", to = {{ at = [1000, -200, 600], rpy = [180, 0, 0] }} }},
  {{ move = "linear", to = {{ at = [1000, -200, 501], rpy = [180, 0, 0] }}, speed = 200 }},
  {{ grip = "part" }},
  {{ move = "linear", to = {{ at = [1000, -200, 600], rpy = [180, 0, 0] }}, speed = 200 }},
  {{ move = "planned", to = {{ at = [1000, 200, 600], rpy = [180, 0, 0] }} }},
  {{ move = "linear", to = {{ at = [1000, 200, 501], rpy = [180, 0, 0] }}, speed = 200 }},
  {{ release = "part" }},
  {{ move = "linear", to = {{ at = [1000, 200, 700], rpy = [180, 0, 0] }}, speed = 200 }},
]
"#,
        urdf(&data, "kuka_kr16_2")
    ));
    let json = type_command(&dir, "run cell.toml --json --out out", 0).json();
    assert_eq!(json["robots"][0]["outcome"], "finished");
    let events = std::fs::read_to_string(dir.path().join("out/events.csv")).unwrap();
    let named: Vec<_> = rows(&events).iter().filter(|r| r[2] == "part").map(|r| r[3].clone()).collect();
    assert_eq!(named, ["grip", "release"]);
}

/// 8: replay the recording of a real controller, in degrees.
#[test]
fn replay_a_recording_in_degrees() {
    let Some(data) = folder::data() else { return };
    let recording = data.join("trajectories/staubli_tx40_real/pos_read_data.csv");
    let dir = tempfile::tempdir().unwrap();
    // The first 5 s, in the form that another program writes.
    let text = std::fs::read_to_string(recording).unwrap();
    let rows_of_5_s: Vec<String> = text.lines().take(1_250).map(|row| row.replace(',', ";")).collect();
    std::fs::write(dir.path().join("recorded.csv"), rows_of_5_s.join("\n")).unwrap();
    let cell = format!(
        r#"{HEAD}[robot.tx40]
model = "{}"
[region.column]
shape = "cylinder"
base = [450, 350, 0]
radius = 60
height = 900
warning = 100
[program.tx40]
trajectory = {{ file = "recorded.csv", angle = "deg", period_ms = 4 }}
"#,
        urdf(&data, "staubli_tx40")
    );
    std::fs::write(dir.path().join("cell.toml"), cell).unwrap();
    let json = type_command(&dir, "run cell.toml --json --out out", 0).json();
    let trace = std::fs::read_to_string(dir.path().join("out/trace.csv")).unwrap();
    let first: Vec<f64> = rows(&trace)[0][2..8].iter().map(|v| v.parse().unwrap()).collect();
    assert!((first[1] - 50.265_f64.to_radians()).abs() < 1e-9 && (first[2] + 70.685_f64.to_radians()).abs() < 1e-9);
    assert!(json["duration_s"].as_f64().unwrap() >= 4.9 || json["robots"][0]["finished"] == false);
}

/// 9: the allowed collision matrix of an unseen arm; 10: objects near the arm at the start.
#[test]
fn write_and_use_an_srdf() {
    let Some(data) = folder::data() else { return };
    let arm = urdf(&data, "fanuc_r1000ia80f");
    let dir = with_cell(&format!(
        "{HEAD}[robot.arm]\nmodel = \"{arm}\"\nsrdf = \"arm.srdf\"\n[object.rack]\nshape = \"box\"\nat = [1500, 0, 500]\nsize = [200, 800, 1000]\n"
    ));
    type_command(&dir, &format!("inspect {arm} --write-srdf arm.srdf"), 0);
    assert!(std::fs::read_to_string(dir.path().join("arm.srdf")).unwrap().contains("reason=\"Adjacent\""));
    let answer = type_command(&dir, "query cell.toml --ask distance --all-pairs 0.6 --no-self", 0);
    let distances: Vec<f64> = rows(&answer.stdout).iter().map(|r| r[2].parse().unwrap()).collect();
    assert!(!distances.is_empty() && distances.is_sorted() && distances.iter().all(|d| *d <= 0.6));
}

/// 11: plan between states of the model's SRDF.
#[test]
fn plan_between_named_states() {
    let Some(data) = folder::data() else { return };
    let arm = urdf(&data, "panda");
    let dir = with_cell(&format!(
        "{HEAD}[robot.arm]\nmodel = \"{arm}\"\nsrdf = \"{}\"\n[object.shelf]\nshape = \"box\"\nat = [500, 0, 200]\nsize = [200, 600, 20]\n",
        arm.replace(".urdf", ".srdf")
    ));
    let json = type_command(&dir, "plan cell.toml --from ready --to extended --json", 0).json();
    assert_eq!(json["found"], true);
}

/// 12: whether the robot stops in time; 13: what is missing.
#[test]
fn check_and_correct_a_warning_zone() {
    let Some(data) = folder::data() else { return };
    let cell = |warning: &str| {
        format!(
            "{HEAD}[robot.arm]\nmodel = \"{}\"\nstart = [90, -90, 90, 0, 0, 0]\nstop_time = 0.6\n[region.aisle]\nshape = \"box\"\nfrom = [2500, -3000, 0]\nto = [4000, 3000, 3000]\n\
             kind = \"forbidden\"\nwarning = {warning}\n\
             [program.arm]\nsteps = [{{ move = \"joint\", to = [0, -45, 45, 0, 0, 0] }}]\n",
            urdf(&data, "kuka_kr150r3100_2")
        )
    };
    let json = type_command(&with_cell(&cell("50")), "check cell.toml --json", 1).json();
    let needed = json["regions"][0]["needed_warning_m"].as_f64().unwrap();
    assert!(needed > 0.05 && json["regions"][0]["excluded"] == false);
    type_command(&with_cell(&cell("50")), "check cell.toml", 1);
    type_command(&with_cell(&cell(&format!("{}", (1e3 * needed).ceil()))), "check cell.toml", 0);
}

/// 14: two arms exchange a region.
#[test]
fn two_arms_exchange_a_region() {
    let Some(data) = folder::data() else { return };
    let dir = with_cell(&format!(
        r#"{HEAD}[robot.left]
model = "{}"
start = [60, -90, 90, 0, 30, 0]
stop_time = 0.3
[robot.right]
model = "{}"
base = {{ at = [3200, 0, 0], rpy = [0, 0, 180] }}
start = [60, 0, 0, 0, 30, 0]
stop_time = 0.3
[region.shared]
shape = "box"
from = [1100, -300, 300]
to = [1500, 300, 1500]
kind = "exchange"
warning = 200
[program.left]
steps = [
  {{ move = "joint", to = [0, -60, 80, 0, 30, 0], speed = 50 }},
  {{ move = "joint", to = [60, -90, 90, 0, 30, 0], speed = 50 }},
]
[program.right]
steps = [
  {{ move = "joint", to = [0, 40, 0, 0, 30, 0], speed = 30 }},
  {{ move = "joint", to = [60, 0, 0, 0, 30, 0], speed = 30 }},
]
"#,
        urdf(&data, "kuka_kr16_2"),
        urdf(&data, "abb_irb4400l_30_243")
    ));
    let json = type_command(&dir, "run cell.toml --json --out out", 0).json();
    assert!(json["robots"].as_array().unwrap().iter().all(|r| r["outcome"] == "finished"));
    let events = std::fs::read_to_string(dir.path().join("out/events.csv")).unwrap();
    let mut inside = Vec::new();
    for row in rows(&events) {
        match row[3].as_str() {
            "inside_in" => inside.push(row[1].clone()),
            "inside_out" => inside.retain(|robot| *robot != row[1]),
            _ => {}
        }
        assert!(inside.len() <= 1, "two robots inside at {} s", row[0]);
    }
    assert!(events.contains("right,shared,waiting") && events.contains("right,shared,granted"));
}

/// 15: a region from taught points.
#[test]
fn a_region_from_taught_points() {
    let Some(data) = folder::data() else { return };
    let dir = with_cell(&format!("{HEAD}[robot.arm]\nmodel = \"{}\"\n", urdf(&data, "ur5e")));
    let states = "shoulder_pan_joint,shoulder_lift_joint,elbow_joint,wrist_1_joint,wrist_2_joint,wrist_3_joint\n\
                  0.3,-1.2,1.4,-1.7,-1.5,0\n0.5,-1.2,1.4,-1.7,-1.5,0\n";
    std::fs::write(dir.path().join("taught.csv"), states).unwrap();
    let region =
        type_command(&dir, "teach cell.toml --shape sphere --name lamp --states taught.csv --warning 100", 0).stdout;
    let path = dir.path().join("cell.toml");
    std::fs::write(&path, std::fs::read_to_string(&path).unwrap() + &region).unwrap();
    // 16: the distance to a region.
    let answer = type_command(&dir, "query cell.toml --ask distance --between arm,lamp", 0);
    assert_eq!(rows(&answer.stdout)[0][4], "lamp");
}

/// 17: the tables of an unseen arm, and its poses.
#[test]
fn tables_and_poses_of_an_arm() {
    let Some(data) = folder::data() else { return };
    let arm = urdf(&data, "abb_irb6600_225_255");
    let dir = tempfile::tempdir().unwrap();
    let answer = type_command(&dir, &format!("inspect {arm} --dh modified --brief"), 0);
    assert!(answer.stdout.contains("Modified DH (Craig)"));
    let header = "joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n0,0,0,0,0,0\n";
    std::fs::write(dir.path().join("q.csv"), header).unwrap();
    let answer = type_command(&dir, &format!("inspect {arm} --states q.csv"), 0);
    assert!(rows(&answer.stdout).iter().any(|row| row[1] == "tool0"));
}

/// 18: the obstacles of a planning scene, around an unseen arm.
#[test]
fn a_planning_scene_around_an_arm() {
    let Some(data) = folder::data() else { return };
    let (arm, scene) =
        (urdf(&data, "panda"), data.join("problems/mbm_scene_configs/scenes/bookshelf/scene_small.yaml"));
    let cell = |frame: &str| {
        format!(
            "{HEAD}[robot.arm]\nmodel = \"{arm}\"\nsrdf = \"{}\"\nflange = \"panda_hand\"\nstart = \"ready\"\n\
             [scene.shelf]\nfile = \"{}\"\n{frame}",
            arm.replace(".urdf", ".srdf"),
            scene.display()
        )
    };
    let refused = type_command(&with_cell(&cell("")), "query cell.toml --ask distance", 2);
    assert!(refused.stderr.contains("frame = \"base_link\""), "{}", refused.stderr);
    let dir = with_cell(&cell("frame = \"base_link\"\n"));
    let answer = type_command(&dir, "query cell.toml --ask distance --no-self --all-pairs 1", 0);
    assert!(rows(&answer.stdout).iter().any(|row| row[4].starts_with("shelf") || row[4].starts_with("Can")));
    type_command(&dir, "plan cell.toml --to extended --json", 0);
}

/// 19: the joint-space map of an arm, as a page.
#[test]
fn the_map_of_an_arm_as_a_page() {
    let Some(data) = folder::data() else { return };
    let dir = with_cell(&format!(
        "{HEAD}[robot.kr]\nmodel = \"{}\"\nstart = [0, -90, 90, 0, 0, 0]\n\
         [object.post]\nshape = \"box\"\nat = [1800, 300, 700]\nsize = [300, 300, 1400]\n",
        urdf(&data, "kuka_kr150r3100_2")
    ));
    let slices = type_command(&dir, "map cell.toml --model slices --page map.html --json", 0).json();
    let exact = type_command(&dir, "map cell.toml --json", 0).json();
    let blocked = |map: &serde_json::Value| map["blocked"].as_u64().unwrap();
    assert!(blocked(&slices) >= blocked(&exact) && blocked(&exact) > 0);
    let page = std::fs::read_to_string(dir.path().join("map.html")).unwrap();
    assert!(page.contains("type=\"range\"") && page.len() < 1_000_000);
}

/// 20: two arms planned in one call.
#[test]
fn two_arms_planned_in_one_call() {
    let Some(data) = folder::data() else { return };
    let dir = with_cell(&format!(
        r#"{HEAD}[robot.left]
model = "{}"
states = {{ home = [60, -90, 90, 0, 30, 0], across = [-60, -60, 80, 0, 30, 0] }}
start = "home"
[robot.right]
model = "{}"
base = {{ at = [2200, 0, 0], rpy = [0, 0, 180] }}
states = {{ home = [60, -90, 90, 0, 30, 0], across = [-60, -60, 80, 0, 30, 0] }}
start = "home"
"#,
        urdf(&data, "kuka_kr16_2"),
        urdf(&data, "kuka_kr16_2")
    ));
    let line = "plan cell.toml --robot left --to across --robot right --to across --out both.csv --report plan.html";
    type_command(&dir, line, 0);
    let csv = std::fs::read_to_string(dir.path().join("both.csv")).unwrap();
    assert!(csv.starts_with("t_s,left.joint_a1,") && rows(&csv).len() > 100);
    assert!(dir.path().join("plan.html").is_file());
    // They touch in no row.
    let answer = type_command(&dir, "query cell.toml --ask collision --between left,right --states both.csv", 0);
    assert!(rows(&answer.stdout).iter().all(|row| row[1] == "0"));
}

/// 21: which triangles touch; 22: one file of pairs for all verbs.
#[test]
fn contacts_of_an_arm_and_a_file_of_pairs() {
    let Some(data) = folder::data() else { return };
    let cell = |pairs: &str| {
        format!(
            "{HEAD}{pairs}[robot.arm]\nmodel = \"{}\"\nstart = [0, 0, 0, 0, 0, 0]\n\
             [object.rack]\nshape = \"box\"\nat = [1000, 0, 1500]\nsize = [500, 400, 500]\n",
            urdf(&data, "fanuc_r1000ia80f")
        )
    };
    let dir = with_cell(&cell(""));
    let ask = "query cell.toml --ask collision --between arm,rack";
    let collides = type_command(&dir, ask, 1);
    assert_eq!(rows(&collides.stdout)[0][1], "1");
    let triangles = type_command(&dir, "query cell.toml --ask contacts --between arm,rack", 0);
    assert!(rows(&triangles.stdout).iter().all(|row| row[1].starts_with("arm/") && row[2] == "rack"));
    type_command(&dir, "query cell.toml --ask point --between arm,rack", 0);
    let arm = urdf(&data, "fanuc_r1000ia80f");
    type_command(&dir, &format!("inspect {arm} --pairs found.toml"), 0);
    let rule = "version = 1\npairs = [{ a = \"arm\", b = \"rack\", reason = \"a soft cover\" }]\n";
    std::fs::write(dir.path().join("pairs.toml"), rule).unwrap();
    std::fs::write(dir.path().join("cell.toml"), cell("pairs = \"pairs.toml\"\n")).unwrap();
    type_command(&dir, "run cell.toml", 0);
    type_command(&dir, ask, 0);
}

/// 23: a tool is exchanged; 24: a region counts what the hand holds.
#[test]
fn a_tool_change_and_a_part_that_a_region_counts() {
    let Some(data) = folder::data() else { return };
    let cell = |program: &str| {
        format!(
            r#"{HEAD}[robot.kr]
model = "{}"
start = [0, -90, 90, 0, 90, 0]
[robot.kr.tools.gripper]
tcp = {{ at = [0, 0, 150] }}
box = {{ at = [0, 0, 75], size = [60, 60, 148] }}
[robot.kr.tools.torch]
tcp = {{ at = [0, 0, 300] }}
box = {{ at = [0, 0, 150], size = [40, 40, 296] }}
mounted = false
[object.bar]
shape = "box"
at = [1000, 0, 500]
size = [60, 1200, 60]
[region.aisle]
shape = "box"
from = [-2000, 800, 0]
to = [2500, 900, 2500]
kind = "forbidden"
warning = 150
guards = ["tool"]
[program.kr]
steps = [
  {{ move = "joint", to = {{ at = [1000, 0, 531], rpy = [180, 0, 0] }} }},
  {program}
]
"#,
            urdf(&data, "kuka_kr16_2")
        )
    };
    // Moved to the side by 400 mm: the bar would be 200 mm inside, the hand is 400 mm away.
    let aside = "{ move = \"linear\", to = { at = [1000, 400, 700], rpy = [180, 0, 0] }, speed = 200 },";
    let empty = type_command(&with_cell(&cell(aside)), "run cell.toml --json", 0).json();
    assert_eq!(empty["robots"][0]["outcome"], "finished");
    let held = type_command(&with_cell(&cell(&format!("{{ grip = \"bar\" }},\n  {aside}"))), "run cell.toml --json", 0);
    let (robot, region) = (&held.json()["robots"][0], &held.json()["regions"][0]);
    assert_eq!((robot["outcome"].as_str(), robot["by"].as_str()), (Some("stopped"), Some("aisle")));
    assert_eq!((robot["part"].as_str(), robot["part_kind"].as_str()), (Some("bar"), Some("load")));
    assert_eq!(region["entered"], false);
    let exchange = "{ move = \"linear\", to = { at = [1000, 0, 700], rpy = [180, 0, 0] }, speed = 200 },\n  { tool = \"torch\" },\n  \
                    { move = \"linear\", to = { at = [1000, 0, 700], rpy = [180, 0, 0] }, speed = 200 },";
    let dir = with_cell(&cell(exchange));
    let json = type_command(&dir, "run cell.toml --json --out out", 0).json();
    assert_eq!(json["robots"][0]["outcome"], "finished");
    let trace = std::fs::read_to_string(dir.path().join("out/trace.csv")).unwrap();
    let last = rows(&trace).pop().unwrap();
    // The torch's tip is now at the former place of the gripper's: the arm has moved back by 150 mm.
    assert!((last[10].parse::<f64>().unwrap() - 0.7).abs() < 1e-4, "{last:?}");
}
