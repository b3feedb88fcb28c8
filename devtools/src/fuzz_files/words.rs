//! Numbers on the command line of a fuzzer.

/// The seed if none is given.
pub const SEED: u64 = 0x9e37_79b9_7f4a_7c15;

/// Parses a number of the command line, with a default.
pub fn number(name: &str, word: Option<&&str>, default: Option<u64>) -> Result<u64, String> {
    match (word, default) {
        (Some(word), _) => word.parse().map_err(|_| format!("`{name}` is a whole number, not `{word}`")),
        (None, Some(default)) => Ok(default),
        (None, None) => Err(format!("{name} is missing")),
    }
}
