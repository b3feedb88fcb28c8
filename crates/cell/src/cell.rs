//! A cell, resolved: every name looked up, every number in metres, radians and seconds.

use std::path::PathBuf;

use elbowroom_avoidance::{AvoiderSettings, Rules};
use elbowroom_formats::Warning;
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_monitor::{Laws, Part, Region, SourceLimits, Volume, VolumeModel, arm_volumes};
use elbowroom_proximity::Shape;
use elbowroom_scene::{Body, Object, Robot};
use elbowroom_spatial::units::{AngleUnit, LengthUnit};
use elbowroom_spatial::{Pose, Vec3};

use crate::seal::Seal;
use crate::{Mover, PoseTrack};

/// A tool centre point so near to a solid (m) lies on its surface: a flange's frame lies on the flange's face.
const ON_SURFACE_M: f64 = 1e-6;

/// Everything that a cell file says. Read by [`Cell::load`].
#[derive(Debug, Clone)]
pub struct Cell {
    /// The file it came from.
    pub file: PathBuf,
    /// Its name.
    pub name: String,
    /// The units its file is written in, for messages.
    pub units: Units,
    /// Period of the control tick, s.
    pub tick_s: f64,
    /// Longest simulated time of a run, s.
    pub max_s: f64,
    /// In file order.
    pub robots: Vec<CellRobot>,
    /// In file order, where they stand at the start.
    pub objects: Vec<Object>,
    /// The objects that move, in the same order.
    pub movers: Vec<Mover>,
    /// In file order.
    pub regions: Vec<CellRegion>,
    /// In file order.
    pub encoders: Vec<Encoder>,
    /// Files of poses that regions follow.
    pub pose_tracks: Vec<PoseTrack>,
    /// The laws of all monitors; joint decelerations are filled in per robot.
    pub laws: CellLaws,
    /// One per robot; `None` for a robot that stands at its start.
    pub programs: Vec<Option<Program>>,
    /// One per robot; `None` for a robot that does not evade.
    pub avoidance: Vec<Option<AvoidanceSpec>>,
    /// Joint-space maps, checked but used by later verbs.
    pub maps: Vec<MapSpec>,
    /// SHA-256 of the monitors' configurations, hex.
    pub checksum: String,
    /// Who sealed it last; `None` where it is not sealed.
    pub seal: Option<Seal>,
    /// What a user should know about the file, none of it fatal.
    pub warnings: Vec<Warning>,
}

/// How a robot evades what moves.
#[derive(Debug, Clone, PartialEq)]
pub struct AvoidanceSpec {
    /// How hard and where to.
    pub rules: Rules,
    /// Speeds, distances and times.
    pub settings: AvoiderSettings,
    /// Indices of the objects that it sees coming; all others are where its programs know them to be.
    pub objects: Vec<usize>,
    /// Indices of the robots that it sees coming; of all others its programs know.
    pub robots: Vec<usize>,
    /// Whether another way is planned where what is in the way stands.
    pub replan: bool,
}

/// The units of a cell file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Units {
    /// Of lengths.
    pub length: LengthUnit,
    /// Of angles.
    pub angle: AngleUnit,
}

/// A robot, its place, its tool.
#[derive(Debug, Clone)]
pub struct CellRobot {
    /// Its name in the cell.
    pub name: String,
    /// Line of its table.
    pub line: usize,
    /// Links, joints, solids; tool and load are bodies of the flange link.
    pub robot: Robot,
    /// Where the root link stands.
    pub base_in_world: Pose,
    /// The link that carries the tool.
    pub flange: LinkId,
    /// Tool centre point frame in the flange link.
    pub tcp_in_flange: Pose,
    /// The tool's solid, in the flange link.
    pub tool: Option<Body>,
    /// The load's solid, in the flange link.
    pub load: Option<Body>,
    /// Joint values at the start, rad or m.
    pub start: Vec<f64>,
    /// True where the file gives `start`.
    pub start_given: bool,
    /// How links become guarded volumes.
    pub volumes: VolumeModel,
    /// Per value of `q`.
    pub limits: Vec<JointLimits>,
}

/// How fast a joint may move. Per second, per second² and per second³, in rad or m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimits {
    /// Largest speed.
    pub velocity: f64,
    /// Largest acceleration of a programmed move.
    pub acceleration: f64,
    /// Largest jerk of a programmed move.
    pub jerk: f64,
    /// Deceleration that the joint reaches when the override falls.
    pub stop: f64,
}

/// A region and whom it concerns.
#[derive(Debug, Clone)]
pub struct CellRegion {
    /// As the monitors see it; `follow` and the slot of an exchange region are filled in per monitor.
    pub region: Region,
    /// Line of its table.
    pub line: usize,
    /// Indices of the robots that it guards against.
    pub robots: Vec<usize>,
    /// What carries it.
    pub follow: Option<Follow>,
    /// The fastest motion of that which the monitors believe.
    pub source_limits: SourceLimits,
}

/// What a dynamic region rides on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Follow {
    /// A frame of a robot.
    Robot {
        /// Index of the robot.
        robot: usize,
        /// The link.
        link: LinkId,
        /// The frame in the link.
        in_link: Pose,
    },
    /// Index of an encoder.
    Encoder(usize),
    /// Index of an object, which may move or stand.
    Object(usize),
    /// Index of a file of poses.
    Poses(usize),
}

/// A conveyor or a rail: something that travels along a line.
#[derive(Debug, Clone)]
pub struct Encoder {
    /// Its name.
    pub name: String,
    /// Unit vector of positive travel, in the world.
    pub direction: Vec3,
    /// How it travels.
    pub travel: Travel,
    /// Travel after which it begins again at 0, m.
    pub wrap_m: Option<f64>,
}

/// Travel over time.
#[derive(Debug, Clone, PartialEq)]
pub enum Travel {
    /// Constant speed between two times.
    Constant {
        /// Travel before it starts, m.
        at_m: f64,
        /// m/s.
        speed: f64,
        /// It starts at this time, s.
        start_s: f64,
        /// It stops at this time, s; infinite for never.
        end_s: f64,
    },
    /// Times (s, rising) and travels (m), linear between.
    Table(Vec<(f64, f64)>),
}

/// The laws of a cell.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CellLaws {
    /// As the monitors take them, without stopping distance.
    pub laws: Laws,
    /// Time from the monitor's answer to the first deceleration, s: `reaction_ms`, or one tick.
    pub reaction_s: f64,
    /// Reaction time (s) of the stopping-distance law, where that is on.
    pub stopping_reaction_s: Option<f64>,
    /// How late (s) robots obey in simulation: the reaction time that the file gives, 0 where it gives none.
    pub obeyed_after_s: f64,
}

/// What a robot does.
#[derive(Debug, Clone)]
pub struct Program {
    /// Programmed override at the start, 0..1.
    pub speed_override: f64,
    /// How often it runs.
    pub repeat: u32,
    /// What it does.
    pub body: ProgramBody,
    /// Line of its table.
    pub line: usize,
}

/// Steps, or a recording.
#[derive(Debug, Clone)]
pub enum ProgramBody {
    /// One after the other, at rest in between.
    Steps(Vec<Step>),
    /// Joint values over time.
    Trajectory(Vec<TrajectoryRow>),
}

/// A row of a recorded trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryRow {
    /// Time, s.
    pub t_s: f64,
    /// Joint values, rad or m.
    pub q: Vec<f64>,
}

/// One step of a program.
#[derive(Debug, Clone)]
pub struct Step {
    /// Its line in the cell file.
    pub line: usize,
    /// What it does.
    pub action: Action,
}

/// What a step does.
#[derive(Debug, Clone)]
pub enum Action {
    /// Straight in joint space.
    Joint {
        /// Where to.
        to: Target,
        /// Share of each joint's speed, 0..1.
        speed: f64,
    },
    /// TCP on a straight line.
    Linear {
        /// Where to.
        to: Target,
        /// TCP speed, m/s.
        speed: f64,
    },
    /// Switches a temporary region.
    Switch {
        /// Index of the region.
        region: usize,
        /// On or off.
        active: bool,
    },
    /// Waits, s.
    Wait(f64),
    /// Sets the programmed override, 0..1.
    Override(f64),
}

/// Where a move goes.
#[derive(Debug, Clone)]
pub enum Target {
    /// Joint values, rad or m.
    Joints(Vec<f64>),
    /// TCP in the world.
    Tcp(Pose),
}

/// The joint-space map that a robot asks for.
#[derive(Debug, Clone)]
pub struct MapSpec {
    /// Index of the robot.
    pub robot: usize,
    /// Line of its table; that of the robot where there is none.
    pub line: usize,
    /// Indices in `q`.
    pub joints: Vec<usize>,
    /// Width of a cell per joint, rad or m.
    pub step: Vec<f64>,
    /// True where the remaining joints are held at the start.
    pub others_at_start: bool,
}

impl MapSpec {
    /// What a robot has that asks for nothing: its first three joints, 2 degrees (0.02 m where they slide), the others
    /// anywhere.
    pub fn of(index: usize, robot: &CellRobot) -> Self {
        let joints: Vec<usize> = (0..robot.robot.chain.dof().min(3)).collect();
        let step = joints.iter().map(|&j| Self::default_step(robot, j)).collect();
        Self { robot: index, line: robot.line, joints, step, others_at_start: false }
    }

    /// Width of a cell where nothing else is said, rad or m.
    pub(crate) fn default_step(robot: &CellRobot, joint: usize) -> f64 {
        if robot.slides(joint) { 0.02 } else { 2.0_f64.to_radians() }
    }
}

impl CellRobot {
    /// True where a joint (by its place in `q`) slides.
    pub(crate) fn slides(&self, joint: usize) -> bool {
        let chain = &self.robot.chain;
        chain.joints()[chain.active_joints()[joint].0].kind == elbowroom_kinematics::JointKind::Prismatic
    }

    /// Names of the joints in the order of `q`.
    pub fn joint_names(&self) -> Vec<String> {
        let chain = &self.robot.chain;
        chain.active_joints().iter().map(|j| chain.joints()[j.0].name.clone()).collect()
    }

    /// What the monitor keeps out of regions: the TCP, tool and load, and the links. The TCP is the first.
    pub fn guarded_volumes(&self) -> Vec<Volume> {
        let mut volumes = vec![Volume::tcp(self.flange, self.tcp_in_flange.translation)];
        let parts = [("tool", &self.tool), ("load", &self.load)];
        volumes.extend(parts.into_iter().filter_map(|(name, body)| {
            let body = body.as_ref()?;
            let (shape, in_link) = match body.shape {
                Shape::Mesh(_) => self.volumes.of(&body.shape, body.in_link),
                _ => (body.shape.clone(), body.in_link),
            };
            Some(Volume { name: name.into(), part: Part::Tool, link: self.flange, shape, in_link })
        }));
        volumes.extend(arm_volumes(&self.bare(), self.volumes));
        if !self.encloses(&volumes[1..], &volumes[0]) {
            volumes[0].part = Part::TcpOutside;
        }
        volumes
    }

    /// True where one of the solids that keep their place relative to the flange contains the point.
    fn encloses(&self, solids: &[Volume], point: &Volume) -> bool {
        let chain = &self.robot.chain;
        let moving = |link: LinkId| {
            let mut joints = chain.path(link);
            joints.retain(|j| chain.joints()[j.0].kind.moves());
            joints
        };
        let with_point = moving(point.link);
        // Whatever the joint values: only links that no joint moves against each other are compared.
        let mut state = ChainState::new(chain);
        state.q.copy_from_slice(&self.start);
        chain.forward(&mut state);
        let in_root = |v: &Volume| state.link_in_root(v.link) * v.in_link;
        solids
            .iter()
            .filter(|v| moving(v.link) == with_point)
            .any(|v| elbowroom_proximity::within(&point.shape, &in_root(point), &v.shape, &in_root(v), ON_SURFACE_M))
    }

    /// The robot without tool and load, which are bodies of its flange for collisions.
    pub fn bare(&self) -> Robot {
        let mut bare = self.robot.clone();
        let bodies = &mut bare.bodies[self.flange.0];
        bodies.truncate(bodies.len().saturating_sub(self.carried().count()));
        bare
    }

    /// Tool and load, in the flange's frame.
    pub fn carried(&self) -> impl Iterator<Item = &Body> {
        [&self.tool, &self.load].into_iter().flatten()
    }
}
