//! Identity of a publisher or subscription.

use xxhash_rust::xxh3::xxh3_128;

/// The global identity of a publisher or subscription: the 128-bit XXH3 hash of its liveliness token, low bytes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Gid(pub [u8; 16]);

impl Gid {
    /// Computes the identity of a token's owner.
    pub fn of_token(token: &str) -> Self {
        Self(xxh3_128(token.as_bytes()).to_le_bytes())
    }
}
