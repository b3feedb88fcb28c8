//! Solids of a robot that a region can guard: the solids themselves, not the volumes that enclose them.

use std::ops::Range;

use elbowroom_cell::CellRobot;
use elbowroom_kinematics::LinkId;
use elbowroom_monitor::Guards;
use elbowroom_proximity::Shape;
use elbowroom_robot::Collider;
use elbowroom_spatial::{Pose, Vec3};

use super::frame::Frame;
use super::solid::{Bounds, OracleSolid};

/// A solid of a robot, or its tool centre point.
#[derive(Debug, Clone)]
pub struct Guarded {
    /// Index of the link that carries it.
    pub link: usize,
    in_link: Frame,
    solid: OracleSolid,
    part: GuardedPart,
    /// When it is on the robot.
    pub presence: Presence,
    /// Largest distance of its points from the link's origin, m.
    pub radius_m: f64,
}

/// When a solid is on its robot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Presence {
    Always,
    /// While the named tool with this index is on its flange.
    Tool(usize),
    /// At these ticks, as an object in the hand.
    Ticks(Range<usize>),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum GuardedPart {
    Tcp,
    Tool,
    Arm,
}

impl Guarded {
    /// Returns all solids of a robot that can count: the tool centre points first.
    pub fn all(robot: &CellRobot) -> Vec<Self> {
        let mut all = Self::hand(robot);
        for (link, colliders) in robot.without_payload().colliders.iter().enumerate() {
            if robot.payload.tools.iter().any(|t| t.link.0 == link) {
                continue;
            }
            all.extend(colliders.iter().map(|b| Self::of_collider(link, b, GuardedPart::Arm)));
        }
        all
    }

    /// Returns tool centre points, tools and load.
    fn hand(robot: &CellRobot) -> Vec<Self> {
        let tcp = |link: LinkId, at: &Pose| Self::new(link.0, at, OracleSolid::point(), GuardedPart::Tcp);
        if robot.payload.tools.is_empty() {
            let solids = robot.payload.colliders().map(|c| Self::of_collider(robot.flange.0, c, GuardedPart::Tool));
            return std::iter::once(tcp(robot.flange, &robot.tcp_in_flange)).chain(solids).collect();
        }
        let mut all = Vec::new();
        for (index, t) in robot.payload.tools.iter().enumerate() {
            let solid = t.collider.iter().map(|c| Self::of_collider(t.link.0, c, GuardedPart::Tool));
            let parts = std::iter::once(tcp(t.link, &t.tcp_in_link)).chain(solid);
            all.extend(parts.map(|part| Self { presence: Presence::Tool(index), ..part }));
        }
        all
    }

    fn of_collider(link: usize, collider: &Collider, part: GuardedPart) -> Self {
        Self::new(link, &collider.in_link, OracleSolid::eroded(&collider.shape, 0.0), part)
    }

    /// Creates an object that is in the hand at these ticks.
    pub fn held(flange: usize, in_flange: Frame, shape: &Shape, ticks: Range<usize>) -> Self {
        let part = Self::at(flange, in_flange, OracleSolid::eroded(shape, 0.0), GuardedPart::Tool);
        Self { presence: Presence::Ticks(ticks), ..part }
    }

    fn new(link: usize, in_link: &Pose, solid: OracleSolid, part: GuardedPart) -> Self {
        Self::at(link, Frame::of(in_link), solid, part)
    }

    fn at(link: usize, in_link: Frame, solid: OracleSolid, part: GuardedPart) -> Self {
        let radius_m = in_link.at.length() + solid.reach_from(Vec3::ZERO);
        Self { link, in_link, solid, part, presence: Presence::Always, radius_m }
    }

    /// Whether it is on the robot before anything moves.
    pub fn is_there_at_start(&self, robot: &CellRobot) -> bool {
        match self.presence {
            Presence::Always => true,
            Presence::Tool(tool) => robot.payload.tools[tool].mounted,
            Presence::Ticks(_) => false,
        }
    }

    /// Whether it is a tool, a load or a held object, and not the arm or a point.
    pub fn is_tool(&self) -> bool {
        self.part == GuardedPart::Tool
    }

    pub fn counts_for(&self, guards: Guards) -> bool {
        match self.part {
            GuardedPart::Tcp => guards.tcp,
            GuardedPart::Tool => guards.tool || guards.arm,
            GuardedPart::Arm => guards.arm,
        }
    }

    /// Returns its approximate place; `frames` are the frames of all links.
    pub fn center(&self, frames: &[Frame]) -> Vec3 {
        frames[self.link].then(&self.in_link).at
    }

    /// Returns a point of it; `frames` are the frames of all links.
    pub fn any_point(&self, frames: &[Frame]) -> Vec3 {
        frames[self.link].then(&self.in_link).point(self.solid.any_point())
    }

    /// Whether the straight line between two points comes nearer than `within` (m).
    pub fn is_crossed(&self, frames: &[Frame], ends: [Vec3; 2], within: f64) -> bool {
        self.solid.is_crossed(&frames[self.link].then(&self.in_link), ends, within)
    }

    pub fn distance(&self, frames: &[Frame], region: &OracleSolid, region_at: &Frame, limit: f64) -> Bounds {
        self.solid.distance(&frames[self.link].then(&self.in_link), region, region_at, limit)
    }
}
