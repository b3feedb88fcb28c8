//! The attachment of an object to the robot that holds it, for queries about states.

use elbowroom_cell::Cell;
use elbowroom_diagnostic::Diagnostic;
use elbowroom_kinematics::ChainState;
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::Attachment;

use crate::hand::grip;
use crate::motion::first_grip;

/// Returns how a robot holds an object.
///
/// This is the first grip of the robot's program. If the program never grips the object, it is a grip with robot and
/// object at their start.
///
/// ```
/// use elbowroom_cell::Cell;
/// use elbowroom_robot::{ObjectId, RobotId};
/// use elbowroom_sim::held_object;
/// let cell = Cell::parse("c.toml", r#"
/// version = 1
/// units = { length = "mm", angle = "deg" }
/// [robot.arm]
/// dh = [{ a = 400, min = -170, max = 170, speed = 90 }]
/// links = [{ capsule = { from = [-400, 0, 0], to = [0, 0, 0], radius = 40 } }]
/// [object.part]
/// shape = "box"
/// at = [0, 500, 0]
/// size = [60, 60, 60]
/// [program.arm]
/// steps = [{ move = "joint", to = [90] }, { grip = "part" }]
/// "#)?;
/// let attachment = held_object(&cell, RobotId(0), ObjectId(0))?;
/// assert!((attachment.in_link.translation.x - 0.1).abs() < 1e-12); // in the frame of the link, which is turned by 90 degrees
/// # Ok::<(), elbowroom_diagnostic::Diagnostic>(())
/// ```
///
/// # Errors
/// [`Diagnostic`] if a step before the grip is infeasible, if the place of the object is known only during the run, or
/// if the robot's program never grips the object and the object is too far from the hand at the start.
pub fn held_object(cell: &Cell, robot: RobotId, object: ObjectId) -> Result<Attachment, Diagnostic> {
    let (at, name) = (&cell.robots[robot.0], &cell.objects[object.0].name);
    if let Some(action) = first_grip(cell, robot, object)? {
        return action.attachment.ok_or_else(|| {
            let what = format!(
                "where \"{name}\" is in the hand of \"{}\" is not known before the run: it moves, or another program grips it",
                at.name
            );
            Diagnostic::new(&cell.file, action.line, what).hint("a part that is at rest, and that no other program grips")
        });
    }
    let mut state = ChainState::new(&at.robot.chain);
    state.q.copy_from_slice(&at.start);
    at.robot.chain.forward(&mut state);
    grip(cell, robot, at, object, &cell.objects[object.0].in_world, &state).map_err(|e| {
        let what = format!("robot \"{}\" at its `start`, as no program of it grips \"{name}\": {e}", at.name);
        let hint =
            format!("{{ grip = \"{name}\" }} in [program.{}] where it is within reach, or another `start`", at.name);
        Diagnostic::new(&cell.file, at.line, what).hint(hint)
    })
}
