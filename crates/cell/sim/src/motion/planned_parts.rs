//! Places of a cell's objects during the planning of one robot's program.

use elbowroom_cell::{Cell, CellRobot, Follow};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::Attachment;
use elbowroom_spatial::Pose;

use crate::hand::grip;

/// An object during planning. Poses and attachments are unknown if the object moves or another program grips it.
#[derive(Debug, Clone, PartialEq)]
enum PlannedPart {
    /// At a pose in the world; `None` if the pose is unknown.
    Placed(Option<Pose>),
    /// Carried by the robot; `None` if the attachment is unknown.
    Carried(Option<Attachment>),
}

/// A step that cannot be executed: what is wrong, and what to write instead.
pub(super) struct PartError {
    pub message: String,
    pub hint: String,
}

impl PartError {
    fn new(message: String, hint: impl Into<String>) -> Self {
        Self { message, hint: hint.into() }
    }
}

/// The objects of a cell during the planning of one robot's program.
#[derive(Clone)]
pub(super) struct PlannedParts<'a> {
    cell: &'a Cell,
    id: RobotId,
    parts: Vec<PlannedPart>,
}

impl PartialEq for PlannedParts<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.parts == other.parts
    }
}

impl<'a> PlannedParts<'a> {
    pub(super) fn new(cell: &'a Cell, id: RobotId) -> Self {
        let is_known = |o: ObjectId| {
            let moves = cell.moving_objects.iter().any(|m| m.object == o);
            !moves && (0..cell.robots.len()).map(RobotId).all(|r| r == id || !cell.gripped_objects(r).contains(&o))
        };
        let place = |o: usize| PlannedPart::Placed(is_known(ObjectId(o)).then_some(cell.objects[o].in_world));
        Self { cell, id, parts: (0..cell.objects.len()).map(place).collect() }
    }

    /// Grips an object. Returns its attachment, or `None` if that is unknown.
    pub(super) fn grip(
        &mut self,
        object: ObjectId,
        robot: &CellRobot,
        q: &[f64],
    ) -> Result<Option<Attachment>, PartError> {
        let name = &self.cell.objects[object.0].name;
        let followed = self.cell.regions.iter().find(|r| r.follow == Some(Follow::Object(object)));
        if let Some(region) = followed {
            let what = format!("grips \"{name}\", which the region \"{}\" follows", region.region.name);
            return Err(PartError::new(what, "a region that follows the robot's flange, or another part"));
        }
        let PlannedPart::Placed(pose) = self.parts[object.0] else {
            let hint = format!("{{ release = \"{name}\" }} before it (or at the end of a program that repeats)");
            return Err(PartError::new(format!("grips \"{name}\", which it has gripped already"), hint));
        };
        let attachment = pose.map(|pose| grip(self.cell, self.id, robot, object, &pose, &self.state(q))).transpose();
        let closer = "a move to the part before it, or the tool and its `tcp` in the robot's table";
        let attachment = attachment.map_err(|e| PartError::new(e.to_string(), closer))?;
        self.parts[object.0] = PlannedPart::Carried(attachment.clone());
        Ok(attachment)
    }

    pub(super) fn release(&mut self, object: ObjectId, q: &[f64]) -> Result<(), PartError> {
        let PlannedPart::Carried(attachment) = &self.parts[object.0] else {
            let name = &self.cell.objects[object.0].name;
            let what = format!("releases \"{name}\", which it does not hold");
            return Err(PartError::new(what, format!("{{ grip = \"{name}\" }} before it")));
        };
        let pose = attachment.as_ref().map(|a| {
            let link = self.state(q).link_in_root(a.link);
            self.robot().base_in_world * link * a.in_link
        });
        self.parts[object.0] = PlannedPart::Placed(pose);
        Ok(())
    }

    /// Name of an object that one of these links holds.
    pub(super) fn held_by(&self, is_holding: impl Fn(LinkId) -> bool) -> Option<&'a str> {
        let held = self.parts.iter().zip(&self.cell.objects).find(|(part, _)| match part {
            PlannedPart::Carried(Some(attachment)) => is_holding(attachment.link),
            PlannedPart::Carried(None) => true,
            PlannedPart::Placed(_) => false,
        });
        held.map(|(_, object)| object.name.as_str())
    }

    /// Objects whose known pose differs from their start, with that pose.
    pub(super) fn placed(&self) -> Vec<(ObjectId, Pose)> {
        let moved =
            self.parts.iter().zip(&self.cell.objects).enumerate().filter_map(|(i, (part, object))| match part {
                PlannedPart::Placed(Some(pose)) if *pose != object.in_world => Some((ObjectId(i), *pose)),
                _ => None,
            });
        moved.collect()
    }

    /// The objects that the robot carries.
    pub(super) fn carried(&self) -> Result<Vec<(ObjectId, Attachment)>, PartError> {
        let mut carried = Vec::new();
        for (i, part) in self.parts.iter().enumerate() {
            match part {
                PlannedPart::Carried(Some(attachment)) => carried.push((ObjectId(i), attachment.clone())),
                PlannedPart::Carried(None) => {
                    let name = &self.cell.objects[i].name;
                    let what = format!(
                        "where \"{name}\" is in the hand is not known before the run: it moves, or another program grips it"
                    );
                    return Err(PartError::new(what, "a joint or linear move while the robot carries it"));
                }
                PlannedPart::Placed(_) => {}
            }
        }
        Ok(carried)
    }

    fn robot(&self) -> &'a CellRobot {
        &self.cell.robots[self.id.0]
    }

    fn state(&self, q: &[f64]) -> ChainState {
        let chain = &self.robot().robot.chain;
        let mut state = ChainState::new(chain);
        state.q.copy_from_slice(q);
        chain.forward(&mut state);
        state
    }
}
