//! Links and joints must make one tree.

use std::path::Path;

use super::{Joint, Link};
use crate::FormatError;
use crate::scan::show;

pub(super) fn check(links: &[Link], joints: &[Joint], file: &Path) -> Result<(), FormatError> {
    let name = |i: usize| show(links[i].name.as_bytes());
    let mut carrier: Vec<Option<usize>> = vec![None; links.len()];
    for (j, joint) in joints.iter().enumerate() {
        if joint.parent == joint.child {
            let what =
                format!("the joint `{}` joins the link `{}` to itself", show(joint.name.as_bytes()), name(joint.child));
            return Err(FormatError::new(file, joint.line, what).hint("two different links as <parent> and <child>"));
        }
        if let Some(first) = carrier[joint.child].replace(j) {
            let what = format!(
                "the link `{}` is already the child of the joint on line {}",
                name(joint.child),
                joints[first].line
            );
            return Err(FormatError::new(file, joint.line, what)
                .hint("one joint for each child; a closed chain is opened at one joint"));
        }
    }
    let roots: Vec<usize> = (0..links.len()).filter(|&i| carrier[i].is_none()).collect();
    if let [first, second, ..] = roots[..] {
        let names: Vec<String> = roots.iter().take(5).map(|&i| format!("`{}`", name(i))).collect();
        let more = if roots.len() > 5 { ", …" } else { "" };
        let what = format!("{} links have no parent: {}{more}; a robot has one root", roots.len(), names.join(", "));
        return Err(FormatError::new(file, links[second].line, what).hint(format!(
            "<joint name=\"…\" type=\"fixed\"><parent link=\"{}\"/><child link=\"{}\"/></joint>",
            name(first),
            name(second)
        )));
    }
    refuse_circles(links, joints, &carrier, file)
}

/// Follows every link towards the root; who never arrives is in a circle, or hangs on one.
fn refuse_circles(links: &[Link], joints: &[Joint], carrier: &[Option<usize>], file: &Path) -> Result<(), FormatError> {
    let mut arrives = vec![false; links.len()];
    for start in 0..links.len() {
        let mut trail = vec![start];
        while let Some(joint) = trail.last().and_then(|&link| carrier[link]).map(|j| &joints[j]) {
            if arrives[joint.parent] {
                break;
            }
            if trail.len() > links.len() {
                let what = format!("the joint `{}` closes a circle of links", show(joint.name.as_bytes()));
                return Err(FormatError::new(file, joint.line, what).hint("a tree: open the circle at one joint"));
            }
            trail.push(joint.parent);
        }
        for link in trail {
            arrives[link] = true;
        }
    }
    Ok(())
}
