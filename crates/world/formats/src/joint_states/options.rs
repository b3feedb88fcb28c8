//! What a reader of joint states requires.

use elbowroom_kinematics::Chain;

use crate::csv;

/// A robot whose joint values are in a file.
#[derive(Debug, Clone, Copy)]
pub struct JointStateRobot<'a> {
    /// Prefix of its columns; empty for a single robot without a name.
    pub name: &'a str,
    /// Its joints.
    pub chain: &'a Chain,
    /// Values, in the order of the chain, for a file that has no column for the robot; they are used with a warning.
    ///
    /// `None` makes the missing columns an error.
    pub default_q: Option<&'a [f64]>,
}

/// Treatment of the column `t_s`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeColumn {
    /// The column is skipped.
    Ignored,
    /// The column must be present and increase from row to row. At least one row is required.
    Required,
}

/// Treatment of columns other than joints, `t_s` and `index`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExtraColumns {
    /// Such columns are errors.
    Refused,
    /// Such columns are skipped with a warning.
    Skipped,
}

/// Treatment of values beyond a joint's limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitCheck {
    /// Limits are not checked.
    None,
    /// One warning names the first value beyond limits and the number of states with such values.
    Warn,
    /// Values beyond limits are errors.
    Refuse,
}

/// Requirements on a file of joint states.
#[derive(Debug, Clone)]
pub struct JointStateOptions<'a> {
    /// The robots, in the order in which their values are returned.
    pub robots: Vec<JointStateRobot<'a>>,
    /// Treatment of the column `t_s`.
    pub time: TimeColumn,
    /// Treatment of other columns.
    pub extra_columns: ExtraColumns,
    /// Treatment of values beyond limits.
    pub limits: LimitCheck,
    /// Largest size of a file, bytes.
    pub max_bytes: u64,
}

impl<'a> JointStateOptions<'a> {
    /// Options for states of robots, in a file of any size, without times and other columns. Limits are not checked.
    pub fn states(robots: Vec<JointStateRobot<'a>>) -> Self {
        Self {
            robots,
            time: TimeColumn::Ignored,
            extra_columns: ExtraColumns::Refused,
            limits: LimitCheck::None,
            max_bytes: u64::MAX,
        }
    }

    /// Options for a trajectory of one robot, of at most 1 GiB.
    ///
    /// Times are required, values beyond limits are errors, and other columns are skipped.
    pub fn trajectory(name: &'a str, chain: &'a Chain) -> Self {
        Self {
            robots: vec![JointStateRobot { name, chain, default_q: None }],
            time: TimeColumn::Required,
            extra_columns: ExtraColumns::Skipped,
            limits: LimitCheck::Refuse,
            max_bytes: csv::MAX_BYTES,
        }
    }
}
