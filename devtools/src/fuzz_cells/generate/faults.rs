//! Random faults of the input of the monitors.

use elbowroom_robot::RobotId;
use elbowroom_sim::{InputFault, InputFaultKind};

use crate::fuzz_cells::random::Random;
use crate::fuzz_cells::spec::CellSpec;

/// One to three faults that do not overlap, for each robot of a cell.
pub fn add(spec: &mut CellSpec, random: &mut Random) {
    for (robot, r) in spec.robots.iter().enumerate() {
        let mut from_s = 0.0;
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
