//! Joint states of a model, fully checked before the first query.

use std::io::BufRead;
use std::path::{Path, PathBuf};

use elbowroom_cell::{QueryModel, QueryRobot};
use elbowroom_formats::Diagnostic;
use elbowroom_formats::joint_states::{self, JointStateOptions, JointStateRobot, LimitCheck};
use elbowroom_robot::RobotId;

type Result<T> = std::result::Result<T, Diagnostic>;

/// The states of a query: joint values that fit its model.
#[derive(Debug, Clone)]
pub struct QueryStates {
    /// The file, for messages.
    pub file: PathBuf,
    /// Warnings.
    pub warnings: Vec<Diagnostic>,
    states: joint_states::JointStates,
}

impl QueryStates {
    /// The default state of the model.
    pub fn start(model: &QueryModel) -> Self {
        let start = model.robots.iter().map(|r| &r.start[..]);
        Self::new(joint_states::JointStates::single(&model.file, start))
    }

    /// Reads a file of states: a header of joint names in any order, then a row of radians (metres for prismatic
    /// joints) per state.
    ///
    /// Mimic joints have no column. With several robots the names have a prefix, `robot.joint`; with one robot the
    /// prefix is optional. A robot of a cell without any column stays at its start. The columns `index` and `t_s` are
    /// ignored.
    ///
    /// # Errors
    /// [`Diagnostic`] names the line and the column.
    pub fn read(path: &Path, model: &QueryModel) -> Result<Self> {
        joint_states::JointStates::read(path, &options(model)).map(Self::new)
    }

    /// Like [`QueryStates::read`], from a source such as standard input; messages name `path`.
    ///
    /// # Errors
    /// As for [`QueryStates::read`].
    pub fn read_from(path: &Path, source: impl BufRead, model: &QueryModel) -> Result<Self> {
        joint_states::JointStates::read_from(path, source, &options(model)).map(Self::new)
    }

    /// Like [`QueryStates::read`], for text in place of the file `path`.
    ///
    /// # Errors
    /// As for [`QueryStates::read`].
    pub fn parse(path: &Path, text: &str, model: &QueryModel) -> Result<Self> {
        joint_states::JointStates::parse(path, text, &options(model)).map(Self::new)
    }

    /// States from rows of the values of all joints of all robots, side by side in the order of the model, rad or m.
    /// Values beyond limits are accepted.
    ///
    /// # Panics
    /// If the number of values is not a multiple of the number of joints.
    pub fn of_rows(model: &QueryModel, values: Vec<f64>) -> Self {
        let joints = model.robots.iter().map(|robot| robot.robot.chain.dof());
        Self::new(joint_states::JointStates::from_rows(&model.file, joints, values))
    }

    fn new(mut states: joint_states::JointStates) -> Self {
        let warnings = std::mem::take(&mut states.warnings);
        Self { file: states.file.clone(), warnings, states }
    }

    /// Number of states.
    pub fn len(&self) -> usize {
        self.states.len()
    }

    /// True without states.
    pub fn is_empty(&self) -> bool {
        self.states.is_empty()
    }

    /// The joint values of each robot in one state; empty beyond the last state.
    pub fn of(&self, index: usize) -> impl Iterator<Item = (RobotId, &[f64])> {
        let robots = if index < self.len() { self.states.robots() } else { 0 };
        (0..robots).map(RobotId).map(move |robot| (robot, self.states.q(index, robot)))
    }
}

/// Values beyond limits are accepted, with a warning. Only in a cell with several robots may a robot have no column.
fn options(model: &QueryModel) -> JointStateOptions<'_> {
    let may_stay = !model.is_single_robot && model.robots.len() > 1;
    let robots = model.robots.iter().map(|r| robot(r, may_stay)).collect();
    JointStateOptions { limits: LimitCheck::Warn, ..JointStateOptions::states(robots) }
}

fn robot(robot: &QueryRobot, may_stay: bool) -> JointStateRobot<'_> {
    let default_q = may_stay.then_some(&robot.start[..]);
    JointStateRobot { name: &robot.name, chain: &robot.robot.chain, default_q }
}
