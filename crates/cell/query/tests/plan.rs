//! Paths in cells: obstacles, and the parts that belong to the robot.

use std::time::Duration;

use crate::common::{ARM, HEAD, parse, rail};
use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel};
use elbowroom_kinematics::ChainState;
use elbowroom_planner::RrtConnectSettings;
use elbowroom_query::QueryStates;
use elbowroom_query::plan::{KeptAxis, PathAnswer, PathGoal, PathPlanner, PathRequest, TcpMotion, plan, write_csv};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, Level, SceneState};
use elbowroom_spatial::{Pose, Vec3};
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

/// The TCP of the first robot.
pub fn tcp(cell: &Cell, q: &[f64]) -> Pose {
    let robot = &cell.robots[0];
    let mut state = ChainState::new(&robot.robot.chain);
    state.q.copy_from_slice(q);
    robot.robot.chain.forward(&mut state);
    robot.base_in_world * state.link_in_root(robot.flange) * robot.tcp_in_flange
}

/// The rows of an answer, and three configurations between each two.
fn fine(answer: &PathAnswer) -> Vec<Vec<f64>> {
    let rows = answer.timed.as_ref().expect("a path").trajectory.rows();
    let between = |w: &[elbowroom_kinematics::TrajectoryRow], share: f64| -> Vec<f64> {
        w[0].q.iter().zip(&w[1].q).map(|(a, b)| a + (b - a) * share).collect()
    };
    rows.windows(2).flat_map(|w| [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| between(w, share))).collect()
}

fn moved(cell: &Cell, by: Vec3) -> Pose {
    let here = tcp(cell, &HERE);
    Pose { translation: here.translation + by, ..here }
}

fn to_pose(cell: &Cell, by: Vec3, tcp_motion: TcpMotion) -> PathRequest {
    PathRequest { to: PathGoal::Tcp(moved(cell, by).into()), tcp_motion, ..request("arm", &HERE, &THERE) }
}

#[test]
fn a_linear_path_keeps_the_tcp_on_its_line() {
    let cell = parse(&format!("{HEAD}[robot.arm]\n{ARM}"));
    for by in [Vec3::new(0.0, 0.3, -0.1), Vec3::new(-0.2, 0.1, 0.1), Vec3::new(0.1, 0.2, 0.0)] {
        let answer = plan(&cell, &to_pose(&cell, by, TcpMotion::Linear)).unwrap();
        let (from, to) = (tcp(&cell, &HERE), moved(&cell, by));
        let mut farthest: f64 = 0.0;
        for q in fine(&answer) {
            let at = tcp(&cell, &q);
            let share = (at.translation - from.translation).dot(by) / by.length_squared();
            let off = (at.translation - from.translation - by * share).length();
            assert!(off < 1e-3 && (-1e-3..1.001).contains(&share), "{off} m at {share}");
            assert!(from.inverse_mul(&at).rotation.angle() < 3e-3);
            farthest = farthest.max(share);
        }
        assert!(farthest > 1.0 - 1e-9);
        assert!(
            tcp(&cell, answer.timed.as_ref().unwrap().trajectory.last().unwrap()).inverse_mul(&to).translation.length()
                < 1e-6
        );
    }
    // A ball on the line: a free path leads around it, a straight one ends before it.
    let by = Vec3::new(0.0, 0.3, 0.0);
    let on_line = moved(&cell, by * 0.5).translation * 1e3;
    let ball =
        format!("[object.ball]\nshape = \"sphere\"\nat = [{}, {}, {}]\nradius = 20\n", on_line.x, on_line.y, on_line.z);
    let cell = parse(&format!("{HEAD}[robot.arm]\n{ARM}{ball}"));
    let answer = plan(&cell, &to_pose(&cell, by, TcpMotion::Linear)).unwrap();
    assert!(!answer.found && answer.reason.as_ref().unwrap().contains("it is not free"), "{:?}", answer.reason);
    assert!(plan(&cell, &to_pose(&cell, by, TcpMotion::Free)).unwrap().found);
    let refused = |request: &PathRequest| plan(&cell, request).unwrap_err().to_string();
    assert!(
        refused(&PathRequest { to: THERE[..].into(), ..to_pose(&cell, by, TcpMotion::Linear) })
            .contains("leads to a pose")
    );
    assert!(
        refused(&PathRequest { planner: PathPlanner::Grid, ..to_pose(&cell, by, TcpMotion::Linear) })
            .contains("no map")
    );
}

#[test]
fn an_axis_that_is_kept_stays_within_its_angle() {
    let axis_in_tcp = Vec3::new(0.0, 0.6, 0.8);
    let keep = |tolerance_rad: f64| TcpMotion::KeptAxis(KeptAxis { axis_in_tcp, tolerance_rad });
    let open = parse(&format!("{HEAD}[robot.arm]\n{ARM}"));
    let by = Vec3::new(0.0, 1.1, 0.0);
    let between = moved(&open, by * 0.5).translation * 1e3;
    let post =
        format!("[object.post]\nshape = \"box\"\nat = [{}, {}, 500]\nsize = [80, 80, 1600]\n", between.x, between.y);
    // A region whose border the path keeps away from, beside the axis.
    let wall =
        "[region.wall]\nshape = \"box\"\nfrom = [-1500, -1500, 2900]\nto = [1500, 1500, 3000]\nguards = [\"arm\"]\n";
    for (text, corners) in [(String::new(), 0), (post, 1), (wall.to_owned(), 0)] {
        let cell = parse(&format!("{HEAD}[robot.arm]\n{ARM}{text}"));
        let answer = plan(&cell, &to_pose(&cell, by, keep(0.05))).unwrap();
        let direction = tcp(&cell, &HERE).rotation * axis_in_tcp;
        let off = |q: &[f64]| {
            let axis = tcp(&cell, q).rotation * axis_in_tcp;
            axis.cross(direction).length().atan2(axis.dot(direction))
        };
        let most = fine(&answer).iter().map(|q| off(q)).fold(0.0, f64::max);
        assert!(
            most <= 0.05 + 1e-9 && waypoints(&answer) >= 2 + corners,
            "{most} rad, {} waypoints",
            waypoints(&answer)
        );
        check(
            &cell,
            &answer,
            &PathRequest {
                to: answer.timed.as_ref().unwrap().trajectory.last().unwrap().to_vec().into(),
                ..request("arm", &HERE, &THERE)
            },
        );
        // Free, the axis turns farther.
        let free = plan(&cell, &to_pose(&cell, by, TcpMotion::Free)).unwrap();
        assert!(fine(&free).iter().map(|q| off(q)).fold(0.0, f64::max) > 0.05);
    }
    let refused = |request: &PathRequest| plan(&open, request).unwrap_err().to_string();
    assert!(refused(&PathRequest { tcp_motion: keep(0.1), ..request("arm", &HERE, &THERE) }).contains("wider angle"));
    for angle in [0.0, -0.1, f64::NAN, std::f64::consts::PI, f64::INFINITY] {
        assert!(refused(&to_pose(&open, by, keep(angle))).contains("not between 0 and half a turn"), "{angle}");
    }
    let none = TcpMotion::KeptAxis(KeptAxis { axis_in_tcp: Vec3::ZERO, tolerance_rad: 0.1 });
    assert!(refused(&to_pose(&open, by, none)).contains("no direction"));
    // Out of a region no axis is kept.
    let inside = parse(&format!("{HEAD}[robot.arm]\n{ARM}{}", wall.replace("2900", "300")));
    assert!(
        plan(&inside, &to_pose(&inside, by, keep(0.1))).unwrap_err().to_string().contains("start is in region `wall`")
    );
}
