//! The link that carries the tool.

use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_kinematics::{Chain, JointId, LinkId};

/// Names of tool frames (ROS-Industrial), in order of preference.
const NAMES: [&str; 2] = ["tool0", "flange"];

/// The link that the key `flange` names; otherwise `tool0`, `flange`, or the leaf with the most joints above it.
///
/// If that leaf is one of several fingers, the link that carries the fingers, with a warning.
pub(super) fn read(
    robot: &str,
    t: &Table<'_>,
    chain: &Chain,
    warnings: &mut Vec<Diagnostic>,
) -> Result<LinkId, Diagnostic> {
    if let Some(v) = t.get("flange") {
        let name = v.text()?;
        return chain.link(name).ok_or_else(|| unknown_link(&v, name, chain));
    }
    if let Some(known) = NAMES.into_iter().find_map(|name| chain.link(name)) {
        return Ok(known);
    }
    let tip = chain.tip();
    let Some(palm) = carrier_of_fingers(chain, tip) else { return Ok(tip) };
    let name = |link: LinkId| &chain.links()[link.0];
    let leaves: Vec<&str> =
        chain.leaves().into_iter().filter(|l| is_below(chain, *l, palm)).map(|l| &name(l)[..]).collect();
    let what = format!(
        "robot \"{robot}\": its TCP is on `{}`, which carries {}, as the model has no link `tool0` or `flange`",
        name(palm),
        leaves.join(" and ")
    );
    warnings.push(Diagnostic::new(t.file, t.line, what).hint(format!("flange = \"{}\", or another link", name(palm))));
    Ok(palm)
}

/// The link that carries a leaf and other links on separate moving joints.
fn carrier_of_fingers(chain: &Chain, leaf: LinkId) -> Option<LinkId> {
    let moves = |joint: JointId| chain.joints()[joint.0].kind.moves();
    // Fixed joints may follow the joint of the finger.
    let finger = chain.path(leaf).into_iter().rfind(|&joint| moves(joint))?;
    let palm = chain.joints()[finger.0].parent;
    let is_other = |joint: JointId| {
        let child = chain.joints()[joint.0].child;
        joint != finger && moves(joint) && is_below(chain, child, palm)
    };
    (0..chain.joints().len()).map(JointId).any(is_other).then_some(palm)
}

/// True if a link is below another one in the chain.
fn is_below(chain: &Chain, link: LinkId, above: LinkId) -> bool {
    chain.path(link).iter().any(|joint| chain.joints()[joint.0].parent == above)
}

/// The error for an unknown link, with the links of the chain.
pub(super) fn unknown_link(v: &Value<'_>, name: &str, chain: &Chain) -> Diagnostic {
    let hint = suggest::hint(name, chain.links().iter().map(String::as_str));
    v.error(format!("names the link \"{name}\", which robot \"{}\" does not have", chain.name())).hint(hint)
}
