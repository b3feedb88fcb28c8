//! What a program does with an object.

use elbowroom_kinematics::LinkId;
use elbowroom_robot::ObjectId;
use elbowroom_scene::Attachment;

/// A program grips or releases an object.
#[derive(Debug, Clone, PartialEq)]
pub struct GripAction {
    /// The object.
    pub object: ObjectId,
    /// True: grips. False: releases.
    pub grips: bool,
    /// The link that grips.
    pub link: LinkId,
    /// How it is attached from now on. `None` for a release, and where that is known in the run only: the object moves, or
    /// another program grips it too.
    pub attachment: Option<Attachment>,
    /// Line of the step in the cell file.
    pub line: usize,
}

/// The objects that a robot holds after some steps of its program.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct HeldObjects {
    actions: Vec<GripAction>,
}

impl HeldObjects {
    /// Executes a step.
    pub fn apply(&mut self, action: &GripAction) {
        self.actions.retain(|held| held.object != action.object);
        if action.grips {
            self.actions.push(action.clone());
        }
    }

    /// The steps that gripped them.
    pub fn actions(&self) -> &[GripAction] {
        &self.actions
    }

    /// How they are attached; `None` if that is not known of all.
    pub fn attachments(&self) -> Option<Vec<(ObjectId, Attachment)>> {
        self.actions.iter().map(|a| Some((a.object, a.attachment.clone()?))).collect()
    }
}
