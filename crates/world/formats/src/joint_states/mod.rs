//! Joint states as CSV: the one reader of tables with a column per joint.
//!
//! The header names the joints, in any order. Every row is a state, in radians, or in metres for prismatic joints. Fixed
//! joints, and joints that follow another one (mimic), have no column. With several robots, names have the prefix of the
//! robot, `robot.joint`; with one robot the prefix is optional. The columns `t_s` (seconds) and `index` are optional.

mod options;

use std::collections::HashMap;
use std::io::BufRead;
use std::path::{Path, PathBuf};

use elbowroom_kinematics::{JointKind, JointTrajectory, TrajectoryRow};
use elbowroom_robot::RobotId;

use crate::Diagnostic;
use crate::csv::{self, CsvLines, missing_column};
use crate::location::Location;

pub use options::{ExtraColumns, JointStateOptions, JointStateRobot, LimitCheck, TimeColumn};

type Result<T> = std::result::Result<T, Diagnostic>;

/// Joint values of one or more robots, row by row, eight bytes each.
///
/// ```
/// use elbowroom_formats::joint_states::{JointStateOptions, JointStateRobot, JointStates};
/// use elbowroom_kinematics::{Chain, JointKind, Limits, dh::ClassicalRow};
/// use elbowroom_robot::RobotId;
/// let row = |name: &str| ClassicalRow {
///     joint: name.into(), kind: JointKind::Revolute, a: 0.3, alpha: 0.0, d: 0.5, theta: 0.0,
///     limits: Limits::symmetric(2.5),
/// };
/// let chain = Chain::from_dh("arm", &[row("shoulder"), row("elbow")])?;
/// let options =
///     JointStateOptions::states(vec![JointStateRobot { name: "arm", chain: &chain, default_q: None }]);
/// let states = JointStates::parse("q.csv".as_ref(), "elbow,arm.shoulder\n0.1,0.2\n", &options)?;
/// assert_eq!(states.q(0, RobotId(0)), [0.2, 0.1]);
/// let error = JointStates::parse("q.csv".as_ref(), "elbow\n0.1\n", &options).unwrap_err();
/// assert_eq!(error.message, "has no column `shoulder`; its columns are elbow");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct JointStates {
    /// Path of the file, for messages.
    pub file: PathBuf,
    /// Warnings for the user.
    pub warnings: Vec<Diagnostic>,
    /// Per robot: end of its values in a row.
    ends: Vec<usize>,
    values: Vec<f64>,
    times_s: Vec<f64>,
    rows: usize,
}

impl JointStates {
    /// Creates a single state from the joint values of each robot. `file` is named in messages.
    pub fn single<'q>(file: &Path, robots: impl IntoIterator<Item = &'q [f64]>) -> Self {
        let (mut ends, mut values) = (Vec::new(), Vec::new());
        for q in robots {
            values.extend_from_slice(q);
            ends.push(values.len());
        }
        Self { file: file.to_owned(), warnings: Vec::new(), ends, values, times_s: Vec::new(), rows: 1 }
    }

    /// Creates states from rows, each with the values of all robots side by side. `file` is named in messages.
    ///
    /// # Panics
    /// If the number of values is not a multiple of the number of joints.
    pub fn from_rows(file: &Path, joints: impl IntoIterator<Item = usize>, values: Vec<f64>) -> Self {
        let ends: Vec<usize> = joints
            .into_iter()
            .scan(0, |end, joints| {
                *end += joints;
                Some(*end)
            })
            .collect();
        let width = ends.last().copied().unwrap_or(0).max(1);
        assert!(values.len().is_multiple_of(width), "{} values in rows of {width}", values.len());
        let rows = values.len() / width;
        Self { file: file.to_owned(), warnings: Vec::new(), ends, values, times_s: Vec::new(), rows }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`Diagnostic`] with the line and the column.
    pub fn read(path: &Path, options: &JointStateOptions<'_>) -> Result<Self> {
        Self::from_lines(path, CsvLines::open(path, options.max_bytes)?, options)
    }

    /// Reads from a source such as standard input; `path` is named in messages. The size is not limited.
    ///
    /// # Errors
    /// The errors of [`JointStates::read`].
    pub fn read_from(path: &Path, source: impl BufRead, options: &JointStateOptions<'_>) -> Result<Self> {
        Self::from_lines(path, CsvLines::new(source, path), options)
    }

    /// Parses text; `path` is named in messages.
    ///
    /// # Errors
    /// The errors of [`JointStates::read`].
    pub fn parse(path: &Path, text: &str, options: &JointStateOptions<'_>) -> Result<Self> {
        Self::from_lines(path, CsvLines::new(text.as_bytes(), path), options)
    }

    /// Number of states.
    pub fn len(&self) -> usize {
        self.rows
    }

    /// Whether the number of states is 0.
    pub fn is_empty(&self) -> bool {
        self.rows == 0
    }

    /// Number of robots.
    pub fn robots(&self) -> usize {
        self.ends.len()
    }

    /// The joint values of one robot in one state, in the order of its chain: rad, or m for prismatic joints.
    ///
    /// # Panics
    /// If `state` or `robot` is out of range.
    pub fn q(&self, state: usize, RobotId(robot): RobotId) -> &[f64] {
        assert!(state < self.rows, "state {state} of {}", self.rows);
        let width = self.ends.last().copied().unwrap_or(0);
        let begin = if robot == 0 { 0 } else { self.ends[robot - 1] };
        &self.values[state * width..][begin..self.ends[robot]]
    }

    /// The time of each state, seconds; empty unless times are required.
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// The states of one robot over time; without rows unless times are required.
    ///
    /// # Panics
    /// If `robot` is out of range.
    pub fn trajectory(&self, robot: RobotId) -> JointTrajectory {
        let row = |(state, t_s): (usize, &f64)| TrajectoryRow { t_s: *t_s, q: self.q(state, robot).to_vec() };
        JointTrajectory::new(self.times_s.iter().enumerate().map(row).collect())
    }

    fn from_lines(path: &Path, mut lines: CsvLines<'_, impl BufRead>, options: &JointStateOptions<'_>) -> Result<Self> {
        let joints = Joints::new(options);
        let (mut last_line, mut warnings) = (1, Vec::new());
        let Some((at, header)) = lines.next()? else {
            return Err(Diagnostic::new(path, 1, "is empty").hint(format!("the header {}", joints.header())));
        };
        let header = Header::parse(at, header, &joints, &mut warnings)?;
        let defaults = joints.defaults();
        let mut states = Self {
            file: path.to_owned(),
            warnings,
            ends: joints.ends(),
            values: Vec::new(),
            times_s: Vec::new(),
            rows: 0,
        };
        let (mut beyond, mut first_beyond) = (0, None);
        while let Some((at, text)) = lines.next()? {
            last_line = at.line;
            let begin = states.values.len();
            states.values.extend_from_slice(&defaults);
            let row = &mut states.values[begin..];
            let time = header.read_row(at, text, row)?;
            states.times_s.extend(check_time(time, states.times_s.last(), at)?);
            states.rows += 1;
            match options.limits {
                LimitCheck::None => {}
                LimitCheck::Refuse => joints.refuse_beyond(row, at)?,
                LimitCheck::Warn => {
                    if let Some(joint) = joints.beyond(row, WARN_TOLERANCE) {
                        beyond += 1;
                        first_beyond.get_or_insert_with(|| joints.warning(joint, row[joint], at));
                    }
                }
            }
        }
        if let Some(mut first) = first_beyond {
            let what = &first.message;
            first.message =
                format!("{what}; {beyond} of {} states are beyond limits and are evaluated unchanged", states.rows);
            states.warnings.push(first);
        }
        if states.rows == 0 {
            if options.time == TimeColumn::Required {
                return Err(Diagnostic::new(path, 1, "has no rows").hint("rows of numbers below the header"));
            }
            states.warnings.push(Diagnostic::new(path, last_line, "there is no state below the header"));
        }
        Ok(states)
    }
}

fn check_time(time: Option<f64>, last: Option<&f64>, at: Location<'_>) -> Result<Option<f64>> {
    match (time, last) {
        (Some(t_s), Some(&last_s)) if t_s <= last_s => Err(csv::not_rising(t_s, last_s, at)),
        _ => Ok(time),
    }
}

/// Largest distances beyond the limits (rad or m) that cause no warning and no error, respectively.
const WARN_TOLERANCE: f64 = 1e-9;
const REFUSE_TOLERANCE: f64 = 1e-6;
/// A full turn (2π, rounded up), rad. Larger joint values are probably degrees if the limits are within a full turn.
const FULL_TURN_RAD: f64 = 6.3;

/// A joint with a column.
struct JointColumn {
    robot: RobotId,
    /// Name as in the chain, without prefix.
    name: String,
    lower: f64,
    upper: f64,
}

/// All joints with a column, in the order of the values of a row.
struct Joints<'a> {
    options: &'a JointStateOptions<'a>,
    list: Vec<JointColumn>,
}

impl<'a> Joints<'a> {
    fn new(options: &'a JointStateOptions<'a>) -> Self {
        let list = options.robots.iter().enumerate().flat_map(|(robot, r)| {
            let robot = RobotId(robot);
            r.chain.active_joints().iter().map(move |id| {
                let joint = &r.chain.joints()[id.0];
                let (lower, upper) = (joint.limits.lower, joint.limits.upper);
                JointColumn { robot, name: joint.name.clone(), lower, upper }
            })
        });
        Self { options, list: list.collect() }
    }

    fn ends(&self) -> Vec<usize> {
        let count = |robot: RobotId| self.list.iter().filter(|j| j.robot <= robot).count();
        (0..self.options.robots.len()).map(RobotId).map(count).collect()
    }

    /// Values of a row for robots without columns in the file; 0 for robots that must have columns.
    fn defaults(&self) -> Vec<f64> {
        let dof = |robot: RobotId| self.list.iter().filter(|j| j.robot == robot).count();
        let of_robot = |(robot, r): (usize, &JointStateRobot<'_>)| {
            let mut q = r.default_q.unwrap_or_default().to_vec();
            q.resize(dof(RobotId(robot)), 0.0);
            q
        };
        self.options.robots.iter().enumerate().flat_map(of_robot).collect()
    }

    fn prefixed(&self, joint: &JointColumn) -> String {
        format!("{}.{}", self.options.robots[joint.robot.0].name, joint.name)
    }

    /// The name that a user should write: with prefix if there are several robots.
    fn shown(&self, joint: &JointColumn) -> String {
        if self.options.robots.len() == 1 { joint.name.clone() } else { self.prefixed(joint) }
    }

    /// The header of a complete file.
    fn header(&self) -> String {
        let time = (self.options.time == TimeColumn::Required).then(|| "t_s".to_owned());
        time.into_iter().chain(self.list.iter().map(|j| self.shown(j))).collect::<Vec<_>>().join(",")
    }

    fn beyond(&self, values: &[f64], tolerance: f64) -> Option<usize> {
        let is_beyond = |(v, j): (&f64, &JointColumn)| *v < j.lower - tolerance || *v > j.upper + tolerance;
        values.iter().zip(&self.list).position(is_beyond)
    }

    fn refuse_beyond(&self, values: &[f64], at: Location<'_>) -> Result<()> {
        let Some(i) = self.beyond(values, REFUSE_TOLERANCE) else { return Ok(()) };
        let joint = &self.list[i];
        let what = format!("joint `{}` is at {}, outside its limits", self.shown(joint), values[i]);
        let hint = format!("radians (metres for a prismatic joint) from {} to {}", joint.lower, joint.upper);
        Err(at.diagnostic(what).hint(hint))
    }

    fn warning(&self, joint: usize, value: f64, at: Location<'_>) -> Diagnostic {
        let joint = &self.list[joint];
        let degrees =
            if value.abs() > FULL_TURN_RAD && joint.upper < FULL_TURN_RAD { "; are these degrees?" } else { "" };
        let (name, lower, upper) = (self.shown(joint), joint.lower, joint.upper);
        at.diagnostic(format!("`{name}` is {value}, beyond its limits {lower:.4} to {upper:.4}{degrees}"))
    }

    /// Why a column is not the column of an independent joint.
    fn why_extra(&self, name: &str) -> String {
        for r in &self.options.robots {
            let bare = name.strip_prefix(r.name).and_then(|n| n.strip_prefix('.')).unwrap_or(name);
            let Some(id) = r.chain.joint(bare) else { continue };
            if r.chain.joints()[id.0].kind == JointKind::Fixed {
                return "is a fixed joint: it has no value".into();
            }
            if let Some(source) = r.chain.mimic_source(id) {
                let source = &r.chain.joints()[source.joint.0].name;
                return format!("is a mimic joint: it follows `{source}` and has no column");
            }
            return format!("must name the robot: `{}.{name}`", r.name);
        }
        if name.contains([';', '\t']) { "is several: commas separate columns" } else { "is not a joint" }.into()
    }
}

/// Content of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Column {
    /// The value of a joint, by its index in a row.
    Joint(usize),
    Time,
    Skipped,
}

struct Header {
    names: Vec<String>,
    columns: Vec<Column>,
}

impl Header {
    fn parse(at: Location<'_>, text: &str, joints: &Joints<'_>, warnings: &mut Vec<Diagnostic>) -> Result<Self> {
        let names: Vec<String> = csv::cells(text).map(str::to_owned).collect();
        let wrong = |what: String| at.diagnostic(what).hint(format!("the header {}", joints.header()));
        if names.iter().all(|n| n.parse::<f64>().is_ok()) {
            return Err(wrong("has numbers where the joint names should be".into()));
        }
        if let Some(name) = csv::duplicate(&names) {
            return Err(wrong(format!("two columns are named `{name}`")));
        }
        let index_of: HashMap<&str, usize> = names.iter().enumerate().map(|(i, n)| (n.as_str(), i)).collect();
        let mut columns = vec![Column::Skipped; names.len()];
        let bare_names_count = joints.options.robots.len() == 1;
        let mut missing = vec![Vec::new(); joints.options.robots.len()];
        for (i, joint) in joints.list.iter().enumerate() {
            let bare = || index_of.get(joint.name.as_str()).filter(|_| bare_names_count);
            match index_of.get(joints.prefixed(joint).as_str()).or_else(bare) {
                Some(&column) => columns[column] = Column::Joint(i),
                None => missing[joint.robot.0].push(joints.shown(joint)),
            }
        }
        let no_column = |of: &str| wrong(missing_column(of, &names));
        for (robot, missing) in joints.options.robots.iter().zip(&missing) {
            if missing.len() == robot.chain.dof() && robot.default_q.is_some() {
                let what = format!("has no column for robot `{}`, which stays at its start", robot.name);
                warnings.push(at.diagnostic(what));
            } else if !missing.is_empty() {
                return Err(no_column(&missing.join("`, `")));
            }
        }
        if joints.options.time == TimeColumn::Required {
            columns[*index_of.get("t_s").ok_or_else(|| no_column("t_s"))?] = Column::Time;
        }
        let header = Self { names, columns };
        header.check_extra(at, joints, warnings)?;
        if !header.columns.iter().any(|c| matches!(c, Column::Joint(_))) {
            return Err(wrong("has no column of a joint".into()));
        }
        Ok(header)
    }

    fn check_extra(&self, at: Location<'_>, joints: &Joints<'_>, warnings: &mut Vec<Diagnostic>) -> Result<()> {
        let is_extra = |c: Column, name: &str| c == Column::Skipped && !["t_s", "index"].contains(&name);
        let mut extra = self.columns.iter().zip(&self.names).filter(|(c, name)| is_extra(**c, name)).map(|(_, n)| n);
        let Some(name) = extra.next() else { return Ok(()) };
        let hint = format!("the header {}", joints.header());
        match joints.options.extra_columns {
            ExtraColumns::Refused => {
                let what = format!("column `{name}` {}", joints.why_extra(name));
                Err(at.diagnostic(what).hint(hint))
            }
            ExtraColumns::Skipped => {
                let of = joints.options.robots.first().map_or("", |r| r.chain.name());
                let what = format!("column `{name}` is not a joint of \"{of}\": ignored");
                warnings.push(at.diagnostic(what).hint(hint));
                Ok(())
            }
        }
    }

    /// Reads the values of a row into `values`, and returns its time if times are required.
    fn read_row(&self, at: Location<'_>, text: &str, values: &mut [f64]) -> Result<Option<f64>> {
        let mut time = None;
        let mut cells = csv::cells(text);
        for (name, column) in self.names.iter().zip(&self.columns) {
            let Some(cell) = cells.next() else { return Err(csv::wrong_length(text, &self.names, at)) };
            match *column {
                Column::Skipped => {}
                Column::Time => time = Some(csv::finite(cell, name, at, "seconds: 0.25")?),
                Column::Joint(i) => {
                    values[i] = csv::finite(cell, name, at, "radians, metres for a prismatic joint: 0.25")?;
                }
            }
        }
        if cells.next().is_some() { Err(csv::wrong_length(text, &self.names, at)) } else { Ok(time) }
    }
}

#[cfg(test)]
mod tests;
