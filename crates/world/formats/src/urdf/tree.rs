//! Check that links and joints form one tree.

use std::path::Path;

use super::model::{UrdfJoint, UrdfLink};
use crate::Diagnostic;
use crate::cycles::find_cycles;
use crate::tokens::show_name;

pub(super) fn check(links: &[UrdfLink], joints: &[UrdfJoint], file: &Path) -> Result<(), Diagnostic> {
    let name = |i: usize| show_name(&links[i].name);
    let mut parent_joint: Vec<Option<usize>> = vec![None; links.len()];
    for (j, joint) in joints.iter().enumerate() {
        if joint.parent == joint.child {
            let what =
                format!("the joint `{}` joins the link `{}` to itself", show_name(&joint.name), name(joint.child));
            return Err(Diagnostic::new(file, joint.line, what).hint("two different links as <parent> and <child>"));
        }
        if let Some(first) = parent_joint[joint.child].replace(j) {
            let what = format!(
                "the link `{}` is already the child of the joint on line {}",
                name(joint.child),
                joints[first].line
            );
            return Err(Diagnostic::new(file, joint.line, what)
                .hint("one joint for each child; a closed chain is opened at one joint"));
        }
    }
    let roots: Vec<usize> = (0..links.len()).filter(|&i| parent_joint[i].is_none()).collect();
    if let [first, second, ..] = roots[..] {
        let names: Vec<String> = roots.iter().take(5).map(|&i| format!("`{}`", name(i))).collect();
        let more = if roots.len() > 5 { ", …" } else { "" };
        let what = format!("{} links have no parent: {}{more}; a robot has one root", roots.len(), names.join(", "));
        return Err(Diagnostic::new(file, links[second].line, what).hint(format!(
            "<joint name=\"…\" type=\"fixed\"><parent link=\"{}\"/><child link=\"{}\"/></joint>",
            name(first),
            name(second)
        )));
    }
    refuse_cycles(links, joints, &parent_joint, file)
}

/// Refuses links that are not connected to the root, because they are in a cycle or below one.
fn refuse_cycles(
    links: &[UrdfLink],
    joints: &[UrdfJoint],
    parent_joint: &[Option<usize>],
    file: &Path,
) -> Result<(), Diagnostic> {
    let cycles = find_cycles(links.len(), |link| parent_joint[link].map(|j| joints[j].parent));
    let Some(joint) = cycles.first().and_then(|&link| parent_joint[link]).map(|j| &joints[j]) else { return Ok(()) };
    let what = format!("the joint `{}` closes a cycle of links", show_name(&joint.name));
    Err(Diagnostic::new(file, joint.line, what).hint("a tree: open the cycle at one joint"))
}
