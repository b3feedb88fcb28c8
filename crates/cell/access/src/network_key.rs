//! The secret that the processes of a running cell share.

use std::fmt;
use std::io;
use std::path::Path;

use crate::result::Result;
use crate::secret_file;

const NAME: &str = "network";
const COMMENT: &str = "The network key of an elbowroom cell, the same for all of its processes. Whoever has it can speak for each of them: keep it secret.";

/// The secret that the processes of a running cell share. Its holder may act for each of them.
#[derive(Clone, PartialEq, Eq)]
pub struct NetworkKey([u8; 32]);

impl fmt::Debug for NetworkKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("NetworkKey")
    }
}

impl NetworkKey {
    /// A new key from random numbers of the operating system.
    ///
    /// # Errors
    /// [`io::Error`] if the system provides none.
    pub fn generate() -> io::Result<Self> {
        Ok(Self(secret_file::random()?))
    }

    /// Writes the key to a new file that only its owner may read (mode 0600).
    ///
    /// # Errors
    /// [`io::Error`] if the file exists already or cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        secret_file::write(path, COMMENT, NAME, &self.0)
    }

    /// Reads the format of [`write`](Self::write).
    ///
    /// # Errors
    /// [`Diagnostic`](elbowroom_formats::Diagnostic) if it cannot be read, is not a key, or others than its owner may read it.
    pub fn read(path: &Path) -> Result<Self> {
        Ok(Self(secret_file::read(path, NAME, "what `elbowroom control network-key` writes")?))
    }

    /// The secret.
    pub fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_read_as_written_and_others_must_not_read_it() -> std::result::Result<(), Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let file = folder.path().join("cell.key");
        let key = NetworkKey::generate()?;
        key.write(&file)?;
        assert_eq!(NetworkKey::read(&file)?, key);
        assert_ne!(NetworkKey::generate()?, key);
        assert_eq!(key.write(&file).map_err(|e| e.kind()), Err(io::ErrorKind::AlreadyExists));
        assert_eq!(format!("{key:?}"), "NetworkKey", "a log must not have the secret");
        let error = |text: &str| {
            std::fs::write(&file, text).map(|()| NetworkKey::read(&file).map_err(|e| e.to_string()).unwrap_err())
        };
        assert!(error("network = \"12\"")?.contains("64 hexadecimal digits"));
        assert!(error("private = \"12\"")?.contains("private"));
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o640))?;
            assert!(NetworkKey::read(&file).map_err(|e| e.to_string()).unwrap_err().contains("chmod 600"));
        }
        Ok(())
    }
}
