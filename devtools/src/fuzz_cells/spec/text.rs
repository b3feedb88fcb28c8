//! Numbers as TOML.

pub type Vector = [f64; 3];

/// Formats a list as `[1, 2, 3]`.
pub fn list(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
    format!("[{}]", numbers.join(", "))
}
