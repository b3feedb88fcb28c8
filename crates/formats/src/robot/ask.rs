//! Asks the user which nodes move, with a file to fill in.

use std::fmt::Write;
use std::path::Path;

use super::from_tree::{SAME, apart};
use super::motion::show;
use crate::Warning;
use crate::joints::key;
use crate::nodetree::NodeTree;
use elbowroom_spatial::Pose;

/// More nodes than this are not listed.
const MOST: usize = 40;

/// What is ambiguous about a tree that nothing says how to move; empty where no node could be a joint's.
pub(super) fn what_moves(tree: &NodeTree, names: &[String], file: &Path, beside: &Path) -> Vec<Warning> {
    let candidates = candidates(tree);
    if candidates.is_empty() {
        return Vec::new();
    }
    let frames = tree.in_world();
    let what = format!(
        "no joint moves: the model has no tracks that turn or slide a node, and there is no {}. {} of its {} nodes could \
         be moved by a joint: {}",
        beside.display(),
        candidates.len(),
        tree.nodes.len(),
        listed(candidates.iter().map(|&i| names[i].as_str()))
    );
    let mut skeleton = format!("{}, with the nodes that do move, and their axes:\n", beside.display());
    // Writing to a String cannot fail.
    let _ = writeln!(skeleton, "    units = {{ length = \"m\", angle = \"deg\" }}");
    for &i in candidates.iter().take(MOST) {
        let parent = tree.nodes[i].parent.map_or("the world", |p| names[p].as_str());
        let origin = show(frames[i].translation);
        let _ = writeln!(
            skeleton,
            "    [joint.{}]   # on {parent}, origin at {origin} m\n    axis = \"?\"   # x y z -x -y -z or [x, y, z], in the \
             node's frame\n    min = -180\n    max = 180\n    speed = 90",
            key(&names[i])
        );
    }
    if candidates.len() > MOST {
        let _ = writeln!(skeleton, "    # and {} more", candidates.len() - MOST);
    }
    vec![Warning::new(file, None, what).hint(skeleton.trim_end())]
}

/// Nodes with solids on or below them that are not just the solid of the node above.
fn candidates(tree: &NodeTree) -> Vec<usize> {
    let mut solid = vec![false; tree.nodes.len()];
    let mut children = vec![0; tree.nodes.len()];
    for (i, node) in tree.nodes.iter().enumerate().rev() {
        solid[i] |= !node.meshes.is_empty();
        if let Some(parent) = node.parent {
            solid[parent] |= solid[i];
            children[parent] += 1;
        }
    }
    let moved = |i: usize| apart(&tree.nodes[i].in_parent, &Pose::IDENTITY) > SAME;
    let parts = (0..tree.nodes.len()).filter(|&i| solid[i] && tree.nodes[i].parent.is_some());
    parts.filter(|&i| moved(i) || children[i] > 1).collect()
}

/// The first names, and how many more there are.
pub(super) fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<String> = names.map(|n| format!("`{n}`")).collect();
    let more = names.len().saturating_sub(MOST);
    let tail = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{}{tail}", names[..names.len() - more].join(", "))
}
