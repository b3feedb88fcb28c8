//! SRDF: the link pairs that are not tested, and named states. Groups and end effectors are ignored.

use std::fmt::Write;
use std::path::Path;

use roxmltree::Node;

use crate::error::WarningList;
use crate::tokens::{LineIndex, show};
use crate::{FormatError, Warning, input, xml};

/// The collision settings of an SRDF.
#[derive(Debug, Clone, Default)]
pub struct Srdf {
    /// Name of the robot, where it is stated.
    pub robot: Option<String>,
    /// In the file's order.
    pub disabled: Vec<DisabledPair>,
    /// Named states of groups, in the file's order.
    pub states: Vec<GroupState>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

/// One `<group_state>`: values of the joints of a group.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupState {
    /// Its name. States of several groups may share one.
    pub name: String,
    /// The group.
    pub group: String,
    /// Joints and their values, rad or m.
    pub values: Vec<(String, f64)>,
}

/// One `<disable_collisions>`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DisabledPair {
    /// The first link.
    pub link1: String,
    /// The second link.
    pub link2: String,
    /// The reason as written; empty where none is stated.
    pub reason: String,
    /// Its line in the file.
    pub line: usize,
}

/// Parses an SRDF. `file` is named in messages.
///
/// # Errors
/// Malformed XML, another root element than `<robot>`, pairs without their links.
///
/// ```
/// use elbowroom_formats::srdf;
/// let text = r#"<robot name="arm"><disable_collisions link1="a" link2="b" reason="Adjacent"/></robot>"#;
/// let srdf = srdf::parse(text.as_bytes(), "arm.srdf".as_ref())?;
/// assert_eq!(srdf.disabled[0].reason, "Adjacent");
/// # Ok::<(), elbowroom_formats::FormatError>(())
/// ```
pub fn parse(bytes: &[u8], file: &Path) -> Result<Srdf, FormatError> {
    input::check_content(bytes, file)?;
    let text = input::text(bytes, file)?;
    let document = xml::parse(&text, file)?;
    let root = document.root_element();
    if root.tag_name().name() != "robot" {
        let what = format!("the root element is <{}>, not <robot>", show(root.tag_name().name().as_bytes()));
        return Err(FormatError::new(file, xml::line(root), what).hint("<robot name=\"arm\"> … </robot>"));
    }
    let mut warnings = WarningList::default();
    if xml::child(root, "link").is_some() && xml::child(root, "disable_collisions").is_none() {
        warnings.push(
            Warning::new(file, xml::line(root), "is a URDF rather than an SRDF")
                .hint("<disable_collisions link1=\"…\" link2=\"…\" reason=\"…\"/>"),
        );
    }
    for node in xml::children(root, "disable_default_collisions") {
        let what = "<disable_default_collisions> is ignored";
        warnings.push_with(|| Warning::new(file, xml::line(node), what).hint("one <disable_collisions> for each pair"));
    }
    let mut disabled = Vec::new();
    for node in xml::children(root, "disable_collisions") {
        let link = |attribute: &str| {
            node.attribute(attribute).map(|n| n.trim().to_owned()).filter(|n| !n.is_empty()).ok_or_else(|| {
                FormatError::new(file, xml::line(node), format!("<disable_collisions> has no {attribute}"))
                    .hint("<disable_collisions link1=\"…\" link2=\"…\" reason=\"Never\"/>")
            })
        };
        let reason = node.attribute("reason").unwrap_or_default().to_owned();
        disabled.push((node, DisabledPair { link1: link("link1")?, link2: link("link2")?, reason, line: 0 }));
    }
    let states = xml::children(root, "group_state").filter_map(|node| group_state(node, file, &mut warnings)).collect();
    let lines = LineIndex::new(&text);
    let line = |node: Node<'_, '_>| lines.line_at(node.range().start);
    let disabled = disabled.into_iter().map(|(node, pair)| DisabledPair { line: line(node), ..pair }).collect();
    Ok(Srdf { robot: root.attribute("name").map(str::to_owned), disabled, states, warnings: warnings.finish(file) })
}

/// A named state; what of it is incomplete is left out, with a warning.
fn group_state(node: Node<'_, '_>, file: &Path, warnings: &mut WarningList) -> Option<GroupState> {
    const EXAMPLE: &str =
        "<group_state name=\"home\" group=\"arm\"><joint name=\"joint_1\" value=\"0\"/></group_state>";
    let mut attribute = |node: Node<'_, '_>, name: &str| {
        let found = node.attribute(name).map(|text| text.trim().to_owned());
        if found.is_none() {
            let what = || format!("<{}> has no {name}: ignored", node.tag_name().name());
            warnings.push_with(|| Warning::new(file, xml::line(node), what()).hint(EXAMPLE));
        }
        found
    };
    let name = attribute(node, "name")?;
    let mut values = Vec::new();
    for joint in xml::children(node, "joint") {
        let (Some(joint_name), Some(text)) = (attribute(joint, "name"), attribute(joint, "value")) else { continue };
        // Joints of several values, such as planar ones, are none of a chain.
        values.extend(text.parse::<f64>().ok().filter(|v| v.is_finite()).map(|value| (joint_name, value)));
    }
    Some(GroupState { name, group: node.attribute("group").unwrap_or_default().to_owned(), values })
}

/// The text of an SRDF that disables pairs of links, each with its reason; comments follow.
///
/// ```
/// use elbowroom_formats::srdf;
/// let text = srdf::text("arm", [["a", "b", "Adjacent"]], &["c and d are still tested".to_owned()]);
/// assert_eq!(srdf::parse(text.as_bytes(), "arm.srdf".as_ref())?.disabled[0].link2, "b");
/// assert!(text.contains("<!-- c and d are still tested -->"));
/// # Ok::<(), elbowroom_formats::FormatError>(())
/// ```
pub fn text<'p>(robot: &str, pairs: impl IntoIterator<Item = [&'p str; 3]>, comments: &[String]) -> String {
    let mut out = format!("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n", xml::escaped(robot));
    for [link1, link2, reason] in pairs {
        let [link1, link2, reason] = [link1, link2, reason].map(xml::escaped);
        // Writing to a String cannot fail.
        let _ = writeln!(out, "  <disable_collisions link1=\"{link1}\" link2=\"{link2}\" reason=\"{reason}\"/>");
    }
    for comment in comments {
        // Two hyphens would end the comment.
        let _ = writeln!(out, "  <!-- {} -->", comment.replace("--", "- -"));
    }
    out.push_str("</robot>\n");
    out
}
