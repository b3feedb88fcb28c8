//! Private keys for signing, public keys for verification.

use std::io::{self, Write};
use std::path::Path;

use ed25519_dalek::{Signature, Signer as _, SigningKey, VerifyingKey};
use elbowroom_formats::toml_tables::{self, Table, Value};
use elbowroom_monitor::AccessClass;

use crate::result::Result;
use crate::secret_file::{self, check_private_permissions, create};
use crate::{hex, text_file};

/// Context of signatures: a signature for another purpose is not valid for an edit.
const CONTEXT: &[u8] = b"elbowroom edit 1\n";

/// A private key, which signs on behalf of its class.
#[derive(Debug)]
pub struct PrivateKey {
    class: AccessClass,
    name: String,
    key: SigningKey,
}

/// A public key, which verifies signatures.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PublicKey(VerifyingKey);

impl PrivateKey {
    /// A new key from random numbers of the operating system.
    ///
    /// # Errors
    /// [`io::Error`] if the system provides none.
    pub fn generate(class: AccessClass, name: &str) -> io::Result<Self> {
        Ok(Self { class, name: name.into(), key: SigningKey::from_bytes(&secret_file::random()?) })
    }

    /// Writes the key to a new file that only its owner may read (mode 0600).
    ///
    /// # Errors
    /// [`io::Error`] if the file exists already or cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        let mut file = create(path)?;
        write!(
            file,
            "# An elbowroom private key. Its holder can act for its class: keep it secret.\n\
             class = \"{}\"\nname = {}\nprivate = \"{}\"\n",
            self.class.name(),
            serde_json::Value::from(self.name.as_str()),
            hex::encode(&self.key.to_bytes())
        )?;
        file.sync_all()
    }

    /// Reads the format of [`write`](Self::write).
    ///
    /// # Errors
    /// [`Diagnostic`](elbowroom_formats::Diagnostic) if it cannot be read, is not a key, or others than its owner may read it.
    pub fn read(path: &Path) -> Result<Self> {
        check_private_permissions(path)?;
        let text = text_file::read(path)?;
        let entries = toml_tables::parse(path, &text)?;
        let table = Table { file: path, name: String::new(), line: 1, entries: &entries };
        table.only(&["class", "name", "private"])?;
        let secret = table.need("private", "the key that `elbowroom region keygen` writes")?;
        let bytes = hex::decode(secret.text()?).ok_or_else(|| {
            secret.error("is no key").hint("64 hexadecimal digits, as `elbowroom region keygen` writes them")
        })?;
        let class = class(&table.need("class", "class = \"programmer\"")?)?;
        let name = table.need("name", "name = \"integration, line 4\"")?.text()?.to_owned();
        Ok(Self { class, name, key: SigningKey::from_bytes(&bytes) })
    }

    /// The class of the key.
    pub fn class(&self) -> AccessClass {
        self.class
    }

    /// Its owner.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The corresponding public key.
    pub fn public(&self) -> PublicKey {
        PublicKey(self.key.verifying_key())
    }

    pub(crate) fn sign(&self, message: &[u8]) -> String {
        hex::encode(&self.key.sign(&[CONTEXT, message].concat()).to_bytes())
    }
}

impl PublicKey {
    /// Reads the 64 hexadecimal digits of [`to_hex`](Self::to_hex); `None` for an invalid key.
    pub fn from_hex(digits: &str) -> Option<Self> {
        let key = VerifyingKey::from_bytes(&hex::decode(digits)?).ok()?;
        // Weak keys accept forged signatures.
        (!key.is_weak()).then_some(Self(key))
    }

    /// 64 hexadecimal digits.
    pub fn to_hex(&self) -> String {
        hex::encode(self.0.as_bytes())
    }

    /// Its short id: the first 16 hexadecimal digits of its hash.
    pub fn id(&self) -> String {
        hex::hash(self.0.as_bytes()).chars().take(16).collect()
    }

    pub(crate) fn has_signed(&self, message: &[u8], signature: &str) -> bool {
        let Some(bytes) = hex::decode(signature) else { return false };
        self.has_signed_text(&[CONTEXT, message].concat(), &Signature::from_bytes(&bytes))
    }

    /// Verifies a signature without the context of edits.
    pub(crate) fn has_signed_text(&self, text: &[u8], signature: &Signature) -> bool {
        self.0.verify_strict(text, signature).is_ok()
    }
}

/// The class of a signing key.
pub(crate) fn class(value: &Value<'_>) -> Result<AccessClass> {
    value.word(&[("programmer", AccessClass::Programmer), ("integrator", AccessClass::Integrator)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signature_covers_only_the_signed_bytes() {
        let key = PrivateKey::generate(AccessClass::Programmer, "P").unwrap();
        let signature = key.sign(b"move the wall");
        let public = PublicKey::from_hex(&key.public().to_hex()).unwrap();
        assert!(public.has_signed(b"move the wall", &signature));
        assert!(!public.has_signed(b"move the door", &signature));
        let other = PrivateKey::generate(AccessClass::Programmer, "P").unwrap();
        assert!(!other.public().has_signed(b"move the wall", &signature));
        assert!(!public.has_signed(b"move the wall", "") && !public.has_signed(b"move the wall", &signature[2..]));
    }

    /// RFC 8032, section 7.1, test 2: the key pair only, because signatures here have a context.
    #[test]
    fn the_public_key_is_that_of_ed25519() {
        let secret = hex::decode("4ccd089b28ff96da9db6c346ec114e0f5b8a319f35aba624da8cf6ed4fb8a6fb").unwrap();
        let key =
            PrivateKey { class: AccessClass::Integrator, name: String::new(), key: SigningKey::from_bytes(&secret) };
        assert_eq!(key.public().to_hex(), "3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c");
    }

    #[test]
    fn invalid_public_keys_are_refused() {
        assert_eq!(PublicKey::from_hex(""), None);
        assert_eq!(PublicKey::from_hex(&"00".repeat(32)), None, "a weak key");
        let identity = format!("01{}", "00".repeat(31));
        assert_eq!(PublicKey::from_hex(&identity), None, "a weak key");
    }
}
