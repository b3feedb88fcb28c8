//! A straight line of the TCP: joint values by inverse kinematics, continuous from end to end.

use std::fmt;
use std::sync::{Mutex, PoisonError};

use elbowroom_cell::{CellIkError, CellRobot, Units};
use elbowroom_kinematics::TrajectoryPoint;
use elbowroom_kinematics::inverse::{IkOptions, IkSolver, IkTask};
use elbowroom_kinematics::{Chain, Limits};
use elbowroom_spatial::Pose;

/// Largest distance between two knots, m.
const KNOT_M: f64 = 0.01;
/// Largest rotation between two knots, rad.
const KNOT_RAD: f64 = 0.03;
/// Largest number of knots.
const MAX_KNOTS: f64 = 4000.0;
/// Half width of the difference stencil, as a fraction of the line.
const STENCIL: f64 = 5e-4;
/// A larger joint motion (rad, m) between two knots means a change of branch.
const JUMP: f64 = 0.5;

/// Samples between two knots. A joint that moves more than `BRANCH_CHANGE_SHARE` of its travel, and more than
/// `BRANCH_CHANGE` (rad, m), from one sample to the next changes its branch there.
const SAMPLES: usize = 8;
const BRANCH_CHANGE_SHARE: f64 = 0.6;
const BRANCH_CHANGE: f64 = 0.01;

/// A straight line of the TCP in the root frame.
#[derive(Debug)]
pub struct TcpLine {
    from: Pose,
    to: Pose,
    /// Joint values at equal steps of s.
    knots: Vec<Vec<f64>>,
    solver: Mutex<IkSolver>,
    /// Units of messages.
    units: Units,
    /// False if the chain has too few joints to keep the orientation.
    pub keeps_orientation: bool,
}

/// Reason why a line cannot be followed.
#[derive(Debug, Clone, PartialEq)]
pub struct LineError {
    /// Position of the failure, m from the start.
    pub at_m: f64,
    /// Its length, m.
    pub length_m: f64,
    /// The cause.
    pub why: LineFault,
}

/// Why the TCP cannot pass a point of a line.
#[derive(Debug, Clone, PartialEq)]
pub enum LineFault {
    /// Inverse kinematics has no solution.
    Ik(CellIkError),
    /// A joint would leave its limits, rad or m.
    Limits {
        /// Name of the joint.
        joint: String,
        /// Its value at the point.
        value: f64,
        /// Its lower limit.
        lower: f64,
        /// Its upper limit.
        upper: f64,
    },
    /// A joint would have to jump, because the line passes a singularity.
    Jump {
        /// Name of the joint.
        joint: String,
        /// The jump, rad or m; `None` if it is between two knots.
        by: Option<f64>,
    },
}

impl fmt::Display for LineFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ik(error) => error.fmt(f),
            Self::Limits { joint, value, lower, upper } => write!(
                f,
                "joint \"{joint}\" would have to be at {value:.4}, outside its limits {lower:.4} to {upper:.4} (rad or m)"
            ),
            Self::Jump { joint, by: Some(by) } => {
                write!(f, "joint \"{joint}\" would have to jump by {by:.2} (rad or m): the line passes a singularity")
            }
            Self::Jump { joint, by: None } => {
                write!(f, "joint \"{joint}\" would have to jump: the line passes a singularity")
            }
        }
    }
}

impl TcpLine {
    /// Computes the line from the TCP's pose at `q` to a pose in the root frame, in the branch of `q`.
    ///
    /// `units` are the units of messages.
    ///
    /// # Errors
    /// `LineError` with the position and the cause of the failure.
    pub fn new(robot: &CellRobot, units: Units, q: &[f64], to: Pose) -> Result<Self, LineError> {
        let whole = Self::with_task(robot, units, q, to, IkTask::Pose);
        let few = robot.robot.chain.path(robot.flange).len() < 6 || robot.robot.chain.dof() < 6;
        match whole {
            Err(error) if few => Self::with_task(robot, units, q, to, IkTask::Position).map_err(|_| error),
            other => other,
        }
    }

    fn with_task(robot: &CellRobot, units: Units, q: &[f64], to: Pose, task: IkTask) -> Result<Self, LineError> {
        let chain = &robot.robot.chain;
        let from = robot.tcp_in_root(q);
        let options = IkOptions { task, restarts: 20, ..IkOptions::default() };
        let solver = IkSolver::new(chain, robot.flange, robot.tcp_in_flange, options);
        let mut line = Self {
            from,
            to,
            knots: vec![q.to_vec()],
            solver: Mutex::new(solver),
            units,
            keeps_orientation: task == IkTask::Pose,
        };
        let turn = if line.keeps_orientation { (from.rotation.inverse() * to.rotation).angle() } else { 0.0 };
        let cells = (line.length() / KNOT_M).max(turn / KNOT_RAD).ceil().clamp(4.0, MAX_KNOTS) as usize;
        for i in 1..=cells {
            let s = i as f64 / cells as f64;
            let next = line.step(chain, s, i).map_err(|why| LineError {
                at_m: s * line.length(),
                length_m: line.length(),
                why,
            })?;
            line.knots.push(next);
        }
        for i in 0..cells {
            if let Some((s, joint)) = line.branch_change(i) {
                let joint = chain.joints()[chain.active_joints()[joint].0].name.clone();
                let why = LineFault::Jump { joint, by: None };
                return Err(LineError { at_m: s * line.length(), length_m: line.length(), why });
            }
        }
        Ok(line)
    }

    /// Finds a change of branch between two knots, and the joint that shows it.
    ///
    /// Two branches may be so close that the knots alone do not reveal the change.
    fn branch_change(&self, cell: usize) -> Option<(f64, usize)> {
        let s = |k: usize| (cell as f64 + k as f64 / SAMPLES as f64) / self.cells() as f64;
        let samples: Vec<Vec<f64>> = (0..=SAMPLES).map(|k| self.q(s(k))).collect();
        let step = |k: usize, j: usize| (samples[k + 1][j] - samples[k][j]).abs();
        (0..samples[0].len()).find_map(|j| {
            let travel: f64 = (0..SAMPLES).map(|k| step(k, j)).sum();
            let jumps = |k: &usize| step(*k, j) > BRANCH_CHANGE && step(*k, j) > BRANCH_CHANGE_SHARE * travel;
            (0..SAMPLES).find(jumps).map(|k| (s(k), j))
        })
    }

    fn step(&self, chain: &Chain, s: f64, i: usize) -> Result<Vec<f64>, LineFault> {
        let last = &self.knots[i - 1];
        // Linear extrapolation of the last two knots is the initial guess.
        let mut q: Vec<f64> = match i.checked_sub(2).map(|k| &self.knots[k]) {
            Some(before) => last.iter().zip(before).map(|(a, b)| 2.0 * a - b).collect(),
            None => last.clone(),
        };
        let mut solver = self.solver.lock().unwrap_or_else(PoisonError::into_inner);
        let target = self.pose(s);
        if !solver.refine(&target, &mut q) {
            let refused = |e| LineFault::Ik(CellIkError::new(e, self.units, chain));
            q = solver.solve(&target, last).map_err(refused)?.q;
        }
        for (j, id) in chain.active_joints().iter().enumerate() {
            let joint = &chain.joints()[id.0];
            let (name, value) = (|| joint.name.clone(), q[j]);
            if !joint.limits.contains(value, 1e-9) {
                let Limits { lower, upper, .. } = joint.limits;
                return Err(LineFault::Limits { joint: name(), value, lower, upper });
            }
            if (value - last[j]).abs() > JUMP {
                return Err(LineFault::Jump { joint: name(), by: Some(value - last[j]) });
            }
        }
        Ok(q)
    }

    /// TCP pose at `s`, in the root frame.
    pub fn pose(&self, s: f64) -> Pose {
        self.from.interpolate(&self.to, s)
    }

    /// Length, m.
    pub fn length(&self) -> f64 {
        self.from.translation.distance(self.to.translation)
    }

    /// Number of intervals between knots.
    pub fn cells(&self) -> usize {
        self.knots.len() - 1
    }

    /// Joint values at the end.
    pub fn end(&self) -> &[f64] {
        &self.knots[self.cells()]
    }

    /// Joint values at `s`: interpolated between the knots, then refined until the TCP is on the line.
    pub fn q(&self, s: f64) -> Vec<f64> {
        let x = s.clamp(0.0, 1.0) * self.cells() as f64;
        let i = (x as usize).min(self.cells() - 1);
        let t = x - i as f64;
        if t == 0.0 || t == 1.0 {
            return self.knots[i + t as usize].clone();
        }
        // Cubic through four knots (Catmull-Rom), so that few refinement steps are needed.
        let knot = |k: isize, j: usize| {
            let last = self.cells().cast_signed();
            let inside = k.clamp(0, last) as usize;
            match k {
                k if k < 0 => 2.0 * self.knots[0][j] - self.knots[1][j],
                k if k > last => 2.0 * self.knots[self.cells()][j] - self.knots[self.cells() - 1][j],
                _ => self.knots[inside][j],
            }
        };
        let mut q: Vec<f64> = (0..self.knots[0].len())
            .map(|j| {
                let i = i.cast_signed();
                let [a, b, c, d] = [knot(i - 1, j), knot(i, j), knot(i + 1, j), knot(i + 2, j)];
                let (m0, m1) = ((c - a) / 2.0, (d - b) / 2.0);
                let (t2, t3) = (t * t, t * t * t);
                (2.0 * t3 - 3.0 * t2 + 1.0) * b + (t3 - 2.0 * t2 + t) * m0 + (3.0 * t2 - 2.0 * t3) * c + (t3 - t2) * m1
            })
            .collect();
        let guess = q.clone();
        let mut solver = self.solver.lock().unwrap_or_else(PoisonError::into_inner);
        let solved = solver.refine(&self.pose(s), &mut q);
        let near = q.iter().zip(&guess).all(|(a, b)| (a - b).abs() < JUMP);
        if solved && near { q } else { guess }
    }

    /// Joint values and their derivatives with respect to s, from differences of refined values.
    pub fn at(&self, s: f64) -> TrajectoryPoint {
        let h = STENCIL;
        let c = s.clamp(h, 1.0 - h);
        let [before, middle, after] = [self.q(c - h), self.q(c), self.q(c + h)];
        let ddq: Vec<f64> = (0..middle.len()).map(|j| (after[j] - 2.0 * middle[j] + before[j]) / (h * h)).collect();
        let dq = (0..middle.len()).map(|j| (after[j] - before[j]) / (2.0 * h) + ddq[j] * (s - c)).collect();
        let q = if c == s { middle } else { self.q(s) };
        TrajectoryPoint { q, dq, ddq }
    }
}
