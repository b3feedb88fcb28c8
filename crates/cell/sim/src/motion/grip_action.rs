//! Grips and releases by programs, and the objects that a robot holds after them.

use elbowroom_kinematics::LinkId;
use elbowroom_robot::ObjectId;
use elbowroom_scene::Attachment;

/// A grip or a release of an object by a program.
#[derive(Debug, Clone, PartialEq)]
pub struct GripAction {
    /// The object.
    pub object: ObjectId,
    /// True for a grip, false for a release.
    pub grips: bool,
    /// The link that grips.
    pub link: LinkId,
    /// Attachment after a grip.
    ///
    /// `None` for a release, and for a grip whose attachment is known only during the run, because the object moves or
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
    /// Applies a grip or a release.
    pub fn apply(&mut self, action: &GripAction) {
        self.actions.retain(|held| held.object != action.object);
        if action.grips {
            self.actions.push(action.clone());
        }
    }

    /// The steps that gripped the held objects.
    pub fn actions(&self) -> &[GripAction] {
        &self.actions
    }

    /// Attachments of the held objects; `None` unless all of them are known.
    pub fn attachments(&self) -> Option<Vec<(ObjectId, Attachment)>> {
        self.actions.iter().map(|a| Some((a.object, a.attachment.clone()?))).collect()
    }
}
