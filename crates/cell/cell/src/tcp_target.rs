//! Joint values for a pose of the TCP, selected from the solutions of inverse kinematics.

use std::fmt;

use elbowroom_kinematics::inverse::{ConfigurationChoice, IkOptions, IkSolver};
use elbowroom_spatial::Pose;

use crate::{CellIkError, CellRobot, TcpTarget, Units};

/// Why no joint values put the TCP of a robot at a target.
#[derive(Debug, Clone, PartialEq)]
pub enum TcpTargetError {
    /// Inverse kinematics has no solution.
    Ik(CellIkError),
    /// None of the solutions found is within the limits.
    NoPosture,
    /// The target is reached, but not in the configuration that it names.
    Configuration {
        /// The configuration that the target names.
        wanted: ConfigurationChoice,
        /// The configurations in which it is reached, sorted.
        others: Vec<String>,
    },
}

impl fmt::Display for TcpTargetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ik(error) => error.fmt(f),
            Self::NoPosture => f.write_str("no posture within the limits was found"),
            Self::Configuration { wanted, others } => {
                write!(f, "the target is not reached in the configuration {wanted}, but in {}", others.join(", "))
            }
        }
    }
}

impl std::error::Error for TcpTargetError {}

impl From<CellIkError> for TcpTargetError {
    fn from(error: CellIkError) -> Self {
        Self::Ik(error)
    }
}

impl From<Pose> for TcpTarget {
    /// A target that accepts any solution.
    fn from(in_world: Pose) -> Self {
        Self { in_world, configuration: ConfigurationChoice::default(), near: None }
    }
}

impl TcpTarget {
    /// Joint values for the TCP of a robot: the solution nearest to `near`, or else to `from`.
    ///
    /// # Errors
    /// [`TcpTargetError`] if no joint values are found.
    pub fn joint_values(&self, robot: &CellRobot, units: Units, from: &[f64]) -> Result<Vec<f64>, TcpTargetError> {
        let mut solver = robot.ik_solver();
        let seed = self.near.as_deref().unwrap_or(from);
        if self.configuration.is_open() {
            let found = solver.solve(&robot.base_in_world.inverse_mul(&self.in_world), seed);
            return found.map(|found| found.q).map_err(|e| CellIkError::new(e, units, &robot.robot.chain).into());
        }
        let all = solver.solve_all(&robot.base_in_world.inverse_mul(&self.in_world), seed);
        let chosen = self.choose(robot, units, from, all)?;
        Ok(chosen.into_iter().next().unwrap_or_default())
    }

    /// Selects the solutions that match the target, in their order; never empty.
    ///
    /// # Errors
    /// [`TcpTargetError`] if no solution matches.
    pub fn choose(
        &self,
        robot: &CellRobot,
        units: Units,
        from: &[f64],
        found: Vec<Vec<f64>>,
    ) -> Result<Vec<Vec<f64>>, TcpTargetError> {
        let mut solver = robot.ik_solver();
        if found.is_empty() {
            let why = solver.solve(&robot.base_in_world.inverse_mul(&self.in_world), from).err();
            let unreached = |e| CellIkError::new(e, units, &robot.robot.chain).into();
            return Err(why.map_or(TcpTargetError::NoPosture, unreached));
        }
        let chosen = self.with_configuration(&solver, found)?;
        let Some(near) = &self.near else { return Ok(chosen) };
        let distance = |q: &Vec<f64>| q.iter().zip(near).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        Ok(chosen.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).into_iter().collect())
    }

    fn with_configuration(&self, solver: &IkSolver, found: Vec<Vec<f64>>) -> Result<Vec<Vec<f64>>, TcpTargetError> {
        if self.configuration.is_open() {
            return Ok(found);
        }
        let (mut chosen, mut others) = (Vec::new(), Vec::new());
        for q in found {
            match solver.configuration(&q) {
                Some(is) if self.configuration.admits(&is) => chosen.push(q),
                Some(is) => others.push(is.to_string()),
                None => {}
            }
        }
        if chosen.is_empty() {
            others.sort();
            others.dedup();
            return Err(TcpTargetError::Configuration { wanted: self.configuration, others });
        }
        Ok(chosen)
    }
}

impl CellRobot {
    /// Inverse kinematics of the active TCP, in the robot's base.
    pub fn ik_solver(&self) -> IkSolver {
        IkSolver::new(&self.robot.chain, self.flange, self.tcp_in_flange, IkOptions::default())
    }
}
