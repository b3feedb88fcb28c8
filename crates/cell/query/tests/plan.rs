//! Paths in cells: obstacles, and the parts that belong to the robot.

use std::time::Duration;

use crate::common::{ARM, HEAD, parse, rail};
use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel};
use elbowroom_kinematics::ChainState;
use elbowroom_planner::RrtConnectSettings;
use elbowroom_query::QueryStates;
use elbowroom_query::plan::{PathAnswer, PathGoal, PathRequest, plan, write_csv};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, Level, SceneState};
use elbowroom_spatial::Vec3;
use elbowroom_testkit::folder;

fn request(robot: &str, from: &[f64], to: &[f64]) -> PathRequest {
    let options = RrtConnectSettings { time_limit: Duration::from_secs(2), ..RrtConnectSettings::default() };
    PathRequest { robot: Some(robot.into()), from: Some(from.into()), to: to.into(), options, ..PathRequest::default() }
}

/// Checks every row and some points in between by exact geometry, and the speeds between rows.
fn check(cell: &Cell, answer: &PathAnswer, request: &PathRequest) {
    let robot = cell.robots.iter().position(|r| Some(&r.name) == request.robot.as_ref()).unwrap();
    let scene = QueryModel::of_cell(cell).scene(OutOfReachProofs::Omit).unwrap();
    let options = CheckerOptions { level: Level::L3, weights: false, matrix: false, ..CheckerOptions::default() };
    let (mut checker, mut state) = (Checker::new(&scene, options), SceneState::new(&scene));
    for (i, r) in cell.robots.iter().enumerate() {
        state.set_q(&scene, RobotId(i), &r.start).unwrap();
    }
    let rows = answer.timed.as_ref().expect("a path").trajectory.rows();
    assert_eq!(&rows[0].q, request.from.as_ref().unwrap());
    assert_eq!(PathGoal::Joints(rows[rows.len() - 1].q.clone()), request.to);
    for w in rows.windows(2) {
        for share in [0.0, 0.25, 0.5, 0.75] {
            let q: Vec<f64> = w[0].q.iter().zip(&w[1].q).map(|(a, b)| a + (b - a) * share).collect();
            state.set_q(&scene, RobotId(robot), &q).unwrap();
            let hit = checker.collides(&state).map(|h| [h.a, h.b].map(|m| scene.name(m)));
            assert_eq!(hit, None, "at {} s", w[0].t_s);
        }
        let limits = &cell.robots[robot].limits;
        let slow =
            |i: usize| (w[1].q[i] - w[0].q[i]).abs() <= limits[i].velocity * (w[1].t_s - w[0].t_s) * (1.0 + 1e-6);
        assert!((0..limits.len()).all(slow), "at {} s", w[0].t_s);
    }
}

fn waypoints(answer: &PathAnswer) -> usize {
    answer.timed.as_ref().map_or(0, |timed| timed.path.waypoints.len())
}

const HERE: [f64; 6] = [-0.8, -0.9, 0.3, 0.0, 0.5, 0.0];
const THERE: [f64; 6] = [0.8, -0.9, 0.3, 0.0, 0.5, 0.0];

#[test]
fn objects_other_robots_tool_and_load_are_checked() {
    let arm = format!("[robot.arm]\n{ARM}");
    let post = "[object.post]\nshape = \"box\"\nat = [1100, 0, 500]\nsize = [100, 100, 1600]\n";
    let other = rail("ball", 0.0).replace("at = [0, 0, 0]", "at = [0, 0, 1050]") + "start = [900]\n";
    let tool = "[robot.arm.tool]\nbox = { at = [0, 0, 400], size = [40, 40, 800] }\n";
    let go = request("arm", &HERE, &THERE);
    let straight = plan(&parse(&format!("{HEAD}{arm}")), &go).unwrap();
    assert_eq!(waypoints(&straight), 2);
    for (what, text) in [("object", format!("{arm}{post}")), ("robot", format!("{arm}{other}"))] {
        let cell = parse(&format!("{HEAD}{text}"));
        let answer = plan(&cell, &go).unwrap();
        assert!(waypoints(&answer) > 2, "{what} is in the path");
        check(&cell, &answer, &go);
    }
    // An obstacle at the tip of the tool at half of the path, where the arm itself is not.
    let cell = parse(&format!("{HEAD}{arm}{tool}"));
    let chain = &cell.robots[0].robot.chain;
    let mut state = ChainState::new(chain);
    state.q.copy_from_slice(&[0.0, HERE[1], HERE[2], HERE[3], HERE[4], HERE[5]]);
    chain.forward(&mut state);
    let tip = state.link_in_root(cell.robots[0].flange).transform_point(Vec3::Z * 0.75) * 1000.0;
    let low = format!("[object.low]\nshape = \"sphere\"\nat = [{}, {}, {}]\nradius = 30\n", tip.x, tip.y, tip.z);
    let without_tool = plan(&parse(&format!("{HEAD}{arm}{low}")), &go).unwrap();
    let cell = parse(&format!("{HEAD}{arm}{tool}{low}"));
    let tooled = plan(&cell, &go).unwrap();
    assert!(
        waypoints(&without_tool) == 2 && waypoints(&tooled) > 2,
        "{} {}",
        waypoints(&without_tool),
        waypoints(&tooled)
    );
    check(&cell, &tooled, &go);
}

#[test]
fn the_rows_are_a_file_that_a_cell_reads_back() {
    let cell = parse(&format!("{HEAD}[robot.arm]\n{ARM}"));
    let go = PathRequest { period_s: Some(0.01), ..request("arm", &HERE, &THERE) };
    let answer = plan(&cell, &go).unwrap();
    let trajectory = &answer.timed.as_ref().unwrap().trajectory;
    let mut text = Vec::new();
    write_csv(&answer.joints, trajectory, &mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    let read = QueryStates::parse("path.csv".as_ref(), &text, &QueryModel::of_cell(&cell)).unwrap();
    let rows = trajectory.rows();
    assert_eq!(read.len(), rows.len());
    assert!(rows.iter().enumerate().all(|(i, row)| read.of(i).next() == Some((RobotId(0), &row.q[..]))));
}

/// Published robots with meshes and SRDF, some with prismatic or mimic joints.
#[test]
fn paths_of_real_robots_lead_around_a_post() {
    let Some(data) = folder::data() else { return };
    let ready = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785, 0.01];
    let turned = |by: f64| [&[by][..], &ready[1..]].concat();
    let folder = data.join("urdf/panda");
    let model = |name: &str| folder.join(name).display().to_string();
    let cell = parse(&format!(
        "version = 1\nunits = {{ length = \"m\", angle = \"rad\" }}\n[robot.panda]\nmodel = '{}'\nsrdf = '{}'\n\
         [object.post]\nshape = \"cylinder\"\nat = [0.35, 0, 0.5]\nradius = 0.02\nheight = 1\n",
        model("panda.urdf"),
        model("panda.srdf")
    ));
    let go = request("panda", &turned(-1.0), &turned(1.0));
    let answer = plan(&cell, &go).unwrap();
    assert!(waypoints(&answer) > 2);
    check(&cell, &answer, &go);
}

#[test]
fn an_optimized_path_is_free_and_no_longer_than_the_first() {
    let post = "[object.post]\nshape = \"box\"\nat = [1100, 0, 500]\nsize = [100, 100, 1600]\n";
    let cell = parse(&format!("{HEAD}[robot.arm]\n{ARM}{post}"));
    let first = request("arm", &HERE, &THERE);
    let mut optimized = PathRequest { optimize: true, ..first.clone() };
    optimized.options.time_limit = Duration::from_millis(500);
    let [first, shorter] = [&first, &optimized].map(|request| plan(&cell, request).unwrap());
    check(&cell, &shorter, &optimized);
    let cost = |answer: &PathAnswer| answer.timed.as_ref().unwrap().path.length_rad;
    assert!(cost(&shorter) <= cost(&first), "{} > {}", cost(&shorter), cost(&first));
    assert!(cost(&shorter) >= 1.6, "the straight segment is 1.6 rad long");
}
