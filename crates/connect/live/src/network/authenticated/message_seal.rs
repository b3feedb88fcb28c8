//! Seal at the end of each message: session, number, keyed hash.

use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

use elbowroom_cell::access::NetworkKey;

/// Purpose of the derived key: hashes for another purpose do not match.
const CONTEXT: &str = "elbowroom 2026 messages of a cell";

/// Seals the messages of this process, and opens those of all others.
pub(super) struct MessageSeal {
    key: [u8; blake3::KEY_LEN],
    /// Secret of this process, unknown even to other processes with the key.
    seed: [u8; blake3::KEY_LEN],
    session: u64,
    /// The number of the last message.
    number: AtomicU64,
    nonces: AtomicU64,
}

impl fmt::Debug for MessageSeal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "session {:016x}", self.session)
    }
}

/// A message that was sealed by a process with the key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Opened<'b> {
    pub(super) contents: &'b [u8],
    pub(super) session: u64,
    pub(super) number: u64,
}

impl MessageSeal {
    /// Starts a session of a process with this key.
    pub(super) fn new(key: &NetworkKey) -> std::io::Result<Self> {
        let key = blake3::derive_key(CONTEXT, key.as_bytes());
        let seed = *NetworkKey::generate()?.as_bytes();
        let seal = Self { key, seed, session: 0, number: AtomicU64::new(0), nonces: AtomicU64::new(0) };
        Ok(Self { session: seal.nonce(), ..seal })
    }

    /// Returns a new number that nobody can predict.
    pub(super) fn nonce(&self) -> u64 {
        let count = self.nonces.fetch_add(1, Ordering::SeqCst);
        let hash = blake3::keyed_hash(&self.seed, &count.to_le_bytes());
        hash.as_bytes().first_chunk().map_or(count, |bytes| u64::from_le_bytes(*bytes))
    }

    /// Number of this process's session.
    pub(super) fn session(&self) -> u64 {
        self.session
    }

    pub(super) fn last_number(&self) -> u64 {
        self.number.load(Ordering::SeqCst)
    }

    /// Replaces `out` by the sealed message with these contents, for publication under this key.
    pub(super) fn close(&self, key: &str, contents: &[u8], out: &mut Vec<u8>) {
        out.clear();
        out.extend_from_slice(contents);
        out.extend_from_slice(&self.session.to_le_bytes());
        let number = self.number.fetch_add(1, Ordering::SeqCst) + 1;
        out.extend_from_slice(&number.to_le_bytes());
        let hash = self.hash(key, out);
        out.extend_from_slice(hash.as_bytes());
    }

    /// Opens a message; `None` unless a process with the cell's key has published it under this key.
    pub(super) fn open<'b>(&self, key: &str, bytes: &'b [u8]) -> Option<Opened<'b>> {
        let (closed, hash) = bytes.split_last_chunk::<{ blake3::OUT_LEN }>()?;
        // Compared in constant time.
        if self.hash(key, closed) != *hash {
            return None;
        }
        let (rest, number) = closed.split_last_chunk()?;
        let (contents, session) = rest.split_last_chunk()?;
        Some(Opened { contents, session: u64::from_le_bytes(*session), number: u64::from_le_bytes(*number) })
    }

    fn hash(&self, key: &str, closed: &[u8]) -> blake3::Hash {
        let mut hasher = blake3::Hasher::new_keyed(&self.key);
        hasher.update(&(key.len() as u64).to_le_bytes()).update(key.as_bytes()).update(closed);
        hasher.finalize()
    }
}
