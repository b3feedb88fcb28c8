//! Files of fuzzy rules.

use std::path::Path;

use elbowroom_avoidance::Rules;
use elbowroom_formats::Diagnostic;

/// The rules of avoidance in the text of a file.
///
/// ```
/// use elbowroom_cell::parse_rules;
/// let refused = parse_rules("rules.toml", "[input.proximity]\nrange = 5").unwrap_err();
/// assert_eq!(refused.line, Some(2));
/// ```
///
/// # Errors
/// What is wrong, with the line of the file.
pub fn parse_rules(file: impl AsRef<Path>, text: &str) -> Result<Rules, Diagnostic> {
    Rules::from_toml(text).map_err(|e| Diagnostic::new(file, e.line, e.message).hint(e.hint))
}
