//! `trusted-keys.toml`: the accepted keys, and their classes.

use std::path::{Path, PathBuf};

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{self, Table, Value};
use elbowroom_monitor::AccessClass;

use crate::keys::{PublicKey, class};
use crate::result::Result;
use crate::text_file;

/// Name of the file, and of its entry in the sealed state.
pub const FILE: &str = "trusted-keys.toml";
/// Key file of the machine. It applies to every cell there, and users cannot name another one.
const MACHINE: &str = "/etc/elbowroom/trusted-keys.toml";
/// Suffix after the quoted name.
const RETIRED: &str = ", retired";
/// Environment variable that names a key file if the machine has none.
const VARIABLE: &str = "ELBOWROOM_TRUSTED_KEYS";

/// The accepted public keys, as listed in a file:
///
/// ```toml
/// [[key]]
/// class = "integrator"
/// name = "integration, line 4"
/// public = "3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c"
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TrustedKeys {
    /// The file.
    pub file: PathBuf,
    /// Keys, in file order.
    pub keys: Vec<TrustedKey>,
    /// True if the file is beside the cell.
    ///
    /// Anybody who may write there could add a key, so only keys that were sealed with the cell count.
    pub beside: bool,
}

/// An accepted key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TrustedKey {
    /// The highest class it may act for.
    pub class: AccessClass,
    /// Its owner.
    pub name: String,
    /// The key.
    pub public: PublicKey,
    /// True if it no longer signs. Its entries count if an entry of another integrator follows.
    pub retired: bool,
}

impl TrustedKeys {
    /// The keys for a cell file; `None` if no key file exists, so that cells need no seal.
    ///
    /// The file is `/etc/elbowroom/trusted-keys.toml`; otherwise the file named by the environment variable
    /// `ELBOWROOM_TRUSTED_KEYS`; otherwise `trusted-keys.toml` beside the cell file.
    ///
    /// # Errors
    /// [`Diagnostic`] if the file cannot be read, or at the wrong line.
    pub fn find(cell: &Path) -> Result<Option<Self>> {
        let named = std::env::var_os(VARIABLE).filter(|v| !v.is_empty()).map(PathBuf::from);
        let beside = cell.with_file_name(FILE);
        let Some(file) = locate(Path::new(MACHINE), named, &beside) else { return Ok(None) };
        Ok(Some(Self { beside: file == beside, ..Self::read(&file)? }))
    }

    /// Reads a key file.
    ///
    /// # Errors
    /// As for [`find`](Self::find).
    pub fn read(file: &Path) -> Result<Self> {
        let text = text_file::read(file)?;
        let entries = toml_tables::parse(file, &text)?;
        let table = Table { file, name: String::new(), line: 1, entries: &entries };
        table.only(&["key"])?;
        let mut keys: Vec<TrustedKey> = Vec::new();
        for value in table.need("key", "[[key]]")?.list("[[key]]")? {
            let key = trusted(&value)?;
            if let Some(other) = keys.iter().find(|k| k.public == key.public) {
                return Err(value.error(format!("is the key of \"{}\" once more", other.name)).hint("each key once"));
            }
            keys.push(key);
        }
        Ok(Self { file: file.to_owned(), keys, beside: false })
    }

    /// The key with this short id.
    pub fn get(&self, id: &str) -> Option<&TrustedKey> {
        self.keys.iter().find(|k| k.public.id() == id)
    }
}

fn trusted(value: &Value<'_>) -> Result<TrustedKey> {
    let t = value.table("[[key]]")?;
    t.only(&["class", "name", "public", "retired"])?;
    let public = t.need("public", "public = \"…\"   (the 64 digits that `elbowroom region keygen` prints)")?;
    let key = PublicKey::from_hex(public.text()?).ok_or_else(|| {
        public.error("is no key").hint("public = \"…\"   (the 64 digits that `elbowroom region keygen` prints)")
    })?;
    Ok(TrustedKey {
        class: class(&t.need("class", "class = \"programmer\"   (or integrator)")?)?,
        name: t.need("name", "name = \"integration, line 4\"   (the owner of the key)")?.text()?.to_owned(),
        public: key,
        retired: t.flag_or("retired", false)?,
    })
}

/// The machine's file has priority: otherwise users could name a file with their own keys.
fn locate(machine: &Path, named: Option<PathBuf>, beside: &Path) -> Option<PathBuf> {
    if machine.exists() {
        return Some(machine.to_owned());
    }
    named.or_else(|| beside.exists().then(|| beside.to_owned()))
}

/// The keys beside a cell, as sealed with it: short id and permissions; [`may_sign`] reads them.
///
/// # Errors
/// The file of the keys is not valid.
pub fn beside(cell: &Path) -> Result<Vec<(String, String)>> {
    let file = cell.with_file_name(FILE);
    if !file.exists() {
        return Ok(Vec::new());
    }
    let value = |k: TrustedKey| {
        let retired = if k.retired { RETIRED } else { "" };
        (k.public.id(), format!("{} {:?}{retired}", k.class.name(), k.name))
    };
    Ok(TrustedKeys::read(&file)?.keys.into_iter().map(value).collect())
}

/// True if the sealed entry of a key permits it to sign on behalf of a class.
pub fn may_sign(sealed: &str, who: AccessClass) -> bool {
    let class = sealed.split(' ').next().and_then(AccessClass::parse);
    class.is_some_and(|c| c >= who) && !sealed.ends_with(RETIRED)
}

/// The error for a sealed cell without a key file.
pub fn missing(cell: &Path, log: &Path) -> Diagnostic {
    let what = format!("is sealed by {}, but there is no file of trusted keys", log.display());
    Diagnostic::new(cell, None, what).hint(format!(
        "the integrator's {FILE} beside the cell file, or at {MACHINE}, or {VARIABLE}=FILE (docs/roles.md)"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_signs_for_its_class_and_below_until_it_is_retired() {
        let dir = tempfile::tempdir().unwrap();
        let key = |class: &str, public: char, retired: bool| {
            let public = public.to_string().repeat(64);
            format!("[[key]]\nclass = \"{class}\"\nname = \"x\"\npublic = \"{public}\"\nretired = {retired}\n")
        };
        let keys = [("integrator", '1', false), ("integrator", '2', true), ("programmer", '3', false)];
        let text: String = keys.iter().map(|(class, public, retired)| key(class, *public, *retired)).collect();
        std::fs::write(dir.path().join(FILE), text).unwrap();
        let sealed = beside(&dir.path().join("cell.toml")).unwrap();
        let may = |who| sealed.iter().map(|(_, entry)| may_sign(entry, who)).collect::<Vec<_>>();
        assert_eq!(may(AccessClass::Integrator), [true, false, false]);
        assert_eq!(may(AccessClass::Programmer), [true, false, true]);
    }

    #[test]
    fn the_keys_of_the_machine_have_precedence_over_those_beside_the_cell() {
        let dir = tempfile::tempdir().unwrap();
        let [machine, named, beside] = ["machine", "named", "beside"].map(|n| dir.path().join(n));
        assert_eq!(locate(&machine, None, &beside), None);
        std::fs::write(&beside, "").unwrap();
        assert_eq!(locate(&machine, None, &beside), Some(beside.clone()));
        assert_eq!(locate(&machine, Some(named.clone()), &beside), Some(named.clone()));
        std::fs::write(&machine, "").unwrap();
        assert_eq!(locate(&machine, Some(named), &beside), Some(machine));
    }
}
