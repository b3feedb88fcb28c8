//! XML with the line in every message.

use std::path::Path;

use roxmltree::{Document, Node, ParsingOptions};

use crate::tokens::show;
use crate::{Diagnostic, input};

/// Largest number of nodes, which bounds the memory of the tree (a node takes about 100 bytes).
const MAX_NODES: u32 = 4_000_000;

pub(crate) fn parse<'a>(text: &'a str, file: &Path) -> Result<Document<'a>, Diagnostic> {
    let options = ParsingOptions { nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|e| explain(&e, text, file))
}

fn explain(error: &roxmltree::Error, text: &str, file: &Path) -> Diagnostic {
    let line = error.pos().row as usize;
    let at = |what: String| Diagnostic::new(file, line, what);
    if !text.trim_start().starts_with('<') {
        let first = text.trim_start().lines().next().unwrap_or_default();
        let hint = input::planning_scene_hint(file);
        return Diagnostic::new(file, 1, format!("is not XML: it begins with `{}`", show(first.as_bytes())))
            .hint(hint.unwrap_or_else(|| "an XML file; a URDF begins with <robot name=\"…\">".to_owned()));
    }
    match error {
        roxmltree::Error::UnknownNamespace(prefix, _) if prefix == "xacro" => {
            at("xacro macros that are not expanded".into()).hint(xacro_hint(file))
        }
        roxmltree::Error::UnknownNamespace(prefix, _) => at(format!("the prefix `{prefix}:` is not declared"))
            .hint(format!("xmlns:{prefix}=\"http://{prefix}\" in the root element, or remove the element")),
        roxmltree::Error::DtdDetected => {
            Diagnostic::new(file, None, "has a document type definition").hint("the file without its <!DOCTYPE …>")
        }
        roxmltree::Error::NodesLimitReached => {
            Diagnostic::new(file, None, format!("has more than {MAX_NODES} XML nodes")).hint("a smaller model")
        }
        roxmltree::Error::UnclosedRootNode | roxmltree::Error::UnexpectedEndOfStream => {
            let last = text.lines().count();
            Diagnostic::new(file, last, "the XML ends before its elements are closed; is the file truncated?")
                .hint("the closing tags; or copy the file again")
        }
        roxmltree::Error::InvalidChar(b'"' | b'\'', b'<', _) => {
            at("is not well-formed XML: a `<` inside an attribute's value, or a quotation mark is missing".into())
                .hint("&lt; for a < inside quotation marks")
        }
        _ => at(format!("is not well-formed XML: {}", without_position(&error.to_string())))
            .hint("check the tags around this line"),
    }
}

/// The message without its trailing `at LINE:COLUMN`.
fn without_position(message: &str) -> &str {
    let is_position = |tail: &str| tail.bytes().all(|b| b.is_ascii_digit() || b == b':');
    message.rsplit_once(" at ").filter(|(_, tail)| is_position(tail)).map_or(message, |(what, _)| what)
}

/// The line on which a node begins. For many nodes use [`LineIndex`](crate::tokens::LineIndex).
pub(crate) fn line(node: Node<'_, '_>) -> usize {
    node.document().text_pos_at(node.range().start).row as usize
}

/// The line of an attribute, or of the node if it does not have the attribute.
pub(crate) fn attribute_line(node: Node<'_, '_>, name: &str) -> usize {
    let start = node.attribute_node(name).map_or(node.range().start, |a| a.range().start);
    node.document().text_pos_at(start).row as usize
}

/// Child elements with a local name, in any namespace.
pub(crate) fn children<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |c| c.is_element() && c.tag_name().name() == name)
}

/// The first child element with a local name.
pub(crate) fn child<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> Option<Node<'a, 'i>> {
    children(node, name).next()
}

/// All text directly in a node, even if comments divide it.
pub(crate) fn text<'a>(node: Node<'a, '_>) -> std::borrow::Cow<'a, str> {
    let mut pieces = node.children().filter(Node::is_text).filter_map(|t| t.text());
    match (pieces.next(), pieces.next()) {
        (None, _) => "".into(),
        (Some(only), None) => only.into(),
        (Some(first), Some(second)) => [first, second].into_iter().chain(pieces).collect::<Vec<_>>().join(" ").into(),
    }
}

/// Escapes a text for the value of an attribute.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The command that expands a xacro file: to `arm.urdf`, from `arm.xacro` or `arm.urdf.xacro`.
pub(crate) fn xacro_hint(file: &Path) -> String {
    let stem = input::stem(file);
    let stem = stem.strip_suffix(".urdf").unwrap_or(&stem);
    let mut urdf = file.with_file_name(format!("{stem}.urdf"));
    // A xacro file may have the extension .urdf.
    if urdf == file {
        urdf = file.with_file_name(format!("{stem}.expanded.urdf"));
    }
    format!("run `xacro {} > {}` and name its output", input::shell_word(file), input::shell_word(&urdf))
}
