//! Robots with one joint, with long moves at constant speed.

use std::f64::consts::{FRAC_PI_2, PI};

use super::settings::stop_time;
use crate::fuzz_cells::random::{Random, rounded};
use crate::fuzz_cells::spec::{DhRow, HandSpec, Model, ProgramSpec, RobotSpec, SolidSpec, StepSpec};

/// Makes a sphere that slides along a line, from one end to the other.
pub fn slide(random: &mut Random) -> RobotSpec {
    let half = random.between(1.0, 4.0);
    let steps = vec![StepSpec::Joint { to: vec![half], percent: 100.0 }];
    let mut robot = one_joint(row(true, 0.0, random), -half, steps, random);
    robot.rpy = [0.0, rounded(FRAC_PI_2), random.between(-PI, PI)];
    robot
}

/// Makes a rail without a program.
pub fn plain(random: &mut Random) -> RobotSpec {
    one_joint(row(true, 0.0, random), 0.0, Vec::new(), random)
}

/// Makes an arm that turns about its only axis, mostly by more than a full turn.
pub fn turner(random: &mut Random) -> RobotSpec {
    let a = random.between(0.0, 1.0);
    let (from, to) = (random.between(-6.0, 6.0), random.one(&[-6.5, 6.5]));
    let steps = vec![StepSpec::Joint { to: vec![to], percent: if random.percent(60) { 100.0 } else { 40.0 } }];
    one_joint(row(false, a, random), from, steps, random)
}

/// Makes a [`turner`] with a second joint that turns back by the angle of the first: its hand moves on a circle without
/// turning.
pub fn counter_turner(random: &mut Random) -> RobotSpec {
    let mut robot = turner(random);
    let Model::Dh { rows, links, .. } = &mut robot.model else { return robot };
    rows.push(DhRow { a: 0.0, ..rows[0] });
    links.push(Vec::new());
    robot.start.push(-robot.start[0]);
    for step in &mut robot.program.steps {
        if let StepSpec::Joint { to, .. } = step {
            to.push(-to[0]);
        }
    }
    robot
}

fn row(slides: bool, a: f64, random: &mut Random) -> DhRow {
    let speed = random.scaled(0.3, 3.0);
    let acceleration = rounded(speed / random.scaled(0.05, 0.5));
    DhRow { slides, a, alpha: 0.0, d: 0.0, theta: 0.0, min: -7.0, max: 7.0, speed, acceleration }
}

fn one_joint(row: DhRow, start: f64, steps: Vec<StepSpec>, random: &mut Random) -> RobotSpec {
    let ball = SolidSpec::Sphere { at: [0.0; 3], radius: random.scaled(0.01, 0.1) };
    RobotSpec {
        model: Model::Dh { rows: vec![row], links: vec![vec![ball]], has_names: false },
        at: [0.0; 3],
        rpy: [0.0; 3],
        start: vec![start],
        hand: HandSpec::default(),
        volumes: "auto",
        // Half of them stop slowly: they hit whatever they do not foresee.
        stop_time: if random.percent(50) { random.between(0.5, 1.5) } else { stop_time(random) },
        acceleration: None,
        overshoot: None,
        program: ProgramSpec::of_steps(100.0, steps),
        evades: Vec::new(),
        is_mechanism: false,
        keys: Vec::new(),
        starts_at_home: false,
    }
}
