//! A resolved cell: names resolved, all numbers in metres, radians and seconds.

use std::borrow::Cow;
use std::path::PathBuf;

use elbowroom_avoidance::{AvoiderSettings, Rules};
use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::{ChainState, JointLimits, LinkId};
use elbowroom_monitor::{Laws, OutputGrid, Part, Presence, Region, SourceLimits, Volume, VolumeModel, arm_volumes};
use elbowroom_proximity::Shape;
use elbowroom_robot::{ObjectId, Robot, RobotId};
use elbowroom_scene::{Object, PairRules};
use elbowroom_spatial::Pose;
use elbowroom_spatial::units::{AngleUnit, LengthUnit};

use crate::seal::Seal;
use crate::{
    CellSensor, CellTiming, CellTool, Encoder, FenceWall, Guidance, MeasuredSource, MovingObject, Payload, PoseTrack,
    Program,
};

/// A tool centre point within this distance (m) of a collider counts as on its surface, such as a flange frame on the
/// flange's face.
const ON_SURFACE_M: f64 = 1e-6;

/// The contents of a cell file, read by [`Cell::load`].
#[derive(Debug, Clone)]
pub struct Cell {
    /// The file.
    pub file: PathBuf,
    /// Its name.
    pub name: String,
    /// The units of its file, for messages.
    pub units: Units,
    /// Control tick, and longest run.
    pub timing: CellTiming,
    /// Robots, in file order.
    pub robots: Vec<CellRobot>,
    /// Objects in file order, at their initial poses.
    pub objects: Vec<Object>,
    /// The moving objects, in the same order.
    pub moving_objects: Vec<MovingObject>,
    /// Regions, in file order.
    pub regions: Vec<CellRegion>,
    /// Encoders and pose files that regions follow.
    pub frame_sources: FrameSources,
    /// The laws of all monitors, and the grids.
    pub monitoring: Monitoring,
    /// Cameras in file order, then sources of point clouds.
    pub sensors: Vec<CellSensor>,
    /// Rules of pairs. [`Self::robots`] are as in their models.
    pub pair_rules: CellPairRules,
    /// Virtual fixtures and operators.
    pub guidance: Guidance,
    /// What identifies the configuration, and who approved it.
    pub approval: Approval,
    /// Non-fatal warnings about the file.
    pub warnings: Vec<Diagnostic>,
}

/// What identifies a configuration, and who approved it.
#[derive(Debug, Clone, Default)]
pub struct Approval {
    /// SHA-256 of the monitors' configurations, hex.
    pub checksum: String,
    /// The last seal; `None` if the cell is not sealed.
    pub seal: Option<Seal>,
}

/// Sources of frames outside the cell's robots and objects, which regions follow by index: [`Follow`].
#[derive(Debug, Clone, Default)]
pub struct FrameSources {
    /// Encoders, in file order.
    pub encoders: Vec<Encoder>,
    /// Pose files, in the order of the regions that follow them.
    pub pose_tracks: Vec<PoseTrack>,
    /// Encoders and objects with `measured = true`, in file order, encoders first.
    pub measured: Vec<MeasuredSource>,
}

/// Rules of a cell for pairs of links and objects.
#[derive(Debug, Clone, Default)]
pub struct CellPairRules {
    /// Rules of the file of pairs and of planning scenes.
    pub given: PairRules,
    /// Rules for [links that always touch where they are joined](elbowroom_robot::joint_contacts).
    pub joint_contacts: PairRules,
}

impl CellPairRules {
    /// The rules of all commands: joint contacts, then the given rules, which take precedence.
    pub fn all(&self) -> PairRules {
        let mut rules = self.joint_contacts.clone();
        rules.extend(self.given.clone());
        rules
    }
}

/// Avoidance settings of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct AvoidanceSpec {
    /// Fuzzy rules.
    pub rules: Rules,
    /// Speeds, distances and times.
    pub settings: AvoiderSettings,
    /// The evaded objects; the poses of all others are known to its program.
    pub objects: Vec<ObjectId>,
    /// The evaded robots; the motion of all others is known to its program.
    pub robots: Vec<RobotId>,
    /// Whether another path is planned if an obstacle blocks the path.
    pub replan: bool,
    /// Standard deviation of each coordinate of an observed position, m.
    pub noise_m: f64,
    /// Age of an observation when it arrives, s.
    pub delay_s: f64,
    /// Time from the start of planning until the path can be followed, s.
    pub plan_s: f64,
}

/// The units of a cell file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Units {
    /// Unit of lengths.
    pub length: LengthUnit,
    /// Unit of angles.
    pub angle: AngleUnit,
}

/// A robot with its pose, payload and task; or a mechanism.
#[derive(Debug, Clone)]
pub struct CellRobot {
    /// Its name in the cell.
    pub name: String,
    /// Line of its table.
    pub line: usize,
    /// Links, joints, colliders; tool and load are colliders of the flange link.
    pub robot: Robot,
    /// Pose of the root link.
    pub base_in_world: Pose,
    /// The link that carries the tool.
    pub flange: LinkId,
    /// Tool centre point frame in the flange link.
    pub tcp_in_flange: Pose,
    /// Tool and load, or named tools. With named tools, `flange` is the link of the active one.
    pub payload: Payload,
    /// Joint values at the start, rad or m.
    pub start: Vec<f64>,
    /// True if the file gives `start`.
    pub start_given: bool,
    /// Named configurations, rad or m, in file order.
    pub states: Vec<(String, Vec<f64>)>,
    /// How links become guarded volumes; `None` for a [mechanism](Self::is_mechanism).
    pub volumes: Option<VolumeModel>,
    /// Motion limits per value of `q`.
    pub limits: Vec<JointLimits>,
    /// Its program; `None` if it stays at its start.
    pub program: Option<Program>,
    /// Its avoidance; `None` if it does not avoid dynamic obstacles.
    pub avoidance: Option<AvoidanceSpec>,
    /// Settings of its joint-space map, if the file has a table for it.
    pub map: Option<MapSpec>,
}

/// A region and the robots it guards against.
#[derive(Debug, Clone)]
pub struct CellRegion {
    /// Region of the monitors; `follow` and the slot of an exchange region are set per monitor.
    pub region: Region,
    /// Line of its table.
    pub line: usize,
    /// The robots that it guards against.
    pub robots: Vec<RobotId>,
    /// The frame that it follows.
    pub follow: Option<Follow>,
    /// Largest plausible motion of that frame, for the monitors.
    pub source_limits: SourceLimits,
    /// Its solid as the file describes it.
    pub solid: RegionSolid,
}

impl CellRegion {
    /// Its table, as the cell file writes it: `[region.NAME]` or `[fence.NAME]`.
    pub fn table(&self) -> String {
        let word = if matches!(self.solid, RegionSolid::Walls(_)) { "fence" } else { "region" };
        format!("[{word}.{}]", self.region.name)
    }
}

/// The solid of a region as the file describes it; for the monitors it is one shape, possibly a mesh.
#[derive(Debug, Clone)]
pub enum RegionSolid {
    /// The shape of the region.
    Shape,
    /// Everything outside of this shape, in the frame of the region's shape: `keep = "inside"`.
    AllBut(Shape),
    /// The walls of a fence.
    Walls(Vec<FenceWall>),
}

/// The source that a dynamic region follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Follow {
    /// A frame of a robot.
    Robot {
        /// The robot.
        robot: RobotId,
        /// The link.
        link: LinkId,
        /// The frame in the link.
        in_link: Pose,
    },
    /// Index of an encoder.
    Encoder(usize),
    /// An object, moving or fixed.
    Object(ObjectId),
    /// Index of a pose file.
    Poses(usize),
}

/// What the monitors of all robots are set to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Monitoring {
    /// Their laws, without stopping distance: joint decelerations are set per robot.
    pub laws: Laws,
    /// Time from the monitor's answer to the first deceleration, s: `reaction_ms`, or one tick.
    pub reaction_s: f64,
    /// Reaction time (s) of the stopping-distance law; `None` if the law is off.
    pub stopping_reaction_s: Option<f64>,
    /// Reaction time (s) of robots in the simulation, from the file; 0 if the file states none.
    pub reaction_delay_s: f64,
    /// Grids of the working area, in file order.
    pub grids: Vec<CellGrid>,
}

/// A grid, for one robot.
#[derive(Debug, Clone, PartialEq)]
pub struct CellGrid {
    /// The robot.
    pub robot: RobotId,
    /// Line of its table.
    pub line: usize,
    /// Grid of the robot's monitor.
    pub grid: OutputGrid,
}

/// Settings of the joint-space map of a robot.
#[derive(Debug, Clone)]
pub struct MapSpec {
    /// Line of its table, or of the robot if the map has no table.
    pub line: usize,
    /// Indices of its joints in `q`.
    pub joints: Vec<usize>,
    /// Width of a cell per joint, rad or m.
    pub step: Vec<f64>,
    /// True if the remaining joints are held at the start.
    pub others_at_start: bool,
}

impl MapSpec {
    /// Default settings for a robot: its first three joints, cells of 2 degrees (0.02 m for prismatic joints), all
    /// values of the other joints.
    pub fn of(robot: &CellRobot) -> Self {
        let joints: Vec<usize> = (0..robot.robot.chain.dof().min(3)).collect();
        let step = joints.iter().map(|&j| Self::default_step(robot, j)).collect();
        Self { line: robot.line, joints, step, others_at_start: false }
    }

    /// Default cell width, rad or m.
    pub(crate) fn default_step(robot: &CellRobot, joint: usize) -> f64 {
        if robot.slides(joint) { 0.02 } else { 2.0_f64.to_radians() }
    }
}

impl Cell {
    /// The cell with objects at rest at other poses in the world.
    pub fn with_objects_at(&self, placed: &[(ObjectId, Pose)]) -> Cow<'_, Self> {
        let mut cell = Cow::Borrowed(self);
        for (object, in_world) in placed {
            let cell = cell.to_mut();
            cell.objects[object.0].in_world = *in_world;
            cell.moving_objects.retain(|moving| moving.object != *object);
        }
        cell
    }

    /// The robots that monitors guard: all but the mechanisms, in file order.
    pub fn guarded_robots(&self) -> impl Iterator<Item = RobotId> {
        guarded(&self.robots)
    }
}

/// The robots that are not mechanisms.
pub(crate) fn guarded(robots: &[CellRobot]) -> impl Iterator<Item = RobotId> {
    robots.iter().enumerate().filter(|(_, r)| !r.is_mechanism()).map(|(i, _)| RobotId(i))
}

impl CellRobot {
    /// True for a mechanism, such as a door, a gate or a positioner: it moves and is an obstacle, but no monitor guards
    /// it, and it follows no override.
    pub fn is_mechanism(&self) -> bool {
        self.volumes.is_none()
    }

    /// True for a prismatic joint (by its index in `q`).
    pub(crate) fn slides(&self, joint: usize) -> bool {
        let chain = &self.robot.chain;
        chain.joints()[chain.active_joints()[joint].0].kind == elbowroom_kinematics::JointKind::Prismatic
    }

    /// The configuration of this name, rad or m.
    pub fn state(&self, name: &str) -> Option<&[f64]> {
        self.states.iter().find(|(known, _)| known == name).map(|(_, q)| &q[..])
    }

    /// Joint values (rad or m) from numbers in the units of a cell file; as many as are given.
    pub fn joint_values_from_units(&self, values: &[f64], units: Units) -> Vec<f64> {
        let slides = |joint: usize| joint < self.robot.chain.dof() && self.slides(joint);
        values.iter().enumerate().map(|(joint, &v)| units.joint(slides(joint), v)).collect()
    }

    /// The TCP in the robot's root frame at joint values (all of the chain's, rad or m).
    ///
    /// # Panics
    /// The number of values is wrong.
    pub fn tcp_in_root(&self, q: &[f64]) -> Pose {
        let mut state = ChainState::new(&self.robot.chain);
        state.q.copy_from_slice(q);
        self.robot.chain.forward(&mut state);
        state.link_in_root(self.flange) * self.tcp_in_flange
    }

    /// Names of the joints in the order of `q`.
    pub fn joint_names(&self) -> Vec<String> {
        let chain = &self.robot.chain;
        chain.active_joints().iter().map(|j| chain.joints()[j.0].name.clone()).collect()
    }

    /// Links of the hand: the flange, the links fixed to it, and the fingers that it carries.
    pub fn hand_links(&self) -> Vec<LinkId> {
        let chain = &self.robot.chain;
        let moving = |link: LinkId| {
            let mut joints = chain.path(link);
            joints.retain(|j| chain.joints()[j.0].kind.moves());
            joints
        };
        let of_flange = moving(self.flange);
        (0..chain.links().len()).map(LinkId).filter(|link| moving(*link).starts_with(&of_flange)).collect()
    }

    /// Guarded volumes: the TCP first, then tool and load, then the links. A mechanism has none.
    ///
    /// For a robot with named tools: their TCPs, the tools, and the links.
    pub fn guarded_volumes(&self) -> Vec<Volume> {
        let Some(model) = self.volumes else { return Vec::new() };
        if !self.payload.tools.is_empty() {
            return self.volumes_of_tools(model);
        }
        let mut volumes = vec![Volume::tcp(self.flange, self.tcp_in_flange.translation)];
        let parts = [("tool", Part::Tool, &self.payload.tool), ("load", Part::Load, &self.payload.load)];
        volumes.extend(parts.into_iter().filter_map(|(name, part, collider)| {
            let collider = collider.as_ref()?;
            let (shape, in_link) = model.of_solid(&collider.shape, collider.in_link);
            Some(Volume { name: name.into(), part, link: self.flange, shape, in_link, presence: Presence::Always })
        }));
        volumes.extend(arm_volumes(&self.without_payload(), model));
        if !self.encloses(&volumes[1..], &volumes[0]) {
            volumes[0].part = Part::TcpOutside;
        }
        volumes
    }

    fn volumes_of_tools(&self, model: VolumeModel) -> Vec<Volume> {
        let mut links = arm_volumes(&self.robot, model);
        links.retain(|v| self.payload.tools.iter().all(|t| t.link != v.link));
        let tool = |t: &CellTool| {
            let c = t.collider.as_ref()?;
            let (shape, in_link) = model.of_solid(&c.shape, c.in_link);
            Some(Volume {
                name: t.name.clone(),
                part: Part::Tool,
                link: t.link,
                shape,
                in_link,
                presence: self.presence(t),
            })
        };
        let tcp = |t: &CellTool| {
            let name = format!("{} tcp", t.name);
            let mut tcp = Volume { name, presence: self.presence(t), ..Volume::tcp(t.link, t.tcp_in_link.translation) };
            // Another tool may be unmounted.
            let solids: Vec<Volume> = tool(t).into_iter().chain(links.iter().cloned()).collect();
            if !self.encloses(&solids, &tcp) {
                tcp.part = Part::TcpOutside;
            }
            tcp
        };
        let tcps: Vec<Volume> = self.payload.tools.iter().map(tcp).collect();
        tcps.into_iter().chain(self.payload.tools.iter().filter_map(tool)).chain(links.iter().cloned()).collect()
    }

    /// True if a solid that is fixed relative to the flange contains the point.
    fn encloses(&self, solids: &[Volume], point: &Volume) -> bool {
        let chain = &self.robot.chain;
        let moving = |link: LinkId| {
            let mut joints = chain.path(link);
            joints.retain(|j| chain.joints()[j.0].kind.moves());
            joints
        };
        let with_point = moving(point.link);
        // Independent of joint values: only links without a joint in between are compared.
        let mut state = ChainState::new(chain);
        state.q.copy_from_slice(&self.start);
        chain.forward(&mut state);
        let in_root = |v: &Volume| state.link_in_root(v.link) * v.in_link;
        solids
            .iter()
            .filter(|v| moving(v.link) == with_point)
            .any(|v| elbowroom_proximity::within(&point.shape, &in_root(point), &v.shape, &in_root(v), ON_SURFACE_M))
    }

    /// The robot without tool and load.
    pub fn without_payload(&self) -> Robot {
        let mut robot = self.robot.clone();
        let colliders = &mut robot.colliders[self.flange.0];
        colliders.truncate(colliders.len().saturating_sub(self.payload.colliders().count()));
        robot
    }
}
