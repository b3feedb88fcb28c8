//! TOML to a file of pairs.

use std::path::Path;

use elbowroom_formats::toml_tables::{self, Table, Value};
use elbowroom_formats::{Diagnostic, read_file, suggest};
use elbowroom_scene::PairState;

use super::{ANYTHING, Note, PairFile, PairRow};

type Result<T> = std::result::Result<T, Diagnostic>;

/// Largest file of pairs, bytes.
const MAX_BYTES: u64 = 64 << 20;
const KEYS: &[&str] = &["version", "pairs"];
const EXAMPLE: &str = "pairs = [{ a = \"part\", b = \"table\", reason = \"the part stands on it\" }]";
const ROW: &str = "{ a = \"part\", b = \"table\", reason = \"the part stands on it\" }";

impl PairFile {
    /// Reads a file. Names are resolved by [`PairFile::rules`].
    ///
    /// # Errors
    /// [`Diagnostic`] with the line if it cannot be read or is not a file of pairs.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let bytes = read_file(path, MAX_BYTES, "a file of pairs, as `elbowroom inspect MODEL --pairs FILE` writes it")?;
        let text = String::from_utf8(bytes).map_err(|_| Diagnostic::not_utf8(path, None))?;
        Self::parse(path, &text)
    }

    /// Reads text as the file `path`.
    ///
    /// # Errors
    /// As for [`PairFile::read`].
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self> {
        let file = path.as_ref();
        let entries = toml_tables::parse(file, text)?;
        let root = Table { file, name: String::new(), line: 1, entries: &entries };
        if let Some(entry) = entries.iter().find(|e| !KEYS.contains(&e.key.as_str())) {
            let what = format!("a file of pairs has no key `{}`", entry.key);
            let hint = suggest::hint(&entry.key, KEYS.iter().copied());
            return Err(Diagnostic::new(file, entry.line, what).hint(hint));
        }
        let needed = |key: &str, example: &str| {
            let missing = || Diagnostic::new(file, 1, format!("a file of pairs needs the key `{key}`")).hint(example);
            root.get(key).ok_or_else(missing)
        };
        let version = needed("version", "version = 1")?;
        if version.number()? != 1.0 {
            return Err(version.error("is not 1, the version that this program reads").hint("version = 1"));
        }
        let rows = needed("pairs", EXAMPLE)?.list(EXAMPLE)?.iter().map(row).collect::<Result<_>>()?;
        Ok(Self { file: file.to_owned(), rows, comments: Vec::new() })
    }
}

fn row(v: &Value<'_>) -> Result<PairRow> {
    let t = v.table(ROW)?;
    t.only(&["a", "b", "state", "weight", "reason", "found"])?;
    let side = |key: &str| Ok::<_, Diagnostic>(t.need(key, ROW)?.text()?.to_owned());
    let sides = [side("a")?, side("b")?];
    if sides == [ANYTHING, ANYTHING] {
        return Err(v.error("lets everything touch everything").hint(ROW));
    }
    let states = [("skipped", PairState::Skipped), ("tested", PairState::Tested)];
    let state = t.get("state").map_or(Ok(PairState::Skipped), |v| v.word(&states))?;
    let weight = t.get("weight").map(|v| v.not_negative()).transpose()?;
    let text = |key: &str| t.get(key).map(|v| v.text().map(str::to_owned)).transpose();
    let note = match (text("reason")?, text("found")?) {
        (Some(_), Some(_)) => {
            return Err(v.error("has `reason` and `found`").hint("reason, for what a person decides"));
        }
        (Some(reason), None) if reason.trim().is_empty() => {
            return Err(v.error("has an empty `reason`").hint("why the pair may touch"));
        }
        (Some(reason), None) => Note::Reason(reason),
        (None, Some(found)) => Note::Found(found),
        (None, None) => Note::None,
    };
    if state == PairState::Skipped && matches!(note, Note::None) {
        let what = "skips a pair without a reason";
        return Err(v.error(what).hint(ROW));
    }
    if state == PairState::Skipped && weight.is_some() {
        let what = "has a `weight`, which orders tested pairs, but skips the pair";
        return Err(v.error(what).hint("state = \"tested\", or no weight"));
    }
    Ok(PairRow { line: v.line, sides, state, weight, note })
}
