//! Links that touch where their robot rests, with no solid between them: said, with what to write where it is built so.

use elbowroom_scene::{Robot, pairs};

/// What to say and what to write of each such pair at the joint values `rest` (rad or m). `name` is the robot's in its cell;
/// `None` for a model alone.
pub(crate) fn warnings(robot: &Robot, rest: &[f64], name: Option<&str>) -> impl Iterator<Item = (String, String)> {
    let links = robot.chain.links().to_vec();
    let of_robot = name.map_or_else(String::new, |n| format!("robot \"{n}\": "));
    let (whose, file) = if name.is_some() { ("at its `start`", "srdf = \"FILE\"") } else { ("at rest", "--srdf FILE") };
    pairs::resting_contacts(robot, rest).into_iter().map(move |found| {
        let (a, b) = (&links[found.a.0], &links[found.b.0]);
        let often = if found.always() {
            format!("in all {} states of the joint space that were looked at", found.samples)
        } else {
            format!("in {} of {} states of the joint space", found.contacts, found.samples)
        };
        let what = format!(
            "{of_robot}links `{a}` and `{b}` touch {whose}, and {often}, with no solid between them: every such state \
             counts as a collision (in `run` once they have been apart)"
        );
        (what, disable(a, b, file))
    })
}

/// The line of an SRDF that makes two links no pair.
pub(crate) fn disable(a: &str, b: &str, file: &str) -> String {
    format!(
        "<disable_collisions link1=\"{a}\" link2=\"{b}\" reason=\"Default\"/> in an SRDF, and {file}, where they are \
         built so"
    )
}
