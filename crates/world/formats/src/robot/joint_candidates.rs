//! The warning about a model without joints, with a template of a joints file.

use std::fmt::Write;
use std::path::Path;

use super::pose_difference::{SAME_POSE, pose_difference};
use super::track_joint::show_vector;
use crate::Diagnostic;
use crate::joints::key;
use crate::names::list_names;
use crate::nodetree::NodeTree;
use elbowroom_spatial::Pose;

/// Largest number of nodes in the template.
const MAX_LISTED: usize = 40;

/// The warning about a tree without joints; empty if a joint could not move any node.
pub(super) fn missing_joints_warning(
    tree: &NodeTree,
    names: &[String],
    file: &Path,
    default_path: &Path,
) -> Vec<Diagnostic> {
    let candidates = candidates(tree);
    if candidates.is_empty() {
        return Vec::new();
    }
    let frames = tree.in_world();
    let what = format!(
        "no joint moves: the model has no tracks that rotate or translate a node, and there is no {}. {} of its {} nodes could \
         be moved by a joint: {}",
        default_path.display(),
        candidates.len(),
        tree.nodes.len(),
        list_names(candidates.iter().map(|&i| names[i].as_str()))
    );
    let mut template = format!("{}, with the nodes that do move, and their axes:\n", default_path.display());
    // Writing to a String cannot fail.
    let _ = writeln!(template, "    units = {{ length = \"m\", angle = \"deg\" }}");
    for &i in candidates.iter().take(MAX_LISTED) {
        let parent = tree.nodes[i].parent.map_or("the world", |p| names[p].as_str());
        let origin = show_vector(frames[i].translation);
        let _ = writeln!(
            template,
            "    [joint.{}]   # on {parent}, origin at {origin} m\n    axis = \"?\"   # x y z -x -y -z or [x, y, z], in the \
             node's frame\n    min = -180\n    max = 180\n    speed = 90",
            key(&names[i])
        );
    }
    if candidates.len() > MAX_LISTED {
        let _ = writeln!(template, "    # and {} more", candidates.len() - MAX_LISTED);
    }
    vec![Diagnostic::new(file, None, what).hint(template.trim_end())]
}

/// Nodes with meshes at or below them that are displaced from their parent, or have several children.
fn candidates(tree: &NodeTree) -> Vec<usize> {
    let mut has_mesh = vec![false; tree.nodes.len()];
    let mut children = vec![0; tree.nodes.len()];
    for (i, node) in tree.nodes.iter().enumerate().rev() {
        has_mesh[i] |= !node.meshes.is_empty();
        if let Some(parent) = node.parent {
            has_mesh[parent] |= has_mesh[i];
            children[parent] += 1;
        }
    }
    let is_displaced = |i: usize| pose_difference(&tree.nodes[i].in_parent, &Pose::IDENTITY) > SAME_POSE;
    let with_mesh = (0..tree.nodes.len()).filter(|&i| has_mesh[i] && tree.nodes[i].parent.is_some());
    with_mesh.filter(|&i| is_displaced(i) || children[i] > 1).collect()
}
