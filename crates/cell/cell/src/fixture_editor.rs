//! Drawn fixtures in the text of a cell file.

use std::fs::File;
use std::path::{Path, PathBuf};

use elbowroom_access::text_file;
use elbowroom_formats::Diagnostic;
use toml_edit::{Item, TableLike, Value};

use crate::shield_report::ShieldReport;
use crate::toml_edits::{appended, document, put, with_line_ends_of};
use crate::{Cell, CellFile, CellFixture, DrawnFixture, Units, seal};

type Result<T> = std::result::Result<T, Diagnostic>;

/// The text of a cell file as it was read, into which drawn fixtures are written.
///
/// ```
/// use elbowroom_cell::{DrawnFixture, DrawnTarget, FixtureEditor};
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("cell.toml");
/// # std::fs::write(&path, r#"
/// # version = 1
/// # units = { length = "mm", angle = "deg" }
/// # [object.block]
/// # shape = "box"
/// # size = [80, 80, 40]
/// # at = [0, 0, 80]
/// # "#)?;
/// let mut editor = FixtureEditor::read(&path)?;
/// let target = DrawnTarget::Line(vec![[0.0, 0.0, 0.1], [0.03, 0.02, 0.1]]);
/// let draft = editor.draft(&DrawnFixture::new("cut", "block", target, 0.01))?;
/// assert!(draft.report()?.closed && draft.table().starts_with("[fixture.cut]"));
/// editor.write(&draft)?;
/// assert!(std::fs::read_to_string(&path)?.ends_with(draft.table()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct FixtureEditor {
    path: PathBuf,
    text: String,
}

/// A cell file with a drawn fixture, before it is written.
#[derive(Debug)]
pub struct FixtureDraft {
    drawn: DrawnFixture,
    before: String,
    text: String,
    table: String,
    replaces: bool,
    cell: Cell,
    index: usize,
}

impl FixtureEditor {
    /// Reads a cell file.
    ///
    /// # Errors
    /// [`Diagnostic`] if it cannot be read.
    pub fn read(path: &Path) -> Result<Self> {
        Ok(Self { path: path.to_owned(), text: text_file::read(path)? })
    }

    /// Adds a drawn fixture to the text, or replaces the target of the fixture of its name, and resolves the whole
    /// cell. Nothing is written.
    ///
    /// # Errors
    /// [`Diagnostic`] if the name cannot be used, another kind of fixture has it, or the changed cell is not valid.
    pub fn draft(&self, drawn: &DrawnFixture) -> Result<FixtureDraft> {
        drawn.check(&self.path)?;
        let units = CellFile::parse(&self.path, &self.text)?.units()?;
        let (text, table, replaces) = self.edited(drawn, units)?;
        let cell = CellFile::parse(&self.path, &text)?.resolve()?;
        let index = cell.guidance.fixtures.iter().position(|f| f.name == drawn.name);
        let index = index.ok_or_else(|| Diagnostic::new(&self.path, None, "the drawn fixture is not in the cell"))?;
        Ok(FixtureDraft { drawn: drawn.clone(), before: self.text.clone(), text, table, replaces, cell, index })
    }

    /// Writes a draft into the cell file, completely or not at all.
    ///
    /// # Errors
    /// [`Diagnostic`] if the shield of the draft cannot be made, the cell is sealed, the file is not as it was read, or
    /// cannot be written. Then nothing is changed.
    pub fn write(&mut self, draft: &FixtureDraft) -> Result<()> {
        draft.report()?;
        self.refusal()?;
        let _held = hold_folder(&self.path);
        text_file::replace(&self.path, &draft.text, || {
            // The last moment before the file is replaced.
            let is_same = self.text == draft.before && text_file::read(&self.path)? == draft.before;
            if is_same { Ok(()) } else { Err(self.changed()) }
        })?;
        self.text.clone_from(&draft.text);
        Ok(())
    }

    /// Checks whether fixtures may be written: not into a sealed cell.
    ///
    /// # Errors
    /// [`Diagnostic`] with what to do instead.
    pub fn refusal(&self) -> Result<()> {
        if !seal::is_guarded(&self.path)? {
            return Ok(());
        }
        let what = "is sealed: a drawn fixture is not written into it without the key of an integrator";
        let hint = format!(
            "the table into the file with an editor; then elbowroom region seal {} --as integrator --key FILE (docs/roles.md)",
            self.path.display()
        );
        Err(Diagnostic::new(&self.path, None, what).hint(hint))
    }

    fn changed(&self) -> Diagnostic {
        let what = "has changed since it was read, and is not overwritten";
        Diagnostic::new(&self.path, None, what)
            .hint("copy the table, end `elbowroom view`, start it again, and draw or paste it there")
    }

    /// The text with the fixture, its table, and whether it replaces a target.
    fn edited(&self, drawn: &DrawnFixture, units: Units) -> Result<(String, String, bool)> {
        let keys = drawn.keys(units);
        let table =
            keys.iter().fold(format!("[fixture.{}]\n", drawn.name), |t, (key, value)| t + key + " = " + value + "\n");
        let mut document = document(&self.path, &self.text)?;
        let wrong = |what: String, hint: &str| Diagnostic::new(&self.path, None, what).hint(hint);
        let Some(fixtures) = document.get_mut("fixture") else {
            return Ok((appended(&self.text, &table), table, false));
        };
        if fixtures.is_inline_table() {
            return Err(wrong("writes `fixture` as one value".into(), "a table [fixture.NAME] for each fixture"));
        }
        let Some(fixture) = fixtures.as_table_like_mut().and_then(|t| t.get_mut(&drawn.name)) else {
            return Ok((appended(&self.text, &table), table, false));
        };
        let fixture = fixture.as_table_like_mut().filter(|t| t.contains_key("target")).ok_or_else(|| {
            wrong(
                format!("has a fixture \"{}\" without a target: a guide, or a shield from a file", drawn.name),
                "another name",
            )
        })?;
        self.replace(fixture, drawn, &keys)?;
        Ok((with_line_ends_of(&self.text, &document.to_string()), table, true))
    }

    fn replace(&self, fixture: &mut dyn TableLike, drawn: &DrawnFixture, keys: &[(&str, String)]) -> Result<()> {
        if drawn.is_drill() {
            fixture.remove("depth");
        }
        for (key, value) in keys {
            let value: Value = value
                .parse()
                .map_err(|e: toml_edit::TomlError| Diagnostic::new(&self.path, None, e.message().to_owned()))?;
            // `target.line = …` becomes a key with a table.
            if !fixture.get(key).is_none_or(Item::is_value) {
                fixture.remove(key);
            }
            put(fixture, key, value);
        }
        Ok(())
    }
}

impl FixtureDraft {
    /// The fixture as it was drawn.
    pub fn drawn(&self) -> &DrawnFixture {
        &self.drawn
    }

    /// Its table as text of the cell file; the keys that a replaced table keeps are not in it.
    pub fn table(&self) -> &str {
        &self.table
    }

    /// Whether it replaces the target of a fixture that the file has.
    pub fn replaces(&self) -> bool {
        self.replaces
    }

    /// The cell with the fixture.
    pub fn cell(&self) -> &Cell {
        &self.cell
    }

    /// The fixture in [`Self::cell`].
    pub fn fixture(&self) -> &CellFixture {
        &self.cell.guidance.fixtures[self.index]
    }

    /// Whether the editor's text is still the one for which the draft was made.
    pub fn fits(&self, editor: &FixtureEditor) -> bool {
        self.before == editor.text
    }

    /// Reports on the shield, as `elbowroom fixture` does for the file once it is written.
    ///
    /// # Errors
    /// [`Diagnostic`] if the shield cannot be made.
    pub fn report(&self) -> Result<ShieldReport> {
        self.fixture().report(&self.cell)
    }
}

/// Keeps other editors from the folder of a file until it is dropped. Systems that cannot lock folders go without: then only
/// the comparison before the last step protects.
fn hold_folder(path: &Path) -> Option<File> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = File::open(folder).ok()?;
    folder.lock().ok()?;
    Some(folder)
}
