//! Links that touch where they are joined, which cells do not test, with a warning.

use elbowroom_formats::Diagnostic;
use elbowroom_robot::{GeometryId, JointContact, JointContactKind, Robot, RobotId, joint_contacts};
use elbowroom_scene::{PairEdit, PairRule, PairRules, Selection};

use crate::{Cell, CellRobot};

/// The rules for such links in a cell, with one warning per pair.
pub(crate) fn of_cell(cell: &Cell) -> (PairRules, Vec<Diagnostic>) {
    let (mut rules, mut warnings) = (PairRules::default(), Vec::new());
    for (i, r) in cell.robots.iter().enumerate() {
        let robot = RobotId(i);
        for found in of_robot(r) {
            let [one, other] = [found.a, found.b].map(|link| GeometryId::Link { robot, link });
            // The file of pairs decides whether they are tested.
            if cell.pair_rules.given.decide(one, other) {
                continue;
            }
            let [a, b] = [one, other].map(Selection::from);
            rules.extend([PairRule { a, b, edit: PairEdit::Skip(reason(&r.robot, &found)) }]);
            warnings.push(warning(cell, r, &found));
        }
    }
    (rules, warnings)
}

/// Joint contacts of a robot.
///
/// Tool and load are part of the link that carries them. A pair is omitted if tool or load touch the other link in any
/// sample.
fn of_robot(r: &CellRobot) -> Vec<JointContact> {
    let mut found = joint_contacts(&r.robot, &r.start);
    if !found.is_empty() && r.payload.colliders().next().is_some() {
        let without = joint_contacts(&r.without_payload(), &r.start);
        found.retain(|contact| without.contains(contact));
    }
    found
}

fn warning(cell: &Cell, robot: &CellRobot, found: &JointContact) -> Diagnostic {
    let [a, b] = names(&robot.robot, found);
    let what = format!(
        "robot \"{}\": links `{a}` and `{b}` touch {}: this pair is not tested",
        robot.name,
        reason(&robot.robot, found)
    );
    let hint = format!(
        "ignore = [[\"{a}\", \"{b}\"]] in its table, if they are built so; a row `state = \"tested\"` of `pairs = FILE`, if not"
    );
    Diagnostic::new(&cell.file, robot.line, what).hint(hint)
}

/// Place and frequency of the contact of two links.
pub(crate) fn reason(robot: &Robot, found: &JointContact) -> String {
    let joint = &robot.chain.joints()[found.joint.0].name;
    let JointContact { contacts, samples, .. } = found;
    let [nearest_mm, farthest_mm] = [found.nearest_m.1, found.farthest_m.1].map(|m| (m * 1e3).ceil());
    match found.kind {
        JointContactKind::AtJoint => format!(
            "in all {samples} states sampled in the joint space, and only at `{joint}` (within {farthest_mm} mm of its origin)"
        ),
        JointContactKind::Linkage => format!(
            "in all {samples} states sampled in the joint space, always at `{joint}` (within {nearest_mm} mm of its origin) and in \
             some up to {farthest_mm} mm from it: parts of a linkage, or on one axis, as links that a joint connects"
        ),
        JointContactKind::Pivot => format!(
            "in {contacts} of {samples} states sampled in the joint space, always at the same place of both: the pivot at which mimic \
             joints close a linkage ({farthest_mm} mm from `{joint}` at most)"
        ),
    }
}

fn names<'r>(robot: &'r Robot, found: &JointContact) -> [&'r str; 2] {
    [found.a, found.b].map(|link| robot.chain.links()[link.0].as_str())
}
