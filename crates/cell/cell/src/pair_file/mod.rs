//! The file of pairs: pairs that may touch, and pairs that are likely to (`pairs = "FILE"` in a cell, `--pairs FILE`).

mod counts;
mod read;
mod scene;
mod survey;

use std::fmt;
use std::path::PathBuf;

use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_robot::Exclusion;
use elbowroom_scene::{PairEdit, PairRule, PairRules, PairState, Selection};

use crate::QueryModel;

pub use counts::PairCounts;

/// Name of a side that stands for anything.
const ANYTHING: &str = "*";

/// A file of pairs.
///
/// ```
/// use elbowroom_cell::{Cell, PairFile, QueryModel};
/// let cell = Cell::parse("c.toml", r#"
/// version = 1
/// units = { length = "m", angle = "rad" }
/// [object.part]
/// shape = "sphere"
/// at = [0, 0, 0]
/// radius = 0.1
/// [object.table]
/// shape = "box"
/// at = [0, 0, -0.6]
/// size = [1, 1, 1]
/// "#)?;
/// let file = PairFile::parse("pairs.toml", r#"
/// version = 1
/// pairs = [{ a = "part", b = "table", reason = "it stands there" }]
/// "#)?;
/// let model = QueryModel::of_cell(&cell);
/// assert!(!file.rules(&model)?.is_empty());
/// let wrong = PairFile::parse("pairs.toml", "version = 1\npairs = [{ a = \"part\", b = \"tabel\", reason = \"-\" }]")?;
/// let error = wrong.rules(&model).unwrap_err();
/// assert!(error.line == Some(2) && error.to_string().contains("table"));
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
#[derive(Debug, Clone)]
pub struct PairFile {
    file: PathBuf,
    rows: Vec<PairRow>,
    /// Comments of the file, one per line.
    comments: Vec<String>,
}

/// A row of the file.
#[derive(Debug, Clone)]
struct PairRow {
    line: usize,
    sides: [String; 2],
    state: PairState,
    weight: Option<f64>,
    note: Note,
}

/// Origin and reason of a row.
#[derive(Debug, Clone)]
enum Note {
    /// Written by a person.
    Reason(String),
    /// Found by [`PairFile::survey`]; replaced when the file is written again.
    Found(String),
    /// A weight without a reason.
    None,
}

impl PairFile {
    /// Resolves the rows to rules for a model.
    ///
    /// # Errors
    /// An error at the line of a row that has a name that the model does not have, or links that are never tested.
    pub fn rules(&self, model: &QueryModel) -> Result<PairRules, Diagnostic> {
        let mut rules = PairRules::default();
        for row in &self.rows {
            rules.extend(self.rules_of(row, model)?);
        }
        Ok(rules)
    }

    fn rules_of(&self, row: &PairRow, model: &QueryModel) -> Result<impl Iterator<Item = PairRule>, Diagnostic> {
        let [a, b] = [self.side(row, 0, model)?, self.side(row, 1, model)?];
        if a == b && matches!(a, Selection::Link { .. } | Selection::Object(_)) {
            return Err(self.error(row, format!("\"{}\" is named twice", row.sides[0])).hint("two different names"));
        }
        if row.state == PairState::Tested && matches!(row.note, Note::Reason(_)) {
            self.check_can_be_tested(row, [a, b], model)?;
        }
        let note = match &row.note {
            Note::Reason(text) | Note::Found(text) => text.clone(),
            Note::None => String::new(),
        };
        let state = match row.state {
            PairState::Skipped => PairEdit::Skip(note),
            PairState::Tested => PairEdit::Test(note),
        };
        let rule = move |edit| PairRule { a, b, edit };
        Ok(std::iter::once(state).chain(row.weight.map(PairEdit::Weight)).map(rule))
    }

    fn side(&self, row: &PairRow, side: usize, model: &QueryModel) -> Result<Selection, Diagnostic> {
        let name = &row.sides[side];
        if name == ANYTHING {
            return Ok(Selection::All);
        }
        model.selection(name).ok_or_else(|| {
            let known = model.names();
            self.error(row, format!("\"{name}\" is no robot, link or object"))
                .hint(suggest::hint(name, known.iter().map(String::as_str)))
        })
    }

    fn check_can_be_tested(&self, row: &PairRow, sides: [Selection; 2], model: &QueryModel) -> Result<(), Diagnostic> {
        let [Selection::Link { robot, link: a }, Selection::Link { robot: other, link: b }] = sides else {
            return Ok(());
        };
        let [a_name, b_name] = &row.sides;
        let why = match model.robots[robot.0].robot.exclusion(a, b).filter(|_| robot == other) {
            Some(Exclusion::Adjacent) => "adjacent: such links touch where they are joined",
            Some(Exclusion::NoJointBetween) => "no pair: no joint moves one against the other",
            Some(Exclusion::Srdf(_)) | None => return Ok(()),
        };
        let what = format!("\"{a_name}\" and \"{b_name}\" are {why}; they cannot be tested");
        Err(self.error(row, what).hint("no row for them"))
    }

    fn error(&self, row: &PairRow, what: String) -> Diagnostic {
        Diagnostic::new(&self.file, row.line, what)
    }
}

/// Writes the text of the file, which [`PairFile::parse`] reads.
impl fmt::Display for PairFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "# Pairs of links and objects; docs/query.md describes this file.\nversion = 1\npairs = [")?;
        let by_hand = |row: &&PairRow| !matches!(row.note, Note::Found(_));
        writeln!(f, "  # By hand: these rows are kept when the file is written again.")?;
        self.rows.iter().filter(by_hand).try_for_each(|row| writeln!(f, "  {row},"))?;
        writeln!(f, "  # Found: to keep a change of one of these rows, write `reason` in place of `found`.")?;
        self.rows.iter().filter(|row| !by_hand(row)).try_for_each(|row| writeln!(f, "  {row},"))?;
        writeln!(f, "]")?;
        self.comments.iter().try_for_each(|line| writeln!(f, "# {line}"))
    }
}

impl fmt::Display for PairRow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = |text: &str| toml_edit::Value::from(text).to_string();
        let [a, b] = &self.sides;
        write!(f, "{{ a = {}, b = {}, state = \"{}\"", text(a), text(b), self.state)?;
        if let Some(weight) = self.weight {
            write!(f, ", weight = {weight:?}")?;
        }
        match &self.note {
            Note::Reason(why) => write!(f, ", reason = {}", text(why))?,
            Note::Found(why) => write!(f, ", found = {}", text(why))?,
            Note::None => {}
        }
        f.write_str(" }")
    }
}
