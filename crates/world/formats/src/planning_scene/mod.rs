//! Planning scenes of `MoveIt`.
//!
//! Two forms are read: the `.scene` text that the motion planning panel saves, and `moveit_msgs/PlanningScene` as YAML
//! (or JSON), as `rostopic echo` prints it and `MotionBenchMaker` reads it.
//!
//! | read | meaning |
//! | --- | --- |
//! | objects | boxes, spheres, cylinders, meshes, planes; a cone becomes its cylinder |
//! | `fixed_frame_transforms` | frames of the objects; a `.scene` has none |
//! | `allowed_collision_matrix`, `robot_state` | pairs that may touch, joint values, attached objects; a `.scene` has none |
//!
//! Other content is ignored. Content whose obstacles would be missing is refused: an octomap with data, and an object
//! that is not added.

mod scene;
#[cfg(test)]
mod tests;
mod text;
mod yaml_form;

use std::path::Path;

use crate::{Diagnostic, input};

pub use crate::moveit_msgs::types::{AllowedCollisions, AttachedObject, CollisionObject, FixedFrame, JointValue};
pub use scene::PlanningScene;

/// Largest size of a file, bytes. A parsed document takes several times the memory of its text.
const MAX_BYTES: u64 = 64 << 20;

/// Reads a file of at most 64 MiB.
///
/// # Errors
/// The errors of [`parse`], or a file that cannot be read.
pub fn read(path: &Path) -> Result<PlanningScene, Diagnostic> {
    parse(path, &input::read_file(path, MAX_BYTES, "a scene whose meshes have fewer triangles")?)
}

/// Parses a planning scene in either form. The content decides the form.
///
/// `file` is named in messages, and mesh files are relative to it.
///
/// ```
/// use elbowroom_formats::planning_scene;
/// let text = b"workshop\n* table\n1 0 0.35\n0 0 0 1\n1\nbox\n0.6 0.4 0.7\n0 0 0\n0 0 0 1\n0 0 0 0\n0\n.\n";
/// let scene = planning_scene::parse("workshop.scene".as_ref(), text)?;
/// assert_eq!((scene.objects[0].id.as_str(), scene.objects[0].solids[0].1.translation.z), ("table", 0.35));
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
///
/// # Errors
/// [`Diagnostic`] with the line, if the text is not a planning scene.
pub fn parse(file: &Path, bytes: &[u8]) -> Result<PlanningScene, Diagnostic> {
    input::check_content(bytes, file)?;
    let text = input::text(bytes, file)?;
    let mut scene =
        if text::is_scene_text(&text, file) { text::parse(&text, file) } else { yaml_form::parse(&text, file) }?;
    file.clone_into(&mut scene.file);
    Ok(scene)
}
