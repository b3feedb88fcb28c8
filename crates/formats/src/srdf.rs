//! SRDF: the link pairs that are never tested. Groups, states and end effectors are passed over.

use std::path::Path;

use crate::error::Warnings;
use crate::scan::show;
use crate::{FormatError, Warning, source, xml};

/// What an SRDF says about collisions.
#[derive(Debug, Clone, Default)]
pub struct Srdf {
    /// The robot that it is for, where it says so.
    pub robot: Option<String>,
    /// In the file's order.
    pub disabled: Vec<DisabledPair>,
    /// What its user should know.
    pub warnings: Vec<Warning>,
}

/// One `<disable_collisions>`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DisabledPair {
    /// One link.
    pub link1: String,
    /// The other.
    pub link2: String,
    /// Why, in the file's words; empty where it does not say.
    pub reason: String,
    /// Its line.
    pub line: usize,
}

/// Parses an SRDF. `file` is named in messages.
///
/// # Errors
/// Unsound XML, another root element than `<robot>`, pairs without their links.
///
/// ```
/// use elbowroom_formats::srdf;
/// let text = r#"<robot name="arm"><disable_collisions link1="a" link2="b" reason="Adjacent"/></robot>"#;
/// let srdf = srdf::parse(text.as_bytes(), "arm.srdf".as_ref())?;
/// assert_eq!(srdf.disabled[0].reason, "Adjacent");
/// # Ok::<(), elbowroom_formats::FormatError>(())
/// ```
pub fn parse(bytes: &[u8], file: &Path) -> Result<Srdf, FormatError> {
    source::check_content(bytes, file)?;
    let text = source::text(bytes, file)?;
    let document = xml::parse(&text, file)?;
    let root = document.root_element();
    if root.tag_name().name() != "robot" {
        let what = format!("the root element is <{}>, not <robot>", show(root.tag_name().name().as_bytes()));
        return Err(FormatError::new(file, xml::line(root), what).hint("<robot name=\"arm\"> … </robot>"));
    }
    let mut warnings = Warnings::default();
    if xml::child(root, "link").is_some() && xml::child(root, "disable_collisions").is_none() {
        warnings.push(
            Warning::new(file, xml::line(root), "looks like a URDF, not an SRDF")
                .hint("<disable_collisions link1=\"…\" link2=\"…\" reason=\"…\"/>"),
        );
    }
    for node in xml::children(root, "disable_default_collisions") {
        let what = "<disable_default_collisions> is passed over";
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
    let lines = xml::LineIndex::new(&text);
    let disabled = disabled.into_iter().map(|(n, pair)| DisabledPair { line: lines.line(n), ..pair }).collect();
    Ok(Srdf { robot: root.attribute("name").map(str::to_owned), disabled, warnings: warnings.finish(file) })
}
