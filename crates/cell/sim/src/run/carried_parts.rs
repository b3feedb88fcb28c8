//! Gripping and releasing of objects during a run.

use elbowroom_cell::{Cell, CellRobot};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_kinematics::ChainState;
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{Attachment, FirstContacts};

use crate::hand;
use crate::motion::GripAction;

/// The robots that carry the objects.
#[derive(Debug)]
pub(super) struct CarriedParts<'a> {
    cell: &'a Cell,
    /// Per object its attachment to the robot that carries it; `None` if it is not carried.
    attachments: Vec<Option<Attachment>>,
    /// Per object whether it was ever gripped. A gripped object no longer moves by itself.
    taken: Vec<bool>,
}

impl<'a> CarriedParts<'a> {
    pub fn new(cell: &'a Cell) -> Self {
        let count = cell.objects.len();
        Self { cell, attachments: vec![None; count], taken: vec![false; count] }
    }

    /// True if the object no longer moves by itself.
    pub fn is_taken(&self, object: ObjectId) -> bool {
        self.taken[object.0]
    }

    /// Objects without a source of motion that a program grips.
    pub fn gripped_by_programs(cell: &Cell) -> impl Iterator<Item = ObjectId> + '_ {
        let robots = || (0..cell.robots.len()).map(RobotId);
        let is_gripped = move |o: &ObjectId| robots().any(|r| cell.gripped_objects(r).contains(o));
        let moves = |o: &ObjectId| cell.moving_objects.iter().any(|m| m.object == *o);
        (0..cell.objects.len()).map(ObjectId).filter(is_gripped).filter(move |o| !moves(o))
    }

    /// Name of an object; `robot/part` if a robot carries it.
    pub fn name(&self, object: ObjectId) -> String {
        let name = &self.cell.objects[object.0].name;
        self.carrier(object).map_or_else(|| name.clone(), |r| format!("{}/{name}", self.cell.robots[r.0].name))
    }

    /// The robot that carries an object; `None` if it is not carried.
    pub fn carrier(&self, object: ObjectId) -> Option<RobotId> {
        self.attachments[object.0].as_ref().map(|a| a.robot)
    }

    /// Per object its attachment to the robot that carries it; `None` if it is not carried.
    pub fn attachments(&self) -> &[Option<Attachment>] {
        &self.attachments
    }

    /// A member of a virtual robot holds an object.
    pub fn hold(
        &mut self,
        object: ObjectId,
        attachment: &Attachment,
        checker: &mut FirstContacts<'_>,
        states: &[&ChainState],
    ) {
        checker.attach(object, attachment.clone(), states);
        (self.attachments[object.0], self.taken[object.0]) = (Some(attachment.clone()), true);
    }

    /// Grips or releases an object; `at` is the robot with its present tool.
    ///
    /// # Errors
    /// An error at the line of the step if another robot holds the object, the object moves, or it is too far away.
    pub fn apply(
        &mut self,
        robot: RobotId,
        action: &GripAction,
        t_s: f64,
        at: &CellRobot,
        checker: &mut FirstContacts<'_>,
        states: &[&ChainState],
    ) -> Result<(), Diagnostic> {
        let object = action.object;
        if !action.grips {
            self.attachments[object.0] = None;
            checker.detach(object, states);
            return Ok(());
        }
        let (cell, name) = (self.cell, &self.cell.objects[object.0].name);
        let error = |what: &str| {
            let robot = &cell.robots[robot.0].name;
            Diagnostic::new(&cell.file, action.line, format!("`program.{robot}` {what} (at {t_s:.3} s of the run)"))
        };
        if let Some(carrier) = self.carrier(object) {
            let carrier = &cell.robots[carrier.0].name;
            let what = format!("grips \"{name}\", which robot \"{carrier}\" holds");
            let hint = format!("a `wait` before it, until the program of \"{carrier}\" has released it");
            return Err(error(&what).hint(hint));
        }
        let moves = cell.moving_objects.iter().any(|m| m.object == object && m.is_moving(t_s));
        if moves && !self.taken[object.0] {
            let hint = "a `wait` before it, until the object is at rest";
            return Err(error(&format!("grips \"{name}\", which moves")).hint(hint));
        }
        let pose = checker.object_in_world(object);
        let attachment = hand::grip(cell, robot, at, object, &pose, states[robot.0]).map_err(|e| {
            error(&e.to_string()).hint("a move to the part before it, or the tool and its `tcp` in the robot's table")
        })?;
        checker.attach(object, attachment.clone(), states);
        (self.attachments[object.0], self.taken[object.0]) = (Some(attachment), true);
        Ok(())
    }
}
