//! Recordings that robots play: CSV files beside the cell.

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
        if let Some(layout) = &self.layout {
            return layout.file(&self.rows);
        }
        let joints = self.rows.first().map_or(0, |(_, q)| q.len());
        let head: String = (1..=joints).map(|joint| format!(",joint_{joint}")).collect::<Vec<String>>().concat();
        let row = |(t_s, q): &(f64, Vec<f64>)| [&[*t_s], &q[..]].concat();
        CellFile::csv("recording", &format!("t_s{head}"), self.rows.iter().map(row))
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

    fn file(&self, rows: &[(f64, Vec<f64>)]) -> CellFile {
        let name = |joint: usize| if self.renames { format!("A{joint}") } else { format!("joint_{joint}") };
        // Other columns are skipped.
        let mut head = vec!["speed_override".to_owned()];
        head.extend((1..=self.slides.len()).map(name));
        let has_times = self.period_ms.is_none();
        head.extend(has_times.then(|| "clock".to_owned()));
        let row = |(t_s, q): &(f64, Vec<f64>)| {
            let mut row = vec![1.0];
            row.extend(q.iter().zip(&self.slides).map(|(value, slides)| self.in_file(*value, *slides)));
            row.extend(has_times.then_some(t_s / self.time_unit.1));
            row
        };
        CellFile::separated("recording", self.separator, &head.join(","), rows.iter().map(row))
    }

    fn in_file(&self, value: f64, slides: bool) -> f64 {
        match (slides, self.in_degrees) {
            (true, _) => value / self.length.1,
            (false, true) => value.to_degrees(),
            (false, false) => value,
        }
    }
}
