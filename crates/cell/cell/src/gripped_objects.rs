//! Objects that programs grip, as guarded volumes.

use elbowroom_kinematics::LinkId;
use elbowroom_monitor::{Presence, Volume};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::Attachment;
use elbowroom_spatial::Pose;

use crate::{Cell, ProgramBody, StepAction};

impl Cell {
    /// The objects that a robot grips: by its program, or as a member of a virtual robot.
    pub fn gripped_objects(&self, robot: RobotId) -> Vec<ObjectId> {
        self.grips(robot).into_iter().map(|(object, _)| object).collect()
    }

    /// The objects that a robot grips and the links that grip them, each pair once, in the order of the program.
    pub fn grips(&self, robot: RobotId) -> Vec<(ObjectId, LinkId)> {
        let at = &self.robots[robot.0];
        if let Some(virtual_robot) = self.guidance.virtual_robot_of(robot) {
            return vec![(virtual_robot.work_piece, at.flange)];
        }
        let Some(ProgramBody::Steps(steps)) = at.program.as_ref().map(|p| &p.body) else { return Vec::new() };
        let (mut grips, mut link) = (Vec::new(), at.flange);
        // A repeated program begins with the tool that it ended with.
        for step in steps.iter().chain(steps) {
            match step.action {
                StepAction::Tool(tool) => link = at.payload.tools.get(tool).map_or(link, |t| t.link),
                StepAction::Grip(object) if !grips.contains(&(object, link)) => grips.push((object, link)),
                _ => {}
            }
        }
        grips
    }

    /// Guarded volume of an object that a link of the robot will grip.
    ///
    /// The volume is the shape of the object, or the volume that replaces its mesh, at its pose in the object's frame.
    pub fn gripped_volume(&self, robot: RobotId, object: ObjectId, link: LinkId) -> Volume {
        let (model, o) = (self.robots[robot.0].volumes.unwrap_or_default(), &self.objects[object.0]);
        let (shape, in_link) = model.of_solid(&o.shape, Pose::IDENTITY);
        Volume { in_link, ..Volume::gripped(o.name.clone(), link, shape) }
    }

    /// The guarded volumes of a robot with the objects that it holds, if their attachments are known in advance.
    pub fn volumes_holding<'a>(
        &self,
        robot: RobotId,
        held: impl IntoIterator<Item = &'a (ObjectId, Attachment)>,
    ) -> Vec<Volume> {
        let mut volumes = self.robots[robot.0].guarded_volumes();
        volumes.retain(|v| v.presence != Presence::Detached);
        volumes.extend(held.into_iter().filter(|(_, a)| a.robot == robot).map(|(object, attachment)| {
            let volume = self.gripped_volume(robot, *object, attachment.link);
            Volume { in_link: attachment.in_link * volume.in_link, presence: Presence::Always, ..volume }
        }));
        volumes
    }
}
