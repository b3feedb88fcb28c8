//! What a virtual robot does, in words.

use elbowroom_cooperation::{HandedOver, Hold, HoldLimit};

use crate::{Cell, CellRobot, CellVirtualRobot};

impl CellVirtualRobot {
    /// Why the work-piece stands, for people.
    pub fn hold_in_words(&self, cell: &Cell, hold: &Hold) -> String {
        match hold {
            Hold::Override => "a monitor has stopped a robot that carries it".to_owned(),
            Hold::Limit(member, limit) => {
                let robot = &cell.robots[self.members[*member].robot.0];
                format!("{} {}", robot.name, limit_in_words(cell, self, robot, limit))
            }
            Hold::Paused => "nothing is desired: the operator is not enabled, or the last row is old".to_owned(),
            Hold::InTheWay(member) => format!("{} is in the way", cell.robots[self.members[*member].robot.0].name),
            Hold::Contact(a, b) => format!("{} and {} would touch", cell.part_name(*a), cell.part_name(*b)),
            Hold::Unproven => "a motion could not be proven free".to_owned(),
            Hold::Input => "a step without a duration".to_owned(),
        }
    }

    /// Why a hand-over was decided, for people.
    pub fn hand_over_in_words(&self, cell: &Cell, handed_over: &HandedOver) -> String {
        let robot = |member: usize| &cell.robots[self.members[member].robot.0];
        let (giver, receiver, reason) = (robot(handed_over.from), robot(handed_over.to), &handed_over.reason);
        let limit =
            reason.limit.map_or_else(|| "goes on".to_owned(), |limit| limit_in_words(cell, self, giver, &limit));
        let can = if reason.limit == Some(HoldLimit::Hidden) { "keeps it in view" } else { "can hold" };
        let holds = if reason.receiver_holds_s.is_finite() {
            format!("{can} {:.1} s", reason.receiver_holds_s)
        } else {
            format!("{can} as long as is foreseen")
        };
        format!(
            "{} {limit} in {:.1} s; {} {holds}; hand-over {:.1} s",
            giver.name, reason.giver_holds_s, receiver.name, reason.takes_s
        )
    }
}

/// What an arm comes to.
fn limit_in_words(cell: &Cell, spec: &CellVirtualRobot, robot: &CellRobot, limit: &HoldLimit) -> String {
    let joint = |index: usize| robot.joint_names().get(index).cloned().unwrap_or_default();
    match *limit {
        HoldLimit::Reach => "comes to the end of its reach".to_owned(),
        HoldLimit::JointRange(index) => format!("comes to the limit of {}", joint(index)),
        HoldLimit::JointSpeed(index) => format!("needs more than the speed of {}", joint(index)),
        HoldLimit::Singularity => "comes near a singularity".to_owned(),
        HoldLimit::Retreat => "could not let go any more".to_owned(),
        HoldLimit::OtherArm => "has no room beside the other robot".to_owned(),
        HoldLimit::Hidden => {
            let camera = spec.view.as_ref().map_or("", |view| view.camera.as_str());
            format!("would hide {} from camera {camera}", cell.objects[spec.work_piece.0].name)
        }
        HoldLimit::Contact(a, b) => format!("would bring {} and {} together", cell.part_name(a), cell.part_name(b)),
    }
}
