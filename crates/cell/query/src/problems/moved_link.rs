//! The link that a linear motion moves along its line.

use elbowroom_formats::srdf::Group;
use elbowroom_formats::suggest;
use elbowroom_kinematics::{Chain, JointId, JointKind, LinkId};

use super::messages::{ProblemKey, Result};

/// What to write in the SRDF.
const CHAIN: &str = "<group name=\"arm\"><chain base_link=\"base_link\" tip_link=\"tool0\"/></group> in the SRDF, and its \
                     name as `group_name`";

/// The tip of the group of a request; without such a group the last link that is fixed to what the last planned joint
/// moves.
///
/// # Errors
/// A group or tip that does not exist; planned joints that are not all between the root and that link.
pub(super) fn of_group(
    chain: &Chain,
    groups: &[Group],
    key: ProblemKey<'_>,
    group: &str,
    planned: &[bool],
) -> Result<LinkId> {
    let joints: Vec<JointId> =
        chain.active_joints().iter().zip(planned).filter_map(|(id, planned)| planned.then_some(*id)).collect();
    let last_moved = || {
        let links = joints.iter().map(|id| chain.joints()[id.0].child);
        links.max_by_key(|link| chain.path(*link).len()).map_or_else(|| chain.tip(), |link| last_fixed_to(chain, link))
    };
    let tip = tip_of_group(chain, groups, key, group)?.unwrap_or_else(last_moved);
    let path = chain.path(tip);
    match joints.iter().find(|id| !path.contains(id)) {
        None => Ok(tip),
        Some(other) => {
            let (joint, link) = (&chain.joints()[other.0].name, &chain.links()[tip.0]);
            let what =
                format!("the goal names `{joint}`, which does not move `{link}`, and LIN moves `{link}` straight");
            Err(key.error(what).hint(format!("goals of the joints from the root to `{link}` only, or {CHAIN}")))
        }
    }
}

/// The link with the most joints between it and the root that is fixed to a link; among equals the first in the file.
fn last_fixed_to(chain: &Chain, link: LinkId) -> LinkId {
    let own = chain.path(link);
    let is_fixed = |id: &JointId| chain.joints()[id.0].kind == JointKind::Fixed;
    let mut last = (link, own.len());
    for other in (0..chain.links().len()).map(LinkId) {
        let path = chain.path(other);
        if path.len() > last.1 && path.starts_with(&own) && path[own.len()..].iter().all(is_fixed) {
            last = (other, path.len());
        }
    }
    last.0
}

/// The tip link of a group, if it is a chain.
fn tip_of_group(chain: &Chain, groups: &[Group], key: ProblemKey<'_>, name: &str) -> Result<Option<LinkId>> {
    if name.is_empty() || groups.is_empty() {
        return Ok(None);
    }
    let Some(group) = groups.iter().find(|group| group.name == name) else {
        let known = groups.iter().map(|group| group.name.as_str());
        return Err(key.error(format!("the SRDF has no group `{name}`")).hint(suggest::hint(name, known)));
    };
    let [[_, tip]] = &group.chains[..] else { return Ok(None) };
    let unknown = || {
        let what = format!("the chain of group `{name}` ends at `{tip}`, which is no link of the robot");
        key.error(what).hint(suggest::hint(tip, chain.links().iter().map(String::as_str)))
    };
    chain.link(tip).ok_or_else(unknown).map(Some)
}
