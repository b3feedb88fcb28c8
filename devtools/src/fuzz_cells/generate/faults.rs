//! Random faults of the input of the monitors.

use elbowroom_cell::Cell;
use elbowroom_robot::RobotId;
use elbowroom_sim::{InputFault, InputFaultKind};

use super::settings::Places;
use crate::fuzz_cells::random::Random;
use crate::fuzz_cells::spec::CellSpec;

/// One to three faults that do not overlap, for each robot of a cell; before them perhaps readings near a joint limit.
pub fn add(spec: &mut CellSpec, random: &mut Random, places: &Places<'_>) {
    for robot in &mut spec.robots {
        robot.overshoot = random.percent(50).then(|| if random.percent(20) { 0.0 } else { random.scaled(0.001, 0.3) });
    }
    let cell = spec.parse(places.cells);
    for (robot, r) in spec.robots.iter().enumerate() {
        let mut from_s = 0.0;
        if random.percent(30)
            && let Ok(cell) = &cell
            && let Some(fault) = near_a_limit(cell, RobotId(robot), random)
        {
            from_s = fault.to_s;
            spec.faults.push(fault);
        }
        for _ in 0..random.whole(1, 3) {
            from_s += random.between(0.02, 0.8);
            let to_s = from_s + random.scaled(0.001, 0.5);
            let kind = match random.whole(0, 4) {
                0 => InputFaultKind::Delayed { by_s: random.scaled(0.001, 0.2) },
                // The controller stops at the first missing answer; a later stop would have to be part of the reaction
                // time.
                1 => InputFaultKind::Lost { timeout_s: 0.0 },
                2 => InputFaultKind::Frozen,
                3 => {
                    let sign = if random.percent(50) { 1.0 } else { -1.0 };
                    InputFaultKind::Jump {
                        joint: random.whole(0, r.start.len() - 1),
                        by: sign * random.scaled(0.2, 2.0),
                    }
                }
                _ => InputFaultKind::NotANumber,
            };
            spec.faults.push(InputFault { robot: RobotId(robot), from_s, to_s, kind });
            from_s = to_s;
        }
    }
}

/// From the start on, a joint reads as if it were about as far beyond a limit as is tolerated. The first reading has no
/// reading before it from which it could have jumped. `None` for a joint without limits.
///
/// A tolerated reading is plausible but wrong, so it lasts for one tick, in which the robot does not come far.
fn near_a_limit(cell: &Cell, robot: RobotId, random: &mut Random) -> Option<InputFault> {
    let r = &cell.robots[robot.0];
    let chain = &r.robot.chain;
    let joint = random.whole(0, chain.dof() - 1);
    let limits = chain.joints()[chain.active_joints()[joint].0].limits;
    let tolerance = limits.overshoot_tolerance.unwrap_or(0.05);
    let beyond = tolerance + random.between(-0.05, 0.05);
    let reading = if random.percent(50) { limits.upper + beyond } else { limits.lower - beyond };
    let kind = InputFaultKind::Jump { joint, by: reading - r.start[joint] };
    let to_s = if beyond <= tolerance + 1e-3 { 1e-4 } else { random.scaled(0.02, 0.5) };
    reading.is_finite().then_some(InputFault { robot, from_s: 0.0, to_s, kind })
}
