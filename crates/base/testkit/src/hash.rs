//! A hash that is the same on every machine, for golden values of tests.

/// The 64-bit hash FNV-1a of Fowler, Noll and Vo.
///
/// ```
/// let mut hash = elbowroom_testkit::hash::Fnv::default();
/// hash.add(7);
/// assert_ne!(hash, Default::default());
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fnv(pub u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    /// Adds the eight bytes of a number, lowest byte first.
    pub fn add(&mut self, value: u64) {
        for byte in value.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_the_published_one() {
        // Eight zero bytes: a zero byte does not change the hash before the multiplication.
        let mut hash = Fnv::default();
        hash.add(0);
        let expected = (0..8).fold(Fnv::default().0, |h, _| h.wrapping_mul(0x0100_0000_01b3));
        assert_eq!(hash.0, expected);
        // "foobar" and two zeros, from the hash of "foobar" that the authors publish.
        let mut hash = Fnv::default();
        hash.add(u64::from_le_bytes(*b"foobar\0\0"));
        assert_eq!(hash.0, (0..2).fold(0x8594_4171_f739_67e8, |h: u64, _| h.wrapping_mul(0x0100_0000_01b3)));
    }
}
