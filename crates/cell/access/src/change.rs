//! A change of a sealed value.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A key of the cell file and its values before and after, as TOML; `None` if it was missing before or is missing
/// now.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// The table: `region.column`, `robot.arm`, `monitor`.
    pub item: String,
    /// The key in it.
    pub field: String,
    /// The sealed value.
    pub before: Option<String>,
    /// The present value.
    pub after: Option<String>,
}

impl Change {
    /// The field for the resolved form of a robot or region, with defaults and files: a checksum.
    pub const RESOLVED: &'static str = "resolved";
    /// Prefix of the fields for the source that a region follows, with its files: a checksum. Unquoted keys of a cell
    /// file contain no space, so it is unique.
    pub const FOLLOWS: &'static str = "follows ";
    /// Prefix of the keys of an object that a region follows: they are sealed with the region.
    pub const OBJECT: &'static str = "object.";

    /// The source of the region, if the field is about the source.
    fn followed(&self) -> Option<&str> {
        self.field.strip_prefix(Self::FOLLOWS)
    }

    /// True for a key of the cell file; false for a checksum of resolved data.
    pub fn is_written(&self) -> bool {
        self.field != Self::RESOLVED && self.followed().is_none()
    }

    /// True for the source of a region, false for the region itself.
    pub fn is_of_source(&self) -> bool {
        self.followed().is_some() || self.field.starts_with("follow.") || self.field.starts_with(Self::OBJECT)
    }
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (item, field) = (&self.item, &self.field);
        if let Some(what) = self.followed() {
            return match (&self.before, &self.after) {
                (None, _) => write!(f, "`{item}`: what it follows, {what}, was not sealed"),
                (_, None) => write!(f, "`{item}`: it no longer follows what was sealed, {what}"),
                _ => write!(f, "`{item}`: what it follows, {what}, is not what was sealed"),
            };
        }
        match (&self.before, &self.after) {
            (Some(_), Some(_)) if field == Self::RESOLVED => {
                write!(f, "`{item}`: a file that it names, or a default, differs from the seal")
            }
            (Some(before), Some(after)) => write!(f, "`{item}`: {field} is {after}, sealed was {before}"),
            (None, Some(_)) if field == Self::RESOLVED => write!(f, "`{item}` was added"),
            (Some(_), None) if field == Self::RESOLVED => write!(f, "`{item}` was removed"),
            (None, Some(after)) => write!(f, "`{item}`: {field} = {after} was added"),
            (Some(before), None) => write!(f, "`{item}`: {field} = {before} was removed"),
            (None, None) => write!(f, "`{item}`: {field} is unchanged"),
        }
    }
}
