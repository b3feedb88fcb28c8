//! Contacts in the rest pose: warnings of links that touch without a collider between them, with the SRDF entry that
//! disables such a pair.

use elbowroom_kinematics::LinkId;
use elbowroom_robot::Robot;
use elbowroom_robot::rest_pose_contacts;

/// The warning and the hint for each new pair of this kind at the joint values `rest` (rad or m).
///
/// `name` is the robot's name in its cell; `None` for a single model.
pub(crate) fn warnings(
    robot: &Robot,
    rest: &[f64],
    name: Option<&str>,
    is_new: impl Fn(LinkId, LinkId) -> bool,
) -> impl Iterator<Item = (String, String)> {
    let links = robot.chain.links().to_vec();
    let of_robot = name.map_or_else(String::new, |n| format!("robot \"{n}\": "));
    let in_cell = name.is_some();
    let whose = if in_cell { "at its `start`" } else { "at rest" };
    rest_pose_contacts(robot, rest).into_iter().filter(move |found| is_new(found.a, found.b)).map(move |found| {
        let (a, b) = (&links[found.a.0], &links[found.b.0]);
        let often = if found.always() {
            format!("in all {} states sampled in the joint space", found.samples)
        } else {
            format!("in {} of {} states sampled in the joint space", found.contacts, found.samples)
        };
        let what = format!(
            "{of_robot}links `{a}` and `{b}` touch {whose}, and {often}, with no link with collision geometry between them: every such state \
             counts as a collision (in `run` once they have been apart)"
        );
        let hint = if in_cell { ignore_entry(a, b) } else { srdf_entry(a, b, "--srdf FILE") };
        (what, hint)
    })
}

/// The key of a robot in a cell file that leaves a pair of links out.
fn ignore_entry(a: &str, b: &str) -> String {
    format!("ignore = [[\"{a}\", \"{b}\"]] in its table, if they are built so (or a line of an SRDF)")
}

/// The SRDF entry that disables a pair of links.
pub(crate) fn srdf_entry(a: &str, b: &str, file: &str) -> String {
    format!(
        "<disable_collisions link1=\"{a}\" link2=\"{b}\" reason=\"Default\"/> in an SRDF, and {file}, if they are \
         built so"
    )
}
