//! Conditions under which a stopped robot would continue.

use elbowroom_cell::configure::MonitorSetup;
use elbowroom_cell::{Cell, CellRegionId, Follow};
use elbowroom_monitor::{Life, OverrideReason, ZoneArbiter};
use elbowroom_robot::RobotId;

use super::final_waits::blockers;
use crate::recording::{HoldReason, Outcome, RobotTrack};

/// Condition under which this robot would continue, in words; `None` for a moving robot, or if none is
/// known.
///
/// `finished` states per robot whether its program is over.
pub(super) fn release(
    cell: &Cell,
    setup: &MonitorSetup,
    arbiter: Option<&ZoneArbiter>,
    robot: RobotId,
    track: &RobotTrack,
    finished: &[bool],
) -> Option<String> {
    let last = track.samples.last()?;
    track.ending.stopped_at_s?;
    if let Some((reason, by)) = track.perception.as_ref().and_then(|p| p.ends_held.as_ref()) {
        return Some(match reason {
            HoldReason::Obstacle => format!("{by} leaves its path"),
            HoldReason::Stale => format!("{by} sees again"),
        });
    }
    match track.ending.outcome {
        Outcome::Finished | Outcome::Collided | Outcome::Mechanism => None,
        Outcome::Deadlock => Some("one of the robots is moved out by hand".to_owned()),
        Outcome::Held => Some(holders_leave(&blockers(cell, setup, arbiter, robot, last.region?), cell, finished)),
        Outcome::Stopped => match (last.region, last.reason) {
            (Some(region), _) => Some(from_region(cell, setup, region)),
            (None, OverrideReason::Fault(_)) => Some("the input of the monitor is valid again".to_owned()),
            // The obstacle that avoidance stopped for.
            _ => track.ending.by.as_ref().map(|obstacle| format!("{obstacle} moves away")),
        },
    }
}

fn holders_leave(holders: &[RobotId], cell: &Cell, finished: &[bool]) -> String {
    let name = |robot: &RobotId| cell.robots[robot.0].name.as_str();
    let names: Vec<&str> = holders.iter().map(name).collect();
    let leave = match names[..] {
        [] => return "the regions that are granted with it become free".to_owned(),
        [one] => format!("{one} leaves it"),
        _ => format!("{} leave it", names.join(", ")),
    };
    let resting: Vec<&str> = holders.iter().filter(|robot| finished[robot.0]).map(name).collect();
    if resting.is_empty() {
        return leave;
    }
    format!(
        "{leave}: the program of {} is over in the region or its warning zone, and must end beyond it; or `warning` is made smaller",
        resting.join(", ")
    )
}

fn from_region(cell: &Cell, setup: &MonitorSetup, region: CellRegionId) -> String {
    let region = &cell.regions[region.0];
    let mut ways = Vec::new();
    match region.follow {
        Some(Follow::Robot { robot, .. }) => ways.push(format!("{} moves away", cell.robots[robot.0].name)),
        Some(_) => ways.push("it moves away".to_owned()),
        None => {}
    }
    if region.region.life == Life::Temporary {
        ways.push("a program switches it off".to_owned());
    }
    // Without the direction-aware law a robot at override 0 cannot move away either.
    let law = if setup.configuration.laws().direction_aware { "" } else { " (direction_aware = true)" };
    ways.push(format!("the program moves away{law}"));
    ways.join(", or ")
}
