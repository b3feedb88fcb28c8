//! SHA-256 over the exact bits of answers.

use std::fmt::Write as _;

use sha2::{Digest as _, Sha256};

/// A hash of answers in their order. Every item has a fixed size or its length before it: different answers have
/// different bytes.
#[derive(Debug, Clone, Default)]
pub struct Digest(Sha256);

impl Digest {
    /// Adds the bits of a number: 0.0 and -0.0 differ, and so do two NaN with different bits.
    pub fn number(&mut self, value: f64) {
        self.0.update(value.to_bits().to_le_bytes());
    }

    pub fn numbers(&mut self, values: impl IntoIterator<Item = f64>) {
        values.into_iter().for_each(|value| self.number(value));
    }

    /// Adds a number that may be missing.
    pub fn some_number(&mut self, value: Option<f64>) {
        self.flag(value.is_some());
        self.numbers(value);
    }

    pub fn whole(&mut self, value: usize) {
        self.0.update((value as u64).to_le_bytes());
    }

    pub fn flag(&mut self, value: bool) {
        self.0.update([u8::from(value)]);
    }

    pub fn text(&mut self, value: &str) {
        self.whole(value.len());
        self.0.update(value.as_bytes());
    }

    /// Returns 64 hexadecimal digits.
    pub fn hex(self) -> String {
        let mut digits = String::new();
        for byte in self.0.finalize() {
            let _ = write!(digits, "{byte:02x}");
        }
        digits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hex(fill: impl FnOnce(&mut Digest)) -> String {
        let mut digest = Digest::default();
        fill(&mut digest);
        digest.hex()
    }

    #[test]
    fn every_bit_counts() {
        let empty = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
        assert_eq!(hex(|_| {}), empty);
        assert_eq!(hex(|d| d.number(0.1)), hex(|d| d.number(0.1)));
        assert_ne!(hex(|d| d.number(0.0)), hex(|d| d.number(-0.0)));
        assert_ne!(hex(|d| d.number(1.0)), hex(|d| d.number(1.0_f64.next_up())));
        assert_ne!(hex(|d| d.some_number(None)), hex(|d| d.some_number(Some(0.0))));
        let texts = |a: &str, b: &str| hex(|d| [a, b].iter().for_each(|text| d.text(text)));
        assert_ne!(texts("ab", "c"), texts("a", "bc"));
    }
}
