//! Joint states from CSV, fully checked before the first query.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use elbowroom_cell::QueryModel;
use elbowroom_formats::{FormatError, Warning};
use elbowroom_kinematics::{Chain, JointKind};

type Result<T> = std::result::Result<T, FormatError>;

/// Longest line, bytes.
const LONGEST_LINE: usize = 1 << 20;

/// Joint values of many states.
#[derive(Debug, Clone)]
pub struct JointStates {
    /// The file, for messages.
    pub file: PathBuf,
    /// Warnings.
    pub warnings: Vec<Warning>,
    /// Number of joint values of each robot, in the order of the model.
    widths: Vec<usize>,
    values: Vec<f64>,
    rows: usize,
}

impl JointStates {
    /// The default state of the model.
    pub fn start(model: &QueryModel) -> Self {
        Self {
            file: model.file.clone(),
            warnings: Vec::new(),
            widths: model.robots.iter().map(|r| r.start.len()).collect(),
            values: model.robots.iter().flat_map(|r| r.start.iter().copied()).collect(),
            rows: 1,
        }
    }

    /// Reads a file of states: a header of joint names in any order, then a row of radians (metres for prismatic
    /// joints) per state. Mimic joints have no column. With several robots the names are prefixed, `robot.joint`; with
    /// one they may be. A robot of a cell without any column stays at its start. The columns `index` and `t_s` are
    /// ignored.
    ///
    /// # Errors
    /// [`FormatError`] names the line and the column.
    pub fn read(path: &Path, model: &QueryModel) -> Result<Self> {
        let unreadable = |e: std::io::Error| {
            FormatError::new(path, None, format!("cannot be read: {e}"))
                .hint("a CSV file: a header of joint names, then rows of numbers")
        };
        let file = File::open(path).map_err(unreadable)?;
        if file.metadata().map_err(unreadable)?.is_dir() {
            return Err(FormatError::new(path, None, "is a folder").hint("a CSV file of joint states"));
        }
        Self::from_lines(path, BufReader::with_capacity(1 << 16, file), model)
    }

    /// As [`JointStates::read`], for text in place of the file `path`.
    ///
    /// # Errors
    /// As there.
    pub fn parse(path: &Path, text: &str, model: &QueryModel) -> Result<Self> {
        Self::from_lines(path, text.as_bytes(), model)
    }

    /// Number of states.
    pub fn len(&self) -> usize {
        self.rows
    }

    /// True without states.
    pub fn is_empty(&self) -> bool {
        self.rows == 0
    }

    /// The joint values of each robot in one state; nothing beyond the last state.
    pub fn of(&self, index: usize) -> impl Iterator<Item = (usize, &[f64])> {
        let all: usize = self.widths.iter().sum();
        let mut rest = self.values.get(index * all..(index + 1) * all).unwrap_or(&[]);
        self.widths.iter().enumerate().filter_map(move |(robot, width)| {
            let (q, after) = rest.split_at_checked(*width)?;
            rest = after;
            Some((robot, q))
        })
    }

    fn from_lines(path: &Path, mut source: impl BufRead, model: &QueryModel) -> Result<Self> {
        let mut states = Self { file: path.to_owned(), values: Vec::new(), rows: 0, ..Self::start(model) };
        let mut lines = Lines { path, number: 0, buffer: Vec::new() };
        let Some((line, header)) = lines.next(&mut source)? else {
            return Err(FormatError::new(path, 1, "is empty").hint(format!("the header {}", header_of(model))));
        };
        let header = Header::parse(path, line, header, model, &mut states.warnings)?;
        let start: Vec<f64> = model.robots.iter().flat_map(|r| r.start.iter().copied()).collect();
        let limits = ValueLimits::of(model);
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
            first.what = format!(
                "{}; {count} of {} states are beyond limits and are evaluated unchanged",
                first.what, states.rows
            );
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

/// Assignment of columns to joint values.
struct Header {
    names: Vec<String>,
    /// Per column its index among the values of a state; `None` for an ignored column.
    places: Vec<Option<usize>>,
}

impl Header {
    fn parse(path: &Path, line: usize, text: &str, model: &QueryModel, warnings: &mut Vec<Warning>) -> Result<Self> {
        let names: Vec<String> = text.split(',').map(|c| unquoted(c.trim()).to_owned()).collect();
        let wrong = |what: String| FormatError::new(path, line, what).hint(format!("the header {}", header_of(model)));
        if names.iter().all(|n| n.parse::<f64>().is_ok()) {
            return Err(wrong("has numbers where the joint names should be".into()));
        }
        if let Some((_, twice)) = names.iter().enumerate().find(|(i, n)| names[..*i].contains(n)) {
            return Err(wrong(format!("two columns are named `{twice}`")));
        }
        let mut places = vec![None; names.len()];
        let mut at = 0;
        for robot in &model.robots {
            let chain = &robot.robot.chain;
            let mut missing = Vec::new();
            let mut found = 0;
            for id in chain.active_joints() {
                let joint = &chain.joints()[id.0].name;
                match column(&names, model, &robot.name, joint) {
                    Some(c) => {
                        places[c] = Some(at);
                        found += 1;
                    }
                    None => missing.push(full(model, &robot.name, joint)),
                }
                at += 1;
            }
            // A robot of a cell without columns stays at its start.
            if found == 0 && !model.is_single_robot && model.robots.len() > 1 {
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
            return Err(wrong(format!("column `{name}` {}", why_stray(model, name))));
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
                    let what = format!("column `{name}` holds \"{}\", which is not a finite number", shown(cell));
                    return Err(FormatError::new(path, line, what).hint("radians, metres for a prismatic joint: 0.25"));
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

/// Limits of all values of a state.
struct ValueLimits {
    bounds: Vec<(String, f64, f64)>,
}

impl ValueLimits {
    fn of(model: &QueryModel) -> Self {
        let of_robot = |r: &elbowroom_cell::QueryRobot| {
            let chain = &r.robot.chain;
            let joint = |id: &elbowroom_kinematics::JointId| {
                let joint = &chain.joints()[id.0];
                (full(model, &r.name, &joint.name), joint.limits.lower, joint.limits.upper)
            };
            chain.active_joints().iter().map(joint).collect::<Vec<_>>()
        };
        Self { bounds: model.robots.iter().flat_map(of_robot).collect() }
    }

    fn broken(&self, values: &[f64]) -> Option<usize> {
        let beyond = |(v, (_, lower, upper)): (&f64, &(String, f64, f64))| *v < lower - 1e-9 || *v > upper + 1e-9;
        values.iter().zip(&self.bounds).position(beyond)
    }

    fn warning(&self, path: &Path, line: usize, joint: usize, value: f64) -> Warning {
        let (name, lower, upper) = &self.bounds[joint];
        // A common mistake: values in degrees.
        let degrees = if value.abs() > 6.3 && *upper < 6.3 { "; are these degrees?" } else { "" };
        let what = format!("`{name}` is {value}, beyond its limits {lower:.4} to {upper:.4}{degrees}");
        Warning::new(path, line, what)
    }
}

fn column(names: &[String], model: &QueryModel, robot: &str, joint: &str) -> Option<usize> {
    let prefixed = format!("{robot}.{joint}");
    let is_single = model.robots.len() == 1;
    names.iter().position(|n| *n == prefixed).or_else(|| names.iter().position(|n| is_single && n == joint))
}

fn full(model: &QueryModel, robot: &str, joint: &str) -> String {
    if model.robots.len() == 1 { joint.to_owned() } else { format!("{robot}.{joint}") }
}

/// A valid header.
fn header_of(model: &QueryModel) -> String {
    let joints = model.robots.iter().flat_map(|r| {
        let chain = &r.robot.chain;
        chain.active_joints().iter().map(|id| full(model, &r.name, &chain.joints()[id.0].name)).collect::<Vec<_>>()
    });
    joints.collect::<Vec<_>>().join(",")
}

fn why_stray(model: &QueryModel, name: &str) -> String {
    for r in &model.robots {
        let chain: &Chain = &r.robot.chain;
        let Some(id) = chain.joint(name.strip_prefix(&format!("{}.", r.name)).unwrap_or(name)) else { continue };
        let joint = &chain.joints()[id.0];
        if joint.kind == JointKind::Fixed {
            return "is a fixed joint: it has no value".into();
        }
        if let Some(source) = chain.mimic_source(id) {
            return format!("is a mimic joint: it follows `{}` and has no column", chain.joints()[source.joint.0].name);
        }
        return format!("must name the robot: `{}.{name}`", r.name);
    }
    "is not a joint".into()
}

/// Removes the quotation marks that some programs put around every cell.
fn unquoted(cell: &str) -> &str {
    cell.strip_prefix('"').and_then(|c| c.strip_suffix('"')).map_or(cell, str::trim)
}

/// At most 40 characters.
fn shown(cell: &str) -> String {
    if cell.chars().count() > 40 { cell.chars().take(39).chain(['…']).collect() } else { cell.to_owned() }
}
