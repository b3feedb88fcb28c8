//! Signed head of a control log, which reveals lines that were cut off at its end or hashed anew.

use std::path::{Path, PathBuf};

use ed25519_dalek::{Signature, Signer as _, SigningKey};
use elbowroom_formats::Diagnostic;
use serde::{Deserialize, Serialize};

use crate::keys::PublicKey;
use crate::result::Result;
use crate::{hex, secret_file, text_file};

const NAME: &str = "control_log";
const COMMENT: &str =
    "The key that signs the control log of an elbowroom cell: keep it where the service runs, and nowhere else.";
/// Remedy for a log that is not as it was signed.
pub(crate) const RESTORE: &str =
    "the log and its head from a backup; or keep both as evidence under other names, and begin a new log";
/// Context of signatures: they are not valid for anything else.
const CONTEXT: &[u8] = b"elbowroom control log 1\n";

/// Number of entries of a log and hash of its last line, signed by the service: `cell.control.head` beside
/// `cell.control.jsonl`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LogHead {
    pub(crate) entries: u64,
    /// SHA-256 of the last line; 64 zeros if the log has no line.
    pub(crate) hash: String,
    /// The public key of the service.
    key: String,
    signature: String,
}

impl LogHead {
    /// The head of a log, `None` if it was never signed.
    pub(crate) fn read(log: &Path) -> Result<Option<Self>> {
        let path = path_of(log);
        let unreadable = |e: std::io::Error| Diagnostic::unreadable(&path, &e, "the path of a file that is there");
        if !path.try_exists().map_err(unreadable)? {
            return Ok(None);
        }
        let head: Option<Self> = serde_json::from_str(&text_file::read(&path)?).ok();
        let head = head.filter(Self::is_signed);
        head.map(Some).ok_or_else(|| Diagnostic::new(&path, None, "is not signed, or was modified").hint(RESTORE))
    }

    fn is_signed(&self) -> bool {
        let (Some(key), Some(signature)) = (PublicKey::from_hex(&self.key), hex::decode(&self.signature)) else {
            return false;
        };
        key.has_signed_text(&message(self.entries, &self.hash), &Signature::from_bytes(&signature))
    }

    /// The short id of the service's key. Comparison with a noted id shows whether another key has signed the log.
    pub(crate) fn key_id(&self) -> Option<String> {
        PublicKey::from_hex(&self.key).map(|key| key.id())
    }
}

fn path_of(log: &Path) -> PathBuf {
    log.with_extension("head")
}

fn message(entries: u64, hash: &str) -> Vec<u8> {
    [CONTEXT, entries.to_string().as_bytes(), b"\n", hash.as_bytes()].concat()
}

/// Signs the head of a log with a key that only the service may read.
#[derive(Debug)]
pub(crate) struct LogSigner {
    path: PathBuf,
    key: SigningKey,
}

impl LogSigner {
    /// Opens the key of a log (`cell.control.key`), which is created with the log. `head` is the head of this log.
    pub(crate) fn open(log: &Path, head: Option<&LogHead>) -> Result<Self> {
        let file = Self::file_of(log);
        // The file is empty if the power failed while it was created.
        let is_empty = std::fs::metadata(&file).is_ok_and(|about| about.len() == 0);
        if head.is_none() && is_empty {
            std::fs::remove_file(&file).map_err(text_file::unwritable(&file))?;
        }
        if head.is_none() && !file.exists() {
            let secret = secret_file::random();
            let made = secret.and_then(|secret| secret_file::write(&file, COMMENT, NAME, &secret));
            made.map_err(text_file::unwritable(&file))?;
        }
        let secret = secret_file::read(&file, NAME, "the file that the service has made with its log")?;
        let signer = Self { path: path_of(log), key: SigningKey::from_bytes(&secret) };
        match head {
            Some(head) if head.key != hex::encode(signer.key.verifying_key().as_bytes()) => {
                let hint = "the key and the log from a backup; or keep both as evidence under other names, and begin a new log";
                Err(Diagnostic::new(&file, None, "is not the key that has signed the log").hint(hint))
            }
            _ => Ok(signer),
        }
    }

    /// The key of a log.
    pub(crate) fn file_of(log: &Path) -> PathBuf {
        log.with_extension("key")
    }

    /// Replaces the head, and returns once the new one is on the disk.
    pub(crate) fn sign(&self, entries: u64, hash: &str) -> Result<()> {
        let head = LogHead {
            entries,
            hash: hash.to_owned(),
            key: hex::encode(self.key.verifying_key().as_bytes()),
            signature: hex::encode(&self.key.sign(&message(entries, hash)).to_bytes()),
        };
        let text = serde_json::to_string(&head).unwrap_or_default();
        text_file::replace(&self.path, &(text + "\n"), || Ok(()))
    }
}
