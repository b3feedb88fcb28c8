//! The examples `crate` and `joint_map`: a camera's pictures, a map, and paths planned on it, as a newcomer types them.

#![allow(clippy::print_stdout, reason = "figures of the evidence")]

use std::path::Path;

use crate::common::elbowroom;
use crate::perceived_run::clearance;
use elbowroom::formats::robot::{LoadOptions, load};
use elbowroom::kinematics::ChainState;
use elbowroom::robot::Robot;
use elbowroom::spatial::Vec3;
use elbowroom::vision::Point2;

/// Where the crate really is, by the table that nothing but this test reads.
struct Truth(Vec<[f64; 3]>);

impl Truth {
    fn read(folder: &Path) -> Self {
        let table = std::fs::read_to_string(folder.join("truth.csv")).unwrap();
        let row = |line: &str| {
            let mut cells = line.split(',').map(|cell| cell.parse().unwrap());
            std::array::from_fn(|_| cells.next().unwrap())
        };
        Self(table.lines().skip(1).map(row).collect())
    }

    fn at(&self, t_s: f64) -> Point2 {
        let next = self.0.iter().position(|row| row[0] > t_s).unwrap_or(self.0.len() - 1).max(1);
        let ([t0, x0, y0], [t1, x1, y1]) = (self.0[next - 1], self.0[next]);
        let share = ((t_s - t0) / (t1 - t0)).clamp(0.0, 1.0);
        Point2::new(x0 + share * (x1 - x0), y0 + share * (y1 - y0))
    }
}

/// Runs a cell of the folder `mine/crate`; returns its results, and the least distance of the arm from the crate, m.
fn run(dir: &Path, cell: &str, robot: &Robot) -> (serde_json::Value, f64) {
    let truth = Truth::read(&dir.join("mine/crate"));
    let answer = elbowroom(dir, &["run", &format!("mine/crate/{cell}"), "--out", "out", "--json"]).expect(0).json();
    let trace = std::fs::read_to_string(dir.join("out/trace.csv")).unwrap();
    let (least_m, at_s) = clearance(&trace, robot, |t_s| truth.at(t_s));
    println!("{cell}: least distance to the true crate {:.0} mm at {at_s:.2} s", least_m * 1e3);
    (answer, least_m)
}

#[test]
fn the_arm_plans_again_around_a_crate_that_no_file_names() {
    let dir = tempfile::tempdir().unwrap();
    elbowroom(dir.path(), &["example", "mine"]).expect(0);
    let robot = load(&dir.path().join("mine/models/kr125/kr125.urdf"), &LoadOptions::default()).unwrap().robot;
    let (answer, least_m) = run(dir.path(), "cell.toml", &robot);
    let perception = &answer["robots"][0]["perception"];
    println!("{perception}");
    assert!(answer["robots"][0]["finished"] == true && least_m > 0.05, "{least_m}");
    assert!(
        perception["replans_in_motion"].as_u64() >= Some(3) && perception["replans_from_rest"] == 0,
        "{perception}"
    );
    assert_eq!(perception["waited_s"], 0.0);
    // Without the camera it hits the crate.
    let cell = std::fs::read_to_string(dir.path().join("mine/crate/cell.toml")).unwrap();
    let (camera, map) = (cell.find("[camera.above]").unwrap(), cell.find("[map.kr125]").unwrap());
    std::fs::write(dir.path().join("mine/crate/blind.toml"), format!("{}{}", &cell[..camera], &cell[map..])).unwrap();
    assert!(run(dir.path(), "blind.toml", &robot).1 <= 0.0);
}

/// Largest angle of the tool's axis from its direction at the start of a run, degrees.
fn largest_tilt_deg(dir: &Path, robot: &Robot) -> f64 {
    let trace = std::fs::read_to_string(dir.join("out/trace.csv")).unwrap();
    let mut state = ChainState::new(&robot.chain);
    let mut axis = |row: &str| {
        let q: Vec<f64> = row.split(',').skip(2).take(6).map(|cell| cell.parse().unwrap()).collect();
        state.q.copy_from_slice(&q);
        robot.chain.forward(&mut state);
        state.link_in_root(robot.chain.tip()).rotation.z_axis()
    };
    let axes: Vec<Vec3> = trace.lines().skip(1).map(&mut axis).collect();
    axes.iter().map(|a| a.dot(axes[0]).clamp(-1.0, 1.0).acos().to_degrees()).fold(0.0, f64::max)
}

#[test]
fn new_paths_keep_the_axis_that_the_move_keeps() {
    let dir = tempfile::tempdir().unwrap();
    elbowroom(dir.path(), &["example", "mine"]).expect(0);
    let robot = load(&dir.path().join("mine/models/kr125/kr125.urdf"), &LoadOptions::default()).unwrap().robot;
    let cell = std::fs::read_to_string(dir.path().join("mine/crate/cell.toml")).unwrap();
    for (name, keep) in [("free.toml", ""), ("kept.toml", ", keep = { axis = \"z\", within = 10 }")] {
        // At this speed the arm is out of the way each time that the crate comes back.
        let text = cell.replace(", planner = \"grid\"", keep).replace("speed = 30", "speed = 34");
        std::fs::write(dir.path().join("mine/crate").join(name), text).unwrap();
    }
    let replans = |answer: &serde_json::Value| answer["robots"][0]["perception"]["replans_in_motion"].as_u64();
    let (answer, least_m) = run(dir.path(), "kept.toml", &robot);
    let tilt_deg = largest_tilt_deg(dir.path(), &robot);
    println!("largest tilt {tilt_deg:.2}°");
    let perception = &answer["robots"][0]["perception"];
    // Searches take as long as the machine lets them. If one is late, the arm stands, and the crate drives up to it.
    let stood = perception["holds"].as_array().unwrap().iter().any(|hold| hold["reason"] == "obstacle");
    assert!(replans(&answer) > Some(0) && (least_m > 0.02 || stood), "{perception}: {least_m}");
    assert!(tilt_deg <= 10.0 + 1e-6, "{tilt_deg}");
    let (answer, _) = run(dir.path(), "free.toml", &robot);
    assert!(replans(&answer) > Some(0) && largest_tilt_deg(dir.path(), &robot) > 10.0);
}

#[test]
fn the_commands_of_the_joint_map_example_work() {
    let dir = tempfile::tempdir().unwrap();
    elbowroom(dir.path(), &["example", "mine"]).expect(0);
    let folder = dir.path().join("mine/joint_map");
    let cell = std::fs::read_to_string(folder.join("cell.toml")).unwrap();
    let typed = |line: &str| elbowroom(&folder, &line.split_whitespace().collect::<Vec<_>>()).expect(0).stdout;
    let mut blocked = Vec::new();
    for line in cell.lines().filter_map(|line| line.strip_prefix("#   elbowroom ")) {
        let line = line.split_once("   (").map_or(line, |(command, _)| command);
        println!("$ elbowroom {line}\n{}", typed(line));
    }
    for model in ["exact", "box", "spheres=2", "sphere", "slices"] {
        let line = format!("map cell.toml --model {model} --json");
        let map = elbowroom(&folder, &line.split_whitespace().collect::<Vec<_>>()).expect(0).json();
        blocked.push(map["blocked"].as_u64().unwrap());
    }
    // The order of the paper's table, for an upright cube: the box is the cube itself.
    assert!(
        blocked[0] == blocked[1] && blocked.windows(2).all(|w| w[0] <= w[1]) && blocked[3] < blocked[4],
        "{blocked:?}"
    );
    let page = std::fs::read_to_string(folder.join("map.html")).unwrap();
    assert!(page.contains(r#""name":"link_3""#));
    assert!(typed("run cell.toml").contains("finished at"));
}

/// A slower program goes over to new paths in motion, too, whatever the tick: at the rate that it has.
#[test]
fn a_program_below_full_override_is_planned_again_in_motion() {
    let dir = tempfile::tempdir().unwrap();
    elbowroom(dir.path(), &["example", "mine"]).expect(0);
    let cell = std::fs::read_to_string(dir.path().join("mine/crate/cell.toml")).unwrap();
    for (percent, tick_ms) in [(70, 8), (50, 8), (30, 2)] {
        let text = cell.replace("[program.kr125]\n", &format!("[program.kr125]\noverride = {percent}\n"));
        let text = text.replace("tick_ms = 8", &format!("tick_ms = {tick_ms}"));
        assert!(text.contains(&format!("override = {percent}")) && text.contains(&format!("tick_ms = {tick_ms}")));
        std::fs::write(dir.path().join("mine/crate/slow.toml"), text).unwrap();
        // Beside it the pictures end before the program; and the crate may drive into an arm that is late, so the
        // distance is not judged.
        let answer = elbowroom(dir.path(), &["run", "mine/crate/slow.toml", "--json"]).expect(0).json();
        let perception = &answer["robots"][0]["perception"];
        println!("override {percent} %, tick {tick_ms} ms: {perception}");
        assert!(perception["replans_in_motion"].as_u64() > Some(1), "{perception}");
        assert_eq!(perception["replans_from_rest"], 0, "{perception}");
    }
}
