//! `tokens.toml`: who may ask a running cell for changes, as salted hashes of secrets.

use std::fs::File;
use std::io::{self, Write as _};
use std::path::Path;

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{self, Table, Value};
use elbowroom_monitor::AccessClass;
use sha2::{Digest as _, Sha256};
use subtle::ConstantTimeEq as _;

use crate::result::Result;
use crate::{hex, text_file};

const EXAMPLE: &str = "what `elbowroom control token --role ROLE --name NAME --file FILE` writes";

/// The tokens of a running cell, as a file lists them:
///
/// ```toml
/// [[token]]
/// role = "programmer"        # or operator, integrator
/// name = "line 4, panel"
/// salt = "…"                 # 32 digits
/// hash = "…"                 # SHA-256 of salt and secret, 64 digits
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct AccessTokens {
    /// Tokens, in file order.
    pub tokens: Vec<AccessToken>,
}

/// Recognizes a secret without containing it.
///
/// A secret has 256 random bits, so nobody finds it by trial, however fast the hash is. SHA-256 is therefore
/// sufficient; slow hashes are for passwords, which are easier to guess.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AccessToken {
    /// The access class for which its holder acts.
    pub class: AccessClass,
    /// Its holder: a place or a role, for the log.
    pub name: String,
    salt: [u8; 16],
    hash: [u8; 32],
}

impl AccessTokens {
    /// Reads a file of tokens.
    ///
    /// # Errors
    /// [`Diagnostic`] at the wrong line, or if others than its owner may write the file: they could add their own
    /// tokens.
    pub fn read(file: &Path) -> Result<Self> {
        check_permissions(file)?;
        let text = text_file::read(file)?;
        let entries = toml_tables::parse(file, &text)?;
        let table = Table { file, name: String::new(), line: 1, entries: &entries };
        table.only(&["token"])?;
        let mut tokens: Vec<AccessToken> = Vec::new();
        for value in table.need("token", &format!("[[token]]   ({EXAMPLE})"))?.list("[[token]]")? {
            let token = token(&value)?;
            if tokens.iter().any(|t| t.name == token.name) {
                return Err(value.error(format!("has the name \"{}\" once more", token.name)).hint("each name once"));
            }
            tokens.push(token);
        }
        Ok(Self { tokens })
    }

    /// Creates a token with a new secret, appends its hash to a file, and returns the secret, which is not stored
    /// anywhere.
    ///
    /// The file is created if it is missing (mode 0600).
    ///
    /// # Errors
    /// [`Diagnostic`] if the file has this name already, is not a file of tokens, or cannot be written.
    ///
    /// ```
    /// use elbowroom_access::AccessTokens;
    /// use elbowroom_monitor::AccessClass;
    /// # let folder = tempfile::tempdir()?;
    /// # let file = folder.path().join("tokens.toml");
    /// let secret = AccessTokens::add(&file, AccessClass::Programmer, "line 4, panel")?;
    /// let tokens = AccessTokens::read(&file)?;
    /// assert_eq!(tokens.find(&secret).unwrap().class, AccessClass::Programmer);
    /// assert!(tokens.find(&secret.replace(&secret[..1], "x")).is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn add(file: &Path, class: AccessClass, name: &str) -> Result<String> {
        if name.trim().is_empty() || name.chars().any(char::is_control) {
            return Err(
                Diagnostic::new(file, None, "a token needs a name, for the log").hint("--name \"line 4, panel\"")
            );
        }
        let known = if file.exists() { Self::read(file)? } else { Self::default() };
        if known.tokens.iter().any(|t| t.name == name) {
            let what = format!("has a token \"{name}\" already");
            return Err(Diagnostic::new(file, None, what).hint("another name; or remove its table before"));
        }
        let (token, secret) = AccessToken::generate(class, name).map_err(text_file::unwritable(file))?;
        let written = open(file).and_then(|mut f| f.write_all(token.to_toml().as_bytes()).and_then(|()| f.sync_all()));
        written.map_err(text_file::unwritable(file))?;
        Ok(secret)
    }

    /// The token of a secret. The time depends neither on the token nor on where a wrong secret differs.
    pub fn find(&self, secret: &str) -> Option<&AccessToken> {
        self.tokens.iter().fold(None, |found, token| if token.is_of(secret) { Some(token) } else { found })
    }
}

impl AccessToken {
    fn generate(class: AccessClass, name: &str) -> io::Result<(Self, String)> {
        let random = |bytes: &mut [u8]| getrandom::fill(bytes).map_err(|e| io::Error::other(e.to_string()));
        let (mut salt, mut secret) = ([0; 16], [0; 32]);
        random(&mut salt)?;
        random(&mut secret)?;
        let secret = hex::encode(&secret);
        Ok((Self { class, name: name.to_owned(), salt, hash: hash(&salt, &secret) }, secret))
    }

    fn is_of(&self, secret: &str) -> bool {
        hash(&self.salt, secret).ct_eq(&self.hash).into()
    }

    fn to_toml(&self) -> String {
        format!(
            "\n[[token]]\nrole = \"{}\"\nname = {}\nsalt = \"{}\"\nhash = \"{}\"\n",
            self.class.name(),
            serde_json::Value::from(self.name.as_str()),
            hex::encode(&self.salt),
            hex::encode(&self.hash)
        )
    }
}

fn hash(salt: &[u8; 16], secret: &str) -> [u8; 32] {
    Sha256::new().chain_update(salt).chain_update(secret).finalize().into()
}

fn token(value: &Value<'_>) -> Result<AccessToken> {
    let t = value.table("[[token]]")?;
    t.only(&["role", "name", "salt", "hash"])?;
    let words = [AccessClass::Operator, AccessClass::Programmer, AccessClass::Integrator].map(|c| (c.name(), c));
    let (salt, hash) = (t.need("salt", EXAMPLE)?, t.need("hash", EXAMPLE)?);
    Ok(AccessToken {
        class: t.need("role", "role = \"programmer\"   (or operator, integrator)")?.word(&words)?,
        name: t.need("name", "name = \"line 4, panel\"")?.text()?.to_owned(),
        salt: hex::decode(salt.text()?).ok_or_else(|| salt.error("is no salt of 32 digits").hint(EXAMPLE))?,
        hash: hex::decode(hash.text()?).ok_or_else(|| hash.error("is no hash of 64 digits").hint(EXAMPLE))?,
    })
}

#[cfg(unix)]
fn open(file: &Path) -> io::Result<File> {
    use std::os::unix::fs::OpenOptionsExt;
    File::options().append(true).create(true).mode(0o600).open(file)
}

#[cfg(not(unix))]
fn open(file: &Path) -> io::Result<File> {
    File::options().append(true).create(true).open(file)
}

#[cfg(unix)]
fn check_permissions(file: &Path) -> Result<()> {
    use std::os::unix::fs::PermissionsExt;
    let Ok(about) = std::fs::metadata(file) else { return Ok(()) };
    let mode = about.permissions().mode() & 0o777;
    if mode & 0o022 == 0 {
        return Ok(());
    }
    let what = format!("is a file of tokens that others may write (mode {mode:03o}): they could add their own");
    Err(Diagnostic::new(file, None, what).hint(format!("chmod 600 {}", file.display())))
}

#[cfg(not(unix))]
fn check_permissions(_: &Path) -> Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_only_hashes_and_knows_its_secrets() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("tokens.toml");
        let secrets = [(AccessClass::Operator, "a"), (AccessClass::Integrator, "b \"quoted\"")]
            .map(|(class, name)| AccessTokens::add(&file, class, name).unwrap());
        let written = std::fs::read_to_string(&file).unwrap();
        assert!(secrets.iter().all(|s| s.len() == 64 && !written.contains(s)));
        let tokens = AccessTokens::read(&file).unwrap();
        assert_eq!(tokens.find(&secrets[0]).map(|t| (t.class, t.name.as_str())), Some((AccessClass::Operator, "a")));
        assert_eq!(tokens.find(&secrets[1]).map(|t| t.name.as_str()), Some("b \"quoted\""));
        for wrong in ["", &secrets[0][1..], &secrets[0].to_uppercase(), &format!("{}0", secrets[0]), &written] {
            assert!(tokens.find(wrong).is_none(), "{wrong}");
        }
        let again = AccessTokens::add(&file, AccessClass::Integrator, "a").unwrap_err().to_string();
        assert!(again.contains("has a token \"a\" already"), "{again}");
        // Salts make the hashes of equal secrets different.
        assert_ne!(hash(&[0; 16], "s"), hash(&[1; 16], "s"));
    }

    #[test]
    fn wrong_files_say_what_to_write() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("tokens.toml");
        let (salt, hash) = ("0".repeat(32), "0".repeat(64));
        for (text, message) in [
            (String::new(), "[[token]]"),
            ("[[token]]\nrole = \"boss\"\nname = \"a\"\n".into(), "salt"),
            (format!("[[token]]\nrole = \"boss\"\nname = \"a\"\nsalt = \"{salt}\"\nhash = \"{hash}\"\n"), "boss"),
            (format!("[[token]]\nrole = \"operator\"\nname = \"a\"\nsalt = \"1\"\nhash = \"{hash}\"\n"), "salt"),
            (
                format!("[[token]]\nrole = \"operator\"\nname = \"a\"\nsalt = \"{salt}\"\nsecret = \"{hash}\"\n"),
                "secret",
            ),
        ] {
            std::fs::write(&file, &text).unwrap();
            set_mode(&file, 0o600);
            let error = AccessTokens::read(&file).unwrap_err().to_string();
            assert!(error.contains(message), "{text}: {error}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_file_that_others_may_write_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("tokens.toml");
        AccessTokens::add(&file, AccessClass::Operator, "a").unwrap();
        set_mode(&file, 0o620);
        let error = AccessTokens::read(&file).unwrap_err().to_string();
        assert!(error.contains("others may write") && error.contains("chmod 600"), "{error}");
    }

    #[cfg(unix)]
    fn set_mode(file: &Path, mode: u32) {
        use std::os::unix::fs::PermissionsExt;
        std::fs::set_permissions(file, std::fs::Permissions::from_mode(mode)).unwrap();
    }

    #[cfg(not(unix))]
    fn set_mode(_: &Path, _: u32) {}
}
