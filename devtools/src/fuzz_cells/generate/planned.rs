//! Robots with planned moves, by random samples or on the robot's joint-space map, so that they go around the regions.

use elbowroom_cell::Cell;

use crate::fuzz_cells::oracle::{Arm, Frame};
use crate::fuzz_cells::random::{Random, rounded};
use crate::fuzz_cells::spec::{CellSpec, KeepSpec, RobotSpec, StepSpec};

/// Number of joints of a map.
pub const MAPPED: usize = 3;

/// Turns most joint moves of a cell into planned moves.
pub fn plan(spec: &mut CellSpec, random: &mut Random) {
    for robot in &mut spec.robots {
        plan_moves(robot, random);
    }
}

fn plan_moves(robot: &mut RobotSpec, random: &mut Random) {
    let is_mapped = random.percent(30) || random.is_first() && random.in_turn(3) == 0;
    let on_map = robot.start.len() >= MAPPED && is_mapped;
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
        *step = StepSpec::Planned { to: std::mem::take(to), percent: *percent, on_map, keep: None };
    }
    if on_map {
        robot.program.steps.retain(|step| !matches!(step, StepSpec::Linear { .. }));
    }
}

/// Lets some robots keep the axis of their tool that is along the first joint's at the start: their first joint turns
/// freely, the others a little.
pub fn keep_axes(spec: &mut CellSpec, cell: &Cell, random: &mut Random) {
    for (robot, r) in spec.robots.iter_mut().zip(&cell.robots) {
        let keeps = random.percent(40) || random.is_first() && random.in_turn(3) == 2;
        if robot.start.len() < MAPPED || !r.payload.tools.is_empty() || !keeps {
            continue;
        }
        let (start, within) = (robot.start.clone(), rounded(random.between(0.05, 0.6)));
        let arm = Arm::new(r);
        let tool = |q: &[f64]| arm.frames(q)[r.flange.0].then(&Frame::of(&r.tcp_in_flange));
        let up = Frame::of(&r.base_in_world).vector(elbowroom_spatial::Vec3::Z);
        let axis = tool(&start).vector_back(up);
        let axis = [axis.x, axis.y, axis.z].map(rounded);
        for step in &mut robot.program.steps {
            match step {
                StepSpec::Planned { to, keep, on_map: false, .. } => {
                    for (value, start) in to.iter_mut().zip(&start).skip(1) {
                        *value = rounded(start + (*value - start) * 0.2 * within);
                    }
                    *keep = Some(KeepSpec { axis, within });
                }
                StepSpec::Joint { to, .. } | StepSpec::Linear { to, .. } => to.copy_from_slice(&start),
                _ => {}
            }
        }
    }
}
