//! Names shortened to the width of a column.

/// Shortens a name that is longer than `width` characters to an ellipsis and its end.
pub(crate) fn shortened(name: &str, width: usize) -> String {
    if name.chars().count() <= width {
        return name.to_owned();
    }
    let tail: String = name.chars().skip(name.chars().count() - (width - 1)).collect();
    format!("…{tail}")
}
