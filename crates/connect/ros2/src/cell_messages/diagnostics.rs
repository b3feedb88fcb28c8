//! Diagnostics: the reasons why robots are slow.

use elbowroom_status::{CellStatus, RobotStatus, SlotStatus};

use crate::message::Byte;
use crate::msgs::builtin_interfaces::Time;
use crate::msgs::diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue};
use crate::msgs::std_msgs::Header;

/// Makes a status per robot and per group of exchange regions.
pub(super) fn diagnostics(status: &CellStatus, stamp: &Time) -> DiagnosticArray {
    let robots = status.robots.iter().map(|robot| of_robot(robot, &status.checksum));
    DiagnosticArray {
        header: Header { stamp: stamp.clone(), frame_id: String::new() },
        status: robots.chain(status.slots.iter().map(of_slot)).collect(),
    }
}

fn of_robot(robot: &RobotStatus, checksum: &str) -> DiagnosticStatus {
    let mut values = vec![
        KeyValue::new("override", robot.speed_override),
        KeyValue::new("reason", &robot.reason),
        KeyValue::new("region", robot.region.as_deref().unwrap_or_default()),
    ];
    if let Some(point) = &robot.governing {
        values.push(KeyValue::new("part", &point.part));
        values.push(KeyValue::new("distance_m", point.distance_m));
    }
    values.push(KeyValue::new("outputs", format!("{:#x}", robot.outputs)));
    for (name, cell) in &robot.grids {
        values.push(KeyValue::new(&format!("grid {name}"), cell));
    }
    let exchange = robot.exchange.iter().map(|(region, state)| KeyValue::new(&format!("exchange {region}"), state));
    values.extend(exchange);
    values.push(KeyValue::new("checksum", checksum));
    DiagnosticStatus {
        level: level(robot),
        name: format!("elbowroom: {}", robot.robot),
        message: format!("override {:.0} %: {}", 1e2 * robot.speed_override, robot.reason),
        hardware_id: robot.robot.clone(),
        values,
    }
}

/// Returns the level: OK if the robot is free, ERROR if it stops without a region, otherwise WARN.
fn level(robot: &RobotStatus) -> Byte {
    match (&robot.region, robot.reason.as_str()) {
        (None, "free") => DiagnosticStatus::OK,
        (None, _) if robot.speed_override == 0.0 => DiagnosticStatus::ERROR,
        _ => DiagnosticStatus::WARN,
    }
}

fn of_slot(slot: &SlotStatus) -> DiagnosticStatus {
    let message = match (&slot.holder, slot.queue.is_empty()) {
        (None, true) => "free".to_owned(),
        (Some(holder), true) => format!("held by {holder}"),
        (holder, false) => {
            let holder = holder.as_deref().unwrap_or("nobody");
            format!("held by {holder}, waiting: {}", slot.queue.join(", "))
        }
    };
    DiagnosticStatus {
        level: if slot.queue.is_empty() { DiagnosticStatus::OK } else { DiagnosticStatus::WARN },
        name: format!("elbowroom: exchange {}", slot.regions.join(", ")),
        message,
        hardware_id: String::new(),
        values: vec![
            KeyValue::new("holder", slot.holder.as_deref().unwrap_or_default()),
            KeyValue::new("queue", slot.queue.join(", ")),
        ],
    }
}
