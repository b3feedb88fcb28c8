//! Random robots.

use std::f64::consts::{FRAC_PI_2, PI};

use super::settings::{Places, program, stop_time};
use crate::fuzz_cells::random::{Random, rounded};
use crate::fuzz_cells::spec::{DhRow, HandSpec, Model, ProgramSpec, RobotSpec, SolidSpec};

/// Robots of `examples/models` with the joint ranges of their random moves, rad.
const EXAMPLES: [(&str, [f64; 6]); 3] = [
    ("ns16/ns16", [2.5, 1.2, 1.2, 2.5, 1.8, 3.0]),
    ("rx60b/rx60b", [2.5, 1.5, 1.5, 2.5, 1.5, 3.0]),
    ("kr125/kr125", [2.5, 0.7, 0.7, 2.5, 1.8, 3.0]),
];

/// Real robots with six revolute joints, used if the data exist.
const REAL: [&str; 4] = [
    "urdf/staubli_tx40/tx40.urdf",
    "urdf/kuka_kr6r700sixx/kr6r700sixx.urdf",
    "urdf/fanuc_lrmate200ic5l/lrmate200ic5l.urdf",
    "urdf/abb_irb2400/irb2400.urdf",
];

/// Makes a robot of six axes from a file, with a program.
pub fn example(random: &mut Random, places: &Places<'_>) -> RobotSpec {
    from_file(random, places)
}

/// Makes a robot of one or two joints.
pub fn small(random: &mut Random) -> RobotSpec {
    gantry(random)
}

/// Makes a gantry or an arm of prismatic and revolute joints, with its hand.
pub fn jointed(random: &mut Random) -> RobotSpec {
    let mut robot = if random.percent(40) { gantry(random) } else { arm(random) };
    equip(&mut robot, random);
    robot
}

/// Makes a robot without hand and program.
pub fn bare(model: Model, start: Vec<f64>, random: &mut Random) -> RobotSpec {
    RobotSpec {
        model,
        at: [0.0; 3],
        rpy: [0.0; 3],
        start,
        hand: HandSpec::default(),
        volumes: "auto",
        stop_time: stop_time(random),
        acceleration: None,
        overshoot: None,
        program: ProgramSpec::of_steps(
            if random.percent(80) { 100.0 } else { random.whole(20, 100) as f64 },
            Vec::new(),
        ),
        evades: Vec::new(),
        is_mechanism: false,
        keys: Vec::new(),
        starts_at_home: false,
    }
}

/// Adds a tool centre point, a tool and a load to some robots.
pub fn equip(robot: &mut RobotSpec, random: &mut Random) {
    if random.percent(40) {
        robot.hand.tcp = Some([random.between(-0.1, 0.1), 0.0, random.between(0.0, 0.4)]);
    }
    if random.percent(30) {
        robot.hand.tool_box = Some((
            random.vector(0.1),
            [random.between(0.02, 0.2), random.between(0.02, 0.2), random.between(0.05, 0.4)],
        ));
    }
    if random.percent(20) {
        robot.hand.load = Some(solid(random, [0.0; 3], 0.3));
    }
}

/// Makes one to three prismatic joints at right angles, or with a revolute one among them.
fn gantry(random: &mut Random) -> RobotSpec {
    let joints = random.whole(1, 3);
    let rows: Vec<DhRow> = (0..joints)
        .map(|_| {
            let row = row(random, true);
            DhRow { alpha: FRAC_PI_2, theta: FRAC_PI_2, ..row }
        })
        .collect();
    finish(rows, Some((0.1, 3.0)), random)
}

/// Makes an arm of revolute and prismatic joints.
pub fn arm(random: &mut Random) -> RobotSpec {
    let joints = random.whole(1, 6);
    let rows: Vec<DhRow> = (0..joints)
        .map(|_| {
            let slides = random.percent(25);
            row(random, slides)
        })
        .collect();
    finish(rows, None, random)
}

fn row(random: &mut Random, slides: bool) -> DhRow {
    let speed = if slides { random.scaled(0.2, 4.0) } else { random.scaled(0.4, 6.0) };
    let half = if slides { random.between(0.3, 2.0) } else { random.between(0.5, 3.1) };
    DhRow {
        slides,
        a: if random.percent(70) { random.between(0.0, 0.7) } else { 0.0 },
        alpha: if random.percent(80) {
            random.one(&[0.0, rounded(FRAC_PI_2), rounded(-FRAC_PI_2)])
        } else {
            random.between(-PI, PI)
        },
        d: if random.percent(50) { random.between(-0.3, 0.5) } else { 0.0 },
        theta: if random.percent(50) { random.between(-PI, PI) } else { 0.0 },
        min: -half,
        max: half,
        speed,
        acceleration: rounded(speed / random.scaled(0.05, 1.0)),
    }
}

fn finish(rows: Vec<DhRow>, linear: Option<(f64, f64)>, random: &mut Random) -> RobotSpec {
    let last = rows.len() - 1;
    let links = (0..rows.len())
        .map(|i| {
            let count = if i == last { random.whole(1, 2) } else { random.whole(0, 2) };
            let back = [-rows[i].a, 0.0, 0.0];
            (0..count).map(|_| solid(random, back, 0.25)).collect()
        })
        .collect();
    let mut place = || rows.iter().map(|r| random.between(r.min, r.max)).collect::<Vec<f64>>();
    let (start, targets) = (place(), [place(), place(), place()]);
    let mut robot = bare(Model::Dh { rows, links, has_names: false }, start, random);
    let count = random.whole(1, 3);
    robot.program.steps = program(targets[..count].to_vec(), linear, random);
    robot
}

/// Makes a random solid about the origin; long ones may reach back along the link.
pub fn solid(random: &mut Random, back: [f64; 3], most: f64) -> SolidSpec {
    let at = random.vector(most * 0.5);
    let radius = random.between(0.01, most * 0.5);
    let to = if random.percent(50) { back } else { random.vector(most) };
    // Coincident ends define no axis.
    let to = if to.iter().zip(&at).all(|(a, b)| (a - b).abs() < 0.02) { [at[0], at[1], at[2] + 0.1] } else { to };
    match random.whole(0, 3) {
        0 => SolidSpec::Sphere { at, radius },
        1 => {
            let size = std::array::from_fn(|_| random.between(0.01, most));
            SolidSpec::Box { at, rpy: random.vector(3.0), size }
        }
        2 => SolidSpec::Capsule { from: at, to, radius },
        _ => SolidSpec::Cylinder { from: at, to, radius },
    }
}

fn from_file(random: &mut Random, places: &Places<'_>) -> RobotSpec {
    let (example, ranges) = random.one(&EXAMPLES);
    let real = random.one(&REAL);
    let real = places.data.map(|d| d.join(real)).filter(|path| path.is_file() && random.percent(10));
    let (lines, ranges) = if let Some(path) = real {
        (format!("model = \"{}\"\n", path.display()), [1.5, 0.5, 0.5, 1.5, 1.0, 2.0])
    } else {
        let path = places.root.join("examples/models").join(example);
        (format!("model = \"{0}.urdf\"\nsrdf = \"{0}.srdf\"\n", path.display()), ranges)
    };
    let mut around = |middle: &[f64], share: f64| -> Vec<f64> {
        let near = |(m, r): (&f64, &f64)| rounded((m + random.between(-share * r, share * r)).clamp(-r, *r));
        middle.iter().zip(&ranges).map(near).collect()
    };
    let start = around(&[0.0; 6], 1.0);
    let (near, far) = (around(&start, 0.3), around(&start, 1.0));
    let targets = vec![near, far];
    let mut robot = bare(Model::File(lines), start, random);
    robot.volumes = random.one(&["auto", "capsule", "box", "hull"]);
    robot.acceleration = Some(random.scaled(2.0, 60.0));
    let linear = random.percent(30).then_some((0.1, 1.5));
    robot.program.steps = program(targets, linear, random);
    robot
}
