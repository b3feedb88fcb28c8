//! Checks of `--frames`, and of robots that a user may believe to be guarded by a sensor.

use elbowroom_cell::{Cell, CellSensor, SensorKind};
use elbowroom_robot::RobotId;

use super::frame_inputs::FrameInput;
use crate::service_error::ServiceError;

/// Checks that each source belongs to a sensor that guards one of the simulated robots, and no other source to the same.
///
/// # Errors
/// [`ServiceError::Frames`] for the first one that does not.
pub(crate) fn check_frames(
    cell: &Cell,
    simulated: &[RobotId],
    frames: &[(String, FrameInput)],
) -> Result<(), ServiceError> {
    let guards = |s: &&CellSensor| s.robots.iter().any(|robot| simulated.contains(robot));
    for (i, (name, source)) in frames.iter().enumerate() {
        let refuse = |why: String| Err(ServiceError::Frames { sensor: name.clone(), why });
        let Some(sensor) = cell.sensors.iter().filter(guards).find(|s| s.name == *name) else {
            let known: Vec<&str> = cell.sensors.iter().filter(guards).map(|s| s.name.as_str()).collect();
            let one_of = if known.is_empty() { "none of the cell does".to_owned() } else { known.join(", ") };
            return refuse(format!(
                "no sensor of this name guards a simulated robot of this process\n  help: {one_of}"
            ));
        };
        if !matches!(sensor.kind, SensorKind::Camera { .. }) && *source != FrameInput::Key {
            return refuse(format!("clouds do not come from a pipe\n  help: --frames {name}=key"));
        }
        let before = &frames[..i];
        if before.iter().any(|(other, _)| other == name) {
            return refuse("is given twice\n  help: one source".to_owned());
        }
        if *source != FrameInput::Key && before.iter().any(|(_, other)| other == source) {
            return refuse("has the source of another sensor\n  help: a pipe of its own".to_owned());
        }
    }
    Ok(())
}

/// A warning per sensor that guards robots whose controllers are not simulated.
pub(crate) fn unguarded(cell: &Cell, real: impl Iterator<Item = RobotId>) -> impl Iterator<Item = String> {
    let real: Vec<RobotId> = real.collect();
    cell.sensors.iter().filter_map(move |sensor| {
        let names = sensor.robots.iter().filter(|robot| real.contains(robot)).map(|robot| &*cell.robots[robot.0].name);
        let names: Vec<&str> = names.collect();
        (!names.is_empty()).then(|| {
            format!(
                "warning: {} \"{}\" does not guard {}: only simulated controllers avoid what sensors see",
                sensor.table(),
                sensor.name,
                names.join(", ")
            )
        })
    })
}
