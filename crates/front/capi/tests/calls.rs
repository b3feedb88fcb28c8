//! Calls from C: every function, with right and wrong arguments, with and without sanitizers; the same answers as in Rust.

use std::fmt::Write as _;
use std::mem::offset_of;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use elbowroom::cell::{Cell, OutOfReachProofs, QueryModel};
use elbowroom::formats::robot::{LoadOptions, load};
use elbowroom::kinematics::LinkId;
use elbowroom::query::{QueryChecker, QueryKind, QueryPairs, QueryRow};
use elbowroom::robot::{GeometryId, RobotId};
use elbowroom::scene::{CheckerOptions, Level, Scene, SceneState};
use elbowroom::spatial::{Pose, Vec3};
use elbowroom_capi::{Answer, LevelCode, PoseRecord, RobotFile};
use elbowroom_testkit::compiler;

/// Two joints, the second of which cannot be at 0.
const ARM: &str = r#"<robot name="arm">
  <link name="base"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <link name="upper_arm"><collision><origin xyz="0.3 0 0"/><geometry><sphere radius="0.05"/></geometry></collision></link>
  <link name="forearm"><collision><origin xyz="0.2 0 0.1"/><geometry><box size="0.2 0.06 0.06"/></geometry></collision></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper_arm"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper_arm"/><child link="forearm"/><origin xyz="0.4 0 0"/><axis xyz="0 0 1"/>
    <limit lower="0.25" upper="2" velocity="1" effort="1"/></joint>
</robot>
"#;

const CELL: &str = r#"version = 1
units = { length = "m", angle = "rad" }
[robot.arm]
model = "arm.urdf"
start = [0.1, 0.5]
[object.ball]
shape = "sphere"
at = [0, 1, 0]
radius = 0.2
[region.corner]
shape = "sphere"
centre = [0, -1, 0.3]
radius = 0.1
warning = 0.1
"#;

fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(dir.path().join(name), text).unwrap();
    write("arm.urdf", ARM);
    write("cell.toml", CELL);
    write("broken.toml", "version = 1\nunits = { length = \"m\", angle = \"rad\" }\nrobot = 7\n");
    write("broken.urdf", &ARM[..ARM.len() / 2]);
    dir
}

fn source(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/c").join(name)
}

fn compiled(mut compiler: Command, name: &str) -> PathBuf {
    let program = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    compiler.arg("-I").arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("include"));
    compiler::compile(compiler, &source("calls.c"), &program, &compiler::linked("elbowroom_capi"));
    program
}

fn run(program: &Path, folder: &Path) -> Output {
    let output = Command::new(program).arg(folder).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && errors.is_empty(), "{}\n{errors}", output.status);
    output
}

/// The line that `calls.c` prints for an answer.
fn line(what: &str, row: &QueryRow, model: &QueryModel) -> String {
    let name = |side: Option<GeometryId>| side.map_or("-".to_owned(), |id| model.geometry_name(id));
    let level = [Level::Auto, Level::L1, Level::L2, Level::Capsule, Level::Hull, Level::L3];
    let level = level.iter().position(|level| *level == row.level).unwrap();
    let (a, b) = (name(row.pair.map(|p| p.0)), name(row.pair.map(|p| p.1)));
    let mut line = format!("{what} {} {level}", u8::from(row.collides));
    let points = [row.witness.map(|w| w.0), row.witness.map(|w| w.1)];
    let mut numbers = vec![row.distance_m.unwrap_or(f64::NAN)];
    numbers.extend(points.into_iter().flat_map(|p| p.map_or([f64::NAN; 3], Vec3::to_array)));
    write!(line, " {:x} {a} {b}", bits(numbers[0])).unwrap();
    numbers[1..].iter().for_each(|v| write!(line, " {:x}", bits(*v)).unwrap());
    line
}

/// All NaN are alike.
fn bits(value: f64) -> u64 {
    if value.is_nan() { f64::NAN.to_bits() } else { value.to_bits() }
}

/// A line from C with the bits of its numbers in place of the numbers.
fn with_bits(line: &str) -> String {
    let words = line.split(' ').enumerate().map(|(i, word)| match word.parse::<f64>() {
        Ok(value) if i > 2 || line.starts_with("pose") => format!("{:x}", bits(value)),
        _ => word.to_owned(),
    });
    words.collect::<Vec<_>>().join(" ")
}

/// What `calls.c` must print after the layouts.
fn expected(folder: &Path) -> Vec<String> {
    let path = folder.join("arm.urdf");
    let arm = |name: &str, y: f64| {
        let robot = load(&path, &LoadOptions::default()).unwrap().robot;
        (name.to_owned(), robot, Pose { translation: Vec3::new(0.0, y, 0.0), ..Pose::IDENTITY })
    };
    let model = QueryModel::of_robots(&path, [arm("left", 0.0), arm("right", 0.5)]);
    let scene = model.scene(OutOfReachProofs::Compute).unwrap();
    let mut state = started(&model, &scene);
    state.set_q(&scene, RobotId(0), &[0.5, 1.0]).unwrap();
    let mut checker = QueryChecker::new(&scene, CheckerOptions::default(), &QueryPairs::all());
    let pose = PoseLine(state.pose(&scene, GeometryId::Link { robot: RobotId(0), link: LinkId(2) }).unwrap());
    let mut lines = vec![pose.to_string()];
    lines.push(line("collision", &checker.row(&state, QueryKind::Collision), &model));
    lines.push(line("distance", &checker.row(&state, QueryKind::Distance), &model));
    lines.push(line("within", &checker.row(&state, QueryKind::Tolerance(0.001)), &model));
    lines.push(line("within", &checker.row(&state, QueryKind::Tolerance(9.0)), &model));
    let pairs = QueryPairs::between("left/forearm,right/base", &mut model.clone(), None).unwrap();
    let options = CheckerOptions { level: Level::L3, ..CheckerOptions::default() };
    let mut named = QueryChecker::new(&scene, options, &pairs);
    lines.push(line("named", &named.row(&state, QueryKind::Distance), &model));
    let rows: Vec<QueryRow> = checker.rows_within(&state, 9.0).collect();
    lines.extend(rows.iter().rev().map(|row| line("pair", row, &model)));
    let cell = Cell::load(folder.join("cell.toml")).unwrap();
    let mut model = QueryModel::of_cell(&cell);
    assert!(model.add_region(&cell, "corner"));
    let scene = model.scene(OutOfReachProofs::Compute).unwrap();
    let mut checker = QueryChecker::new(&scene, CheckerOptions::default(), &QueryPairs::all());
    lines.push(line("cell", &checker.row(&started(&model, &scene), QueryKind::Distance), &model));
    lines
}

fn started(model: &QueryModel, scene: &Scene) -> SceneState {
    let mut state = model.start_state(scene).unwrap();
    for (robot, of_robot) in model.robots.iter().enumerate() {
        state.set_q(scene, RobotId(robot), &of_robot.start).unwrap();
    }
    state
}

struct PoseLine(Pose);

impl std::fmt::Display for PoseLine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "pose")?;
        let numbers = self.0.translation.to_array().into_iter().chain(self.0.rotation.to_quaternion_xyzw());
        numbers.into_iter().try_for_each(|v| write!(f, " {:x}", bits(v)))
    }
}

/// The layout of a structure in Rust, as `calls.c` prints that of C.
macro_rules! layout {
    ($rust:ident, $c:literal, $($field:ident),*) => {{
        let mut lines = vec![$(format!("{}.{} {}", $c, stringify!($field), offset_of!($rust, $field))),*];
        lines.push(format!("{} {}", $c, size_of::<$rust>()));
        lines
    }};
}

fn layouts() -> Vec<String> {
    let pose = layout!(PoseRecord, "elbowroom_pose", position_m, quaternion_xyzw);
    let robot = layout!(RobotFile, "elbowroom_robot_file", name, path, srdf, joints, unit, base_in_world);
    let answer = layout!(Answer, "elbowroom_answer", collides, level, distance_m, a, b, point_a_m, point_b_m);
    [pose, robot, answer].concat()
}

fn check(compiler: Command, name: &str) {
    let dir = folder();
    let output = run(&compiled(compiler, name), dir.path());
    let printed = String::from_utf8(output.stdout).unwrap();
    let printed: Vec<&str> = printed.lines().collect();
    let layouts = layouts();
    assert_eq!(printed[..layouts.len()], layouts[..]);
    let answers: Vec<String> = printed[layouts.len()..].iter().map(|line| with_bits(line)).collect();
    let expected = expected(dir.path());
    assert!(expected.len() > 8, "{expected:?}");
    assert_eq!(answers, expected);
}

#[test]
fn calls_from_c_answer_like_rust_and_refuse_what_is_wrong() {
    let Some(compiler) = compiler::c() else { return };
    check(compiler, "calls");
}

#[test]
fn no_call_makes_a_sanitizer_report() {
    let dir = tempfile::tempdir().unwrap();
    let Some(compiler) = compiler::c().and_then(|c| compiler::with_sanitizers(c, dir.path())) else { return };
    check(compiler, "calls_sanitized");
}

#[test]
fn levels_have_the_numbers_of_the_header() {
    let codes = [LevelCode::Auto, LevelCode::L1, LevelCode::L2, LevelCode::Capsule, LevelCode::Hull, LevelCode::L3];
    assert_eq!(codes.map(|code| code as i32), [0, 1, 2, 3, 4, 5]);
}
