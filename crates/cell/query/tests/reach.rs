//! What a robot reaches from other places of its base: compared with scenes that were built there.

use std::num::NonZeroUsize;

use elbowroom_cell::{Cell, OutOfReachProofs, QueryModel};
use elbowroom_kinematics::ChainState;
use elbowroom_kinematics::inverse::{IkOptions, IkSolver};
use elbowroom_query::{Reach, ReachQuery, ReachTarget};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, SceneState};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::folder;
use elbowroom_testkit::random::Random;

const ARM: RobotId = RobotId(0);

/// An arm on a floor, beside a post and above a box; a second arm stands behind.
fn cell() -> Cell {
    Cell::parse(folder::workspace().join("cell.toml"), &text()).unwrap_or_else(|e| panic!("{e}"))
}

fn text() -> String {
    let urdf = folder::model("rx60b");
    format!(
        r#"
version = 1
units = {{ length = "m", angle = "rad" }}
[robot.arm]
model = "{urdf}"
tool = {{ tcp = {{ at = [0, 0, 0.1] }} }}
[robot.other]
model = "{urdf}"
base = {{ at = [-0.9, 0.4, 0] }}
[object.floor]
shape = "plane"
[object.post]
shape = "box"
size = [0.1, 0.1, 1.2]
at = [0.45, 0.3, 0.61]
[object.bench]
shape = "box"
size = [0.5, 0.6, 0.3]
at = [0.1, -0.8, 0.16]
"#,
        urdf = urdf.display()
    )
}

fn random_pose(r: &mut Random, size: f64, up_m: f64) -> Pose {
    let turn = Vec3::from(r.within(1.0)).try_normalize().unwrap_or(Vec3::Z);
    Pose::new(Rotation::from_axis_angle(turn, r.between(-3.0, 3.0)), Vec3::from(r.within(size)) + Vec3::Z * up_m)
}

/// The answers with a scene that was built with the base there.
fn naive(cell: &Cell, base: &Pose, targets: &[Pose]) -> Vec<Reach> {
    let mut model = QueryModel::of_cell(cell);
    model.robots[0].base_in_world = *base;
    let scene = model.scene(OutOfReachProofs::Omit).unwrap();
    let robot = &cell.robots[0];
    let options = IkOptions { restarts: 16, ..IkOptions::default() };
    let mut solver = IkSolver::new(&robot.robot.chain, robot.flange, robot.tcp_in_flange, options);
    let mut state = SceneState::new(&scene);
    state.set_q(&scene, RobotId(1), &cell.robots[1].start).unwrap();
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let reach = |target: &Pose| {
        let mut reach = Reach::default();
        for q in solver.solve_all(&(base.inverse() * *target), &robot.start) {
            reach.solutions += 1;
            state.set_q(&scene, ARM, &q).unwrap();
            if checker.collides(&state).is_none() {
                reach.free += 1;
                reach.q.get_or_insert(q);
            }
        }
        reach
    };
    targets.iter().map(reach).collect()
}

#[test]
fn the_answers_are_those_of_a_robot_that_stands_there() {
    let cell = cell();
    let query = ReachQuery::of_cell(&cell, ARM).unwrap();
    let robot = &cell.robots[0];
    let mut r = Random(11);
    let (mut out, mut blocked, mut free, mut some) = (0, 0, 0, 0);
    for _ in 0..6 {
        // Nowhere inside a solid.
        let base =
            Pose::new(Rotation::from_rpy(0.0, 0.0, r.between(-3.0, 3.0)), Vec3::new(r.between(-0.2, 0.2), 0.0, 0.0));
        let targets: Vec<Pose> = (0..60).map(|_| random_pose(&mut r, 0.4, 0.5)).collect();
        let frames: Vec<ReachTarget> = targets.iter().map(|pose| ReachTarget::Frame(*pose)).collect();
        let found = query.evaluate(&base, &frames, None).unwrap();
        assert_eq!(found, query.evaluate(&base, &frames, NonZeroUsize::new(3)).unwrap());
        assert_eq!(found, naive(&cell, &base, &targets), "{base:?}");
        for (found, target) in found.iter().zip(targets) {
            out += usize::from(found.solutions == 0);
            blocked += usize::from(found.solutions > 0 && found.free == 0);
            free += usize::from(found.free > 0 && found.free == found.solutions);
            some += usize::from(found.free > 0 && found.free < found.solutions);
            let Some(q) = &found.q else { continue };
            let mut state = ChainState::new(&robot.robot.chain);
            state.q.copy_from_slice(q);
            robot.robot.chain.forward(&mut state);
            let tool = base * state.link_in_root(robot.flange) * robot.tcp_in_flange;
            assert!(tool.translation.distance(target.translation) < 1e-6);
            assert!((tool.rotation.inverse() * target.rotation).angle() < 1e-6);
        }
    }
    assert!([out, blocked, free, some].iter().all(|&count| count >= 5), "{out} {blocked} {free} {some}");
}

#[test]
fn a_turn_about_the_axis_is_free() {
    let cell = cell();
    let query = |turns| ReachQuery::of_cell(&cell, ARM).unwrap().turns(NonZeroUsize::new(turns).unwrap());
    let (point, direction) = (Vec3::new(0.5, -0.1, 0.4), Vec3::new(0.0, 0.0, -2.0));
    let axis = [ReachTarget::Axis { point, direction }];
    let of_axis = query(4).evaluate(&Pose::IDENTITY, &axis, None).unwrap();
    let frames: Vec<ReachTarget> = (0..4)
        .map(|k| {
            let turn = Rotation::from_axis_angle(Vec3::Z, std::f64::consts::FRAC_PI_2 * f64::from(k));
            ReachTarget::Frame(Pose::new(Rotation::from_z(-Vec3::Z) * turn, point))
        })
        .collect();
    let of_frames = query(1).evaluate(&Pose::IDENTITY, &frames, None).unwrap();
    let sum = |count: fn(&Reach) -> usize| of_frames.iter().map(count).sum::<usize>();
    assert_eq!((of_axis[0].solutions, of_axis[0].free), (sum(|r| r.solutions), sum(|r| r.free)));
    assert!(of_axis[0].free > 0, "{of_axis:?}");
    assert_eq!(of_axis[0].q, of_frames.iter().find_map(|r| r.q.clone()));
}

#[test]
fn a_base_may_stand_on_its_floor_and_not_in_a_bench() {
    let cell = cell();
    let query = ReachQuery::of_cell(&cell, ARM).unwrap();
    let above =
        |base: Vec3| [ReachTarget::Frame(Pose::new(Rotation::from_z(-Vec3::Z), base + Vec3::new(0.4, 0.0, 0.5)))];
    let reach = |base: Vec3| query.evaluate(&Pose::from_translation(base), &above(base), None).unwrap().remove(0);
    let (present, inside) = (reach(Vec3::ZERO), reach(Vec3::new(0.1, -0.8, 0.0)));
    assert!(present.free > 0, "{present:?}");
    assert!(inside.solutions == present.solutions && inside.free == 0, "{inside:?}");
    // The base may touch the floor, but not sink into it.
    let sunk = reach(Vec3::new(0.0, 0.0, -0.1));
    assert!(sunk.solutions > 0 && sunk.free == 0, "{sunk:?}");
    assert!(reach(Vec3::new(0.0, 0.0, -0.0005)).free > 0);
}

#[test]
fn what_touches_somewhere_else_does_not_count() {
    let far = r#"
[robot.far]
dh = [{ a = 1, min = -3, max = 3, speed = 1 }]
links = [{ capsule = { from = [-1, 0, 0], to = [0, 0, 0], radius = 0.1 } }]
base = { at = [50, 0, 1] }
[object.stone]
shape = "sphere"
at = [50.5, 0, 1]
radius = 0.3
"#;
    let (alone, beside) = (cell(), Cell::parse(folder::workspace().join("cell.toml"), &(text() + far)).unwrap());
    let target = [ReachTarget::Axis { point: Vec3::new(0.5, -0.1, 0.4), direction: -Vec3::Z }];
    let reach = |cell: &Cell| ReachQuery::of_cell(cell, ARM).unwrap().evaluate(&Pose::IDENTITY, &target, None).unwrap();
    assert_eq!(reach(&alone), reach(&beside));
    assert!(reach(&alone)[0].free > 0);
}

#[test]
fn what_is_no_place_is_refused() {
    let query = ReachQuery::of_cell(&cell(), ARM).unwrap();
    let good = ReachTarget::Frame(Pose::IDENTITY);
    let bad = [
        ReachTarget::Frame(Pose::from_translation(Vec3::X * f64::NAN)),
        ReachTarget::Axis { point: Vec3::ZERO, direction: Vec3::ZERO },
        ReachTarget::Axis { point: Vec3::X * f64::INFINITY, direction: Vec3::Z },
    ];
    for target in bad {
        let message = query.evaluate(&Pose::IDENTITY, &[good, target], None).unwrap_err().to_string();
        assert!(message.contains("target 1 (from 0) is not finite, or its direction has no length"), "{message}");
    }
    let nowhere = Pose::from_translation(Vec3::Y * f64::NAN);
    assert!(query.evaluate(&nowhere, &[good], None).unwrap_err().to_string().contains("arm"));
    assert_eq!(query.evaluate(&Pose::IDENTITY, &[], None).unwrap(), []);
}
