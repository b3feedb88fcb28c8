//! Robots with planned moves, by random samples or on the robot's joint-space map, so that they go around the regions.

use crate::fuzz_cells::random::Random;
use crate::fuzz_cells::spec::{CellSpec, RobotSpec, StepSpec};

/// Number of joints of a map.
const MAPPED: usize = 3;

/// Turns most joint moves of a cell into planned moves.
pub fn plan(spec: &mut CellSpec, random: &mut Random) {
    for robot in &mut spec.robots {
        plan_moves(robot, random);
    }
}

fn plan_moves(robot: &mut RobotSpec, random: &mut Random) {
    let on_map = robot.start.len() >= MAPPED && random.percent(30);
    // Joints outside the map keep their values.
    let rest = if on_map { robot.start[MAPPED..].to_vec() } else { Vec::new() };
    for step in &mut robot.program.steps {
        let StepSpec::Joint { to, percent } = step else { continue };
        if !random.percent(70) && !on_map {
            continue;
        }
        if on_map {
            to[MAPPED..].copy_from_slice(&rest);
        }
        *step = StepSpec::Planned { to: std::mem::take(to), percent: *percent, on_map };
    }
    if on_map {
        robot.program.steps.retain(|step| !matches!(step, StepSpec::Linear { .. }));
    }
}
