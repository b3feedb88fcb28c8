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

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (item, field) = (&self.item, &self.field);
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
