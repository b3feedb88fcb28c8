//! Joint states from CSV, checked to the last row before anything is answered.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use elbowroom_formats::{FormatError, Warning};
use elbowroom_kinematics::{Chain, JointKind};

use super::Subject;

type Result<T> = std::result::Result<T, FormatError>;

/// Longest line that is read, bytes.
const LONGEST_LINE: usize = 1 << 20;

/// Joint values, eight bytes each.
#[derive(Debug, Clone)]
pub struct States {
    /// The file, for messages.
    pub file: PathBuf,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// Joint values of each robot, in the order of its chain.
    widths: Vec<usize>,
    values: Vec<f64>,
    rows: usize,
}

impl States {
    /// The one state in which the subject is unless told otherwise.
    pub fn start(subject: &Subject) -> Self {
        Self {
            file: subject.file.clone(),
            warnings: Vec::new(),
            widths: subject.robots.iter().map(|r| r.start.len()).collect(),
            values: subject.robots.iter().flat_map(|r| r.start.iter().copied()).collect(),
            rows: 1,
        }
    }

    /// Reads a file of states: a header of joint names in any order, then a row of radians (metres for sliding joints)
    /// per state. Mimic joints have no column. With several robots the names are prefixed, `robot.joint`; with one they
    /// may be. A robot of a cell without any column stays at its start. Columns `index` and `t_s` are passed over.
    ///
    /// # Errors
    /// [`FormatError`] names the line and the column.
    pub fn read(path: &Path, subject: &Subject) -> Result<Self> {
        let unreadable = |e: std::io::Error| {
            FormatError::new(path, None, format!("cannot be read: {e}"))
                .hint("a CSV file: a header of joint names, then rows of numbers")
        };
        let file = File::open(path).map_err(unreadable)?;
        if file.metadata().map_err(unreadable)?.is_dir() {
            return Err(FormatError::new(path, None, "is a folder").hint("a CSV file of joint states"));
        }
        Self::from_lines(path, BufReader::with_capacity(1 << 16, file), subject)
    }

    /// [`States::read`] of text that stands in the file `path`.
    ///
    /// # Errors
    /// As there.
    pub fn parse(path: &Path, text: &str, subject: &Subject) -> Result<Self> {
        Self::from_lines(path, text.as_bytes(), subject)
    }

    /// Number of states.
    pub fn len(&self) -> usize {
        self.rows
    }

    /// True where there is none.
    pub fn is_empty(&self) -> bool {
        self.rows == 0
    }

    /// The joint values of each robot in one state; none beyond the last.
    pub fn of(&self, index: usize) -> impl Iterator<Item = (usize, &[f64])> {
        let all: usize = self.widths.iter().sum();
        let mut rest = self.values.get(index * all..(index + 1) * all).unwrap_or(&[]);
        self.widths.iter().enumerate().filter_map(move |(robot, width)| {
            let (q, after) = rest.split_at_checked(*width)?;
            rest = after;
            Some((robot, q))
        })
    }

    fn from_lines(path: &Path, mut source: impl BufRead, subject: &Subject) -> Result<Self> {
        let mut states = Self { file: path.to_owned(), values: Vec::new(), rows: 0, ..Self::start(subject) };
        let mut lines = Lines { path, number: 0, buffer: Vec::new() };
        let Some((line, header)) = lines.next(&mut source)? else {
            return Err(FormatError::new(path, 1, "is empty").hint(format!("the header {}", header_of(subject))));
        };
        let header = Header::parse(path, line, header, subject, &mut states.warnings)?;
        let start: Vec<f64> = subject.robots.iter().flat_map(|r| r.start.iter().copied()).collect();
        let limits = Limits::of(subject);
        let mut beyond: (usize, Option<Warning>) = (0, None);
        while let Some((line, text)) = lines.next(&mut source)? {
            let row = states.values.len();
            states.values.extend_from_slice(&start);
            header.row(path, line, text, &mut states.values[row..])?;
            states.rows += 1;
            if let Some(joint) = limits.broken(&states.values[row..]) {
                beyond.0 += 1;
                beyond.1.get_or_insert_with(|| limits.warning(path, line, joint, states.values[row + joint]));
            }
        }
        if let (count, Some(mut first)) = beyond {
            first.what =
                format!("{}; {count} of {} states are beyond limits and answered as they are", first.what, states.rows);
            states.warnings.push(first);
        }
        if states.rows == 0 {
            states.warnings.push(Warning::new(path, lines.number, "there is no state below the header"));
        }
        Ok(states)
    }
}

/// Lines that are not blank, with their numbers.
struct Lines<'a> {
    path: &'a Path,
    number: usize,
    buffer: Vec<u8>,
}

impl Lines<'_> {
    fn next(&mut self, source: &mut impl BufRead) -> Result<Option<(usize, &str)>> {
        loop {
            self.buffer.clear();
            self.number += 1;
            let wrong = |what: String| {
                FormatError::new(self.path, self.number, what).hint("a text file of comma-separated numbers")
            };
            let mut limited = std::io::Read::take(&mut *source, LONGEST_LINE as u64);
            let read =
                limited.read_until(b'\n', &mut self.buffer).map_err(|e| wrong(format!("cannot be read: {e}")))?;
            if read == 0 {
                return Ok(None);
            }
            if read == LONGEST_LINE {
                return Err(wrong(format!("is longer than {LONGEST_LINE} bytes")));
            }
            if self.buffer.iter().all(u8::is_ascii_whitespace) {
                continue;
            }
            break;
        }
        let text = std::str::from_utf8(&self.buffer).map_err(|_| {
            FormatError::new(self.path, self.number, "is not UTF-8 text").hint("the file saved as UTF-8")
        })?;
        Ok(Some((self.number, text.trim_start_matches('\u{feff}').trim())))
    }
}

/// Where the columns go.
struct Header {
    names: Vec<String>,
    /// Per column the place among the values of a state; `None` where it is passed over.
    places: Vec<Option<usize>>,
}

impl Header {
    fn parse(path: &Path, line: usize, text: &str, subject: &Subject, warnings: &mut Vec<Warning>) -> Result<Self> {
        let names: Vec<String> = text.split(',').map(|c| unquoted(c.trim()).to_owned()).collect();
        let wrong =
            |what: String| FormatError::new(path, line, what).hint(format!("the header {}", header_of(subject)));
        if names.iter().all(|n| n.parse::<f64>().is_ok()) {
            return Err(wrong("has numbers where the joint names should be".into()));
        }
        if let Some((_, twice)) = names.iter().enumerate().find(|(i, n)| names[..*i].contains(n)) {
            return Err(wrong(format!("two columns are named `{twice}`")));
        }
        let mut places = vec![None; names.len()];
        let mut at = 0;
        for robot in &subject.robots {
            let chain = &robot.robot.chain;
            let mut missing = Vec::new();
            let mut found = 0;
            for id in chain.active_joints() {
                let joint = &chain.joints()[id.0].name;
                match column(&names, subject, &robot.name, joint) {
                    Some(c) => {
                        places[c] = Some(at);
                        found += 1;
                    }
                    None => missing.push(full(subject, &robot.name, joint)),
                }
                at += 1;
            }
            // A cell's robot that is not mentioned stands at its start.
            if found == 0 && !subject.alone && subject.robots.len() > 1 {
                let what = format!("has no column for robot `{}`, which stays at its start", robot.name);
                warnings.push(Warning::new(path, line, what));
            } else if !missing.is_empty() {
                return Err(wrong(format!(
                    "has no column `{}`; its columns are {}",
                    missing.join("`, `"),
                    names.join(", ")
                )));
            }
        }
        let stray = |(c, name): &(usize, &String)| places[*c].is_none() && !["t_s", "index"].contains(&name.as_str());
        if let Some((_, name)) = names.iter().enumerate().find(stray) {
            return Err(wrong(format!("column `{name}` {}", why_stray(subject, name))));
        }
        if places.iter().all(Option::is_none) {
            return Err(wrong("has no column of a joint".into()));
        }
        Ok(Self { names, places })
    }

    fn row(&self, path: &Path, line: usize, text: &str, values: &mut [f64]) -> Result<()> {
        let mut cells = text.split(',');
        for (name, place) in self.names.iter().zip(&self.places) {
            let Some(cell) = cells.next() else { return Err(self.length(path, line, text)) };
            let cell = unquoted(cell.trim());
            let Some(place) = place else { continue };
            match cell.parse::<f64>() {
                Ok(v) if v.is_finite() => values[*place] = v,
                _ => {
                    let what = format!("column `{name}` holds \"{}\", which is no finite number", shown(cell));
                    return Err(FormatError::new(path, line, what).hint("radians, metres for a sliding joint: 0.25"));
                }
            }
        }
        if cells.next().is_some() { Err(self.length(path, line, text)) } else { Ok(()) }
    }

    fn length(&self, path: &Path, line: usize, text: &str) -> FormatError {
        let what = format!("has {} values for {} columns", text.split(',').count(), self.names.len());
        FormatError::new(path, line, what).hint(format!("a number for each of {}", self.names.join(",")))
    }
}

/// The limits of all values of a state.
struct Limits {
    bounds: Vec<(String, f64, f64)>,
}

impl Limits {
    fn of(subject: &Subject) -> Self {
        let of_robot = |r: &super::SubjectRobot| {
            let chain = &r.robot.chain;
            let joint = |id: &elbowroom_kinematics::JointId| {
                let joint = &chain.joints()[id.0];
                (full(subject, &r.name, &joint.name), joint.limits.lower, joint.limits.upper)
            };
            chain.active_joints().iter().map(joint).collect::<Vec<_>>()
        };
        Self { bounds: subject.robots.iter().flat_map(of_robot).collect() }
    }

    fn broken(&self, values: &[f64]) -> Option<usize> {
        let beyond = |(v, (_, lower, upper)): (&f64, &(String, f64, f64))| *v < lower - 1e-9 || *v > upper + 1e-9;
        values.iter().zip(&self.bounds).position(beyond)
    }

    fn warning(&self, path: &Path, line: usize, joint: usize, value: f64) -> Warning {
        let (name, lower, upper) = &self.bounds[joint];
        // Values that look like degrees are the commonest of mistakes.
        let degrees = if value.abs() > 6.3 && *upper < 6.3 { "; are these degrees?" } else { "" };
        let what = format!("`{name}` is {value}, beyond its limits {lower:.4} to {upper:.4}{degrees}");
        Warning::new(path, line, what)
    }
}

fn column(names: &[String], subject: &Subject, robot: &str, joint: &str) -> Option<usize> {
    let prefixed = format!("{robot}.{joint}");
    let bare = subject.robots.len() == 1;
    names.iter().position(|n| *n == prefixed).or_else(|| names.iter().position(|n| bare && n == joint))
}

fn full(subject: &Subject, robot: &str, joint: &str) -> String {
    if subject.robots.len() == 1 { joint.to_owned() } else { format!("{robot}.{joint}") }
}

/// The header that would do.
fn header_of(subject: &Subject) -> String {
    let joints = subject.robots.iter().flat_map(|r| {
        let chain = &r.robot.chain;
        chain.active_joints().iter().map(|id| full(subject, &r.name, &chain.joints()[id.0].name)).collect::<Vec<_>>()
    });
    joints.collect::<Vec<_>>().join(",")
}

fn why_stray(subject: &Subject, name: &str) -> String {
    for r in &subject.robots {
        let chain: &Chain = &r.robot.chain;
        let Some(id) = chain.joint(name.strip_prefix(&format!("{}.", r.name)).unwrap_or(name)) else { continue };
        let joint = &chain.joints()[id.0];
        if joint.kind == JointKind::Fixed {
            return "is a fixed joint: it has no value".into();
        }
        if let Some(source) = chain.mimic_source(id) {
            return format!("is a mimic joint: it follows `{}` and has no column", chain.joints()[source.joint.0].name);
        }
        return format!("must say which robot: `{}.{name}`", r.name);
    }
    "is no joint".into()
}

/// A cell without the quotation marks that some programs put around everything.
fn unquoted(cell: &str) -> &str {
    cell.strip_prefix('"').and_then(|c| c.strip_suffix('"')).map_or(cell, str::trim)
}

/// At most 40 characters of it.
fn shown(cell: &str) -> String {
    if cell.chars().count() > 40 { cell.chars().take(39).chain(['…']).collect() } else { cell.to_owned() }
}
