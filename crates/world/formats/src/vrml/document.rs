//! The nodes of a file, as written.

use std::collections::HashMap;

/// The content of a file. Nodes refer to each other by index; a cycle is impossible, because `USE` refers to nodes that are
/// complete.
#[derive(Debug, Default)]
pub(super) struct Document<'a> {
    pub(super) nodes: Vec<Node<'a>>,
    /// Nodes outside of other nodes.
    pub(super) top: Vec<usize>,
    /// Line of the first `ROUTE`.
    pub(super) first_route: Option<usize>,
    /// Line of each prototype.
    pub(super) prototypes: HashMap<&'a [u8], usize>,
}

/// A node.
#[derive(Debug)]
pub(super) struct Node<'a> {
    pub(super) kind: &'a [u8],
    /// Name after `DEF`.
    pub(super) name: Option<&'a [u8]>,
    pub(super) line: usize,
    pub(super) fields: Vec<Field<'a>>,
    /// Whether the node, or a node in it, may have a surface.
    pub(super) holds_surface: bool,
}

/// A field of a node.
#[derive(Debug)]
pub(super) struct Field<'a> {
    pub(super) name: &'a [u8],
    pub(super) line: usize,
    pub(super) value: Value<'a>,
}

/// The value of a field.
#[derive(Debug)]
pub(super) enum Value<'a> {
    /// Numbers, texts, `TRUE` or `FALSE`, without brackets; parsed when they are needed.
    Plain {
        text: &'a [u8],
        /// Line on which the text begins.
        line: usize,
    },
    /// Indices of nodes; none for `NULL`.
    Nodes(Vec<usize>),
}

impl Document<'_> {
    /// Whether a node in a field may have a surface.
    pub(super) fn holds_surface(&self, field: &Field<'_>) -> bool {
        matches!(&field.value, Value::Nodes(nodes) if nodes.iter().any(|n| self.nodes[*n].holds_surface))
    }
}

impl<'a> Node<'a> {
    pub(super) fn field(&self, name: &str) -> Option<&Field<'a>> {
        self.fields.iter().find(|f| f.name == name.as_bytes())
    }

    /// The nodes of a field; none if the field is missing.
    pub(super) fn nodes(&self, name: &str) -> &[usize] {
        match self.field(name).map(|f| &f.value) {
            Some(Value::Nodes(nodes)) => nodes,
            _ => &[],
        }
    }
}
