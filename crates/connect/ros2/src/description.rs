//! Descriptions of message types, from which a recording's schema and a type's hash are made.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use sha2::{Digest, Sha256};

/// Type of one value, with the numbers of `type_description_interfaces/msg/FieldType`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ElementType {
    /// Another message, by its name: `std_msgs/msg/Header`.
    Message(&'static str),
    /// A number, a truth value or a string.
    Primitive {
        /// Its number.
        id: u8,
        /// Its name in a `.msg` file.
        name: &'static str,
    },
}

/// Number of values of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Multiplicity {
    /// One.
    One,
    /// Always this many.
    Array(usize),
    /// Any number.
    Sequence,
}

/// The type of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FieldType {
    /// The type of one value.
    pub element: ElementType,
    /// Number of values.
    pub multiplicity: Multiplicity,
}

/// Type number of a nested message.
const NESTED: u8 = 1;
/// Offset added to an element's number for an array; `SEQUENCE` is the offset for a sequence.
const ARRAY: u8 = 48;
const SEQUENCE: u8 = 144;

impl FieldType {
    /// The type of a field with one value.
    pub fn one(element: ElementType) -> Self {
        Self { element, multiplicity: Multiplicity::One }
    }

    fn id(self) -> u8 {
        let element = match self.element {
            ElementType::Message(_) => NESTED,
            ElementType::Primitive { id, .. } => id,
        };
        match self.multiplicity {
            Multiplicity::One => element,
            Multiplicity::Array(_) => element + ARRAY,
            Multiplicity::Sequence => element + SEQUENCE,
        }
    }

    fn capacity(self) -> usize {
        if let Multiplicity::Array(count) = self.multiplicity { count } else { 0 }
    }

    fn nested_name(self) -> &'static str {
        if let ElementType::Message(name) = self.element { name } else { "" }
    }

    /// The type as in a `.msg` file.
    fn source(self) -> String {
        let element = match self.element {
            ElementType::Message(name) => short(name),
            ElementType::Primitive { name, .. } => name.to_owned(),
        };
        match self.multiplicity {
            Multiplicity::One => element,
            Multiplicity::Array(count) => format!("{element}[{count}]"),
            Multiplicity::Sequence => format!("{element}[]"),
        }
    }
}

/// Shortens `std_msgs/msg/Header` to `std_msgs/Header`, as in `.msg` files.
fn short(name: &str) -> String {
    name.replace("/msg/", "/")
}

/// Descriptions of a message and of all messages in it.
#[derive(Debug, Clone, Default)]
pub struct TypeSet {
    types: BTreeMap<&'static str, Vec<(&'static str, FieldType)>>,
}

impl TypeSet {
    /// Adds a type; false if it is already there, with the messages in it.
    pub fn add(&mut self, name: &'static str, fields: &[(&'static str, FieldType)]) -> bool {
        let plain = |field: &'static str| field.strip_prefix("r#").unwrap_or(field);
        let fields = fields.iter().map(|(field, kind)| (plain(field), *kind)).collect();
        self.types.insert(name, fields).is_none()
    }

    /// The schema of a message in a recording (`ros2msg`): its definition, then the definitions of the messages in it.
    pub fn schema(&self, name: &str) -> String {
        let mut text = self.definition(name);
        for other in self.types.keys().filter(|other| **other != name) {
            let _ = write!(text, "{}\nMSG: {}\n{}", "=".repeat(80), short(other), self.definition(other));
        }
        text
    }

    fn definition(&self, name: &str) -> String {
        let fields = self.types.get(name).into_iter().flatten();
        fields.fold(String::new(), |mut text, (field, kind)| {
            let _ = writeln!(text, "{} {field}", kind.source());
            text
        })
    }

    /// The hash of a type (REP 2011): SHA-256 over its description as JSON, with `RIHS01_` before it.
    pub fn hash(&self, name: &str) -> String {
        let others: Vec<String> = self.types.keys().filter(|n| **n != name).map(|n| self.json(n)).collect();
        let json = format!(
            "{{\"type_description\": {}, \"referenced_type_descriptions\": [{}]}}",
            self.json(name),
            others.join(", ")
        );
        Sha256::digest(json.as_bytes()).iter().fold(String::from("RIHS01_"), |mut text, byte| {
            let _ = write!(text, "{byte:02x}");
            text
        })
    }

    /// One description as JSON, with the spaces that are part of the hash.
    fn json(&self, name: &str) -> String {
        let field = |(name, kind): &(&str, FieldType)| {
            format!(
                "{{\"name\": \"{name}\", \"type\": {{\"type_id\": {}, \"capacity\": {}, \"string_capacity\": 0, \
                 \"nested_type_name\": \"{}\"}}}}",
                kind.id(),
                kind.capacity(),
                kind.nested_name()
            )
        };
        let fields: Vec<String> = self.types.get(name).into_iter().flatten().map(field).collect();
        format!("{{\"type_name\": \"{name}\", \"fields\": [{}]}}", fields.join(", "))
    }
}
