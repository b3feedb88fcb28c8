//! Programs of robots: steps, or a recorded trajectory.

use elbowroom_kinematics::JointTrajectory;
use elbowroom_kinematics::inverse::ConfigurationChoice;
use elbowroom_robot::ObjectId;
use elbowroom_spatial::{Pose, Vec3};

use crate::CellRegionId;

/// Program of a robot.
#[derive(Debug, Clone)]
pub struct Program {
    /// Programmed override at the start, 0..1.
    pub speed_override: f64,
    /// Number of repetitions.
    pub repeat: u32,
    /// Its contents.
    pub body: ProgramBody,
    /// Line of its table.
    pub line: usize,
}

/// Steps, or a recorded trajectory.
#[derive(Debug, Clone)]
pub enum ProgramBody {
    /// Executed in order, at rest in between.
    Steps(Vec<ProgramStep>),
    /// Joint values over time.
    Trajectory(JointTrajectory),
}

/// One step of a program.
#[derive(Debug, Clone)]
pub struct ProgramStep {
    /// Its line in the cell file.
    pub line: usize,
    /// Its action.
    pub action: StepAction,
}

/// An axis of the TCP that keeps the direction that it has at the start; the TCP may turn about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeptAxis {
    /// The axis in the frame of the TCP; any length but 0.
    pub axis_in_tcp: Vec3,
    /// Largest angle from the direction at the start, rad.
    pub tolerance_rad: f64,
}

/// Action of a step.
#[derive(Debug, Clone)]
pub enum StepAction {
    /// Joint move: straight in joint space.
    Joint {
        /// Target.
        to: MoveTarget,
        /// Fraction of each joint's speed, 0..1.
        speed: f64,
    },
    /// Linear move: the TCP on a straight line.
    Linear {
        /// Target.
        to: MoveTarget,
        /// TCP speed, m/s.
        speed: f64,
    },
    /// Planned move: a path around everything at its place at the start of the run, or at the place where this program
    /// has put it.
    Planned {
        /// Target.
        to: MoveTarget,
        /// Fraction of each joint's speed, 0..1.
        speed: f64,
        /// Planner that searches the path.
        planner: PathPlanner,
        /// An axis that keeps its direction on the path.
        keep: Option<KeptAxis>,
    },
    /// Switches a temporary region.
    Switch {
        /// The region.
        region: CellRegionId,
        /// On or off.
        active: bool,
    },
    /// Attaches an object to the flange, at its present pose.
    Grip(ObjectId),
    /// Detaches an object from the flange; its pose stays.
    Release(ObjectId),
    /// Makes one of the robot's [tools](crate::Payload::tools) the active one.
    Tool(usize),
    /// Waits, s.
    Wait(f64),
    /// Sets the programmed override, 0..1.
    Override(f64),
}

/// A method of path search.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PathPlanner {
    /// Two trees of random samples, proven on sphere covers and in the exact scene; for any number of joints.
    #[default]
    RrtConnect,
    /// A search through the free cells of the robot's joint-space map of three joints.
    Grid,
}

/// Target of a move.
#[derive(Debug, Clone)]
pub enum MoveTarget {
    /// Joint values, rad or m.
    Joints(Vec<f64>),
    /// A pose of the TCP.
    Tcp(TcpTarget),
}

/// A pose of the TCP. If several joint values reach it, `configuration` and `near` choose.
#[derive(Debug, Clone, PartialEq)]
pub struct TcpTarget {
    /// The TCP in the world.
    pub in_world: Pose,
    /// Shoulder, elbow and wrist, only for six axes with a spherical wrist.
    pub configuration: ConfigurationChoice,
    /// Chooses the solution nearest to these values of all joints (rad or m), and so also whole turns.
    pub near: Option<Vec<f64>>,
}
