//! Keys and values of a cell file as canonical TOML.

use std::collections::BTreeMap;

use elbowroom_formats::toml_tables::{Data, Node};

/// A key as TOML writes it.
pub(crate) fn key(name: &str) -> String {
    let is_bare_key = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if is_bare_key { name.to_owned() } else { quoted(name) }
}

fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// A value as canonical TOML: tables in the order of their keys.
pub(crate) fn text(node: &Node) -> String {
    match &node.data {
        Data::Text(t) => quoted(t),
        // -0 and 0 have the same text.
        Data::Number(v) => format!("{}", v + 0.0),
        Data::Flag(b) => b.to_string(),
        Data::Date => "date".into(),
        Data::List(nodes) => format!("[{}]", nodes.iter().map(text).collect::<Vec<_>>().join(", ")),
        Data::Table(entries) => {
            let sorted: BTreeMap<_, _> = entries.iter().map(|e| (key(&e.key), text(&e.node))).collect();
            let pairs: Vec<_> = sorted.iter().map(|(k, v)| format!("{k} = {v}")).collect();
            if pairs.is_empty() { "{}".into() } else { format!("{{ {} }}", pairs.join(", ")) }
        }
    }
}
