//! Recordings that robots play: CSV files beside the cell.

use std::fmt::Write as _;

use super::files::CellFile;

/// Rows of time (s) and joint values (rad or m).
#[derive(Debug, Clone)]
pub struct RecordingSpec {
    pub rows: Vec<(f64, Vec<f64>)>,
    /// How the file says so; by default as the cell's own recordings, without a table.
    pub layout: Option<RecordingLayout>,
}

/// The layout of a controller's file, which the table `trajectory` describes.
#[derive(Debug, Clone, Default)]
pub struct RecordingLayout {
    /// Whether each joint slides.
    pub slides: Vec<bool>,
    pub in_degrees: bool,
    /// Name of the unit of lengths, and its size, m.
    pub length: (&'static str, f64),
    /// Name of the unit of times, and its size, s.
    pub time_unit: (&'static str, f64),
    pub renames: bool,
    pub separator: char,
    /// Rest at the first row, s.
    pub offset_s: f64,
    /// Time from row to row, ms, for a file without times; the rows have these times.
    pub period_ms: Option<f64>,
}

impl RecordingSpec {
    pub fn offset_s(&self) -> f64 {
        self.layout.as_ref().map_or(0.0, |layout| layout.offset_s)
    }

    /// The value of the key `trajectory`.
    pub(super) fn value(&self) -> String {
        let file = self.file().name;
        self.layout.as_ref().map_or_else(|| format!("\"{file}\""), |layout| layout.table(&file))
    }

    pub(super) fn file(&self) -> CellFile {
        CellFile::csv("recording", self.layout.as_ref().map_or_else(|| self.csv(), |layout| layout.csv(&self.rows)))
    }

    fn csv(&self) -> String {
        let joints = self.rows.first().map_or(0, |(_, q)| q.len());
        let mut text = String::from("t_s");
        for joint in 1..=joints {
            let _ = write!(text, ",joint_{joint}");
        }
        for (t_s, q) in &self.rows {
            let _ = write!(text, "\n{t_s}");
            for value in q {
                let _ = write!(text, ",{value}");
            }
        }
        text + "\n"
    }
}

impl RecordingLayout {
    fn table(&self, file: &str) -> String {
        let mut keys = vec![format!("file = \"{file}\"")];
        if self.in_degrees {
            keys.push("angle = \"deg\"".to_owned());
        }
        if self.length.0 != "m" {
            keys.push(format!("length = \"{}\"", self.length.0));
        }
        match self.period_ms {
            Some(period_ms) => keys.push(format!("period_ms = {period_ms}")),
            None => keys.push(format!("time = \"clock\", time_unit = \"{}\"", self.time_unit.0)),
        }
        if self.renames {
            let columns: Vec<String> = (1..=self.slides.len()).map(|j| format!("joint_{j} = \"A{j}\"")).collect();
            keys.push(format!("columns = {{ {} }}", columns.join(", ")));
        }
        if self.offset_s > 0.0 {
            keys.push(format!("offset = {}", self.offset_s));
        }
        format!("{{ {} }}", keys.join(", "))
    }

    fn csv(&self, rows: &[(f64, Vec<f64>)]) -> String {
        let name = |joint: usize| if self.renames { format!("A{joint}") } else { format!("joint_{joint}") };
        let mut head: Vec<String> = (1..=self.slides.len()).map(name).collect();
        // Other columns are skipped.
        head.insert(0, "speed_override".to_owned());
        if self.period_ms.is_none() {
            head.push("clock".to_owned());
        }
        let mut text = head.join(&self.separator.to_string()) + "\n";
        for (t_s, q) in rows {
            let mut cells = vec![1.0];
            cells.extend(q.iter().zip(&self.slides).map(|(value, slides)| self.in_file(*value, *slides)));
            if self.period_ms.is_none() {
                cells.push(t_s / self.time_unit.1);
            }
            let cells: Vec<String> = cells.iter().map(|cell| self.number(*cell)).collect();
            text += &(cells.join(&self.separator.to_string()) + "\n");
        }
        text
    }

    fn in_file(&self, value: f64, slides: bool) -> f64 {
        match (slides, self.in_degrees) {
            (true, _) => value / self.length.1,
            (false, true) => value.to_degrees(),
            (false, false) => value,
        }
    }

    /// A number; with a decimal comma where commas do not separate.
    fn number(&self, value: f64) -> String {
        if self.separator == ',' { value.to_string() } else { value.to_string().replace('.', ",") }
    }
}
