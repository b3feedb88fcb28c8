//! Edits of a sealed cell file. Unaffected text stays unchanged, comments included.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use elbowroom_access::{Change, LogEntry, PrivateKey, TrustedKeys, text_file, trust, utc_now};
use elbowroom_formats::Diagnostic;
use elbowroom_monitor::AccessClass;
use toml_edit::{DocumentMut, Item, TableLike, Value};

use super::authorize::authorize;
use super::log::{Log, log_of};
use super::result::Result;
use super::state::{SealedState, least_class, without_consequences};
use crate::file::REGION_TABLES;
use crate::{Cell, CellFile};

/// An edit. Values are TOML: `150`, `[900, 0, 0]`, `"temporary"`. Anything that is not TOML is treated as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CellEdit {
    /// Adds regions: tables `[region.NAME]` and `[fence.NAME]` of a cell file.
    Add {
        /// The tables.
        toml: String,
        /// Their origin, for messages.
        from: PathBuf,
    },
    /// Sets and removes keys of a region.
    Change {
        /// The region.
        region: String,
        /// Keys and their values.
        set: Vec<(String, String)>,
        /// Keys.
        unset: Vec<String>,
    },
    /// Removes a region.
    Remove {
        /// The region.
        region: String,
    },
    /// Sets and removes keys of `[monitor]`.
    Laws {
        /// Keys and their values.
        set: Vec<(String, String)>,
        /// Keys.
        unset: Vec<String>,
    },
}

/// The author of an edit.
#[derive(Debug, Clone, Copy)]
pub struct Signer<'a> {
    /// The access class.
    pub class: AccessClass,
    /// Its private key.
    pub key: &'a PrivateKey,
    /// A note for the log.
    pub note: Option<&'a str>,
}

/// Edits a sealed cell file and logs the edit.
///
/// # Errors
/// [`Diagnostic`] if the cell differs from its seal, the class or the key is not permitted, or the result is not a
/// valid cell. Then nothing is changed.
pub fn edit(cell: &Path, signer: &Signer<'_>, edit: &CellEdit) -> Result<LogEntry> {
    let trusted = trusted(cell)?;
    signer.check(cell, &trusted)?;
    let path = log_of(cell);
    if !path.exists() {
        let what = "is not sealed yet: no class guards it";
        let hint = format!("elbowroom region seal {} --as integrator --key FILE", cell.display());
        return Err(Diagnostic::new(cell, None, what).hint(hint));
    }
    let held = hold(&path)?;
    let before = CellFile::read(cell)?.resolve()?;
    let log = Log::read(&path, &trusted)?;
    let new = edited(cell, &text_file::read(cell)?, edit)?;
    let draft = Draft::new(cell, new)?;
    let changes = log.state.changes_to(&draft.state);
    let only = edit.items(&draft)?;
    if let Some(c) = changes.iter().find(|c| !only.contains(&c.item)) {
        return Err(Diagnostic::new(cell, draft.state.line(c), format!("the edit would also change this: {c}"))
            .hint("tables [region.NAME] with the keys of a region, and nothing else"));
    }
    signer.authorize(cell, &before, &draft, &log, &changes)?;
    draft.commit(cell, signer, edit.action(&only), changes, log, held)
}

/// Seals a cell file in its present state and logs all changes since the last seal.
///
/// # Errors
/// [`Diagnostic`] if the class or the key is not permitted, the cell is not valid, or the log was modified.
pub fn seal(cell: &Path, signer: &Signer<'_>) -> Result<LogEntry> {
    let trusted = trusted(cell)?;
    signer.check(cell, &trusted)?;
    let path = log_of(cell);
    let draft = Draft::new(cell, text_file::read(cell)?)?;
    // A failed first write leaves an empty log.
    let first = !std::fs::metadata(&path).is_ok_and(|m| m.len() > 0);
    if first && signer.class < AccessClass::Integrator {
        let what = format!("was never sealed: its first seal is the integrator's, not the {}'s", signer.class.name());
        return Err(Diagnostic::new(cell, None, what).hint("--as integrator, with the key of an integrator"));
    }
    let held = hold(&path)?;
    let log = if first { Log::new(&path) } else { Log::read_to_continue(&path, &trusted)? };
    signer.check_sealed(cell, &trusted, &log)?;
    let changes = log.state.changes_to(&draft.state);
    let least = least_class(&log.state, &draft.state, &changes);
    if signer.class < least {
        return Err(signer.refusal(cell, &log, &draft.state, &changes));
    }
    draft.commit(cell, signer, "seal".into(), changes, log, held)
}

fn trusted(cell: &Path) -> Result<TrustedKeys> {
    if !cell.exists() {
        return Err(
            Diagnostic::new(cell, None, "does not exist").hint("the path of a cell file (see docs/cell-file.md)")
        );
    }
    TrustedKeys::find(cell)?.ok_or_else(|| {
        let what = format!("there is no file of trusted keys, {}", trust::FILE);
        Diagnostic::new(cell, None, what).hint(
            "elbowroom region keygen --as integrator --name \"integration, line 4\" --out integrator.key >> trusted-keys.toml   \
             (beside the cell file; docs/roles.md)",
        )
    })
}

/// Locks the log against concurrent edits; creates it if it is missing.
fn hold(log: &Path) -> Result<File> {
    let file = File::options().append(true).create(true).open(log).map_err(text_file::unwritable(log))?;
    file.lock().map_err(text_file::unwritable(log))?;
    Ok(file)
}

impl Signer<'_> {
    /// Checks that the key is trusted for this class.
    fn check(&self, cell: &Path, trusted: &TrustedKeys) -> Result<()> {
        let class = self.class.name();
        let wrong = |what: String, hint: &str| Err(Diagnostic::new(cell, None, what).hint(hint));
        if self.class == AccessClass::Operator {
            return wrong(
                "an operator changes no regions and no laws".into(),
                "--as programmer or --as integrator, with a key of that class",
            );
        }
        let id = self.key.public().id();
        let file = trusted.file.display();
        match trusted.get(&id) {
            None => wrong(
                format!("the key {id} of \"{}\" does not count here: {file} does not name it", self.key.name()),
                "a key that it names; or the integrator adds this one there, and seals the cell",
            ),
            Some(key) if key.retired => {
                wrong(format!("the key {id} of \"{}\" is retired in {file}", key.name), "a key that is not")
            }
            Some(key) if key.class < self.class => wrong(
                format!("the key {id} of \"{}\" may act as {}, not as {class}", key.name, key.class.name()),
                &format!("--as {}; or the key of an {class}", key.class.name()),
            ),
            Some(_) => Ok(()),
        }
    }

    /// Checks that a key beside the cell was sealed with it; other keys beside the cell do not count.
    fn check_sealed(&self, cell: &Path, trusted: &TrustedKeys, log: &Log) -> Result<()> {
        let id = self.key.public().id();
        let sealed = log.state.sealed_key(&id).is_some_and(|k| trust::may_sign(k, self.class));
        if sealed || !trusted.beside || log.entries.is_empty() {
            return Ok(());
        }
        let what = format!(
            "the key {id} of \"{}\" was not sealed with the cell as one that may act as {}, though {} names it",
            self.key.name(),
            self.class.name(),
            trusted.file.display()
        );
        Err(Diagnostic::new(cell, None, what).hint("with the key of an integrator that was: elbowroom region seal"))
    }

    fn authorize(&self, cell: &Path, before: &Cell, draft: &Draft, log: &Log, changes: &[Change]) -> Result<()> {
        let least = least_class(&log.state, &draft.state, changes);
        if let Err(e) = authorize(self.class, before, &draft.cell)? {
            let refused = Diagnostic::new(cell, first_line(&draft.state, changes), e);
            return Err(refused.hint(format!("--as {}, with a key of that class", least.name())));
        }
        if self.class < least { Err(self.refusal(cell, log, &draft.state, changes)) } else { Ok(()) }
    }

    /// The error for a change that this class may not make.
    fn refusal(&self, cell: &Path, log: &Log, now: &SealedState, changes: &[Change]) -> Diagnostic {
        let least = |c: &Change| least_class(&log.state, now, std::slice::from_ref(c));
        let shown = without_consequences(changes);
        let Some(change) = shown.into_iter().find(|c| least(c) > self.class) else {
            return Diagnostic::new(cell, None, "needs another class")
                .hint("--as integrator, with a key of that class");
        };
        let needed = least(change).name();
        let what = format!("{change}: that needs the {needed} class, not {}", self.class.name());
        Diagnostic::new(cell, now.line(change), what).hint(format!("--as {needed}, with a key of that class"))
    }
}

fn first_line(now: &SealedState, changes: &[Change]) -> Option<usize> {
    without_consequences(changes).first().and_then(|c| now.line(c))
}

/// An edited cell file before it is written.
struct Draft {
    text: String,
    cell: Cell,
    state: SealedState,
}

impl Draft {
    /// Creates a draft. A checksum in the file is updated.
    fn new(path: &Path, text: String) -> Result<Self> {
        let mut file = CellFile::parse(path, &text)?;
        let mut text = text;
        let cell = if file.entries.iter().any(|e| e.key == "checksum") {
            file.entries.retain(|e| e.key != "checksum");
            let cell = file.resolve()?;
            let mut document = document(path, &text)?;
            put(document.as_table_mut(), "checksum", Value::from(cell.approval.checksum.as_str()));
            text = document.to_string();
            file = CellFile::parse(path, &text)?;
            cell
        } else {
            file.resolve()?
        };
        let state = SealedState::of(&file, &cell)?;
        Ok(Self { text, cell, state })
    }

    fn commit(
        self,
        path: &Path,
        signer: &Signer<'_>,
        action: String,
        changes: Vec<Change>,
        log: Log,
        mut held: File,
    ) -> Result<LogEntry> {
        let entry = LogEntry {
            sequence: log.entries.len() as u64 + 1,
            time: utc_now(),
            class: signer.class.name().into(),
            key: signer.key.public().id(),
            program: concat!("elbowroom ", env!("CARGO_PKG_VERSION")).into(),
            action,
            note: signer.note.map(Into::into),
            changes,
            state: self.state.digest(),
            checksum: self.cell.approval.checksum.clone(),
            previous: log.head,
            signature: String::new(),
        }
        .signed(signer.key);
        let line = entry.line() + "\n";
        let written =
            || held.write_all(line.as_bytes()).and_then(|()| held.sync_all()).map_err(text_file::unwritable(&log.file));
        text_file::replace(path, &self.text, written)?;
        Ok(entry)
    }
}

impl CellEdit {
    /// The tables that the edit may change.
    fn items(&self, draft: &Draft) -> Result<Vec<String>> {
        Ok(match self {
            Self::Add { toml, from } => {
                let names = CellFile::parse(from, toml)?.region_names();
                names.into_iter().map(|name| format!("region.{name}")).collect()
            }
            Self::Change { region, .. } | Self::Remove { region } => vec![format!("region.{region}")],
            // Laws have per-robot settings.
            Self::Laws { .. } => {
                let robots = draft.cell.robots.iter().map(|r| format!("robot.{}", r.name));
                std::iter::once("monitor".to_owned()).chain(robots).collect()
            }
        })
    }

    fn action(&self, items: &[String]) -> String {
        match self {
            Self::Add { .. } => format!("add {}", items.join(", ")),
            Self::Change { .. } => format!("change {}", items.join(", ")),
            Self::Remove { .. } => format!("remove {}", items.join(", ")),
            Self::Laws { .. } => "change monitor".into(),
        }
    }
}

/// The text of the cell file after the edit.
fn edited(cell: &Path, text: &str, edit: &CellEdit) -> Result<String> {
    let mut document = document(cell, text)?;
    match edit {
        CellEdit::Add { toml, from } => {
            return added(cell, &document, text, toml, from);
        }
        CellEdit::Change { region, set, unset } => {
            let table = tables_with(&mut document, region).and_then(|t| t.get_mut(region));
            let table = table.and_then(Item::as_table_like_mut);
            change(cell, table.ok_or_else(|| unknown(cell, text, region))?, &format!("region.{region}"), set, unset)?;
        }
        CellEdit::Remove { region } => {
            let tables = tables_with(&mut document, region);
            tables.and_then(|t| t.remove(region)).ok_or_else(|| unknown(cell, text, region))?;
        }
        CellEdit::Laws { set, unset } => {
            let item = document.as_table_mut().entry("monitor").or_insert_with(toml_edit::table);
            let what = || Diagnostic::new(cell, None, "`monitor` is no table").hint("[monitor]");
            change(cell, item.as_table_like_mut().ok_or_else(what)?, "monitor", set, unset)?;
        }
    }
    Ok(document.to_string())
}

fn document(path: &Path, text: &str) -> Result<DocumentMut> {
    // The file was already parsed; errors there have lines.
    text.parse().map_err(|e: toml_edit::TomlError| Diagnostic::new(path, None, e.message().to_owned()))
}

/// The tables that hold this region: those of `[region.NAME]` or of `[fence.NAME]`.
fn tables_with<'d>(document: &'d mut DocumentMut, region: &str) -> Option<&'d mut dyn TableLike> {
    let word = REGION_TABLES.into_iter().find(|word| has(document, word, region))?;
    document.get_mut(word).and_then(Item::as_table_like_mut)
}

fn has(document: &DocumentMut, word: &str, name: &str) -> bool {
    document.get(word).and_then(Item::as_table_like).is_some_and(|tables| tables.contains_key(name))
}

fn unknown(cell: &Path, text: &str, region: &str) -> Diagnostic {
    let names: Vec<String> = CellFile::parse(cell, text).map(|f| f.region_names()).unwrap_or_default();
    Diagnostic::new(cell, None, format!("there is no region `{region}`"))
        .hint(elbowroom_formats::suggest::hint(region, names.iter().map(String::as_str)))
}

/// Appends the tables as written.
fn added(cell: &Path, document: &DocumentMut, text: &str, toml: &str, from: &Path) -> Result<String> {
    let new = CellFile::parse(from, toml)?;
    let wrong = |line: Option<usize>, what: String| {
        Diagnostic::new(from, line, what).hint("[region.NAME] and its keys, as `elbowroom teach` prints them")
    };
    let first = toml.lines().map(str::trim).find(|l| !l.is_empty() && !l.starts_with('#'));
    if !first.is_some_and(|l| l.starts_with('[')) {
        return Err(wrong(None, "holds no region, or keys outside of [region.NAME]".into()));
    }
    if let Some(e) = new.entries.iter().find(|e| !REGION_TABLES.contains(&e.key.as_str())) {
        return Err(wrong(Some(e.line), format!("`{}` is neither a region nor a fence", e.key)));
    }
    let names = new.region_names();
    let is_known = |name: &&String| REGION_TABLES.iter().any(|word| has(document, word, name));
    if let Some(name) = names.iter().find(is_known) {
        let what = format!("there is a region `{name}` already");
        let hint = format!("elbowroom region change {} {name} KEY=VALUE --as CLASS --key FILE", cell.display());
        return Err(Diagnostic::new(cell, None, what).hint(hint));
    }
    let gap = if toml.starts_with('\n') { "" } else { "\n" };
    Ok(format!("{}\n{gap}{}\n", text.trim_end_matches('\n'), toml.trim_end_matches('\n')))
}

fn change(
    cell: &Path,
    table: &mut dyn TableLike,
    name: &str,
    set: &[(String, String)],
    unset: &[String],
) -> Result<()> {
    for key in unset {
        if table.remove(key).is_none() {
            return Err(Diagnostic::new(cell, None, format!("`{name}` has no key `{key}` to take out")));
        }
    }
    for (key, value) in set {
        put(table, key, value.parse().unwrap_or_else(|_| Value::from(value.as_str())));
    }
    Ok(())
}

/// Sets a key; whitespace and comments around an existing value stay.
fn put(table: &mut dyn TableLike, key: &str, mut value: Value) {
    if let Some(old) = table.get_mut(key).and_then(Item::as_value_mut) {
        *value.decor_mut() = old.decor().clone();
        *old = value;
    } else {
        table.insert(key, Item::Value(value));
    }
}
