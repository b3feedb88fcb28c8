//! Parser of the text of an SRDF.

use std::collections::HashSet;
use std::path::Path;

use roxmltree::Node;

use super::model::{DisabledPair, EndEffector, Group, GroupState, Srdf, VirtualJoint};
use crate::tokens::{LineIndex, show};
use crate::warning_list::WarningList;
use crate::{Diagnostic, input, xml};

/// Elements that are read, and elements that have no effect here.
const READ: [&str; 6] =
    ["group", "group_state", "end_effector", "virtual_joint", "passive_joint", "disable_collisions"];
const WITHOUT_EFFECT: [&str; 2] = ["link_sphere_approximation", "joint_property"];

/// Parses an SRDF. `file` is named in messages. Elements with other names give a warning.
///
/// # Errors
/// [`Diagnostic`] for malformed XML, a root element other than `<robot>`, or pairs without their links.
///
/// ```
/// use elbowroom_formats::srdf;
/// let text = r#"<robot name="arm"><disable_collisions link1="a" link2="b" reason="Adjacent"/></robot>"#;
/// let srdf = srdf::parse(text.as_bytes(), "arm.srdf".as_ref())?;
/// assert_eq!(srdf.disabled[0].reason, "Adjacent");
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
pub fn parse(bytes: &[u8], file: &Path) -> Result<Srdf, Diagnostic> {
    input::check_content(bytes, file)?;
    let text = input::text(bytes, file)?;
    let document = xml::parse(&text, file)?;
    let root = document.root_element();
    if root.tag_name().name() != "robot" {
        let what = format!("the root element is <{}>, not <robot>", show(root.tag_name().name().as_bytes()));
        return Err(Diagnostic::new(file, xml::line(root), what).hint("<robot name=\"arm\"> … </robot>"));
    }
    let mut reader = Reader { file, warnings: WarningList::default() };
    let is_urdf = xml::child(root, "link").is_some() && xml::child(root, "disable_collisions").is_none();
    if is_urdf {
        let hint = "<disable_collisions link1=\"…\" link2=\"…\" reason=\"…\"/>";
        reader.warnings.push(Diagnostic::new(file, xml::line(root), "is a URDF rather than an SRDF").hint(hint));
    } else {
        reader.report_ignored(root);
    }
    let mut disabled = Vec::new();
    for node in xml::children(root, "disable_collisions") {
        disabled.push((node, disabled_pair(node, file)?));
    }
    let lines = LineIndex::new(&text);
    let line = |node: Node<'_, '_>| lines.line_at(node.range().start);
    let disabled = disabled.into_iter().map(|(node, pair)| DisabledPair { line: line(node), ..pair }).collect();
    let passive = xml::children(root, "passive_joint").filter_map(|node| reader.attribute(node, "name"));
    let passive_joints = passive.collect();
    Ok(Srdf {
        robot: root.attribute("name").map(str::to_owned),
        groups: if is_urdf {
            Vec::new()
        } else {
            xml::children(root, "group").filter_map(|n| reader.group(n)).collect()
        },
        states: xml::children(root, "group_state").filter_map(|n| reader.state(n)).collect(),
        end_effectors: xml::children(root, "end_effector").filter_map(|n| reader.end_effector(n)).collect(),
        virtual_joints: xml::children(root, "virtual_joint").filter_map(|n| reader.virtual_joint(n)).collect(),
        passive_joints,
        disabled,
        warnings: reader.warnings.finish(file),
    })
}

fn disabled_pair(node: Node<'_, '_>, file: &Path) -> Result<DisabledPair, Diagnostic> {
    let link = |attribute: &str| {
        node.attribute(attribute).map(|n| n.trim().to_owned()).filter(|n| !n.is_empty()).ok_or_else(|| {
            Diagnostic::new(file, xml::line(node), format!("<disable_collisions> has no {attribute}"))
                .hint("<disable_collisions link1=\"…\" link2=\"…\" reason=\"Never\"/>")
        })
    };
    let reason = node.attribute("reason").unwrap_or_default().to_owned();
    Ok(DisabledPair { link1: link("link1")?, link2: link("link2")?, reason, line: 0 })
}

/// An example of a valid element, for messages.
fn example(element: &str) -> &'static str {
    match element {
        "group" | "link" | "chain" => "<group name=\"arm\"><chain base_link=\"base_link\" tip_link=\"tool0\"/></group>",
        "end_effector" => "<end_effector name=\"hand\" parent_link=\"tool0\" group=\"hand\"/>",
        "virtual_joint" => {
            "<virtual_joint name=\"base\" type=\"fixed\" parent_frame=\"world\" child_link=\"base_link\"/>"
        }
        "passive_joint" => "<passive_joint name=\"joint_7\"/>",
        _ => "<group_state name=\"home\" group=\"arm\"><joint name=\"joint_1\" value=\"0\"/></group_state>",
    }
}

/// Reader of elements. Incomplete parts of an element are skipped with a warning.
struct Reader<'a> {
    file: &'a Path,
    warnings: WarningList,
}

impl Reader<'_> {
    /// Warns once about each kind of element that is not read.
    fn report_ignored(&mut self, root: Node<'_, '_>) {
        let mut known: HashSet<&str> = READ.into_iter().chain(WITHOUT_EFFECT).collect();
        for node in root.children().filter(Node::is_element) {
            let name = node.tag_name().name();
            if known.insert(name) {
                let what = || format!("<{}> is ignored", show(name.as_bytes()));
                let hint = if name == "disable_default_collisions" {
                    "one <disable_collisions> for each pair"
                } else {
                    "<group>, <group_state>, <end_effector>, <virtual_joint> and <disable_collisions> are read"
                };
                self.warnings.push_with(|| Diagnostic::new(self.file, xml::line(node), what()).hint(hint));
            }
        }
    }

    /// A non-empty attribute.
    fn attribute(&mut self, node: Node<'_, '_>, name: &str) -> Option<String> {
        let found = node.attribute(name).map(|text| text.trim().to_owned()).filter(|text| !text.is_empty());
        if found.is_none() {
            let element = node.tag_name().name();
            let what = || format!("<{element}> has no {name}: ignored");
            self.warnings.push_with(|| Diagnostic::new(self.file, xml::line(node), what()).hint(example(element)));
        }
        found
    }

    /// The names of child elements.
    fn names(&mut self, node: Node<'_, '_>, element: &'static str) -> Vec<String> {
        xml::children(node, element).filter_map(|child| self.attribute(child, "name")).collect()
    }

    fn group(&mut self, node: Node<'_, '_>) -> Option<Group> {
        let chain = |reader: &mut Self, child| {
            Some([reader.attribute(child, "base_link")?, reader.attribute(child, "tip_link")?])
        };
        Some(Group {
            name: self.attribute(node, "name")?,
            links: self.names(node, "link"),
            joints: self.names(node, "joint"),
            chains: xml::children(node, "chain").filter_map(|child| chain(self, child)).collect(),
            subgroups: self.names(node, "group"),
        })
    }

    fn state(&mut self, node: Node<'_, '_>) -> Option<GroupState> {
        let name = self.attribute(node, "name")?;
        let mut values = Vec::new();
        for joint in xml::children(node, "joint") {
            let (Some(joint_name), Some(text)) = (self.attribute(joint, "name"), self.attribute(joint, "value")) else {
                continue;
            };
            // A chain has no joints with several values, such as planar joints.
            values.extend(text.parse::<f64>().ok().filter(|v| v.is_finite()).map(|value| (joint_name, value)));
        }
        Some(GroupState { name, group: node.attribute("group").unwrap_or_default().to_owned(), values })
    }

    fn end_effector(&mut self, node: Node<'_, '_>) -> Option<EndEffector> {
        Some(EndEffector {
            name: self.attribute(node, "name")?,
            group: self.attribute(node, "group")?,
            parent_link: self.attribute(node, "parent_link")?,
            parent_group: node.attribute("parent_group").map(str::to_owned),
        })
    }

    fn virtual_joint(&mut self, node: Node<'_, '_>) -> Option<VirtualJoint> {
        Some(VirtualJoint {
            name: self.attribute(node, "name")?,
            kind: self.attribute(node, "type")?,
            parent_frame: self.attribute(node, "parent_frame")?,
            child_link: self.attribute(node, "child_link")?,
        })
    }
}
