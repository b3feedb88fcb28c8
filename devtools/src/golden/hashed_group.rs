//! A group of answers and their hash.

use std::fmt;

use super::digest::Digest;

/// The answers about a robot, a kind of cell or a set of problems.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct HashedGroup {
    /// Name, without white space.
    pub name: String,
    pub hash: String,
    /// Number of hashed answers.
    pub count: usize,
}

impl HashedGroup {
    pub fn new(name: &str, digest: Digest, count: usize) -> Self {
        let name = name.replace(char::is_whitespace, "_");
        Self { name, hash: digest.hex(), count }
    }

    /// Returns the hash of all groups, in their order.
    pub fn total(groups: &[Self]) -> Self {
        let mut digest = Digest::default();
        for group in groups {
            digest.text(&group.name);
            digest.text(&group.hash);
        }
        Self::new("total", digest, groups.iter().map(|group| group.count).sum())
    }
}

impl fmt::Display for HashedGroup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, hash, count } = self;
        write!(f, "{name} {hash} {count}")
    }
}
