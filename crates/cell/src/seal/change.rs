//! What an edit changed.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A key of the cell file and its values before and after, as TOML; `None` where it was not, or is no longer, there.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// The table: `region.column`, `robot.arm`, `monitor`.
    pub item: String,
    /// The key in it.
    pub field: String,
    /// What was sealed.
    pub before: Option<String>,
    /// What stands there now.
    pub after: Option<String>,
}

/// The field that stands for what a robot or region amounts to with defaults filled in and files read: a checksum.
pub(super) const RESOLVED: &str = "resolved";

/// How a field begins that stands for what a region follows, with the files that it was read from: a checksum. No key of a
/// cell file has a blank, unless it is in quotes.
pub(super) const FOLLOWS: &str = "follows ";

impl Change {
    /// What the region follows, where that is what this is about.
    fn followed(&self) -> Option<&str> {
        self.field.strip_prefix(FOLLOWS)
    }

    /// True for what somebody wrote in the cell file; false for what that, or a file, amounts to.
    pub(super) fn is_written(&self) -> bool {
        self.field != RESOLVED && self.followed().is_none()
    }

    /// True for what carries a region, false for the region itself.
    pub(super) fn is_of_source(&self) -> bool {
        self.followed().is_some() || self.field.starts_with("follow.") || self.field.starts_with(OBJECT)
    }
}

/// How the keys of an object begin that a region follows: they are sealed with the region.
pub(super) const OBJECT: &str = "object.";

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
            (Some(_), Some(_)) if field == RESOLVED => {
                write!(f, "`{item}`: a file that it names, or a default, is not what was sealed")
            }
            (Some(before), Some(after)) => write!(f, "`{item}`: {field} is {after}, sealed was {before}"),
            (None, Some(_)) if field == RESOLVED => write!(f, "`{item}` was added"),
            (Some(_), None) if field == RESOLVED => write!(f, "`{item}` was removed"),
            (None, Some(after)) => write!(f, "`{item}`: {field} = {after} was added"),
            (Some(before), None) => write!(f, "`{item}`: {field} = {before} was removed"),
            (None, None) => write!(f, "`{item}`: {field} is unchanged"),
        }
    }
}
